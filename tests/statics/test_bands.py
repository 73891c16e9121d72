from typing import ClassVar

import jax.numpy as jnp
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.statics.bands import MOST_BANDS


@pytest.mark.parametrize("environment", [lf.Earth(), lf.Chamber()])
def test_edges_are_where_lift_equals_weight(disk, environment):
    """Altitudes, or pressures of a chamber."""
    model = lf.Lu2023()
    band = lf.levitation_band(disk, environment, model)
    for edge in (band.lower, band.upper):
        state = environment.state(edge)
        ratio = lf.lift(disk, state, model) / lf.statics.weight(disk, state)
        assert ratio == pytest.approx(1.0, abs=1e-8)
    inside = environment.state(0.5 * (band.lower + band.upper))
    assert lf.lift(disk, inside, model) > lf.statics.weight(disk, inside)


def test_a_range_that_begins_at_its_end(disk):
    """The edges came out exchanged."""
    with pytest.raises(lf.ParameterError, match=r"upper end of search_range = 0\.01 is not above"):
        lf.levitation_band(disk, lf.Chamber(), lf.Lu2023(), (1e3, 1e-2))


def test_many_flyers_at_once(film):
    radii = np.array([0.0025, 0.01, 0.02, 0.03])
    bands = lf.levitation_band(lf.Disk(film, radii), lf.lu2023_earth(), lf.Lu2023())
    np.testing.assert_array_equal(bands.exists, [True, True, True, False])
    assert np.isnan(bands.lower[3])
    one = lf.levitation_band(lf.Disk(film, 0.01), lf.lu2023_earth(), lf.Lu2023())
    assert bands.upper[1] == pytest.approx(one.upper, rel=1e-9)


def test_a_band_narrower_than_the_first_look_is_found(film):
    model, earth = lf.Lu2023(), lf.lu2023_earth()
    best = lf.levitation_band(lf.Disk(film, 0.01), earth, model)
    heights = np.linspace(best.lower, best.upper, 20001)
    most = lf.payload(lf.Disk(film, 0.01), earth.state(heights), model).max()
    just_light_enough = lf.Disk(film, 0.01, payload=most * (1 - 1e-5))
    band = lf.levitation_band(just_light_enough, earth, model)
    assert band.exists
    assert 0.0 < band.upper - band.lower < 100.0


def test_two_bands_are_told_apart(disk):
    class TwoLayers(lf.AbstractForceModel):
        """Pushes only near two pressures."""

        flyers: ClassVar = (lf.Disk,)

        def heat_loss(self, flyer, state, unknowns):
            return lf.FreeMolecular().heat_loss(flyer, state, unknowns)

        def force(self, flyer, state, unknowns):
            (excess,) = unknowns
            near = [jnp.exp(-(jnp.log(state.pressure / centre) ** 2)) for centre in (0.5, 50.0)]
            return 1e-4 * flyer.area * (1e3 * near[0] + 1e5 * near[1]) * excess

    bands = lf.statics.levitation_bands(disk, lf.lu2023_earth(), TwoLayers())
    assert bands.exists.shape == (MOST_BANDS,)
    np.testing.assert_array_equal(bands.exists, [True, True, False, False])
    assert bands.upper[0] < bands.lower[1]
    widest = lf.levitation_band(disk, lf.lu2023_earth(), TwoLayers())
    widths = bands.upper[:2] - bands.lower[:2]
    assert widest.lower == bands.lower[np.argmax(widths)]


def test_a_band_cut_by_the_searched_range_is_open(disk):
    band = lf.levitation_band(disk, lf.lu2023_earth(), lf.Lu2023(), (70e3, 75e3))
    assert (band.lower, band.upper) == (70e3, 75e3)
    assert band.lower_open
    assert band.upper_open


def test_edges_are_differentiable(film, require_derivatives):
    def lower_edge(light):
        earth = lf.lu2023_earth(light[0])
        return lf.levitation_band(lf.Disk(film, 0.01), earth, lf.Lu2023()).lower[None] / 1e3

    require_derivatives(lower_edge, np.array([1360.0]), rtol=1e-5, atol=1e-9)
