"""Ranges in which a model is known to hold, and what to say outside of them."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lightflyer.core.types import Numeric

_MOST_DIGITS = 16


class OutOfRange(str):
    """A line on a number that is outside the range in which a model is known to hold."""

    __slots__ = ("places",)
    places: NDArray[np.bool_]  # Where it is, of the shape of number and pressure

    def __new__(cls, text: str, places: NDArray[np.bool_]) -> "OutOfRange":
        """The line with its places."""
        line = super().__new__(cls, text)
        line.places = places
        return line


class Validity(NamedTuple):
    """Range of a number within which a model is known to hold."""

    name: str  # The number in words, such as ``"the Knudsen number"``
    lowest: float  # Ends of the range
    highest: float  # Ends of the range
    beyond: str  # What the model does outside, for the reader of a result

    def diagnostics(self, values: Numeric, pressure: Numeric) -> Iterator[str]:
        """One line for each end of the range that is passed, at the worst of some places."""
        found, where = np.broadcast_arrays(np.asarray(values, float), np.asarray(pressure, float))
        for word, limit, excess in (
            ("below", self.lowest, self.lowest - found),
            ("above", self.highest, found - self.highest),
        ):
            worst = int(np.argmax(np.where(np.isnan(excess), -np.inf, excess)))
            if excess.ravel()[worst] > 0.0:
                value = _apart(found.ravel()[worst], limit)
                yield OutOfRange(
                    f"{self.name} is {value} at {where.ravel()[worst]:.3g} Pa, "
                    f"{word} {limit:.3g}: {self.beyond}",
                    excess > 0.0,
                )


def _apart(value: float, limit: float) -> str:
    """The value with as many digits as show that it is not the limit, three at least."""
    shown = (f"{value:.{digits}g}" for digits in range(3, _MOST_DIGITS))
    return next((text for text in shown if text != f"{limit:.3g}"), f"{value!r}")
