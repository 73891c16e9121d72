"""Refractive index and density of what a film is made of.

A :class:`Material` interpolates measured n and k between the wavelengths of its source and
knows where they end. Outside that range it raises, unless the user has chosen one of the named
:class:`Extrapolation` policies; every result then lists the materials that were extrapolated.
"""

import dataclasses
import enum
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lightflyer.film.material_csv import read_index_csv
from lightflyer.foundation.errors import ParameterError
from lightflyer.foundation.units import Measured

MICROMETRE = 1e-6
GIVEN = "given by the user"

_RANGE_TOLERANCE = 1e-9  # relative: rounding of a unit conversion is not an extrapolation
_WIDEST_STEP = 0.01  # relative: what lies between two sources' ends closer than this is no gap


class Extrapolation(enum.StrEnum):
    """Policy of a material outside the wavelengths of its data.

    Comparing results of HOLD and LOSSLESS shows how much they depend on the extrapolation.
    """

    ERROR = "error"
    """Raise. Averages are taken over the covered part, with bounds for the rest."""
    HOLD = "hold"
    """Keep n and k of the nearest wavelength with data."""
    LOSSLESS = "lossless"
    """Keep n of the nearest wavelength with data and set k to zero."""


class Segment(NamedTuple):
    """A stretch of wavelengths with one source.

    Attributes
    ----------
    shortest, longest : float
        Wavelengths covered [m].
    source : str
        Database page or file.
    lookup : callable
        Takes wavelengths inside [m], returns n and k [1].
    """

    shortest: float
    longest: float
    source: str
    lookup: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclasses.dataclass(frozen=True, eq=False)
class Material:
    """Complex refractive index n + ik and mass density of a material.

    Attributes
    ----------
    name : str
    segments : tuple of Segment
        In order of wavelength. Across a gap between two of them n and k are linear.
    density : float or None
        Mass density [kg/m³]; None where it depends on the sample and must be given.
    density_source : str
    description : str
        What was measured.
    tac : Measured or None
        Thermal accommodation coefficient of its surface in air [1]; None if never measured.
    tac_source : str
    extrapolation : Extrapolation
        Policy outside the range.

    Raises
    ------
    ParameterError
        If a density is not positive.
    """

    name: str
    segments: tuple[Segment, ...]
    density: float | None = None
    density_source: str = ""
    description: str = ""
    tac: Measured | None = None
    tac_source: str = ""
    extrapolation: Extrapolation = Extrapolation.ERROR

    def __post_init__(self) -> None:
        if self.density is not None and not (np.isfinite(self.density) and self.density > 0.0):
            raise ParameterError(f"density of {self.name} = {self.density:g} is not positive")

    @property
    def wavelength_range(self) -> tuple[float, float]:
        """Shortest and longest wavelength with data [m]."""
        return self.segments[0].shortest, self.segments[-1].longest

    @property
    def gaps(self) -> tuple[tuple[float, float], ...]:
        """Wavelengths between two sources [m], across which n and k are linear."""
        ends = zip(self.segments, self.segments[1:], strict=False)
        found = ((left.longest, right.shortest) for left, right in ends)
        return tuple(gap for gap in found if gap[1] > gap[0] * (1.0 + _WIDEST_STEP))

    @property
    def source(self) -> str:
        """Where n and k come from."""
        return "; ".join(segment.source for segment in self.segments)

    def with_extrapolation(self, policy: Extrapolation | str) -> "Material":
        """The same material with another policy outside its data.

        Parameters
        ----------
        policy : Extrapolation or str

        Returns
        -------
        Material

        Raises
        ------
        ParameterError
            If the policy is unknown.
        """
        try:
            return dataclasses.replace(self, extrapolation=Extrapolation(policy))
        except ValueError:
            names = ", ".join(Extrapolation)
            raise ParameterError(
                f'extrapolation "{policy}" is unknown; choose from {names}'
            ) from None

    def with_density(self, density: float) -> "Material":
        """The same material with another density [kg/m³]."""
        return dataclasses.replace(self, density=density, density_source=GIVEN)

    def covers(self, wavelength: np.ndarray | float) -> np.ndarray:
        """Whether there is data at each wavelength.

        Parameters
        ----------
        wavelength : array, shape (...)
            [m].

        Returns
        -------
        bool array, shape (...)
        """
        shortest, longest = self.wavelength_range
        wavelength = np.asarray(wavelength)
        above = wavelength >= shortest * (1.0 - _RANGE_TOLERANCE)
        return above & (wavelength <= longest * (1.0 + _RANGE_TOLERANCE))

    def index(self, wavelength: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
        """Refractive index and extinction coefficient.

        Parameters
        ----------
        wavelength : array, shape (...)
            Vacuum wavelength [m], concrete.

        Returns
        -------
        n, k : array, shape (...)
            Real and imaginary part of the complex index [1]; k is positive where the material
            absorbs.

        Raises
        ------
        ParameterError
            If a wavelength is outside the range and the policy is ERROR. The message names
            material, wavelength, range and policies.
        """
        wavelength = np.asarray(wavelength, float)
        inside = self.covers(wavelength)
        if self.extrapolation is Extrapolation.ERROR and not np.all(inside):
            self._refuse(wavelength[~inside].flat[0])
        shortest, longest = self.wavelength_range
        n, k = self._inside(np.clip(wavelength, shortest, longest).ravel())
        if self.extrapolation is Extrapolation.LOSSLESS:
            k = np.where(inside.ravel(), k, 0.0)
        return n.reshape(wavelength.shape)[()], k.reshape(wavelength.shape)[()]

    def _refuse(self, wavelength: float) -> None:
        shortest, longest = (end / MICROMETRE for end in self.wavelength_range)
        raise ParameterError(
            f"{self.name} has no data at {wavelength / MICROMETRE:.5g} µm, only from "
            f"{shortest:.5g} µm to {longest:.5g} µm; to go beyond, set extrapolation to "
            f'"{Extrapolation.HOLD}" or "{Extrapolation.LOSSLESS}"'
        )

    def _inside(self, wavelength: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        n, k = np.empty_like(wavelength), np.empty_like(wavelength)
        for segment in self.segments:
            here = (wavelength >= segment.shortest) & (wavelength <= segment.longest)
            n[here], k[here] = segment.lookup(wavelength[here])
        for left, right in zip(self.segments, self.segments[1:], strict=False):
            gap = (wavelength > left.longest) & (wavelength < right.shortest)
            if np.any(gap):
                ends = np.array([left.longest, right.shortest])
                start, stop = left.lookup(ends[:1]), right.lookup(ends[1:])
                n[gap], k[gap] = (
                    np.interp(wavelength[gap], ends, np.concatenate(pair))
                    for pair in zip(start, stop, strict=True)
                )
        return n, k


def tabulated_material(
    name: str,
    wavelength: np.ndarray,
    n: np.ndarray,
    k: np.ndarray,
    *,
    density: float | None = None,
    tac: Measured | None = None,
    source: str = "given in Python",
) -> Material:
    """Material from a table of n and k.

    Parameters
    ----------
    name : str
    wavelength : array, shape (m,)
        Increasing, at least two [m].
    n, k : array, shape (m,)
        Refractive index and extinction coefficient [1].
    density : float, optional
        Mass density [kg/m³].
    tac : Measured, optional
        Thermal accommodation coefficient of its surface [1].
    source : str
        Origin of the numbers.

    Returns
    -------
    Material

    Raises
    ------
    ParameterError
        If wavelengths do not increase, a value is not finite, n is not positive or k negative.
    """
    table = np.array([wavelength, n, k], float)
    if table.ndim != 2 or table.shape[1] < 2 or not np.all(np.isfinite(table)):
        raise ParameterError(f"{name}: needs two or more wavelengths with finite n and k")
    if np.any(np.diff(table[0]) <= 0.0) or table[0, 0] <= 0.0:
        raise ParameterError(f"{name}: wavelengths must be positive and increase")
    if np.any(table[1] <= 0.0) or np.any(table[2] < 0.0):
        raise ParameterError(f"{name}: n must be positive and k zero or positive")

    def lookup(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.interp(points, table[0], table[1]), np.interp(points, table[0], table[2])

    segment = Segment(float(table[0, 0]), float(table[0, -1]), source, lookup)
    return Material(
        name,
        (segment,),
        density=density,
        density_source="" if density is None else GIVEN,
        tac=tac,
        tac_source="" if tac is None else GIVEN,
    )


def material_from_csv(
    path: str | Path, *, density: float | None = None, tac: Measured | None = None
) -> Material:
    """Material from a CSV file of wavelength, n and k.

    Parameters
    ----------
    path : str or path
        Comma-separated; the first line not starting with ``#`` names the columns, with the
        unit of the wavelength: ``wavelength [um],n,k``.
    density : float, optional
        Mass density [kg/m³].
    tac : Measured, optional
        Thermal accommodation coefficient of its surface [1].

    Returns
    -------
    Material
        Named as the file.

    Raises
    ------
    ConfigurationError
        One line that says what is wrong and where.
    """
    path = Path(path)
    wavelength, n, k = read_index_csv(path)
    return tabulated_material(
        path.name, wavelength, n, k, density=density, tac=tac, source=str(path)
    )
