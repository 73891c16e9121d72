"""Free numbers of a search: their bounds, and how exactly they can be made."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Quantity
from lightflyer.design.design import Field
from lightflyer.study.axes import Distribution, Normal, read_ends

_KEYS = ("from", "to", "scale", "uncertainty")
_PERCENT = re.compile(r"\s*([-+.\deE]+)\s*%\s*")
_WORST_TOLERANCE = 0.3  # relative, beyond which a normal error could make a thickness negative


@dataclass(frozen=True)
class Tolerance(ShortRepr):
    """How exactly a number can be made."""

    size: float  #: Standard uncertainty of the made number: in the unit of the field, or relative
    relative: bool

    def spread(self, value: Any) -> Any:
        """Standard uncertainty in the unit of the field."""
        return self.size * abs(value) if self.relative else self.size + 0.0 * value


@dataclass(frozen=True)
class Bounds(ShortRepr):
    """A number that is free between two ends."""

    field: Field
    low: float  #: In the unit of the field
    high: float  #: In the unit of the field
    logarithmic: bool  #: Whether the search proceeds in the logarithm
    #: How exactly the number can be made; None where nothing is stated
    tolerance: "Tolerance | None" = None

    def value(self, fraction: Any) -> Any:
        """Value at a fraction of the way from the low end (0) to the high end (1)."""
        if self.logarithmic:
            return self.low * (self.high / self.low) ** fraction
        return self.low + fraction * (self.high - self.low)

    def fraction(self, value: float) -> float:
        """Inverse of :meth:`value`."""
        if self.logarithmic:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)


def read_bounds(entry: Mapping[str, Any], known: Field) -> Bounds:
    """Bounds of a free number."""
    low, high, logarithmic = read_ends(entry, known, _KEYS)
    text = entry.get("uncertainty")
    if text is None:
        return Bounds(known, low, high, logarithmic)
    share = _PERCENT.fullmatch(text) if isinstance(text, str) else None
    if share and known.quantity.unit:
        found = Tolerance(float(share[1]) / 100.0, relative=True)
    else:
        # a spread is a difference: any size, and without the offset of a temperature scale
        found = Tolerance(Quantity(known.quantity.unit).read(text).value, relative=False)
    if not found.size > 0.0:
        raise ConfigurationError(f'uncertainty = "{text}" must be positive')
    if known.quantity.lowest == 0.0 and found.spread(low) > _WORST_TOLERANCE * low:
        raise ConfigurationError(
            f'uncertainty = "{text}" is one standard deviation and must be at most '
            f"{100.0 * _WORST_TOLERANCE:g} % of the number wherever it may lie"
        )
    return Bounds(known, low, high, logarithmic, found)


def errors_of(bounds: Bounds) -> Distribution:
    """Errors of a free number, in its standard uncertainties."""
    return _Errors(bounds.field, 0.0, 1.0)


class _Errors(Normal):
    """Normal errors, whatever values the number itself may have."""

    def impossible(self) -> float:
        return 0.0

    def quantile(self, share: np.ndarray) -> np.ndarray:
        from scipy.special import ndtri  # slow to import

        return np.asarray(ndtri(share))
