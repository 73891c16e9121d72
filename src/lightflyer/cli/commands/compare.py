"""``lightflyer compare``: several flyers side by side."""

import math
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table

from lightflyer.cli.figure_files import AS_USUAL, FigureOptions, ResultOptions
from lightflyer.cli.options import Json, Samples, Seed
from lightflyer.cli.output import print_json, printer, write_json
from lightflyer.core.errors import ConfigurationError

if TYPE_CHECKING:
    from lightflyer.comparison.comparison import Compared, Comparison

_LETTERS = "ABCDEFGHI"


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
        Of the samples.
    figures
        How figures are written.
    """
    out = figures.folder(out)
    from lightflyer.comparison.comparison import compare
    from lightflyer.config.reader import read_flyer_file

    for path in flyer_files:
        read_flyer_file(path)  # every mistake in a file is told before anything is computed
    searched = _range(altitudes, pressures, flyer_files)
    comparison = compare(*flyer_files, searched=searched, samples=samples, seed=seed)
    written = _write(out, comparison, figures) if out is not None else []
    if json_output:
        print_json(comparison.summary())
        return
    console = printer()
    _show(console, comparison)
    figures.tell(console, written, "add --out FOLDER to write the figure and data")


def _range(
    altitudes: str | None, pressures: str | None, flyer_files: tuple[Path, ...]
) -> tuple[float, float] | None:
    """The range asked for in SI units."""
    from lightflyer.config.reader import read_flyer_file
    from lightflyer.core.units import parse

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
    ends = text.split(" to ")
    example = '"50 km to 100 km"' if name == "altitude" else '"1 Pa to 100 Pa"'
    if len(ends) != 2:
        raise ConfigurationError(f'--{name}s "{text}": write a range, as in {example}')
    try:
        low, high = (parse(end.strip(), where.unit).value for end in ends)
    except ConfigurationError as error:
        raise ConfigurationError(f"--{name}s: {error}") from None
    return low, high


def _write(out: Path, comparison: "Comparison", figures: FigureOptions) -> list[Path]:
    from lightflyer.comparison.figures import comparison_figure
    from lightflyer.comparison.tables import to_dataset, write_csv
    from lightflyer.core.atomic_files import output_directory

    names = [f"comparison.{ending}" for ending in ("nc", "csv", "json")]
    tables, table, summary = names
    with output_directory(out) as stage:
        to_dataset(comparison).to_netcdf(stage(tables), engine="h5netcdf")
        write_csv(comparison, stage(table))
        write_json(stage(summary), comparison.summary())
        names += figures.write(stage, lambda: {"comparison": comparison_figure(comparison)})
    return [out / name for name in names]


def _show(console: Console, comparison: "Comparison") -> None:
    for letter, found in zip(_LETTERS, comparison.flyers, strict=False):
        console.print(f"{letter}  {found.name}: {found.description}", soft_wrap=True)
    console.print(_best_table(comparison))
    console.print(_payloads_table(comparison))
    if any(found.setup.budget is not None for found in comparison.flyers):
        console.print(needs_table(comparison))
    for difference in comparison.differing_models:
        console.print(str(difference), soft_wrap=True)
    for text in comparison.warnings:
        console.print(f"warning: {text}", soft_wrap=True)


def _best_table(comparison: "Comparison") -> Table:
    """Largest payload of each flyer; the best of all is marked."""
    unit, (scale, mass) = comparison.coordinate.shown_unit, comparison.shown("payload")
    table = Table(box=None, padding=(0, 1), collapse_padding=True, pad_edge=False)
    table.add_column("")
    headings = (f"best payload\n[{mass}]", f"95 % band\n[{mass}]", f"at\n[{unit}]",
                "per area\n[g/m²]", "of own\nmass", "hottest\n[K]",
                f"levitates\n[{unit}]")  # fmt: skip
    for heading in headings:
        table.add_column(heading, justify="right", no_wrap=True)
    for letter, found in zip(_LETTERS, comparison.flyers, strict=False):
        mark = "*" if found is comparison.best and found.prediction.bands else " "
        table.add_row(f"{letter}{mark}", *_best_cells(found, scale))
    return table


def _best_cells(found: "Compared", scale: float) -> tuple[str, ...]:
    from lightflyer.design.outputs import OUTPUTS

    prediction, digits = found.prediction, _digits(found)
    values, (_, factor) = prediction.best.values, prediction.coordinate_key
    band = found.best_band("payload")
    shown = {name: values[name] * OUTPUTS[name].shown[0] for name in values if name in OUTPUTS}
    widest = prediction.widest
    flies = "nowhere"
    if widest is not None:
        low, high = (format(edge * factor, digits) for edge in prediction.bands[widest])
        flies = f"{low} to {high}" + (" …" if len(prediction.bands) > 1 else "")
    return (
        format(values["payload"] * scale, ".4g"),
        "–" if band is None else f"{band[0] * scale:.3g} to {band[1] * scale:.3g}",
        format(prediction.best.coordinate * factor, digits),
        format(shown["payload_per_area"], ".3g"),
        format(shown["relative_payload"], ".3g"),
        format(shown["temperature"], ".0f"),
        flies,
    )


def needs_table(comparison: "Comparison") -> Table:
    """What each flyer's payload needs where it carries most, and what is left."""
    from lightflyer.design.outputs import BUDGET_OUTPUTS, budget_outputs

    table = Table(box=None, padding=(0, 1), collapse_padding=True, pad_edge=False)
    table.add_column("")
    having = [found for found in comparison.flyers if found.setup.budget is not None]
    scales = {}
    for name, output in BUDGET_OUTPUTS.items():
        values = [found.prediction.best.values.get(name, math.nan) for found in having]
        scales[name], unit = output.shown_for(values)
        heading = f"{name.replace('_', ' ')}\n[{unit.replace('^2', '²')}]"
        table.add_column(heading, justify="right", no_wrap=True)
    for letter, found in zip(_LETTERS, comparison.flyers, strict=False):
        known, best = budget_outputs(found.setup), found.prediction.best.values
        cells = [
            format(best[name] * scale, ".4g") if name in known else "–"
            for name, scale in scales.items()
        ]
        table.add_row(letter, *cells)
    return table


def _digits(found: "Compared") -> str:
    return ".3g" if found.prediction.coordinate.logarithmic else ".1f"


def _payloads_table(comparison: "Comparison") -> Table:
    """Payload of each flyer at round coordinates; the largest is marked."""
    where, (scale, mass) = comparison.coordinate, comparison.shown("payload")
    _, factor = comparison.flyers[0].prediction.coordinate_key
    table = Table(box=None, padding=(0, 1), collapse_padding=True, pad_edge=False)
    heading = f"{where.name} [{where.shown_unit}]; payload [{mass}]"
    table.add_column(heading, justify="right", no_wrap=True)
    for letter, _ in zip(_LETTERS, comparison.flyers, strict=False):
        table.add_column(letter, justify="right")
    for index, coordinate in enumerate(comparison.listed):
        payloads = [found.listed["payload"][index] * scale for found in comparison.flyers]
        best = max(payloads)
        cells = [
            f"{payload:.3g}{'*' if payload == best > 0.0 else ' '}" if payload > 0.0 else "– "
            for payload in payloads
        ]
        table.add_row(f"{coordinate * factor:.6g}", *cells)
    return table
