"""The line that moves on a terminal while a command works."""

from typing import Any

from rich.columns import Columns
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    SpinnerColumn,
    Task,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.text import Text

from lightflyer.cli.output import in_words, printer


class _Counted(ProgressColumn):
    """Bar, count, rate and time left, where the work is counted."""

    def __init__(self) -> None:
        super().__init__()
        self._parts = (BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())

    def render(self, task: Task) -> Any:
        if task.total is None:
            return Text("")
        speed, unit = task.finished_speed or task.speed, task.fields.get("unit", "")
        rate = [Text(f"{in_words(speed)} {unit}/s")] if speed and unit else []
        return Columns([*(part(task) for part in self._parts), *rate])


def new_bar() -> Progress:
    """A bar that has not begun, on the standard error stream."""
    return Progress(
        SpinnerColumn(),
        TextColumn("{task.description}"),
        _Counted(),
        TimeElapsedColumn(),
        console=printer(stderr=True),
        transient=True,
    )
