"""Thickness, porosity and optical constants of a film from its spectra."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lightflyer.lab.result import Outcome


def optics(
    sample_file: Path, /, *, starts: int = 16, seed: int = 0, update: Path | None = None
) -> "Outcome":
    """Fit thicknesses, porosity and optical constants of a film to measured spectra.

    Intervals are 95 % and include errors of the instruments' scales and zeros, and residuals that
    are alike over many points.

    Parameters
    ----------
    sample_file
        TOML file with the layers of a sample ([film]), the numbers in it that are free, and the
        spectra of transmittance and reflectance; "lightflyer lab example optics" writes one.
    starts
        How many points between the bounds minima are looked for from.
    update
        Flyer file whose [film] has the same layers, to write the fitted numbers, their ± and their
        correlations into.
    seed
        Seed of the starts, and of the bands of n and k.
    """
    from lightflyer.lab.optics.data import read_sample
    from lightflyer.lab.optics.fit import fit_optics, to_dataset
    from lightflyer.lab.optics.record import require_same_layers, tables, update_layers
    from lightflyer.lab.result import Outcome, figures_by, rejected_json, rejected_lines

    sample = read_sample(sample_file)
    if update is not None:
        require_same_layers(update, sample)
    result = fit_optics(sample, starts=starts, seed=seed)
    parts = [*result.finding()]
    for spectrum in (one.measured.spectrum for one in result.spectra):
        ends = spectrum.wavelength[[-1, 0]] * 1e6
        parts += [
            f"read {len(spectrum.value)} points of {spectrum.quantity} from {spectrum.source}, "
            f"{ends[0]:.4g} to {ends[1]:.4g} µm",
            *rejected_lines(spectrum.rejected),
        ]

    return Outcome(
        result.summary(),
        to_dataset(result),
        [*parts, *result.parts()],
        read=[
            {
                "file": one.spectrum.source,
                "format": one.spectrum.metadata.format,
                "rejected": rejected_json(one.spectrum.rejected),
            }
            for one in sample.spectra
        ],
        warnings=result.warnings,
        figures=figures_by("optics.figures:optics_figures", result),
        tables=tables(result),
        write=lambda flyer, insist: update_layers(flyer, result, sample_file.name, insist=insist),
    )
