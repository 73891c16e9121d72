"""Results as text: lines and tables that ``print``, notebooks and the command line share."""

import io
import math
import re
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from rich.measure import Measurement
    from rich.table import Table

NARROW = 80  # Columns of a narrow terminal

Parts: TypeAlias = "Iterable[str | Table]"

UNBOUNDED = 1000  # Columns in which nothing is wrapped

# A command that is to be copied is one word: pip install 'lightflyer[jax]'.
_BETWEEN_WORDS = re.compile(r" (?!install |'lightflyer\[)")


class PrintedResult:
    """A result that prints as a short text with numbers, units and bands."""

    def text_parts(self) -> Parts:
        """Lines and tables of the text."""
        raise NotImplementedError

    def __str__(self) -> str:
        return as_text(self.text_parts())

    def __repr__(self) -> str:
        return str(self)


def as_text(parts: Parts) -> str:
    """Lines and tables as one text, of which no line is wrapped."""
    from rich.console import Console

    file = io.StringIO()
    console = Console(
        file=file, width=UNBOUNDED, markup=False, emoji=False, highlight=False, no_color=True,
        force_terminal=False, force_jupyter=False,
    )  # fmt: skip
    for part in parts:
        console.print(part, soft_wrap=isinstance(part, str))
    return "\n".join(line.rstrip() for line in file.getvalue().splitlines())


def rows_of(texts: dict[str, str]) -> "Table":
    """Table of labelled texts."""
    from rich.table import Table

    rows = Table.grid(padding=(0, 2))
    room = NARROW - 2 - max(map(len, texts), default=0)
    for label, text in texts.items():
        rows.add_row(label, "\n".join(wrap(line, room) for line in text.splitlines()))
    return rows


def table_of(
    headings: Iterable[str],
    rows: Iterable[Iterable[str]] = (),
    left: Iterable[int] = (0,),
    **settings: Any,
) -> "Table":
    """Table without lines, flush right but for ``left``; ``settings``: of :class:`rich.Table`."""
    from rich.table import Table

    table = Table(**{"box": None, "padding": (0, 1), "title_justify": "left"} | settings)
    for place, heading in enumerate(headings):
        table.add_column(heading, justify="left" if place in left else "right")
    for row in rows:
        table.add_row(*row)
    return table


def width_of(table: "Table") -> "Measurement":
    """Width of a table on an unbounded terminal."""
    from rich.console import Console
    from rich.measure import Measurement

    console = Console(width=UNBOUNDED)
    return Measurement.get(console, console.options, table)


def wrap(line: str, width: int = NARROW) -> str:
    """A text in lines that break between words; long words, such as paths, begin no line."""
    first, *words = _BETWEEN_WORDS.split(line.strip())
    lines = [line[: len(line) - len(line.lstrip())] + first]
    for word in words:
        fits = len(lines[-1]) + 1 + len(word) <= width or len(word) > width // 2 >= len(lines[-1])
        lines[-1:] = [f"{lines[-1]} {word}"] if fits else [lines[-1].rstrip(), word]
    return "\n".join(lines)


def wrap_all(text: str) -> str:
    """A text of lines, of which none is wider but for a long word and commands to be copied."""
    return "\n".join(
        line if len(line) <= NARROW or line.startswith("next: ") else wrap(line)
        for line in text.split("\n")
    )


def unwrap(text: str) -> list[str]:
    """Lines of a text, with those whole again that :func:`wrap` broke."""
    lines: list[str] = []
    for line in text.splitlines():
        word = _BETWEEN_WORDS.split(line, maxsplit=1)[0]
        if word and lines and len(lines[-1].rpartition("\n")[2]) + len(word) >= NARROW:
            lines[-1] += f"\n{line}"
        else:
            lines.append(line)
    return [line.replace("\n", " ") for line in lines]


def listed(words: Iterable[str]) -> str:
    """Words as a sentence lists them, such as ``"a, b and c"``."""
    *first, last = [*words] or [""]
    return f"{', '.join(first)} and {last}" if first else last


def warning_lines(warnings: Iterable[str]) -> Iterator[str]:
    """A line for each warning."""
    return (f"warning: {text}" for text in warnings)


def open_interval_text(low: float, high: float) -> str:
    """An interval of a positive number; an end that is zero or infinite is open."""
    if math.isinf(high):
        return f"above {low:.4g}" if low > 0.0 else "unknown"
    return f"{low:.4g} to {high:.4g}" if low > 0.0 else f"below {high:.4g}"
