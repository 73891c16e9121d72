"""Quantities with units, at the edge of the program only: "2 cm" becomes 0.02.

Inside the package every number is SI. The units that files may use are few and stand here: to load
Pint takes a tenth of the time of a prediction. The tests compare each unit with Pint's.
"""

import math
import re
import sys
import unicodedata
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

from lightflyer.core.constants import ZERO_CELSIUS
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

_KILO = 1e3
_COLD = 100.0  # kelvin, below which a temperature without a unit is meant in °C
_LONGEST, _SHOWN = 200, 40  # characters of a number with its unit; of a longer one in a message
_FAR = 1e6  # a value beside which offsets of temperature scales are small

_SEPARATOR = re.compile(r"\s*(?:±|\+/-|\+-)\s*")
_NUMBER = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$")
_COMMA = re.compile(r",\d")
_FACTOR = r"(?:[A-Za-zµμ°]+(?:(?:\*\*|\^)?-?[1-9]|[²³])?|%)"
_BELOW = rf"\(\s*{_FACTOR}(?:\s*[*·]\s*{_FACTOR}|\s+{_FACTOR})*\s*\)"  # as in "W/(m*K)"
_UNIT = re.compile(rf"^{_FACTOR}(?:\s*[*/·]\s*{_FACTOR}|\s+{_FACTOR}|\s*/\s*{_BELOW})*$")

_MINUS, _DOT = "\N{MINUS SIGN}", "\N{DOT OPERATOR}"
# Words in any case; symbols are not here, in which case tells mega from milli.
_WORDS = {
    "pascal": "Pa", "pascals": "Pa", "torr": "Torr", "millitorr": "mTorr", "millibar": "mbar",
    "mb": "mbar", "hpa": "hPa", "hectopascal": "hPa", "hectopascals": "hPa", "m/sec": "m/s",
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
_POINT = re.compile(r"(?<=[A-Za-z\d])\.(?=[A-Za-zµμ])")  # of UDUNITS, as in m.s-1
_TORR = re.compile(r"^([mµμu]?)(?:torr|TORR)$")
_MEGA_OR_MILLI = re.compile(r"M(?:[Tt]orr|TORR|[Bb]ar|BAR)")
_CONVENTIONS = {"sun": "1 sun is taken as 1000 W/m^2"}


class _Unit(NamedTuple):
    """One of a unit, in SI units."""

    factor: float
    power: int  # of ten, beside the factor, so that whole numbers are not rounded
    dimensions: tuple[int, ...]  # powers of the base units
    offset: float = 0.0  # of a temperature scale

    def times(self, other: "_Unit", exponent: int) -> "_Unit":
        """The product with a power of another unit, of a temperature scale as of a difference."""
        pairs = zip(self.dimensions, other.dimensions, strict=True)
        return _Unit(
            self.factor * other.factor**exponent,
            self.power + other.power * exponent,
            tuple(mine + exponent * theirs for mine, theirs in pairs),
        )


_PREFIXES = {
    "tera": 12, "giga": 9, "mega": 6, "kilo": 3, "hecto": 2, "deci": -1, "centi": -2, "milli": -3,
    "micro": -6, "nano": -9, "pico": -12, "femto": -15, "T": 12, "G": 9, "M": 6,
    "k": 3, "h": 2, "d": -1, "c": -2, "m": -3, "µ": -6, "μ": -6, "u": -6, "n": -9, "p": -12,
    "f": -15,
}  # fmt: skip
_BASES = ("metre meter m", "gram g", "second s", "kelvin K", "ampere A", "radian rad", "bit")
_PURE = _Unit(1.0, 0, (0,) * len(_BASES))
# SI Brochure, 9th edition (2019); torr, psi and inch by their legal definitions. An inch of mercury
# is at 0 °C and standard gravity (13.5951 g/cm³, NIST SP 811). A sun is 1000 W/m², as solar cells
# are rated (AM1.5, IEC 60904-3) and as Lu et al. (2023) count; it is not the solar constant.
_DEFINITIONS = (  # names, and what one is: a factor, a power of ten, other units
    ("dimensionless", 1.0, 0, ""),
    ("percent %", 1.0, -2, ""),
    ("degree deg °", math.pi / 180.0, 0, "rad"),
    ("angstrom", 1.0, -10, "m"),
    ("inch in", 2.54, -2, "m"),
    ("foot ft", 30.48, -2, "m"),
    ("knot kt", 1852.0 / 3600.0, 0, "m s^-1"),
    ("mph", 0.44704, 0, "m s^-1"),
    ("minute min", 60.0, 0, "s"),
    ("hour h", 3600.0, 0, "s"),
    ("day d", 86400.0, 0, "s"),
    ("hertz Hz", 1.0, 0, "s^-1"),
    ("newton N", 1.0, 0, "kg m s^-2"),
    ("pascal Pa", 1.0, 0, "N m^-2"),
    ("bar", 1.0, 5, "Pa"),
    ("atmosphere atm", 101325.0, 0, "Pa"),
    ("torr Torr mmHg", 101325.0 / 760.0, 0, "Pa"),
    ("inHg", 25.4 * 13.5951 * 9.80665, 0, "Pa"),
    ("psi", 6894.757293168361, 0, "Pa"),
    ("joule J", 1.0, 0, "N m"),
    ("eV", 1.602176634, -19, "J"),
    ("watt W", 1.0, 0, "J s^-1"),
    ("sun", 1.0, 3, "W m^-2"),
    ("volt V", 1.0, 0, "W A^-1"),
    ("ohm Ω", 1.0, 0, "V A^-1"),
)
_TEMPERATURE_SCALES = (  # names, kelvin of a degree, and of zero
    ("celsius °C degC degreeC", 1.0, ZERO_CELSIUS),
    ("fahrenheit °F degF degreeF", 5.0 / 9.0, 233.15 + 200.0 / 9.0),
)
_TOKEN = re.compile(r"([A-Za-zµμ°Ω%]+)(?:\*\*|\^)?(-?[1-9]|[²³])?|([/()])")
_SUPERSCRIPTS = {"²": 2, "³": 3, "": 1}
_NAMED: dict[str, _Unit] = {}


@lru_cache
def _unit(text: str) -> _Unit:
    """A unit or a product of units; KeyError of an unknown one."""
    if text in _NAMED:
        return _NAMED[text]
    found, sign, in_brackets = _PURE, 1, False
    for name, exponent, mark in _TOKEN.findall(text):
        if mark:
            sign, in_brackets = (1 if mark == ")" else -1), mark == "("
            continue
        number = _SUPERSCRIPTS[exponent] if exponent in _SUPERSCRIPTS else int(exponent)
        found = found.times(_named(name), sign * number)
        if not in_brackets:
            sign = 1
    return found


def _named(name: str) -> _Unit:
    """A unit by its name, which may have a prefix and be a plural; KeyError of an unknown one."""
    for stem in (name, name.removesuffix("s")):
        if stem in _NAMED:
            return _NAMED[stem]
        for prefix, power in _PREFIXES.items():
            unit = _NAMED.get(stem.removeprefix(prefix)) if stem.startswith(prefix) else None
            if unit and not unit.offset:
                return unit._replace(power=unit.power + power)
    raise KeyError(name)


for _place, _names in enumerate(_BASES):
    _powers = tuple(int(_place == other) for other in range(len(_BASES)))
    _one = _Unit(1.0, -3 if "gram" in _names else 0, _powers)  # the base unit is the kilogram
    _NAMED |= dict.fromkeys(_names.split(), _one)
for _names, _factor, _power, _units in _DEFINITIONS:
    _one = _Unit(_factor, _power, _PURE.dimensions).times(_unit(_units), 1)
    _NAMED |= dict.fromkeys(_names.split(), _one)
for _names, _factor, _zero in _TEMPERATURE_SCALES:
    _one = _NAMED["K"]._replace(factor=_factor, offset=_zero)
    _NAMED |= dict.fromkeys(_names.split(), _one)


def spell_unit(unit: str, target: str) -> str:
    """A unit in the package's spelling, from that of instruments and spreadsheets."""
    # full-width, raised and squared letters as plain ones: ⁻², ℃, ㎛, Å
    text = unicodedata.normalize("NFKC", unit).replace(_MINUS, "-").replace(_DOT, "·").strip()
    text = _POINT.sub("·", _TORR.sub(r"\1Torr", text))
    word = " ".join(text.casefold().split())
    return _BY_TARGET.get((word, target)) or _WORDS.get(word, text)


def stated_convention(unit: str) -> str:
    """What a reader must know of a unit that is not the same everywhere; empty where all agree."""
    return _CONVENTIONS.get(spell_unit(unit, ""), "")


def _converter(unit: str, target: str, text: str) -> Callable[[float], float]:
    """Conversion of values from ``unit`` to ``target``, offset included."""
    written, unit = unit, spell_unit(unit, target)
    if _MEGA_OR_MILLI.fullmatch(unit):
        milli = "mbar" if "b" in unit.casefold() else "mTorr"
        raise ConfigurationError(f'"{text}": unit "{written}" may be milli or mega; write {milli}')
    if len(unit) > _LONGEST or not _UNIT.match(unit):
        raise ConfigurationError(f'"{text[:_LONGEST]}": "{written[:_LONGEST]}" is not a unit')
    try:
        given, wanted = _unit(unit), _unit(target)
    except KeyError:
        raise ConfigurationError(
            f'"{text}": unit "{written}" is unknown; {_unit_advice(target, unit)}'
        ) from None
    if given.dimensions != wanted.dimensions:
        raise ConfigurationError(
            f'"{text}": unit "{written}" is of the wrong kind; {_unit_advice(target, unit)}'
        )
    factor, power = given.factor / wanted.factor, given.power - wanted.power
    size = 10.0 ** abs(power)
    offset = (given.offset - wanted.offset) / wanted.factor

    def convert(value: float) -> float:
        scaled = factor * float(value)
        return (scaled * size if power >= 0 else scaled / size) + offset

    return convert


@lru_cache
def scale_and_offset(unit: str, target: str) -> tuple[float, float]:
    """Factor and offset that convert values of one unit into another."""
    convert = _converter(unit or "dimensionless", target, unit)
    offset = convert(0.0)
    # from far away, where the offset's rounding does not count
    return (convert(_FAR) - offset) / _FAR if offset else convert(1.0), offset


def is_si(unit: str) -> bool:
    """Whether numbers in a unit of a dataset are in SI units as they are."""
    try:
        one = _unit(spell_unit(file_unit(unit), ""))
    except KeyError:
        return False
    return one.factor == 1.0 and one.power == 0 and one.offset == 0.0


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
    if usual == f"k{unit}" and abs(value) >= _KILO:  # which is hardly meant
        usual = unit
    if not usual:
        usual = "°C" if unit == "K" and value < _COLD else {"rad": "deg"}.get(unit, unit)
    given = in_toml(text)
    return ConfigurationError(f'{given} has no unit; write "{text} {usual}"')


def parse(text: str | float, unit: str, usual: str = "", *, difference: bool = False) -> Measured:
    """Read a number with unit and uncertainty; in ``unit``. ``usual``: what messages propose.

    ``difference``: whether it is one of two numbers, for which 1 °C is 1 K.
    """
    if isinstance(text, bool) or not isinstance(text, int | float | str):
        raise ConfigurationError(f"{in_toml(text)} is not a number{_with_unit(unit)}")
    if (isinstance(text, int) and abs(text) > sys.float_info.max) or len(str(text)) > _LONGEST:
        raise ConfigurationError(
            f'"{str(text)[:_SHOWN]}…" has {len(str(text))} characters: no number with a unit is so '
            "long"
        )
    if not isinstance(text, str):
        plain = _finite(Measured(float(text)), str(text))
        if unit and not _is_zero(plain.value, unit):
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
    if unit and not value_unit and (rest or not _is_zero(value, unit)):
        raise _no_unit(text, value, unit, usual)
    convert = _converter(value_unit or unit or "dimensionless", unit, text)
    read = convert(value) - (convert(0.0) if difference else 0.0)
    if uncertainty is None:
        return _finite(Measured(read), text)
    if uncertainty < 0.0:
        raise ConfigurationError(f'"{text}": the uncertainty is negative')
    spread = _converter(own_unit, unit, text) if own_unit else convert
    # a difference of two conversions, in which the offset of a temperature scale drops out
    return _finite(Measured(read, spread(uncertainty) - spread(0.0)), text)


def _is_zero(value: float, unit: str) -> bool:
    """Whether a number is zero in whatever unit; that of temperatures is not."""
    return value == 0.0 and unit != "K"


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
