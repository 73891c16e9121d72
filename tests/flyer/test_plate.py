import numpy as np
import pytest

import lightflyer as lf

NUMBERS = {
    "radius": 4e-3, "channel_width": 50e-6, "channel_length": 500e-6, "spacing": 60e-6,
    "height": 100e-6, "wall_thickness": 50e-9, "wall_conductivity": 1.8,
}  # fmt: skip
AREA = np.pi * 4e-3**2
OPEN = 50.0 * 500.0 / (110.0 * 560.0)


@pytest.fixture
def films():
    top = lf.FilmProperties(
        1.5e-4, 0.05, 0.10, 0.20, 0.7, 0.8, transmittance=0.85, infrared_transmittance=0.4
    )
    bottom = lf.FilmProperties(2.0e-4, 0.60, 0.30, 0.05, 0.9, 0.6, transmittance=0.1)
    return top, bottom


@pytest.fixture
def plate(films):
    return lf.Plate(*films, **NUMBERS)


def state_at(temperature=250.0, **radiation):
    radiation = lf.environment.Radiation(**radiation)
    return lf.environment.EnvironmentState(30.0, temperature, 9.7, lf.gas.AIR, radiation)


def test_cells_make_the_plate(plate, films):
    """One channel with half of the film around it, counted by hand."""
    assert plate.open_fraction == pytest.approx(OPEN, rel=1e-14)
    section = 2.0 * (50e-6 + 500e-6) * 50e-9 / (110e-6 * 560e-6)
    assert plate.wall_fraction == pytest.approx(section, rel=1e-14)
    assert plate.own_mass == pytest.approx(AREA * (1.0 - OPEN) * 3.5e-4, rel=1e-14)
    with_walls = lf.Plate(*films, **NUMBERS, wall_density=3e3, payload=1e-9)
    walls = AREA * section * 100e-6 * 3e3
    assert with_walls.mass == pytest.approx(float(plate.own_mass) + walls + 1e-9, rel=1e-13)
    weighed = lf.Plate(*films, **NUMBERS, wall_density=3e3, areal_density=4.1e-4)
    assert weighed.own_mass == pytest.approx(AREA * 4.1e-4, rel=1e-14)
    assert plate.describe() == "plate of 8 mm"
    np.testing.assert_allclose(
        lf.Plate(*films, **(NUMBERS | {"channel_length": np.array([5e-4, 1e-3])})).open_fraction,
        [OPEN, 50.0 * 1000.0 / (110.0 * 1060.0)],
    )


def test_light_goes_straight_through_the_channels(films, plate):
    """The lower film sees what passes the upper one, and nothing of what enters a channel."""
    state = state_at(irradiance=1000.0)
    with lf.float64():
        top, bottom = plate.beam_areas(state)
    solid = AREA * (1.0 - OPEN)
    # between the films light goes to and fro; both reflect 0.1 and 0.3 of it there
    to_and_fro = 1.0 / (1.0 - 0.10 * 0.30)
    assert bottom == pytest.approx(solid * 0.85 * 0.60 * to_and_fro, rel=1e-12)
    assert top == pytest.approx(solid * 0.05 * (1.0 + 0.85 * 0.30 * to_and_fro), rel=1e-12)
    mirror = lf.FilmProperties(1.5e-4, 0.0, 0.1, 0.1, 0.8, 0.8)
    with lf.float64():
        shaded = lf.Plate(mirror, films[1], **NUMBERS).beam_areas(state)
    np.testing.assert_array_equal(np.array(shaded), 0.0)


def test_light_from_below_and_heat_are_those_of_two_films_with_holes(plate, films):
    state = state_at(
        irradiance=1000.0, zenith_angle=0.5, albedo=0.3, diffuse_above=20.0, infrared_below=240.0
    )
    sandwich = lf.Sandwich(
        *films, 4e-3, 100e-6, OPEN, 25e-6, 1.1e-3 * 50e-9 / (110e-6 * 560e-6), 1.8
    )
    with lf.float64():
        for mine, theirs in (
            (plate.heat_gains(state), sandwich.heat_gains(state)),
            (
                plate.heat_losses(state, (0.2, 0.4)),
                sandwich.heat_losses(state, (0.2, 0.4)),
            ),
        ):
            np.testing.assert_allclose(mine, theirs, rtol=1e-12)
        assert plate.heat_losses(state, (0.0, 0.0)) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"spacing": 0.0}, "spacing = 0 is not positive"),
        ({"height": -1e-4}, "height = -0.0001 is not positive"),
        ({"channel_width": 600e-6}, "channel_length is the long side of a channel"),
        ({"wall_thickness": 30e-6}, "wall_thickness must be less than half of spacing"),
        ({"channel_length": 7.98e-3}, "must not exceed the plate's diameter"),
        ({"areal_density": 0.0}, "areal_density = 0 is not positive"),
    ],
)
def test_impossible_numbers_raise(films, changed, message):
    with pytest.raises(lf.ParameterError, match=message):
        lf.Plate(*films, **(NUMBERS | changed))
