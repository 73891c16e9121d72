"""Materials of measured n and k.

A :class:`Material` interpolates measured n and k between the wavelengths of its source and
knows where they end. Outside that range it raises, unless the user has chosen one of the named
:class:`~lightflyer.film.media.medium.Extrapolation` policies; every result then lists the materials
that were extrapolated.
"""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from lightflyer.array.namespace import Numeric
from lightflyer.array.records import field
from lightflyer.core.arguments import reads_units
from lightflyer.core.checks import require_range
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import Density, Length
from lightflyer.core.units import Measured
from lightflyer.film.media.material_csv import read_index_csv
from lightflyer.film.media.medium import GIVEN, MICROMETRE, DataMedium, Extrapolation

ROOM_TEMPERATURES = (270.0, 320.0)  # Temperatures of samples that need no mention [K]

_WIDEST_STEP = 0.01  # relative: what lies between two sources' ends closer than this is no gap


class Segment(NamedTuple):
    """A stretch of wavelengths with one source."""

    shortest: float  # Wavelengths covered [m]
    longest: float  # Wavelengths covered [m]
    source: str  # Database page or file
    # Takes wavelengths inside [m], returns n and k [1]
    lookup: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


class Material(DataMedium):
    """Complex refractive index n + ik and mass density of a material, from fixed tables.

    Raises
    ------
    ParameterError
        If a density is negative.
    """

    name: str = field(static=True)
    #: In order of wavelength. Across a gap between two of them n and k are linear
    segments: tuple[Segment, ...] = field(static=True)
    #: Mass density [kg/m³]; None where it depends on the sample and must be given
    density: Numeric | None = None
    density_source: str = field(static=True, default="")
    description: str = field(static=True, default="")  #: What was measured
    #: Thermal accommodation coefficient of its surface in air [1]; None if never measured
    tac: Measured | None = field(static=True, default=None)
    tac_source: str = field(static=True, default="")
    #: Policy outside the range
    extrapolation: Extrapolation = field(static=True, default=Extrapolation.ERROR)
    #: What a reader of results must know of the tables, one line each
    remarks: tuple[str, ...] = field(static=True, default=())
    #: Of the sample, where it is stated [K]
    temperature: float | None = field(static=True, default=None)

    def __check_init__(self) -> None:
        require_range(f"density of {self.name}", self.density, 0.0)

    @property
    def wavelength_range(self) -> tuple[float, float]:
        return self.segments[0].shortest, self.segments[-1].longest

    @property
    def gaps(self) -> tuple[tuple[float, float], ...]:
        """Wavelengths between two sources [m], across which n and k are linear."""
        ends = zip(self.segments, self.segments[1:], strict=False)
        found = ((left.longest, right.shortest) for left, right in ends)
        return tuple(gap for gap in found if gap[1] > gap[0] * (1.0 + _WIDEST_STEP))

    @property
    def diagnostics(self) -> tuple[str, ...]:
        """Warns of gaps between sources and an unusual temperature, and repeats remarks."""
        gaps = (
            f"{self.name} has no optical data from {gap[0] / MICROMETRE:.4g} µm to "
            f"{gap[1] / MICROMETRE:.4g} µm; n and k are linear between these"
            for gap in self.gaps
        )
        coldest, hottest = ROOM_TEMPERATURES
        usual = self.temperature is None or coldest <= self.temperature <= hottest
        sample = () if usual else (f"{self.name} has n and k at {self.temperature:g} K",)
        return (*gaps, *sample, *self.remarks)

    @property
    def source(self) -> str:
        return "; ".join(segment.source for segment in self.segments)

    def index(self, wavelength: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Index and extinction as NumPy arrays."""
        wavelength = np.asarray(wavelength, float)
        self.require_covered(wavelength)
        inside = np.clip(wavelength, *self.wavelength_range).ravel()
        n, k = np.empty_like(inside), np.empty_like(inside)
        for segment in self.segments:
            here = (inside >= segment.shortest) & (inside <= segment.longest)
            n[here], k[here] = segment.lookup(inside[here])
        for left, right in zip(self.segments, self.segments[1:], strict=False):
            gap = (inside > left.longest) & (inside < right.shortest)
            if np.any(gap):
                ends = np.array([left.longest, right.shortest])
                start, stop = left.lookup(ends[:1]), right.lookup(ends[1:])
                n[gap], k[gap] = (
                    np.interp(inside[gap], ends, np.concatenate(pair))
                    for pair in zip(start, stop, strict=True)
                )
        if self.extrapolation is Extrapolation.LOSSLESS:
            k = np.where(self.covers(wavelength).ravel(), k, 0.0)
        return n.reshape(wavelength.shape)[()], k.reshape(wavelength.shape)[()]


def vacuum() -> Material:
    """Empty space, for pores and gaps.

    Returns
    -------
    Material

    Examples
    --------
    >>> print(*vacuum().index(1e-6))
    1.0 0.0
    """
    return _VACUUM


def _nothing(wavelength: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.ones_like(wavelength), np.zeros_like(wavelength)


_VACUUM = Material(
    name="vacuum",
    segments=(Segment(0.0, np.inf, "n = 1, k = 0", _nothing),),
    density=0.0,
    density_source="empty",
)


@reads_units
def tabulated_material(
    name: str,
    wavelength: Length,
    n: np.ndarray,
    k: np.ndarray,
    *,
    density: Density | None = None,
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
        name=name,
        segments=(segment,),
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
