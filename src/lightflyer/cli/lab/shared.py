"""Options, tables and records that the commands of the lab bench share."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from lightflyer.cli.figure_files import ResultOptions
from lightflyer.cli.output import print_json, printer, show, write_json
from lightflyer.core.errors import ConfigurationError
from lightflyer.files.result_text import Parts

if TYPE_CHECKING:
    import numpy as np
    import xarray as xr
    from matplotlib.figure import Figure

    from lightflyer.core.units import Measured
    from lightflyer.files.table import Table as LabTable
    from lightflyer.files.table_rows import Rejected
    from lightflyer.lab.estimate import Estimate

Files = Annotated[list[Path], Parameter(consume_multiple=True, negative=())]
"""Input files of a command."""

_USUAL = {"--diameter": "mm", "--wall": "cm", "--size": "um", "--at": "nm", "--band": "cm^-1"}
"""Units that messages propose, where they are not those of SI."""

_IMPOSSIBLE = {
    "K": "below absolute zero", "m": "not positive",
    **dict.fromkeys(("Pa", "W/m^2", "m^-1"), "negative"),
}  # fmt: skip

Insist = Annotated[bool, Parameter(negative=())]
"""Whether --update also writes what is most likely of a wrong unit."""

_SHOWN_REJECTED = 10


def quantity(option: str, text: str, unit: str) -> "Measured":
    """Value of an option such as ``--diameter "24 mm"``; ``unit``: SI unit of the value."""
    from lightflyer.core.units import number_or_text, parse

    try:
        found = parse(text if unit else number_or_text(text), unit, _USUAL.get(option, ""))
    except ConfigurationError as error:
        raise ConfigurationError(f"{option}: {error}") from None
    if unit in _IMPOSSIBLE and (found.value < 0.0 or (unit == "m" and found.value == 0.0)):
        raise ConfigurationError(f'{option}: "{text}" is {_IMPOSSIBLE[unit]}')
    if unit == "K":
        from lightflyer.core.quantity import Quantity, Temperature, quantity_of

        (quantity_of(Temperature) or Quantity()).check(option, found.value)
    return found


def known(option: str, text: str, unit: str) -> "Measured":
    """The same of an option whose value must exceed its ±."""
    found = quantity(option, text, unit)
    if (found.uncertainty or 0.0) >= found.value:
        raise ConfigurationError(f'{option} "{text}" is not known by its ±')
    return found


def exact(option: str, text: str, unit: str) -> float:
    """Value of an option that has no use for a ±, in SI units."""
    value, spread = quantity(option, text, unit)
    if spread is not None:
        raise ConfigurationError(f'{option} "{text}": takes no ±')
    return value


def quantities(option: str, text: str, unit: str) -> "np.ndarray":
    """Values of an option such as ``--at "550 nm, 10 um"``, at least one; ``unit``: SI unit."""
    import numpy as np

    values = [exact(option, part, unit) for part in text.split(",") if part.strip()]
    if not values:
        raise ConfigurationError(f'{option} "{text}" has no quantity in it')
    return np.array(values)


def difference(option: str, text: str, unit: str) -> float:
    """Value of an option that is a difference, for which 1 °C is 1 K."""
    from lightflyer.core.units import parse, scale_and_offset

    written = text.lstrip("+-.0123456789eE ")
    try:
        value = parse(text, unit).value - scale_and_offset(written, unit)[1]
    except ConfigurationError as error:
        raise ConfigurationError(f"{option}: {error}") from None
    if value < 0.0:
        raise ConfigurationError(f'{option}: "{text}" is negative')
    return value


def share(option: str, text: str) -> float:
    """Value of an option that is a share, such as ``--gauge-accuracy "5 %"`` [1]."""
    from lightflyer.core.checks import require_range

    value = exact(option, text, "")
    if value >= 1.0 and "accuracy" in option and "%" not in text:
        raise ConfigurationError(f'{option} "{text}": per cent are written "{text} %"')
    require_range(option, value, 0.0, 1.0)
    return value


def optional_share(option: str, text: str | None) -> float | None:
    """The same of an option without a default, None where it is not given [1]."""
    return None if text is None else share(option, text)


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
    show(console, parts)
    written = [] if out is None else [out / file for file in names]
    figures.tell(console, written, "add --out FOLDER to write a record and a figure")
    show(console, updated)


def updater(
    flyer: Path | None,
    values: "Mapping[tuple[str, str], Estimate]",
    name: str,
    files: Sequence[Path],
    *,
    insist: bool,
    digits: int = 2,
) -> Callable[[], list[str]]:
    """Function that writes values into a flyer file, if one is named; see :func:`deliver`.

    ``digits``: of the standard uncertainties.
    """

    def update() -> list[str]:
        if flyer is None:
            return []
        from lightflyer.config.update import update_flyer_file

        origin = ", ".join([f"lab {name}", *(file.name for file in files)])
        changes = update_flyer_file(flyer, values, origin, insist=insist, digits=digits)
        return [f"{flyer}: {text}" for text in changes]

    return update
