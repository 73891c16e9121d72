"""Text in and out: a user's file with one line for each way it can fail, numbers in words."""

import os
import stat
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import numpy as np

from lightflyer.core.errors import ConfigurationError

_LEAST_CORRELATION, _MOST_CORRELATIONS = 0.1, 8  # that are listed

_LARGEST_PIPE = 2**28  # bytes
_FORMULA = ("=", "+", "-", "@", "\t", "\r")  # what one begins with

_noted: ContextVar[list[Path] | None] = ContextVar("files read", default=None)


@contextmanager
def files_read() -> Iterator[list[Path]]:
    """Note the files that :func:`read_text` reads within the block; grows as files are read."""
    files: list[Path] = []
    token = _noted.set(files)
    try:
        yield files
    finally:
        _noted.reset(token)


def read_content(path: Path) -> bytes:
    """Content of a file, or of a pipe; ConfigurationError where there is none or no end of it."""
    try:
        with path.open("rb") as file:
            mode = os.fstat(file.fileno()).st_mode
            if stat.S_ISBLK(mode) or (stat.S_ISCHR(mode) and not file.isatty()):
                raise ConfigurationError(f"{path}: cannot be read: is a device")
            if stat.S_ISREG(mode):
                return file.read()
            content = file.read(_LARGEST_PIPE + 1)
    except OSError as error:
        raise ConfigurationError(f"{path}: cannot be read: {error.strerror}") from None
    if len(content) > _LARGEST_PIPE:
        raise ConfigurationError(f"{path}: cannot be read: has no end")
    return content


def read_text(path: Path) -> str:
    """Text of a UTF-8 file, with or without a byte-order mark."""
    content = read_content(path)
    try:
        text = content.decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
    except UnicodeDecodeError as error:
        line = 1 + error.object[: error.start].count(b"\n")
        raise ConfigurationError(f"{path}:{line}: is not text in UTF-8; save it so") from None
    noted = _noted.get()
    if noted is not None:
        noted.append(path)
    return text


def shortened(text: str, most: int = 80) -> str:
    """A text for a message, without the end that nobody reads."""
    return text if len(text) <= most else f"{text[:most]}…"


def cell_text(text: str) -> str:
    """A text for a table of commas; an apostrophe before what a spreadsheet takes for a formula."""
    return f"'{text}" if text.startswith(_FORMULA) else text


def in_toml(value: Any) -> str:
    """A value as a TOML file writes it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{key} = {in_toml(entry)}' for key, entry in value.items())} }}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(in_toml, value))}]"
    return str(value)


def span(values: Any) -> str:
    """A number, or the range of an array, to four digits."""
    low, high = np.min(values), np.max(values)
    return f"{low:.4g}" if low == high else f"{low:.4g} to {high:.4g}"


def rounded(value: float, digits: int = 2) -> str:
    """A number to some digits, without a power of ten where it has less than seven figures."""
    return f"{float(f'{value:.{digits}g}'):g}"


def correlation_text(names: Sequence[str], covariance: np.ndarray) -> str:
    """The larger correlations of fitted numbers, the largest first; ``covariance`` (n, n)."""
    spread = np.sqrt(np.diag(covariance))
    with np.errstate(divide="ignore", invalid="ignore"):
        related = covariance / np.outer(spread, spread)
    every = [(i, j) for i in range(len(names)) for j in range(i)]
    pairs = sorted(every, key=lambda pair: -abs(related[pair]))
    shown = [
        f"{names[j]} and {names[i]} {related[i, j]:+.2f}"
        for i, j in pairs[:_MOST_CORRELATIONS]
        if abs(related[i, j]) >= _LEAST_CORRELATION
    ]
    return f"correlations: {', '.join(shown) or f'none above {_LEAST_CORRELATION:g}'}"
