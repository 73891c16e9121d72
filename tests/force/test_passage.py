"""Molecules through two perforated membranes, by following them one by one."""

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.core.errors import ParameterError
from lightflyer.force.laws.membrane_transmission import passage

OUTER, INNER = (0.7, 0.9), (0.8, 0.6)  # of the top, the bottom membrane
NOBODY, TOP, BOTTOM = 0, 1, 2


def followed(beta, from_above, count=200_000):
    """Whether molecules from one side leave below, and which membrane warmed them last.

    In a gap much wider than the holes a molecule meets the next membrane anywhere.
    """
    dice = np.random.default_rng(7)
    near = 0 if from_above else 1
    inside = dice.random(count) < beta
    warmed = np.where(~inside & (dice.random(count) < OUTER[near]), near + 1, NOBODY)
    down, below = np.full(count, from_above), np.full(count, not from_above)
    while inside.any():
        leaves = inside & (dice.random(count) < beta)
        below[leaves] = down[leaves]
        inside &= ~leaves
        tac, membrane = np.where(down, INNER[1], INNER[0]), np.where(down, BOTTOM, TOP)
        warms = inside & (dice.random(count) < tac)
        warmed[warms] = membrane[warms]
        down = down ^ inside
    return below, warmed


@pytest.mark.parametrize("beta", [0.2, 0.5, 0.8])
def test_wide_gap_as_molecules_see_it(beta):
    found = passage("wide", beta, OUTER, INNER)
    sides = followed(beta, True), followed(beta, False)
    noise = 5.0 * 0.5 / np.sqrt(sides[0][0].size)
    passed = found.open_fraction
    assert passed == pytest.approx(beta / (2.0 - beta), rel=1e-14)
    assert sides[0][0].mean() == pytest.approx(passed, abs=noise)
    assert 1.0 - sides[1][0].mean() == pytest.approx(passed, abs=noise)

    def leaving(plane_below, membrane):
        return sum(
            np.mean((below == plane_below) & (warmed == membrane)) for below, warmed in sides
        )

    assert leaving(False, TOP) == pytest.approx(found.top, abs=noise)
    assert leaving(False, BOTTOM) == pytest.approx(found.top_by_bottom, abs=noise)
    assert leaving(True, BOTTOM) == pytest.approx(found.bottom, abs=noise)
    assert leaving(True, TOP) == pytest.approx(found.bottom_by_top, abs=noise)


def test_wide_gap_between_black_sheets():
    """Two sheets that accommodate completely: what drives the force falls with the square of s."""
    for beta in (0.0, 0.3, 0.9):
        found = passage("wide", beta, (1.0, 1.0), (1.0, 1.0))
        solid = 1.0 - beta
        assert found.odd == pytest.approx(solid**2, rel=1e-12)
        assert found.even == pytest.approx(1.0 - beta**2, rel=1e-12)
        assert found.tac == pytest.approx(1.0, rel=1e-12)


def test_without_holes_both_ways_are_one():
    aligned, wide = (passage(way, 0.0, OUTER, INNER) for way in ("aligned", "wide"))
    assert aligned == pytest.approx(wide, rel=1e-12)


@pytest.mark.parametrize("way", ["aligned", "wide"])
def test_heat_of_free_molecules_is_what_they_carry_away(way):
    found, excess = passage(way, 0.4, OUTER, INNER), (0.2, 0.7)
    assert sum(found.heat(excess, 0.0, 0.0)) == pytest.approx(sum(found.emission(*excess)))


@pytest.mark.parametrize("way", ["aligned", "wide"])
def test_gas_as_warm_as_the_membranes_takes_nothing(way):
    """All that leaves both planes, and nothing of their difference, comes back at one excess."""
    found = passage(way, 0.4, (0.8, 0.8), (0.7, 0.7))
    top, bottom = found.heat((0.3, 0.3), 1.0 / found.even, 0.2)
    assert abs(top) < 1e-15
    assert abs(bottom) < 1e-15


def test_other_ways_are_refused():
    with pytest.raises(ParameterError, match='transmission = "broad" is unknown; choose from'):
        lf.Schafer2025(transmission="broad")
