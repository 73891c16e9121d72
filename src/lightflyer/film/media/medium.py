"""What a layer can be made of: anything that has a complex refractive index over wavelength.

A medium of fixed tables is a :class:`~lightflyer.film.media.materials.Material`. A medium with
parameters, such as a mixture or an oscillator model, is a subclass of :class:`Medium` whose
parameters are its leaves: films are then differentiable in them and fits can free them.
"""

import abc
import dataclasses
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from lightflyer.array.namespace import Numeric
from lightflyer.array.records import AbstractVar, Module
from lightflyer.core.checks import Choice
from lightflyer.core.errors import ParameterError

MICROMETRE = 1e-6
GIVEN = "given by the user"  # Source of a density

_RANGE_TOLERANCE = 1e-9  # relative: rounding of a unit conversion is not an extrapolation


class Extrapolation(Choice):
    """Policy of a medium outside the wavelengths of its data.

    Comparing results of HOLD and LOSSLESS shows how much they depend on the extrapolation.
    """

    ERROR = "error"
    """Raise. Averages are taken over the covered part, with bounds for the rest."""
    HOLD = "hold"
    """Keep n and k of the nearest wavelength with data."""
    LOSSLESS = "lossless"
    """Keep n of the nearest wavelength with data and set k to zero."""


class Medium(Module):
    """What a layer is made of.

    A subclass gives the attributes and the abstract methods below. Parameters that may be varied,
    fitted or differentiated are its leaves; all else is static.

    Attributes
    ----------
    name : str
    density : array or None
        Mass density [kg/m³], may be traced; None where it is unknown.
    density_source : str
        Where the density comes from, or why it is unknown.
    """

    if TYPE_CHECKING:  # a subclass may have them as fields or as properties, which mypy must know

        @property
        def name(self) -> str:
            """Name."""
            ...

        @property
        def density(self) -> Numeric | None:
            """Mass density [kg/m³]."""
            ...

        @property
        def density_source(self) -> str:
            """Where the density comes from."""
            ...

    else:
        name: AbstractVar[str]
        density: AbstractVar[Numeric | None]
        density_source: AbstractVar[str]

    @abc.abstractmethod
    def index(self, wavelength: ArrayLike) -> tuple[Numeric, Numeric]:
        """Refractive index and extinction coefficient [1]."""

    @property
    @abc.abstractmethod
    def wavelength_range(self) -> tuple[float, float]:
        """Shortest and longest wavelength with data [m]."""

    @property
    @abc.abstractmethod
    def usable_range(self) -> tuple[float, float]:
        """Wavelengths at which :meth:`index` answers, extrapolations included [m]."""

    @property
    @abc.abstractmethod
    def source(self) -> str:
        """Where n and k come from."""

    @abc.abstractmethod
    def with_extrapolation(self, policy: Extrapolation | str) -> "Medium":
        """The same medium with another policy outside its data."""

    @abc.abstractmethod
    def with_density(self, density: Numeric) -> "Medium":
        """The same medium with another density [kg/m³]."""

    @abc.abstractmethod
    def extrapolations(self, shortest: float, longest: float) -> tuple[str, ...]:
        """What is extrapolated within a range of wavelengths, with the policy."""

    @property
    def diagnostics(self) -> tuple[str, ...]:
        """What a reader of results must know of n and k, one line each."""
        return ()

    @property
    def sheets(self) -> tuple["Medium", ...]:
        """Homogeneous media of equally thick sheets that stand for a layer, top to bottom."""
        # One, the medium itself, unless the medium changes with depth.
        return (self,)

    def flip(self) -> "Medium":
        """The medium upside down."""
        return self

    def covers(self, wavelength: ArrayLike) -> np.ndarray:
        """Whether there is data at each wavelength."""
        shortest, longest = self.wavelength_range
        wavelength = np.asarray(wavelength)
        above = wavelength >= shortest * (1.0 - _RANGE_TOLERANCE)
        return np.asarray(above & (wavelength <= longest * (1.0 + _RANGE_TOLERANCE)))

    def describe_range(self, *, named: bool = True) -> str:
        """The range of the data in words, such as ``"PET 0.4 µm to 19.942 µm"``."""
        shortest, longest = (f"{end / MICROMETRE:.5g} µm" for end in self.wavelength_range)
        return f"{self.name + ' ' if named else ''}{shortest} to {longest}"


class DataMedium(Medium):
    """A medium whose n and k are known at a range of wavelengths, with a policy outside of it."""

    # A subclass has the fields ``density``, ``density_source`` and ``extrapolation``.

    if TYPE_CHECKING:

        @property
        def extrapolation(self) -> Extrapolation: ...

    else:
        extrapolation: AbstractVar[Extrapolation]

    @property
    def usable_range(self) -> tuple[float, float]:
        extrapolates = self.extrapolation is not Extrapolation.ERROR
        return (0.0, np.inf) if extrapolates else self.wavelength_range

    def with_extrapolation(self: Any, policy: Extrapolation | str) -> Any:
        return dataclasses.replace(self, extrapolation=Extrapolation.of(policy))

    def with_density(self: Any, density: Numeric) -> Any:
        return dataclasses.replace(self, density=density, density_source=GIVEN)

    def extrapolations(self, shortest: float, longest: float) -> tuple[str, ...]:
        if self.extrapolation is Extrapolation.ERROR or np.all(self.covers([shortest, longest])):
            return ()
        return (f"{self.name}: {self.extrapolation} beyond {self.describe_range(named=False)}",)

    def require_covered(self, wavelength: np.ndarray) -> None:
        """Raise where there are no data and the medium does not extrapolate."""
        inside = self.covers(wavelength)
        if self.extrapolation is not Extrapolation.ERROR or np.all(inside):
            return
        missing = np.asarray(wavelength)[~inside].flat[0] / MICROMETRE
        shortest, longest = (end / MICROMETRE for end in self.wavelength_range)
        raise ParameterError(
            f"{self.name} has no data at {missing:.5g} µm, only from {shortest:.5g} µm to "
            f'{longest:.5g} µm; to go beyond, set extrapolation to "{Extrapolation.HOLD}" or '
            f'"{Extrapolation.LOSSLESS}"'
        )


def common_range(ranges: Iterable[tuple[float, float]]) -> tuple[float, float]:
    """Wavelengths that all of some ranges hold [m]; both ends are the same where there are none."""
    ends = list(ranges)
    shortest = max((end[0] for end in ends), default=0.0)
    return shortest, max(shortest, min((end[1] for end in ends), default=np.inf))
