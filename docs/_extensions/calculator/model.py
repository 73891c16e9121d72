"""What the calculator computes: results and ranges of a flyer, by the package itself."""

from __future__ import annotations

import json
import tomllib
from dataclasses import asdict, dataclass
from functools import cache
from typing import Any

import numpy as np

import lightflyer
from lightflyer.array.namespace import within
from lightflyer.cli.commands.init import templates
from lightflyer.config.flyer_file import FileDesign, FlyerFile, models_for
from lightflyer.core.errors import LightflyerError
from lightflyer.core.quantity import quantities_of
from lightflyer.core.units import scale_and_offset
from lightflyer.core.validity import Validity
from lightflyer.design.diagnostics import diagnose_force
from lightflyer.design.operating_point import OperatingPoint
from lightflyer.design.outputs import OUTPUTS
from lightflyer.film.properties import FilmProperties, FilmSection
from lightflyer.flyer.base import FlyerSection
from lightflyer.uncertainty.propagation import DEFAULT_SAMPLES

from .javascript import Tables, write_function
from .kinds import DISK, Kind, Number
from .recorder import NotKnownError, Recorder

SHOWN = (
    "levitation_irradiance",
    "levitation_temperature",
    "temperature",
    "lift_over_weight",
    "payload",
    "relative_payload",
    "own_mass",
    "pressure",
    "gas_temperature",
)
"""Outputs that are shown."""

NUMBERS, COMPUTED = DISK.numbers, DISK.computed

_FIRST = np.random.default_rng(0).bit_generator.state["state"]  # of the generator of predict

TITLES = {
    "lu2023": "Lu et al. (2023)",
    "kinetic": "kinetic equation",
    "free-molecular": "free molecules",
    "free-molecular-linear": "free molecules, linear",
    "schafer2025": "Schafer et al. (2025)",
    "celenza2023": "Celenza et al. (2023)",
}
"""What force models are called where room is short; others keep their names."""


@cache
def template(kind: Kind = DISK) -> dict[str, Any]:
    """The flyer file that ``lightflyer init`` writes, with an emittance for each face."""
    content = tomllib.loads(templates()[kind.template].read())
    film = content.get("film", {})
    if "emittance" in film:
        both = film.pop("emittance")
        film |= {"emittance_top": both, "emittance_bottom": both}
    if any(number.name == "film.tac_correlation" for number in kind.numbers):
        film["tac_correlation"] = 0.0
    return content


@cache
def design(model: str, kind: Kind = DISK) -> FileDesign:
    """The design of ``lightflyer init`` under a force model."""
    content = template(kind)
    own = content["force"] if content["force"]["model"] == model else {"model": model}
    return FlyerFile(**content | {"force": own}).design()


@cache
def force_models(kind: Kind = DISK) -> list[str]:
    """Names of all force models that are for the flyer where it is, the template's first."""
    content = template(kind)
    first, found = content["force"]["model"], []
    section = FlyerSection.alternatives[content["flyer"]["shape"]]
    if "form" in content["flyer"]:
        section = FlyerSection.alternatives[FlyerSection.tag_of(content["flyer"])]
    for name in sorted(models_for(section), key=lambda name: name != first):
        point = start(design(name, kind), kind)
        try:
            point.setup.model.require_gas(point.state.gas)
        except LightflyerError:  # in a gas that it is not for
            continue
        found.append(name)
    return found


def start(base: FileDesign, kind: Kind) -> OperatingPoint:
    """Where the calculator begins."""
    return OperatingPoint(base.build({}), kind.start * factor(kind.coordinate, kind))


@cache
def uncertain(model: str, kind: Kind = DISK) -> dict[str, dict[str, float | None]]:
    """Uncertain numbers of a design that have no slider, such as errors of its force model.

    Returns
    -------
    dict
        Each with its value, standard uncertainty and the ends of its range, in the package's units;
        None for no end. They are the last arguments of the compiled function.
    """
    base, shown = design(model, kind), {number.name for number in kind.numbers}
    found: dict[str, dict[str, float | None]] = {}
    for name, spread in base.uncertainties.items():
        if name in base.fields and name not in shown:
            quantity = base.fields[name].quantity
            ends = (
                end if np.isfinite(end) else None for end in (quantity.lowest, quantity.highest)
            )
            values = (base.number(name) or 0.0, spread, *ends, list(base.fields).index(name))
            keys = ("value", "spread", "least", "most", "rank")
            found[name] = dict(zip(keys, values, strict=True))
    return found


@cache
def factor(number: Number, kind: Kind = DISK) -> float:
    """From the shown unit to the one that the package computes with."""
    first = template(kind)["force"]["model"]
    unit = design(first, kind).fields[number.name].quantity.unit
    return scale_and_offset(number.unit, unit)[0] if number.unit else 1.0


def case(
    base: FileDesign, values: Any, kind: Kind = DISK, others: tuple[str, ...] = ()
) -> OperatingPoint:
    """The flyer of some numbers, in the order of the kind's computed ones and then of others."""
    names = (*(number.name for number in kind.computed), *others)
    named = dict(zip(names, values, strict=True))
    return OperatingPoint(base.build(named), named[kind.coordinate.name])


def ranges_of(one: OperatingPoint) -> tuple[list[tuple[Validity, Any]], tuple[str, ...]]:
    """What a model, its flyer and its gas look at before they warn.

    Parameters
    ----------
    one : OperatingPoint

    Returns
    -------
    ranges : list of (Validity, array)
    notes : tuple of str
        Warnings that depend on no number.
    """
    flyer, state, hot = one.flyer, one.state, one.balance.temperature
    found = [
        *one.setup.model.ranges(flyer, state, hot),
        *state.gas.ranges(state.temperature),
        *state.gas.ranges(hot),
    ]
    try:
        notes = (*one.setup.model.remarks(flyer, state, hot), *flyer.diagnostics(state, hot))
    except NotKnownError:  # depend on numbers, which a recorder has not
        notes = ()
    return found, notes


@dataclass(frozen=True)
class Compiled:
    """A force model in JavaScript.

    Attributes
    ----------
    name : str
    text : str
        A function of that name, ``identifier``.
    identifier : str
    ranges : tuple of Validity
        Of the numbers that stand behind the outputs and ``converged``.
    notes : tuple of str
    """

    name: str
    text: str
    identifier: str
    ranges: tuple[Validity, ...]
    notes: tuple[str, ...]


def compile_model(name: str, tables: Tables, kind: Kind = DISK) -> Compiled:
    """Record a force model and write it in JavaScript."""
    base, identifier = design(name, kind), f"model_{name.replace('-', '_')}"
    others = tuple(uncertain(name, kind))
    looked_at: list[Validity] = []
    notes: list[str] = []

    def point(*values: Any) -> tuple[Any, ...]:
        one = case(base, values, kind, others)
        results = [OUTPUTS[output].value(one) for output in SHOWN]
        ranges, told = ranges_of(one)
        looked_at.extend(range_ for range_, _ in ranges)
        notes.extend(told)
        return *results, one.converged, *(value for _, value in ranges)

    recorder = Recorder()
    with within(jax=recorder):
        given = [recorder.variable() for _ in range(len(kind.computed) + len(others))]
        results = point(*given)
    arguments, found = ([recorder.nodes(one).item() for one in part] for part in (given, results))
    text = write_function(identifier, recorder.graph, arguments, found, tables)
    return Compiled(name, text, identifier, tuple(looked_at), tuple(notes))


def compile_all(kind: Kind = DISK) -> str:
    """All that the page's script needs of the package for a kind, as one script.

    Returns
    -------
    str
        It defines ``lightflyerModel``.
    """
    tables = Tables()
    compiled = [compile_model(name, tables, kind) for name in force_models(kind)]
    functions = "".join(one.text for one in compiled)
    entries = ",".join(f"{json.dumps(one.name)}:{{evaluate:{one.identifier}}}" for one in compiled)
    return (
        f"/* Made from lightflyer {lightflyer.__version__} by docs/_extensions/calculator. */\n"
        '(function(){"use strict";\n'
        f"{tables.text()}{functions}"
        f"globalThis.lightflyerModel={{functions:{{{entries}}},about:{_about(compiled, kind)}}};\n"
        "})();\n"
    )


def _about(compiled: list[Compiled], kind: Kind) -> str:
    """Names, units, ranges and words, in JSON."""
    flyer = design(force_models(kind)[0], kind).setup.flyer
    about = {
        "version": lightflyer.__version__,
        "numbers": [described(number, kind) for number in kind.numbers],
        "outputs": [_output(name, kind) for name in SHOWN],
        "samples": DEFAULT_SAMPLES,
        "random": {key: str(number) for key, number in _FIRST.items()},
        "coordinate": kind.coordinate.name,
        "size": kind.size.name,
        "limits": kind.limits,
        "lights": kind.lights,
        "models": {
            one.name: {
                "title": TITLES.get(one.name, one.name),
                "notes": one.notes,
                "ranges": [_range(range_) for range_ in one.ranges],
                "uncertain": [
                    {"name": key} | value for key, value in uncertain(one.name, kind).items()
                ],
            }
            for one in compiled
        },
        "pushed": {
            sign: list(diagnose_force(flyer, {"lift": np.array([lift])}))
            for sign, lift in (("down", -1.0), ("not", 0.0))
        },
        "template": _fixed(kind),
    }
    return json.dumps(about, ensure_ascii=False, allow_nan=False)


def _fixed(kind: Kind) -> dict[str, dict[str, str]]:
    """Words of the flyer file that no number stands for, by section."""
    varied = {number.name for number in kind.numbers} | {"force.model"}
    found: dict[str, dict[str, str]] = {}

    def take(section: str, content: dict[str, Any]) -> None:
        found[section] = {}
        for key, value in content.items():
            if isinstance(value, dict):
                take(f"{section}.{key}", value)
            elif f"{section}.{key}" not in varied:
                found[section][key] = value

    for section, content in template(kind).items():
        take(section, content)
    return found


def described(number: Number, kind: Kind = DISK) -> dict[str, Any]:
    """What the script must know of a number, with its default and range in the shown unit."""
    base, shown = design(force_models(kind)[0], kind), asdict(number)
    scale = factor(number, kind) if number.computed else 1.0
    if number == kind.coordinate:
        low, high = (end / scale for end in base.setup.searched)
        return shown | {"factor": scale, "default": kind.start, "spread": 0.0, "least": low,
                        "most": high, "positive": number.logarithmic}  # fmt: skip
    *outer, key = number.name.split(".")
    content: Any = template(kind)
    for part in outer:
        content = content[part]
    value, _, unit = _nominal(str(content[key])).partition(" ")
    shift = scale_and_offset(unit, number.unit)[0] if unit and unit != number.unit else 1.0
    of_film = quantities_of(FilmSection) | quantities_of(FilmProperties)
    quantity = of_film.get(key) or base.fields[number.name].quantity
    smallest, largest = quantity.sizes
    least, most = max(quantity.lowest, smallest), min(quantity.highest, largest)
    return shown | {
        "default": float(f"{float(value) * shift:.12g}"),
        "spread": float(f"{base.uncertainties.get(number.name, 0.0) / scale:.12g}"),
        "rank": list(base.fields).index(number.name) if number.computed else None,
        "factor": scale,
        # sizes are those of values other than zero
        "least": (least if quantity.open_below else quantity.lowest) / scale,
        "most": min(most, 1.0) if not number.unit else most / scale,
        "positive": quantity.open_below,
    }


def _nominal(text: str) -> str:
    """A quantity without its ±, as ``"2 cm"`` of ``"2 ± 0.1 cm"``."""
    value, _, rest = text.partition("±")
    return f"{value.strip()} {rest.strip().partition(' ')[2]}".strip() if rest else text


def _output(name: str, kind: Kind) -> dict[str, Any]:
    output = OUTPUTS[name]
    scale, unit = output.shown
    if name in ("payload", "own_mass"):
        scale, unit = scale_and_offset("kg", kind.mass)[0], kind.mass
    return {"name": name, "title": output.long_name, "unit": unit, "factor": scale}


def _range(range_: Validity) -> dict[str, Any]:
    ends = (float(end) if np.isfinite(end) else None for end in (range_.lowest, range_.highest))
    return dict(zip(("name", "lowest", "highest", "beyond"), (range_.name, *ends, range_.beyond),
                    strict=True))  # fmt: skip
