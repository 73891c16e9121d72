"""The map of payload over a number of the design and altitude, with its optimum."""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from lightflyer.config.flyer_file import FileDesign
from lightflyer.explorer import view
from lightflyer.explorer.compute import Quick, coordinate_factor, prediction_of, pretty_unit
from lightflyer.explorer.state import Document, Workplace
from lightflyer.flight.outputs import OUTPUTS
from lightflyer.foundation.drawing import BLUE, ORANGE, VERMILION
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.progress import report
from lightflyer.foundation.quantity import Quantity
from lightflyer.foundation.units import scale_and_offset
from lightflyer.prediction.evaluator import POINTS, Evaluator

MAP_COLUMNS = 33
"""Values of the varied number in a map."""

MAP_ROWS = 76
"""Altitudes or pressures in a map: every fourth of a prediction's."""

_MAP_SPAN = 5.0  # a map reaches so many times below and above the design's own value
_EVERY = POINTS // (MAP_ROWS - 1)
_CLOSER = 9  # columns of the closer looks at the optimum
_LOOKS = 2
_AROUND = 0.2  # of the range in which the design itself nearly flies, shown beyond it
_LENGTH = "m"


class Choices(NamedTuple):
    """What the page chose for a job.

    Attributes
    ----------
    over : str
        Number that a map varies; empty for the first size of the flyer.
    output : str
        Result whose sensitivity is shown.
    """

    over: str = ""
    output: str = "levitation_irradiance"


def variable_numbers(design: FileDesign) -> dict[str, Quantity]:
    """Positive numbers of a design that arithmetic varies, those of lengths of the flyer first.

    Parameters
    ----------
    design : FileDesign

    Returns
    -------
    dict of str to Quantity
    """
    known = design.quantities
    costly = set(design.costly(list(known)))
    usable = {
        name: quantity
        for name, quantity in known.items()
        if name not in costly and (design.number(name) or 0.0) > 0.0
    }

    def order(name: str) -> tuple[bool, bool]:
        is_length = usable[name].unit == _LENGTH and name.startswith("flyer.")
        return not is_length, not name.startswith(("flyer.", "film."))

    return {name: usable[name] for name in sorted(usable, key=order)}


def payload_map(workplace: Workplace, document: Document, choices: Choices) -> dict[str, Any]:
    """Largest payload over a number of the design and altitude or pressure."""
    design = workplace.design(document)
    known = variable_numbers(design)
    if not known:
        raise ConfigurationError("the design has no number that a map could vary")
    over = choices.over if choices.over in known else next(iter(known))
    own = float(design.number(over) or 0.0)
    low, high = _ends(own, known[over])
    values = np.geomspace(low, high, MAP_COLUMNS)
    coordinates = _map_coordinates(design)
    columns = []
    for done, value in enumerate(values):
        report("computing the map", done, MAP_COLUMNS, "designs")
        moved = design.build({over: float(value)})
        columns.append(Evaluator(moved)(coordinates)["payload"])
    payload = np.stack(columns)
    best = _refined(design, over, values, coordinates, payload)
    return _map_data(design, over, known, values, coordinates, payload, best)


def _ends(own: float, quantity: Quantity) -> tuple[float, float]:
    smallest, largest = quantity.sizes
    low = max(own / _MAP_SPAN, quantity.lowest, smallest)
    return low, min(own * _MAP_SPAN, quantity.highest, largest)


def _map_coordinates(design: FileDesign) -> np.ndarray:
    """Coordinates around those at which the design itself nearly flies."""
    prediction = prediction_of(design)
    found = Quick(prediction.setup, prediction.coordinates, prediction.table)
    where, (low, high) = prediction.coordinate, view.shown_range(found)
    first, last = float(found.coordinates[0]), float(found.coordinates[-1])
    if where.logarithmic:
        reach = (high / low) ** _AROUND
        return np.geomspace(max(low / reach, first), min(high * reach, last), POINTS)
    reach = _AROUND * (high - low)
    return np.linspace(max(low - reach, first), min(high + reach, last), POINTS)


def _refined(
    design: FileDesign,
    over: str,
    values: np.ndarray,
    coordinates: np.ndarray,
    payload: np.ndarray,
) -> tuple[float, float, float]:
    """Number, coordinate and payload at the optimum: the map, looked at closer there."""
    place = np.unravel_index(int(np.nanargmax(payload)), payload.shape)
    column, row = int(place[0]), int(place[1])
    for _ in range(_LOOKS):
        ends = values[max(column - 1, 0)], values[min(column + 1, values.size - 1)]
        near = coordinates[max(row - 1, 0)], coordinates[min(row + 1, coordinates.size - 1)]
        values, coordinates = np.geomspace(*ends, _CLOSER), np.linspace(*near, POINTS)
        closer = np.stack(
            [Evaluator(design.build({over: float(one)}))(coordinates)["payload"] for one in values]
        )
        place = np.unravel_index(int(np.nanargmax(closer)), closer.shape)
        column, row = int(place[0]), int(place[1])
    return float(values[column]), float(coordinates[row]), float(closer[column, row])


def _map_data(
    design: FileDesign,
    over: str,
    known: Mapping[str, Quantity],
    values: np.ndarray,
    coordinates: np.ndarray,
    payload: np.ndarray,
    best: tuple[float, float, float],
) -> dict[str, Any]:
    where = design.setup.environment.coordinate
    prediction = prediction_of(design)
    chosen = np.arange(0, coordinates.size, _EVERY)
    unit = _shown_unit(known[over].unit, values)
    across = scale_and_offset(known[over].unit, unit)[0]
    up = coordinate_factor(where)
    scale, shown = OUTPUTS["payload"].shown_for(best[2])
    x, y = values * across, coordinates[chosen] * up
    shares = np.where(payload > 0.0, payload, np.nan)[:, chosen] * scale
    x_edges, y_edges = _edges(np.log(x)), _edges(np.log(y) if where.logarithmic else y)
    x_edges = np.exp(x_edges)
    y_edges = np.exp(y_edges) if where.logarithmic else y_edges
    cells = {
        "left": np.repeat(x_edges[:-1], y.size),
        "right": np.repeat(x_edges[1:], y.size),
        "bottom": np.tile(y_edges[:-1], x.size),
        "top": np.tile(y_edges[1:], x.size),
        "x": np.repeat(x, y.size),
        "y": np.tile(y, x.size),
        "value": shares.ravel(),
    }
    lifts = best[2] > 0.0
    at_end = best[0] <= values[0] * 1.001 or best[0] >= values[-1] * 0.999
    optimum = f"{best[0] * across:.4g} {unit}".rstrip()
    words = f"Largest payload: {best[2] * scale:.4g} {shown} at {optimum} and "
    words += f"{best[1] * up:.4g} {where.shown_unit}."
    if at_end:
        words += " It is at the end of the map: beyond may be more."
    if not lifts:
        words = "No design of this map lifts anything; the star is where least is missing."
    own = float(design.number(over) or 0.0)
    return view.figure_data(
        {
            "cells": cells,
            "best": {"x": np.array([best[0] * across]), "y": np.array([best[1] * up])},
            "here": {
                "x": np.array([own * across]),
                "y": np.array([prediction.best.coordinate * up]),
            },
        },
        x=(float(x_edges[0]), float(x_edges[-1])),
        y=(float(y_edges[0]), float(y_edges[-1])),
        labels=(f"{words_of(over)}{_bracketed(unit)}", view.axis_label(where)),
        words=words,
        legend=(
            view.Line(f"colour: largest payload [{shown}]", BLUE, "area"),
            view.Line("star: optimum", ORANGE, "area"),
            view.Line("cross: this design", VERMILION, "area"),
        ),
        tips=[
            (words_of(over), f"@x{{0.0000}} {unit}"),
            (where.name, f"@y{{0.00}} {where.shown_unit}"),
            ("payload", f"@value{{0.0000}} {shown}"),
        ],
        colours={"low": 0.0, "high": max(best[2] * scale, 1e-12)},
        numbers=list(known),
        over=over,
        shown=shown,
        unit=unit,
        place_unit=where.shown_unit,
        logarithmic=where.logarithmic,
        best=list(best),
        across=across,
        up=up,
    )


def _edges(centres: np.ndarray) -> np.ndarray:
    """Edges of cells around evenly spaced centres."""
    half = 0.5 * (centres[1] - centres[0])
    return np.concatenate([centres - half, [centres[-1] + half]])


def _shown_unit(unit: str, values: np.ndarray) -> str:
    """A unit in which values have few digits: of lengths alone."""
    if unit != _LENGTH:
        return unit
    middle = float(np.sqrt(values[0] * values[-1]))
    for candidate, size in (("m", 0.5), ("cm", 5e-3), ("mm", 5e-4), ("um", 5e-7)):
        if middle >= size:
            return candidate
    return "nm"


def words_of(name: str) -> str:
    """Name of a number in words.

    Parameters
    ----------
    name : str

    Returns
    -------
    str
    """
    return name.replace(".", " ").replace("_", " ")


def _bracketed(unit: str) -> str:
    return f" [{pretty_unit(unit)}]" if unit else ""
