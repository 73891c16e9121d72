"""Wavelengths, directions and weights of a film's averages, and what becomes of light there."""

import dataclasses
from typing import Any, NamedTuple, TypeVar

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.transformations import stop_gradient
from lightflyer.core.checks import is_traced
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.film.media.medium import MICROMETRE
from lightflyer.film.optics.spectra import Spectrum, planck
from lightflyer.film.optics.stack import Film, Side
from lightflyer.film.optics.transfer_matrix import Structure, transfer

DIRECTIONS = 16  # Directions in a hemispherical average, Gauss-Legendre in the cosine

POINTS_PER_E_FOLD = 4000
"""Wavelengths per factor e in a thermal average: converged to 1e-5 with the sharp bands of PET."""

COARSE_POINTS_PER_E_FOLD = POINTS_PER_E_FOLD // 10
"""The same where a film's change is asked: an emittance to 1e-3, its ± to 1 % of itself."""

S = TypeVar("S", bound=Any)  # Shares as a named tuple

# Directions at wavelengths computed at a time where nothing is traced: arrays of both polarisations
# (128 KiB) stay in the processor's cache.
_AT_ONCE = 4096
_WIDEST = (0.1e-6, 3e-3)  # [m]; outside lies less than 1e-5 of what any body from 100 K radiates


class Grid(NamedTuple):
    """Where an average is taken."""

    wavelength: np.ndarray  # shape (w,); [m]
    weight: np.ndarray  # shape (m, w); share of each spectrum's power at each wavelength [1]
    # Cosines of the directions to the film's normal, and their weights, whose sum is one
    cosine: Numeric
    share: Numeric

    @property
    def mean_weight(self) -> np.ndarray:
        """Weights of a mean over the grid, shape (m, w); each row's sum is one [1]."""
        return np.asarray(self.weight / self.weight.sum(axis=1, keepdims=True))


class SpectralShares(NamedTuple):
    """What becomes of light at each wavelength."""

    absorptance: Numeric  # shape (w,); [1]; the sum of all is one
    transmittance: Numeric
    reflectance: Numeric
    scattered: Numeric


def thermal_range(film: Film) -> tuple[float, float]:
    """Wavelengths over which an emittance is averaged [m]."""
    shortest, longest = film.covered_range
    return max(shortest, _WIDEST[0]), min(longest, _WIDEST[1])


def light_grid(film: Film, spectrum: Spectrum, incidence: Numeric, diffuse: bool) -> Grid:
    """Grid of an absorptance: the wavelengths of the light's table; with one spectrum."""
    wavelength, weight = spectrum.between(*film.covered_range)
    cosine, share = hemisphere() if diffuse else (xp.cos(incidence), 1.0)
    return Grid(wavelength, weight[None], cosine, share)


def thermal_grid(
    film: Film, temperatures: np.ndarray, *, normal: bool, points_per_e_fold: int
) -> Grid:
    """Grid of an emittance: wavelengths even in their logarithm, and Planck's spectrum."""
    shortest, longest = thermal_range(film)
    span = np.log(longest / shortest)
    count = int(np.ceil(points_per_e_fold * span)) + 1
    wavelength = np.geomspace(shortest, longest, count)
    step = np.full(count, span / (count - 1))
    step[[0, -1]] *= 0.5
    weight = np.stack([planck(wavelength, t) * wavelength * step for t in temperatures])
    dark = ~(weight.sum(axis=1) > 0.0)
    if dark.any():
        raise ParameterError(
            f"a black body at {temperatures[dark][0]:g} K radiates nothing between "
            f"{shortest / MICROMETRE:.4g} µm and {longest / MICROMETRE:.4g} µm, where the film's "
            "materials have data"
        )
    cosine, share = (1.0, 1.0) if normal else hemisphere()
    return Grid(wavelength, weight, cosine, share)


def hemisphere(directions: int = DIRECTIONS) -> tuple[np.ndarray, np.ndarray]:
    """Cosines and weights of the mean over a half-space, ``2 μ dμ``."""
    nodes, weights = np.polynomial.legendre.leggauss(directions)
    cosine = 0.5 * (nodes + 1.0)
    return cosine, weights * cosine


def spectral_shares(film: Film, side: Side, grid: Grid) -> SpectralShares:
    """What becomes of unpolarised light at each wavelength, averaged over directions."""
    pieces = spectral_pieces(film, side, grid.wavelength, np.size(grid.cosine))
    parts = [_spectral(*(*piece, grid.cosine, grid.share)) for piece in pieces]
    found = SpectralShares(*(xp.concatenate(part) for part in zip(*parts, strict=True)))
    return with_holes(found, film.open_fraction)


def with_holes(shares: S, open_fraction: Numeric | None) -> S:
    """Shares of a film with holes, through which all light passes."""
    if open_fraction is None:
        return shares
    solid = type(shares)(*((1.0 - open_fraction) * share for share in shares))
    return solid._replace(transmittance=solid.transmittance + open_fraction)


def spectral_pieces(
    film: Film, side: Side, wavelength: np.ndarray, directions: int, *weights: np.ndarray
) -> list[tuple[Any, ...]]:
    """A lit film as numbers at wavelengths, in pieces to be computed one after another."""
    lit = (film if side == "top" else film.flip()).homogeneous()
    n, k = lit.index(wavelength)
    structure, thickness = lit.structure(wavelength, axes=2), lit.thickness
    if is_traced(n, k, thickness, structure):
        return [(n, k, thickness, wavelength, *weights, structure)]
    pieces: list[tuple[Any, ...]] = []
    length = _AT_ONCE // directions
    for start in range(0, wavelength.size, length):

        def part(table: Any, start: int = start) -> Any:
            return table[..., start : start + length] if np.ndim(table) else table

        media = dataclasses.replace(
            structure, above=part(structure.above), below=tuple(map(part, structure.below))
        )
        tables = map(part, (wavelength, *weights))
        pieces.append((part(n), part(k), thickness, *tables, media))
    return pieces


@entry_point
def _spectral(
    n: Numeric,
    k: Numeric,
    thickness: Numeric,
    wavelength: Numeric,
    structure: Structure,
    cosine: Numeric,
    share: Numeric,
) -> SpectralShares:
    """Shares of unpolarised light at each wavelength, weighted over directions."""
    incidence = xp.arccos(xp.atleast_1d(cosine))[:, None]
    layers = thickness.reshape(-1, 1, 1)
    optics = transfer(
        n[:, None], k[:, None], layers, wavelength, incidence, structure, inside=False
    ).polarisation_mean()
    scattered = optics.scattered + xp.zeros_like(optics.reflectance)
    absorbed = 1.0 - optics.reflectance - optics.transmittance - scattered
    # rounding below zero, of clear films; the derivative stays
    absorbed = absorbed + stop_gradient(xp.maximum(-absorbed, 0.0))
    found = SpectralShares(absorbed, optics.transmittance, optics.reflectance, scattered)
    return SpectralShares(*(xp.atleast_1d(share) @ part for part in found))


@entry_point
def weighted_means(spectral: Numeric, weights: Numeric) -> Array:
    """Means of a spectrum; ``weights`` has one row a mean."""
    return weights @ spectral
