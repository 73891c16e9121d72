"""Formats of raw files: how each is recognised, and what reads it."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.extras import load_plugins
from lightflyer.core.text import read_content


class Source(NamedTuple):
    """A file with its content."""

    path: Path
    content: bytes

    @property
    def text(self) -> str:
        """The content as text."""
        # Unicode marked by a byte-order mark, UTF-8, Shift-JIS as JASCO writes it, else cp1252.
        if self.content.startswith((b"\xff\xfe", b"\xfe\xff")):
            return self.content.decode("utf-16", "replace")
        for encoding in ("utf-8-sig", "cp932"):
            try:
                return self.content.decode(encoding)
            except UnicodeDecodeError:
                continue
        return self.content.decode("cp1252", "replace")

    @property
    def suffix(self) -> str:
        """End of the file's name in small letters, such as ``".csv"``."""
        return self.path.suffix.lower()

    def refuse(self, why: str, line: int | None = None) -> NoReturn:
        """Raise :class:`ConfigurationError`; ``why``: what is wrong; ``line``: counted from 1."""
        place = f"{self.path}" if line is None else f"{self.path}:{line}"
        raise ConfigurationError(f"{place}: {one_line(why)}")


class Format(NamedTuple):
    """A format of spectra, height maps or thermal images."""

    name: str  #: Such as ``"JASCO text"``
    recognises: Callable[[Source], bool]  #: Whether a :class:`Source` is of this format
    #: What a :class:`Source` holds: a list of :class:`RawSpectrum`, a list of :class:`Channel`, or
    #: a :class:`ThermalImage`
    read: Callable[..., Any]
    #: Options of :func:`read_thermal_image` that ``read`` takes by name
    options: tuple[str, ...] = ()


def has_suffix(*suffixes: str) -> Callable[[Source], bool]:
    """How a format is recognised by the file's name."""
    return lambda source: source.suffix in suffixes


def read_source(path: Path) -> Source:
    """A file with its content; ConfigurationError if it cannot be read."""
    return Source(path, read_content(path))


def find_format(source: Source, formats: Sequence[Format]) -> Format | None:
    """The first format that knows a file; a plug-in puts its own before or behind the others."""
    load_plugins()
    return next((one for one in formats if one.recognises(source)), None)


def reason(error: Exception) -> str:
    """What another package's reader says of a damaged file."""
    return f"it is damaged: {one_line(str(error)) or type(error).__name__}"


def one_line(text: str) -> str:
    """Words with single spaces and without characters that cannot be printed."""
    return " ".join("".join(one if one.isprintable() else " " for one in text).split())
