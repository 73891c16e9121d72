import numpy as np
import pytest

import lightflyer as lf
from lightflyer.film import (
    Film,
    Layer,
    material,
    material_from_csv,
    material_names,
    tabulated_material,
)


@pytest.mark.parametrize("name", material_names())
def test_every_material_is_sound_over_its_whole_range(name):
    known = material(name)
    shortest, longest = known.wavelength_range
    wavelength = np.geomspace(shortest, longest, 2001)
    n, k = known.index(wavelength)
    assert np.all(np.isfinite(n) & (n > 0.0))
    assert np.all(np.isfinite(k) & (k >= 0.0))
    assert known.source
    assert known.density_source
    assert known.density is None or 500.0 < known.density < 2e4


def test_extrapolation_is_a_choice():
    ends = [2e-7, 25e-6]
    inside = [0.4e-6, 19.942e-6]
    n, k = material("PET").index(inside)
    hold = material("PET", extrapolation="hold").index(ends)
    np.testing.assert_array_equal(hold, (n, k))
    lossless = material("PET", extrapolation="lossless").index(ends)
    np.testing.assert_array_equal(lossless, (n, np.zeros(2)))
    with pytest.raises(lf.ParameterError, match="choose from error, hold, lossless"):
        material("PET", extrapolation="guess")


def test_a_gap_between_pages_is_bridged_without_a_jump():
    ends = np.array([1.59e-6, 1.667e-6])
    middle = material("polyimide").index(ends.mean())
    np.testing.assert_allclose(middle, np.mean(material("polyimide").index(ends), axis=1))


def test_names_are_forgiving_and_mistakes_are_helped():
    assert material("mylar").name == material("pet").name == "PET"
    with pytest.raises(lf.ParameterError, match='"Germaniun" is unknown; did you mean Ge'):
        material("Germaniun")


def test_films_whose_data_do_not_meet():
    infrared = tabulated_material("ir", np.array([30e-6, 40e-6]), np.ones(2), np.ones(2))
    film = Film((Layer(infrared, 1e-7), Layer(material("PET"), 1e-7)))
    with pytest.raises(lf.ParameterError, match="no wavelength in common"):
        _ = film.covered_range


def test_ones_own_table(tmp_path, write):
    path = write("# mine\nwavelength [nm],n,k\n400,1.5,0.1\n800,1.4,0.2\n", "mine.csv")
    own = material_from_csv(path, density=900.0)
    np.testing.assert_allclose(own.index(600e-9), (1.45, 0.15), rtol=1e-12)
    path.write_text("k,wavelength_um,n\n0.1,0.4,1.5\n0.2,0.8,1.4\n")
    np.testing.assert_allclose(material_from_csv(path).index(600e-9), (1.45, 0.15), rtol=1e-12)
    with pytest.raises(lf.ConfigurationError, match="cannot be read"):
        material_from_csv(tmp_path / "none.csv")
