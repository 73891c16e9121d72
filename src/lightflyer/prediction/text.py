"""A prediction in words: lines and tables."""

import math
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np
from rich.table import Table

from lightflyer.core.text import rounded
from lightflyer.design.outputs import BUDGET_OUTPUTS, OUTPUTS, node_outputs, outputs_of
from lightflyer.files.result_text import (
    NARROW,
    Parts,
    rows_of,
    warning_lines,
    width_of,
    wrap,
)

if TYPE_CHECKING:
    from lightflyer.prediction.evaluator import Place
    from lightflyer.prediction.prediction import Prediction

_NONE: Mapping[str, Any] = MappingProxyType({})
_TWO_DIGITS = 4.0  # first digit of half a band below which two of its digits are told
_LEAST_BAND = 1e-6  # half of a band over its value, below which none is told
_SMALL_LIFT = 0.01  # over weight, below which two decimals would show zero
_LONGEST_BAR = 24  # characters
_ROOM_OF_WEIGHT = 1.05
_FAR_STRONGER = 3.0  # times the available light, from which on the strongest is not told


Bands: TypeAlias = Mapping[str, tuple[float, float]]
"""95 % bands of results, by their names in the summary of the uncertainty."""


class SampleShares(NamedTuple):
    """In how many samples of its uncertainties a flyer flies, and its film survives at rest."""

    samples: int = 0
    flies: float | None = None  # Share of the samples [1]; None without samples
    survives: float | None = None  # None where the film's limit is not known, too


_UNKNOWN = SampleShares()


def prediction_parts(
    prediction: "Prediction",
    width: int = NARROW,
    bands: Bands = _NONE,
    shares: SampleShares = _UNKNOWN,
    *,
    sources: str = "",
    verbose: bool = False,
    payload: bool = True,
) -> Parts:
    """The verdict, a table around the bands, and what must be known; ``verbose``: all of it."""
    # ``sources``: where the bands are from, or why there are none, in short; ``payload``: tell the
    # largest one
    width = min(width, NARROW)
    told = [*verdict_lines(prediction, bands, shares, payload=payload)]
    yield from (wrap(line, width) for line in told)
    if prediction.asked.size:
        yield from (
            _points_tables(prediction, width) if verbose else [_short_table(prediction, width)]
        )
    too_hot = bool(np.any(_too_hot(prediction)))
    if too_hot:
        yield "* hotter in the light than its film withstands"
    if prediction.asked.size and np.any(_extrapolated(prediction)):
        yield "~ outside the range of force model or gas"
    if prediction.setup.budget is not None and not verbose:
        best = prediction.verdict.best or prediction.best
        yield wrap(f"payload needs {payload_line(best.values)}")
    if verbose:
        yield _results(prediction, prediction.summary())
    yield from (wrap(line, width) for line in warning_lines(prediction.other_warnings))
    has_brackets = any("(" in line for line in told)
    # what lifts it, by which force model, how far that reaches, and where bands are from
    setup, found, covers = prediction.setup, prediction.verdict, ""
    if found.covered != prediction.bands:
        covers = ", which covers nothing of that range: all is extrapolated"
    if covers and found.covered:
        covers = f", which covers it {_ranges(prediction, found.covered, _NONE, 'covered')}"
    if found.best_covered is not None:
        place = _place_text(prediction, found.best_covered.coordinate)
        covers += f", where it carries up to {_most_payload(found.best_covered)} at {place}"
    force = f"force: {type(setup.model).__name__}{covers}{sources * (has_brackets or not bands)}"
    yield wrap(f"lifted by {setup.flyer.lifted_by}; {force}", width)
    if verbose:
        yield wrap("; ".join(prediction.assumptions), width)


def verdict_lines(
    prediction: "Prediction",
    bands: Bands = _NONE,
    shares: SampleShares = _UNKNOWN,
    *,
    payload: bool = True,
) -> Iterator[str]:
    """What flies, where, what becomes of it when released, and what its film allows."""
    setup, found = prediction.setup, prediction.verdict
    own_mass, aboard = _mass(float(setup.flyer.own_mass)), _mass(float(setup.flyer.payload), "g")
    carried = f", payload {aboard}" if float(setup.flyer.payload) else ""
    light = f"{prediction.available:.4g} W/m²"
    visible = setup.environment.state(np.float64(prediction.best.coordinate)).radiation.visible
    if visible is not None and not np.any(visible):
        light = "the dark"
    yield f"{setup.flyer.describe()}, {own_mass}{carried}, in {light}"
    several = f" of {shares.samples} samples"
    if not prediction.bands:
        but = f", but does in {_percent(shares.flies)}{several}" if shares.flies else ""
        lifts = prediction.best.values["payload"] > 0.0  # itself, and a part of its payload
        less = f"; it carries at most {_most_payload(prediction.best, bands)}" if lifts else ""
        yield f"It does not fly{but}: lift is at most {most_lift(prediction, bands)}{less}."
        return
    often = f", in {_percent(shares.flies)}{several}," if shares.flies not in (None, 1.0) else ""
    night = ""
    if found.longest_night is not None and math.isfinite(found.longest_night):
        factor, unit = OUTPUTS["longest_night"].shown
        night = (
            f"; after {rounded(found.longest_night * factor)} {unit} in the dark it is below that"
        )
    yield f"It flies{often} {_ranges(prediction, prediction.bands, bands, 'band')}{night}."
    yield from film_lines(prediction, bands, shares)
    if payload and found.best is not None:
        held = "Afloat at" if found.carries_afloat else "Held at" if found.rest else "At"
        place = _place_text(prediction, found.best.coordinate)
        yield f"{held} {place} it carries up to {_most_payload(found.best, bands)}."


def _survival(survives: bool, band_is_above: bool, share: float | None) -> str:
    """Whether a film survives at rest; ``band_is_above``: its limit."""
    if share in (None, float(survives)):
        but = ", but not in all of that band" if band_is_above else ""
        return f" and survives{but}" if survives else ""
    often = f"in {_percent(share)} of the samples"
    return f" and survives, {often}" if survives else f", and survives {often}"


def _percent(share: float | None) -> str:
    """A share that is neither none nor all."""
    text = f"{100.0 * (share or 0.0):.0f}"
    return f"{100.0 * (share or 0.0):.1f} %" if text in ("0", "100") else f"{text} %"


def film_lines(
    prediction: "Prediction", bands: Bands = _NONE, shares: SampleShares = _UNKNOWN
) -> Iterator[str]:
    """What becomes of a flyer when released, and where and in which light its film survives."""
    found = prediction.verdict
    limit, rest = f"{found.highest_temperature or 0.0:.0f} K", found.rest
    known = found.highest_temperature is not None
    own, of = ("its film", "its film's") if prediction.setup.flyer.film_names() else ("it", "its")
    film = f"{own} withstands {limit}" if known else f"{of} limit is not stated"
    if rest is not None:
        band = bands.get("verdict.rest.temperature_k")
        hot = _with_band(rest.values["temperature"], band, ".0f", "K")
        above = band is not None and band[1] > (found.highest_temperature or 0.0)
        survives = _survival(bool(found.survives), above, shares.survives)
        place = _place_text(prediction, rest.coordinate)
        yield f"Released, it rests at {place} and {hot}; {film}{survives}."
    ways = []
    if found.strongest_light and found.strongest_light < _FAR_STRONGER * prediction.available:
        ways.append(f"in up to {found.strongest_light:.4g} W/m²")
    if found.ballast is not None:
        least = _mass(float(f"{found.ballast[0]:.3g}"))
        ways.append(f"with a payload of {least} or more")
    if ways:
        yield f"At rest {own} survives {', or '.join(ways)}."
    elif found.survives is False:
        yield f"No light that lifts it is weak enough for {own} at rest."
    if found.limit == "film":
        parts = "nowhere in that range"
        if found.usable:
            parts = _ranges(prediction, found.usable, bands, "verdict.usable_band")
        yield f"I{own[1:]} survives {parts}{'' if rest else f', as it withstands {limit}'}."
    elif rest is None:
        yield f"I{film[1:]}{' and survives' if known else ''}."


def _most_payload(best: "Place", bands: Bands = _NONE) -> str:
    """The largest payload where the film survives, with its band."""
    output = OUTPUTS["payload"]
    (factor, unit), (key, json_factor) = (
        output.display_unit_for(best.values["payload"]),
        output.json,
    )
    band = bands.get(f"verdict.best.{key}", bands.get(f"best.{key}"))
    if band is not None:
        band = band[0] * factor / json_factor, band[1] * factor / json_factor
    return _with_band(best.values["payload"] * factor, band, ".3g", unit)


def _with_band(value: float, band: tuple[float, float] | None, form: str, unit: str = "") -> str:
    """A number with as many digits as its 95 % band allows, and that in brackets."""
    half = 0.0 if band is None else 0.5 * (band[1] - band[0])
    unit = f" {unit}" if unit else ""
    if band is None or not _LEAST_BAND * abs(value) < half < math.inf:
        return f"{value:{form}}{unit}"
    power = math.floor(math.log10(half))
    digits = max(0, -power + (half < _TWO_DIGITS * 10.0**power))
    low, high = (f"{end:.{digits}f}" for end in band)
    told = f"{value:.{digits}f}"
    if value and not float(told):  # a small value in a wide band keeps its first digit
        told = f"{value:.1g}"
    return f"{told}{unit} ({low} to {high})"


def _place_text(
    prediction: "Prediction", coordinate: float, band: tuple[float, float] | None = None
) -> str:
    """An altitude or pressure with its unit."""
    factor, where = prediction.coordinate_key[1], prediction.coordinate
    form = ".3g" if where.logarithmic else ".1f"
    return _with_band(coordinate * factor, band, form, where.shown_unit)


def _ranges(
    prediction: "Prediction", ranges: list[tuple[float, float]], bands: Bands, name: str
) -> str:
    """Ranges in words; what ends with the search is open. The widest has bands."""
    first, last = prediction.coordinates[[0, -1]]
    key, where = prediction.coordinate_key[0], prediction.coordinate
    unit = key.removeprefix(where.name)
    name = f"{where.name}_band{unit}" if name == "band" else f"{name}{unit}"
    widest = max(ranges, key=lambda ends: where.to_axis(ends[1]) - where.to_axis(ends[0]))
    words = []
    for ends in ranges:
        low, high = (
            _place_text(prediction, end, bands.get(f"{name}.{edge}") if ends == widest else None)
            for end, edge in zip(ends, ("lower", "upper"), strict=True)
        )
        below = "below " if ends[0] <= first else ""
        above = "above " if ends[1] >= last else ""
        words.append(f"from {below}{low} to {above}{high}")
    return " and ".join(words)


def most_lift(prediction: "Prediction", bands: Bands = _NONE) -> str:
    """Largest lift over weight, and where, as what does not fly tells it."""
    lift = float(prediction.best.values["lift_over_weight"])
    form = ".2f" if abs(lift) >= _SMALL_LIFT else ".1g"
    most = _with_band(lift, bands.get("best.lift_over_weight"), form)
    return f"{most} of its weight, at {_place_text(prediction, prediction.best.coordinate)}"


def _results(prediction: "Prediction", summary: dict[str, Any]) -> Table:
    """Lines on where it levitates, with how much light, and what it carries."""
    where, light = prediction.coordinate, prediction.available
    key, factor = prediction.coordinate_key
    unit, digits = where.shown_unit, ".3g" if where.logarithmic else ".2f"
    best, easiest = prediction.best, prediction.easiest
    rows: dict[str, str] = {}
    if not prediction.bands:
        rows["levitates"] = f"nowhere at {light:g} W/m²: lift is at most {most_lift(prediction)}"
    else:
        edge = ".4g" if where.logarithmic else ".3f"
        bands = summary[f"{where.name}_bands{key.removeprefix(where.name)}"]
        shown = ", ".join(f"{low:{edge}} {unit} to {high:{edge}} {unit}" for low, high in bands)
        rows["levitates"] = shown
        if where.name != "pressure":
            low, high = summary["pressure_band_pa"]
            widest = "widest at " if len(bands) > 1 else ""
            rows["levitates"] += f" ({widest}{low:.3g} Pa to {high:.3g} Pa)"
    if easiest is None:
        rows["least irradiance"] = f"none: no irradiance lifts it at any {where.name}"
    else:
        rows["least irradiance"] = (
            f"{easiest.values['levitation_irradiance']:.1f} W/m² at "
            f"{easiest.coordinate * factor:{digits}} {unit} "
            f"({easiest.values['levitation_temperature']:.1f} K)"
        )
    place = f"at {best.coordinate * factor:{digits}} {unit} ({best.values['temperature']:.1f} K)"
    payload, relative = best.values["payload"], best.values["relative_payload"]
    rows["peak of lift"] = f"{_mass(payload)}, {relative:.3g} of its own mass, {place}"
    if payload < 0.0:
        rows["peak of lift"] = f"none: {_mass(-payload)} short of lifting itself {place}"
    if prediction.setup.budget is not None:
        rows["payload needs"] = payload_line(best.values)
    return rows_of(rows)


def _mass(kilograms: float, form: str = ".4g") -> str:
    """A mass with a unit that suits it."""
    factor, unit = OUTPUTS["own_mass"].display_unit_for(kilograms)
    return f"{kilograms * factor:{form}} {unit}"


def payload_line(best: dict[str, float]) -> str:
    """What the payload needs where the flyer carries most, and what is left."""

    def shown(name: str, form: str = ".4g") -> str:
        output = BUDGET_OUTPUTS[name]
        factor, unit = output.display_unit_for(best[name])
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
    headings = dict(nodes)
    for name, output in outputs_of(prediction.setup).items():
        words = name.replace("_", " ")
        headings.setdefault(name, (f"{words}\n[{{}}]" if output.shown[1] else words, ".4g"))
    for start in range(0, len(rest), _OWN):
        part = rest[start : start + _OWN]
        yield _points_table(prediction, {name: headings[name] for name in part})


def _short_table(prediction: "Prediction", width: int) -> Table:
    """Table of the temperature and of lift over weight as a bar, at each coordinate asked for."""
    names = ("pressure", "gas_temperature", "temperature", "lift_over_weight")
    headings = {name: _COLUMNS[name] for name in names if name != prediction.coordinate.name}
    table = _points_table(prediction, headings)
    lifts = np.nan_to_num(prediction.at["lift_over_weight"])
    room = min(_LONGEST_BAR, width - width_of(table).maximum - 1)
    scale = room / max(1.0, float(lifts.max()) * _ROOM_OF_WEIGHT)
    mark = min(room - 1, round(scale))
    bars = [("█" * max(0, round(lift * scale))).ljust(room) for lift in lifts]
    drawn = [f"{bar[:mark]}│{bar[mark + 1 :]}".rstrip() for bar in bars]
    return _points_table(prediction, headings, ("│: weight", drawn))


def _too_hot(prediction: "Prediction") -> np.ndarray:
    """Where, of the coordinates asked for, the light makes the film hotter than it withstands."""
    highest = prediction.verdict.highest_temperature
    return prediction.at["temperature"] > (math.inf if highest is None else highest)


def _extrapolated(prediction: "Prediction") -> np.ndarray:
    """Where, of the coordinates asked for, force model or gas are outside their ranges."""
    return np.asarray(prediction.at["covered"] < 1.0)


def _points_table(
    prediction: "Prediction",
    headings: dict[str, tuple[str, str]],
    bars: tuple[str, list[str]] | None = None,
) -> Table:
    """Table of some results, each with its heading and format, and perhaps of bars."""
    where, (_, factor) = prediction.coordinate, prediction.coordinate_key
    known = outputs_of(prediction.setup)
    marks = np.where(_extrapolated(prediction), "~", "")
    marks = np.char.add(marks, np.where(_too_hot(prediction), "*", ""))
    columns = {
        f"{where.name}\n[{where.shown_unit}]": [
            f"{mark}{x * factor:.6g}" for mark, x in zip(marks, prediction.asked, strict=True)
        ]
    }
    for name, (heading, form) in headings.items():
        values = prediction.at[name]
        scale, unit = known[name].display_unit_for(values)
        title = heading.format(unit.replace("^2", "²"))
        numbers = (value * scale for value in values)
        columns[title] = [format(one, form) if math.isfinite(one) else "–" for one in numbers]
    table = Table(box=None, padding=(0, 1), collapse_padding=len(columns) > _ROOMY, pad_edge=False)
    for heading, cells in columns.items():
        # headings may wrap between words, numbers never
        words = max(map(len, [*heading.split(), *cells]))
        table.add_column(heading, justify="right", min_width=words)
    if bars is not None:
        columns[bars[0]] = bars[1]
        table.add_column(bars[0], no_wrap=True)
    for row in zip(*columns.values(), strict=True):
        table.add_row(*row)
    return table
