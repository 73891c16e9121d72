"""A prediction in words: lines and tables."""

import math
import textwrap
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.table import Table

from lightflyer.design.outputs import BUDGET_OUTPUTS, OUTPUTS, node_outputs, outputs_of
from lightflyer.files.result_text import NARROW, Parts, rows_of, warning_lines, width_of

if TYPE_CHECKING:
    from lightflyer.prediction.prediction import Prediction


def prediction_parts(prediction: "Prediction", width: int = NARROW) -> Parts:
    """The verdict, the results at each coordinate asked for, the bands, and what is assumed."""
    yield from (_wrapped(line, width) for line in verdict_lines(prediction))
    yield from _points_tables(prediction, min(width, NARROW))
    if np.any(_too_hot(prediction)):
        yield "* hotter in the light than its film bears"
    yield _results(prediction, prediction.summary())
    yield from warning_lines(prediction.warnings)
    yield _wrapped("; ".join(prediction.assumptions), width)


def _wrapped(line: str, width: int) -> str:
    return textwrap.fill(line, width, break_long_words=False, break_on_hyphens=False)


def verdict_lines(prediction: "Prediction") -> Iterator[str]:
    """What flies, where, what becomes of it when let go, and what its film allows."""
    setup, found = prediction.setup, prediction.verdict
    own_mass, payload = _mass(float(setup.flyer.own_mass)), _mass(float(setup.flyer.payload), "g")
    yield f"{setup.flyer.describe()}, {own_mass}, payload {payload}"
    light, bears = f"{prediction.available:.4g} W/m²", f"{found.highest_temperature or 0.0:.0f} K"
    if not prediction.bands:
        yield f"It does not fly in {light}: lift is at most {_most_lift(prediction)}."
        return
    yield f"It flies in {light} {_ranges(prediction, prediction.bands)}."
    rest, best = found.rest, found.best
    if rest is not None:
        film = {
            None: "its film's limit is not stated",
            True: f"its film bears {bears} and survives",
            False: f"too hot for its film, which bears {bears}",
        }[found.survives]
        hot = f"{rest.values['temperature']:.0f} K"
        yield f"Let go, it rests at {_shown(prediction, rest.coordinate)} and {hot}: {film}."
    if found.strongest_light == 0.0:
        yield "No light that lifts it is weak enough for its film at rest."
    elif found.survives is False or math.isfinite(found.strongest_light or math.inf):
        yield f"At rest its film survives in up to {found.strongest_light:.4g} W/m²."
    if found.limit == "film":
        parts = _ranges(prediction, found.usable) if found.usable else "nowhere in that range"
        yield f"Its film survives {parts}{'' if rest else f', as it bears {bears}'}."
    elif rest is None:
        known = found.highest_temperature is not None
        yield (
            f"Its film bears {bears} and survives." if known else "Its film's limit is not stated."
        )
    if best is not None:
        place, payload = (
            _shown(prediction, best.coordinate),
            _mass(float(f"{best.values['payload']:.3g}")),
        )
        yield f"Held at {place} it carries up to {payload}."


def _shown(prediction: "Prediction", coordinate: float) -> str:
    """An altitude or pressure with its unit."""
    factor, unit = prediction.coordinate_key[1], prediction.coordinate.shown_unit
    return f"{coordinate * factor:{'.3g' if prediction.coordinate.logarithmic else '.1f'}} {unit}"


def _ranges(prediction: "Prediction", bands: list[tuple[float, float]]) -> str:
    """Ranges in words; what ends with the search is open."""
    first, last = prediction.coordinates[[0, -1]]
    return " and ".join(
        f"from {'below ' if low <= first else ''}{_shown(prediction, low)} "
        f"to {'above ' if high >= last else ''}{_shown(prediction, high)}"
        for low, high in bands
    )


def _most_lift(prediction: "Prediction") -> str:
    lift = round(float(prediction.best.values["lift_over_weight"]), 2) + 0.0  # and never -0.00
    return f"{lift:.2f} of its weight, at {_shown(prediction, prediction.best.coordinate)}"


def _results(prediction: "Prediction", summary: dict[str, Any]) -> Table:
    """Lines on where it levitates, with how much light, and what it carries."""
    where, light = prediction.coordinate, prediction.available
    key, factor = prediction.coordinate_key
    unit, digits = where.shown_unit, ".3g" if where.logarithmic else ".2f"
    best, easiest = prediction.best, prediction.easiest
    rows: dict[str, str] = {}
    if not prediction.bands:
        rows["levitates"] = f"nowhere at {light:g} W/m²: lift is at most {_most_lift(prediction)}"
    else:
        edge = ".4g" if where.logarithmic else ".3f"
        bands = summary[f"{where.name}_bands{key.removeprefix(where.name)}"]
        shown = ", ".join(f"{low:{edge}} {unit} to {high:{edge}} {unit}" for low, high in bands)
        rows["levitates"] = shown + _pressures(prediction, summary, len(bands))
    if easiest is None:
        rows["least irradiance"] = f"none: no irradiance lifts it at any {where.name}"
    else:
        rows["least irradiance"] = (
            f"{easiest.values['levitation_irradiance']:.1f} W/m² at "
            f"{easiest.coordinate * factor:{digits}} {unit} "
            f"({easiest.values['levitation_temperature']:.1f} K)"
        )
    place = f"at {best.coordinate * factor:{digits}} {unit} ({best.values['temperature']:.1f} K)"
    rows["best payload"] = _payload(best.values, place)
    if prediction.setup.budget is not None:
        rows["payload needs"] = payload_line(best.values)
    return rows_of(rows)


def _pressures(prediction: "Prediction", summary: dict[str, Any], bands: int) -> str:
    """Pressures of the widest band, where the coordinate is another."""
    if prediction.coordinate.name == "pressure":
        return ""
    low, high = summary["pressure_band_pa"]
    return f" ({'widest at ' if bands > 1 else ''}{low:.3g} Pa to {high:.3g} Pa)"


def _mass(kilograms: float, form: str = ".4g") -> str:
    """A mass with a unit that suits it."""
    factor, unit = OUTPUTS["own_mass"].shown_for(kilograms)
    return f"{kilograms * factor:{form}} {unit}"


def _payload(best: dict[str, float], place: str) -> str:
    payload = best["payload"]
    if payload < 0.0:
        return f"none: {_mass(-payload)} short of lifting itself {place}"
    return f"{_mass(payload)}, {best['relative_payload']:.3g} of its own mass, {place}"


def payload_line(best: dict[str, float]) -> str:
    """What the payload needs where the flyer carries most, and what is left."""

    def shown(name: str, form: str = ".4g") -> str:
        output = BUDGET_OUTPUTS[name]
        factor, unit = output.shown_for(best[name])
        return f"{best[name] * factor:{form}} {unit.replace('^2', '²')}"

    if not math.isfinite(best["payload_needed"]):
        return f"{shown('power_needed')}, which its solar cells cannot give there: no light"
    margin = best["payload_margin"]
    parts = [f"{shown('payload_needed')} there", f"{shown('power_needed')}"]
    parts += [f"{shown('cell_area')} of solar cells"] if "cell_area" in best else []
    parts += [f"radio {shown('transmit_power')}"] if "transmit_power" in best else []
    return f"{', '.join(parts)}: {_mass(abs(margin))} {'to spare' if margin >= 0.0 else 'too much'}"


# Heading and format of the columns that every flyer has.
_COLUMNS = {
    "pressure": ("pressure\n[Pa]", ".4g"),
    "gas_temperature": ("gas\n[K]", ".1f"),
    "levitation_irradiance": ("to levitate\n[W/m²]", ".1f"),
    "levitation_temperature": ("then\n[K]", ".1f"),
    "temperature": ("in the light\n[K]", ".1f"),
    "lift": ("lift\n[{}]", ".4g"),
    "lift_over_weight": ("lift /\nweight", ".3f"),
}
_DISPENSABLE = ("pressure", "levitation_temperature", "gas_temperature", "lift", "temperature")
"""Columns that a narrow terminal shows in a table of their own, the first to go first."""

_NODE = ("of the {}\n[K]", ".1f")  # a temperature of one part of the flyer
_ROOMY = 8  # columns that fit a terminal of 80 characters with two spaces between them
_OWN = 5  # results of the flyer's or the force model's own that fit beside the coordinate


def _points_tables(prediction: "Prediction", width: int) -> Iterator[Table]:
    """Tables of the results at each coordinate asked for, those that every flyer has first."""
    # What does not fit the width goes into further tables.
    if not prediction.asked.size:
        return
    nodes = {
        name: (_NODE[0].format(name.removeprefix("temperature_").replace("_", " ")), _NODE[1])
        for name in node_outputs(prediction.setup.flyer)
    }
    names = prediction.point_names
    first = [name for name in names if name in _COLUMNS or name in nodes]
    table = _points_table(prediction, {name: (_COLUMNS | nodes)[name] for name in first})
    if width_of(table).minimum > width:
        first = [name for name in names if name in _COLUMNS]
        table = _points_table(prediction, {name: _COLUMNS[name] for name in first})
    for name in _DISPENSABLE:
        if width_of(table).minimum > width and name in first:
            first.remove(name)
            table = _points_table(prediction, {name: _COLUMNS[name] for name in first})
    yield table
    rest = [name for name in names if name not in first]
    headings = {name: nodes.get(name, (_own_heading(prediction, name), ".4g")) for name in rest}
    for start in range(0, len(rest), _OWN):
        part = rest[start : start + _OWN]
        yield _points_table(prediction, {name: headings[name] for name in part})


def _too_hot(prediction: "Prediction") -> np.ndarray:
    """Where, of the coordinates asked for, the light makes the film hotter than it bears."""
    highest = prediction.verdict.highest_temperature
    return prediction.at["temperature"] > (math.inf if highest is None else highest)


def _own_heading(prediction: "Prediction", name: str) -> str:
    words, known = name.replace("_", " "), outputs_of(prediction.setup)[name]
    return f"{words}\n[{{}}]" if known.shown[1] else words


def _points_table(prediction: "Prediction", headings: dict[str, tuple[str, str]]) -> Table:
    """Table of some results, each with its heading and format."""
    where, (_, factor) = prediction.coordinate, prediction.coordinate_key
    known = outputs_of(prediction.setup)
    marks = np.where(_too_hot(prediction), "*", "")
    columns = {
        f"{where.name}\n[{where.shown_unit}]": [
            f"{mark}{x * factor:.6g}" for mark, x in zip(marks, prediction.asked, strict=True)
        ]
    }
    for name, (heading, form) in headings.items():
        values = prediction.at[name]
        scale, unit = known[name].shown_for(values)
        title = heading.format(unit.replace("^2", "²"))
        columns[title] = [_cell(value * scale, form) for value in values]
    table = Table(box=None, padding=(0, 1), collapse_padding=len(columns) > _ROOMY, pad_edge=False)
    for heading, cells in columns.items():
        # headings may wrap between words, numbers never
        words = max(map(len, [*heading.split(), *cells]))
        table.add_column(heading, justify="right", min_width=words)
    for row in zip(*columns.values(), strict=True):
        table.add_row(*row)
    return table


def _cell(value: float, form: str) -> str:
    return format(value, form) if math.isfinite(value) else "–"
