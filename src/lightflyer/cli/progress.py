"""What a terminal shows while a command works.

On a terminal there is a line that moves, from the second second on. Elsewhere there is a line now
and then. Both go to the standard error stream and end before results are printed.
"""

import os
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, TextIO

from lightflyer.cli.output import BEFORE_RESULTS
from lightflyer.core.progress import Step, report_to
from lightflyer.files.result_text import wrap_all

if TYPE_CHECKING:
    from rich.progress import Progress

SWITCH = "LIGHTFLYER_PROGRESS"  # Environment variable; ``off`` shows nothing

_QUIET = 1.0  # seconds before a terminal shows anything
_FIRST, _EVERY = 10.0, 30.0  # seconds between lines where there is no terminal


class Display:
    """Shows the steps that are reported, and for how long the command has worked."""

    def __init__(self, command: str) -> None:
        self._step = Step(command)
        self._since = time.monotonic()
        self._over = threading.Event()
        self._lock = threading.Lock()
        self._bar: Progress | None = None
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        """Begin to watch the time; nothing is shown yet."""
        if os.environ.get(SWITCH, "").lower() in ("off", "0", "no"):
            return
        show = self._move if sys.stderr.isatty() else self._tell
        self._thread = threading.Thread(target=show, daemon=True)
        self._thread.start()

    def __call__(self, step: Step) -> None:
        """Take a step that is reported."""
        with self._lock:
            another = step.doing != self._step.doing
            self._step = step
            if self._bar is not None:
                self._update(self._bar, another=another)

    def stop(self) -> None:
        """Clear the line, before something is printed."""
        self._over.set()
        with self._lock:
            if self._bar is not None:
                self._bar.stop()
                self._bar = None

    def note(self, text: str) -> None:
        """Print a line to the standard error stream, above what moves."""
        with self._lock:
            if self._bar is not None:
                self._bar.console.print(wrap_all(text), soft_wrap=True)
                return
        print_error(text)

    def _move(self) -> None:
        if self._over.wait(_QUIET):
            return
        from lightflyer.cli.progress_bar import new_bar  # Rich is not needed for a quick command

        bar = new_bar()
        with self._lock:
            if self._over.is_set():
                return
            self._bar = bar
            self._update(bar, another=True)
            bar.start()

    def _update(self, bar: "Progress", *, another: bool) -> None:
        step = self._step
        if another:
            for number in bar.task_ids:
                bar.remove_task(number)
            number = bar.add_task(
                step.doing, total=step.total, completed=step.done or 0, unit=step.unit
            )
            bar.tasks[bar.task_ids.index(number)].start_time = self._since  # of the whole command
        else:
            bar.update(bar.task_ids[-1], total=step.total, completed=step.done or 0)

    def _tell(self) -> None:
        pause = _FIRST
        while not self._over.wait(pause):
            with self._lock:  # no line begins once results may be printed
                if not self._over.is_set():
                    step, seconds = self._step, time.monotonic() - self._since
                    count = f" {step.done or 0:,} of {step.total or 0:,} {step.unit}".rstrip()
                    of = "" if step.total is None else count
                    print_error(f"lightflyer: {step.doing}{of}, {seconds:.0f} s")
            pause = _EVERY


@contextmanager
def show_progress(command: str) -> Iterator[Display]:
    """Show the progress of what is done within the block; ``command``: its name."""
    display = Display(command)
    BEFORE_RESULTS.append(display.stop)
    try:
        with report_to(display):
            display.start()
            yield display
    finally:
        display.stop()
        BEFORE_RESULTS.remove(display.stop)


def print_error(text: str) -> None:
    """Print a line to the standard error stream; nothing where that is full."""
    try:
        print(wrap_all(text), file=sys.stderr)  # noqa: T201
    except OSError:
        abandon(sys.stderr)


def abandon(stream: TextIO) -> None:
    """Let Python end without trying to write again what could not be written."""
    with suppress(OSError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
