"""What media of several others share."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Numeric, xp
from lightflyer.array.records import AbstractVar
from lightflyer.core.checks import is_traced
from lightflyer.core.entry_point import entry_point
from lightflyer.film.media.medium import Extrapolation, Medium


class Compound(Medium):
    """A medium of several others, whose ranges, policies and sources it has."""

    # A subclass has the fields ``parts`` and ``measured_density``.

    if TYPE_CHECKING:

        @property
        def parts(self) -> tuple[Medium, ...]: ...

    else:
        parts: AbstractVar[tuple[Medium, ...]]

    @property
    def wavelength_range(self) -> tuple[float, float]:
        """Wavelengths at which all parts have data [m]."""
        return _common(part.wavelength_range for part in self.parts)

    @property
    def usable_range(self) -> tuple[float, float]:
        return _common(part.usable_range for part in self.parts)

    @property
    def source(self) -> str:
        return "; ".join(dict.fromkeys(part.source for part in self.parts))

    def extrapolations(self, shortest: float, longest: float) -> tuple[str, ...]:
        found = (text for part in self.parts for text in part.extrapolations(shortest, longest))
        return tuple(dict.fromkeys(found))

    def with_extrapolation(self, policy: Extrapolation | str) -> Any:
        parts = tuple(part.with_extrapolation(policy) for part in self.parts)
        return tree.replace_at(lambda one: one.parts, self, parts)

    def with_density(self, density: Numeric) -> Any:
        """The same medium with a measured density, not that of its parts [kg/m³]."""
        return tree.replace_at(lambda one: one.measured_density, self, density)


def _common(ranges: Iterable[tuple[float, float]]) -> tuple[float, float]:
    ends = list(ranges)
    shortest = max(end[0] for end in ends)
    return shortest, max(shortest, min(end[1] for end in ends))


def indices(media: Sequence[Medium], wavelength: np.ndarray) -> tuple[Numeric, Numeric]:
    """Values of n and k of media, shape (media, ...); ``wavelength``: concrete."""
    n, k = zip(*(medium.index(wavelength) for medium in media), strict=True)
    return stack_arrays(n), stack_arrays(k)


@entry_point
def stack_arrays(values: tuple[Numeric, ...]) -> Numeric:
    """One array of several, in double precision."""
    return xp.stack(xp.broadcast_arrays(*values))


def vector(value: Any) -> Numeric:
    """Fractions as a vector, from a number or a sequence of numbers that may be traced."""
    if isinstance(value, list | tuple) and is_traced(value):
        return stack_arrays(tuple(value))
    if is_traced(value):
        return value if np.ndim(value) else value[None]
    return np.atleast_1d(np.asarray(value, float))
