from lightflyer.files.display_units import amount, in_words, suitable
from lightflyer.files.drawing import wrap_label


def test_values_and_names_as_readers_see_them():
    label = "smallest irradiance that levitates the flyer [W/m²]"
    assert suitable("kg", 1.5e-7) == (1e6, "mg")
    assert amount(72116.2, "m", digits=5) == "72.116 km"
    assert in_words("flyer.film.tac_top") == "film TAC, top"
    assert in_words("flyer.diameter") == "flyer diameter"
    assert wrap_label(label) == "smallest irradiance that\nlevitates the flyer [W/m²]"
