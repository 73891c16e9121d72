"""Absorptance and emittance of a film, averaged over spectrum, angle and polarisation."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jax import Array

from lightflyer.film.curve import EmittanceCurve, node_temperatures
from lightflyer.film.spectra import Spectrum, am0, blackbody_fraction, planck
from lightflyer.film.stack import GRAZING, Film, Side
from lightflyer.film.transfer_matrix import transfer
from lightflyer.foundation.checks import require_positive, require_range
from lightflyer.foundation.precision import entry_point, is_traced
from lightflyer.foundation.types import Numeric

DIRECTIONS = 16
"""Directions in a hemispherical average, Gauss-Legendre in the cosine."""

POINTS_PER_E_FOLD = 4000
"""Wavelengths per factor e in a thermal average: converged to 1e-5 with the sharp bands of PET."""

_CHUNK = 2048  # wavelengths computed at a time where nothing is differentiated
_WIDEST = (0.1e-6, 3e-3)  # [m]; outside lies less than 1e-5 of what any body from 100 K radiates


class Average(eqx.Module):
    """A film's mean absorptance or emittance over a spectrum.

    Attributes
    ----------
    value : array
        Mean over the part of the spectrum in which the materials have data or extrapolate [1].
    covered : array
        Share of the spectrum's power in that part [1].
    extrapolated_share : array
        Share of the spectrum's power at which a material extrapolates [1].
    extrapolated : tuple of str
        Those materials, with their policy and range.
    """

    value: Numeric
    covered: Numeric
    extrapolated_share: Numeric = 0.0
    extrapolated: tuple[str, ...] = eqx.field(static=True, default=())

    @property
    def lower(self) -> Numeric:
        """Value if the film absorbed nothing outside its data [1]."""
        return self.value * self.covered

    @property
    def upper(self) -> Numeric:
        """Value if the film absorbed everything outside its data [1]."""
        return self.lower + (1.0 - self.covered)


def absorptance(
    film: Film,
    spectrum: Spectrum | None = None,
    incidence: Numeric = 0.0,
    *,
    side: Side = "top",
    diffuse: bool = False,
) -> Average:
    """Share of unpolarised light that a film absorbs.

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
    Average

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
    covered = film.covered_range
    wavelength, weight = spectrum.between(*covered)
    beam = jnp.cos(incidence) if is_traced(incidence) else np.cos(incidence)
    cosine, share = _hemisphere() if diffuse else (beam, 1.0)
    value = _mean(film, side, wavelength, weight[None] / weight.sum(), cosine, share)[0]
    outside = _extrapolating(film, wavelength)
    return Average(
        value=value,
        covered=float(weight.sum()),
        extrapolated_share=float(weight[outside].sum()),
        extrapolated=film.extrapolated(wavelength[0], wavelength[-1]),
    )


def emittance(
    film: Film,
    temperature: Numeric,
    *,
    side: Side = "top",
    normal: bool = False,
    points_per_e_fold: int = POINTS_PER_E_FOLD,
) -> Average:
    r"""Share of a black body's radiation that a face of a film emits.

    By Kirchhoff's law the spectral, directional emittance of a face is the absorptance for
    light that falls on it; the mean is weighted with Planck's spectrum.

    Parameters
    ----------
    film : Film
    temperature : array, shape (m,) or ()
        Concrete [K].
    side : {"top", "bottom"}
        The face.
    normal : bool
        Whether to give the emittance along the normal, not the hemispherical one.
    points_per_e_fold : int
        Wavelengths per factor e in the integration.

    Returns
    -------
    Average
        Arrays of the shape of ``temperature``.

    Raises
    ------
    ParameterError
        If a temperature is not positive.

    Notes
    -----
    Optical data are for room temperature. Differentiable in the thicknesses.

    References
    ----------
    [HowellMenguc2020]_ ch. 3.
    """
    require_positive(temperature=temperature)
    temperatures = np.atleast_1d(np.asarray(temperature, float))
    shortest, longest = thermal_range(film)
    wavelength, weight = _thermal_weights(shortest, longest, temperatures, points_per_e_fold)
    cosine, share = (1.0, 1.0) if normal else _hemisphere()
    normalised = weight / weight.sum(axis=1, keepdims=True)
    value = _mean(film, side, wavelength, normalised, cosine, share)
    outside = _extrapolating(film, wavelength)
    shape = np.shape(temperature)
    return Average(
        value=value.reshape(shape),
        covered=thermal_coverage(film, temperature),
        extrapolated_share=weight[:, outside].sum(axis=1).reshape(shape)[()],
        extrapolated=film.extrapolated(shortest, longest),
    )


def thermal_range(film: Film) -> tuple[float, float]:
    """Wavelengths over which an emittance is averaged [m].

    Parameters
    ----------
    film : Film

    Returns
    -------
    shortest, longest : float
    """
    shortest, longest = film.covered_range
    return max(shortest, _WIDEST[0]), min(longest, _WIDEST[1])


def thermal_coverage(film: Film, temperature: Numeric) -> np.ndarray:
    """Share of a black body's radiation at which a film's emittance can be computed.

    Parameters
    ----------
    film : Film
    temperature : array, shape (...)
        [K].

    Returns
    -------
    array, shape (...)
        [1].
    """
    shortest, longest = thermal_range(film)
    return np.vectorize(
        lambda t: blackbody_fraction(longest, t) - blackbody_fraction(shortest, t), otypes=[float]
    )(temperature)[()]


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


def _hemisphere() -> tuple[np.ndarray, np.ndarray]:
    """Cosines and weights of the mean over a half-space, ``2 μ dμ``."""
    nodes, weights = np.polynomial.legendre.leggauss(DIRECTIONS)
    cosine = 0.5 * (nodes + 1.0)
    return cosine, weights * cosine


def _thermal_weights(
    shortest: float, longest: float, temperatures: np.ndarray, density: int
) -> tuple[np.ndarray, np.ndarray]:
    """Wavelengths even in their logarithm, and trapezoidal Planck weights, one row each."""
    count = int(np.ceil(density * np.log(longest / shortest))) + 1
    wavelength = np.geomspace(shortest, longest, count)
    step = np.full(count, np.log(longest / shortest) / (count - 1))
    step[[0, -1]] *= 0.5
    weight = np.stack([planck(wavelength, t) * wavelength * step for t in temperatures])
    return wavelength, weight


def _extrapolating(film: Film, wavelength: np.ndarray) -> np.ndarray:
    """Whether any material is outside its data, at each wavelength."""
    covers = [layer.material.covers(wavelength) for layer in film.layers]
    return ~np.all(covers, axis=0) if covers else np.zeros(wavelength.shape, bool)


def _mean(
    film: Film,
    side: Side,
    wavelength: np.ndarray,
    weights: np.ndarray,
    cosine: Numeric,
    share: Numeric,
) -> Array:
    lit = film if side == "top" else film.flipped()
    n, k = lit.index(wavelength)
    if is_traced(lit.thickness, cosine):
        return _weighted(_spectral(n, k, lit.thickness, wavelength, cosine, share), weights)
    # Concrete: always the same shape, so that one compilation serves every spectrum and side.
    cosines, shares = np.ones(DIRECTIONS), np.zeros(DIRECTIONS)
    cosines[: np.size(cosine)], shares[: np.size(share)] = cosine, share
    padding = (0, -wavelength.size % _CHUNK)
    n, k = (np.pad(table, [(0, 0), padding], mode="edge") for table in (n, k))
    padded = np.pad(wavelength, padding, mode="edge")
    parts = []
    for start in range(0, wavelength.size, _CHUNK):
        chunk = slice(start, start + _CHUNK)
        parts.append(
            _spectral(n[:, chunk], k[:, chunk], lit.thickness, padded[chunk], cosines, shares)
        )
    return _weighted(np.concatenate(parts)[: wavelength.size], weights)


@entry_point
def _spectral(
    n: Numeric, k: Numeric, thickness: Numeric, wavelength: Numeric, cosine: Numeric, share: Numeric
) -> Array:
    """Absorptance of unpolarised light at each wavelength, weighted over directions."""
    incidence = jnp.arccos(jnp.atleast_1d(cosine))[:, None]
    layers = thickness.reshape(-1, 1, 1)
    optics = transfer(n[:, None], k[:, None], layers, wavelength, incidence).unpolarised()
    return jnp.atleast_1d(share) @ (1.0 - optics.reflectance - optics.transmittance)


@entry_point
def _weighted(spectral: Numeric, weights: Numeric) -> Array:
    return weights @ spectral
