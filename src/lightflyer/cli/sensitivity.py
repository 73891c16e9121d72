"""``lightflyer sensitivity``: which uncertain property costs most."""

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter
from rich.console import Console
from rich.markup import escape
from rich.table import Table

if TYPE_CHECKING:
    from lightflyer.search.sobol import Indices


def sensitivity_command(
    study_file: Path,
    /,
    *,
    out: Path | None = None,
    json_output: Annotated[bool, Parameter(name="--json", negative=())] = False,
) -> None:
    """Say which property's uncertainty costs most, and so what to measure next.

    Parameters
    ----------
    study_file
        TOML file with flyer = "flyer.toml" and the sections [sensitivity] and [sensitivity.at];
        what is uncertain is taken from the ± of the flyer file or from [sensitivity.inputs].
    out
        Folder to write the result (JSON) and a tornado figure (PNG, SVG) for each output into.
    json_output
        Print one JSON object instead of tables.
    """
    from lightflyer.search.sobol import read_inquiry, sensitivity_indices

    inquiry = read_inquiry(study_file)
    results = sensitivity_indices(inquiry)
    summary = {found.output: found.summary() for found in results}
    written = [] if out is None else _write(out, summary, results)
    if json_output:
        print(json.dumps(summary, allow_nan=False))  # noqa: T201
        return
    console = Console(highlight=False)
    for found in results:
        _show(console, found)
    pairs = [group for group in inquiry.groups if len(group) > 1]
    for pair in pairs:
        console.print(
            f"{' and '.join(pair)} vary together (tac_correlation = {inquiry.tac_correlation:g}) "
            "and have one share; beside it stand the output's quantiles",
            soft_wrap=True,
        )
    for path in written:
        console.print(f"wrote {path}", soft_wrap=True)


def _write(out: Path, summary: dict[str, Any], results: "list[Indices]") -> list[Path]:
    from lightflyer.foundation import drawing as plot
    from lightflyer.foundation.files import output_directory
    from lightflyer.sweeps import figures as sweep_figures

    names = ["sensitivity.json"]
    with output_directory(out) as stage:
        text = json.dumps(summary, indent=2, allow_nan=False)
        stage("sensitivity.json").write_text(text + "\n", encoding="utf-8")
        for found in results:
            files = [f"{found.output}-tornado.{suffix}" for suffix in ("png", "svg")]
            plot.save(sweep_figures.tornado_figure(found), [stage(file) for file in files])
            names += files
    return [out / name for name in names]


def _show(console: Console, found: "Indices") -> None:
    from lightflyer.flight.outputs import unit_of_output

    name = unit_of_output(found.output)
    unit = f" {name}" if name else ""
    console.print(
        f"{found.output} {found.nominal:.4g}{unit}; over all inputs {found.mean:.4g} ± "
        f"{found.spread:.2g}{unit}",
        soft_wrap=True,
    )
    table = Table(box=None, padding=(0, 1, 0, 0))  # so that it fits into 80 columns
    ends = (escape(f"at its\n{end} %\n[{name or '1'}]") for end in ("2.5", "97.5"))
    shares = ("share of\nvariance\n[%]", "with inter-\nactions\n[%]")
    headings = ("input", *shares, "elasticity", *ends)
    for heading in headings:
        left = heading == "input"
        table.add_column(heading, justify="left" if left else "right", no_wrap=True)
    for row in (-found.total).argsort():
        table.add_row(
            "\n".join(found.groups[row]),
            f"{100.0 * found.first[row]:.1f} ± {100.0 * found.first_interval[row]:.1f}",
            f"{100.0 * found.total[row]:.1f} ± {100.0 * found.total_interval[row]:.1f}",
            "\n".join(_signed(found.elasticity[name]) for name in found.groups[row]),
            _short(found.low[row]),
            _short(found.high[row]),
        )
    console.print(table)
    if not found.ranked:
        advice = "too few points to say what to measure next: shares are known to "
        advice += f"± {100.0 * found.first_interval.max():.0f} % at worst; raise points"
    elif found.next is None:
        advice = "all of it is the model's own error, which no measurement makes smaller"
    else:
        advice = f"measure {found.next} next: half that uncertainty would leave ± "
        advice += f"{found.spread_after_halving:.2g}{unit}"
    console.print(advice, soft_wrap=True)


def _short(value: float) -> str:
    """Few digits where a power of ten takes room: the table fits into 80 columns."""
    text = f"{value:.4g}"
    return f"{value:.3g}" if "e" in text else text


def _signed(elasticity: float) -> str:
    return "–" if math.isnan(elasticity) else f"{elasticity:+.3g}"
