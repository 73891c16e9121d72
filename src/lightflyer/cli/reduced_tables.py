"""What ``lightflyer sweep --reduce`` prints."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from lightflyer.cli.output import print_json, printer
from lightflyer.files.result_text import table_of

if TYPE_CHECKING:
    import xarray as xr

    from lightflyer.parametric.run import SweepReport
    from lightflyer.study.study import Study

_SHOWN_SHARES = (0.0, 0.05, 0.5, 0.95, 1.0)
_SHOWN_DESIGNS = 5


def show_reduced(
    study: "Study", out: Path, report: "SweepReport", line: str, *, json_output: bool
) -> None:
    """Print what a reduced sweep kept; ``out``: its file; ``line``: the report in words."""
    from lightflyer.parametric.reduced import open_reduced

    tree = open_reduced(out)
    warnings = _warnings(study, tree)
    if json_output:
        print_json(_summary(out, report, tree, warnings))
        return
    console = printer()
    console.print(line, soft_wrap=True)
    if report.not_converged:
        console.print(f"{report.not_converged} designs have not converged and are left out")
    for name, group in _groups(tree, "best"):
        _show_best(console, name, group)
    for name, group in _groups(tree, "fronts"):
        count = group.sizes["point"]
        shown = "1 design" if count == 1 else f"{count} designs"
        console.print(f"front, {name.replace('_', ' ')}: {shown}")
    _show_distributions(console, tree)
    for text in warnings:
        console.print(f"warning: {text}", soft_wrap=True)
    console.print(f"wrote {out}", soft_wrap=True)


def _groups(tree: "xr.DataTree", kind: str) -> "list[tuple[str, xr.Dataset]]":
    if kind not in tree:
        return []
    return [(str(name), group.to_dataset()) for name, group in tree[kind].children.items()]


def _show_best(console: Console, name: str, group: "xr.Dataset") -> None:
    from lightflyer.files.display_units import suitable, unit_of

    count = group.sizes["rank"]
    if not count:
        console.print(f"no design has a {name}")
        return
    ranks = [str(rank + 1) for rank in range(min(count, _SHOWN_DESIGNS))]
    title, unit_column = f"best {name} ({count} kept)", len(ranks) + 1
    table = table_of(["", *ranks, "unit"], left=(0, unit_column), title=title)
    for key in [*group.data_vars, *group.coords]:
        if key == "design" or group[key].dims != ("rank",):
            continue
        values = group[key].values[:_SHOWN_DESIGNS]
        factor, unit = suitable(unit_of(group[key]), values)
        table.add_row(str(key), *(f"{value * factor:.5g}" for value in values), unit)
    console.print(table)


def _show_distributions(console: Console, tree: "xr.DataTree") -> None:
    from lightflyer.files.display_units import suitable, unit_of

    shares = (f"{100 * share:g} %" for share in _SHOWN_SHARES[1:-1])
    headings = ("", "least", *shares, "most", "unit", "designs", "without")
    table = table_of(headings, left=(0, headings.index("unit")), title="all designs")
    for name, group in _groups(tree, "distributions"):
        values = group["quantile"].sel(share=list(_SHOWN_SHARES))
        factor, unit = suitable(unit_of(values), values.values)
        known, without = (group.attrs[key] for key in ("designs", "designs without a value"))
        shown = (f"{value * factor:.5g}" for value in values.values)
        table.add_row(name, *shown, unit, f"{known:,}", f"{without:,}")
    console.print(table)


def _warnings(study: "Study", tree: "xr.DataTree") -> list[str]:
    """Diagnostics of the best design of each output; of the study itself where there is none."""
    from lightflyer.design.diagnostics import diagnose_design

    found: list[str] = []
    for _, group in _groups(tree, "best"):
        if group.sizes["rank"]:
            best = group.isel(rank=0)
            there = {str(name): float(value) for name, value in best.coords.items()}
            found += (f"best design: {text}" for text in diagnose_design(study.design, there))
    return list(dict.fromkeys(found or study.design.warnings))


def _summary(
    out: Path, report: "SweepReport", tree: "xr.DataTree", warnings: list[str]
) -> dict[str, Any]:
    from lightflyer.files.display_units import unit_of

    best = {}
    for name, group in _groups(tree, "best"):
        first = group.isel(rank=0) if group.sizes["rank"] else None
        best[name] = None if first is None else {
            "value": float(first[name]),
            "unit": unit_of(first[name]),
            "where": {
                str(key): {"value": float(value), "unit": unit_of(value)}
                for key, value in first.coords.items()
            },
        }  # fmt: skip
    return {
        "out": str(out),
        "designs": report.designs,
        "found": report.found,
        "computed": report.computed,
        "not_converged": report.not_converged,
        "seconds": report.seconds,
        "best": best,
        "fronts": {name: group.sizes["point"] for name, group in _groups(tree, "fronts")},
        "medians": {
            name: float(group["quantile"].sel(share=0.5))
            for name, group in _groups(tree, "distributions")
        },
        "warnings": warnings,
    }
