"""What the calculator computes: results, ranges and slopes of a disk, by the package itself."""

from __future__ import annotations

import json
import tomllib
from dataclasses import asdict, dataclass
from functools import cache
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

import lightflyer
from lightflyer.cli.commands.init import templates
from lightflyer.config.flyer_file import FileDesign, flyer_file_type, models_for
from lightflyer.core.precision import float64
from lightflyer.core.quantity import quantities_of
from lightflyer.core.units import scale_and_offset
from lightflyer.core.validity import Validity
from lightflyer.design.diagnostics import diagnose_force
from lightflyer.design.operating_point import OperatingPoint
from lightflyer.design.outputs import OUTPUTS
from lightflyer.film.properties import FilmProperties
from lightflyer.flyer.disk import DiskSection
from lightflyer.program.javascript.writer import Tables, write_function
from lightflyer.program.tracing import trace_numbers

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

SLOPE_OF = "levitation_irradiance"
"""Output whose slopes are shown."""


@dataclass(frozen=True)
class Number:
    """A number that a reader may change.

    Attributes
    ----------
    name : str
        As in a design; ``altitude`` for the coordinate.
    label : str
    unit : str
        As a flyer file has it, empty for a pure number.
    low, high : float
        Ends of its slider, in the unit.
    digits : int
        Digits after the point of one step.
    logarithmic : bool
        Whether the slider is.
    computed : bool
        Whether results depend on it; a limit changes none.
    """

    name: str
    label: str
    unit: str
    low: float
    high: float
    digits: int = 2
    logarithmic: bool = False
    computed: bool = True


GROUPS = {
    "Flyer": (
        Number("flyer.diameter", "diameter", "cm", 0.1, 20.0, 3, logarithmic=True),
        Number("flyer.payload", "payload carried", "mg", 0.0, 10.0, 2),
        Number("altitude", "altitude", "km", 20.0, 120.0, 1),
    ),
    "Film": (
        Number("film.areal_density", "areal density", "g/m^2", 0.05, 20.0, 3, logarithmic=True),
        Number("film.absorptance", "absorptance for sunlight", "", 0.01, 1.0),
        Number("film.emittance_top", "emittance, top", "", 0.01, 1.0),
        Number("film.emittance_bottom", "emittance, bottom", "", 0.01, 1.0),
        Number("film.tac_top", "accommodation coefficient (TAC), top", "", 0.3, 1.0),
        Number("film.tac_bottom", "accommodation coefficient (TAC), bottom", "", 0.3, 1.0),
        Number("film.highest_temperature", "temperature it bears", "K", 300.0, 1500.0, 0,
               computed=False),
    ),
    "Light and heat around": (
        Number("environment.irradiance", "irradiance of the beam", "W/m^2", 0.0, 5000.0, 0),
        Number("environment.incidence", "beam from the vertical", "deg", 0.0, 85.0, 0),
        Number("environment.albedo", "albedo below", "", 0.0, 1.0),
        Number("environment.infrared_bottom", "heat radiation from below", "W/m^2", 0.0, 400.0, 0),
        Number("environment.infrared_top", "heat radiation from above", "W/m^2", 0.0, 400.0, 0),
    ),
}  # fmt: skip
"""Numbers by the heading that they stand under."""

NUMBERS = tuple(number for group in GROUPS.values() for number in group)
COMPUTED = tuple(number for number in NUMBERS if number.computed)
"""Arguments of the compiled functions, in order."""

TITLES = {
    "lu2023": "Lu et al. (2023)",
    "kinetic": "kinetic equation",
    "free-molecular": "free molecules",
    "free-molecular-linear": "free molecules, linear",
}
"""What force models are called where room is short; others keep their names."""

_ALTITUDE = "altitude"
_START = 80.0  # altitude to start from, near the strongest lift by the kinetic force [km]


def template() -> dict[str, Any]:
    """The flyer file that ``lightflyer init`` writes, with an emittance for each face."""
    content = tomllib.loads(templates()["earth"].read())
    both = content["film"].pop("emittance")
    content["film"] |= {"emittance_top": both, "emittance_bottom": both}
    return content


@cache
def design(model: str) -> FileDesign:
    """The design of ``lightflyer init`` under a force model."""
    content = template() | {"force": {"model": model}}
    return flyer_file_type()(**content).design()


def force_models() -> list[str]:
    """Names of all force models for a disk, the default first."""
    first = DiskSection.default_model
    return sorted(models_for(DiskSection), key=lambda name: name != first)


@cache
def factor(number: Number) -> float:
    """From the shown unit to the one that the package computes with."""
    unit = design(force_models()[0]).fields[number.name].quantity.unit
    return scale_and_offset(number.unit, unit)[0] if number.unit else 1.0


def case(base: FileDesign, values: Any) -> OperatingPoint:
    """The flyer of some numbers, in the order of :data:`COMPUTED`."""
    named = {number.name: value for number, value in zip(COMPUTED, values, strict=True)}
    return OperatingPoint(base.build(named), named[_ALTITUDE])


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
    return found, (*one.setup.model.remarks(flyer, state, hot), *flyer.diagnostics(state, hot))


@dataclass(frozen=True)
class Compiled:
    """A force model in JavaScript.

    Attributes
    ----------
    name : str
    text : str
        Two functions, ``<identifier>`` and ``<identifier>_slopes``.
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


def compile_model(name: str, tables: Tables) -> Compiled:
    """Trace a force model and write it in JavaScript."""
    base, identifier = design(name), f"model_{name.replace('-', '_')}"
    looked_at: list[Validity] = []
    notes: list[str] = []

    def point(*values: Any) -> tuple[Any, ...]:
        one = case(base, values)
        results = [OUTPUTS[output].value(one) for output in SHOWN]
        ranges, told = ranges_of(one)
        looked_at.extend(range_ for range_, _ in ranges)
        notes.extend(told)
        return *results, one.converged, *(value for _, value in ranges)

    with float64():
        text = write_function(identifier, trace_numbers(point, len(COMPUTED)), tables)
        slopes = trace_numbers(slopes_of(base), len(COMPUTED))
        text += write_function(f"{identifier}_slopes", slopes, tables)
    return Compiled(name, text, identifier, tuple(looked_at), tuple(notes))


def slopes_of(base: FileDesign) -> Any:
    """Make the function that gives the slopes of the irradiance to levitate."""

    def irradiance(values: tuple[Any, ...]) -> Any:
        return jnp.asarray(OUTPUTS[SLOPE_OF].value(case(base, values)))

    return lambda *values: jax.grad(irradiance)(values)


def compile_all() -> str:
    """All that the page's script needs of the package, as one script.

    Returns
    -------
    str
        It defines ``lightflyerModel``.
    """
    tables = Tables()
    compiled = [compile_model(name, tables) for name in force_models()]
    functions = "".join(one.text for one in compiled)
    entries = ",".join(
        f"{json.dumps(one.name)}:{{evaluate:{one.identifier},slopes:{one.identifier}_slopes}}"
        for one in compiled
    )
    return (
        f"/* Made from lightflyer {lightflyer.__version__} by docs/_extensions/calculator. */\n"
        '(function(){"use strict";\n'
        f"{tables.text()}{functions}"
        f"globalThis.lightflyerModel={{functions:{{{entries}}},about:{_about(compiled)}}};\n"
        "})();\n"
    )


def _about(compiled: list[Compiled]) -> str:
    """Names, units, ranges and words, in JSON."""
    about = {
        "version": lightflyer.__version__,
        "numbers": [described(number) for number in NUMBERS],
        "outputs": [_output(name) for name in SHOWN],
        "models": {
            one.name: {
                "title": TITLES.get(one.name, one.name),
                "notes": one.notes,
                "ranges": [_range(range_) for range_ in one.ranges],
            }
            for one in compiled
        },
        "pushed": {
            sign: next(diagnose_force({"lift": np.array([lift])}))
            for sign, lift in (("down", -1.0), ("not", 0.0))
        },
        "template": _fixed(),
    }
    return json.dumps(about, ensure_ascii=False, allow_nan=False)


def _fixed() -> dict[str, dict[str, str]]:
    """Words of the flyer file that no number stands for, by section."""
    found = {}
    for section, content in template().items():
        varied = {number.name for number in NUMBERS} | {"force.model"}
        found[section] = {
            key: value for key, value in content.items() if f"{section}.{key}" not in varied
        }
    return found


def described(number: Number) -> dict[str, Any]:
    """What the script must know of a number, with its default and range in the shown unit."""
    start = design(force_models()[0])
    shown = asdict(number)
    if number.name == _ALTITUDE:
        low, high = (end / factor(number) for end in start.setup.searched)
        return shown | {"factor": factor(number), "default": _START, "least": low,
                            "most": high, "positive": False}  # fmt: skip
    section, key = number.name.split(".")
    default = str(template()[section][key]).removesuffix(number.unit)
    quantity = quantities_of(FilmProperties).get(key) or start.fields[number.name].quantity
    smallest, largest = quantity.sizes
    least, most = max(quantity.lowest, smallest), min(quantity.highest, largest)
    scale = factor(number) if number.computed else 1.0
    return shown | {
        "default": float(default),
        "factor": scale,
        # sizes are those of values other than zero
        "least": (least if quantity.open_below else quantity.lowest) / scale,
        "most": min(most, 1.0) if not number.unit else most / scale,
        "positive": quantity.open_below,
    }


def _output(name: str) -> dict[str, Any]:
    output = OUTPUTS[name]
    scale, unit = output.shown
    return {"name": name, "title": output.long_name, "unit": unit, "factor": scale}


def _range(range_: Validity) -> dict[str, Any]:
    ends = (float(end) if np.isfinite(end) else None for end in (range_.lowest, range_.highest))
    return dict(zip(("name", "lowest", "highest", "beyond"), (range_.name, *ends, range_.beyond),
                    strict=True))  # fmt: skip
