"""What a measurement is: a function of files and options, and the outcome that it returns.

Its command, its help, what it prints and writes, and its place in ``lightflyer lab summary`` follow
from the function's annotated parameters, its docstring and the outcome
(:mod:`lightflyer.cli.lab`).
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lightflyer.files.result_text import Parts
from lightflyer.files.table import Table
from lightflyer.files.table_rows import Rejected
from lightflyer.lab.estimate import Estimate, estimate_table
from lightflyer.lab.record import dataset

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_SHOWN_REJECTED = 10


@dataclass(frozen=True)
class Outcome:
    """What a measurement found, as its command prints and writes it."""

    summary: Mapping[str, Any]  # JSON object of the result
    dataset: "xr.Dataset"
    parts: Parts  # Text, the finding first
    _: KW_ONLY
    read: Sequence[Mapping[str, Any]] = ()  # JSON of the files read
    warnings: Sequence[str] = ()
    figures: "Callable[[], Mapping[str, Figure]]" = dict
    tables: Mapping[str, str | bytes] = field(default_factory=dict)  # further files, by name
    # Numbers for a flyer file, by section and key, and digits of their ±
    values: Mapping[tuple[str, str], Estimate] = field(default_factory=dict)
    digits: int = 2
    # Where they come from, by default the command's name, and the files given
    origin: str = ""
    sources: Sequence[Path] = ()
    # In place of that: writes into a flyer file, insisting or not, and tells what
    write: Callable[[Path, bool], Sequence[str]] | None = None

    @classmethod
    def of(
        cls, title: str, estimates: Mapping[str, Estimate], tables: Sequence[Table],
        variables: Mapping[str, Any], **others: Any,
    ) -> "Outcome":  # fmt: skip
        """The outcome of a few numbers by name, from tables; ``variables``: of the dataset."""
        words = {name: name.replace("_", " ") for name in estimates}
        return cls(
            {name: one.to_json() for name, one in estimates.items()},
            dataset(title, variables, [one.source for one in tables],
                    warnings=others.get("warnings", ())),
            [*(f"{words[name]} {one}" for name, one in list(estimates.items())[:1]),
             *read_parts(tables),
             estimate_table((words[name], one) for name, one in estimates.items())],
            read=read_summary(tables), **others,
        )  # fmt: skip


@dataclass(frozen=True)
class Listing:
    """What an option such as ``--list-channels`` asks for in place of an outcome."""

    document: dict[str, Any]
    lines: Sequence[str]


def figures_by(figures: str, *results: Any, **options: Any) -> "Callable[[], Mapping[str, Figure]]":
    """Function that draws results by ``"module:function"``, which is imported when it is called."""
    module, _, name = figures.partition(":")
    return lambda: getattr(import_module(f"lightflyer.lab.{module}"), name)(*results, **options)


def read_summary(tables: Sequence[Table]) -> list[dict[str, Any]]:
    """JSON list of the tables read, their rows, and the rejected rows with reasons."""
    return [
        {
            "file": table.source,
            "rows": len(table),
            "rejected": rejected_json(table.rejected),
            "columns_not_used": table.unused,
            "notes": table.notes,
        }
        for table in tables
    ]


def rejected_json(rejected: Sequence[Rejected]) -> list[dict[str, Any]]:
    """Rejected rows as JSON."""
    return [{"line": row.line, "reason": row.reason} for row in rejected]


def read_parts(tables: Sequence[Table]) -> Iterator[str]:
    """The tables read, and their rejected rows."""
    for table in tables:
        unused = f"; not used: {', '.join(table.unused)}" if table.unused else ""
        yield f"read {len(table)} row{'s' * (len(table) != 1)} of {table.source}{unused}"
        yield from rejected_parts(table.rejected)
        yield from (f"  note: {note}" for note in table.notes)


def rejected_parts(rejected: Sequence[Rejected]) -> Iterator[str]:
    """Rejected rows, only the first of very many."""
    yield from (f"  rejected {row}" for row in rejected[:_SHOWN_REJECTED])
    if len(rejected) > _SHOWN_REJECTED:
        yield f"  and {len(rejected) - _SHOWN_REJECTED} more rows, listed in the JSON record"
