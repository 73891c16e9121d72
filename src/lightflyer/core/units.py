"""Quantities with units, at the edge of the program only: "2 cm" becomes 0.02.

Inside the package every number is SI. Units are Pint's; the registry is built from a short list
of its own (``data/units.txt``) because Pint's full list takes longer to read than a prediction
takes to compute.
"""

import math
import re
import sys
import unicodedata
from collections.abc import Callable
from functools import cache
from importlib import resources
from typing import NamedTuple

import pint

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.text import in_toml


class Measured(NamedTuple):
    """A value in SI units and its standard uncertainty, or None where none is stated.

    Attributes
    ----------
    value : float
    uncertainty : float or None
    """

    value: float
    uncertainty: float | None = None


DIGITS = 12  # Of a number that is written into a file: a prediction from it repeats the search's

_COLD = 100.0  # kelvin, below which a temperature without a unit is meant in °C
_LONGEST, _SHOWN = 200, 40  # characters of a number with its unit; of a longer one in a message
_FAR = 1e6  # a value beside which offsets of temperature scales are small

_SEPARATOR = re.compile(r"\s*(?:±|\+/-|\+-)\s*")
_NUMBER = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$")
_COMMA = re.compile(r",\d")
_FACTOR = r"(?:[A-Za-zµμ°]+(?:(?:\*\*|\^)?-?[1-9]|[²³])?|%)"
_EXPONENT = re.compile(r"(?<=[A-Za-zµμ°])(-?[1-9])")  # of "m2" and "m-2", which Pint does not read
_BELOW = rf"\(\s*{_FACTOR}(?:\s*[*·]\s*{_FACTOR}|\s+{_FACTOR})*\s*\)"  # as in "W/(m*K)"
_UNIT = re.compile(rf"^{_FACTOR}(?:\s*[*/·]\s*{_FACTOR}|\s+{_FACTOR}|\s*/\s*{_BELOW})*$")

_MINUS, _DOT = "\N{MINUS SIGN}", "\N{DOT OPERATOR}"
# Words in any case; symbols are not here, in which case tells mega from milli.
_WORDS = {
    "pascal": "Pa", "pascals": "Pa", "torr": "Torr", "millitorr": "mTorr", "millibar": "mbar",
    "inhg": "inHg", "in hg": "inHg", "in. hg": "inHg", "inches hg": "inHg", "mm hg": "mmHg",
    "mmhg": "mmHg", "micron hg": "mTorr", "microns hg": "mTorr", "kelvin": "K", "kelvins": "K",
    "celsius": "°C", "deg c": "°C", "deg. c": "°C", "degc": "°C", "° c": "°C",
    "fahrenheit": "°F", "deg f": "°F", "deg. f": "°F", "degf": "°F", "° f": "°F",
    "micrometer": "um", "micrometers": "um", "micrometre": "um", "micrometres": "um",
    "nanometer": "nm", "nanometers": "nm", "nanometre": "nm", "nanometres": "nm",
    "angstrom": "angstrom", "angstroms": "angstrom", "\N{LATIN SMALL LETTER A WITH RING ABOVE}":
    "angstrom", "ohm": "ohm", "ohms": "ohm", "\N{GREEK SMALL LETTER OMEGA}": "ohm", "volt": "V",
    "volts": "V", "amp": "A", "amps": "A", "watt": "W", "watts": "W", "sec": "s", "secs": "s",
    "second": "s", "seconds": "s", "sun": "sun", "suns": "sun", "ev": "eV", "percent": "%",
    "degrees_north": "deg", "degrees_east": "deg", "degree_north": "deg", "degree_east": "deg",
    "1/cm": "cm^-1", "1/m": "m^-1",
}  # fmt: skip
_BY_TARGET = {
    ("micron", "Pa"): "mTorr", ("microns", "Pa"): "mTorr",
    ("micron", "m"): "um", ("microns", "m"): "um",
    ("c", "K"): "°C", ("f", "K"): "°F",
}  # fmt: skip
_TORR = re.compile(r"^([mµμu]?)(?:torr|TORR)$")
_MEGA_OR_MILLI = re.compile(r"M(?:[Tt]orr|TORR|[Bb]ar|BAR)")
_CONVENTIONS = {"sun": "1 sun is taken as 1000 W/m^2"}


@cache
def registry() -> pint.UnitRegistry:
    """The package's unit registry."""
    definitions = resources.files("lightflyer") / "data" / "units.txt"
    with resources.as_file(definitions) as path:
        return pint.UnitRegistry(str(path))


def spell_unit(unit: str, target: str) -> str:
    """A unit in the package's spelling, from that of instruments and spreadsheets."""
    # full-width, raised and squared letters as plain ones: ⁻², ℃, ㎛, Å
    text = unicodedata.normalize("NFKC", unit).replace(_MINUS, "-").replace(_DOT, "·").strip()
    text = _TORR.sub(r"\1Torr", text)
    word = " ".join(text.casefold().split())
    return _BY_TARGET.get((word, target)) or _WORDS.get(word, text)


def stated_convention(unit: str) -> str:
    """What a reader must know of a unit that is not the same everywhere; empty where all agree."""
    return _CONVENTIONS.get(spell_unit(unit, ""), "")


def _converter(unit: str, target: str, text: str) -> Callable[[float], float]:
    """Conversion of values from ``unit`` to ``target``, offset included."""
    units = registry()
    written, unit = unit, spell_unit(unit, target)
    if _MEGA_OR_MILLI.fullmatch(unit):
        milli = "mbar" if "b" in unit.casefold() else "mTorr"
        raise ConfigurationError(f'"{text}": unit "{written}" may be milli or mega; write {milli}')
    # checked here because Pint's parser meets malformed text with errors of many kinds
    if len(unit) > _LONGEST or not _UNIT.match(unit):
        raise ConfigurationError(f'"{text[:_LONGEST]}": "{written[:_LONGEST]}" is not a unit')
    try:
        parsed = units.parse_units(_EXPONENT.sub(r"**\1", unit))
    except pint.UndefinedUnitError:
        raise ConfigurationError(
            f'"{text}": unit "{written}" is unknown; {_unit_advice(target, unit)}'
        ) from None
    if not units.is_compatible_with(parsed, units.parse_units(target)):
        raise ConfigurationError(
            f'"{text}": unit "{written}" is of the wrong kind; {_unit_advice(target, unit)}'
        )
    return lambda value: float(units.Quantity(value, parsed).to(target).magnitude)


def is_si(unit: str) -> bool:
    """Whether numbers in a unit of a dataset are in SI units as they are."""
    try:
        parsed = registry().parse_units(_EXPONENT.sub(r"**\1", spell_unit(file_unit(unit), "")))
    except pint.PintError:
        return False
    return bool(registry().Quantity(1.0, parsed).to_base_units().magnitude == 1.0)


def scale_and_offset(unit: str, target: str) -> tuple[float, float]:
    """Factor and offset that convert values of one unit into another."""
    convert = _converter(unit or "dimensionless", target, unit)
    offset = convert(0.0)
    # from far away, where the offset's rounding does not count
    return (convert(_FAR) - offset) / _FAR if offset else convert(1.0), offset


_DATASET_UNITS = {
    "": "1",
    "kg/m^2": "kg m-2",
    "m^2": "m2",
    "kg/m^3": "kg m-3",
    "W/m^2": "W m-2",
    "m/s^2": "m s-2",
    "m/s": "m s-1",
    "W/(m*K)": "W m-1 K-1",
    "deg": "degree",
}


def dataset_unit(unit: str) -> str:
    """A unit in the spelling of datasets, as UDUNITS and CF want it."""
    return _DATASET_UNITS.get(unit, unit)


def file_unit(unit: str) -> str:
    """A unit in the spelling of flyer files, from that of datasets; inverse of the above."""
    written = {there: here for here, there in _DATASET_UNITS.items()}
    return written.get(unit, unit)


def _unit_advice(target: str, unit: str) -> str:
    if target in ("deg", "rad") and unit in ("N", "E", "S", "W"):
        return 'write north and east as "45 deg", south and west as "-45 deg"'
    return f"give one that converts to {target}" if target else "write a pure number or a %"


def _no_unit(text: str | float, value: float, unit: str, usual: str) -> ConfigurationError:
    if not usual:
        usual = "°C" if unit == "K" and value < _COLD else {"rad": "deg"}.get(unit, unit)
    given = in_toml(text)
    return ConfigurationError(f'{given} has no unit; write "{text} {usual}"')


def parse(text: str | float, unit: str, usual: str = "") -> Measured:
    """Read a number with unit and uncertainty; in ``unit``. ``usual``: what messages propose."""
    if isinstance(text, bool) or not isinstance(text, int | float | str):
        raise ConfigurationError(f"{in_toml(text)} is not a number{_with_unit(unit)}")
    if (isinstance(text, int) and abs(text) > sys.float_info.max) or len(str(text)) > _LONGEST:
        raise ConfigurationError(
            f'"{str(text)[:_SHOWN]}…" has {len(str(text))} characters: no number with a unit is so '
            "long"
        )
    if not isinstance(text, str):
        plain = _finite(Measured(float(text)), str(text))
        if unit:
            raise _no_unit(text, text, unit, usual)
        return plain
    first, *rest = _SEPARATOR.split(text)
    if len(rest) > 1:
        raise ConfigurationError(f'"{text}" has more than one ±')
    value, value_unit = _split(first, text, unit)
    uncertainty, own_unit = _split(rest[0], text, unit) if rest else (None, "")
    if own_unit == "%" and not value_unit:
        raise ConfigurationError(
            f'"{text}": relative or absolute? write the uncertainty in the unit of the value'
        )
    value_unit = value_unit or own_unit
    if unit and not value_unit:
        raise _no_unit(text, value, unit, usual)
    convert = _converter(value_unit or "dimensionless", unit, text)
    if uncertainty is None:
        return _finite(Measured(convert(value)), text)
    if uncertainty < 0.0:
        raise ConfigurationError(f'"{text}": the uncertainty is negative')
    spread = _converter(own_unit, unit, text) if own_unit else convert
    # a difference of two conversions, in which the offset of a temperature scale drops out
    return _finite(Measured(convert(value), spread(uncertainty) - spread(0.0)), text)


def rewrite(text: str, value: float, unit: str) -> str:
    """A quantity with another value, in the unit and with the ± that it has; ``unit``: SI unit."""
    own, spread = unit, ""
    if text:
        first, *rest = _SEPARATOR.split(text)
        parts = [_split(part, text, unit) for part in (first, *rest)]
        own = next((found for _, found in parts if found), "")
        spread = f" ± {parts[1][0]:g}" if rest else ""
    scale, offset = scale_and_offset(own, unit) if own and own != unit else (1.0, 0.0)
    return f"{(value - offset) / scale:.{DIGITS}g}{spread} {own}".rstrip()


def _split(part: str, text: str, unit: str) -> tuple[float, str]:
    match = _NUMBER.match(part)
    if match is None:
        raise ConfigurationError(f'"{text}" is not a number{_with_unit(unit)}')
    if _COMMA.match(match[2]):
        raise ConfigurationError(
            f'"{text}" has a comma; write a point before decimals, and nothing between thousands'
        )
    return float(match[1]), match[2]


def _with_unit(unit: str) -> str:
    return f' with a unit, such as "1 {unit}"' if unit else ""


def _finite(measured: Measured, text: str) -> Measured:
    if not math.isfinite(measured.value):
        raise ConfigurationError(f'"{text}" is not a finite number')
    return measured


def number_or_text(text: str) -> float | str:
    """A number without a unit as such; :func:`parse` takes both."""
    try:
        return float(text)
    except ValueError:
        return text
