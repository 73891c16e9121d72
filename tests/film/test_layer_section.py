"""Layers of flyer files: pages, porous, mixed and graded layers, tables at several temperatures."""

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.config.reader import read_film_file
from lightflyer.film import Graded, Mixture, material, thickness_uncertainty
from lightflyer.film.media.dispersion import Formula, TaucLorentz


@pytest.fixture
def layer(write):
    return lambda entry: read_film_file(
        write(f"[film]\nlayers = [\n  {{{entry}}},\n]\n", "film.toml")
    )


def medium(section):
    return section.film().layers[0].material


def test_a_page_of_the_database(layer):
    section = layer('material = "cr/johnson", thickness = "10 nm", density = "7.15 g/cm^3"')
    assert medium(section).name == "main/Cr/Johnson"
    assert section.film().areal_density == pytest.approx(7.15e-5)


def test_a_porous_layer(layer):
    section = layer('material = "Ge", porosity = "30 %", grain = "3 nm", thickness = "20 nm"')
    same = Mixture((material("Ge"), material("vacuum")), 0.3)
    np.testing.assert_array_equal(medium(section).index(6e-7), same.index(6e-7))
    assert medium(section).diagnostics == ()
    assert section.limit() == 1211.0
    assert "of porous Ge is known" in section.lacking()
    stated = layer('material = "Ge", porosity = 0.5, density = "3 g/cm^3", thickness = "1 um"')
    assert stated.film().areal_density == pytest.approx(3e-3)


def test_a_graded_mixture_keeps_the_order_of_its_parts(layer):
    section = layer(
        'parts = [{material = "SiO2", fraction = 0.1, fraction_bottom = 0.4}, {material = "Ge"}, '
        '{material = "air", fraction = 0.2}], sheets = 3, thickness = "30 nm", density = "4 g/cm^3"'
    )
    found = medium(section)
    assert isinstance(found, Graded)
    assert [part.name for part in found.parts] == ["Ge", "SiO2", "vacuum"]
    np.testing.assert_allclose(found.sheets[2].all_fractions, [0.45, 0.35, 0.2], rtol=1e-14)
    assert section.film().areal_density == pytest.approx(1.2e-4)
    names = [name for name, _, value in section.numbers() if value is not None]
    assert "layers.0.parts.0.fraction_bottom" in names


def test_every_number_with_an_uncertainty_counts(layer):
    """The mass of a porous layer, from ± of its porosity and thickness, by hand."""
    section = layer('material = "Ge", porosity = "0.3 ± 0.1", thickness = "20 ± 1 nm"')
    spread = thickness_uncertainty(
        lambda one: one.areal_density, section.film(), [1e-9], section.neighbours()
    )
    assert spread == pytest.approx(5323.0 * np.hypot(0.1 * 20e-9, 0.7 * 1e-9), rel=1e-12)
    at_the_end = layer('material = "Ge", porosity = "0.05 ± 0.1", thickness = "20 nm"')
    ((above, below),) = at_the_end.neighbours()
    assert above.layers[0].material.fractions == pytest.approx(0.15)
    assert below.layers[0].material.fractions == 0.0


def test_a_mat_of_needles(layer):
    section = layer(
        'parts = [{material = "vacuum"}, {material = "main/C/Querry-AsburyMicro260", '
        'fraction = 0.3, density = "2.2 g/cm^3"}], rule = "maxwell-garnett", shape = "mat", '
        'thickness = "300 nm"'
    )
    shipped = material("CNT-mat").index(np.array([6e-7, 1e-5]))
    np.testing.assert_allclose(medium(section).index(np.array([6e-7, 1e-5])), shipped, rtol=1e-14)
    assert medium(section).density == pytest.approx(material("CNT-mat").density)


def test_tables_at_several_temperatures(layer):
    section = layer(
        'tables = [{material = "main/Si/Franta-400K"}, {material = "Si", at = "300 K"}], '
        'temperature = "350 K", thickness = "20 nm"'
    )
    ends = [material(name).index(6e-7)[1] for name in ("Si", "main/Si/Franta-400K")]
    assert medium(section).index(6e-7)[1] == pytest.approx(np.mean(ends), rel=1e-12)


A_GE = 'name = "a-Ge", density = "5 g/cm^3", dispersion = '
TERM = '{amplitude = "120 eV", energy = "3.2 eV", broadening = "2.9 eV", gap = "0.8 eV"}'


def test_a_formula(layer):
    text = f'{{permittivity = 1.1, tauc_lorentz = [{TERM}], longest = "3 um"}}'
    section = layer(f'{A_GE}{text}, thickness = "20 nm"')
    expected = Formula("a-Ge", (TaucLorentz("120 eV", "3.2 eV", "2.9 eV", "0.8 eV"),), 1.1)
    np.testing.assert_allclose(medium(section).index(1e-6), expected.index(1e-6), rtol=1e-12)
    assert medium(section).wavelength_range[1] == 3e-6
    assert section.film().areal_density == pytest.approx(1e-4)


THICK = ', thickness = "20 nm"'


@pytest.mark.parametrize(
    ("entry", "message"),
    [
        ('material = "main/Cr/Jonson"', "did you mean main/Cr/Johnson"),
        ('material = "main/Si/Daub"', "has no refractive index n, only k"),
        ('material = "Ge", porosity = 1.2', "porosity = 1.2: must be between 0 and 1"),
        ('material = "Ge", porosity_bottom = 0.2', "porosity_bottom needs porosity"),
        ('material = "Ge", rule = "series"', "rule is for layers with porosity or parts"),
        ('material = "Ge", temperature = "300 K"', "temperature and tables need each other"),
        ('material = "Ge", porosity = 0.2, shape = "mat"', 'the rule "bruggeman" has no mat'),
        ('material = "Ge", porosity = 0.2, sheets = 0', "sheets = 0: must be at least 1"),
        ('material = "vacuum"', "vacuum is for parts of mixtures"),
        (A_GE + "{}", "needs either cauchy, or terms"),
        (A_GE + '{cauchy = {a = 1.5}, lorentz = [{strength = 1, energy = "1 eV", '
         'broadening = "1 eV"}]}', "needs either cauchy, or terms"),
        (A_GE + '{cauchy = {a = 1.5, b = "1 eV"}}', "wrong kind"),
        (A_GE + "{tauc_lorentz = [" + TERM.replace("2.9", "29") + "]}", "below twice its energy"),
        (A_GE + "{tauc_lorentz = [" + TERM.replace("gap", "gab") + "]}", 'did you mean "gap"'),
        ('sheets = 3', "give one of material, parts"),
        ('parts = [{material = "Ge"}, {material = "Si"}]', r"\(without are Ge, Si\)"),
        ('parts = [{material = "Ge", fraction = 1}, {material = "Si", fraction = 0}]', "are none"),
        ('parts = [{material = "Ge"}, {material = "Si", fraction = 0.7}, '
         '{material = "air", fraction = 0.4}]', "add up to 1.1, more than 1"),
        ('parts = [{material = "Ge", fraction_bottom = 0.2}, {material = "Si", fraction = 0.7}]',
         "fraction_bottom of Ge needs its fraction"),
        ('parts = [{material = "Ge"}]', "parts"),
        ('tables = [{material = "Si"}, {material = "main/Si/Franta-400K"}], temperature = "350 K"',
         "Si states no temperature; give it"),
        ('tables = [{material = "main/Si/Franta-300K"}, {material = "main/Si/Franta-400K"}], '
         'temperature = "450 K"', "= 450 is not between 300 and 400"),
        ('tables = [{material = "main/Si/Franta-300K"}, {material = "main/Si/Franta-400K"}], '
         'temperature = "390 ± 20 K"', "temperature ± one standard deviation: .* = 410 is not"),
        ('parts = [{material = "Ge"}, {material = "Si", fraction = "0.7 ± 0.1"}, '
         '{material = "air", fraction = 0.25}]', "add up to 1.05, more than 1"),
        ('tables = [{material = "Si", at = "400 K"}, {material = "main/Si/Franta-400K"}], '
         'temperature = "400 K"', "two tables are for the same temperature"),
    ],
)  # fmt: skip
def test_bad_layers_get_one_line(layer, entry, message):
    with pytest.raises(lf.ConfigurationError, match=message) as caught:
        layer(entry + THICK)
    assert "film.toml:" in str(caught.value)
    assert "\n" not in str(caught.value)
