"""``lightflyer predict``, ``compare``: what flyers will do, one by one or side by side."""

import json
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from lightflyer.cli.options import (
    AS_USUAL,
    Json,
    ResultOptions,
    Samples,
    Seed,
    coordinate,
    coordinate_range,
)
from lightflyer.cli.output import print_json, printer, say, show
from lightflyer.core.errors import ConfigurationError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from lightflyer.config.flyer_file import FlyerFile
    from lightflyer.prediction.prediction import Prediction


def predict_command(
    flyer_file: Path,
    /,
    *,
    out: Path | None = None,
    at: str | None = None,
    json_output: Json = False,
    csv: Annotated[bool, Parameter(negative=())] = False,
    verbose: Annotated[bool, Parameter(negative=())] = False,
    samples: Samples = 500,
    seed: Seed = 0,
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Predict where a flyer levitates, what it carries and how hot it gets.

    Parameters
    ----------
    flyer_file
        TOML file that describes flyer, film, environment and force model; "lightflyer init"
        writes one.
    out
        Folder to write figures, the dataset (NetCDF) and the summary (JSON) into.
    at
        Altitudes such as "68 km,72 km", or in a chamber pressures such as "3 Pa,30 mTorr", to
        report one by one.
    json_output
        Print one JSON object instead of tables.
    csv
        With --out, write the table as CSV too.
    verbose
        Print all results, all bands and what is assumed.
    samples
        Monte Carlo samples for the bands of a file with ±; 0 for first order alone.
    seed
        Seed of the samples' random numbers.
    figures
        How figures are written.
    """
    if csv and out is None:
        raise ConfigurationError("--csv: the table needs a folder; add --out FOLDER")
    out = figures.folder(out)
    from lightflyer.config.reader import read_design
    from lightflyer.uncertainty.propagation import require_samples
    from lightflyer.uncertainty.with_bands import predict_with_bands

    require_samples(samples, seed, "--")
    design = read_design(flyer_file)
    file, where = design.file, design.setup.environment.coordinate
    points = None
    if at is not None:
        asked = map(str.strip, at.split(","))
        points = [coordinate("--at", part, where) for part in asked if part]
        if not points:
            raise ConfigurationError(f'--at "{at}" names no {where.name}')
    prediction = predict_with_bands(design, points, samples, seed)
    incidence = float(file.environment.light_incidence)
    summary = prediction.summary() | {
        name: film.report(incidence, passing=file.flyer.needs_transmittance)
        for name, film in file.films().items()
        if film.layered
    }
    written: list[Path] = []
    if out is not None:
        written = _write(out, flyer_file, file, prediction, summary, figures, csv=csv)
    if json_output:
        print_json(summary)
        return
    console = printer()
    if verbose or at is not None or figures.report is not None:
        from lightflyer.prediction.text import prediction_parts
        from lightflyer.uncertainty.text import band_parts

        found = prediction.uncertainty
        told = () if found is None else (found.bands, found.shares)
        show(console, prediction_parts(prediction, console.width, *told, verbose=True))
        for name in filter(summary.__contains__, file.films()):
            film = summary[name]
            parts = []
            for key, entry in film.items():
                if key != "extrapolated":
                    value, spread = entry["value"], entry.get("uncertainty")
                    ends = [*value.items()][:: len(value) - 1 or 1] if type(value) is dict else []
                    text = " to ".join(f"{number:.3g} at {kelvin} K" for kelvin, number in ends)
                    text = (text or f"{value:.4g}") + (f" ± {spread:g}" if spread else "")
                    parts.append(f"{key} {text} ({entry['origin']})")
            console.print(f"{name}: {', '.join(parts)}", soft_wrap=True)
        if found is not None:
            show(console, band_parts(summary["uncertainty"], console.width))
    else:
        show(console, prediction.text_parts(console.width))
    if prediction.uncertainty is None and file.uncertainties():
        uncertain = ", ".join(file.uncertainties())
        console.print(f"uncertainties of {uncertain} are kept with the data, not propagated")
    figures.tell(console, written, "--out FOLDER writes figures and data")
    if not verbose:
        say(console, f"next: --verbose for all results, or: lightflyer explore {flyer_file}")


def _write(
    out: Path,
    flyer_file: Path,
    file: "FlyerFile",
    prediction: "Prediction",
    summary: dict[str, Any],
    figures: ResultOptions,
    *,
    csv: bool,
) -> list[Path]:
    from lightflyer.core.atomic_files import write_columns
    from lightflyer.prediction.figures import prediction_figures
    from lightflyer.prediction.tables import columns, write_csv

    uncertainty = prediction.uncertainty
    coords, variables, attributes = columns(prediction, flyer_file.read_text(encoding="utf-8-sig"))
    attributes["uncertainties"] = json.dumps(file.uncertainties())
    attributes["summary"] = json.dumps(summary)
    if uncertainty is not None:
        for whole, bands in zip((coords, variables), uncertainty.columns(), strict=True):
            whole |= bands

    def draw() -> "dict[str, Figure]":
        drawn = prediction_figures(prediction)
        if uncertainty is not None:
            from lightflyer.uncertainty.text import add_to_figures

            add_to_figures(drawn, uncertainty)
        return drawn

    files: dict[str, Any] = {
        "prediction.nc": lambda path: write_columns(path, coords | variables, attributes),
        "prediction.json": summary,
    }
    if csv:
        files["prediction.csv"] = partial(write_csv, prediction)
    return figures.write_folder(out, files, draw)


def compare_command(
    *flyer_files: Path,
    altitudes: str | None = None,
    pressures: str | None = None,
    out: Path | None = None,
    json_output: Json = False,
    samples: Samples = 500,
    seed: Seed = 0,
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Compare flyers: payload, lift and temperature side by side, each in its own surroundings.

    Parameters
    ----------
    flyer_files
        Two to nine flyer files, all in an atmosphere or all in chambers.
    altitudes
        Range to compare in, such as "50 km to 100 km"; by default wherever any of them comes near
        to flying.
    pressures
        The same for chambers, such as "1 Pa to 100 Pa".
    out
        Folder to write the figure, the tables (NetCDF, CSV) and the summary (JSON) into.
    json_output
        Print one JSON object instead of tables.
    samples
        Monte Carlo samples for the bands of files with ±; 0 for first order alone.
    seed
        Seed of the samples' random numbers.
    figures
        How figures are written.
    """
    out = figures.folder(out)
    from lightflyer.comparison.comparison import compare
    from lightflyer.comparison.text import to_dataset, write_csv
    from lightflyer.config.reader import read_flyer_file
    from lightflyer.core.atomic_files import write_netcdf

    for path in flyer_files:
        read_flyer_file(path)  # every mistake in a file is told before anything is computed
    searched = _range(altitudes, pressures, flyer_files)
    comparison = compare(flyer_files, searched=searched, samples=samples, seed=seed)
    summary = comparison.summary()
    files = {
        "comparison.nc": lambda path: write_netcdf(to_dataset(comparison), path),
        "comparison.csv": lambda path: write_csv(comparison, path),
        "comparison.json": summary,
    }
    written = figures.write_folder(out, files, lambda: {"comparison": comparison.plot()})
    if json_output:
        print_json(summary)
        return
    console = printer()
    show(console, comparison.text_parts())
    figures.tell(console, written, "add --out FOLDER to write the figure and data")


def _range(
    altitudes: str | None, pressures: str | None, flyer_files: tuple[Path, ...]
) -> tuple[float, float] | None:
    """The range asked for in SI units."""
    from lightflyer.config.reader import read_flyer_file

    asked = {"altitude": altitudes, "pressure": pressures}
    given = {name: text for name, text in asked.items() if text is not None}
    if not given:
        return None
    if len(given) > 1:
        raise ConfigurationError("give --altitudes or --pressures, not both")
    ((name, text),) = given.items()
    for path in flyer_files:
        where = read_flyer_file(path).design().setup.environment.coordinate
        if where.name != name:
            raise ConfigurationError(f"--{name}s: {path} is described over {where.name}")
    return coordinate_range(f"--{name}s", text, where)
