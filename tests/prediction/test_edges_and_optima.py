import numpy as np
import pytest

from lightflyer.prediction.evaluator import find_edges_and_optima, find_usable
from lightflyer.statics.grid_refinement import (
    band_brackets,
    band_count,
    crossing,
    peak,
    rows_around,
)


def bell(places):
    return np.exp(1.0 - (places - 5.2) ** 2 / 4.0)


def test_edges_of_known_curves():
    lower, upper = crossing(lambda x: bell(x) - 1.0, [0.0, 10.0], [5.0, 5.0])
    assert lower == pytest.approx(3.2, rel=1e-9)
    assert upper == pytest.approx(7.2, rel=1e-9)


def test_an_edge_that_is_not_wanted_or_none_is_the_place_inside():
    found = crossing(
        lambda x: bell(x) - [1.0, 9.0], [0.0, 0.0], [5.0, 5.0], np.array([False, True])
    )
    np.testing.assert_array_equal(found, 5.0)


def test_an_edge_where_numbers_end():
    """Nothing is known below 2.5, where the curve jumps."""
    found = crossing(lambda x: np.where(x < 2.5, np.nan, 1.0 + x), 0.0, 5.0)
    assert found[0] == pytest.approx(2.5, rel=1e-12)


def test_optima_of_known_curves():
    place, height = peak(bell, 0.0, 10.0)
    assert place[0] == pytest.approx(5.2, abs=1e-5)
    assert height[0] == pytest.approx(np.e, rel=1e-9)
    place, height = peak(lambda x: 7.0 - np.where(x < 4.1, 4.1 - x, 3.0 * (x - 4.1)), 0.0, 10.0)
    assert place[0] == pytest.approx(4.1, abs=1e-4)  # a kink
    assert height[0] == pytest.approx(7.0, abs=1e-4)


def test_an_optimum_at_an_end_is_the_end_though_the_curve_bends_upwards():
    place, height = peak(lambda x: np.exp([-1.0, 1.0] * x - [0.0, 10.0]), [0.0, 0.0], [10.0, 10.0])
    np.testing.assert_array_equal(place, [0.0, 10.0])
    np.testing.assert_allclose(height, 1.0, rtol=1e-12)


def test_bands_of_columns_in_a_table():
    flies = np.array([[1, 1, 1, 0, 1, 1], [1, 1, 0, 0, 0, 1], [0, 0, 0, 1, 0, 0]], bool).T
    np.testing.assert_array_equal(band_count(flies), [2, 2, 1])
    second = band_brackets(np.arange(18.0).reshape(6, 3), flies, 2)
    np.testing.assert_array_equal(second.exists[0], [True, True, False])
    np.testing.assert_array_equal(second.inside[:, :2], [[12.0, 16.0], [15.0, 16.0]])
    np.testing.assert_array_equal(second.outside[0, :2], [9.0, 13.0])
    np.testing.assert_array_equal(second.is_open[:, :2], [[False, False], [True, True]])


def curves(scale, light):
    """Outputs of flyers whose lift is a bell, and the light that they need."""

    def tabulate(places, names=None):
        return {"lift_over_weight": scale * bell(places), "levitation_irradiance": light(places)}

    return tabulate


def test_many_flyers_at_once_with_a_band_between_the_rows_and_none():
    place = np.linspace(0.0, 10.0, 8)
    scale = np.array([1.0, 1.001 / np.e, 0.9 / np.e])
    tabulate = curves(scale, lambda x: 2.0 + (x - 4.0) ** 2 + 0.0 * scale)
    table = {name: rows[:, 0] for name, rows in tabulate(place[:, None, None]).items()}
    found = find_edges_and_optima(tabulate, place, table, widest=True)
    half = 2.0 * np.sqrt(1.0 + np.log(scale[:2]))
    np.testing.assert_allclose(found.edges[:, 0, :2], [5.2 - half, 5.2 + half], rtol=1e-8)
    assert np.isnan(found.edges[:, 0, 2]).all()
    np.testing.assert_allclose(found.best, 5.2, atol=1e-4)
    np.testing.assert_allclose(found.easiest, 4.0, atol=1e-4)
    np.testing.assert_allclose(found.at_easiest["levitation_irradiance"], 2.0, rtol=1e-8)


def test_flyers_that_need_no_light_need_none_and_some_never_have_enough():
    place = np.linspace(0.0, 10.0, 21)
    ends = np.array([3.0, -np.inf])

    def light(places):
        return np.where(ends < 0.0, np.inf, np.maximum(ends - places, 0.0))

    tabulate = curves(np.ones(2), light)
    table = {name: rows[:, 0] for name, rows in tabulate(place[:, None, None]).items()}
    found = find_edges_and_optima(tabulate, place, table)
    assert found.easiest[0] == pytest.approx(3.0, abs=1e-4)
    assert found.at_easiest["levitation_irradiance"][0] == 0.0
    assert np.isnan(found.easiest[1])
    assert np.isnan(found.at_easiest["levitation_irradiance"][1])


def test_a_film_that_survives_between_two_rows_beside_an_edge():
    """Just above the lower edge, 3.2, where it is hotter above, and just below the upper, 7.2."""
    limit, turns = 500.0, np.array([3.25, 3.9, 7.1, 6.3])
    warmer = np.array([1.0, 1.0, -1.0, -1.0])

    def curve(places, names):
        lift = bell(places)
        known = {
            "lift_over_weight": lift,
            "temperature": limit + 10.0 * warmer * (places - turns),
            "levitation_irradiance": 1000.0 / lift,
            "payload": lift - 1.0,
        }
        return {name: known[name] for name in names or known}

    place = np.arange(11.0)
    table = curve(np.broadcast_to(place[:, None], (11, 4)), None)
    found = find_edges_and_optima(curve, place, table)
    best = found.best, found.at_best
    usable = find_usable(curve, place, table, found.edges, best, limit)
    lower, upper = usable.edges[:, 0]
    assert lower == pytest.approx([3.2, 3.2, 7.1, 6.3], abs=1e-8)
    assert upper == pytest.approx([3.25, 3.9, 7.2, 7.2], abs=1e-8)
    assert usable.best == pytest.approx(turns, abs=1e-8)
    assert usable.at_best["payload"] == pytest.approx(bell(turns) - 1.0, abs=1e-8)


def test_the_widest_band_counts_in_places_not_in_rows():
    place = np.array([0.0, 1.0, 2.0, 3.0, 10.0, 20.0])
    lifts = 0.5 + np.array([1, 1, 1, 0, 1, 1], float)

    def tabulate(places, names=None):
        lift = np.interp(places, place, lifts)
        return {"lift_over_weight": lift, "levitation_irradiance": 1.0 / lift}

    table = {name: rows[:, 0] for name, rows in tabulate(place[:, None, None]).items()}
    found = find_edges_and_optima(tabulate, place, table, widest=True)
    np.testing.assert_allclose(found.edges[:, 0, 0], [6.5, 20.0], rtol=1e-9)
    assert find_edges_and_optima(tabulate, place, table).edges.shape == (2, 2, 1)


@pytest.mark.parametrize("columns", [1, 300])
def test_looks_begin_in_a_table_and_leave_out_what_is_finished(columns):
    """Edges and tops of curves of all widths, by the closed form of a bell."""
    width = np.linspace(1.0, 3.0, columns)
    rows = np.linspace(0.0, 10.0, 21)[:, None]
    looked = []

    def margin(places):
        looked.append(np.isfinite(places).sum())
        return np.exp(1.0 - ((places - 5.2) / width) ** 2) - 1.0

    table = margin(rows)
    near = np.array([9, 10, 11])
    known = np.broadcast_to(rows[near], (3, columns)), table[near]
    looked.clear()
    place, height = peak(margin, rows[9], rows[11], known=known, leaves_out=True)
    np.testing.assert_allclose(place, 5.2, atol=1e-4)
    np.testing.assert_allclose(height, np.e - 1.0, rtol=1e-7)
    assert sum(looked) <= 9 * columns + 9
    last = (table > 0.0).sum(axis=0) + (table > 0.0).argmax(axis=0)
    around = last + np.arange(-2, 2)[::-1, None]
    columns_of = np.arange(columns)
    known = np.broadcast_to(rows, table.shape)[around, columns_of], table[around, columns_of]
    looked.clear()
    edge = crossing(margin, known[0][1], known[0][2], known=known, leaves_out=True)
    np.testing.assert_allclose(edge, 5.2 + width, rtol=1e-9)
    assert sum(looked) <= max(6 * columns, 27)


def test_rows_around_an_edge():
    table = np.arange(10.0).reshape(5, 2)
    places = np.array([[0.0, 1.0, 2.0, 3.0, 4.0]] * 2).T
    found = rows_around(table, places, np.array([[1.0, 4.0], [2.0, 3.0]]))
    np.testing.assert_array_equal(found, [[0.0, np.nan], [2.0, 9.0], [4.0, 7.0], [6.0, 5.0]])
