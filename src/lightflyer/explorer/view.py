"""Figures of the page: what Bokeh draws, made once, and the data that go into them.

A figure is sent to the page as a description with empty sources. Whatever is computed then comes
as columns of these sources, ranges, labels, a legend and words for those who do not see it; the
page changes the figure in place.
"""

import math
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from lightflyer.design.outputs import OUTPUTS, outputs_of
from lightflyer.environment.base import Coordinate
from lightflyer.explorer.compute import Quick, coordinate_factor, pretty_unit
from lightflyer.files.drawing import EXTRAPOLATED
from lightflyer.files.palette import (
    AVAILABLE,
    BLUE,
    GREEN,
    GREY,
    LIMIT,
    ORANGE,
    PURPLE,
    SKY,
)
from lightflyer.prediction.prediction import Prediction
from lightflyer.uncertainty.propagation import PredictionUncertainty

Columns = dict[str, list[Any]]

_SPAN = 30.0  # irradiance, over the least, up to which curves are shown
_ROOM = 1.15  # between the highest value and the top of a figure
_ROUND = (1.0, 2.0, 5.0, 10.0)
_STEPS = 20  # a range ends at multiples of about so many parts of it
_ROWS = 13  # of a table beside a figure
FAINT = 0.35  # opacity of curves outside the range of force model or gas
_WIDEST = 300.0  # of a ratio beyond which a figure shows no further decades
NODE_COLOURS = (ORANGE, PURPLE, GREEN, SKY)
PIN_COLOURS = (GREEN, PURPLE, ORANGE, SKY)


class Line(NamedTuple):
    """An entry of a legend."""

    label: str
    colour: str
    dash: str = "solid"


def figure_data(
    sources: Mapping[str, Mapping[str, Any]],
    *,
    x: tuple[float, float],
    y: tuple[float, float],
    labels: tuple[str, str],
    legend: Iterable[Line] = (),
    words: str = "",
    **more: Any,
) -> dict[str, Any]:
    """What the page puts into a figure; ``sources``: columns by the name of the source."""
    return {
        "sources": {
            name: {column: plain_list(values) for column, values in columns.items()}
            for name, columns in sources.items()
        },
        "x": list(x),
        "y": list(y),
        "labels": list(labels),
        "legend": [line._asdict() for line in legend],
        "words": words,
        **more,
    }


def plain_list(values: Any) -> list[Any]:
    """A column for JSON: None stands where a number is not finite."""
    if isinstance(values, np.ndarray) and values.dtype.kind == "f":
        known = values.astype(object)
        known[~np.isfinite(values)] = None
        found: list[Any] = known.tolist()
        return found
    return [
        plain_list(entry) if isinstance(entry, list | np.ndarray) else entry for entry in values
    ]


def curves(found: Quick, pins: int = 0) -> dict[str, Any]:
    """Irradiance, temperature and payload over the coordinate; data by the name of the figure."""
    where = found.setup.environment.coordinate
    factor = coordinate_factor(where)
    low, high = shown_range(found)
    inside = (found.coordinates >= low) & (found.coordinates <= high)
    x = found.coordinates[inside] * factor
    table = {name: values[inside] for name, values in found.table.items()}
    axis = (low * factor, high * factor), axis_label(where)
    drawn = {
        "irradiance": _irradiance(found.setup, x, table, axis),
        "temperature": _temperature(found.setup, x, table, axis),
        "payload": _payload(x, table, axis),
    }
    here = (where.name, f"@x{{0.00}} {where.shown_unit}")
    usable = _usable(found, factor)
    pinned = [
        Line(f"pin {number}", colour, "dashdot")._asdict()
        for number, colour in enumerate(PIN_COLOURS[:pins], start=1)
    ]
    for data in drawn.values():
        data["legend"] += pinned
        data["tips"] = [here, *data["tips"]]
        data["sources"] |= {"flies": usable, "band": {"x": [], "low": [], "high": []}}
    return drawn


def _usable(found: Quick, factor: float) -> Columns:
    """Where the film survives flight, by the table, until the prediction has found the edges."""
    margin, x = found.table["lift_over_weight"] - 1.0, found.coordinates * factor
    highest = found.setup.flyer.highest_temperature
    if highest is not None:
        margin = np.minimum(margin, 1.0 - found.table["temperature"] / float(highest))
    flying = np.concatenate([[False], margin >= 0.0, [False]])
    first, last = (
        np.flatnonzero(flying[1:] & ~flying[:-1]),
        np.flatnonzero(~flying[1:] & flying[:-1]),
    )

    def edge(inside: int, outside: int) -> float:
        if not 0 <= outside < x.size:
            return float(x[inside])
        share = margin[inside] / (margin[inside] - margin[outside])
        return float(x[inside] + share * (x[outside] - x[inside]))

    return {
        "low": [edge(int(index), int(index) - 1) for index in first],
        "high": [edge(int(index) - 1, int(index)) for index in last],
    }


_Axis = tuple[tuple[float, float], str]


def axis_label(where: Coordinate) -> str:
    """Label of the axis of a coordinate, such as ``"altitude [km]"``."""
    name = where.long_name.removeprefix("geometric ")
    return f"{name} [{where.shown_unit}]"


def shown_range(found: Quick | Prediction) -> tuple[float, float]:
    """Range of the coordinate worth showing, with round ends [m]."""
    where, needed = found.setup.environment.coordinate, found.table["levitation_irradiance"]
    first, last = float(found.coordinates[0]), float(found.coordinates[-1])
    light = found.coordinates[needed < _SPAN * np.min(needed, initial=np.inf)]
    if light.size < 2:
        return first, last
    if where.logarithmic:
        return (max(first, round_down(float(light[0]))), min(last, round_up(float(light[-1]))))
    step = _step(float(light[-1] - light[0]))
    low, high = math.floor(light[0] / step) * step, math.ceil(light[-1] / step) * step
    return max(first, low), min(last, high)


def _step(width: float) -> float:
    return round_up(width / _STEPS) if width > 0.0 else 1.0


def round_up(value: float) -> float:
    """Next of 1, 2, 5, 10, … at or above a positive value."""
    decade = 10.0 ** math.floor(math.log10(value))
    return next((step * decade for step in _ROUND if step * decade >= value * (1.0 - 1e-9)), value)


def round_down(value: float) -> float:
    """Next of 1, 2, 5, 10, … at or below a positive value."""
    decade = 10.0 ** math.floor(math.log10(value))
    return max(step * decade for step in _ROUND if step * decade <= value * (1.0 + 1e-9))


def round_range(values: Any) -> tuple[float, float]:
    """Range with round ends around values, those not finite left out."""
    finite = np.asarray(values, float)
    finite = finite[np.isfinite(finite)]
    if not finite.size:
        return 0.0, 1.0
    low, high = float(finite.min()), float(finite.max())
    step = _step((high - low) or abs(high) or 1.0)
    return math.floor(low / step - 0.5) * step, math.ceil(high / step + 0.5) * step


def _irradiance(setup: Any, x: np.ndarray, table: Mapping[str, Any], axis: _Axis) -> dict[str, Any]:
    needed = table["levitation_irradiance"]
    available = float(setup.environment.radiation.irradiance)
    finite = needed[np.isfinite(needed)]
    seen = [value for value in (available, *finite) if value > 0.0] or [1.0]
    low = round_down(0.7 * min(seen))
    high = min(round_up(_ROOM * max(seen)), round_up(_WIDEST * low))
    least = ""
    if finite.size:
        place = x[int(np.nanargmin(needed))]
        least = f"The least is {finite.min():.4g} W/m² at {place:.4g}."
    return figure_data(
        {
            "curve": {"x": x, "needed": needed, "inside": _covered(needed, table)},
            "level": {"x": np.array(axis[0]), "y": np.full(2, available)},
            "best": _lowest(x, needed),
        },
        x=axis[0],
        y=(low, high),
        labels=(axis[1], "irradiance [W/m²]"),
        legend=(
            Line("needed to levitate", BLUE),
            Line("available", AVAILABLE, "dashed"),
            *_faint_entry(table),
        ),
        tips=[("needed", "@needed{0,0.0} W/m²")],
        words=f"Irradiance needed to levitate over {axis[1]}; {available:.4g} W/m² is available. "
        f"{least}",
    )


def _temperature(
    setup: Any, x: np.ndarray, table: Mapping[str, Any], axis: _Axis
) -> dict[str, Any]:
    nodes = [name for name in table if name.startswith("temperature_")]
    limit = setup.flyer.highest_temperature
    level = math.nan if limit is None else float(np.asarray(limit))
    names = {"flyer": "temperature", "gas": "gas_temperature"}
    columns = {name: table[output] for name, output in names.items()}
    shown = [*columns.values(), *(table[name] for name in nodes)]
    y = round_range(np.concatenate(shown))
    y = (y[0], max(y[1], 1.02 * level)) if level < 2.0 * y[1] else y
    legend = [Line("flyer in the available light", BLUE), Line("gas", GREY, "dotted")]
    several = {"xs": [], "ys": [], "colour": []}  # type: dict[str, list[Any]]
    for name, colour in zip(nodes, NODE_COLOURS, strict=False):
        several["xs"].append(x)
        several["ys"].append(table[name])
        several["colour"].append(colour)
        legend.append(Line(name.removeprefix("temperature_").replace("_", " "), colour))
    if math.isfinite(level):
        legend.append(Line("film limit", LIMIT, "dashed"))
    hottest = np.nanmax(table["temperature"])
    return figure_data(
        {
            "curve": {"x": x, **columns},
            "nodes": several,
            "level": {"x": np.array(axis[0]), "y": np.full(2, level)},
        },
        x=axis[0],
        y=y,
        labels=(axis[1], "temperature [K]"),
        legend=legend,
        tips=[("flyer", "@flyer{0.0} K"), ("gas", "@gas{0.0} K")],
        words=f"Temperature of flyer and gas over {axis[1]}; the flyer is at most {hottest:.4g} K.",
    )


def _payload(x: np.ndarray, table: Mapping[str, Any], axis: _Axis) -> dict[str, Any]:
    most = float(np.nanmax(table["payload"]))
    scale, unit = OUTPUTS["payload"].display_unit_for(most)
    values = table["payload"] * scale
    low, high = round_range(values)
    high = round_up(_ROOM * most * scale) if most > 0.0 else high
    low = max(low, -0.15 * high) if most > 0.0 else low
    return figure_data(
        {
            "curve": {"x": x, "payload": values, "inside": _covered(values, table)},
            "best": _lowest(x, -values, -1.0),
        },
        x=axis[0],
        y=(low, high),
        labels=(axis[1], f"largest payload [{unit}]"),
        legend=(Line("largest payload", BLUE), *_faint_entry(table)),
        tips=[("payload", f"@payload{{0.0000}} {unit}")],
        words=f"Largest payload over {axis[1]}: at most {most * scale:.4g} {unit}.",
        scale=scale,
    )


def _covered(values: np.ndarray, table: Mapping[str, Any]) -> np.ndarray:
    """Values where force model and gas are within their ranges, NaN elsewhere."""
    return np.where(table["covered"] > 0.0, values, np.nan)


def _faint_entry(table: Mapping[str, Any]) -> list[Line]:
    """Entry of a legend for what is extrapolated, where anything is."""
    return [] if np.all(table["covered"] > 0.0) else [Line(EXTRAPOLATED, GREY, "area")]


def _lowest(x: np.ndarray, values: np.ndarray, sign: float = 1.0) -> dict[str, np.ndarray]:
    """The least of a curve, where it is finite."""
    known = np.flatnonzero(np.isfinite(values))
    if not known.size:
        return {"x": x[:0], "y": x[:0]}
    place = known[[int(np.argmin(values[known]))]]
    return {"x": x[place], "y": sign * values[place]}


def marks(prediction: Prediction) -> dict[str, Any]:
    """Bands in which the film survives and the best places, for the figures over the coordinate."""
    factor = coordinate_factor(prediction.coordinate)
    edges = factor * np.array(prediction.verdict.usable).reshape(-1, 2)
    flies = {"low": plain_list(edges[:, 0]), "high": plain_list(edges[:, 1])}
    best = prediction.verdict.best or prediction.best
    scale = OUTPUTS["payload"].display_unit_for(_most(prediction))[0]
    found: dict[str, Any] = {name: {"sources": {"flies": flies}} for name in OVER_COORDINATE}
    found["payload"]["sources"]["best"] = {
        "x": [best.coordinate * factor],
        "y": plain_list(np.array([best.values["payload"] * scale])),
    }
    if prediction.easiest is not None:
        easiest = prediction.easiest
        found["irradiance"]["sources"]["best"] = {
            "x": [easiest.coordinate * factor],
            "y": plain_list(np.array([easiest.values["levitation_irradiance"]])),
        }
    else:
        found["irradiance"]["sources"]["best"] = {"x": [], "y": []}
    return found


def _most(prediction: Prediction) -> float:
    return float(np.nanmax(prediction.table["payload"]))


OVER_COORDINATE = {
    "irradiance": "levitation_irradiance",
    "temperature": "temperature",
    "payload": "payload",
}
"""Figures over the coordinate, and which output each shows."""


def bands(uncertainty: PredictionUncertainty | None) -> dict[str, Any]:
    """95 % bands of the curves."""
    found: dict[str, Any] = {}
    for figure, output in OVER_COORDINATE.items():
        columns: Columns = {"x": [], "low": [], "high": []}
        if uncertainty is not None and output in uncertainty.low:
            factor = coordinate_factor(uncertainty.prediction.coordinate)
            scale = 1.0
            if output == "payload":
                scale = OUTPUTS[output].display_unit_for(_most(uncertainty.prediction))[0]
            known = np.isfinite(uncertainty.low[output]) & np.isfinite(uncertainty.high[output])
            columns = {
                "x": plain_list(uncertainty.coordinate[known] * factor),
                "low": plain_list(uncertainty.low[output][known] * scale),
                "high": plain_list(uncertainty.high[output][known] * scale),
            }
        found[figure] = {"sources": {"band": columns}}
    return found


def rows(found: Prediction) -> dict[str, Any]:
    """The curves as a table, for those who do not see figures."""
    where, known = found.setup.environment.coordinate, outputs_of(found.setup)
    low, high = shown_range(found)
    places = np.flatnonzero((found.coordinates >= low) & (found.coordinates <= high))
    chosen = places[np.linspace(0, places.size - 1, min(_ROWS, places.size)).round().astype(int)]
    names = [name for name in found.table if name != where.name]
    scales = {name: known[name].display_unit_for(found.table[name][chosen]) for name in names}
    columns = [axis_label(where)]
    for name in names:
        unit = pretty_unit(scales[name][1])
        columns.append(f"{name.replace('_', ' ')}{f' [{unit}]' if unit else ''}")
    factor = coordinate_factor(where)
    body = [
        [f"{found.coordinates[place] * factor:.4g}"]
        + [
            f"{value:.4g}" if math.isfinite(value) else "–"
            for value in (found.table[name][place] * scales[name][0] for name in names)
        ]
        for place in chosen
    ]
    return {"columns": columns, "rows": body}
