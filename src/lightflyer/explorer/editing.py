"""Changes of a document that take more than a text, and files of it for the user.

Changes are other alternatives, and where sliders end; files are the design as TOML and Python, and
its results as CSV and NetCDF.
"""

import math
import pprint
import re
import tempfile
from collections.abc import Mapping
from copy import deepcopy
from pathlib import Path
from typing import Any, NamedTuple

import lightflyer
from lightflyer.config.flyer_file import BASES, FileDesign, models_for, sections_in
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Quantity
from lightflyer.core.units import Measured, scale_and_offset
from lightflyer.explorer.compute import prediction_of, uncertainty_of
from lightflyer.explorer.grammar import (
    MISSION,
    base_of,
    example,
    kinds_of_part,
    quantity_text,
    templates,
)
from lightflyer.explorer.maps import Choices
from lightflyer.explorer.state import Document, Workplace, plain, to_toml
from lightflyer.files.section import Alternative, Section
from lightflyer.flyer.base import FlyerSection
from lightflyer.prediction.tables import to_dataset, write_csv

_DECADE = 10.0  # a slider of a positive number reaches so many times below and above
_TWICE = 2.0  # one of a number that may be zero, from there to so many times
_KELVIN = "K"  # temperatures: twice, not ten times
_FROM_ZERO = 10.0  # of the unit, where the number is zero
_UNIT = re.compile(r"[A-Za-zµμ°%].*$")
_EXPONENT = re.compile(r"^([-+]?[\d.]+)[eE][-+]?\d+")

_WIDTH = 88


class Slider(NamedTuple):
    """Ends of a slider, in the unit in which the number is written."""

    value: float
    low: float
    high: float
    logarithmic: bool
    text: str  # The number as it is written, or would be


def sliders(
    design: FileDesign, document: Document, mission: Section | None = None
) -> dict[str, Slider]:
    """Sliders of the numbers that a design has, by dotted name; ``document``: that describes it."""
    found = {}
    parts = design.file.parts()
    if mission is not None:
        parts[MISSION] = mission
    for part, section in parts.items():
        for name, quantity, value in section.numbers():
            if value is not None and math.isfinite(value.value):
                given = value_at(document, f"{part}.{name}")
                text = quantity_text(value, quantity) if given in (None, "") else str(given)
                found[f"{part}.{name}"] = slider(text, value, quantity)
    return found


def slider(text: str, value: Measured, quantity: Quantity) -> Slider:
    """Slider of one number; ``text``: as it is written; ``value``: what that means."""
    found = _UNIT.search(_EXPONENT.sub(r"\1", text.strip()))
    scale, offset = scale_and_offset(found[0], quantity.unit) if found else (1.0, 0.0)
    own = _round((value.value - offset) / scale)
    smallest, largest = quantity.sizes
    least = max(quantity.lowest, smallest if quantity.open_below else -largest)
    most = min(quantity.highest, largest)
    lowest, highest = ((end - offset) / scale for end in (least, most))
    if math.isfinite(quantity.highest - quantity.lowest):
        low, high, logarithmic = lowest, highest, False
        if quantity.open_below:  # such as an emittance: zero itself is impossible
            low = lowest + min(0.01, 0.1 * (own - lowest))
    elif quantity.open_below and offset == 0.0:
        reach = _TWICE if quantity.unit == _KELVIN else _DECADE
        low, high, logarithmic = max(own / reach, lowest), min(own * reach, highest), True
    else:
        reach = _TWICE * abs(own) or _FROM_ZERO
        low, high, logarithmic = max(-reach, lowest), min(reach, highest), False
    return Slider(own, _round(low), _round(high), logarithmic, text)


def _round(number: float) -> float:
    return float(f"{number:.12g}")


def switch_alternative(document: Document, name: str, tag: str) -> Document:
    """A document with another alternative of one of its sections."""
    # The section's content is that of the first template with the alternative. Parts that do not
    # belong to it change with it.
    changed = deepcopy(document)
    *outer, last = name.split(".")
    place = changed
    for key in outer:
        place = place.setdefault(key, {})
        if not isinstance(place, dict):
            raise ConfigurationError(f"{name} is not a section")
    kind = _section_kind(changed, name, tag)
    if kind is None:
        place.pop(last, None)
    else:
        place[last] = _content(kind, tag, place.get(last) or {})
    if name != "flyer":
        return changed
    flyer = FlyerSection.alternatives[FlyerSection.tag_of(changed["flyer"])]
    assert issubclass(flyer, FlyerSection)  # an alternative of that base
    if not flyer.needs_film:
        changed.pop("film", None)
    elif "film" not in changed:
        with_film = (t.document for t in templates().values() if "film" in t.document)
        changed["film"] = plain(deepcopy(next(with_film)["film"]))
    force = changed.get("force")
    if isinstance(force, Mapping) and str(force.get("model", "")) not in models_for(flyer):
        changed["force"] = {"model": flyer.default_model}
    return changed


def _section_kind(document: Document, name: str, tag: str) -> type[Section] | None:
    """Class of another alternative of a section, which an outer section of the document has."""
    if not tag:
        return None
    first, *inner = name.split(".")
    kinds = kinds_of_part(first) if first in (*BASES, "payload", MISSION) else []
    content = document.get(first)
    for key in inner:
        owners = ((kind, base_of(kind)) for kind in kinds if key in kind.model_fields)
        kinds = [
            found
            for kind, base in owners
            if base is None or base.tag_of(content) == kind.tag()  # type: ignore[attr-defined]
            for found in sections_in(kind.model_fields[key].annotation)
        ]
        content = content.get(key) if isinstance(content, Mapping) else None
    for kind in kinds:
        base = base_of(kind)
        if base is None and tag == "given":
            return kind
        if base is not None and tag in base.alternatives:
            return base.alternatives[tag]
    raise ConfigurationError(f"{name} has no alternative {tag[:60]}")


def _content(kind: type[Section], tag: str, before: Mapping[str, Any]) -> dict[str, Any]:
    base = base_of(kind)
    found: dict[str, Any] | None = None
    if base is not None and issubclass(kind, Alternative):  # from the first template that has it
        required = {key for key, info in kind.model_fields.items() if info.is_required()}
        found = next(
            (
                plain(section)
                for template in templates().values()
                for section in template.document.values()
                if isinstance(section, dict)
                and required <= set(section) <= set(kind.model_fields)
                and base.tag_of(section) == kind.tag()
            ),
            None,
        )
    chosen: dict[str, Any] = {}
    if base is not None:
        names = [key for key, _ in base.choosing_keys]
        chosen = dict(zip(names, tag.split(" "), strict=False))
        same = bool(names) and before.get(names[0], base.choosing_keys[0][1]) == chosen[names[0]]
        if found is None or same:
            found = {key: entry for key, entry in before.items() if key in kind.model_fields}
    content = chosen | {k: v for k, v in (found or {}).items() if k not in chosen}
    for key, info in kind.model_fields.items():
        if info.is_required() and key not in content:
            start = {} if sections_in(info.annotation) else plain(example(kind, key))
            content |= {} if start is None else {key: start}
    return content


def value_at(document: Document, name: str) -> Any:
    """What a document says at a dotted name, None where it says nothing."""
    place: Any = document
    for key in name.split("."):
        if isinstance(place, Mapping):
            place = place.get(key)
        elif isinstance(place, list) and key.isdigit() and int(key) < len(place):
            place = place[int(key)]
        else:
            return None
    return place


class Download(NamedTuple):
    """A file for the user."""

    name: str
    kind: str  # Media type
    content: bytes


def download(what: str, workplace: Workplace, document: Document, choices: Choices) -> Download:
    """A file with a design or its results, by what the page calls it; ``choices``: of a figure."""
    if what in ("toml", "mission.toml"):
        if what == "toml":
            workplace.design(document)
            name, command, content = "flyer.toml", "predict", _without_mission(document)
        else:
            workplace.mission(document)
            name, command, content = "mission.toml", "fly", document
        heading = (
            f"# Written by lightflyer explore {lightflyer.__version__}. "
            f"The same numbers come from:  lightflyer {command} {name} --out FOLDER\n\n"
        )
        return Download(name, "application/toml", (heading + to_toml(content)).encode())
    if what == "python":
        workplace.design(document)
        return Download("explored.py", "text/x-python", python_lines(document).encode())
    if what == "csv":
        prediction = prediction_of(workplace.design(document))
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "prediction.csv")
            write_csv(prediction, path)
            return Download(path.name, "text/csv", path.read_bytes())
    if what == "netcdf":
        design = workplace.design(document)
        dataset = to_dataset(prediction_of(design), design.text)
        uncertainty = uncertainty_of(design)
        if uncertainty is not None:
            uncertainty.add_to_dataset(dataset)
        netcdf = bytes(dataset.to_netcdf(engine="h5netcdf"))
        return Download("prediction.nc", "application/x-netcdf", netcdf)
    from lightflyer.explorer.figures import figure_bytes

    figure, _, ending = what.rpartition(".")
    kind = "image/svg+xml" if ending == "svg" else "image/png"
    drawn = figure_bytes(figure, ending, workplace, document, choices)
    return Download(f"lightflyer-{what}", kind, drawn)


def _without_mission(document: Document) -> Document:
    return {name: part for name, part in document.items() if name != MISSION}


def python_lines(document: Document) -> str:
    """Lines of Python that give the results of the page."""
    parts = _without_mission(document)
    literals = {name: pprint.pformat(part, width=_WIDTH, sort_dicts=False)
                for name, part in parts.items()}  # fmt: skip
    arguments = ",\n".join(
        f"    {name}=" + text.replace("\n", "\n    ") for name, text in literals.items()
    )
    lines = f"import lightflyer as lf\n\nflyer_file = lf.FlyerFile(\n{arguments},\n)\n"
    lines += "prediction = lf.predict(flyer_file)\nprint(prediction.summary())\n"
    if MISSION in document:
        lines += (
            "\n# mission.toml is another download of the explorer\n"
            'mission = lf.mission.read_mission_file("mission.toml")\n'
            "flown = lf.fly(mission.design, mission=mission.mission)\n"
            'print(flown.attrs["end"])\n'
        )
    return lines
