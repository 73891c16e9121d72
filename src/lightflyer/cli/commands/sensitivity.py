"""``lightflyer sensitivity``: which uncertain property matters most."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table

from lightflyer.cli.figure_files import AS_USUAL, FigureOptions, ResultOptions
from lightflyer.cli.options import Json
from lightflyer.cli.output import print_json, printer, write_json
from lightflyer.core.constants import NORMAL_HALF_WIDTH_95

if TYPE_CHECKING:
    from lightflyer.search.sobol import Indices


def sensitivity_command(
    study_file: Path,
    /,
    *,
    out: Path | None = None,
    json_output: Json = False,
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Rank uncertain properties by their effect, and say what to measure next.

    Parameters
    ----------
    study_file
        TOML file with flyer = "flyer.toml" and the sections [sensitivity] and [sensitivity.at];
        uncertainties are those of [sensitivity.inputs], by default those of the flyer file.
    out
        Folder to write the result (JSON) and a tornado figure for each output into.
    json_output
        Print one JSON object instead of tables.
    figures
        How figures are written.
    """
    out = figures.folder(out)
    from lightflyer.search import read_sensitivity_study, sensitivity

    study = read_sensitivity_study(study_file)
    results = sensitivity(study)
    summary = {found.output: found.summary() for found in results}
    written = [] if out is None else _write(out, summary, results, figures)
    if json_output:
        print_json(summary)
        return
    console = printer()
    for found in results:
        _show(console, found)
    for group in study.groups:
        if len(group) > 1:
            values = (v for pair, v in study.correlations.items() if set(pair) <= set(group))
            console.print(
                f"{' and '.join(group)} vary together (correlation "
                f"{', '.join(f'{value:g}' for value in values)}) and have one share; the last two "
                "columns are quantiles of the output",
                soft_wrap=True,
            )
    for text in study.design.sampling_warnings:
        console.print(f"warning: {text}", soft_wrap=True)
    figures.tell(console, written)


def _write(
    out: Path, summary: dict[str, Any], results: "list[Indices]", figures: FigureOptions
) -> list[Path]:
    from lightflyer.core.atomic_files import output_directory
    from lightflyer.search.figures import tornado_figure

    names = ["sensitivity.json"]
    with output_directory(out) as stage:
        write_json(stage("sensitivity.json"), summary)
        names += figures.write(
            stage, lambda: {f"{found.output}-tornado": tornado_figure(found) for found in results}
        )
    return [out / name for name in names]


def _show(console: Console, found: "Indices") -> None:
    factor, name = found.shown
    unit = f" {name}" if name else ""
    console.print(
        f"{found.output} {factor * found.nominal:.4g}{unit}; over all inputs "
        f"{factor * found.mean:.4g} ± {factor * found.spread:.2g}{unit}",
        soft_wrap=True,
    )
    table = Table(box=None, padding=(0, 1, 0, 0))  # so that it fits into 80 columns
    ends = (f"at its\n{end} %\n[{name or '1'}]" for end in ("2.5", "97.5"))
    shares = ("share of\nvariance\n[%]", "with inter-\nactions\n[%]")
    headings = ("input", *shares, "elasticity", *ends)
    for heading in headings:
        left = heading == "input"
        table.add_column(heading, justify="left" if left else "right", no_wrap=True)
    for row in (-found.total).argsort():
        table.add_row(
            "\n".join(found.groups[row]),
            _share(found.first[row], found.first_interval[row]),
            _share(found.total[row], found.total_interval[row]),
            "\n".join(_signed(found.elasticity[name]) for name in found.groups[row]),
            _short(factor * found.low[row]),
            _short(factor * found.high[row]),
        )
    console.print(table)
    if not found.ranked:
        advice = "too few points to say what to measure next: the 95 % interval of a share reaches "
        advice += f"{100.0 * found.first_interval.max():.0f} % to either side; raise points"
    elif found.next is None:
        advice = "all of it is the model's own error, which measurements cannot reduce"
    else:
        advice = f"measure {found.next} next: halving its uncertainty would leave ± "
        advice += f"{factor * found.spread_after_halving:.2g}{unit}"
    console.print(advice, soft_wrap=True)


def _share(share: float, half_width: float) -> str:
    """A share in percent with its standard uncertainty, from that and half its 95 % interval."""
    return f"{100.0 * share:.1f} ± {100.0 * half_width / NORMAL_HALF_WIDTH_95:.1f}"


def _short(value: float) -> str:
    """Few digits where a power of ten takes room: the table fits into 80 columns."""
    text = f"{value:.4g}"
    return f"{value:.3g}" if "e" in text else text


def _signed(elasticity: float) -> str:
    return "–" if math.isnan(elasticity) else f"{elasticity:+.3g}"
