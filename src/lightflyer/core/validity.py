"""Ranges in which a model is known to hold, and what to say outside of them."""

from collections.abc import Iterable, Iterator
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from lightflyer.array.namespace import Numeric, xp

_MOST_DIGITS = 16


class Validity(NamedTuple):
    """Range of a number within which a model is known to hold."""

    name: str  #: The number in words, such as ``"the Knudsen number"``
    lowest: float  #: Ends of the range
    highest: float  #: Ends of the range
    beyond: str  #: What the model does outside, for the reader of a result

    def diagnostics(self, values: Numeric, pressure: Numeric) -> Iterator[str]:
        """One line for each end of the range that is passed, at the worst of some places."""
        found, where = np.broadcast_arrays(np.asarray(values, float), np.asarray(pressure, float))
        for word, limit, outside in (
            ("below", self.lowest, found < self.lowest),
            ("above", self.highest, found > self.highest),
        ):
            if outside.any():
                apart = np.subtract(found, limit, where=outside, out=np.zeros(found.shape))
                worst = int(np.argmax(np.abs(apart)))
                value = _apart(found.ravel()[worst], limit)
                yield (
                    f"{self.name} is {value} at {where.ravel()[worst]:.3g} Pa, "
                    f"{word} {limit:.3g}: {self.beyond}"
                )


Looks: TypeAlias = Iterable[tuple[Validity, Numeric]]
"""Ranges, each with the numbers of some flyers or places, shape (...), that should be within."""


def describe(looks: Looks, pressure: Numeric) -> tuple[str, ...]:
    """Lines on what is outside; ``pressure`` of the places [Pa], shape (...)."""
    return tuple(line for range_, found in looks for line in range_.diagnostics(found, pressure))


def covers(looks: Looks) -> Any:
    """Whether numbers are all within, shape (...), traceable; what is unknown is not outside."""
    inside: Any = True
    for (_, lowest, highest, _), found in looks:
        inside &= ~((xp.asarray(found) < lowest) | (xp.asarray(found) > highest))
    return inside


def _apart(value: float, limit: float) -> str:
    """The value with as many digits as show that it is not the limit, three at least."""
    shown = (f"{value:.{digits}g}" for digits in range(3, _MOST_DIGITS))
    return next((text for text in shown if text != f"{limit:.3g}"), f"{value!r}")
