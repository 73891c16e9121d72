"""The map of payload over a number of the design and altitude, with its optimum."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from lightflyer.config.flyer_file import FileDesign
from lightflyer.core.errors import ConfigurationError, LightflyerError
from lightflyer.core.progress import report
from lightflyer.core.quantity import Quantity
from lightflyer.core.units import scale_and_offset
from lightflyer.design.diagnostics import diagnose_at, diagnose_force
from lightflyer.design.outputs import OUTPUTS
from lightflyer.design.setup import Setup
from lightflyer.explorer import view
from lightflyer.explorer.compute import coordinate_factor, prediction_of, pretty_unit
from lightflyer.explorer.state import Document, Workplace
from lightflyer.files.palette import BLUE, ORANGE, VERMILION
from lightflyer.prediction.evaluator import POINTS, Evaluator

MAP_COLUMNS = 33  # Values of the varied number in a map
MAP_ROWS = 76  # Altitudes or pressures in a map: every fourth of a prediction's

_MAP_SPAN = 5.0  # a map reaches so many times below and above the design's own value
_EVERY = POINTS // (MAP_ROWS - 1)
_CLOSER = 9  # columns of the closer looks at the optimum
_LOOKS = 2
_AROUND = 0.2  # of the range in which the design itself nearly flies, shown beyond it
_HALVINGS = 20  # of the way from the design's own number to one of which none can be built
_END = 1e-3  # of a number, within which it is an end of the map
_LEAST = 1e-12  # of the colours' range, where nothing is lifted
_LENGTH = "m"


class Choices(NamedTuple):
    """What the page chose for a job."""

    over: str = ""  # Number that a map varies; empty for the first size of the flyer
    output: str = "levitation_irradiance"  # Result whose sensitivity is shown


def variable_numbers(design: FileDesign) -> dict[str, Quantity]:
    """Positive numbers of a design that arithmetic varies, those of lengths of the flyer first."""
    known = design.quantities
    costly = set(design.needs_recompute(list(known)))
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
    (low, below), (high, above) = _ends(design, over, known[over])
    values = np.geomspace(low, high, MAP_COLUMNS)
    # coordinates around those at which the design itself nearly flies
    prediction = prediction_of(design)
    where, (near, far) = prediction.coordinate, view.shown_range(prediction)
    first, last = float(prediction.coordinates[0]), float(prediction.coordinates[-1])
    if where.logarithmic:
        reach = (far / near) ** _AROUND
        coordinates = np.geomspace(max(near / reach, first), min(far * reach, last), POINTS)
    else:
        reach = _AROUND * (far - near)
        coordinates = np.linspace(max(near - reach, first), min(far + reach, last), POINTS)
    columns = []
    for done, value in enumerate(values):
        report("computing the map", done, MAP_COLUMNS, "designs")
        moved = design.build({over: float(value)})
        columns.append(_usable_payload(moved, coordinates))
    payload = np.stack(columns)
    best = _refine(design, over, values, coordinates, payload)
    unit = known[over].unit
    if unit == _LENGTH:  # one in which values have few digits
        sizes = (("m", 0.5), ("cm", 5e-3), ("mm", 5e-4), ("um", 5e-7))
        middle = float(np.sqrt(values[0] * values[-1]))
        unit = next((name for name, size in sizes if middle >= size), "nm")
    across, up = scale_and_offset(known[over].unit, unit)[0], coordinate_factor(where)
    scale, payload_unit = OUTPUTS["payload"].display_unit_for(best[2])
    # cells of the map, a column after the other; those that lift nothing have no value
    chosen = np.arange(0, coordinates.size, _EVERY)
    x, y = values * across, coordinates[chosen] * up
    sides = np.exp(_edges(np.log(x)))
    levels = np.exp(_edges(np.log(y))) if where.logarithmic else _edges(y)
    lifted = np.where(payload > 0.0, payload, np.nan)[:, chosen] * scale
    cells = {
        "left": np.repeat(sides[:-1], y.size),
        "right": np.repeat(sides[1:], y.size),
        "bottom": np.tile(levels[:-1], x.size),
        "top": np.tile(levels[1:], x.size),
        "x": np.repeat(x, y.size),
        "y": np.tile(y, x.size),
        "value": lifted.ravel(),
    }
    own = float(design.number(over) or 0.0), prediction.best.coordinate
    places = {
        name: {"x": np.array([place[0] * across]), "y": np.array([place[1] * up])}
        for name, place in (("best", best), ("here", own))
    }
    words = "No design of this map lifts anything; the star is where least is missing."
    if best[2] > 0.0:
        words = (
            f"Largest payload: {best[2] * scale:.4g} {payload_unit} at "
            f"{f'{best[0] * across:.4g} {unit}'.rstrip()} and "
            f"{best[1] * up:.4g} {where.shown_unit}."
        )
        at_ends = best[0] <= values[0] * (1.0 + _END), best[0] >= values[-1] * (1.0 - _END)
        for at_end, limit in zip(at_ends, (below, above), strict=True):
            if at_end:
                more = "none can be built" if limit else "may be more"
                words += f" It is at the end of the map: beyond {more}."
    # what the optimum's reader must know; elsewhere on the map nobody has looked
    optimum, at_best = design.build({over: best[0]}), np.array([best[1]])
    table = Evaluator(optimum)(at_best)
    found = (
        *diagnose_force(optimum.flyer, table),
        *diagnose_at(optimum, at_best, table["temperature"]),
    )
    return view.figure_data(
        {"cells": cells, **places},
        x=(float(cells["left"][0]), float(cells["right"][-1])),
        y=(float(cells["bottom"][0]), float(cells["top"][-1])),
        labels=(f"{words_of(over)}{f' [{pretty_unit(unit)}]' if unit else ''}",
                view.axis_label(where)),
        colours={"low": 0.0, "high": max(best[2] * scale, _LEAST)},
        words=words,
        warnings=[
            *(f"at the optimum: {text}" for text in found),
            "whether models are within their range is checked at the optimum only",
            *(f"the map ends where no flyer can be built: {text}"
              for text in (below, above) if text),
        ],
        numbers=list(known),
        over=over,
        shown=payload_unit,
        unit=unit,
        place_unit=where.shown_unit,
        logarithmic=where.logarithmic,
        best=list(best),
        across=across,
        up=up,
        legend=(
            view.Line(f"colour: largest payload that the film survives [{payload_unit}]",
                      BLUE, "area"),
            view.Line("star: optimum", ORANGE, "star"),
            view.Line("cross: this design", VERMILION, "cross"),
        ),
        tips=[
            (words_of(over), f"@x{{0.0000}} {unit}"),
            (where.name, f"@y{{0.00}} {where.shown_unit}"),
            ("payload", f"@value{{0.0000}} {payload_unit}"),
        ],
    )  # fmt: skip


def _usable_payload(setup: Setup, coordinates: np.ndarray) -> np.ndarray:
    """Largest payload at coordinates, shape (n,); NaN where the film does not survive."""
    table = Evaluator(setup)(coordinates, names=("temperature", "payload"))
    highest = setup.flyer.highest_temperature
    hot = table["temperature"] > (np.inf if highest is None else float(highest))
    return np.where(hot, np.nan, table["payload"])


def _ends(design: FileDesign, over: str, quantity: Quantity) -> Iterator[tuple[float, str]]:
    """Ends of the varied number, and what no flyer beyond them meets; empty where one may be."""
    own, (smallest, largest) = float(design.number(over) or 0.0), quantity.sizes
    for end in (
        max(own / _MAP_SPAN, quantity.lowest, smallest),
        min(own * _MAP_SPAN, quantity.highest, largest),
    ):
        limit, built, beyond = _mistake(design, over, end), own, end
        if not limit:
            yield end, ""
            continue
        for _ in range(_HALVINGS):
            middle = float(np.sqrt(built * beyond))
            if _mistake(design, over, middle):
                beyond = middle
            else:
                built = middle
        yield built, limit


def _mistake(design: FileDesign, over: str, value: float) -> str:
    """Why no flyer of such a number can be built; empty where one can."""
    try:
        design.build({over: value})
    except LightflyerError as error:
        return str(error).partition("\n")[0]
    return ""


def _refine(
    design: FileDesign,
    over: str,
    values: np.ndarray,
    coordinates: np.ndarray,
    payload: np.ndarray,
) -> tuple[float, float, float]:
    """Number, coordinate and payload at the optimum: the map, looked at closer there."""
    place = np.unravel_index(int(np.argmax(np.nan_to_num(payload, nan=-np.inf))), payload.shape)
    column, row = int(place[0]), int(place[1])
    for _ in range(_LOOKS):
        ends = values[max(column - 1, 0)], values[min(column + 1, values.size - 1)]
        near = coordinates[max(row - 1, 0)], coordinates[min(row + 1, coordinates.size - 1)]
        values, coordinates = np.geomspace(*ends, _CLOSER), np.linspace(*near, POINTS)
        closer = np.stack(
            [_usable_payload(design.build({over: float(one)}), coordinates) for one in values]
        )
        place = np.unravel_index(int(np.argmax(np.nan_to_num(closer, nan=-np.inf))), closer.shape)
        column, row = int(place[0]), int(place[1])
    return float(values[column]), float(coordinates[row]), float(np.nan_to_num(closer[column, row]))


def _edges(centres: np.ndarray) -> np.ndarray:
    """Edges of cells around evenly spaced centres."""
    half = 0.5 * (centres[1] - centres[0])
    return np.concatenate([centres - half, [centres[-1] + half]])


def words_of(name: str) -> str:
    """Name of a number in words."""
    return name.replace(".", " ").replace("_", " ")
