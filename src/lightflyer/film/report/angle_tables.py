"""Shares of light and heat radiation by angle as a dataset and as CSV files."""

import csv
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import lightflyer
from lightflyer.core.text import cell_text
from lightflyer.film.media.medium import MICROMETRE
from lightflyer.film.optics.angles import POLARISATIONS, DirectionalShares, shares_by_name

if TYPE_CHECKING:
    import xarray as xr

    from lightflyer.film.report.angular_summary import AngularSummary

_SPECTRAL = ("polarisation", "angle", "wavelength")
_LIT = ("polarisation", "angle")
_THERMAL = ("polarisation", "angle", "temperature")


def to_dataset(summary: "AngularSummary") -> "xr.Dataset":
    """Optics by angle as an xarray dataset."""
    # Names without addition are spectral, those with ``light_`` and ``thermal_`` averages.
    import xarray as xr

    groups = (
        ("", "", _SPECTRAL, summary.spectral_shares),
        ("light_", f", mean over {summary.light.name}", _LIT, summary.lit),
        ("thermal_", ", mean over a black body's radiation", _THERMAL, summary.thermal),
    )
    variables = {
        f"{prefix}{name}": (dims, values, {"units": "1", "long_name": f"{name}{about}"})
        for prefix, about, dims, shares in groups
        for name, values in shares_by_name(shares).items()
    }
    angle = {"units": "degree", "long_name": "angle between the rays and the film's normal"}
    return xr.Dataset(
        variables,
        coords={
            "polarisation": list(POLARISATIONS),
            "angle": ("angle", np.degrees(summary.incidence), angle),
            "wavelength": (
                "wavelength", summary.wavelength,
                {"units": "m", "long_name": "wavelength in vacuum"},
            ),
            "temperature": (
                "temperature", summary.temperatures,
                {"units": "K", "long_name": "temperature of the black body"},
            ),
        },
        attrs={
            "title": "lightflyer film by angle",
            "lightflyer_version": lightflyer.__version__,
            "light": summary.light.name,
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
