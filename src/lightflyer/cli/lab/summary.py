"""``lightflyer lab summary``: the numbers of many records in one table."""

import math
from pathlib import Path
from typing import Any

from lightflyer.cli.lab.measure import Files
from lightflyer.cli.options import Json
from lightflyer.cli.output import print_json, printer

_MOST_LINES = 30  # unless --quantity asks for more


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
        Quantities whose name contains this, such as "tac"; "" for all. Default: what each
        measurement was made for.
    out
        Table to write, such as runs.csv.
    json_output
        Print one JSON object instead of a table.
    """
    from lightflyer.core.atomic_files import output_directory
    from lightflyer.core.errors import ConfigurationError
    from lightflyer.files.result_text import table_of
    from lightflyer.lab.collection import collect_records, table_text
    from lightflyer.lab.optics.fit import in_display_unit

    def interval(one: Any) -> str:
        low, high = one.interval
        if math.isinf(low) and math.isinf(high):
            return "unknown"
        return one.interval_text() if math.isfinite(low) else f"below {high:.4g}"

    entries = collect_records(folders)
    names = sorted({one.quantity for one in entries})
    found = len(entries)
    entries = [
        one
        for one in entries
        if (one.is_headline or out is not None or json_output if quantity is None
            else quantity in one.quantity or quantity in one.name)
    ]  # fmt: skip
    if not entries:
        raise ConfigurationError(f"no quantity contains {quantity}; found: {'; '.join(names)}")
    if out is not None and out.is_dir():
        raise ConfigurationError(f"{out}: is a folder; name a table, such as {out / 'runs.csv'}")
    if out is not None:
        with output_directory(out.parent, shared=True) as stage:
            stage(out.name).write_text(table_text(entries), encoding="utf-8")
    if json_output:
        print_json({"records": [
            {"folder": one.folder, "command": one.command, "quantity": one.quantity}
            | one.estimate.to_json()
            | {"warnings": one.warnings}
            for one in entries
        ]})  # fmt: skip
        return
    shown = entries if quantity is not None else entries[:_MOST_LINES]
    headings = ("folder", "command", "quantity", "value", "95 % interval", "unit", "warnings")
    rows = (
        (
            one.folder, one.command, one.name, f"{number.value:.4g}",
            interval(number), number.unit or "1", str(one.warnings),
        )
        for one, number in ((one, in_display_unit(one.estimate)) for one in shown)
    )  # fmt: skip
    console = printer()
    console.print(table_of(headings, rows, left=(0, 1, 2, 4, 5)))
    if len(shown) < found and quantity is None:
        console.print(f'and {found - len(shown)} more numbers, with --quantity ""')
    if out is not None:
        console.print(f"wrote {out}", markup=False, soft_wrap=True)
