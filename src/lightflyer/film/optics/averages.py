"""Shares of light and heat radiation on a film, averaged over spectrum, angle and polarisation.

What a film absorbs, lets through and reflects; its emittance is what it absorbs of heat radiation.
"""

from typing import NamedTuple

import numpy as np

from lightflyer.array.namespace import Numeric
from lightflyer.array.records import Module, field, short_repr
from lightflyer.core.checks import require_positive, require_range
from lightflyer.core.errors import ParameterError
from lightflyer.film.optics.curve import EmittanceCurve, node_temperatures
from lightflyer.film.optics.integration import (
    POINTS_PER_E_FOLD,
    Grid,
    light_grid,
    spectral_shares,
    thermal_grid,
    thermal_range,
    weighted_means,
)
from lightflyer.film.optics.spectra import Spectrum, am0, blackbody_fraction
from lightflyer.film.optics.stack import GRAZING, Film, Side


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
