"""Writing values into a flyer file without losing its comments."""

import datetime
import math
import os
import re
import tempfile
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, NamedTuple, Protocol

from lightflyer.core.atomic_files import TEMPORARY, remove_if_interrupted
from lightflyer.core.errors import ConfigurationError, Doubt, OutputError
from lightflyer.core.text import read_text
from lightflyer.core.units import rewrite

Face = Literal["top", "bottom", "both"]  # Faces of a film that a value applies to

_ORIGIN = re.compile(r"\s*(?:[;#]\s*)?(?:measured|optimised): .*$")
_DIGITS = 2  # of an uncertainty
_WRITTEN = "# Written by"
_NEW_FILE = 0o666
_FACES = {"top": ("top",), "bottom": ("bottom",), "both": ("top", "bottom")}


class UncertainNumber(Protocol):
    """A number with a standard uncertainty, such as an estimate of the lab bench."""

    @property
    def value(self) -> float:
        """In the unit."""

    @property
    def unit(self) -> str:
        """As files write it; empty for a pure number."""

    @property
    def uncertainty(self) -> float | None:
        """Standard uncertainty; None where there is none."""


class Fitted(NamedTuple):
    """A number that was fitted."""

    value: float
    uncertainty: float | None = None
    unit: str = ""


def require_no_doubt(path: Path, warnings: Sequence[str], *, insist: bool) -> None:
    """Refuse to write into a flyer file what is in doubt, unless the user insists."""
    for text in () if insist else warnings:
        if isinstance(text, Doubt):
            raise ConfigurationError(
                f"{text}; --insist writes it all the same; {path} is unchanged"
            )


def measured_text(estimate: UncertainNumber, digits: int = _DIGITS) -> str:
    """Text of an estimate for a flyer file; ``estimate``: with a standard uncertainty."""
    spread = estimate.uncertainty or 0.0
    if not spread > 0.0:
        return f"{estimate.value:.10g} {estimate.unit}".rstrip()
    digits = max(0, digits - 1 - math.floor(math.log10(spread)))
    text = f"{estimate.value:.{digits}f} ± {spread:.{digits}f}"
    return f"{text} {estimate.unit}".rstrip()


def update_flyer_file(
    path: str | Path,
    values: Mapping[tuple[str, str], UncertainNumber],
    origin: str,
    *,
    insist: bool = False,
    digits: int = _DIGITS,
) -> list[str]:
    """Write values with ± and origin.

    ``insist``: also what :func:`_require_likely` refuses; ``digits``: of the uncertainties.
    """
    import tomlkit

    from lightflyer.config.reader import read_flyer_file  # slow to import

    path = Path(path)
    read_flyer_file(path)  # names existing mistakes with their lines
    document = tomlkit.parse(read_text(path))
    written = []
    for (section, key), estimate in values.items():
        if section == "film" and section not in document:
            raise ConfigurationError(
                f"{path}: has no section [film] to write {key} into; the file is unchanged"
            )
        if section not in document:
            document.add(section, tomlkit.table())
        table = document[section]
        if section == "film":
            _make_room(table, key)
        text = measured_text(estimate, digits)
        exact = estimate.uncertainty is None and not estimate.unit
        kept = _own_comment(table[key]) if key in table else ""
        table[key] = float(text) if exact else text
        _comment(table[key], kept, f"measured: {origin}, {datetime.date.today().isoformat()}")
        written.append(f"{section}.{key} = {text}" if exact else f'{section}.{key} = "{text}"')
    replace_file(
        path, tomlkit.dumps(document), () if insist else [".".join(name) for name in values]
    )
    return written


def write_design(
    path: str | Path, text: str, values: Mapping[str, tuple[float, str]], origin: str
) -> None:
    """Write a flyer file with other numbers, each in the unit that it had before."""
    import tomlkit

    path = Path(path)
    require_free(path)
    earlier = text.partition("\n")[0] + "\n" if text.startswith(_WRITTEN) else ""  # of a search
    document = tomlkit.parse(text.removeprefix(earlier))
    for name, (value, unit) in values.items():
        *sections, key = name.split(".")
        table: Any = document
        for section in sections:
            if section.isdigit():
                table = table[int(section)]
                continue
            if section not in table:
                table.add(section, tomlkit.table())
            table = table[section]

        if name.startswith("film."):
            _make_room(table, key)
        before = table.get(key, "")
        kept = _own_comment(table[key]) if key in table and not _in_line(table) else ""
        text = rewrite(str(before), value, unit)
        table[key] = text if unit or (isinstance(before, str) and before) else float(text)
        if not _in_line(table):
            _comment(table[key], kept, f"optimised: {origin}")
    replace_file(path, f"{_WRITTEN} {origin}\n{tomlkit.dumps(document)}")


def require_free(path: Path) -> None:
    """Raise where :func:`write_design` cannot write, or would overwrite what people wrote."""
    if not path.parent.is_dir():
        raise OutputError(f"{path}: cannot be written: there is no folder {path.parent}")
    if path.exists() and not (path.is_file() and read_text(path).startswith(_WRITTEN)):
        raise OutputError(f"{path}: already exists, and no search wrote it; choose another name")


def _in_line(table: Any) -> bool:
    """Whether a table is written on one line, which has no room for comments."""
    return type(table).__name__ == "InlineTable"


def emittance_keys(face: Face) -> list[tuple[str, str]]:
    """Keys of a film's emittance: one per face, or one for both; sections and keys."""
    return [("film", "emittance" if face == "both" else f"emittance_{face}")]


def tac_keys(face: Face) -> list[tuple[str, str]]:
    """Keys of a film's accommodation coefficients; sections and keys."""
    return [("film", f"tac_{side}") for side in _FACES[face]]


def _make_room(film: Any, key: str) -> None:
    """Remove emittances that a key replaces, keeping the value and comment of the other face."""
    both, faces = "emittance", ("emittance_top", "emittance_bottom")
    if key == both:
        there = [face for face in faces if face in film]
        said = dict.fromkeys(_own_comment(film[face]) for face in there)
        for face in there:
            del film[face]
        if there and both not in film:
            _add(film, both, "", "; ".join(filter(None, said)))
    elif key in faces and both in film:
        value, comment = film[both].unwrap(), film[both].trivia.comment
        del film[both]
        _add(film, faces[1 - faces.index(key)], value, comment)
        _add(film, key, value, comment)


def _add(table: Any, key: str, value: Any, comment: str) -> None:
    table.add(key, value)
    if comment:
        _comment(table[key], comment)


def _comment(item: Any, *words: str) -> None:
    item.comment("; ".join(filter(None, words)))
    item.trivia.comment_ws = "  "


def _own_comment(item: Any) -> str:
    """The comment after a value, without an earlier origin."""
    return str(_ORIGIN.sub("", item.trivia.comment).lstrip("# ").rstrip())


def replace_file(path: Path, text: str, measured: Collection[str] = ()) -> None:
    """Replace the file if the text is a valid flyer file, with likely measured numbers."""
    # beside the file, so that relative names of other files in it stay valid
    try:
        handle, name = tempfile.mkstemp(prefix=TEMPORARY, suffix=".toml", dir=path.parent)
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror}") from None
    with remove_if_interrupted(Path(name)), os.fdopen(handle, "w", encoding="utf-8") as file:
        staged = Path(name)
        from lightflyer.config.reader import read_flyer_file

        try:
            with file:
                file.write(text)
            try:
                _require_likely(read_flyer_file(staged), measured)
            except ConfigurationError as error:
                said = "; ".join(str(error).replace(str(staged), str(path)).splitlines())
                left = "the file is unchanged" if path.exists() else "nothing is written"
                raise ConfigurationError(f"{said}; {left}") from None
            staged.chmod(_mode_of(path))
            os.replace(staged, path)
        except OSError as error:
            raise OutputError(f"{path}: cannot be written: {error.strerror}") from None
        finally:
            staged.unlink(missing_ok=True)


def _require_likely(file: Any, measured: Collection[str]) -> None:
    """Refuse measured numbers that are most likely of a wrong unit, or hardly measured."""
    for part, section in file.parts().items():
        for key, quantity, value in section.numbers():
            name = f"{part}.{key}"
            if name not in measured or value is None:
                continue
            problem = quantity.unlikely(value.value)
            if problem is None and (value.uncertainty or 0.0) >= abs(value.value):
                problem = f"{value.value:.3g} ± {value.uncertainty:.3g} is not determined"
            if problem:
                raise ConfigurationError(f"{name} = {problem}; --insist writes it all the same")


def _mode_of(path: Path) -> int:
    """Permissions of a file, or those that a new one gets."""
    if path.exists():
        return path.stat().st_mode
    mask = os.umask(0)
    os.umask(mask)
    return _NEW_FILE & ~mask
