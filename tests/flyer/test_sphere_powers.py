"""Spheres in files by where they absorb, and in the light of a laser."""

import re

import numpy as np
import pytest

from lightflyer import ConfigurationError, film
from lightflyer.config.reader import read_design

FILE = """[flyer]
shape = "sphere"
diameter = "2 um"
density = "1.8 g/cm^3"
conductivity = "0.3 W/(m*K)"
tac_top = 0.9
emittance = 0.2
{}
[environment]
kind = "earth"
"""


def design(folder, keys):
    path = folder / "flyer.toml"
    path.write_text(FILE.format(keys), encoding="utf-8")
    return read_design(path)


@pytest.fixture
def powers(tmp_path):
    """A sphere of radius 5 with q = 1 - z/10, whose asymmetry is 3/40 of its efficiency."""
    middle = np.arange(10) - 4.5
    points = np.stack(np.meshgrid(middle, middle, middle), -1).reshape(-1, 3)
    points = points[np.sum(points**2, axis=1) < 25.0]
    rows = np.column_stack([points, 1.0 - 0.1 * points[:, 2]])
    np.savetxt(tmp_path / "q.txt", rows, header="x y z q", comments="")
    return tmp_path / "q.txt"


def test_absorbed_powers_of_a_file_give_the_asymmetry(powers, tmp_path):
    made = design(tmp_path, 'absorption_efficiency = 0.8\nabsorbed_powers = "q.txt"')
    share = film.read_absorbed_powers(powers).asymmetry
    assert made.setup.flyer.asymmetry == pytest.approx(0.8 * share, rel=1e-12)
    assert share == pytest.approx(3 / 40, rel=0.05)
    more = made.build({"flyer.absorption_efficiency": 1.2}).flyer
    assert more.asymmetry == pytest.approx(1.2 * share, rel=1e-12)
    # they go before what a material gives
    keys = 'material = "graphite"\nextrapolation = "hold"\nabsorbed_powers = "q.txt"'
    made = design(tmp_path, keys).setup.flyer
    assert made.asymmetry == pytest.approx(share * made.absorption_efficiency, rel=1e-12)


def test_a_sphere_in_the_light_of_a_laser(tmp_path):
    keys = 'material = "SiO2"\nextrapolation = "hold"\nspectrum = "532 nm"'
    made = design(tmp_path, keys).setup.flyer
    glass = film.material("SiO2", extrapolation="hold")
    seen = film.sphere_absorption(glass, 1e-6, film.spectral_line(532e-9))
    assert made.absorption_efficiency == pytest.approx(seen.absorption_efficiency, rel=1e-12)
    assert made.asymmetry == pytest.approx(seen.asymmetry, rel=1e-12)


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ('absorption_efficiency = 1\nabsorbed_powers = "no.txt"', "no.txt"),
        ('absorption_efficiency = 1\nabsorbed_powers = "IntField-X"', "IntField-X: cannot"),
        ('absorption_efficiency = 1\nabsorbed_powers = "flyer.toml"', "flyer.toml"),
        ('absorption_efficiency = 1\nasymmetry = 0\nabsorbed_powers = "q.txt"', "beside asymmetry"),
        ('material = "a-C"\nspectrum = "moon"', 'a wavelength such as "532 nm"'),
        ('material = "a-C"\nspectrum = "5 kg"', "kg"),
        ('material = "a-C"\nspectrum = "-5 um"', "wavelength"),
        ('material = "a-C"\nspectrum = "50 um"', "no power"),
    ],
)
@pytest.mark.usefixtures("powers")
def test_bad_powers_and_light_are_refused_in_a_line(keys, said, tmp_path):
    with pytest.raises(ConfigurationError, match=re.escape(said)) as error:
        _ = design(tmp_path, keys).setup
    assert "\n" not in str(error.value)
