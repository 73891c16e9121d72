"""A film by angle and polarisation in one object, as the command ``film`` reports it."""

import csv
import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import lightflyer
from lightflyer.array.records import ShortRepr
from lightflyer.core.text import cell_text
from lightflyer.film.media.medium import MICROMETRE
from lightflyer.film.optics.angles import (
    POLARISATIONS,
    DirectionalShares,
    heat_by_angle,
    light_by_angle,
    shares_by_name,
)
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
        from lightflyer.film.report.figures import draw_angles

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
            for name, values in shares_by_name(shares).items()
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
    spectra = [(summary.light.name, shares_by_name(summary.lit))]
    for number, temperature in enumerate(summary.temperatures):
        shares = DirectionalShares(*(part[..., number] for part in summary.thermal))
        spectra.append((f"black body {temperature:g} K", shares_by_name(shares)))
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
    table = shares_by_name(summary.spectral_shares)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["wavelength [um]", "angle [deg]", "polarisation",
                         *(f"{name} [1]" for name in table)])  # fmt: skip
        for column, wavelength in enumerate(summary.wavelength / MICROMETRE):
            for place, angle in enumerate(np.degrees(summary.incidence)):
                for row, polarisation in enumerate(POLARISATIONS):
                    numbers = (f"{values[row, place, column]:.8g}" for values in table.values())
                    writer.writerow([f"{wavelength:.8g}", f"{angle:.8g}", polarisation, *numbers])
