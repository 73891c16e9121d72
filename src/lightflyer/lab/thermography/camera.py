r"""What a thermal camera measures: the radiance within its band of wavelengths.

A camera shows the apparent temperature: that of a black body with the same radiance

.. math:: B(T) = \int R(\lambda)\,L_\lambda(T)\,d\lambda

in the camera's band, where R is its relative spectral response and :math:`L_\lambda` Planck's
spectral radiance. Radiances add; their fourth roots, and apparent temperatures, do not. :math:`T^4`
in place of B would be right for a camera that sees all wavelengths alike.
"""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.polynomial import Chebyshev

from lightflyer.core.checks import require_positive, require_range
from lightflyer.core.constants import STEFAN_BOLTZMANN
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import Length, Quantity
from lightflyer.files.quantities import ends
from lightflyer.files.table import read_table
from lightflyer.files.table_layout import Column
from lightflyer.film.optics.spectra import SECOND_RADIATION_CONSTANT, planck

MICROMETRE = 1e-6  # [m]

WAVELENGTHS = (0.7 * MICROMETRE, 1000.0 * MICROMETRE)
"""Wavelengths that the band of a thermal camera may have: infrared [m]."""

_NODES = 12  # Gauss-Legendre, per piece
_WIDEST = 1.15  # longest over shortest wavelength of a piece
_MANY = 2000  # temperatures above which radiances are interpolated
_DEGREE = 64  # of the interpolating polynomial
_TABLES = (".csv", ".txt", ".tsv", ".dat")
_COLUMNS = (
    Column("wavelength", Length, ("lambda", "wl"), required=True, suggested_unit="um"),
    Column("response", Quantity("", 0.0), ("responsivity", "transmission"), required=True,
           any_unit=True),
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class CameraBand:
    """Relative spectral response of a thermal camera, linear between the points of a table."""

    wavelength: np.ndarray  # shape (m,); increasing [m]
    response: np.ndarray  # shape (m,); relative response [1]; zero outside the table
    assumed: bool = False  # Whether the band is this package's assumption and not the camera's own
    _nodes: np.ndarray = field(init=False, repr=False)
    _weights: np.ndarray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        wavelength, response = np.asarray(self.wavelength, float), np.asarray(self.response, float)
        if wavelength.ndim != 1 or wavelength.shape != response.shape or wavelength.size < 2:
            raise ParameterError("a camera's band needs two or more wavelengths with a response")
        require_range("wavelength [m] of the camera's band", wavelength, *WAVELENGTHS)
        require_range("response of the camera", response, 0.0)
        if not np.all(np.diff(wavelength) > 0.0):
            raise ParameterError("the wavelengths of a camera's band must increase")
        if not response.any():
            raise ParameterError("the response of the camera is zero everywhere")
        position, weight = np.polynomial.legendre.leggauss(_NODES)
        counts = np.ceil(np.log(wavelength[1:] / wavelength[:-1]) / np.log(_WIDEST)).astype(int)
        pieces = [
            np.geomspace(start, end, count, endpoint=False)
            for start, end, count in zip(wavelength[:-1], wavelength[1:], counts, strict=True)
        ]
        edges = np.concatenate([*pieces, wavelength[-1:]])
        half, middle = 0.5 * np.diff(edges), 0.5 * (edges[1:] + edges[:-1])
        nodes = (middle[:, None] + half[:, None] * position).ravel()
        weights = (half[:, None] * weight).ravel() * np.interp(nodes, wavelength, response)
        object.__setattr__(self, "_nodes", nodes)
        object.__setattr__(self, "_weights", weights)

    @property
    def name(self) -> str:
        """The band in words, such as ``"7.5 to 14 µm"``."""
        seen = self.wavelength[[0, -1]] / MICROMETRE
        return f"{seen[0]:.4g} to {seen[1]:.4g} µm"

    def radiance(self, temperature: Any) -> np.ndarray:
        """Radiance of a black body within the band, weighted by the response [W/(m² sr)]."""
        kelvin = np.asarray(temperature, float)
        require_positive(temperature=kelvin)
        if kelvin.size <= _MANY or not np.ptp(kelvin):
            return self._integral(kelvin, np.ones_like)
        logarithm = Chebyshev.interpolate(
            lambda inverse: np.log(self._integral(1.0 / inverse, np.ones_like)), _DEGREE,
            (1.0 / kelvin.max(), 1.0 / kelvin.min()),
        )  # fmt: skip
        return np.asarray(np.exp(logarithm(1.0 / kelvin)))

    def slope(self, temperature: Any) -> np.ndarray:
        """Derivative of the radiance by the temperature [W/(m² sr K)]."""
        kelvin = np.asarray(temperature, float)
        require_positive(temperature=kelvin)
        return self._integral(kelvin, lambda x: x / -np.expm1(-x)) / kelvin

    def _integral(self, kelvin: np.ndarray, factor: Any) -> np.ndarray:
        """Integral of response, spectral radiance and a factor of hc/λkT over the wavelength."""
        nodes = self._nodes.reshape(-1, *(1,) * kelvin.ndim)
        each: Any = kelvin
        spectral = planck(nodes, each) * factor(SECOND_RADIATION_CONSTANT / (nodes * kelvin))
        exitance = STEFAN_BOLTZMANN * kelvin**4
        return np.asarray(np.tensordot(self._weights, spectral, 1) * exitance / np.pi)


def flat_band(shortest: float, longest: float, *, assumed: bool = False) -> CameraBand:
    """Band with the same response to all of its wavelengths.

    Parameters
    ----------
    shortest, longest : float
        [m].
    assumed : bool
        Whether the band is an assumption and not the camera's own.

    Returns
    -------
    CameraBand

    Examples
    --------
    >>> print(f"{float(flat_band(7.5e-6, 14e-6).radiance(295.15)):.2f} W/(m² sr)")
    54.91 W/(m² sr)
    """
    return CameraBand(np.array([shortest, longest]), np.ones(2), assumed)


def read_response(path: str | Path) -> CameraBand:
    """Read the spectral response of a camera; ``path`` [um]."""
    numbers = read_table(path, _COLUMNS, strict=True).numbers
    order = np.argsort(numbers["wavelength"])
    try:
        return CameraBand(numbers["wavelength"][order], numbers["response"][order])
    except ParameterError as error:
        raise ConfigurationError(f"{path}: {error}") from None


def parse_band(text: str) -> CameraBand | None:
    """Camera's band from the text of an option; none for ``"total"``."""
    if text.strip().lower() == "total":
        return None
    if Path(text).is_file() or Path(text).suffix in _TABLES:
        return read_response(text)
    found = ends("--band", text, "m")
    if found is None:
        raise ConfigurationError(
            f'--band: "{text}" is not a band; write "7.5-14 um", the file of a spectral response, '
            'or "total"'
        )
    try:
        return flat_band(*found)
    except ParameterError as error:
        raise ConfigurationError(f'--band: "{text}": {error}') from None


UNCOOLED = flat_band(7.5 * MICROMETRE, 14.0 * MICROMETRE, assumed=True)
"""Band assumed where none is stated: 7.5 to 14 µm, as many uncooled cameras have it."""
