"""Tables of fitted spectra and constants, as CSV."""

from typing import TYPE_CHECKING

from lightflyer.lab.record import csv_text

if TYPE_CHECKING:
    from lightflyer.lab.optics.fit import OpticsFit


def tables(result: "OpticsFit") -> dict[str, str]:
    """Text of the tables of a fit."""
    found = {}
    for number, one in enumerate(result.spectra, start=1):
        spectrum = one.measured.spectrum
        found[f"optics-spectrum-{number}.csv"] = csv_text(
            [f"# {one.measured.label}"],
            {"wavelength [nm]": 1e9 * spectrum.wavelength, "measured": spectrum.value,
             "fitted reading": one.reading, "film": one.share},
        )  # fmt: skip
    for number, layer in enumerate(result.indices, start=1):
        found[f"optics-constants-{number}.csv"] = csv_text(
            [f"# {layer.name}, fitted; 95 % bands"],
            {"wavelength [um]": 1e6 * layer.wavelength, "n": layer.n, "k": layer.k,
             "n_low": layer.n_band[0], "n_high": layer.n_band[1],
             "k_low": layer.k_band[0], "k_high": layer.k_band[1]},
        )  # fmt: skip
    return found
