"""A comparison in words, as a dataset with units, as comma-separated values, and what differs."""

import csv
import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import lightflyer
from lightflyer.array.records import Module, ShortRepr
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Quantity, quantities_of
from lightflyer.core.text import cell_text
from lightflyer.core.units import dataset_unit, scale_and_offset
from lightflyer.design.design import digest
from lightflyer.design.outputs import BUDGET_OUTPUTS, OUTPUTS, Output, budget_outputs, outputs_of
from lightflyer.design.setup import Setup
from lightflyer.files.result_text import Parts, table_of, warning_lines, wrap

if TYPE_CHECKING:
    import xarray as xr
    from rich.table import Table

    from lightflyer.comparison.comparison import Compared, Comparison

_ROUNDING = 1e-6  # of the larger end of a band, below which the other one is zero

_LETTERS = "ABCDEFGHI"

_FLYER = "flyer"
_OR = "; or "  # between what one name stands for

_RADIATION = "radiation"
_RANGE = "searched"


def comparison_parts(comparison: "Comparison") -> Parts:
    """The flyers, what each carries at best and over the coordinate, and in what they differ."""
    from lightflyer.prediction.text import film_lines, most_lift

    for letter, found in zip(_LETTERS, comparison.flyers, strict=False):
        yield f"{letter}  {found.name}: {found.description}"
    best, unit = comparison.best, comparison.coordinate.shown_unit
    scale, mass = comparison.display_unit("payload")
    if best.prediction.bands:
        payload, band, place, *_ = _best_cells(best, scale)
        within = "" if band == "–" else f" ({band})"
        beyond = "" if best.best.values["covered"] else ", outside the range of force model or gas"
        yield wrap(f"{best.name} carries most: {payload} {mass}{within} at {place} {unit}{beyond}")
    # the largest payload that each film survives; the best of all is marked
    headings = ("", f"best payload\n[{mass}]", f"95 % band\n[{mass}]", f"at\n[{unit}]",
                "per area\n[g/m²]", "of own\nmass", "hot\n[K]",
                f"levitates\n[{unit}]")  # fmt: skip
    table = _table(headings)
    for letter, found in zip(_LETTERS, comparison.flyers, strict=False):
        mark = "*" if found is best and found.prediction.bands else " "
        table.add_row(f"{letter}{mark}", *_best_cells(found, scale))
    yield table
    for letter, found in zip(_LETTERS, comparison.flyers, strict=False):
        if not found.prediction.bands:
            yield f"{letter}: It does not fly: lift is at most {most_lift(found.prediction)}."
        elif found.prediction.verdict.highest_temperature is not None:
            yield from (wrap(f"{letter}: {line}") for line in film_lines(found.prediction))
    yield _payloads_table(comparison)
    if any(np.any(found.listed["payload"] > 0.0) for found in comparison.flyers):
        yield "* carries most"
    if any(np.any(_too_hot(found)) for found in comparison.flyers):
        yield "! hotter than the film withstands"
    if any(np.any(found.listed["covered"] < 1.0) for found in comparison.flyers):
        yield "~ outside the range of force model or gas"
    if any(found.setup.budget is not None for found in comparison.flyers):
        yield needs_table(comparison)
    yield from map(wrap, (*map(str, comparison.differing_models),
                          *warning_lines(comparison.warnings)))  # fmt: skip


def _table(headings: Iterable[str], left: tuple[int, ...] = (0,)) -> "Table":
    return table_of(headings, left=left, collapse_padding=True, pad_edge=False)


def _best_cells(found: "Compared", scale: float) -> tuple[str, ...]:
    prediction = found.prediction
    digits = ".3g" if prediction.coordinate.logarithmic else ".1f"
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


def needs_table(comparison: "Comparison") -> "Table":
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


def _payloads_table(comparison: "Comparison") -> "Table":
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


def to_dataset(comparison: "Comparison") -> "xr.Dataset":
    """A comparison's tables as an xarray dataset.

    Parameters
    ----------
    comparison : Comparison

    Returns
    -------
    xarray.Dataset
        Over ``flyer`` and ``altitude`` [m] or ``pressure`` [Pa]. Every variable has ``units`` and
        ``long_name``; ``..._low`` and ``..._high`` are the ends of 95 % bands. NaN stands for what
        a flyer does not have, and where no irradiance levitates it.
    """
    import xarray as xr

    where = comparison.coordinate
    dims = (_FLYER, where.name)
    variables: dict[str, Any] = {}
    for name, (output, low, values, high) in _columns(comparison).items():
        variables[name] = (dims, values, output.attributes)
        for end, column in (("low", low), ("high", high)):
            if column is not None:
                long_name = f"{output.long_name}, {end} end of the 95 % band"
                about = output.attributes | {"long_name": long_name}
                variables[f"{name}_{end}"] = (dims, column, about)
    flyers = comparison.flyers
    return xr.Dataset(
        variables,
        coords={
            _FLYER: [found.name for found in flyers],
            where.name: (
                where.name,
                comparison.coordinates,
                {"units": dataset_unit(where.unit), "long_name": where.long_name},
            ),
            "description": (_FLYER, [found.description for found in flyers]),
        },
        attrs={
            "title": "lightflyer comparison",
            "lightflyer_version": lightflyer.__version__,
            "warnings": "; ".join(comparison.warnings),
            "summary": json.dumps(comparison.summary(), allow_nan=False),
        },
    )


def write_csv(comparison: "Comparison", path: Path) -> None:
    """Write a comparison's tables as comma-separated values, one row a flyer and coordinate.

    Parameters
    ----------
    comparison : Comparison
    path : Path
        The header has units, in brackets. A cell is empty where there is no number.
    """
    where, columns = comparison.coordinate, _columns(comparison)
    header = [_FLYER, f"{where.name} [{dataset_unit(where.unit)}]"]
    stacks: list[np.ndarray] = []
    for name, (output, low, values, high) in columns.items():
        unit = output.attributes["units"]
        for ending, column in (("", values), ("_low", low), ("_high", high)):
            if column is not None:
                header.append(f"{name}{ending} [{unit}]")
                stacks.append(column)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        for row, found in enumerate(comparison.flyers):
            for place, coordinate in enumerate(comparison.coordinates):
                numbers = (float(stack[row, place]) for stack in stacks)
                cells = (f"{one:.10g}" if np.isfinite(one) else "" for one in numbers)
                writer.writerow([cell_text(found.name), f"{coordinate:.10g}", *cells])


def _columns(
    comparison: "Comparison",
) -> dict[str, tuple[Output, np.ndarray | None, np.ndarray, np.ndarray | None]]:
    """Output, low end, values and high end, each of shape (flyers, n), by name."""
    outputs: dict[str, Output] = {}  # that any of the flyers has, but for the coordinate
    for flyer in comparison.flyers:
        known = outputs_of(flyer.setup)
        for name in flyer.table:
            outputs[name] = join_outputs(outputs.get(name, known[name]), known[name])
    outputs.pop(comparison.coordinate.name, None)
    found = {}
    missing = np.full_like(comparison.coordinates, np.nan)
    for name, output in outputs.items():
        values = [flyer.table.get(name, missing) for flyer in comparison.flyers]
        rows = [np.where(np.isfinite(one), one, np.nan) for one in values]
        bands = [flyer.band(name) for flyer in comparison.flyers]
        low = high = None
        if any(band is not None for band in bands):
            low, high = (
                np.stack([missing if band is None else band[end] for band in bands])
                for end in (0, 1)
            )
        found[name] = (output, low, np.stack(rows), high)
    return found


def join_outputs(one: Output, other: Output) -> Output:
    """Two flyers' output of one name: it may be another thing for each, in the same unit."""
    if one.unit != other.unit:
        raise ConfigurationError(
            f'"{one.name}" is {one.long_name} [{one.unit or "1"}] of one flyer and '
            f"{other.long_name} [{other.unit or '1'}] of another; they cannot be compared"
        )
    if other.long_name in one.long_name.split(_OR):
        return one
    return replace(one, long_name=f"{one.long_name}{_OR}{other.long_name}")


def require_comparable(setups: Iterable[Setup]) -> None:
    """Raise :class:`ConfigurationError` where an output is in another unit for another flyer."""
    found: dict[str, Output] = {}
    for setup in setups:
        for name, output in outputs_of(setup).items():
            found[name] = join_outputs(found.get(name, output), output)


@dataclass(frozen=True)
class Difference(ShortRepr):
    """Something in which flyers differ.

    Attributes
    ----------
    what : str
        Such as ``"light"`` or ``"atmosphere"``.
    values : dict of str to str
        What it is for each flyer, by the flyer's name.
    """

    what: str
    values: dict[str, str]

    def __str__(self) -> str:
        groups: dict[str, list[str]] = {}
        for name, value in self.values.items():
            groups.setdefault(value, []).append(name)
        told = "; ".join(f"{value} ({', '.join(names)})" for value, names in groups.items())
        return f"{self.what}: {told}"


def differing_surroundings(setups: Mapping[str, Setup]) -> tuple[Difference, ...]:
    """In what the surroundings of flyers differ; ``setups``: by the flyer's name."""
    surroundings = {name: setup.environment for name, setup in setups.items()}
    light = tuple(_describe({name: found.assumptions() for name, found in surroundings.items()}))
    skipped = (_RADIATION,) if light else ()
    rest = _differences("", surroundings, Quantity(), skipped)
    searched = {name: _range_of(setup) for name, setup in setups.items()}
    return (*light, *rest, *_if_different(_RANGE, searched))


def differing_models(setups: Mapping[str, Setup]) -> tuple[Difference, ...]:
    """In what the force models of flyers differ; see :func:`differing_surroundings`."""
    models = {name: setup.model for name, setup in setups.items()}
    return tuple(_differences("force model", models, Quantity()))


def _describe(texts: Mapping[str, Sequence[str]]) -> Iterator[Difference]:
    """Differences between descriptions whose texts begin with what they are about."""
    told = {
        name: dict(text.partition(": ")[::2] for text in described)
        for name, described in texts.items()
    }
    for topic in dict.fromkeys(topic for described in told.values() for topic in described):
        values = {name: described.get(topic, "none") for name, described in told.items()}
        yield from _if_different(topic, values)


def _if_different(what: str, values: dict[str, str]) -> Iterator[Difference]:
    if len(set(values.values())) > 1:
        yield Difference(what, values)


def _differences(
    what: str, parts: Mapping[str, Any], quantity: Quantity, skipped: tuple[str, ...] = ()
) -> Iterator[Difference]:
    """Differences between objects, field by field as far down as they are of one kind."""
    first = next(iter(parts.values()))
    if isinstance(first, Module) and len({type(part) for part in parts.values()}) == 1:
        known = quantities_of(type(first))
        for field in fields(first):
            if field.name in skipped:
                continue
            values = {name: getattr(part, field.name) for name, part in parts.items()}
            words = f"{what} {field.name.replace('_', ' ')}".lstrip()
            yield from _differences(words, values, known.get(field.name, Quantity()))
        return
    yield from _if_different(
        what or "surroundings", {name: _text(part, quantity) for name, part in parts.items()}
    )


def _text(value: Any, quantity: Quantity) -> str:
    if isinstance(value, Module):
        return type(value).__name__
    if value is None:
        return "not given"
    if isinstance(value, str | bool):
        return str(value)
    try:
        numbers = np.asarray(value, float)
    except (TypeError, ValueError):
        return str(value)
    if numbers.ndim:
        return f"{numbers.size} numbers ({digest(numbers)})"
    return f"{float(numbers):.9g} {quantity.unit}".rstrip()


def _range_of(setup: Setup) -> str:
    where = setup.environment.coordinate
    factor, _ = scale_and_offset(where.unit, where.shown_unit)
    low, high = (f"{float(end) * factor:g} {where.shown_unit}" for end in setup.searched)
    return f"{low} to {high}"
