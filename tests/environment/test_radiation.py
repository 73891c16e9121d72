"""Light and heat radiation on tilted faces, against brute force."""

import jax
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.environment import Attitude, Radiation, ground_view_factor


def sampled_view(tilt, straight_down, rng, count=400_000):
    """Share of cosine-distributed rays from a face that hit the planet below."""
    azimuth = rng.uniform(0.0, 2.0 * np.pi, count)
    sine = np.sqrt(rng.uniform(0.0, 1.0, count))  # Lambert's law
    ray = np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), np.sqrt(1.0 - sine**2)])
    # the face's normal is tilted away from straight down
    downward = ray[2] * np.cos(tilt) + ray[0] * np.sin(tilt)
    return np.mean(downward > np.sqrt(1.0 - straight_down))


@pytest.mark.parametrize("straight_down", [1.0, 0.978, 0.5, 0.01])
@pytest.mark.parametrize("degrees", [0.0, 5.0, 30.0, 80.0, 90.0, 120.0, 179.0])
def test_view_factor_is_that_of_sampled_rays(degrees, straight_down, rng):
    tilt = np.radians(degrees)
    expected = sampled_view(tilt, straight_down, rng)
    assert ground_view_factor(tilt, straight_down) == pytest.approx(expected, abs=2.5e-3)


def test_view_factor_in_closed_form():
    angles = np.linspace(0.0, np.pi, 13)
    np.testing.assert_allclose(
        ground_view_factor(angles, 1.0), 0.5 * (1.0 + np.cos(angles)), atol=1e-6
    )
    # a sphere that is wholly in front of the face: the cosine law
    np.testing.assert_allclose(ground_view_factor(0.7, 0.1), 0.1 * np.cos(0.7), rtol=1e-14)
    assert ground_view_factor(3.0, 0.1) == 0.0
    # continuous where the sphere begins to set
    setting = np.arccos(np.sqrt(0.3)) + np.array([-1e-9, 1e-9])
    assert np.ptp(ground_view_factor(setting, 0.3)) < 1e-7


def test_view_factor_has_derivatives():
    with lf.float64():
        slope = jax.grad(ground_view_factor)(1.2, 0.9)
    step = 1e-6
    rise = ground_view_factor(1.2 + step, 0.9) - ground_view_factor(1.2 - step, 0.9)
    assert float(slope) == pytest.approx(rise / (2 * step), rel=1e-6)


def vector(polar, azimuth):
    return np.array(
        [np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)]
    )


@pytest.mark.parametrize("zenith", [0.0, 0.6, 1.4, 1.7])
@pytest.mark.parametrize(("tilt", "towards"), [(0.3, 0.0), (1.2, 2.0), (2.5, -1.0)])
def test_beam_on_a_tilted_flyer_is_a_scalar_product(zenith, tilt, towards):
    radiation = Radiation(1000.0, zenith, azimuth=0.4)
    light = radiation.on_faces(Attitude(tilt, towards))
    facing = vector(zenith, 0.4) @ vector(tilt, towards)
    assert light.beam_top == pytest.approx(max(facing, 0.0), abs=1e-6)
    assert light.beam_bottom == pytest.approx(max(-facing, 0.0), abs=1e-6)


@lf.entry_point
def on_faces(radiation, attitude):
    return radiation.on_faces(attitude)


def test_reflected_and_diffuse_light_reach_what_sees_them():
    radiation = Radiation(1000.0, 0.5, albedo=0.3, diffuse_above=40.0, ground_view=0.9)
    level, flat = on_faces(radiation, None), on_faces(radiation, Attitude())
    for one, other in zip(level, flat, strict=True):
        assert one == pytest.approx(other, rel=1e-12)
    assert level.beam_bottom == pytest.approx(0.3 * np.cos(0.5) * 0.9)
    assert level.diffuse_top == 40.0
    assert level.diffuse_bottom == pytest.approx(4.0)  # past the horizon
    over = on_faces(radiation, Attitude(np.pi))
    assert over.beam_top == pytest.approx(level.beam_bottom, rel=1e-9)
    assert over.beam_bottom == pytest.approx(level.beam_top, rel=1e-9)
    assert over.diffuse_top == pytest.approx(level.diffuse_bottom, rel=1e-9)


def test_a_sun_below_the_horizon_lights_the_lower_face(film):
    evening = Radiation(1000.0, np.radians(100.0), albedo=0.3)
    light = on_faces(evening, None)
    assert light.beam_top == 0.0
    assert light.beam_bottom == pytest.approx(np.sin(np.radians(10.0)))


def test_a_tilted_disk_is_pushed_along_its_axis(film):
    """Level light on a tilted disk: the same force as on a level one, turned with the disk."""
    tilt, towards, model = 0.4, 1.1, lf.Lu2023()
    level = lf.Disk(film, 0.01)
    tilted = lf.Disk(film, 0.01, attitude=Attitude(tilt, towards))
    straight, slanted = (
        lf.environment.EnvironmentState(
            3.0, 215.0, 9.8, lf.gas.AIR, Radiation(1000.0, zenith, towards)
        )
        for zenith in (0.0, tilt)
    )
    force = lf.lift(level, straight, model)
    found = lf.flight.force_vector(tilted, slanted, model)
    np.testing.assert_allclose(found, force * vector(tilt, towards), rtol=1e-12)
    assert lf.lift(tilted, slanted, model) == pytest.approx(force * np.cos(tilt), rel=1e-12)
    # it takes more light to carry the weight with the vertical part
    assert (
        lf.levitate(tilted, slanted, model).irradiance
        > lf.levitate(level, straight, model).irradiance
    )


def test_incidence_of_a_flyer_file_is_that_of_a_level_disk_under_slanting_sun():
    film = {"areal_density": "1 g/m^2", "absorptance": 0.75, "emittance": 0.08,
            "tac_top": 0.8, "tac_bottom": 0.9}  # fmt: skip
    sky = {"atmosphere": "lu2023", "incidence": "30 deg"}

    def lift(**flyer):
        setup = lf.FlyerFile(
            flyer={"diameter": "2 cm", **flyer}, film=film, environment=sky
        ).build()
        return lf.lift(setup.flyer, setup.environment.state(72e3), setup.model)

    facing = {**sky, "incidence": "0 deg"}
    straight = lf.FlyerFile(flyer={"diameter": "2 cm"}, film=film, environment=facing).build()
    full = lf.lift(straight.flyer, straight.environment.state(72e3), straight.model)
    assert lift(tilt="30 deg") == pytest.approx(full * np.cos(np.radians(30.0)), rel=1e-12)
    assert lift() < lift(tilt="15 deg")  # half way to the sun carries more


def test_own_environment_depends_on_place_and_time(film):
    """A user's planet: the sun goes round, the gas is uniform, and the wind blows east."""

    class Carousel(lf.environment.AbstractEnvironment):
        radiation: Radiation = Radiation(600.0)

        @property
        def coordinate(self):
            return lf.environment.Coordinate(
                name="altitude", unit="m", long_name="geometric altitude", lowest=0.0,
                highest=1e5, searched=(0.0, 1e5), logarithmic=False, shown_unit="km",
                points=(5e4,), easiest_keys=("minimum_irradiance", "value_w_m2"),
            )  # fmt: skip

        def state(self, coordinate, place=None):
            hour = 0.0 if place is None else place.time / 3600.0
            sun = Radiation(600.0, zenith_angle=abs(hour) * np.pi / 12.0)
            return lf.environment.EnvironmentState(
                pressure=20.0 + 0.0 * coordinate,
                temperature=210.0,
                gravity=3.7,
                gas=lf.gas.AIR,
                radiation=sun,
                wind=lf.environment.Wind(30.0, 0.0, 0.0),
            )

    disk, model = lf.Disk(film, 0.005), lf.Lu2023()
    noon, later = (
        Carousel().state(5e4, lf.environment.Place(0.0, 0.0, 3600.0 * hour)) for hour in (0.0, 4.0)
    )
    assert noon.wind.east == 30.0
    noon_power = lf.equilibrium(disk, noon, model).absorbed_power
    later_power = lf.equilibrium(disk, later, model).absorbed_power
    assert later_power == pytest.approx(noon_power * np.cos(np.pi / 3.0), rel=1e-12)
    found = lf.predict(disk, Carousel(), model)
    assert found.summary()["at"][0]["altitude_km"] == 50.0
    assert found.best.values["lift_over_weight"] == pytest.approx(
        lf.lift(disk, noon, model) / lf.weight(disk, noon), rel=1e-9
    )
