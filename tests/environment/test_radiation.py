"""Light and heat radiation on tilted faces, against brute force."""

import jax
import numpy as np
import pytest
from scipy import integrate

import lightflyer as lf
from lightflyer.environment import Attitude, Radiation, sunlight
from lightflyer.environment.horizon import ground_view_factor, sphere_view_factor

from ..conftest import FILM


def view_by_rings(tilt, straight_down):
    """The view factor as an integral over rings of the planet's disk, each in closed form."""

    def ring(angle):
        constant, swing = np.cos(tilt) * np.cos(angle), np.sin(tilt) * np.sin(angle)
        lit = np.arccos(np.clip(-constant / max(swing, 1e-300), -1.0, 1.0))
        return 2.0 * np.sin(angle) * (lit * constant + np.sin(lit) * swing) / np.pi

    edge = np.arcsin(np.sqrt(straight_down))
    touches = [x for x in (np.pi / 2.0 - tilt, tilt - np.pi / 2.0) if 0.0 < x < edge]
    return integrate.quad(ring, 0.0, edge, points=touches or None, epsabs=1e-11, limit=200)[0]


@pytest.mark.parametrize("straight_down", [1.0, 0.999, 0.978, 0.5, 0.01])
def test_view_factor_is_the_integral_over_the_planets_disk(straight_down):
    edge = np.arcsin(np.sqrt(straight_down))
    near = np.array([-1e-3, -1e-6, 0.0, 1e-6, 1e-3])
    angles = [
        *np.linspace(0.05, 3.1, 15),
        *(0.5 * np.pi - edge + near),
        *(0.5 * np.pi + edge - near),
    ]
    angles = np.clip(angles, 0.0, np.pi)
    expected = [view_by_rings(angle, straight_down) for angle in angles]
    np.testing.assert_allclose(ground_view_factor(angles, straight_down), expected, atol=1e-6)


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
    found = lf.statics.force_vector(tilted, slanted, model)
    np.testing.assert_allclose(found, force * vector(tilt, towards), rtol=1e-12)
    assert lf.lift(tilted, slanted, model) == pytest.approx(force * np.cos(tilt), rel=1e-12)
    # it takes more light to carry the weight with the vertical part
    assert (
        lf.levitate(tilted, slanted, model).irradiance
        > lf.levitate(level, straight, model).irradiance
    )


def test_incidence_of_a_flyer_file_is_that_of_a_level_disk_under_slanting_sun():
    def lift(incidence="30 deg", **flyer):
        setup = file_of(flyer, atmosphere="lu2023", incidence=incidence).build()
        return lf.lift(setup.flyer, setup.environment.state(72e3), setup.model)

    full = lift("0 deg")
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
                easiest_keys=("minimum_irradiance", "value_w_m2"),
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
    assert found.best.values["lift_over_weight"] == pytest.approx(
        lf.lift(disk, noon, model) / lf.statics.weight(disk, noon), rel=1e-9
    )


def light_from_a_round_earth(zenith, altitude, albedo=0.29, radius=6_356_766.0, rays=400_000):
    """Light on a level lower face per irradiance: rays down to a matt sphere under the sun."""
    rng = np.random.default_rng(7)
    sun = np.array([np.sin(zenith), 0.0, np.cos(zenith)])
    sine, turn = np.sqrt(rng.uniform(size=rays)), rng.uniform(0.0, 2.0 * np.pi, rays)
    down = np.stack([sine * np.cos(turn), sine * np.sin(turn), -np.sqrt(1.0 - sine**2)])
    height = radius + altitude
    along = -height * down[2]  # to the point of the ray that is nearest to the centre
    half_chord = radius**2 - height**2 + along**2
    hits = half_chord > 0.0
    distance = along[hits] - np.sqrt(half_chord[hits])
    ground = (np.array([[0.0], [0.0], [height]]) + distance * down[:, hits]) / radius
    lit = np.maximum(sun @ ground, 0.0)
    return albedo * lit.sum() / rays


@pytest.mark.parametrize("degrees", [0.0, 30.0, 60.0])
@pytest.mark.parametrize("altitude", [20e3, 80e3])
def test_reflected_sunlight_is_that_of_a_round_earth(degrees, altitude):
    zenith = np.radians(degrees)
    state = lf.Earth(radiation=sunlight(zenith_angle=zenith)).state(altitude)
    found = state.radiation.on_faces().beam_bottom
    # the far ground sees the sun lower than the ground below does: up to half a percent at 80 km
    assert found == pytest.approx(light_from_a_round_earth(zenith, altitude), rel=1e-2)


def test_the_ground_is_seen_from_the_altitude_unless_told():
    altitudes = np.array([0.0, 20e3, 80e3])
    seen = lf.Earth().state(altitudes).radiation.ground_view
    np.testing.assert_allclose(seen, [1.0, 0.99374, 0.97530], rtol=1e-5)
    told = lf.Earth(radiation=Radiation(albedo=0.3, ground_view=0.5)).state(80e3)
    assert told.radiation.ground_view == 0.5
    assert Radiation(albedo=0.3).on_faces().beam_bottom == pytest.approx(0.3)


def test_light_over_earth_warms_a_disk_by_what_arrives(film):
    """The absorbed power, from irradiances that are added up here."""
    film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.2, 0.8, 0.9, absorptance_bottom=0.4)
    disk, altitude, sigma = lf.Disk(film, 0.01), 80e3, 5.670374419e-8
    state = lf.Earth(radiation=sunlight(zenith_angle=np.radians(40.0))).state(altitude)
    view = (6356766.0 / (6356766.0 + altitude)) ** 2
    horizontal = 1361.0 * np.cos(np.radians(40.0))
    black = sigma * state.temperature**4
    expected = disk.area * (
        0.75 * horizontal
        + 0.4 * 0.29 * view * horizontal
        + 0.08 * (0.0 - black)
        + 0.2 * (240.0 * view - black)
    )
    found = lf.equilibrium(disk, state, lf.Lu2023()).absorbed_power
    assert found == pytest.approx(expected, rel=1e-12)


def test_environments_say_what_light_they_assume():
    earth = lf.Earth(radiation=sunlight(1300.0, np.radians(30.0), albedo=np.array([0.1, 0.5])))
    assert earth.assumptions() == (
        "light: 1300 W/m², 30° from the vertical",
        "reflected light: 0.1 to 0.5 of it (albedo), from below",
        "infrared: from above 0 W/m², from below 240 W/m²",
        "view factor of the ground: (R/(R+h))² at altitude h",
    )
    paper = (
        "light: 1360 W/m², 0° from the vertical",
        "reflected light: none",
        "infrared: black surroundings at the gas temperature",
    )
    assert lf.lu2023_earth().assumptions() == paper
    assert lf.Chamber(radiation=Radiation(1360.0)).assumptions() == paper
    mirror = Radiation(
        1500.0, albedo=0.8, diffuse_above=3.0, infrared_below=430.0, ground_view=0.25
    )
    assert lf.Chamber(radiation=mirror).assumptions() == (
        "light: 1500 W/m², 0° from the vertical, and diffuse 3 W/m² from above",
        "reflected light: 0.8 of it (albedo), from below",
        "infrared: from above black surroundings at the gas temperature, from below 430 W/m²",
        "view factor of the ground: 0.25",
    )


def file_of(flyer, **section):
    return lf.FlyerFile(
        flyer={"diameter": "2 cm", **flyer}, film=FILM, environment=section,
        force={"model": "lu2023"},
    )  # fmt: skip


def environment_of(**section):
    return file_of({}, **section).build().environment


def test_a_file_that_leaves_light_out_means_what_python_means():
    assert environment_of().assumptions() == lf.Earth().assumptions()
    assert environment_of(atmosphere="lu2023").assumptions() == lf.lu2023_earth().assumptions()
    chamber = environment_of(kind="chamber", temperature="293 K", irradiance="1 kW/m^2")
    assert chamber.assumptions() == lf.Chamber(radiation=Radiation(1000.0)).assumptions()
    as_the_paper = environment_of(albedo=0.0, surroundings="gas").radiation
    assert (as_the_paper.albedo, as_the_paper.infrared_above) == (0.0, None)
    half = environment_of(surroundings="gas", infrared_bottom="200 W/m^2").radiation
    assert (half.infrared_above, half.infrared_below) == (None, 200.0)
    told = environment_of(atmosphere="lu2023", albedo=0.3, surroundings="earth").radiation
    assert (told.albedo, told.infrared_above, told.infrared_below) == (0.3, 0.0, 240.0)


def test_surroundings_without_effect_are_refused():
    with pytest.raises(Exception, match="surroundings has no effect beside infrared_top"):
        environment_of(surroundings="gas", infrared_top="0 W/m^2", infrared_bottom="240 W/m^2")
    with pytest.raises(Exception, match="surroundings"):
        environment_of(surroundings="space")


def mean_over_sphere(function):
    """Mean of a function of the tilt and azimuth of a face, over all directions of its normal."""
    cosines, weights = np.polynomial.legendre.leggauss(200)
    azimuths = np.linspace(0.0, 2.0 * np.pi, 90, endpoint=False)
    tilt, azimuth = np.meshgrid(np.arccos(cosines), azimuths, indexing="ij")
    return np.sum(weights[:, None] * np.asarray(function(tilt, azimuth))) / (2.0 * azimuths.size)


@pytest.mark.parametrize("view", [0.97, 0.5])
def test_a_sphere_receives_the_mean_over_all_faces(view):
    radiation = lf.environment.Radiation(
        1000.0, 0.7, albedo=0.3, diffuse_above=50.0, infrared_above=20.0, infrared_below=240.0,
        ground_view=view,
    )  # fmt: skip

    def faces(tilt, azimuth):
        return radiation.on_faces(lf.environment.Attitude(tilt, azimuth))

    def infrared(tilt, azimuth):
        return radiation.infrared_excess(250.0, lf.environment.Attitude(tilt, azimuth))[0]

    with lf.float64():
        found = radiation.on_sphere()
        beam = mean_over_sphere(lambda *angles: faces(*angles).beam_top)
        diffuse = mean_over_sphere(lambda *angles: faces(*angles).diffuse_top)
        assert float(found.beam) == pytest.approx(beam, rel=1e-4)
        assert float(found.diffuse) == pytest.approx(diffuse, rel=1e-4)
        heat = float(radiation.infrared_excess_on_sphere(250.0))
        assert heat == pytest.approx(mean_over_sphere(infrared), rel=1e-4)


def test_view_factor_of_a_sphere():
    """A quarter of the solid angle where the planet fills a cone of 60 degrees to its axis."""
    with lf.float64():
        assert sphere_view_factor(0.75) == pytest.approx(0.25, rel=1e-14)
        assert sphere_view_factor(1.0) == 0.5
        assert sphere_view_factor(0.0) == 0.0
    # every direction counts once: sphere and planet alike lose nothing
    radiation = lf.environment.Radiation(1.0, infrared_above=300.0, infrared_below=300.0)
    with lf.float64():
        black = radiation.stefan_boltzmann * 200.0**4
        assert float(radiation.infrared_excess_on_sphere(200.0)) == pytest.approx(300.0 - black)
