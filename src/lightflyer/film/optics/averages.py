"""Shares of light and heat radiation on a film, averaged over spectrum, angle and polarisation.

What a film absorbs, lets through and reflects; its emittance is what it absorbs of heat radiation.
Wavelengths, directions and weights of the averages come first.
"""

import dataclasses
from typing import Any, NamedTuple, TypeVar

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module, field, short_repr
from lightflyer.array.transformations import stop_gradient
from lightflyer.core.checks import is_traced, require_positive, require_range
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.film.media.medium import MICROMETRE
from lightflyer.film.optics.curve import EmittanceCurve, node_temperatures
from lightflyer.film.optics.spectra import Spectrum, am0, blackbody_fraction, planck
from lightflyer.film.optics.stack import GRAZING, Film, Side
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


class Average(Module):
    """Mean over a spectrum of what a film absorbs, lets through or reflects."""

    #: Mean over the part of the spectrum in which the materials have data or extrapolate [1]
    value: Numeric
    #: Share of the spectrum's power at which all materials have data, whatever their policy beyond
    #: [1]
    covered: Numeric
    #: Share of the spectrum's power at which a material extrapolates [1]
    extrapolated_share: Numeric = 0.0
    #: Those materials, with their policy and range
    extrapolated: tuple[str, ...] = field(static=True, default=())
    #: Mean over the part of the spectrum that has data [1]; None if nothing is extrapolated, when
    #: it is ``value``
    within: Numeric | None = None
    #: Share of the spectrum's power that rough interfaces scatter [1]. It is not in ``value``,
    #: where some of it may belong
    scattered: Numeric = 0.0

    @property
    def left_out(self) -> Numeric:
        """Share of the spectrum's power that is neither covered nor extrapolated [1]."""
        return 1.0 - self.covered - self.extrapolated_share

    @property
    def lower(self) -> Numeric:
        """Value if the share were zero outside the data [1]."""
        return (self.value if self.within is None else self.within) * self.covered

    @property
    def upper(self) -> Numeric:
        """Value if the share were one outside the data [1]."""
        return self.lower + (1.0 - self.covered)


class Shares(NamedTuple):
    """What becomes of light or heat radiation on a film."""

    #: Their values have the sum one. The absorptance for heat radiation is the emittance. What
    #: rough interfaces scatter is not followed: the film may absorb some of it
    absorptance: Average
    transmittance: Average  #: As ``absorptance``
    reflectance: Average  #: As ``absorptance``
    scattered: Average  #: As ``absorptance``

    def __repr__(self) -> str:
        return short_repr(self)


def light_shares(
    film: Film,
    spectrum: Spectrum | None = None,
    incidence: Numeric = 0.0,
    *,
    side: Side = "top",
    diffuse: bool = False,
) -> Shares:
    """Shares of unpolarised light that a film absorbs, lets through and reflects.

    Parameters
    ----------
    film : Film
    spectrum : Spectrum, optional
        Spectrum of the light; by default sunlight above the atmosphere.
    incidence : float
        Angle between the light and the film's normal [rad].
    side : {"top", "bottom"}
        Where the light comes from.
    diffuse : bool
        Whether the light comes from the whole half-space with equal radiance.

    Returns
    -------
    Shares

    Raises
    ------
    ParameterError
        If the angle is not in [0, 90°), or the spectrum has no power where the materials have
        data.

    Notes
    -----
    Differentiable in the thicknesses and the angle.

    References
    ----------
    [ASTME490]_ for sunlight.
    """
    require_range("incidence", incidence, 0.0, GRAZING)
    spectrum = am0() if spectrum is None else spectrum
    grid = light_grid(film, spectrum, incidence, diffuse)
    computed = float(grid.weight.sum())
    covered = np.array([light_coverage(film, spectrum)])
    return _averages(film, side, grid, np.array([computed]), covered, ())


def light_coverage(film: Film, spectrum: Spectrum) -> float:
    """Share of a light's power at which all of a film's materials have data [1]."""
    data, usable = film.data_range, film.covered_range
    try:
        _, weight = spectrum.between(max(data[0], usable[0]), min(data[1], usable[1]))
    except ParameterError:  # no power there
        return 0.0
    return float(weight.sum())


def absorptance(
    film: Film,
    spectrum: Spectrum | None = None,
    incidence: Numeric = 0.0,
    *,
    side: Side = "top",
    diffuse: bool = False,
) -> Average:
    """Share of unpolarised light that a film absorbs; see :func:`light_shares`."""
    return light_shares(film, spectrum, incidence, side=side, diffuse=diffuse).absorptance


def heat_shares(
    film: Film,
    temperature: Numeric,
    *,
    side: Side = "top",
    normal: bool = False,
    points_per_e_fold: int = POINTS_PER_E_FOLD,
) -> Shares:
    r"""Shares of a black body's radiation that a film absorbs, lets through and reflects."""
    # By Kirchhoff's law the spectral, directional emittance of a face is the absorptance for light
    # that falls on it; the mean is weighted with Planck's spectrum.
    #
    # Optical data are for room temperature. Differentiable in the thicknesses.
    #
    # Source: [HowellMenguc2020]_ ch. 3.
    require_positive(temperature=temperature)
    temperatures = np.atleast_1d(np.asarray(temperature, float))
    grid = thermal_grid(film, temperatures, normal=normal, points_per_e_fold=points_per_e_fold)
    computed = _blackbody_share(thermal_range(film), temperatures)
    covered = thermal_coverage(film, temperatures)
    return _averages(film, side, grid, computed, covered, np.shape(temperature))


def emittance(
    film: Film,
    temperature: Numeric,
    *,
    side: Side = "top",
    normal: bool = False,
    points_per_e_fold: int = POINTS_PER_E_FOLD,
) -> Average:
    """Share of a black body's radiation that a face of a film emits; see :func:`heat_shares`."""
    return heat_shares(
        film, temperature, side=side, normal=normal, points_per_e_fold=points_per_e_fold
    ).absorptance


def thermal_coverage(film: Film, temperature: Numeric) -> np.ndarray:
    """Share of a black body's radiation at which all of a film's materials have data [1]."""
    shortest, longest = film.data_range
    ends = thermal_range(film)
    inside = max(shortest, ends[0]), min(longest, ends[1])
    return _blackbody_share(inside, temperature)[()]


def _blackbody_share(ends: tuple[float, float], temperature: Numeric) -> np.ndarray:
    """Share of a black body's radiation between two wavelengths."""

    def share(one: float) -> float:
        return max(0.0, blackbody_fraction(ends[1], one) - blackbody_fraction(ends[0], one))

    return np.vectorize(share, otypes=[float])(temperature)


def emittance_curve(
    film: Film, side: Side = "top", *, points_per_e_fold: int = POINTS_PER_E_FOLD
) -> EmittanceCurve:
    """Hemispherical emittance of a face as a smooth function of its temperature.

    Parameters
    ----------
    film : Film
    side : {"top", "bottom"}
    points_per_e_fold : int
        Wavelengths per factor e in the integration; a tenth of the default gives 1e-3.

    Returns
    -------
    EmittanceCurve
        From 100 K to 1500 K.

    Notes
    -----
    Differentiable in the thicknesses. At low temperature the data may cover little of the
    spectrum: the curve is then the mean over that part, as in :func:`emittance`.
    """
    values = emittance(
        film, node_temperatures(), side=side, points_per_e_fold=points_per_e_fold
    ).value
    return EmittanceCurve.through(values)


def _averages(
    film: Film,
    side: Side,
    grid: Grid,
    computed: np.ndarray,
    covered: np.ndarray,
    shape: tuple[int, ...],
) -> Shares:
    """Averages on a grid; ``computed`` and ``covered`` are shares of the spectrum's power."""
    inside = np.ones(grid.wavelength.shape, bool)
    for medium in film.media:
        inside &= medium.covers(grid.wavelength)
    known, weight = None, grid.mean_weight
    if not inside.all():
        with_data = grid.weight * inside
        total = with_data.sum(axis=1, keepdims=True)
        known = np.divide(with_data, total, where=total > 0.0, out=np.zeros_like(with_data))
    extrapolated = film.extrapolations(grid.wavelength[0], grid.wavelength[-1])

    found = spectral_shares(film, side, grid)
    scattered: Numeric = 0.0
    if film.is_rough:
        scattered = weighted_means(found.scattered, weight).reshape(shape)

    def average(spectral: Numeric) -> Average:
        return Average(
            value=weighted_means(spectral, weight).reshape(shape),
            covered=covered.reshape(shape)[()],
            extrapolated_share=np.maximum(computed - covered, 0.0).reshape(shape)[()],
            extrapolated=extrapolated,
            within=None if known is None else weighted_means(spectral, known).reshape(shape),
            scattered=scattered,
        )

    return Shares(*map(average, found))
