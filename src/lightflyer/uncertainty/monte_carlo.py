"""Monte Carlo for predictions: many slightly different flyers at once, and their results."""

from collections.abc import Sequence
from typing import Any

import jax
import numpy as np

from lightflyer.design.outputs import table_of, tabulate
from lightflyer.environment.base import Coordinate
from lightflyer.prediction.edges_and_optima import Found, Names, find_edges_and_optima
from lightflyer.prediction.evaluator import Table
from lightflyer.program.entry_point import entry_point
from lightflyer.uncertainty.inputs import Inputs

_tabulate_each = entry_point(tabulate)


def tabulate_samples(
    inputs: Inputs, samples: np.ndarray, coordinate: np.ndarray, names: Sequence[str]
) -> Table:
    """Outputs of many flyers, shape (samples, n); ``coordinate`` (n,) or (samples, n)."""
    setup = inputs.setup_of(samples)
    shape = len(samples), np.shape(coordinate)[-1]
    places = np.broadcast_to(coordinate, shape)
    light = setup.environment.radiation.irradiance
    if any(np.ndim(leaf) > 2 for leaf in jax.tree.leaves(setup)):  # tables for each sample
        found = table_of(setup, places, light, names, _tabulate_each)
    else:
        rows = jax.tree.map(lambda leaf: _in_a_row(leaf, shape), setup)
        found = table_of(rows, places.ravel(), np.broadcast_to(light, shape).ravel(), names)
    return {
        name: np.broadcast_to(values.reshape(-1, shape[1]), shape) for name, values in found.items()
    }


def _in_a_row(leaf: Any, shape: tuple[int, int]) -> Any:
    """A number of each sample, shape (samples, 1), for each of its coordinates."""
    own = np.shape(leaf) in ((shape[0], 1), shape)  # and no table of an atmosphere
    return np.broadcast_to(leaf, shape).ravel() if own else leaf


def search_samples(
    inputs: Inputs,
    samples: np.ndarray,
    coordinate: np.ndarray,
    table: Table,
    searched: tuple[float, float],
    where: Coordinate,
) -> Found:
    """The widest band and the optima of each sample in a range, of which ``table`` has the ends."""
    increasing, order = np.unique(coordinate, return_index=True)
    inside = (searched[0] <= increasing) & (increasing <= searched[1])
    rows = {name: values[:, order[inside]].T for name, values in table.items()}

    def look(places: np.ndarray, names: Names) -> Table:
        each = where.from_axis(np.moveaxis(places, -1, 0).reshape(len(samples), -1))
        found = tabulate_samples(inputs, samples, each, names or tuple(table))
        return {name: values.T.reshape(places.shape) for name, values in found.items()}

    return find_edges_and_optima(look, where.to_axis(increasing[inside]), rows, widest=True)
