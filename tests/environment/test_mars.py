import dataclasses

import jax
import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.special import expn

import lightflyer as lf
from lightflyer.environment import Dust, MarsAtmosphere, Place, mars_sunlight
from lightflyer.environment.light.mars import (
    air_mass,
    distance_in_season,
    dusty_light,
    solar_longitude,
    sun_from_mars,
    two_stream_transmittance,
    zenith_angle_in_season,
)
from lightflyer.environment.mars import season_irradiance
from lightflyer.files.table import shipped_table

ASTRONOMICAL_UNIT = 149_597_870_700.0
# Mars by the NASA fact sheet: mass times gravitational constant [m³/s²], mean radius [m]
GM, RADIUS = 4.2828e13, 3389.5e3
GAS_CONSTANT = 8314.462618


@pytest.fixture(scope="module")
def mars():
    return lf.Mars()


@pytest.fixture(scope="module")
def table():
    rows = shipped_table("mars_cospar.csv").numbers
    return rows["altitude_km"] * 1e3, rows["temperature"], rows["pressure"]


def test_pressures_are_those_of_the_published_table(table):
    altitude, temperature, pressure = table
    air = MarsAtmosphere()
    np.testing.assert_allclose(air.temperature(altitude), temperature, rtol=1e-12)
    np.testing.assert_allclose(air.pressure(altitude), pressure, rtol=0.012)
    # the two that flyers are most asked for
    assert air.pressure(50e3) == pytest.approx(3.15, rel=5e-3)
    assert air.pressure(60e3) == pytest.approx(0.878, rel=5e-3)


def test_pressure_carries_the_weight_above():
    """Hydrostatic equilibrium, with gravity and the gas law written out once more."""
    air = MarsAtmosphere(temperature_offset=4.0)

    def slope(altitude, logarithm):
        del logarithm
        gravity = GM / (RADIUS + altitude) ** 2
        return [-43.49 * gravity / (GAS_CONSTANT * float(air.temperature(altitude)))]

    ends = np.array([5e3, 31.7e3, 64.2e3, 100e3])
    solved = solve_ivp(slope, (0.0, 100e3), [np.log(636.0)], t_eval=ends, max_step=2e3, rtol=1e-8)
    np.testing.assert_allclose(np.log(air.pressure(ends)), solved.y[0], atol=1e-3)
    state = lf.Mars().state(40e3)
    assert state.gravity == pytest.approx(GM / (RADIUS + 40e3) ** 2, rel=1e-4)
    density = state.gas.density(state.pressure, state.temperature)
    assert density == pytest.approx(43.49 * 10.6 / (GAS_CONSTANT * 162.4), rel=5e-3)


def test_offsets_broadcast_and_are_differentiable():
    offsets, altitudes = np.array([-6.0, 0.0, 6.0]), np.array([0.0, 47.3e3, 80e3])
    together = MarsAtmosphere(temperature_offset=offsets).pressure(altitudes[:, None])
    one = MarsAtmosphere(temperature_offset=6.0).pressure(47.3e3)
    assert together.shape == (3, 3)
    assert together[1, 2] == pytest.approx(one, rel=1e-13)
    with lf.float64():
        slope = jax.grad(lambda offset: MarsAtmosphere(temperature_offset=offset).pressure(47.3e3))
        found = slope(0.0)
    step = 1e-3
    ends = [MarsAtmosphere(temperature_offset=side * step).pressure(47.3e3) for side in (1, -1)]
    assert found == pytest.approx((ends[0] - ends[1]) / (2.0 * step), rel=1e-6)


def test_a_profile_of_ones_own():
    """An isothermal atmosphere in falling gravity has a closed form."""
    altitude = np.linspace(0.0, 80e3, 5)
    air = MarsAtmosphere.from_table(altitude, np.full(5, 170.0), 700.0)
    weight = GM * (1.0 / RADIUS - 1.0 / (RADIUS + 55e3))
    expected = 700.0 * np.exp(-43.49 * weight / (GAS_CONSTANT * 170.0))
    assert air.pressure(55e3) == pytest.approx(expected, rel=2e-4)
    assert air.altitude_range == (0.0, 80e3)
    with pytest.raises(lf.ParameterError, match="must increase from 0"):
        MarsAtmosphere.from_table(altitude + 1.0, np.full(5, 170.0), 700.0)
    with pytest.raises(lf.ParameterError, match="as many of each"):
        MarsAtmosphere.from_table(altitude, np.full(4, 170.0), 700.0)
    with pytest.raises(lf.ParameterError, match=r"altitude \[m\] = 131000"):
        lf.Mars().state(131e3)


# Direction and distance of the sun in the frame of Mars, from astropy 8.0.2: its positions of
# planets, and the pole and rotation of the IAU (2009). Seconds since 2000-01-01 12:00 UTC; unit
# vector; au.
ASTROPY = np.array(
    [
        (0.0, 0.705602, -0.567453, -0.424408, 1.391197),
        (142004707.2, -0.193452, 0.917252, 0.348175, 1.659377),
        (227460342.022786, -0.587692, -0.792781, -0.161604, 1.422855),
        (645649455.891481, 0.959309, 0.020099, -0.281644, 1.397016),
        (867169145.458260, -0.165207, -0.916864, 0.363410, 1.606538),
        (1499676597.127086, 0.928273, -0.354019, 0.113927, 1.594157),
    ]
)


def test_sun_of_mars_against_an_independent_ephemeris():
    time, *vector, distance = ASTROPY.T
    sun = sun_from_mars(time)
    apart = np.linalg.norm(sun.direction - np.stack(vector, axis=-1), axis=-1)
    assert np.degrees(apart).max() < 0.03
    np.testing.assert_allclose(sun.distance / ASTRONOMICAL_UNIT, distance, rtol=2e-4)


def test_season_has_the_published_check_value():
    # Mars24, worked example of 2000-01-06 00:00 UTC
    time = 4.5 * 86_400.0
    assert np.degrees(solar_longitude(time)) == pytest.approx(277.18758, abs=1e-3)
    found = sun_from_mars(time).distance / ASTRONOMICAL_UNIT
    assert found == pytest.approx(1.39358, rel=1e-5)


def test_sunlight_through_the_year():
    """490 W/m² at aphelion, 713 at perihelion: of an orbit from 1.381 to 1.666 au."""
    time = np.arange(0.0, 690.0) * 86_400.0
    light = 1361.0 / (sun_from_mars(time).distance / ASTRONOMICAL_UNIT) ** 2
    assert (light.min(), light.max()) == (
        pytest.approx(490.0, abs=1.0),
        pytest.approx(713.0, abs=1.0),
    )
    season = np.asarray(solar_longitude(time))
    np.testing.assert_allclose(season_irradiance(season), light, rtol=1e-3)
    mean, _ = quad(lambda days: np.interp(days, np.arange(690.0), light), 0.0, 686.98, limit=400)
    assert mars_sunlight().irradiance == pytest.approx(mean / 686.98, rel=1e-4)


def test_height_of_the_sun_by_latitude_and_local_time():
    for season, latitude, hour, expected in (
        (90.0, 25.19, 12.0, 0.0),
        (0.0, 40.0, 12.0, 40.0),
        (180.0, -70.0, 18.0, 90.0),
        (270.0, 50.0, 12.0, 75.19),
    ):
        angle = zenith_angle_in_season(np.radians(season), np.radians(latitude), hour)
        assert np.degrees(angle) == pytest.approx(expected, abs=0.02)
    assert distance_in_season(np.radians(71.0)) == pytest.approx(1.6660, rel=1e-4)
    with pytest.raises(lf.ConfigurationError, match="needs a solar_longitude"):
        mars_sunlight(latitude=10.0)


def test_the_sky_agrees_with_season_and_local_time(mars):
    """Daylight by date and place has the sun where season and true solar time put it."""
    over = dataclasses.replace(mars, sky=lf.environment.MARS_SKY, dust=None)
    place = Place(latitude=np.radians(10.0), longitude=0.3, time=812_345_678.0)
    state = over.state(60e3, place)
    position = sun_from_mars(place.time)
    east = np.arctan2(position.direction[1], position.direction[0])
    hour = 12.0 + np.degrees(place.longitude - east) / 15.0
    season = solar_longitude(place.time)
    expected = zenith_angle_in_season(season, place.latitude, hour)
    assert state.radiation.zenith_angle == pytest.approx(float(expected), abs=2e-4)
    assert state.radiation.ground_view == pytest.approx((3389.5 / 3449.5) ** 2, rel=1e-4)


def test_dust_column_is_conraths_integral():
    dust = Dust(optical_depth=0.7, fall_off=0.01)
    share = np.array([1.0, 0.3, 0.05, 0.01, 0.003])
    column = share * expn(2, 0.01 / share) / expn(2, 0.01)
    np.testing.assert_allclose(dust.depth_above(share), 0.7 * column, atol=2e-4 * 0.7)


def test_beam_through_dust_by_straight_geometry():
    """Vertical: exp(-τ). Grazing: the chord through an even shell, past the lowest point."""
    dust, distance = Dust(1.0), 3389.5e3
    down = dusty_light(dust, 0.4, 0.4, 1.0, distance)
    assert down.beam == pytest.approx(np.exp(-0.4), rel=1e-12)
    chord = np.sqrt((distance + 9e3) ** 2 - distance**2) / 9e3
    assert air_mass(0.0, distance) == pytest.approx(chord, rel=1e-12)
    below = [dusty_light(dust, 1e-3, 1e-3, cosine, distance).beam for cosine in (-1e-9, 1e-9)]
    assert below[0] == pytest.approx(below[1], rel=1e-9)


def monte_carlo_transmittance(depth, cosine, share, asymmetry, photons=40_000):
    """Photons through a level layer with the phase function of Henyey and Greenstein."""
    random = np.random.default_rng(3)
    height = np.full(photons, depth)  # optical height above the ground
    direction = np.tile([np.sqrt(1.0 - cosine**2), 0.0, -cosine], (photons, 1))
    passed = 0
    while height.size:
        height = height + direction[:, 2] * random.exponential(size=height.size)
        passed += np.count_nonzero(height <= 0.0)
        alive = (height > 0.0) & (height < depth) & (random.random(height.size) < share)
        height, direction = height[alive], direction[alive]
        root = (1.0 - asymmetry**2) / (1.0 + asymmetry * (2.0 * random.random(height.size) - 1.0))
        turn = (1.0 + asymmetry**2 - root**2) / (2.0 * asymmetry)
        angle = 2.0 * np.pi * random.random(height.size)
        helper = np.where(np.abs(direction[:, 2:]) < 0.9, [[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])
        first = np.cross(direction, helper)
        first /= np.linalg.norm(first, axis=1, keepdims=True)
        second = np.cross(direction, first)
        sideways = np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * second
        sine = np.sqrt(np.maximum(1.0 - turn**2, 0.0))[:, None]
        direction = turn[:, None] * direction + sine * sideways
    return passed / photons


@pytest.mark.parametrize(("depth", "cosine"), [(0.3, 1.0), (0.3, 0.5), (1.0, 0.7), (3.0, 1.0)])
def test_scattered_light_against_photons_followed_one_by_one(depth, cosine):
    found = two_stream_transmittance(depth, cosine, 0.92, 0.66)
    assert found == pytest.approx(monte_carlo_transmittance(depth, cosine, 0.92, 0.66), abs=0.02)


def test_surroundings_under_transformations(compiled, mars):
    """jit and vmap give what the plain call gives, and grad the difference quotient."""

    def light(altitude):
        radiation = mars.state(altitude).radiation
        return radiation.visible + radiation.scattered + mars.state(altitude).pressure

    altitudes = np.array([12.3e3, 44.4e3, 71.7e3])
    plain = light(altitudes)
    with lf.float64():
        found, slopes = compiled(jax.vmap(jax.value_and_grad(light)))(altitudes)
    np.testing.assert_allclose(found, plain, rtol=1e-12)
    assert slopes[0] == pytest.approx((light(12.31e3) - light(12.29e3)) / 20.0, rel=1e-5)


def test_dust_dims_low_flyers_and_not_high_ones(mars):
    clear = dataclasses.replace(mars, dust=None)
    low, high = mars.state(5e3).radiation, mars.state(55e3).radiation
    assert 0.7 < low.visible < 0.9
    assert 0.1 < low.scattered < 0.25
    faces, clear_faces = low.on_faces(), clear.state(5e3).radiation.on_faces()
    assert faces.beam_top == pytest.approx(float(low.visible + low.scattered))
    assert faces.beam_bottom == pytest.approx(float(clear_faces.beam_bottom), rel=5e-3)
    assert high.visible == pytest.approx(1.0, abs=2e-3)
    assert clear.state(5e3).radiation.visible is None
    text = " ".join(mars.assumptions())
    assert "dust: optical depth 0.3" in text
    assert "vibration of co2" in text
    assert "dust: none" in clear.assumptions()
    assert "COSPAR" in text


@pytest.fixture
def read(flyer_file):
    earth = (
        'kind = "earth"\natmosphere = "lu2023"\nirradiance = "1360 W/m^2"\nincidence = "0 deg"\n'
    )
    return lambda lines: lf.read_flyer_file(flyer_file(earth, f'kind = "mars"\n{lines}\n'))


def test_light_of_a_file_by_season_and_hour(read):
    design = read(
        'solar_longitude = "251 deg"\nlatitude = "-20 deg"\nlocal_time = "15 h"\n'
        'surface_pressure = "700 ± 50 Pa"\ngas = "co2-frozen"'
    ).design()
    radiation = design.setup.environment.radiation
    assert radiation.irradiance == pytest.approx(713.2, abs=0.5)
    # declination -23.7°: cos z = sin φ sin δ + cos φ cos δ cos 45°
    declination, latitude = np.arcsin(0.42565 * np.sin(np.radians(251.0))), np.radians(-20.0)
    cosine = np.sin(latitude) * np.sin(declination)
    cosine += np.cos(latitude) * np.cos(declination) * np.cos(np.pi / 4.0)
    assert np.cos(radiation.zenith_angle) == pytest.approx(cosine, rel=1e-6)
    assert design.uncertainties["environment.surface_pressure"] == 50.0
    assert "environment.irradiance" not in design.quantities
    assert design.setup.environment.gas.name == "co2-frozen"
    later = design.build({"environment.local_time": 12.0}).environment.radiation
    assert later.zenith_angle < radiation.zenith_angle


def test_light_of_a_file_by_date_and_place(read):
    lines = 'sun = "ephemeris"\ndate = 2026-06-21T12:00:00\nlatitude = "20 deg"\n'
    setup = read(f'{lines}longitude = "70 deg"').build()
    place = Place.at("2026-06-21T12:00Z", 20.0, 70.0)
    expected = lf.environment.MarsSun().position_above(place)
    radiation = setup.environment.radiation
    assert radiation.zenith_angle == pytest.approx(float(expected.zenith_angle), rel=1e-9)
    au = float(expected.distance) / ASTRONOMICAL_UNIT
    assert radiation.irradiance == pytest.approx(1361.0 / au**2, rel=1e-9)
    told = " ".join(setup.environment.assumptions())
    assert "2026-06-21 12:00" in told
    assert "limb of Mars" in told
    assert "dust" in told
    state, other = setup.environment.state(50e3), setup.environment.state(50e3, place)
    assert state.radiation.visible == pytest.approx(float(other.radiation.visible))


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ('irradiance = "500 W/m^2"\nsolar_longitude = "1 deg"', "irradiance has no effect beside"),
        ('latitude = "3 deg"', "latitude needs solar_longitude"),
        ('local_time = "3 h"', "local_time has no effect without latitude"),
        ('sun = "ephemeris"\ndate = 2026-01-01T00:00:00', "needs latitude, longitude as well"),
        ("date = 2026-01-01T00:00:00", "date has no effect without sun"),
        ('surroundings = "gas"\nsun = "ephemeris"\ndate = 2026-01-01T00:00:00\n'
         'latitude = "1 deg"\nlongitude = "2 deg"', "needs a number for the heat radiation"),
        ('gas = "air"', r":\d+: environment.gas"),
        ("dust_optical_depth = -1", r":\d+: environment.dust_optical_depth = -1"),
        ('solar_longitude = "400 deg"', "must be between 0 and 360 deg"),
    ],
)  # fmt: skip
def test_what_cannot_be_meant_is_refused(read, lines, message):
    with pytest.raises(lf.ConfigurationError, match=message):
        read(lines)
