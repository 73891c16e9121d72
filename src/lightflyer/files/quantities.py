"""Quantities of options: texts with units, such as ``--diameter "24 mm"``, as numbers."""

import re
from typing import TYPE_CHECKING

from lightflyer.core.errors import ConfigurationError

if TYPE_CHECKING:
    import numpy as np

    from lightflyer.core.units import Measured

_USUAL = {"--diameter": "mm", "--wall": "cm", "--size": "um", "--at": "nm", "--band": "cm^-1"}
"""Units that messages propose, where they are not those of SI."""

_DOUBTFUL = 0.2  # accuracy above which a number without a unit may be per cent

_ENDS = re.compile(r"^\s*([\d.]+)\s*(?:-|–|to)\s*([\d.]+)\s*([^\d\s.]\S*)\s*$")  # of a range

_IMPOSSIBLE = {
    "K": "below absolute zero", "m": "not positive",
    **dict.fromkeys(("Pa", "W/m^2", "m^-1"), "negative"),
}  # fmt: skip


def quantity(option: str, text: str, unit: str) -> "Measured":
    """Value of an option such as ``--diameter "24 mm"``; ``unit``: SI unit of the value."""
    from lightflyer.core.units import number_or_text, parse

    try:
        found = parse(text if unit else number_or_text(text), unit, _USUAL.get(option, ""))
    except ConfigurationError as error:
        raise ConfigurationError(f"{option}: {error}") from None
    if unit in _IMPOSSIBLE and (found.value < 0.0 or (unit == "m" and found.value == 0.0)):
        raise ConfigurationError(f'{option}: "{text}" is {_IMPOSSIBLE[unit]}')
    if unit == "K":
        from lightflyer.core.quantity import Quantity, Temperature, quantity_of

        (quantity_of(Temperature) or Quantity()).check(option, found.value)
    return found


def known(option: str, text: str, unit: str) -> "Measured":
    """The same of an option whose value must exceed its ±."""
    found = quantity(option, text, unit)
    if (found.uncertainty or 0.0) >= found.value:
        raise ConfigurationError(f'{option} "{text}" is not known by its ±')
    return found


def exact(option: str, text: str, unit: str) -> float:
    """Value of an option that has no use for a ±, in SI units."""
    value, spread = quantity(option, text, unit)
    if spread is not None:
        raise ConfigurationError(f'{option} "{text}": takes no ±')
    return value


def quantities(option: str, text: str, unit: str) -> "np.ndarray":
    """Values of an option such as ``--at "550 nm, 10 um"``, at least one; ``unit``: SI unit."""
    import numpy as np

    values = [exact(option, part, unit) for part in text.split(",") if part.strip()]
    if not values:
        raise ConfigurationError(f'{option} "{text}" has no quantity in it')
    return np.array(values)


def ends(option: str, text: str, unit: str) -> tuple[float, float] | None:
    """Ends of a range such as ``"7.5-14 um"``, in SI units; None if the text is none."""
    whole = _ENDS.match(text)
    if whole is None:
        return None
    from lightflyer.core.units import parse

    try:
        low, high = (parse(f"{end} {whole[3]}", unit).value for end in whole.groups()[:2])
    except ConfigurationError as error:
        raise ConfigurationError(f"{option}: {error}") from None
    if low >= high:
        raise ConfigurationError(f'{option} "{text}": {whole[1]} must be below {whole[2]}')
    return low, high


def difference(option: str, text: str, unit: str) -> float:
    """Value of an option that is a difference, for which 1 °C is 1 K."""
    from lightflyer.core.units import parse

    try:
        value = parse(text, unit, difference=True).value
    except ConfigurationError as error:
        raise ConfigurationError(f"{option}: {error}") from None
    if value < 0.0:
        raise ConfigurationError(f'{option}: "{text}" is negative')
    return value


def share(option: str, text: str) -> float:
    """Value of an option that is a share, such as ``--gauge-accuracy "5 %"`` [1]."""
    from lightflyer.core.checks import require_range

    value = exact(option, text, "")
    if value > _DOUBTFUL and "accuracy" in option and "%" not in text:
        said = "" if value >= 1.0 else f', a share of it "{100.0 * value:g} %"'
        raise ConfigurationError(f'{option} "{text}": per cent are written "{text} %"{said}')
    require_range(option, value, 0.0, 1.0)
    return value


def optional_share(option: str, text: str | None) -> float | None:
    """The same of an option without a default, None where it is not given [1]."""
    return None if text is None else share(option, text)
