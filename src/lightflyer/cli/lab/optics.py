"""``lightflyer lab optics``: thicknesses, mixtures and constants of a film from its spectra."""

from pathlib import Path
from typing import TYPE_CHECKING

from lightflyer.cli.figure_files import AS_USUAL, ResultOptions
from lightflyer.cli.lab.shared import (
    Insist,
    deliver,
    rejected_parts,
)
from lightflyer.cli.options import Json, Seed, Whole, only_with
from lightflyer.files.result_text import Parts

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from lightflyer.lab.optics.fit import OpticsFit


@only_with(insist="update")
def optics_command(
    sample_file: Path,
    /,
    *,
    starts: Whole = 16,
    out: Path | None = None,
    update: Path | None = None,
    insist: Insist = False,
    seed: Seed = 0,
    json_output: Json = False,
    figures: ResultOptions = AS_USUAL,
) -> None:
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
    out
        Folder to write the record (JSON, NetCDF, CSV) and the figures into.
    update
        Flyer file whose [film] has the same layers, to write the fitted numbers, their ± and their
        correlations into.
    insist
        Have --update write also what is in doubt: of a wrong unit, not determined, or of data that
        do not fit or not cover it.
    seed
        Seed of the starts, and of the bands of n and k.
    json_output
        Print one JSON object instead of tables.
    figures
        How figures are written.
    """
    out = figures.folder(out)
    from lightflyer.lab.optics.data import read_sample
    from lightflyer.lab.optics.fit import fit_optics, to_dataset
    from lightflyer.lab.optics.record import tables
    from lightflyer.lab.optics.text import finding_parts

    sample = read_sample(sample_file)
    if update is not None:
        from lightflyer.lab.optics.flyer_file import require_same_layers

        require_same_layers(update, sample)
    result = fit_optics(sample, starts=starts, seed=seed)
    document = result.summary() | {"read": [
        {"file": one.spectrum.source, "format": one.spectrum.metadata.format,
         "rejected": [{"line": row.line, "reason": row.reason} for row in one.spectrum.rejected]}
        for one in sample.spectra
    ]}  # fmt: skip

    def write() -> list[str]:
        if update is None:
            return []
        from lightflyer.lab.optics.flyer_file import update_layers

        changes = update_layers(update, result, sample_file.name, insist=insist)
        return [f"{update}: {text}" for text in changes]

    def draw() -> "dict[str, Figure]":
        from lightflyer.lab.optics.figures import optics_figures

        return optics_figures(result)

    deliver(
        "optics", document, to_dataset(result), draw,
        [*finding_parts(result), *_read_parts(result), *result.text_parts()],
        out=out, figures=figures, json_output=json_output, update=write, tables=tables(result),
    )  # fmt: skip


def _read_parts(result: "OpticsFit") -> Parts:
    for one in result.spectra:
        spectrum = one.measured.spectrum
        ends = spectrum.wavelength[[-1, 0]] * 1e6
        yield (
            f"read {len(spectrum.value)} points of {spectrum.quantity} from {spectrum.source}, "
            f"{ends[0]:.4g} to {ends[1]:.4g} µm"
        )
        yield from rejected_parts(spectrum.rejected)
