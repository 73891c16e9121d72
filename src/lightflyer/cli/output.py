"""Where commands print: plain text, whatever is in it, and large numbers as people say them."""

import json
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from lightflyer.files.result_text import UNBOUNDED, Parts, width_of, wrap_all

_SCALE = 1000.0
_WORDS = ("", "thousand", "million", "billion", "trillion")
_PREFIXES = ("", "k", "M", "G", "T", "P")
_SECONDS = (("years", 31557600.0), ("days", 86400.0), ("hours", 3600.0), ("minutes", 60.0))


def _in_steps(number: float, names: tuple[str, ...]) -> str:
    power = 0
    while number >= _SCALE and power < len(names) - 1:
        number, power = number / _SCALE, power + 1
    return f"{number:.3g} {names[power]}"


def in_words(number: float) -> str:
    """A large number in words, to three digits, such as "2.5 million"."""
    return _in_steps(number, _WORDS).rstrip()


def with_prefix(number: float, unit: str) -> str:
    """A large amount to three digits with a decimal prefix before its unit, such as "5.2 GB"."""
    return _in_steps(number, _PREFIXES) + unit


def duration(seconds: float) -> str:
    """A time in the largest unit of which there are two, such as "2 hours"."""
    for name, length in _SECONDS:
        if seconds >= 2.0 * length:
            return f"{seconds / length:.0f} {name}"
    return f"{seconds:.0f} seconds"


BEFORE_RESULTS: list[Callable[[], None]] = []
"""What is called before anything is printed to the standard output stream."""

AFTER_PRINT: list[Callable[[object], None]] = []
"""What is called with every result that is printed there."""


def _clear() -> None:
    for call in BEFORE_RESULTS:
        call()


class _Printed(Console):
    """The standard output stream, before which progress is cleared away."""

    # A table that is wider than the terminal keeps its digits: the terminal breaks its lines.

    def print(self, *objects: Any, **settings: Any) -> None:
        _clear()
        shown = (wrap_all(one) if isinstance(one, str) else one for one in objects)
        tables = (part for part in objects if isinstance(part, Table))
        wanted = max((width_of(table).maximum for table in tables), default=0)
        if wanted > self.width:
            settings |= {"width": wanted, "crop": False}
        super().print(*shown, **settings)
        for part in objects:
            for call in AFTER_PRINT:
                call(part)


def printer(*, stderr: bool = False) -> Console:
    """Console that shows texts as they are; ``stderr``: print to the standard error stream."""
    # Names of files and of quantities may contain brackets, which Rich would take for markup, and
    # colons, which it would take for emoji.
    kind = Console if stderr else _Printed
    console = kind(stderr=stderr, markup=False, emoji=False, highlight=False)
    if not console.is_terminal and "COLUMNS" not in os.environ:
        console.width = UNBOUNDED
    return console


def show(console: Console, parts: Parts) -> None:
    """Print the lines and tables of a result."""
    for part in parts:
        console.print(part, soft_wrap=isinstance(part, str))


def say(console: Console, text: str) -> None:
    """Print a line that is not a result: about files that were written, for one."""
    _clear()
    Console.print(console, wrap_all(text), soft_wrap=True)


def print_json(document: dict[str, Any]) -> None:
    """Print one JSON object on one line."""
    _clear()
    for call in AFTER_PRINT:
        call(json.dumps(document, indent=2, allow_nan=False, ensure_ascii=False))
    readable = (sys.stdout.encoding or "").lower().startswith("utf")  # else escapes lose nothing
    print(json.dumps(document, allow_nan=False, ensure_ascii=not readable))  # noqa: T201


def write_json(path: Path, document: Any) -> None:
    """Write a JSON file that people can read."""
    text = json.dumps(document, indent=2, allow_nan=False, ensure_ascii=False)
    path.write_text(text + "\n", encoding="utf-8")
