"""Edges of the bands and optima of flyers, many at once, where a table shows that they are."""

from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np

from lightflyer.flight.grid_refinement import (
    at,
    band_brackets,
    band_count,
    best_of,
    crossing,
    first_largest,
    peak,
    with_point,
)
from lightflyer.prediction.evaluator import Table

_LIFT, _LIGHT = _SEARCHED = "lift_over_weight", "levitation_irradiance"

Names: TypeAlias = tuple[str, ...] | None
"""Outputs that are asked for; None for all that are reported."""

Tabulate: TypeAlias = Callable[[np.ndarray, Names], Table]
"""Takes places of shape (n, k, m), gives outputs of that shape: of m flyers at k places each."""


class Found(NamedTuple):
    """Where m flyers have their edges and optima; places are NaN where there is none."""

    edges: np.ndarray  # Lower and upper edge of each band, shape (2, bands, m)
    best: np.ndarray  # Place of the largest payload, shape (m,)
    easiest: np.ndarray  # Place of the least light, shape (m,)
    at_best: Table  # Outputs there, shape (m,)
    at_easiest: Table


def find_edges_and_optima(
    tabulate: Tabulate, place: np.ndarray, table: Table, *, widest: bool = False
) -> Found:
    """Find all edges and optima between the rows of a table, shape (n, m); ``place`` (n,)."""

    def objectives(places: np.ndarray) -> np.ndarray:
        lift, light = (
            tabulate(places[:, [row]], (name,))[name][:, 0] for row, name in enumerate(_SEARCHED)
        )
        return _objectives(lift, light)

    first = _objectives(table[_LIFT], table[_LIGHT])
    _, before, after = best_of(first)
    optima, heights = peak(objectives, place[before], place[after])
    there = {name: values[0] for name, values in tabulate(optima[None], None).items()}
    optima = np.where(heights > -np.inf, optima, np.nan)
    best, easiest = (
        {name: np.where(np.isnan(found), np.nan, values[row]) for name, values in there.items()}
        for row, found in enumerate(optima)
    )

    # the place of most payload is added so as not to miss a narrow band
    places, lifts = with_point(place, table[_LIFT], optima[0], best[_LIFT])
    flies = lifts >= 1.0
    count = int(band_count(flies).max())
    brackets = [band_brackets(places, flies, 1 + number) for number in range(max(count, 1))]
    outside, inside, exists, is_open = (np.stack(part, 1) for part in zip(*brackets, strict=True))
    if widest:
        width = np.where(exists[0], inside[1] - inside[0], -np.inf)
        chosen = np.broadcast_to(first_largest(width), (2, width.shape[1]))
        outside, inside, exists, is_open = (
            at(part.swapaxes(0, 1), chosen)[:, None] for part in (outside, inside, exists, is_open)
        )

    def margins(places: np.ndarray) -> np.ndarray:
        spread = places.reshape(len(places), -1, places.shape[-1])
        return tabulate(spread, (_LIFT,))[_LIFT].reshape(places.shape) - 1.0

    edges = crossing(margins, outside, inside, exists & ~is_open)
    edges = np.where(exists, edges, np.nan)
    return Found(edges, optima[0], optima[1], at_best=best, at_easiest=easiest)


def _objectives(lift: np.ndarray, light: np.ndarray) -> np.ndarray:
    """What is largest where the payload is, and where the light is least; shape (n, 2, m)."""
    with np.errstate(divide="ignore"):
        return np.stack([lift, -np.log(light)], axis=1)
