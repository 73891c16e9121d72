import dataclasses

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.array import tree
from lightflyer.film.optics.curve import NODES, EmittanceCurve
from lightflyer.flyer.sheets import Exitance, Sheet, net_gains, perforate

SIGMA = 5.670374419e-8


@pytest.fixture
def films():
    top = lf.FilmProperties(
        3.0e-4, 0.05, 0.10, 0.20, 0.7, 0.8, transmittance=0.85, infrared_transmittance=0.4
    )
    bottom = lf.FilmProperties(
        4.0e-4, 0.60, 0.30, 0.05, 0.9, 0.6, absorptance_bottom=0.5, transmittance=0.1
    )
    return top, bottom


@pytest.fixture
def sandwich(films):
    return lf.Sandwich(*films, 0.01, 1.2e-4, 0.4, 3e-5, 2e-4, 1.8)


def state_at(temperature=220.0, **radiation):
    radiation = lf.environment.Radiation(**radiation)
    return lf.environment.EnvironmentState(3.0, temperature, 9.7, lf.gas.AIR, radiation)


def followed(faces, open_fraction, sources, bounces=4000):
    """Follow radiation between two films with holes from bounce to bounce.

    ``faces`` has absorptance, transmittance and reflectance of the four faces from above;
    ``sources`` the irradiance from above and from below, then what the four faces emit. Returns
    what each film absorbs and what leaves upward and downward.
    """
    solid = 1.0 - open_fraction
    (a1, t1, r1), (a2, t2, r2), (a3, t3, r3), (a4, t4, r4) = faces
    above, below, *emitted = sources
    absorbed, out = np.zeros(2), np.array([emitted[0], emitted[3]], float)
    absorbed -= [emitted[0] + emitted[1], emitted[2] + emitted[3]]
    # from outside
    absorbed += [above * solid * a1, below * solid * a4]
    out += [above * solid * r1, below * solid * r4]
    down = above * (open_fraction + solid * t1) + emitted[1]
    up = below * (open_fraction + solid * t4) + emitted[2]
    for _ in range(bounces):
        absorbed += [up * solid * a2, down * solid * a3]
        out += [up * (open_fraction + solid * t2), down * (open_fraction + solid * t3)]
        down, up = up * solid * r2, down * solid * r3
    return absorbed, out


def random_faces(rng):
    """Absorptance, transmittance and reflectance of four faces, both of a film passing as much."""
    faces = []
    for _ in range(2):
        through = rng.uniform(0.0, 0.5)
        for absorbing in rng.uniform(0.0, 1.0 - through, 2):
            faces.append((absorbing, through, 1.0 - through - absorbing))
    return faces


def sheets_of(faces, open_fraction):
    (a1, t1, _), (a2, *_), (a3, t3, _), (a4, *_) = faces
    return perforate(a1, a2, t1, open_fraction), perforate(a3, a4, t3, open_fraction)


def test_radiation_between_sheets_is_the_sum_of_its_bounces(rng):
    for _ in range(20):
        faces, open_fraction = random_faces(rng), rng.uniform(0.0, 0.95)
        sources = rng.uniform(0.0, 100.0, 6)
        absorbed, out = followed(faces, open_fraction, sources)
        above, below, *emitted = sources
        with lf.float64():
            gains = net_gains(
                *sheets_of(faces, open_fraction),
                above,
                below,
                Exitance(*emitted[:2]),
                Exitance(*emitted[2:]),
            )
        np.testing.assert_allclose(gains, absorbed, rtol=1e-10, atol=1e-10)
        # nothing is lost: what came in from outside is absorbed or leaves again
        assert np.sum(gains) + np.sum(out) == pytest.approx(above + below, rel=1e-12)


def test_sheets_exchange_as_much_one_way_as_the_other(rng):
    """Black-body sources: what the top gains per emission of the bottom, and the reverse."""
    for _ in range(10):
        with lf.float64():
            top, bottom = sheets_of(random_faces(rng), rng.uniform(0.0, 0.9))
            hot_bottom = Exitance(bottom.absorptance_top, bottom.absorptance_bottom)
            hot_top = Exitance(top.absorptance_top, top.absorptance_bottom)
            upward, _ = net_gains(top, bottom, 0.0, 0.0, emitted_bottom=hot_bottom)
            _, downward = net_gains(top, bottom, 0.0, 0.0, emitted_top=hot_top)
            assert float(upward) == pytest.approx(float(downward), rel=1e-12)
            # all at one temperature within walls at that temperature: nobody gains
            still = net_gains(top, bottom, 1.0, 1.0, hot_top, hot_bottom)
        np.testing.assert_allclose(np.array(still), 0.0, atol=1e-15)


def test_known_cases_of_sheets():
    with lf.float64():
        # opaque plates without holes: the textbook's two grey plates
        top, bottom = perforate(0.2, 0.3, 0.0, 0.0), perforate(0.5, 0.1, 0.0, 0.0)
        gain, _ = net_gains(top, bottom, 0.0, 0.0, emitted_bottom=Exitance(0.5, 0.0))
        assert gain == pytest.approx(1.0 / (1.0 / 0.3 + 1.0 / 0.5 - 1.0), rel=1e-14)
        # nothing but holes
        nothing = perforate(0.5, 0.5, 0.2, 1.0)
        assert net_gains(nothing, nothing, 7.0, 3.0) == (0.0, 0.0)
        # perfect mirrors keep the light out, without dividing zero by zero
        mirror = Sheet(0.0, 0.0, 0.0, 0.0)
        assert net_gains(mirror, mirror, 7.0, 3.0) == (0.0, 0.0)


def test_absorbed_light_of_the_flyer(sandwich):
    """All kinds of light at once, followed from bounce to bounce."""
    state = state_at(
        irradiance=1000.0, zenith_angle=0.5, albedo=0.3, diffuse_above=20.0, infrared_below=240.0
    )
    visible = [
        (0.05, 0.85, 0.10), (0.05, 0.85, 0.10), (0.60, 0.10, 0.30), (0.50, 0.10, 0.40)
    ]  # fmt: skip
    infrared = [
        (0.10, 0.40, 0.50), (0.20, 0.40, 0.40), (0.30, 0.00, 0.70), (0.05, 0.00, 0.95)
    ]  # fmt: skip
    cosine, black = np.cos(0.5), SIGMA * 220.0**4
    beam, _ = followed(visible, 0.4, [cosine, 0.3 * cosine, 0, 0, 0, 0])
    diffuse, _ = followed(visible, 0.4, [20.0, 0.0, 0, 0, 0, 0])
    heat, _ = followed(infrared, 0.4, [0.0, 240.0 - black, 0, 0, 0, 0])
    area = np.pi * 0.01**2
    with lf.float64():
        np.testing.assert_allclose(sandwich.beam_areas(state), area * beam, rtol=1e-12)
        found = sandwich.heat_gains(state)
    np.testing.assert_allclose(found, area * (diffuse + heat), rtol=1e-12)


def test_tilted_sandwich_takes_light_from_the_side_it_faces(sandwich):
    state = state_at(irradiance=1000.0)
    half_turn = lf.environment.Attitude(np.pi)
    upside_down = dataclasses.replace(sandwich, attitude=half_turn)
    top, bottom = (
        dataclasses.replace(
            film,
            absorptance=film.absorptance_below,
            absorptance_bottom=film.absorptance,
            emittance_top=film.emittance_bottom,
            emittance_bottom=film.emittance_top,
        )
        for film in (sandwich.bottom, sandwich.top)
    )
    mirrored = dataclasses.replace(sandwich, top=top, bottom=bottom)
    with lf.float64():
        top, bottom = upside_down.beam_areas(state)
        np.testing.assert_allclose((bottom, top), mirrored.beam_areas(state), rtol=1e-12)


def test_heat_losses_are_those_of_absolute_temperatures(sandwich):
    temperature, excesses = 220.0, np.array([0.3, 0.7])
    state = state_at(temperature)
    infrared = [
        (0.10, 0.40, 0.50), (0.20, 0.40, 0.40), (0.30, 0.00, 0.70), (0.05, 0.00, 0.95)
    ]  # fmt: skip
    cold, (hot_top, hot_bottom) = temperature, temperature * (1.0 + excesses)
    emitted = 0.6 * SIGMA * np.array(
        [0.10 * hot_top**4, 0.20 * hot_top**4, 0.30 * hot_bottom**4, 0.05 * hot_bottom**4]
    )  # fmt: skip
    black = SIGMA * cold**4
    gained, _ = followed(infrared, 0.4, [black, black, *emitted])
    conducted = 2e-4 * 1.8 / 1.2e-4 * (hot_bottom - hot_top)
    expected = np.pi * 0.01**2 * (-gained + [-conducted, conducted])
    with lf.float64():
        np.testing.assert_allclose(sandwich.heat_losses(state, excesses), expected, rtol=1e-11)
        assert sandwich.heat_losses(state, (0.0, 0.0)) == (0.0, 0.0)
        # a billionth of the temperature: as linear as can be, to all digits
        tiny = np.array(sandwich.heat_losses(state, (1e-9, 3e-9))) / 1e-9
        small = np.array(sandwich.heat_losses(state, (1e-8, 3e-8))) / 1e-8
    np.testing.assert_allclose(tiny, small, rtol=1e-6)


def test_emittance_that_depends_on_temperature(sandwich):
    """A curve that is constant changes nothing; a rising one radiates more."""

    def with_curves(slope):
        curve = EmittanceCurve.through(np.full(NODES, 0.3))
        curve = tree.replace_at(lambda c: c.coefficients, curve, curve.coefficients.copy())
        curve.coefficients[-2] += slope
        curve.coefficients[-1] += 0.3 - np.asarray(curve(220.0))
        return tree.replace_at(lambda flyer: flyer.bottom.emittance_top, sandwich, curve)

    state = state_at()
    with lf.float64():
        grey = sandwich.heat_losses(state, (0.2, 0.5))
        np.testing.assert_allclose(
            with_curves(0.0).heat_losses(state, (0.2, 0.5)), grey, rtol=1e-12
        )
        assert with_curves(0.05).heat_losses(state, (0.2, 0.5))[1] > grey[1]
        assert with_curves(0.05).heat_losses(state, (0.0, 0.0)) == (0.0, 0.0)


def test_no_excess_is_above_the_bound(sandwich):
    """Even in vacuum, where radiation alone cools; exact where only the outer faces radiate."""
    state = state_at()
    inner = (lambda flyer: flyer.top.emittance_bottom, lambda flyer: flyer.bottom.emittance_top)
    dark = tree.replace_at(lambda flyer: [face(flyer) for face in inner], sandwich, [1e-9, 1e-9])
    for excess in (1e-9, 0.1, 3.0, -0.5):
        for flyer in (sandwich, dark):
            with lf.float64():
                power = sum(flyer.heat_losses(state, (excess, excess)))
                bound = flyer.highest_excess(state, power)
            assert abs(excess) <= float(bound) * (1.0 + 1e-14)
        assert float(bound) == pytest.approx(abs(excess), rel=1e-6)


def test_mass_and_description(sandwich, films):
    area = np.pi * 0.01**2
    assert sandwich.own_mass == pytest.approx(area * 0.6 * 7e-4, rel=1e-14)
    assert sandwich.describe() == "sandwich of 2 cm"
    held = lf.Sandwich(*films, 0.01, 1.2e-4, 0.4, 3e-5, 2e-4, 1.8, 1e-6, None, 3000.0)
    supports = area * 2e-4 * 1.2e-4 * 3000.0
    assert held.mass == pytest.approx(area * 0.6 * 7e-4 + supports + 1e-6, rel=1e-14)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"gap": 0.0}, "gap = 0 is not positive"),
        ({"open_fraction": 1.0}, "open_fraction = 1 is not between 0 and 0.999"),
        ({"hole_radius": 0.01}, "hole_radius must be smaller than the radius"),
        ({"support_fraction": 0.7}, "exceed 1 together"),
        ({"support_conductivity": -1.0}, "support_conductivity = -1 is not"),
    ],
)
def test_impossible_numbers_raise(films, changed, message):
    numbers = {
        "radius": 0.01, "gap": 1e-4, "open_fraction": 0.5, "hole_radius": 3e-5,
        "support_fraction": 1e-4, "support_conductivity": 1.8,
    }  # fmt: skip
    with pytest.raises(lf.ParameterError, match=message):
        lf.Sandwich(*films, **(numbers | changed))
