"""A comparison in words: lines and tables."""

import math
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

import numpy as np
from rich.table import Table

from lightflyer.design.outputs import BUDGET_OUTPUTS, OUTPUTS, budget_outputs
from lightflyer.files.result_text import Parts, table_of, warning_lines, wrap
from lightflyer.prediction.text import film_lines

_ROUNDING = 1e-6  # of the larger end of a band, below which the other one is zero

if TYPE_CHECKING:
    from lightflyer.comparison.comparison import Compared, Comparison

_LETTERS = "ABCDEFGHI"


def comparison_parts(comparison: "Comparison") -> Parts:
    """The flyers, what each carries at best and over the coordinate, and in what they differ."""
    for letter, found in zip(_LETTERS, comparison.flyers, strict=False):
        yield f"{letter}  {found.name}: {found.description}"
    yield from _best_line(comparison)
    yield _best_table(comparison)
    for letter, found in zip(_LETTERS, comparison.flyers, strict=False):
        if found.prediction.verdict.highest_temperature is not None:
            yield from (wrap(f"{letter}: {line}") for line in film_lines(found.prediction))
    yield _payloads_table(comparison)
    if any(found.prediction.bands for found in comparison.flyers):
        yield "* carries most"
    if any(np.any(_too_hot(found)) for found in comparison.flyers):
        yield "! hotter than the film withstands"
    if any(np.any(found.listed["covered"] < 1.0) for found in comparison.flyers):
        yield "~ outside the range of force model or gas"
    if any(found.setup.budget is not None for found in comparison.flyers):
        yield needs_table(comparison)
    yield from map(wrap, (*map(str, comparison.differing_models),
                          *warning_lines(comparison.warnings)))  # fmt: skip


def _best_line(comparison: "Comparison") -> Iterator[str]:
    """Which of the flyers that fly carries most."""
    best = comparison.best
    if best.prediction.bands:
        where = comparison.coordinate
        scale, mass = comparison.display_unit("payload")
        payload, band, place, *_ = _best_cells(best, scale)
        within = "" if band == "–" else f" ({band})"
        yield f"{best.name} carries most: {payload} {mass}{within} at {place} {where.shown_unit}"


def _best_table(comparison: "Comparison") -> Table:
    """Largest payload that each film survives; the best of all is marked."""
    unit, (scale, mass) = comparison.coordinate.shown_unit, comparison.display_unit("payload")
    headings = ("", f"best payload\n[{mass}]", f"95 % band\n[{mass}]", f"at\n[{unit}]",
                "per area\n[g/m²]", "of own\nmass", "hot\n[K]",
                f"levitates\n[{unit}]")  # fmt: skip
    table = _table(headings)
    for letter, found in zip(_LETTERS, comparison.flyers, strict=False):
        mark = "*" if found is comparison.best and found.prediction.bands else " "
        table.add_row(f"{letter}{mark}", *_best_cells(found, scale))
    return table


def _table(headings: Iterable[str], left: tuple[int, ...] = (0,)) -> Table:
    return table_of(headings, left=left, collapse_padding=True, pad_edge=False)


def _best_cells(found: "Compared", scale: float) -> tuple[str, ...]:
    prediction, digits = found.prediction, _digits(found)
    values, (_, factor) = found.best.values, prediction.coordinate_key
    band = found.best_band("payload")
    shown = {name: values[name] * OUTPUTS[name].shown[0] for name in values if name in OUTPUTS}
    widest = prediction.widest
    # beyond a range that was asked for it may well fly
    flies = "nowhere" if prediction.setup.search_range == (None, None) else "not in range"
    if widest is not None:
        ends = zip(prediction.bands[widest], prediction.coordinates[[0, -1]], "<>", strict=True)
        low, high = (
            f"{open_mark if edge == end else ''}{format(edge * factor, digits)}"
            for edge, end, open_mark in ends
        )
        flies = f"{low} to {high}" + (" …" if len(prediction.bands) > 1 else "")
    return (
        format(values["payload"] * scale, ".4g"),
        "–" if band is None else " to ".join(_ends(band, scale)),
        format(found.best.coordinate * factor, digits),
        format(shown["payload_per_area"], ".3g"),
        format(shown["relative_payload"], ".3g"),
        format(shown["temperature"], ".0f"),
        flies,
    )


def _ends(band: tuple[float, float], scale: float) -> list[str]:
    """Ends of a band; one that is only the rounding of an edge is zero."""
    size = max(map(abs, band))
    return [f"{0.0 if abs(end) < _ROUNDING * size else end * scale:.3g}" for end in band]


def needs_table(comparison: "Comparison") -> Table:
    """What each flyer's payload needs where it carries most, and what is left."""
    having = [found for found in comparison.flyers if found.setup.budget is not None]
    scales, headings = {}, [""]
    for name, output in BUDGET_OUTPUTS.items():
        values = [found.best.values.get(name, math.nan) for found in having]
        scales[name], unit = output.display_unit_for(values)
        headings.append(f"{name.replace('_', ' ')}\n[{unit.replace('^2', '²')}]")
    table = _table(headings)
    for letter, found in zip(_LETTERS, comparison.flyers, strict=False):
        known, best = budget_outputs(found.setup), found.best.values
        cells = [
            format(best[name] * scale, ".4g") if name in known else "–"
            for name, scale in scales.items()
        ]
        table.add_row(letter, *cells)
    return table


def _too_hot(found: "Compared") -> np.ndarray:
    """Where, of the listed coordinates, the film is hotter than it withstands."""
    highest = found.prediction.verdict.highest_temperature
    return found.listed["temperature"] > (math.inf if highest is None else highest)


def _digits(found: "Compared") -> str:
    return ".3g" if found.prediction.coordinate.logarithmic else ".1f"


def _payloads_table(comparison: "Comparison") -> Table:
    """Payload of each flyer at round coordinates; the largest that its film survives is marked."""
    where, (scale, mass) = comparison.coordinate, comparison.display_unit("payload")
    _, factor = comparison.flyers[0].prediction.coordinate_key
    heading = f"{where.name} [{where.shown_unit}]; payload [{mass}]"
    table = _table([heading, *_LETTERS[: len(comparison.flyers)]], left=())
    hot = np.array([_too_hot(found) for found in comparison.flyers])
    payloads = scale * np.array([found.listed["payload"] for found in comparison.flyers])
    best = np.max(np.where(hot, 0.0, payloads), axis=0)
    marks = np.where(hot, "!", np.where(payloads == best, "*", " "))
    outside = np.array([found.listed["covered"] < 1.0 for found in comparison.flyers])
    for index, coordinate in enumerate(comparison.listed):
        cells = [
            f"{'~' * bool(beyond)}{payload:.3g}{mark}" if payload > 0.0 else "– "
            for payload, mark, beyond in zip(
                payloads[:, index], marks[:, index], outside[:, index], strict=True
            )
        ]
        table.add_row(f"{coordinate * factor:.6g}", *cells)
    return table
