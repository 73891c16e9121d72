"""Options, tables and records that the commands of the lab bench share."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from lightflyer.cli.figure_files import ResultOptions
from lightflyer.cli.output import print_json, printer, show, write_json
from lightflyer.files.result_text import Parts, wrap

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from lightflyer.files.table import Table as LabTable
    from lightflyer.files.table_rows import Rejected
    from lightflyer.lab.estimate import Estimate

Files = Annotated[list[Path], Parameter(consume_multiple=True, negative=())]
"""Input files of a command."""

Insist = Annotated[bool, Parameter(negative=())]
"""Whether --update also writes what is in doubt."""

_SHOWN_REJECTED = 10


def read_summary(tables: Sequence["LabTable"]) -> list[dict[str, Any]]:
    """JSON list of the files read, their rows, and the rejected rows with reasons."""
    return [
        {
            "file": table.source,
            "rows": len(table),
            "rejected": [{"line": row.line, "reason": row.reason} for row in table.rejected],
            "columns_not_used": table.unused,
            "notes": table.notes,
        }
        for table in tables
    ]


def read_parts(tables: Iterable["LabTable"]) -> Parts:
    """The files read, and their rejected rows."""
    for table in tables:
        unused = f"; not used: {', '.join(table.unused)}" if table.unused else ""
        yield f"read {len(table)} row{'s' * (len(table) != 1)} of {table.source}{unused}"
        yield from rejected_parts(table.rejected)
        yield from (f"  note: {note}" for note in table.notes)


def rejected_parts(rejected: Sequence["Rejected"]) -> Parts:
    """Rejected rows, only the first of very many."""
    yield from (f"  rejected {row}" for row in rejected[:_SHOWN_REJECTED])
    if len(rejected) > _SHOWN_REJECTED:
        yield f"  and {len(rejected) - _SHOWN_REJECTED} more rows, listed in the JSON record"


def deliver(
    name: str,
    document: dict[str, Any],
    dataset: "xr.Dataset",
    draw: Callable[[], dict[str, "Figure"]],
    parts: Parts,
    *,
    out: Path | None,
    figures: ResultOptions,
    json_output: bool,
    update: Callable[[], list[str]] = list,
    tables: Mapping[str, str | bytes] | None = None,
) -> None:
    """Write a measurement's record and figures, and print its text or its JSON object."""
    from lightflyer.core.atomic_files import output_directory

    names: list[str] = []
    with nullcontext() if out is None else output_directory(out) as stage:
        if stage is not None:
            names = [f"{name}.json", f"{name}.nc"]
            write_json(stage(names[0]), document)
            dataset.to_netcdf(stage(names[1]), engine="h5netcdf")
            for file, content in (tables or {}).items():
                whole = content.encode() if isinstance(content, str) else content
                stage(file).write_bytes(whole)
                names.append(file)
            names += figures.write(stage, draw)
        # the flyer file is changed after all files are prepared; if that fails, nothing is written
        updated = update()
    if json_output:
        print_json(document)
        return
    console = printer()
    show(console, map(_narrow, parts))
    written = [] if out is None else [out / file for file in names]
    figures.tell(console, written, "add --out FOLDER to write a record and a figure")
    show(console, map(_narrow, updated))


def _narrow(part: Any) -> Any:
    """A line of text in lines of a narrow terminal; tables as they are."""
    return "\n".join(map(wrap, part.splitlines())) if isinstance(part, str) else part


def updater(
    flyer: Path | None,
    values: "Mapping[tuple[str, str], Estimate]",
    name: str,
    files: Sequence[Path],
    *,
    insist: bool,
    warnings: Sequence[str],
    digits: int = 2,
) -> Callable[[], list[str]]:
    """Function that writes values into a flyer file, if one is named; see :func:`deliver`.

    ``warnings``: of the result, which is not written where one is a doubt; ``digits``: of the
    standard uncertainties.
    """

    def update() -> list[str]:
        if flyer is None:
            return []
        from lightflyer.config.update import update_flyer_file
        from lightflyer.lab.record import require_no_doubt

        require_no_doubt(flyer, warnings, insist=insist)
        origin = ", ".join([f"lab {name}", *(file.name for file in files)])
        changes = update_flyer_file(flyer, values, origin, insist=insist, digits=digits)
        return [f"{flyer}: {text}" for text in changes]

    return update


def heated(temperature: str | None, tube: str | None) -> tuple[float | None, float | None]:
    """Temperature [K] of a gauge and diameter [m] of its tube, as the options give them."""
    from lightflyer.cli.quantities import exact

    return (
        None if temperature is None else exact("--gauge-temperature", temperature, "K"),
        None if tube is None else exact("--gauge-tube", tube, "m"),
    )
