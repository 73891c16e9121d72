"""Writing a measured value into a flyer file, which keeps its comments."""

import datetime
import math
import os
import re
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from lightflyer.config.reader import read_flyer_file
from lightflyer.foundation.errors import ConfigurationError, OutputError
from lightflyer.foundation.extras import extra
from lightflyer.foundation.text import read_text
from lightflyer.lab.estimate import Estimate

Face = Literal["top", "bottom", "both"]
"""Which faces of a film a value is for."""

_ORIGIN = re.compile(r"\s*(?:[;#]\s*)?measured: .*$")
_DIGITS = 2  # of an uncertainty
_FACES = {"top": ("top",), "bottom": ("bottom",), "both": ("top", "bottom")}


def measured_text(estimate: Estimate) -> str:
    """An estimate as flyer files write it.

    Parameters
    ----------
    estimate : Estimate
        With a standard uncertainty.

    Returns
    -------
    str
        Such as ``"0.903 ± 0.031"``, rounded to two digits of the uncertainty.

    Examples
    --------
    >>> measured_text(Estimate.normal(0.90312, 0.0313))
    '0.903 ± 0.031'
    """
    spread = estimate.uncertainty or 0.0
    if not spread > 0.0:
        return f"{estimate.value:.10g} {estimate.unit}".rstrip()
    digits = max(0, _DIGITS - 1 - math.floor(math.log10(spread)))
    text = f"{estimate.value:.{digits}f} ± {spread:.{digits}f}"
    return f"{text} {estimate.unit}".rstrip()


def update_flyer_file(
    path: str | Path, values: Mapping[tuple[str, str], Estimate], origin: str
) -> list[str]:
    """Write values with their ± into a flyer file, and where they come from beside them.

    Parameters
    ----------
    path : str or path
    values : mapping of (str, str) to Estimate
        By section and key. ``emittance_top`` and ``emittance_bottom`` take the place of
        ``emittance``, and the other way round.
    origin : str
        What was measured; stands in a comment behind each value, after the comment that was
        there and in place of an earlier origin.

    Returns
    -------
    list of str
        What was written, one text a key.

    Raises
    ------
    ConfigurationError
        If the file is no flyer file, or would not be one with these values; it is left as it is.
    OutputError
        If it cannot be written.
    """
    path = Path(path)
    read_flyer_file(path)  # the user's own mistakes are named with their lines
    tomlkit = extra("tomlkit", "updating a flyer file", "lab")
    document = tomlkit.parse(read_text(path))
    written = []
    for (section, key), estimate in values.items():
        if section not in document:
            document.add(section, tomlkit.table())
        table = document[section]
        if section == "film":
            _make_room(table, key)
        text = measured_text(estimate)
        _put(table, key, text, f"measured: {origin}, {datetime.date.today().isoformat()}")
        written.append(f'{section}.{key} = "{text}"')
    _replace(path, tomlkit.dumps(document))
    return written


def emittance_keys(face: Face) -> list[tuple[str, str]]:
    """Keys of a film's emittance: of one face, or one key for both.

    Parameters
    ----------
    face : {"top", "bottom", "both"}

    Returns
    -------
    list of (str, str)
        Sections and keys.
    """
    return [("film", "emittance" if face == "both" else f"emittance_{face}")]


def tac_keys(face: Face) -> list[tuple[str, str]]:
    """Keys of a film's accommodation coefficients.

    Parameters
    ----------
    face : {"top", "bottom", "both"}

    Returns
    -------
    list of (str, str)
        Sections and keys.
    """
    return [("film", f"tac_{side}") for side in _FACES[face]]


def _make_room(film: Any, key: str) -> None:
    """Take away what a key of the emittance would contradict, keeping what it said of a face."""
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
        table[key].comment(comment)
        table[key].trivia.comment_ws = "  "


def _own_comment(item: Any) -> str:
    """The comment behind a value, without an origin written there before."""
    return str(_ORIGIN.sub("", item.trivia.comment).lstrip("# ").rstrip())


def _put(table: Any, key: str, text: str, origin: str) -> None:
    kept = _own_comment(table[key]) if key in table else ""
    table[key] = text
    table[key].comment(f"{kept}; {origin}" if kept else origin)
    table[key].trivia.comment_ws = "  "


def _replace(path: Path, text: str) -> None:
    """Write the file if the text is a flyer file; names of other files in it stay relative."""
    try:
        handle, name = tempfile.mkstemp(prefix=".lightflyer-", suffix=".toml", dir=path.parent)
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror}") from None
    staged = Path(name)
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        try:
            read_flyer_file(staged)
        except ConfigurationError as error:
            said = str(error).replace(str(staged), str(path))
            raise ConfigurationError(f"{said}; the file is left as it was") from None
        staged.chmod(path.stat().st_mode)
        os.replace(staged, path)
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror}") from None
    finally:
        staged.unlink(missing_ok=True)
