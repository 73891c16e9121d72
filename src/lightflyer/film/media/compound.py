"""Media of several others: what they share, and tables at several temperatures."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from lightflyer.array import tree
from lightflyer.array.namespace import Numeric, xp
from lightflyer.array.records import AbstractVar, field
from lightflyer.core.checks import is_concrete, is_traced, require_range
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.film.media.materials import Material
from lightflyer.film.media.medium import GIVEN, Extrapolation, Medium, common_range


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
        return common_range(part.wavelength_range for part in self.parts)

    @property
    def usable_range(self) -> tuple[float, float]:
        return common_range(part.usable_range for part in self.parts)

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


class TemperatureDependentMedium(Compound):
    """A medium whose n and k are measured at several temperatures, at one between them.

    Attributes
    ----------
    parts : tuple of Medium
        One per temperature.
    temperatures : tuple of float
        Of the parts, increasing [K].
    temperature : array
        Of the layer [K]; n and k are linear between the two nearest tables.
    measured_density : array or None
        Mass density [kg/m³]; by default that of the first part that has one.

    Raises
    ------
    ParameterError
        If temperatures do not increase, or a concrete ``temperature`` is outside them.

    Notes
    -----
    The layer's temperature is stated: it does not follow from a flyer's heat balance.
    Differentiable in the temperature, from one side at the tables' temperatures. A traced
    temperature beyond the tables, such as a rare sample of an uncertain one, has the values of the
    nearest.
    """

    parts: tuple[Medium, ...]
    temperatures: tuple[float, ...] = field(static=True)
    temperature: Numeric
    measured_density: Numeric | None = None

    def __check_init__(self) -> None:
        steps = np.diff(self.temperatures)
        if len(self.parts) < 2 or len(self.parts) != len(self.temperatures) or np.any(steps <= 0.0):
            raise ParameterError(
                "media at two or more temperatures, which increase, are needed; given are "
                f"{len(self.parts)} at {', '.join(f'{one:g}' for one in self.temperatures)} K"
            )
        name = f"temperature of {self.name}"
        require_range(name, self.temperature, self.temperatures[0], self.temperatures[-1])

    @property
    def name(self) -> str:
        """The parts' names."""
        return " / ".join(dict.fromkeys(part.name for part in self.parts))

    @property
    def density(self) -> Numeric | None:
        """Mass density [kg/m³]."""
        if self.measured_density is not None:
            return self.measured_density
        return next((one.density for one in self.parts if one.density is not None), None)

    @property
    def density_source(self) -> str:
        """Where the density comes from, or why it is unknown."""
        if self.measured_density is not None:
            return GIVEN
        known = (one.density_source for one in self.parts if one.density is not None)
        return next(known, self.parts[0].density_source)

    def index(self, wavelength: ArrayLike) -> tuple[Numeric, Numeric]:
        n, k = indices(self.parts, np.asarray(wavelength, float))
        return _interpolate(n, k, np.array(self.temperatures), self.temperature)

    @property
    def diagnostics(self) -> tuple[str, ...]:
        """Warns of the temperature, and repeats what the parts warn of."""
        at = f"{float(self.temperature):g} K" if is_concrete(self.temperature) else "a temperature"
        tables = ", ".join(f"{one:g}" for one in self.temperatures)
        between = f"{self.name} has n and k at {at}, linear between tables at {tables} K"
        parts = [
            text
            for part in self.parts
            for text in part.diagnostics
            if " has n and k at " not in text
        ]
        return (between, *dict.fromkeys(parts))


def at_temperature(parts: Sequence[Material], temperature: Numeric) -> TemperatureDependentMedium:
    """A medium at a temperature between those of its tables.

    Parameters
    ----------
    parts : sequence of Material
        That state their temperature, such as pages of refractiveindex.info, in any order.
    temperature : float
        [K].

    Returns
    -------
    TemperatureDependentMedium

    Raises
    ------
    ParameterError
        If a part states no temperature.

    Examples
    --------
    >>> from lightflyer.film import material
    >>> warm = at_temperature([material(f"main/Si/Franta-{T}K") for T in (300, 400)], 350.0)
    >>> print(f"{warm.index(10e-6)[0]:.4f}")
    3.4280
    """
    for part in parts:
        if part.temperature is None:
            raise ParameterError(
                f"{part.name} states no temperature; use TemperatureDependentMedium and give it"
            )
    ordered = {float(part.temperature or 0.0): part for part in parts}
    known = tuple(sorted(ordered))
    return TemperatureDependentMedium(tuple(ordered[one] for one in known), known, temperature)


@entry_point
def _interpolate(
    n: Numeric, k: Numeric, temperatures: Numeric, temperature: Numeric
) -> tuple[Numeric, Numeric]:
    steps = xp.searchsorted(temperatures, temperature, side="right") - 1
    lower = xp.clip(steps, 0, temperatures.size - 2)
    share = (temperature - temperatures[lower]) / (temperatures[lower + 1] - temperatures[lower])
    share = xp.clip(share, 0.0, 1.0)  # of a traced temperature, which may be beyond
    return (
        n[lower] + share * (n[lower + 1] - n[lower]),
        k[lower] + share * (k[lower + 1] - k[lower]),
    )
