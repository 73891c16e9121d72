"""Shares of light and heat radiation on a film by the angle and polarisation of the rays."""

import csv
import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

import lightflyer
from lightflyer.array import tree
from lightflyer.array.namespace import Numeric, xp
from lightflyer.array.records import ShortRepr, short_repr
from lightflyer.core.checks import is_traced, require_positive, require_range
from lightflyer.core.entry_point import entry_point
from lightflyer.core.text import cell_text
from lightflyer.film.media.medium import MICROMETRE
from lightflyer.film.optics.averages import (
    DIRECTIONS,
    POINTS_PER_E_FOLD,
    Grid,
    light_grid,
    spectral_pieces,
    thermal_grid,
    with_holes,
)
from lightflyer.film.optics.spectra import SPECTRUM_RANGE, Spectrum, am0
from lightflyer.film.optics.stack import GRAZING, Film, Side
from lightflyer.film.optics.transfer_matrix import StackOptics, Structure, transfer

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

POLARISATIONS = ("s", "p", "mean")  # Names along the axis of polarisation of tables

SPECTRUM_POINTS = 400


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

    def with_mean(self) -> dict[str, np.ndarray]:
        """Shares by name, the mean behind both polarisations; shape (3, ...)."""
        shares = {name: np.asarray(value) for name, value in self._asdict().items()}
        return {name: np.concatenate([s, s.mean(axis=0)[None]]) for name, s in shares.items()}


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


@dataclasses.dataclass(frozen=True, eq=False)
class AngularSummary(ShortRepr):
    """Optics of a film's top by angle and polarisation, spectral and averaged."""

    film: Film
    light: Spectrum  #: Light on the film: sunlight or a lamp
    incidence: np.ndarray  #: shape (angles,); [rad]
    #: shape (w,); [m]; from 0.25 µm to 25 µm, as far as the media have data or extrapolate
    wavelength: np.ndarray
    temperatures: np.ndarray  #: shape (m,); [K]
    spectral: StackOptics  #: Arrays of shape (2, angles, w)
    lit: DirectionalShares  #: Of the light, shape (2, angles)
    thermal: DirectionalShares  #: Of black bodies' radiation, shape (2, angles, m)

    @classmethod
    def of(
        cls, film: Film, light: Spectrum, incidence: np.ndarray, temperatures: np.ndarray
    ) -> "AngularSummary":
        """Summary of a film; ``incidence`` (angles,); ``temperatures`` (m,)."""
        shortest, longest = film.covered_range
        ends = max(shortest, SPECTRUM_RANGE[0]), min(longest, SPECTRUM_RANGE[1])
        wavelength = np.geomspace(*ends, SPECTRUM_POINTS)
        incidence = np.asarray(incidence, float)
        return cls(
            film=film,
            light=light,
            incidence=incidence,
            wavelength=wavelength,
            temperatures=temperatures,
            spectral=film.optics(wavelength, incidence[:, None]),
            lit=light_by_angle(film, incidence, light),
            thermal=heat_by_angle(film, incidence, temperatures),
        )

    @property
    def spectral_shares(self) -> DirectionalShares:
        """Shares at each wavelength, shape (2, angles, w)."""
        found = self.spectral
        scattered = found.scattered + np.zeros_like(found.reflectance)
        return DirectionalShares(
            found.reflectance, found.transmittance, found.absorptance, scattered
        )

    def plot(self) -> "Figure":
        """Draw shares of the light, and the emittance, over the angle."""
        from lightflyer.film.figures import draw_angles

        return draw_angles(self)

    def to_dataset(self) -> "xr.Dataset":
        """The summary as an xarray dataset."""
        # Names without addition are spectral, those with ``light_`` and ``thermal_`` averages.
        import xarray as xr

        groups = (
            ("", "", ("wavelength",), self.spectral_shares),
            ("light_", f", mean over {self.light.name}", (), self.lit),
            ("thermal_", ", mean over a black body's radiation", ("temperature",), self.thermal),
        )
        variables = {
            f"{prefix}{name}": (
                ("polarisation", "angle", *dims), values,
                {"units": "1", "long_name": f"{name}{about}"},
            )
            for prefix, about, dims, shares in groups
            for name, values in shares.with_mean().items()
        }  # fmt: skip
        angle = {"units": "degree", "long_name": "angle between the rays and the film's normal"}
        return xr.Dataset(
            variables,
            coords={
                "polarisation": list(POLARISATIONS),
                "angle": ("angle", np.degrees(self.incidence), angle),
                "wavelength": (
                    "wavelength", self.wavelength,
                    {"units": "m", "long_name": "wavelength in vacuum"},
                ),
                "temperature": (
                    "temperature", self.temperatures,
                    {"units": "K", "long_name": "temperature of the black body"},
                ),
            },
            attrs={
                "title": "lightflyer film by angle",
                "lightflyer_version": lightflyer.__version__,
                "light": self.light.name,
            },
        )  # fmt: skip


def write_csv(summary: "AngularSummary", path: Path) -> None:
    """Write the averages, one row an angle, polarisation and spectrum."""
    spectra = [(summary.light.name, summary.lit.with_mean())]
    for number, temperature in enumerate(summary.temperatures):
        shares = DirectionalShares(*(part[..., number] for part in summary.thermal))
        spectra.append((f"black body {temperature:g} K", shares.with_mean()))
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["spectrum", "angle [deg]", "polarisation",
                         *(f"{name} [1]" for name in DirectionalShares._fields)])  # fmt: skip
        for name, table in spectra:
            for place, angle in enumerate(np.degrees(summary.incidence)):
                for row, polarisation in enumerate(POLARISATIONS):
                    numbers = (f"{values[row, place]:.8g}" for values in table.values())
                    writer.writerow([cell_text(name), f"{angle:.8g}", polarisation, *numbers])


def write_spectral_csv(summary: "AngularSummary", path: Path) -> None:
    """Write the spectra, one row a wavelength, angle and polarisation."""
    table = summary.spectral_shares.with_mean()
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["wavelength [um]", "angle [deg]", "polarisation",
                         *(f"{name} [1]" for name in table)])  # fmt: skip
        for column, wavelength in enumerate(summary.wavelength / MICROMETRE):
            for place, angle in enumerate(np.degrees(summary.incidence)):
                for row, polarisation in enumerate(POLARISATIONS):
                    numbers = (f"{values[row, place, column]:.8g}" for values in table.values())
                    writer.writerow([f"{wavelength:.8g}", f"{angle:.8g}", polarisation, *numbers])
