"""``lightflyer lab summary``: the numbers of many records in one table."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from lightflyer.cli.lab.shared import Files
from lightflyer.cli.options import Json
from lightflyer.cli.output import print_json, printer

if TYPE_CHECKING:
    from lightflyer.lab.collection import Entry


def summary_command(
    folders: Files,
    /,
    *,
    quantity: str | None = None,
    out: Path | None = None,
    json_output: Json = False,
) -> None:
    """Collect the numbers of records that other commands wrote with --out.

    Parameters
    ----------
    folders
        Folders of records, and of folders of them.
    quantity
        Only quantities whose name contains this, such as "tac".
    out
        Table to write, such as runs.csv.
    json_output
        Print one JSON object instead of a table.
    """
    from lightflyer.core.atomic_files import output_directory
    from lightflyer.core.errors import ConfigurationError
    from lightflyer.files.result_text import table_of
    from lightflyer.lab.collection import collect_records, table_text

    entries = collect_records(folders)
    names = sorted({one.quantity for one in entries})
    entries = [one for one in entries if (quantity or "") in one.quantity]
    if not entries:
        raise ConfigurationError(f"no quantity contains {quantity}; found: {'; '.join(names)}")
    if out is not None and out.is_dir():
        raise ConfigurationError(f"{out}: is a folder; name a table, such as {out / 'runs.csv'}")
    if out is not None:
        with output_directory(out.parent, shared=True) as stage:
            stage(out.name).write_text(table_text(entries), encoding="utf-8")
    if json_output:
        print_json({"records": [_plain(one) for one in entries]})
        return
    headings = ("folder", "command", "quantity", "value", "95 % interval", "unit", "warnings")
    rows = (
        (
            one.folder, one.command, one.quantity, f"{one.estimate.value:.4g}",
            one.estimate.interval_text(), one.estimate.unit or "1", str(one.warnings),
        )
        for one in entries
    )  # fmt: skip
    console = printer()
    console.print(table_of(headings, rows, left=(0, 1, 2, 4, 5)))
    if out is not None:
        console.print(f"wrote {out}", markup=False, soft_wrap=True)


def _plain(one: "Entry") -> dict[str, Any]:
    about = {"folder": one.folder, "command": one.command, "quantity": one.quantity}
    return about | one.estimate.to_json() | {"warnings": one.warnings}
