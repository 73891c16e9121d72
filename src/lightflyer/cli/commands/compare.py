"""``lightflyer compare``: several flyers side by side."""

from pathlib import Path

from lightflyer.cli.figure_files import AS_USUAL, ResultOptions
from lightflyer.cli.options import Json, Samples, Seed, coordinate_range
from lightflyer.cli.output import print_json, printer, show
from lightflyer.core.atomic_files import write_netcdf
from lightflyer.core.errors import ConfigurationError


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
