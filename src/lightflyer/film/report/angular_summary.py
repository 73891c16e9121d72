"""A film by angle and polarisation in one object, as the command ``film`` reports it."""

import dataclasses
from typing import TYPE_CHECKING

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.film.optics.angles import DirectionalShares, heat_by_angle, light_by_angle
from lightflyer.film.optics.spectra import SPECTRUM_RANGE, Spectrum
from lightflyer.film.optics.stack import Film
from lightflyer.film.optics.transfer_matrix import StackOptics

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

SPECTRUM_POINTS = 400


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
        from lightflyer.film.report.angle_figures import draw_angles

        return draw_angles(self)

    def to_dataset(self) -> "xr.Dataset":
        """The summary as an xarray dataset; see :mod:`lightflyer.film.report.angle_tables`."""
        from lightflyer.film.report.angle_tables import to_dataset

        return to_dataset(self)
