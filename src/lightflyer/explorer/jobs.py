"""Slow figures: each computes in a thread of its own, says how far it is, and can be stopped.

A job takes the workplace, the page's document and what the page chose, and returns the data of
its figure with what a reader must know.
"""

import threading
from collections.abc import Callable
from typing import Any

import numpy as np

from lightflyer.comparison.comparison import FEWEST, side_by_side
from lightflyer.config.flyer_file import FileDesign, models_for
from lightflyer.core.errors import ConfigurationError, LightflyerError
from lightflyer.core.progress import Step, report
from lightflyer.explorer import view
from lightflyer.explorer.compute import (
    coordinate_factor,
    prediction_of,
    readings,
    uncertainty_of,
    verdict_of,
)
from lightflyer.explorer.maps import Choices, payload_map, variable_numbers, words_of
from lightflyer.explorer.state import Document, Workplace
from lightflyer.files.drawing import EXTRAPOLATED
from lightflyer.files.palette import BLUE, GREEN, GREY, LESS, MORE, ORANGE, PURPLE, SKY, VERMILION
from lightflyer.film.layered_section import LayeredFilmSection
from lightflyer.film.optics.spectra import planck
from lightflyer.film.summary import FilmSummary
from lightflyer.mission.areas import describe_place
from lightflyer.mission.report.figures import MOST_LINES, map_view, shores
from lightflyer.mission.report.summary import day_and_night
from lightflyer.prediction.evaluator import Evaluator

STEP = 1e-3
"""Relative change of a number in central differences; their error is of the order of its square."""

_MOST_BARS = 14
_SMALL = 1e-6  # of an effect, not shown
_ROOM = 0.05  # of a map's width, around it
_MICROMETRE, _HOUR, _KILOMETRE, _HALF_TURN = 1e-6, 3600.0, 1e3, 180.0
_TEMPERATURES = np.array([250.0, 300.0, 350.0, 400.0])
_HEAT = 300.0  # K, of the black body behind a spectrum
_BEHIND = 0.45  # height of the shaded spectra
_MODEL_COLOURS = (BLUE, GREEN, PURPLE, VERMILION, SKY, GREY)  # orange is the light available
_DASHES = ("solid", "dashed", "dotdash", "dotted")


class StoppedError(Exception):
    """The page no longer wants the result."""


_HERE = threading.local()


def pass_on(step: Step) -> None:
    """Tell a step to the job of this thread; for as long as the server runs steps come here."""
    listener = getattr(_HERE, "listener", None)
    if listener is not None:
        listener(step)


def bands(workplace: Workplace, document: Document, _: Choices) -> dict[str, Any]:
    """95 % bands of the curves and of the results."""
    design = workplace.design(document)
    report("propagating the ±")
    uncertainty = uncertainty_of(design)
    note = "No ± is stated: write one, such as 0.90 ± 0.03, to see bands."
    if uncertainty is not None:
        names = ", ".join(uncertainty.inputs.names)
        note = (
            f"Shaded, and beside results: 95 % bands, from {uncertainty.samples} samples of the ± "
            f"of {names}, as lightflyer predict has them."
        )
    found = readings(prediction_of(design), uncertainty)
    return {
        "figures": view.bands(uncertainty),
        "readings": [reading.__dict__ for reading in found],
        "verdict": verdict_of(prediction_of(design), uncertainty),
        "note": note,
        "warnings": [] if uncertainty is None else list(uncertainty.warnings),
    }


def designs_by_model(
    workplace: Workplace, document: Document
) -> tuple[dict[str, FileDesign], list[str]]:
    """The same flyer under each force model that is for it; returns ``designs``, ``left_out``."""
    designs: dict[str, FileDesign] = {}
    left_out = []
    for tag in models_for(type(workplace.design(document).file.flyer)):
        own = document.get("force", {}).get("model") == tag
        force = document["force"] if own else {"model": tag}
        report(f"computing with {tag}")
        try:
            design = workplace.design({**document, "force": force})
            prediction_of(design)
        except LightflyerError as error:
            left_out.append(f"{tag}: {str(error).partition(chr(10))[0]}")
        else:
            designs[tag] = design
    if len(designs) < FEWEST:
        only = ", ".join(designs) or "none"
        reasons = "; ".join(left_out) or "the package has no other"
        raise ConfigurationError(f"this flyer has one usable force model, {only}: {reasons}")
    return designs, left_out


def force_models(workplace: Workplace, document: Document, _: Choices) -> dict[str, Any]:
    """The least irradiance by all force models that are for the flyer."""
    designs, left_out = designs_by_model(workplace, document)
    report("comparing")
    found = side_by_side({name: prediction_of(design) for name, design in designs.items()})
    where = found.coordinate
    factor = coordinate_factor(where)
    looks = [(colour, dash) for dash in _DASHES for colour in _MODEL_COLOURS]
    columns = ("xs", "ys", "colour", "name", "dash", "alpha")
    lines: dict[str, list[Any]] = {column: [] for column in columns}
    legend, words = [], []
    for one, (colour, dash) in zip(found.flyers, looks, strict=False):
        needed = one.table["levitation_irradiance"]
        inside = np.where(one.table["covered"] > 0.0, needed, np.nan)
        for light, alpha in ((needed, view.FAINT), (inside, 1.0)):
            entries = (found.coordinates * factor, light, colour, one.name, dash, alpha)
            for column, entry in zip(columns, entries, strict=True):
                lines[column].append(entry)
        legend.append(view.Line(one.name, colour, dash))
        easiest = one.prediction.easiest
        if easiest is not None:
            least = easiest.values["levitation_irradiance"]
            words.append(f"{one.name}: at least {least:.4g} W/m²")
    available = float(found.flyers[0].setup.environment.radiation.irradiance)
    legend.append(view.Line("available", ORANGE, "dashed"))
    legend.append(view.Line(EXTRAPOLATED, GREY, "area"))
    every = np.concatenate([*lines["ys"], [available]])
    finite = every[np.isfinite(every) & (every > 0.0)]
    low = view.round_down(0.7 * float(finite.min()))
    high = min(view.round_up(1.2 * float(finite.max())), view.round_up(3e2 * low))
    ends = tuple(float(end) * factor for end in found.coordinates[[0, -1]])
    return view.figure_data(
        {"curves": lines, "level": {"x": np.array(ends), "y": np.full(2, available)}},
        x=ends,  # type: ignore[arg-type]
        y=(low, max(high, 1.2 * available)),
        labels=(view.axis_label(where), "irradiance needed [W/m²]"),
        legend=legend,
        words="; ".join(words) + ".",
        warnings=[*(f"left out: {text}" for text in left_out), *found.warnings],
    )


def film_summary(design: FileDesign) -> tuple[str, FilmSummary]:
    """Name and optics of the first film of layers; returns ``name``, ``summary``."""
    for name, section in design.file.films().items():
        if isinstance(section, LayeredFilmSection):
            report(f"computing the optics of {name}")
            return name, FilmSummary.of(section.film(), section.light(), _TEMPERATURES)
    raise ConfigurationError(
        "the film is given by measured numbers: choose layers to see their spectrum"
    )


def film_spectrum(workplace: Workplace, document: Document, _: Choices) -> dict[str, Any]:
    """Reflectance, transmittance and absorptance of a film of layers over wavelength."""
    name, summary = film_summary(workplace.design(document))
    optics, micrometres = summary.optics, summary.wavelength / _MICROMETRE
    ends = float(micrometres[0]), float(micrometres[-1])
    lit = (summary.light.wavelength >= ends[0] * _MICROMETRE) & (
        summary.light.wavelength <= ends[1] * _MICROMETRE
    )
    light = summary.light.wavelength[lit], summary.light.irradiance[lit]
    heat = summary.wavelength, planck(summary.wavelength, _HEAT)
    legend = [
        view.Line("absorptance", VERMILION),
        view.Line("reflectance", BLUE, "dashed"),
        view.Line("transmittance", GREEN, "dashdot"),
        view.Line(f"{summary.light.name} (shape)", ORANGE, "area"),
        view.Line(f"black body, {_HEAT:g} K (shape)", GREY, "area"),
    ]
    absorbed = float(summary.lamp["top"].value)
    emitted = float(np.asarray(summary.thermal["top"].value)[1])
    return view.figure_data(
        {
            "curve": {
                "x": micrometres,
                "absorptance": np.asarray(optics.absorptance),
                "reflectance": np.asarray(optics.reflectance),
                "transmittance": np.asarray(optics.transmittance),
            },
            "light": _shape(*light),
            "heat": _shape(*heat),
        },
        x=ends,
        y=(0.0, 1.0),
        labels=("wavelength [µm]", "share, normal incidence"),
        legend=legend,
        words=f"Of {name}: absorptance {absorbed:.3f} for {summary.light.name}, emittance of the "
        f"top face {emitted:.3f} at {_TEMPERATURES[1]:g} K.",
        warnings=list(summary.warnings),
    )


def _shape(wavelength: np.ndarray, spectrum: np.ndarray) -> dict[str, np.ndarray]:
    """A spectrum per logarithm of wavelength, so that equal areas are equal powers."""
    per_log = np.asarray(wavelength * spectrum)
    return {
        "x": np.asarray(wavelength) / _MICROMETRE,
        "zero": np.zeros_like(per_log),
        "y": _BEHIND * per_log / per_log.max(),
    }


SENSITIVE = {
    "levitation_irradiance": "least irradiance",
    "lift_over_weight": "lift over weight",
    "temperature": "flyer's temperature",
}
"""Outputs whose sensitivities are shown, in words."""


def sensitivity(workplace: Workplace, document: Document, choices: Choices) -> dict[str, Any]:
    """By how many per cent a result changes where a number of the design changes by one."""
    design = workplace.design(document)
    output = choices.output if choices.output in SENSITIVE else next(iter(SENSITIVE))
    prediction = prediction_of(design)
    place = prediction.best if prediction.easiest is None else prediction.easiest
    if not np.isfinite(place.values[output]):
        raise ConfigurationError(f"no light lifts this flyer: {SENSITIVE[output]} is not finite")
    known = variable_numbers(design)
    at = np.array([place.coordinate])
    found: dict[str, float] = {}
    for done, (name, quantity) in enumerate(known.items()):
        report("computing sensitivities", done, len(known), "numbers")
        own = float(design.number(name) or 0.0)
        ends = [own * (1.0 - STEP), min(own * (1.0 + STEP), quantity.highest)]
        low, high = (float(Evaluator(design.build({name: end}))(at)[output][0]) for end in ends)
        if low > 0.0 and high > 0.0 and np.isfinite(low * high):
            found[name] = float(np.log(high / low) / np.log(ends[1] / ends[0]))
    where = prediction.coordinate
    felt = {name: value for name, value in found.items() if abs(value) > _SMALL}
    names = sorted(felt, key=lambda name: abs(felt[name]))[-_MOST_BARS:]
    values = np.array([felt[name] for name in names])
    reach = float(np.abs(values).max(initial=0.1)) * 1.1
    labels = [words_of(name) for name in names]
    texts = [f"{value:+.3g} % for +1 %" for value in values]
    best = f"{place.coordinate * coordinate_factor(where):.4g} {where.shown_unit}"
    largest = ", ".join(
        f"{label} {text}" for label, text in list(zip(labels, texts, strict=True))[:-4:-1]
    )
    return view.figure_data(
        {
            "bars": {
                "name": labels,
                "value": values,
                "colour": [MORE if value > 0.0 else LESS for value in values],
                "text": texts,
            }
        },
        x=(-reach, reach),
        y=(0.0, 1.0),
        labels=(f"change of the {SENSITIVE[output]} [%] for +1 % of", ""),
        legend=(view.Line("grows with it", MORE, "area"), view.Line("falls", LESS, "area")),
        words=f"Sensitivity of the {SENSITIVE[output]} at {best}: {largest}. By central "
        f"differences of {100.0 * STEP:g} %.",
        factors=labels,
        elasticities=found,
        outputs=SENSITIVE,
        output=output,
    )


def flown(workplace: Workplace, document: Document) -> tuple[FileDesign, Any]:
    """Fly the mission of a page; returns ``design``, ``dataset``."""
    from lightflyer.mission.mission import fly

    flight = workplace.mission(document)
    report("flying")
    return flight.design, fly(flight.design, mission=flight.mission)


def mission(workplace: Workplace, document: Document, _: Choices) -> dict[str, Any]:
    """Altitude over time with day and night, and the way over the ground, by ``lf.fly``."""
    design, dataset = flown(workplace, document)
    hours = dataset.elapsed.values / _HOUR
    altitude = dataset.altitude.values / _KILOMETRE
    spans = day_and_night(dataset)
    nights = [(begin / _HOUR, end / _HOUR) for begin, end, is_day in spans if not is_day]
    end = float(dataset.end_elapsed) / _HOUR, float(dataset.end_altitude) / _KILOMETRE
    ended = f"After {end[0]:.4g} h, at {end[1]:.4g} km, the flyer {dataset.attrs['end']}."
    lowest = prediction_of(design).verdict.lowest_release
    if lowest is not None and end[1] * _KILOMETRE < lowest:
        ended += f" That is below {lowest / _KILOMETRE:.4g} km, from where on light lifts it."
    members = [] if "ensemble_altitude" not in dataset else dataset.ensemble_altitude.values
    heights = [line / _KILOMETRE for line in members[:MOST_LINES]]
    warnings = dataset.attrs["warnings"].splitlines()
    legend = [view.Line("flyer", BLUE), view.Line("night", GREY, "area")]
    return view.figure_data(
        {
            "curve": {
                "x": hours,
                "y": altitude,
                "light": dataset.irradiance.values,
                "temperature": dataset.temperature.values,
            },
            "members": {"xs": [hours] * len(heights), "ys": heights},
            "nights": {
                "low": np.array([night[0] for night in nights]),
                "high": np.array([night[1] for night in nights]),
            },
            "end": {"x": np.array([end[0]]), "y": np.array([end[1]])},
        },
        x=(0.0, float(hours[-1])),
        y=view.round_range(np.concatenate([altitude, *heights])),
        labels=("time since the release [h]", "altitude [km]"),
        legend=legend + _MEMBERS[: len(heights)],
        words=ended,
        warnings=warnings,
        assumptions=dataset.attrs["assumptions"].splitlines(),
        track=_track(dataset),
    )


_MEMBERS = [view.Line("members of the ensemble", SKY)]


def _track(dataset: Any) -> dict[str, Any]:
    """The way over the ground, with coastlines."""
    shown = map_view(dataset)
    longitude, latitude = dataset.longitude.values, dataset.latitude.values
    ends = float(dataset.end_longitude), float(dataset.end_latitude)
    way: dict[str, list[Any]] = {"xs": [], "ys": []}
    if "ensemble_longitude" in dataset:
        ensemble = dataset.ensemble_longitude.values, dataset.ensemble_latitude.values
        for line in zip(*(values[:MOST_LINES] for values in ensemble), strict=True):
            for column, values in zip(way.values(), shown.line(*line), strict=True):
                column.append(values)
    room, coast = _ROOM * (shown.east - shown.west), [np.empty((2, 0))]
    for line in shores(dataset):
        x, y = np.pad(line, [(0, 0), (0, 1)], constant_values=np.nan)
        inside = (x > shown.west - room) & (x < shown.east + room)
        inside &= (y > shown.south - room) & (y < shown.north + room)
        kept = inside | np.roll(inside, 1)  # with a gap where it leaves
        coast.append(np.stack([np.where(inside, x, np.nan), y])[:, kept])
    shore_x, shore_y = np.concatenate(coast, axis=1)
    placed = shown.points(longitude)
    jumps = np.abs(np.diff(placed, prepend=placed[:1])) > _HALF_TURN
    times = np.datetime_as_string(dataset.time.values, unit="m")
    start = describe_place(latitude[0], longitude[0])
    return view.figure_data(
        {
            "curve": {
                "x": placed,
                "y": np.where(jumps, np.nan, latitude),  # no line from edge to edge of the map
                "utc": [text.replace("T", " ") + " UTC" for text in times],
            },
            "members": way,
            "shores": {"x": shore_x, "y": shore_y},
            "release": {"x": placed[:1], "y": latitude[:1]},
            "end": {"x": shown.points(np.array(ends[:1])), "y": np.array(ends[1:])},
        },
        x=(shown.west, shown.east),
        y=(shown.south, shown.north),
        labels=("longitude [°]", "latitude [°]"),
        legend=[view.Line("flyer", BLUE), *_MEMBERS[: len(way["xs"])], view.Line("coast", GREY)],
        words=f"From {start} to {describe_place(*ends[::-1])}.",
        latitude=view.plain_list(latitude),
    )


JOBS: dict[str, Callable[[Workplace, Document, Choices], dict[str, Any]]] = {
    "bands": bands,
    "map": payload_map,
    "models": force_models,
    "film": film_spectrum,
    "sensitivity": sensitivity,
    "mission": mission,
}
"""Jobs by the name of the figure that they fill."""


def run(
    name: str,
    workplace: Workplace,
    document: Document,
    choices: Choices,
    tell: Callable[[Step], None],
    stop: threading.Event,
) -> dict[str, Any]:
    """Do a job; data of the figure; ``name``: one of :data:`JOBS`."""

    def listener(step: Step) -> None:
        if stop.is_set():
            raise StoppedError
        tell(step)

    _HERE.listener = listener
    try:
        return JOBS[name](workplace, document, choices)
    finally:
        _HERE.listener = None
