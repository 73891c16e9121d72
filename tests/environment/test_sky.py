"""Daylight by place and time: twilight against SPA and an ellipsoid, light on flyers, the file."""

import importlib.resources

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import xarray as xr
from pvlib import spa
from scipy import integrate, optimize

import lightflyer as lf
from lightflyer.environment import (
    EARTH_LIMB,
    Attitude,
    Daylight,
    GriddedGround,
    Knocke1988Ground,
    Place,
    UniformGround,
)
from lightflyer.environment.light.sky import describe_shadow
from lightflyer.environment.light.sun import sun_from_earth

J2000 = 946_728_000.0
SKY = Daylight()
EQUATORIAL, POLAR = 6_378_137.0, 6_356_752.3142


def ecef(latitude, altitude):
    """Position on the meridian of Greenwich, above the ellipsoid."""
    squared = 1.0 - (POLAR / EQUATORIAL) ** 2
    normal = EQUATORIAL / np.sqrt(1.0 - squared * np.sin(latitude) ** 2)
    return np.array([
        (normal + altitude) * np.cos(latitude),
        0.0,
        (normal * (1.0 - squared) + altitude) * np.sin(latitude),
    ])  # fmt: skip


def axes_at(latitude):
    east = np.array([0.0, 1.0, 0.0])
    north = np.array([-np.sin(latitude), 0.0, np.cos(latitude)])
    return east, north, np.cross(east, north)


def nearest_height(start, direction):
    """Least height of a straight ray above the ellipsoid, by Bowring's latitude."""

    def height(along):
        x, y, z = start + along * direction
        across = np.hypot(x, y)
        first = np.arctan2(z * EQUATORIAL, across * POLAR)
        squared = 1.0 - (POLAR / EQUATORIAL) ** 2
        second = squared / (1.0 - squared)
        latitude = np.arctan2(
            z + second * POLAR * np.sin(first) ** 3,
            across - squared * EQUATORIAL * np.cos(first) ** 3,
        )
        normal = EQUATORIAL / np.sqrt(1.0 - squared * np.sin(latitude) ** 2)
        return across * np.cos(latitude) + z * np.sin(latitude) - EQUATORIAL**2 / normal

    found = optimize.minimize_scalar(
        height, bounds=(0.0, 3e6), method="bounded", options={"xatol": 10.0}
    )
    return found.fun


def bending_of_grazing_ray(altitude):
    """Bending on both sides of the limb, as an integral over the straight ray."""
    lowest = 6.371e6 + EARTH_LIMB.height

    def slope(along):
        height = np.hypot(lowest, along) - lowest
        return (
            EARTH_LIMB.refractivity
            / EARTH_LIMB.scale_height
            * np.exp(-height / EARTH_LIMB.scale_height)
        )

    to_flyer = np.sqrt((6.371e6 + altitude) ** 2 - lowest**2)
    return integrate.quad(slope, -3e6, to_flyer, points=[0.0], limit=200)[0]


def light_is_left(time, latitude, altitude, bending):
    """Height by which the ray of the sun's centre passes above the limb [m], by SPA."""
    unix = time + J2000
    delta = spa.calculate_deltat(2026, 6)
    found = spa.solar_position(
        np.array([unix]), np.degrees(latitude), 0.0, 0.0, 0.0, 12.0, delta, 0.5667
    )[:, 0]
    zenith, azimuth = np.radians(found[1]) - bending, np.radians(found[4])
    east, north, up = axes_at(latitude)
    level = np.sin(azimuth) * east + np.cos(azimuth) * north
    direction = np.cos(zenith) * up + np.sin(zenith) * level
    lowest = EARTH_LIMB.height + EARTH_LIMB.refractivity * (6.371e6 + EARTH_LIMB.height)
    return nearest_height(ecef(latitude, altitude), direction) - lowest


@pytest.mark.parametrize(
    ("date", "degrees", "altitude"),
    [
        ("2026-03-20T12:00Z", 0.0, 75e3),
        ("2026-06-21T12:00Z", 45.0, 60e3),
        ("2026-12-21T12:00Z", 60.0, 90e3),
        ("2026-09-10T12:00Z", -75.0, 50e3),
    ],
)
def test_first_and_last_light_within_ten_seconds(date, degrees, altitude):
    place = Place.at(date, degrees, 0.0)
    hours = SKY.light_hours(altitude, place)
    bending = bending_of_grazing_ray(altitude)
    for found in (hours.first, hours.last):
        expected = optimize.brentq(
            light_is_left, found - 600.0, found + 600.0, xtol=0.1,
            args=(place.latitude, altitude, bending),
        )  # fmt: skip
        assert found == pytest.approx(expected, abs=10.0)
        # half of the sun's disk is up then
        assert SKY.radiation(altitude, place._replace(time=found)).visible == pytest.approx(
            0.5, abs=1e-5
        )
    assert hours.first < hours.noon < hours.last


def test_last_light_moves_with_the_latitude():
    place = Place.at("2026-06-21T12:00Z", 45.0, 0.0)
    sky = SKY.over(place.time - 86_400.0, place.time + 86_400.0)  # which compiles sooner

    def last(latitude):
        return sky.light_hours(75e3, place._replace(latitude=latitude)).last

    with lf.float64():
        _, slope = jax.jvp(last, (place.latitude,), (1.0,))
    change = (last(place.latitude + 1e-4) - last(place.latitude - 1e-4)) / 2e-4
    assert float(slope) == pytest.approx(change, rel=1e-5)


def test_days_and_nights_without_end():
    midsummer = Place.at("2026-06-21T12:00Z", np.array([85.0, -85.0]), 0.0)
    hours = SKY.light_hours(70e3, midsummer)
    assert np.isnan([hours.first, hours.last]).all()
    np.testing.assert_array_equal(hours.share, [1.0, 0.0])
    zenith = SKY.sun.position_above(midsummer._replace(time=hours.noon)).zenith_angle
    # noon is when the sun stands highest
    for moved in (-300.0, 300.0):
        aside = midsummer._replace(time=hours.noon + moved)
        assert np.all(SKY.sun.position_above(aside).zenith_angle > zenith)


EVENING = Place.at("2026-06-21T19:50Z", 45.0, 10.0)


def test_light_of_a_day():
    noon = SKY.radiation(70e3, Place.at("2026-01-03T12:00Z", 0.0, 0.0))
    assert noon.irradiance == pytest.approx(1361.0 / 0.9833**2, rel=1e-4)
    assert noon.visible == 1.0
    assert noon.infrared_below == 240.0
    dark = SKY.radiation(70e3, Place.at("2026-01-03T00:00Z", 0.0, 0.0))
    assert dark.visible == 0.0
    assert dark.lit_ground == 0.0
    for face in dark.on_faces()[:2]:
        assert face == 0.0
    # before the shadow reaches it, a level flyer is lit from below alone
    low = SKY.radiation(90e3, EVENING)
    light = low.on_faces()
    assert np.degrees(low.zenith_angle) == pytest.approx(96.28, abs=0.02)
    assert light.beam_top == 0.0
    assert light.beam_bottom == pytest.approx(-np.cos(low.zenith_angle), rel=1e-3)


@lf.entry_point
def on_faces(radiation, attitude):
    return radiation.on_faces(attitude)


def test_a_level_face_takes_the_light_of_a_disk_at_sunset():
    """Top and bottom together: what the upper and the lower part of the sun send."""
    radiation = lf.environment.Radiation(1000.0, np.pi / 2.0, angular_radius=0.0047)
    light = on_faces(radiation, None)
    assert light.beam_top == pytest.approx(0.0047 * 2.0 / (3.0 * np.pi), rel=1e-6)
    assert light.beam_bottom == pytest.approx(light.beam_top, rel=1e-6)
    turned = on_faces(radiation, Attitude(0.3, np.pi))
    assert turned.beam_bottom == pytest.approx(np.sin(0.3), rel=1e-6)


def test_light_is_smooth_through_the_evening(film):
    """Absorbed power over three hours around sunset: no jump of its slope."""
    disk = lf.Disk(film, 0.01)

    @lf.entry_point
    def power(time):
        radiation = SKY.radiation(75e3, EVENING._replace(time=time))
        state = lf.environment.EnvironmentState(2.4, 208.0, 9.6, lf.gas.AIR, radiation)
        return disk.beam_areas(state)[0] * radiation.irradiance + disk.heat_gains(state)[0]

    time = EVENING.time + np.linspace(-5400.0, 1800.0, 2881)
    values = power(time)
    for part in (slice(0, 1601), slice(1600, None)):  # sunset on level ground; in the flyer's sky
        # a slope that jumps does so between any two points around, however fine the grid
        slopes = [np.diff(values[part][::step]) / (2.5 * step) for step in (2, 1)]
        coarse, fine = (np.abs(slope[2:] - slope[:-2]).max() for slope in slopes)
        assert fine < 0.8 * coarse


def test_derivatives_of_the_sky_forwards_and_backwards():
    """Of all that a sky gives, by altitude, place and time; one by one as all at once."""
    start = np.array([75e3, 0.785, 0.175, EVENING.time + 640.0])
    steps = np.array([1.0, 1e-6, 1e-6, 0.1])
    names = ("zenith_angle", "azimuth", "visible", "lit_ground", "ground_view", "irradiance")
    sky = Daylight(ground=Knocke1988Ground())

    @lf.entry_point
    def light(where):
        altitude, *place = where
        radiation = sky.radiation(altitude, Place(*place))
        values = [getattr(radiation, name) for name in names]
        return jnp.stack([*values, radiation.albedo, radiation.infrared_below])

    assert 0.2 < light(start)[2] < 0.8  # the sun is setting
    with lf.float64():
        forwards, backwards = jax.jit(jax.jacfwd(light))(start), jax.jit(jax.jacrev(light))(start)
        together = jax.jit(jax.vmap(light))(jnp.stack([start, start + 10.0 * steps]))
    np.testing.assert_allclose(forwards, backwards, rtol=1e-10, atol=1e-14)
    # angles of 1e5 rad are rounded to 1e-11, and a setting sun magnifies that
    np.testing.assert_allclose(together[1], light(start + 10.0 * steps), rtol=1e-8)
    for column, step in enumerate(steps * np.eye(4)):
        change = (light(start + step) - light(start - step)) / (2.0 * steps[column])
        np.testing.assert_allclose(forwards[:, column], change, rtol=1e-4, atol=1e-9)


TEMPLATES = ("earth", "sandwich", "plate", "hollow", "balloon", "particle")


@pytest.mark.parametrize("kind", TEMPLATES)
def test_no_flyer_has_a_beam_in_the_shadow(kind):
    """Each kind's shipped file: half of the sun sends half of the beam, none none."""
    template = importlib.resources.files("lightflyer") / "data" / f"flyer-{kind}.toml"
    with importlib.resources.as_file(template) as path:
        flyer = lf.read_flyer_file(path).build().flyer

    @lf.entry_point
    def areas(visible):
        radiation = lf.environment.Radiation(1361.0, 1.8, visible=visible)
        return flyer.beam_areas(
            lf.environment.EnvironmentState(1.0, 220.0, 9.8, lf.gas.AIR, radiation)
        )

    whole = np.array(areas(1.0))
    assert whole.max() > 0.0
    np.testing.assert_allclose(areas(0.0), 0.0, atol=1e-12 * whole.max())
    np.testing.assert_allclose(areas(0.5), 0.5 * whole, rtol=1e-9, atol=1e-12 * whole.max())


def test_earth_without_a_place_is_as_before_and_with_one_has_its_light():
    given = lf.Earth(sky=SKY)
    with pytest.raises(lf.ConfigurationError, match="needs a place: date, latitude"):
        given.state(70e3)
    state = given.state(90e3, EVENING)
    assert state.radiation.visible == 1.0
    own = lf.Earth(sky=SKY, place=EVENING)
    assert own.state(90e3).radiation.zenith_angle == state.radiation.zenith_angle
    assert own.radiation.irradiance == state.radiation.irradiance
    told = own.assumptions()
    where = "at 45° N, 10° E on 2026-06-21 19:50 UTC"
    assert told[0] == f"light: 1318 W/m², 96.28° from the vertical, {where}"
    assert told[1].startswith("shadow: no sun up to 54.")
    assert "albedo: 0.29 everywhere" in told
    assert lf.Earth().planet is lf.environment.EARTH_PLANET
    assert lf.Chamber().planet is None


def test_knockes_ground_reflects_what_satellites_saw():
    ground = Knocke1988Ground()
    midwinter = "1981-12-22T00:00Z"
    equator, pole = (ground.albedo_at(Place.at(midwinter, degrees, 0.0)) for degrees in (0.0, 90.0))
    assert equator == pytest.approx(0.34 - 0.145)
    assert pole == pytest.approx(0.34 + 0.10 + 0.29)
    heat = ground.infrared_at(Place.at(midwinter, -90.0, 0.0))
    assert heat == pytest.approx(1361.0 / 4.0 * (0.68 + 0.07 - 0.18))
    # of the sunlight that falls on Earth in a year, within 0.01 of what newer measurements have
    sine = (np.arange(200) + 0.5) / 100.0 - 1.0
    time = np.arange(0.0, 365.25, 5.0) * 86_400.0
    place = Place(np.arcsin(sine)[:, None], 0.0, time)
    declination = np.arcsin(sun_from_earth(time).direction[:, 2])
    half_day = np.arccos(np.clip(-np.tan(place.latitude) * np.tan(declination), -1.0, 1.0))
    falls = half_day * sine[:, None] * np.sin(declination) + np.sqrt(
        1.0 - sine[:, None] ** 2
    ) * np.cos(declination) * np.sin(half_day)
    mean = np.sum(ground.albedo_at(place) * falls) / np.sum(falls)
    assert mean == pytest.approx(0.29, abs=0.015)


def grid_of(ground, **selected):
    """Monthly means of a ground, as a dataset."""
    months, latitude, longitude = (
        np.arange(1, 13), np.arange(-88.75, 90.0, 2.5), np.arange(1.25, 360.0, 5.0),
    )  # fmt: skip
    middles = ((months - 0.5) / 12.0 * 365.2425 - 0.5) * 86_400.0
    place = Place(np.radians(latitude)[:, None], np.radians(longitude), middles[:, None, None])
    dims = ("month", "lat", "lon")
    return xr.Dataset(
        {
            "albedo": (dims, ground.albedo_at(place)),
            "infrared": (dims, ground.infrared_at(place), {"units": "W m-2"}),
        },
        {"month": months, "lat": latitude, "lon": longitude},
    )


def test_a_dataset_stands_for_what_it_samples():
    ground = Knocke1988Ground()
    data = GriddedGround(grid_of(ground))
    rng = np.random.default_rng(3)
    place = Place(
        np.arcsin(rng.uniform(-1.0, 1.0, 500)), rng.uniform(-7.0, 7.0, 500),
        rng.uniform(0.0, 1e9, 500),
    )  # fmt: skip
    np.testing.assert_allclose(data.albedo_at(place), ground.albedo_at(place), atol=0.003)
    np.testing.assert_allclose(data.infrared_at(place), ground.infrared_at(place), atol=1.0)
    assert (
        data.describe()[0]
        == "albedo: 0.1893 to 0.7293, a dataset of months, 74 latitudes, 72 longitudes"
    )
    lit = Daylight(ground=data).radiation(7e4, EVENING)
    assert lit.albedo == pytest.approx(ground.albedo_at(EVENING), abs=0.003)


def test_data_that_end_say_so():
    dates = np.array(["2026-01-01", "2026-02-01"], "datetime64[ns]")
    data = xr.Dataset({"albedo": ("time", [20.0, 40.0], {"units": "%"})}, {"time": dates})
    ground = GriddedGround(data, otherwise=UniformGround(0.5, 200.0))
    within = Place.at("2026-01-16T12:00Z", 10.0, 20.0)
    assert ground.albedo_at(within) == pytest.approx(0.3)
    assert ground.infrared_at(within) == 200.0
    after = Place.at("2026-02-02T00:00Z", 10.0, 20.0)
    earth = lf.Earth(sky=Daylight(ground=ground))
    with pytest.raises(
        lf.ParameterError, match="albedo on the ground ends at 2026-02-01 00:00 UTC"
    ):
        earth.state(70e3, after)
    margin = earth.sky.margins(70e3, after)
    assert min(margin.values()) == -86_400.0
    with lf.float64():
        assert np.isnan(jax.jit(lambda place: ground.albedo_at(place))(after))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: d.rename(albedo="a", infrared="b"), "needs the variables albedo"),
        (lambda d: d.isel(lon=slice(0, 30)), "longitude of albedo must go once round"),
        (lambda d: d.isel(lat=slice(10, 60)), "latitude of albedo must reach"),
        (lambda d: d.isel(month=slice(0, 6)), "month of albedo must be the numbers 1 to 12"),
        (lambda d: 3.0 * d, "albedo = .* is not between 0 and 1"),
        (lambda d: d.assign(infrared=d.infrared * 100.0), "infrared = 2.4e.04 .* is unlikely"),
        (lambda d: d.rename(lat="y"), "has the dimension y, which is none of"),
        (lambda d: d.where(d.lat > 0), "missing values"),
        (lambda d: d.drop_vars("lat"), "the dimension lat has no coordinates"),
    ],
)
def test_unfit_data_are_refused_in_one_line(change, message):
    with pytest.raises(lf.ConfigurationError, match=message) as error:
        GriddedGround(change(grid_of(UniformGround(0.4, 240.0))))
    assert "\n" not in str(error.value)


SECTION = {
    "sun": "ephemeris", "date": "2026-06-21T12:00:00+02:00", "latitude": "45 deg",
    "longitude": "10 deg",
}  # fmt: skip


def file_of(film_section, **environment):
    return lf.FlyerFile(
        flyer={"diameter": "2 cm"}, film=film_section, environment=environment,
        force={"model": "lu2023", "force_error": 0},
    )  # fmt: skip


def test_a_file_may_state_date_and_place(film_section):
    file = file_of(film_section, **SECTION, limb_height="22 ± 4 km")
    earth = file.build().environment
    assert earth.place == Place.at("2026-06-21T10:00Z", 45.0, 10.0)
    assert earth.sky.limb.height == 22e3
    assert file.uncertainties() == {"environment.limb_height": 4e3}
    design = file.design()
    assert "environment.latitude" in design.quantities
    assert design.why_not_varied("environment.incidence") == "follows from date and place"
    # the light moves with the place
    north = design.build({"environment.latitude": 60.0}).environment
    assert north.radiation.zenith_angle > earth.radiation.zenith_angle
    zenith = float(earth.radiation.zenith_angle)
    assert file.environment.light_incidence == pytest.approx(zenith, rel=1e-10)
    midnight = file_of(film_section, **{**SECTION, "date": "2026-06-21T23:00:00Z"})
    assert 0.0 < midnight.environment.light_incidence < np.pi / 2.0
    zonal = file_of(film_section, **SECTION, ground="knocke1988").build().environment
    assert isinstance(zonal.sky.ground, Knocke1988Ground)
    mission = file_of(film_section, sun="ephemeris").build().environment
    assert mission.place is None


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"date": None}, "needs date; without date"),
        ({"sun": None}, "date has no effect without sun"),
        ({"irradiance": "1 kW/m^2"}, "irradiance has no effect beside sun"),
        ({"ground": "knocke1988", "albedo": 0.3}, "albedo has no effect beside ground"),
        ({"surroundings": "gas"}, "needs a number for the heat radiation from below"),
        ({"atmosphere": "lu2023"}, '"lu2023" has the light of the paper'),
        ({"sun": None, "date": None, "latitude": None, "longitude": None, "limb_height": "9 km"},
         "limb_height has no effect without sun"),
    ],
)  # fmt: skip
def test_light_of_the_file_is_stated_once(change, message, film_section):
    with pytest.raises(Exception, match=message):
        file_of(film_section, **{**SECTION, **change})


def test_shadow_in_words():
    said = describe_shadow(np.array([60e3, 70e3, 80e3]), np.array([0.0, 0.4, 1.0]))
    assert said == ("shadow: no sun up to 60.0 km, all of it from 80.0 km",)
