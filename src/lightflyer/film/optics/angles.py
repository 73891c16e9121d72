"""Shares of light and heat radiation on a film by the angle and polarisation of the rays."""

from typing import Any, NamedTuple

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Numeric, xp
from lightflyer.array.records import short_repr
from lightflyer.core.checks import is_traced, require_positive, require_range
from lightflyer.core.entry_point import entry_point
from lightflyer.film.optics.integration import (
    DIRECTIONS,
    POINTS_PER_E_FOLD,
    Grid,
    light_grid,
    spectral_pieces,
    thermal_grid,
    with_holes,
)
from lightflyer.film.optics.spectra import Spectrum, am0
from lightflyer.film.optics.stack import GRAZING, Film, Side
from lightflyer.film.optics.transfer_matrix import Structure, transfer

POLARISATIONS = ("s", "p", "mean")  # Names along the axis of polarisation of tables


class DirectionalShares(NamedTuple):
    """Shares of a spectrum's power by direction."""

    #: shape (2, angles, m); of s and of p polarisation [1]; their sum is one. The absorptance for
    #: heat radiation is the directional emittance. The last axis is that of the temperatures
    reflectance: Numeric
    transmittance: Numeric  #: As ``reflectance``
    absorptance: Numeric  #: As ``reflectance``
    scattered: Numeric  #: As ``reflectance``

    def __repr__(self) -> str:
        return short_repr(self)

    def polarisation_mean(self) -> "DirectionalShares":
        """The mean of both polarisations, without their axis."""
        return DirectionalShares(*(0.5 * (share[0] + share[1]) for share in self))


def light_by_angle(
    film: Film, incidence: Numeric, spectrum: Spectrum | None = None, *, side: Side = "top"
) -> DirectionalShares:
    """Shares of polarised light by the angle of a beam.

    Parameters
    ----------
    film : Film
    incidence : array, shape (angles,)
        Angle between the light and the film's normal [rad].
    spectrum : Spectrum, optional
        Spectrum of the light; by default sunlight above the atmosphere.
    side : {"top", "bottom"}
        Where the light comes from.

    Returns
    -------
    DirectionalShares
        Of shape (2, angles); means over the part of the spectrum in which the media have data or
        extrapolate, as in :func:`~lightflyer.film.optics.averages.light_shares`.

    Raises
    ------
    ParameterError
        If an angle is not in [0, 90°), or the spectrum has no power where the media have data.

    Notes
    -----
    Differentiable in the thicknesses, the media's parameters and the angles.

    Examples
    --------
    >>> from lightflyer.film import Film, Layer, material
    >>> film = Film((Layer(material("Al2O3"), 100e-9),))
    >>> found = light_by_angle(film, np.radians([0.0, 60.0])).transmittance
    >>> print(np.round(np.asarray(found), 2))
    [[0.85 0.53]
     [0.85 1.  ]]
    """
    require_range("incidence", incidence, 0.0, GRAZING)
    grid = light_grid(film, am0() if spectrum is None else spectrum, 0.0, diffuse=False)
    shares = _by_angle(film, side, grid, incidence)
    return DirectionalShares(*(share[..., 0] for share in shares))


def heat_by_angle(
    film: Film,
    incidence: Numeric,
    temperature: Numeric,
    *,
    side: Side = "top",
    points_per_e_fold: int = POINTS_PER_E_FOLD,
) -> DirectionalShares:
    r"""Shares of a black body's polarised radiation by its angle; ``incidence`` (angles,)."""
    # By Kirchhoff's law the absorptance is the directional emittance :math:`\varepsilon(\theta)` of
    # the face. The hemispherical one is :math:`\int_0^{\pi/2}\varepsilon\sin2\theta\,d\theta`.
    #
    # Source: [HowellMenguc2020]_ ch. 3.
    require_range("incidence", incidence, 0.0, GRAZING)
    require_positive(temperature=temperature)
    temperatures = np.atleast_1d(np.asarray(temperature, float))
    grid = thermal_grid(film, temperatures, normal=True, points_per_e_fold=points_per_e_fold)
    shares = _by_angle(film, side, grid, incidence)
    if np.ndim(temperature) == 0:
        return DirectionalShares(*(share[..., 0] for share in shares))
    return shares


def _by_angle(film: Film, side: Side, grid: Grid, incidence: Numeric) -> DirectionalShares:
    """Means over a grid's wavelengths, shape (2, angles, spectra)."""
    angles = xp.reshape(incidence, -1)
    blocks = [angles]
    if not is_traced(angles):
        blocks = np.array_split(angles, -(-angles.size // DIRECTIONS))
    pieces = spectral_pieces(film, side, grid.wavelength, DIRECTIONS, grid.mean_weight)
    rows = [
        tree.map_leaves(
            lambda *parts: sum(parts), *(_directional(*(*piece, block)) for piece in pieces)
        )
        for block in blocks
    ]
    shares = DirectionalShares(*(xp.concatenate(part, axis=1) for part in zip(*rows, strict=True)))
    return with_holes(shares, film.open_fraction)


@entry_point
def _directional(
    n: Numeric,
    k: Numeric,
    thickness: Numeric,
    wavelength: Numeric,
    weight: Numeric,
    structure: Structure,
    incidence: Numeric,
) -> DirectionalShares:
    """Part of the means that some wavelengths give."""
    layers = thickness.reshape(-1, 1, 1)
    optics = transfer(
        n[:, None], k[:, None], layers, wavelength, incidence[:, None], structure, inside=False
    )
    scattered = optics.scattered + xp.zeros_like(optics.reflectance)
    absorbed = 1.0 - optics.reflectance - optics.transmittance - scattered
    parts = (optics.reflectance, optics.transmittance, absorbed, scattered)
    return DirectionalShares(*(part @ weight.T for part in parts))


def with_mean(share: Numeric) -> np.ndarray:
    """A share of s and p polarisation with their mean behind, shape (3, ...)."""
    values = np.asarray(share)
    return np.concatenate([values, values.mean(axis=0, keepdims=True)])


def shares_by_name(shares: DirectionalShares) -> dict[str, Any]:
    """Shares by name with the mean of the polarisations."""
    return {name: with_mean(value) for name, value in shares._asdict().items()}
