"""What the page asks for and gets: one function for each question, from JSON to JSON."""

import re
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

import lightflyer
from lightflyer.calibration.points import read_points
from lightflyer.config.flyer_file import FileDesign, models_for
from lightflyer.core.errors import ConfigurationError, LightflyerError
from lightflyer.explorer import view
from lightflyer.explorer.compute import (
    coordinate_factor,
    place_of,
    prediction_of,
    quick,
    readings,
    uncertainty_of,
    values_at,
    verdict_of,
)
from lightflyer.explorer.editing import python_lines, sliders, switch_alternative
from lightflyer.explorer.grammar import MISSION, grammar, templates
from lightflyer.explorer.state import (
    MOST_PINS,
    Document,
    View,
    Workplace,
    from_url,
    plain,
    require_document,
    tags_of,
    to_toml,
    to_url,
    walk,
)
from lightflyer.files.palette import ON_PAGES, SERIES_ON_DARK
from lightflyer.flyer.base import FlyerSection

Answer = dict[str, Any]

_KEY = re.compile(r"^(?:\[([a-z][\w.]*)\]|([a-z]\w*(?:\.\w+)+)|the section \[(\w+)\])")
_NEEDS = re.compile(r"^\[([\w.]+)\] needs ([\w, ]+)$")
_STATIC = Path(__file__).parent / "static"
_KILOMETRE = 1e3  # [m]
_LONGEST = 500  # characters of a message: it may quote what the user gave


def mistake(text: str, key: str = "") -> dict[str, str]:
    """A mistake for the page: one line, and the field that it is about."""
    shown = text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"
    return {"key": key, "text": shown}


def mistakes(message: str) -> list[dict[str, str]]:
    """Mistakes of a design, from the lines of an error."""
    found = []
    for line in message.splitlines() or [""]:
        needs, named = _NEEDS.match(line), _KEY.match(line)
        if needs:
            keys = needs[2].replace(" and ", ", ").split(", ")
            found += [mistake(line, f"{needs[1]}.{key.strip()}") for key in keys]
        else:
            found.append(mistake(line, named[named.lastindex or 0] if named else ""))
    return found


def document_of(content: Mapping[str, Any]) -> Document:
    """The design that a request brings."""
    document = content.get("document")
    require_document(document)
    assert isinstance(document, dict)  # require_document saw to it
    return document


def grammar_of_page(workplace: Workplace, largest_upload: int) -> Answer:
    """All that the page needs before it shows a design; ``largest_upload``: bytes."""
    starts = [{"name": one.name, "title": one.title} for one in templates().values()]
    return grammar() | {
        "starts": starts,
        "version": lightflyer.__version__,
        "largest_upload": largest_upload,
        "most_pins": MOST_PINS,
        "pin_colours": list(view.PIN_COLOURS),
        "file": workplace.name,
        "palette": [[light.lower(), dark.lower()] for light, dark in ON_PAGES.values()]
        + [[light.lower(), dark.lower()] for light, dark in SERIES_ON_DARK.items()],
        "drawn": sorted(path.stem.removeprefix("kind-") for path in _STATIC.glob("kind-*.svg")),
    }


def open_upload(workplace: Workplace, text: str, name: str) -> Answer:
    """Document of a flyer or mission file that the user gave."""
    return _form_of(workplace.from_toml(text, Path(name).name))


def _open(workplace: Workplace, content: Mapping[str, Any]) -> Answer:
    """Document of an address, of a template, or the first one."""
    start, url = str(content.get("start", "")), str(content.get("url", ""))
    if start:
        if start not in templates():
            raise ConfigurationError(f"there is no start {start[:40]}")
        return _form_of(plain(templates()[start].document))
    if not url:
        return _form_of(workplace.initial)
    try:
        found = from_url(url)
    except LightflyerError as error:
        wrong = mistakes(f"{error}; the first design is shown")
        return _form_of(workplace.initial) | {"errors": wrong}
    return _form_of(found.document or workplace.initial, found.at, found.pins)


def _form_of(document: Document, at: str = "", pins: tuple[Document, ...] = ()) -> Answer:
    """A document with what the form needs, at once: results come with the next question."""
    shape = document.get("flyer")
    kind = FlyerSection.alternatives.get(FlyerSection.tag_of(shape))
    return {
        "url": to_url(View(document, at, pins)),
        "document": document,
        "at": at,
        "pins": list(pins),
        "tags": tags_of(document),
        "models": models_for(kind) if kind is not None else [],  # type: ignore[arg-type]
    }


def _switch(workplace: Workplace, content: Mapping[str, Any]) -> Answer:
    """The document with another alternative of a section."""
    section, tag = str(content.get("section", "")), str(content.get("tag", ""))
    changed = switch_alternative(document_of(content), section, tag)
    if section == MISSION and tag:  # released where it flies best, under the sun of its place
        for key in ("irradiance", "incidence"):
            changed.get("environment", {}).pop(key, None)
        found = prediction_of(workplace.design(changed))
        if found.bands and found.coordinate.name == "altitude":
            best = found.verdict.best or found.best
            changed[MISSION]["altitude"] = f"{best.coordinate / _KILOMETRE:.1f} km"
    return _form_of(changed)


def _view_of(content: Mapping[str, Any]) -> View:
    given = content.get("pins")
    pins = given[:MOST_PINS] if isinstance(given, list) else []
    for pin in pins:
        require_document(pin)
    return View(document_of(content), str(content.get("at", "")), tuple(pins))


def _move(workplace: Workplace, content: Mapping[str, Any]) -> Answer:
    """What follows a slider: curves, ends of sliders, address; or what is wrong."""
    shown = _view_of(content)
    answer: Answer = {"url": to_url(shown), "tags": tags_of(shown.document)}
    mission = None
    try:
        design = workplace.design(shown.document)
        if MISSION in shown.document:
            mission = workplace.mission(shown.document).section
    except LightflyerError as error:
        return answer | {"errors": mistakes(str(error))}
    where = design.setup.environment.coordinate
    found = quick(design)
    ends = sliders(design, shown.document, mission)
    answer |= {
        "errors": [],
        "figures": view.curves(found, len(shown.pins)),
        "sliders": {name: one._asdict() for name, one in ends.items()},
        "models": models_for(type(design.file.flyer)),
        "coordinate": {
            "name": where.name,
            "unit": where.shown_unit,
            "logarithmic": where.logarithmic,
        },
    }
    try:
        place = place_of(shown.at, design.setup)
    except ConfigurationError as error:
        return answer | {"errors": mistakes(str(error))}
    if place is not None:
        answer["place"] = _place(design, place)
    return answer


def _place(design: FileDesign, place: float) -> Answer:
    """Results at one altitude or pressure."""
    rows = [asdict(one) for one in values_at(design.setup, place)]
    return {"x": place * coordinate_factor(design.setup.environment.coordinate), "rows": rows}


def _predict(workplace: Workplace, content: Mapping[str, Any]) -> Answer:
    """The whole prediction, where a slider has come to rest."""
    document = document_of(content)
    design = workplace.design(document)
    prediction = prediction_of(design)
    uncertain = bool(design.file.uncertainties() or design.data_bounds())
    return {
        "summary": prediction.summary(),
        "readings": [asdict(one) for one in readings(prediction, None)],
        "verdict": verdict_of(prediction, None, to_be_sampled=uncertain),
        "figures": view.marks(prediction),
        "place": _place(design, (prediction.verdict.best or prediction.best).coordinate),
        "rows": view.rows(prediction),
        "assumptions": list(prediction.assumptions),
        "warnings": [*workplace.diagnostics(document), *prediction.other_warnings],
        "description": f"{prediction.setup.flyer.describe()}, "
        f"{type(prediction.setup.model).__name__}",
        "python": python_lines(document),
        "toml": to_toml(document),
    }


def _pins(workplace: Workplace, content: Mapping[str, Any]) -> Answer:
    """Designs side by side: curves of those pinned, results and differences of all."""
    shown = _view_of(content)
    scale = content.get("scale")
    scale = scale if isinstance(scale, int | float) else 1.0
    designs = [workplace.design(document) for document in (shown.document, *shown.pins)]
    found = [prediction_of(design) for design in designs]
    where = found[0].coordinate
    same = [one.coordinate.name == where.name for one in found]
    sources: dict[str, dict[str, list[Any]]] = {
        figure: {"xs": [], "ys": [], "colour": []} for figure in view.OVER_COORDINATE
    }
    for one, fits, colour in zip(found[1:], same[1:], view.PIN_COLOURS, strict=False):
        if not fits:
            continue
        x = view.plain_list(one.coordinates * coordinate_factor(where))
        for figure, output in view.OVER_COORDINATE.items():
            factor = scale if figure == "payload" else 1.0
            sources[figure]["xs"].append(x)
            sources[figure]["ys"].append(view.plain_list(one.table[output] * factor))
            sources[figure]["colour"].append(colour)
    results = [[asdict(one) for one in readings(one_found, None)] for one_found in found]
    flat = [
        {
            name: str(entry)
            for name, entry in walk(document)
            if entry not in ("", None) and not isinstance(entry, dict | list)
        }
        for document in (shown.document, *shown.pins)
    ]
    keys = dict.fromkeys(key for one in flat for key in one if not key.startswith(f"{MISSION}."))
    values = {key: [one.get(key, "–") for one in flat] for key in keys}
    return {
        "figures": {name: {"sources": {"pins": columns}} for name, columns in sources.items()},
        "results": results,
        "differences": [
            {"key": key, "values": texts} for key, texts in values.items() if len(set(texts)) > 1
        ],
        "warnings": [] if all(same) else ["designs over pressure and over altitude: not drawn"],
    }


def points(workplace: Workplace, text: str, name: str, document: Any) -> Answer:
    """Levitation points of a file, placed on the figure of the irradiance."""
    name = Path(name).name or "points.csv"
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "points.csv")
        path.write_text(text, encoding="utf-8", errors="replace")
        try:
            found = read_points(path)
        except LightflyerError as error:
            raise ConfigurationError(str(error).replace(str(path), name)) from None
    require_document(document)
    design = workplace.design(document)
    where = design.setup.environment.coordinate
    place, warnings = found.pressure, [text.replace(str(path), name) for text in found.warnings]
    if not where.logarithmic:
        table = quick(design)
        pressure = np.log(table.table["pressure"])
        place = np.interp(-np.log(found.pressure), -pressure, table.coordinates)
        warnings.append("points are drawn at the altitude whose pressure they have")
    spread = found.numbers.get("irradiance_uncertainty", np.zeros(len(found)))
    low = np.maximum(found.irradiance - 1.96 * spread, 1e-3 * found.irradiance)
    samples = ", ".join(dict.fromkeys(found.samples))
    return {
        "columns": {
            "x": view.plain_list(place * coordinate_factor(where)),
            "y": view.plain_list(found.irradiance),
            "low": view.plain_list(low),
            "high": view.plain_list(found.irradiance + 1.96 * spread),
            "sample": list(found.samples),
        },
        "words": f"{len(found)} points of {samples} from {name}; bars are 95 % intervals.",
        "warnings": warnings,
    }


ANSWERS: dict[str, Callable[[Workplace, Mapping[str, Any]], Answer]] = {
    "open": _open,
    "switch": _switch,
    "move": _move,
    "predict": _predict,
    "pins": _pins,
}
"""Questions of the page that are answered at once, by name."""


def warm(workplace: Workplace) -> None:
    """Compute the first design, before a page asks for it."""
    design = workplace.design(workplace.initial)
    prediction_of(design)
    uncertainty_of(design)
