"""Geometry, mass, light and heat radiation of hollow bodies."""

import numpy as np
import pytest
from scipy.integrate import quad

import lightflyer as lf
from lightflyer.array import tree
from lightflyer.environment.horizon import ground_view_factor

SIGMA = 5.670374419e-8
SIZE, OUTLET = 0.1, 0.02


@pytest.fixture
def films():
    outer = lf.FilmProperties(
        3.0e-4, 0.10, 0.80, 0.15, 0.9, 0.8, absorptance_bottom=0.2, transmittance=0.7,
        infrared_transmittance=0.1,
    )  # fmt: skip
    inner = lf.FilmProperties(
        6.0e-4, 0.60, 0.20, 0.05, 0.85, 0.95, transmittance=0.2, infrared_transmittance=0.3
    )
    return outer, inner


def make(films, form="sphere", **changed):
    numbers = {
        "size": SIZE, "outlet_radius": OUTLET, "open_fraction": 0.4, "channel_width": 2e-4,
        "wall_thickness": 1e-4, "sheet_thickness": 5e-8, "sheet_conductivity": 1.8,
    }  # fmt: skip
    return lf.HollowBody(*films, form=form, **(numbers | changed))


def state_at(temperature=220.0, **radiation):
    radiation = lf.environment.Radiation(**radiation)
    return lf.environment.EnvironmentState(3.0, temperature, 9.7, lf.gas.AIR, radiation)


def profile(form):
    """Height of the outlet and the top, and the radius in between as a function of the height."""
    radius = 0.5 * SIZE
    if form == "cone":
        return 0.0, SIZE, lambda z: OUTLET + (radius - OUTLET) * z / SIZE
    if form == "sphere":
        return -np.sqrt(radius**2 - OUTLET**2), radius, lambda z: np.sqrt(radius**2 - z**2)
    end = SIZE + OUTLET
    return (
        0.0,
        end,
        lambda z: OUTLET if z < SIZE else np.sqrt(max(OUTLET**2 - (z - SIZE) ** 2, 0.0)),
    )


@pytest.mark.parametrize("form", ["cone", "sphere", "rocket"])
def test_geometry_is_that_of_the_turned_profile(films, form):
    low, high, radius = profile(form)
    breaks = [SIZE] if form == "rocket" else None
    volume, _ = quad(lambda z: np.pi * radius(z) ** 2, low, high, points=breaks)
    body = make(films, form)
    with lf.float64():
        assert float(body.volume) == pytest.approx(volume, rel=1e-8)

    def element(z):
        step = 1e-7 * SIZE
        slope = (radius(z + step) - radius(z - step)) / (2.0 * step)
        return 2.0 * np.pi * radius(z) * np.sqrt(1.0 + slope**2)

    # a sphere's zones have areas as their heights; the poles would make the profile too steep
    poles = {"cone": 0.0, "sphere": 1e-4, "rocket": 1e-4}[form]
    top = {"sphere": 0.5 * SIZE, "rocket": OUTLET}.get(form, 0.0)
    inside = 1e-6 * SIZE
    surface, _ = quad(element, low + inside, high - poles, points=breaks, limit=500)
    surface += 2.0 * np.pi * top * poles
    if form == "cone":
        surface += np.pi * (0.5 * SIZE) ** 2  # the lid
    with lf.float64():
        assert float(body.surface) == pytest.approx(surface, rel=1e-4)
        seen = {"cone": 0.5 * SIZE, "sphere": 0.5 * SIZE, "rocket": OUTLET}[form]
        assert float(body.area) == pytest.approx(np.pi * seen**2, rel=1e-12)


@pytest.mark.parametrize("form", ["cone", "sphere", "rocket"])
def test_silhouette_over_all_directions_is_a_quarter_of_the_surface(films, form):
    """Cauchy: true of every convex body, the outlet being a part of its surface."""
    body = make(films, form)
    with lf.float64():
        cosines = np.polynomial.legendre.leggauss(400)
        seen = body.geometry.silhouette(SIZE, OUTLET, cosines[0])
        mean = 0.5 * float(np.sum(cosines[1] * np.asarray(seen)))
        whole = float(body.surface + body.outlet_area)
    assert mean == pytest.approx(0.25 * whole, rel=1e-5)


def followed(films, open_fraction, outlet_share, above, within, bounces=3000):
    """Follow light from bounce to bounce through two films and the body, all per area of wall.

    ``outlet_share`` of what flies about within the body comes to the outlet.
    """
    (outer, inner), solid = films, 1.0 - open_fraction
    reflect = {
        "outer": 1.0 - outer.absorptance_below - outer.transmittance,
        "inner": 1.0 - inner.absorptance - inner.transmittance,
        "inside": 1.0 - inner.absorptance_below - inner.transmittance,
    }
    absorbed = np.zeros(2)  # by the inner and the outer film
    absorbed[1] += above * solid * outer.absorptance
    inward, outward = above * solid * outer.transmittance, 0.0  # between the films
    body = within + above * open_fraction
    for _ in range(bounces):
        come, body = body * (1.0 - outlet_share), 0.0
        # within the body: channels pass it, the inner film absorbs, passes and reflects it
        absorbed[0] += come * solid * inner.absorptance_below
        outward_new = come * solid * inner.transmittance
        body += come * solid * reflect["inside"]
        # between the films
        absorbed[0] += inward * inner.absorptance
        body += inward * inner.transmittance
        outward_new += inward * reflect["inner"]
        absorbed[1] += outward * outer.absorptance_below
        inward = outward * reflect["outer"]
        outward = outward_new
    return absorbed


def test_light_is_the_sum_of_its_bounces(films):
    body = make(films)
    state = state_at(irradiance=1000.0)
    with lf.float64():
        surface, outlet = float(body.surface), float(body.outlet_area)
        found = np.asarray(body.beam_areas(state))
    seen = np.pi * (0.5 * SIZE) ** 2
    expected = surface * followed(films, 0.4, outlet / (surface + outlet), seen / surface, 0.0)
    np.testing.assert_allclose(found, expected, rtol=1e-10)
    # from straight below: the outlet lets some of it in
    with lf.float64():
        found = np.asarray(body.beam_areas(state_at(irradiance=1000.0, zenith_angle=np.pi)))
    share = outlet / (surface + outlet)
    expected = surface * followed(films, 0.4, share, (seen - outlet) / surface, outlet / surface)
    np.testing.assert_allclose(found, expected, rtol=1e-10)


def elements(form):
    """Area and inclination to the axis of rings of the wall, from the profile."""
    low, high, radius = profile(form)
    fine = np.sin(np.linspace(0.0, 0.5 * np.pi, 600))  # towards the pole
    z = low + (high - low) * fine
    if form == "rocket":
        z = np.concatenate([np.linspace(low, SIZE, 9)[:-1], SIZE + OUTLET * fine])
    at = np.array([radius(min(place, high)) for place in z])
    rise, spread = np.diff(z), np.diff(at)
    areas = np.pi * (at[1:] + at[:-1]) * np.hypot(rise, spread)
    inclination = np.arctan2(rise, -spread)
    if form == "cone":
        return np.append(areas, np.pi * (0.5 * SIZE) ** 2), np.append(inclination, 0.0)
    return areas, inclination


@pytest.mark.parametrize("tilt", [0.0, 0.8])
@pytest.mark.parametrize("form", ["cone", "sphere", "rocket"])
def test_light_of_sky_and_ground_by_elements_of_the_wall(films, form, tilt):
    """Each sees what a flat face there sees; a convex body does not shade itself."""
    areas, inclination = elements(form)
    azimuth = np.pi * (np.arange(48) + 0.5) / 48
    upward, sideways = np.cos(inclination)[:, None], np.sin(inclination)[:, None]
    cosine = upward * np.cos(tilt) + sideways * np.sin(tilt) * np.cos(azimuth)  # of each normal
    attitude = lf.environment.Attitude(tilt) if tilt else None
    body = make(films, form, attitude=attitude)
    for view, within in ((1.0, 2e-4), (0.994, 3e-4), (0.975, 3e-4), (0.3, 5e-3)):
        seen = np.mean(ground_view_factor(np.arccos(-cosine), view), axis=1)
        expected = 3.0 * np.sum(areas * (1.0 - seen)) + 2.0 * np.sum(areas * seen)
        radiation = lf.environment.Radiation(ground_view=view)
        with lf.float64():
            views = body._views_of_ground(radiation)
            wall, outlet = body._incident_powers(
                lf.environment.radiation.Exitances(3.0, 2.0), *views
            )
            flat = float(ground_view_factor(tilt, view))
        assert float(wall) == pytest.approx(expected, rel=within)
        assert float(outlet) == pytest.approx(np.pi * OUTLET**2 * (3.0 - flat), rel=1e-12)


@pytest.mark.parametrize("form", ["cone", "sphere", "rocket"])
def test_heat_radiation_in_equilibrium(films, form):
    body = make(films, form)
    black = SIGMA * 220.0**4
    inside = state_at(infrared_above=black, infrared_below=black, irradiance=0.0)
    with lf.float64():
        np.testing.assert_allclose(body.heat_gains(inside), 0.0, atol=1e-12)
        assert tuple(map(float, body.heat_losses(inside, (0.0, 0.0)))) == (0.0, 0.0)
        # walls at 250 K around a body at 250 K in gas at 220 K: nobody gains
        warm = SIGMA * 250.0**4
        around = state_at(infrared_above=warm, infrared_below=warm)
        gains = np.asarray(body.heat_gains(around))
        losses = np.asarray(body.heat_losses(around, (250.0 / 220.0 - 1.0,) * 2))
    np.testing.assert_allclose(gains, losses, rtol=1e-10)
    assert np.all(gains > 0.0)


def test_films_exchange_as_much_one_way_as_the_other(films):
    body = make(films)
    with lf.float64():
        inner_warm = body.heat_losses(state_at(), (1e-6, 0.0))
        outer_warm = body.heat_losses(state_at(), (0.0, 1e-6))
    assert float(inner_warm[1]) == pytest.approx(float(outer_warm[0]), rel=1e-5)
    assert float(inner_warm[1]) < 0.0


def test_mass_and_buoyancy(films):
    body = make(films, sheet_density=3950.0, payload=1e-6)
    with lf.float64():
        surface, volume = float(body.surface), float(body.volume)
        own = float(body.own_mass)
        lifted = float(body.buoyancy(state_at(), (0.5, 0.1)))
    # sheets: those of channels of 0.2 mm by 2 mm, 50 nm thick, between the faces
    section = (2e-4 + 1e-7) * (2e-3 + 1e-7) - 2e-4 * 2e-3
    sheets = 3950.0 * 0.4 / (2e-4 * 2e-3) * section * (1e-4 - 1e-7)
    assert own == pytest.approx(surface * (0.6 * 9e-4 + sheets), rel=1e-9)
    density = 3.0 / (lf.gas.AIR.specific_gas_constant * 220.0)
    assert lifted == pytest.approx(density * 9.7 * volume * (1.0 - 1.0 / 1.5), rel=1e-12)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"outlet_radius": 0.05}, "the outlet must be smaller than the sphere"),
        ({"open_fraction": 0.0}, "open_fraction must be positive"),
        ({"open_fraction": 1.0}, "open_fraction = 1 is not between 0 and 0.999"),
        ({"open_fraction": 0.95, "sheet_thickness": 1e-5}, "take more than the whole wall"),
        ({"wall_thickness": 0.05}, "wall_thickness must be smaller than the radius"),
        ({"wall_thickness": 1e-7}, "wall_thickness must exceed twice sheet_thickness"),
        ({"channel_width": 0.01}, "channels must be narrower than the sphere"),
        ({"channel_aspect": 0.5}, "channel_aspect must be 1 at least"),
        ({"size": -0.1}, "size = -0.1 is not positive"),
        ({"form": "cube"}, 'form = "cube" is unknown; choose from cone, sphere, rocket'),
    ],
)
def test_impossible_numbers_raise(films, changed, message):
    form = changed.pop("form", "sphere")
    with pytest.raises(lf.ParameterError, match=message):
        make(films, form, **changed)


def test_a_rocket_may_be_as_wide_as_it_is_long(films):
    assert make(films, "rocket", outlet_radius=0.08).describe() == "hollow rocket of 10 cm"


def test_tilt_turns_the_light(films):
    """A cone on its side in vertical light shows its side."""
    lying = tree.replace_at(
        lambda body: body.attitude,
        make(films, "cone"),
        lf.environment.Attitude(0.5 * np.pi),
    )
    state = state_at(irradiance=1000.0)
    with lf.float64():
        upright = np.asarray(make(films, "cone").beam_areas(state))
        found = np.asarray(lying.beam_areas(state))
    side, lid = (0.5 * SIZE + OUTLET) * SIZE, np.pi * (0.5 * SIZE) ** 2
    np.testing.assert_allclose(found / upright, side / lid, rtol=1e-7)
