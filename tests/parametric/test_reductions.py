"""What reductions keep, against all designs at once, and merged in any order."""

import itertools
from functools import reduce

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.array.transformations import compiled
from lightflyer.parametric.reductions import (
    RESOLUTION,
    Best,
    Front,
    Spread,
    histogram,
    quantiles,
)

RNG = np.random.default_rng(5)
# rounded, so that there are equals; with infinities and numbers beyond all cells
GAIN = np.round(RNG.normal(scale=10.0, size=600), 1)
GAIN[::7], GAIN[3], GAIN[5:7], GAIN[9:11] = np.nan, -0.0, (np.inf, -np.inf), (1e-30, -1e30)
COLUMNS = {"gain": GAIN, "cost": np.round(RNG.lognormal(size=600) * 5.0)}
COLUMNS["coarse"] = np.where(np.abs(GAIN) < 100.0, np.round(GAIN, -1), np.nan)
KNOWN = np.flatnonzero(np.isfinite(GAIN))
REDUCTIONS = [
    Best("gain", 50),
    Best("gain", 5, less_is_better=True),
    Best("gain", 1000),
    Front("gain", "cost"),
    Front("gain", "cost", less_gain_is_better=True, more_cost_is_better=True),
    Front("coarse", "cost"),
    Spread("gain"),
]


def parts(reduction, cuts):
    return [
        reduction.of_chunk({name: column[a:b] for name, column in COLUMNS.items()}, a)
        for a, b in itertools.pairwise(cuts)
    ]


def require_same(one, other):
    for name in one:
        np.testing.assert_array_equal(one[name], other[name])


@pytest.mark.parametrize("reduction", REDUCTIONS, ids=str)
def test_chunks_merge_to_the_whole_in_any_order_and_on_the_device(reduction):
    whole = reduction.of_chunk(COLUMNS, 0)
    divided = parts(reduction, [0, 0, 1, 100, 350, 600])
    require_same(whole, reduce(reduction.merge, divided[::-1], reduction.empty()))
    a, b, *rest = divided
    require_same(whole, reduction.merge(reduce(reduction.merge, rest, b), a))
    found = compiled(reduction.on_device)(COLUMNS, 0)
    assert reduction.is_whole(found)
    require_same(whole, reduction.merge(reduction.empty(), found))


@pytest.mark.parametrize("less", [False, True])
def test_best_designs_are_those_of_a_sorted_list(less):
    found = Best("gain", 20, less).of_chunk(COLUMNS, first=10**12)
    sign = -1.0 if less else 1.0
    expected = sorted(KNOWN.tolist(), key=lambda design: (-sign * GAIN[design], design))[:20]
    np.testing.assert_array_equal(found["designs"] - 10**12, expected)
    np.testing.assert_array_equal(found["values"], GAIN[expected])


@pytest.mark.parametrize("name", ["gain", "coarse"])
@pytest.mark.parametrize(("worth", "price"), [(1.0, 1.0), (-1.0, -1.0)])
def test_no_design_beats_one_of_the_front(name, worth, price):
    front = Front(name, "cost", worth < 0.0, price < 0.0).of_chunk(COLUMNS, 0)
    gain, cost = worth * COLUMNS[name], price * COLUMNS["cost"]
    known = np.flatnonzero(np.isfinite(gain))
    gains, costs = gain[known], cost[known]
    at_least = (gains[:, None] >= gains) & (costs[:, None] <= costs)
    better = at_least & ((gains[:, None] > gains) | (costs[:, None] < costs))
    # of equals the first
    expected = {(gain[n], cost[n]): n for n in known[~better.any(axis=0)][::-1]}
    assert sorted(front["designs"]) == sorted(expected.values())


def test_a_front_above_the_capacity_says_so():
    line = {"gain": np.arange(50.0), "cost": np.arange(50.0)}
    with lf.float64():
        found = Front("gain", "cost", capacity=49).on_device(line, 0)
        assert not Front("gain", "cost", capacity=49).is_whole(found)
        assert Front("gain", "cost", capacity=50).is_whole(
            Front("gain", "cost", capacity=50).on_device(line, 0)
        )


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e9])
def test_quantiles_are_those_of_the_values_to_the_resolution(scale):
    values = scale * RNG.normal(size=4001)
    spread = Spread("x").of_chunk({"x": values}, 0)
    shares = np.array([0.0, 1e-4, 0.025, 0.3, 0.5, 0.77, 0.975, 1.0])
    exact = np.quantile(values, shares, method="inverted_cdf")
    np.testing.assert_allclose(quantiles(spread, shares), exact, rtol=0.5 * RESOLUTION)
    assert quantiles(spread, [0.0, 1.0]).tolist() == [values.min(), values.max()]
    edges = np.linspace(-3.0, 3.0, 25) * scale
    moved = np.abs(histogram(spread, edges) - np.histogram(values, edges)[0])
    assert moved.max() <= 4  # cells that an edge divides
    assert moved.sum() < 0.01 * values.size


def test_a_spread_without_values_has_no_quantiles():
    spread = Spread("x").of_chunk({"x": np.full(3, np.nan)}, 0)
    assert np.isnan(quantiles(spread, [0.5])).all()
    assert int(spread["missing"]) == 3
    assert histogram(spread, [0.0, 1.0]).tolist() == [0]


def test_numbers_beyond_all_cells_are_counted_at_the_ends():
    spread = Spread("x").of_chunk({"x": np.array([-1e300, -1e-300, 0.0, 1e-300, 1e300])}, 0)
    assert int(spread["counts"].sum()) == 5
    assert quantiles(spread, [0.2, 0.4, 0.6, 0.8, 1.0]).tolist() == [-1e300, 0.0, 0.0, 0.0, 1e300]
