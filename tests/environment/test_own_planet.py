"""Titan, which the package does not know: numbers, an atmosphere, and four lines for files."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

import lightflyer as lf

TITAN = '''
from typing import ClassVar, Literal

import jax.numpy as jnp
import lightflyer as lf
from lightflyer.environment import AbstractAtmosphere, Planet, PlanetSection

TITAN = Planet("Titan", 2.57473e6, 4.5607e-6, gravity=1.352, irradiance=14.8, albedo=0.26,
               infrared=2.3, highest_searched=500e3)


class Haze(AbstractAtmosphere):
    """As warm everywhere as the stratosphere of Titan; 10 Pa at 200 km."""

    altitude_range = (100e3, 600e3)

    def temperature(self, altitude, place=None):
        return 170.0 + 0.0 * altitude

    def pressure(self, altitude, place=None):
        height = 296.8 * 170.0 / TITAN.gravity_at(200e3)
        share = (TITAN.radius + 200e3) / (TITAN.radius + altitude)
        return 10.0 * jnp.exp(-(altitude - 200e3) * share / height)

    def molar_mass_ratio(self, altitude, place=None):
        return 1.0


class TitanSection(PlanetSection):
    planet: ClassVar = TITAN
    default_gas: ClassVar = "nitrogen"
    kind: Literal["titan"]

    def build_atmosphere(self):
        return Haze()
'''

FILE = """
[flyer]
diameter = "2 cm"
[film]
areal_density = "0.02 g/m^2"
absorptance = 0.9
emittance = 0.05
tac_top = 0.4
tac_bottom = 0.95
[environment]
kind = "titan"
{}
[force]
model = "kinetic"
"""


@pytest.fixture(scope="module")
def titan():
    """Names of the module that a user of Titan writes, but for its section."""
    names = {"__name__": "titan"}
    exec(TITAN[: TITAN.index("class TitanSection")], names)
    return names


@pytest.fixture(scope="module")
def place(titan):
    return lf.environment.Planetary(
        planet=titan["TITAN"], atmosphere=titan["Haze"](), gas=lf.gas.NITROGEN
    )


def test_a_planet_brings_its_own_light_gravity_and_ground(place):
    altitude = np.array([200e3, 400e3])
    state = place.state(altitude)
    falling = (2.57473e6 / (2.57473e6 + altitude)) ** 2
    np.testing.assert_allclose(state.gravity, 1.352 * falling, rtol=1e-14)
    np.testing.assert_allclose(state.radiation.ground_view, falling, rtol=1e-14)
    assert place.radiation.irradiance == 14.8
    assert place.radiation.albedo == 0.26
    assert place.radiation.infrared_below == 2.3
    slope = np.diff(np.log(place.state(np.array([299.9e3, 300.1e3])).pressure))[0] / 200.0
    weight = 1.352 * (2.57473 / 2.87473) ** 2 / (lf.gas.NITROGEN.specific_gas_constant * 170.0)
    assert slope == pytest.approx(-weight, rel=1e-3)  # hydrostatic: gravity is that of the planet
    assert place.coordinate.searched == (100e3, 500e3)
    assert any("Haze" in text for text in place.assumptions())


def test_everything_goes_there(place):
    film = lf.FilmProperties(2e-5, 0.9, 0.05, 0.05, tac_top=0.4, tac_bottom=0.95)
    disk = lf.Disk(film, 0.01)
    found = lf.predict(disk, place, lf.Kinetic())
    (band,) = found.bands
    assert 100e3 < band[0] < band[1] == 500e3  # where the search ends, not the atmosphere
    band = lf.levitation_band(disk, place, lf.Kinetic())
    np.testing.assert_allclose([band.lower, band.upper], found.bands[0], rtol=1e-6)


def test_numbers_that_a_planet_lacks_are_asked_for(titan):
    bare = lf.environment.Planet("Bare", 2e6, 1e-5)
    with pytest.raises(lf.ParameterError, match="Bare has no irradiance"):
        lf.environment.Planetary(planet=bare, atmosphere=titan["Haze"](), gas=lf.gas.NITROGEN)
    with pytest.raises(lf.ParameterError, match="Bare has no gravity"):
        bare.gravity_at(0.0)


def test_a_file_has_the_light_of_its_planet_unless_it_states_other(tmp_path):
    """What ``lightflyer predict`` says of a file, with Titan in an installed package."""
    (tmp_path / "titan.py").write_text(TITAN)
    about = tmp_path / "titan-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: titan\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text("[lightflyer]\ntitan = titan\n")
    environment = "albedo = 0.2\naltitude_max = '400 km'"
    (tmp_path / "flyer.toml").write_text(FILE.format(environment))
    path = os.pathsep.join([str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH")])])
    run = subprocess.run(
        [sys.executable, "-m", "lightflyer", "predict", str(tmp_path / "flyer.toml"), "--json"],
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    light, reflected, infrared, *_ = json.loads(run.stdout)["assumptions"]
    assert light.startswith("light: 14.8 W/m²")
    assert "0.2 of it (albedo)" in reflected
    assert "from below 2.3 W/m²" in infrared


def test_a_section_without_a_planet_asks_for_the_light():
    assert lf.environment.AltitudeSection.model_fields["irradiance"].is_required()
    for tag, section in lf.environment.EnvironmentSection.alternatives.items():
        assert not section.model_fields["irradiance"].is_required(), tag
