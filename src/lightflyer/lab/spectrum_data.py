"""Measured infrared spectra, and their files: tables and JCAMP-DX."""

import contextlib
import io
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.extras import extra
from lightflyer.foundation.layout import Column
from lightflyer.foundation.quantity import Length, Quantity
from lightflyer.foundation.table import Rejected, Table, read_table

Ordinate = Literal["transmittance", "reflectance"]
"""Quantity that a spectrum shows."""

PER_CENTIMETRE = 100.0
"""One reciprocal centimetre [1/m]."""

# wider than zero to one for noise, and for detectors that are not quite linear
_SHARE = Quantity("", -0.2, 1.5)
_ABSORBANCE = Quantity("", -1.0, 10.0)
_MOST_POINTS = 20_000_000
_ABSCISSAE = dict.fromkeys(("1/cm", "cm-1", "cm^-1"), PER_CENTIMETRE)
_WAVELENGTHS = {"micrometers": 1e-6, "um": 1e-6, "nanometers": 1e-9, "nm": 1e-9}

COLUMNS = (
    Column(
        "wavenumber", Quantity("m^-1", 0.0, open_below=True), ("wavenumbers", "nu"),
        suggested_unit="cm^-1",
    ),
    Column("wavelength", Length, ("lambda", "wl"), suggested_unit="um"),
    Column("transmittance", _SHARE, ("t", "transmission")),
    Column("reflectance", _SHARE, ("r", "reflection")),
    Column("absorbance", _ABSORBANCE, ("a", "abs")),
)  # fmt: skip
"""Columns of a spectrum: one of the first two, and one of the others."""


@dataclass(frozen=True)
class MeasuredSpectrum:
    """Transmittance or reflectance over wavenumber.

    Attributes
    ----------
    source : str
        Name of the file.
    quantity : {"transmittance", "reflectance"}
    wavenumber : array, shape (n,)
        Increasing [1/m].
    value : array, shape (n,)
        [1].
    rejected : tuple of Rejected
        Rejected rows of its file.
    """

    source: str
    quantity: Ordinate
    wavenumber: np.ndarray
    value: np.ndarray
    rejected: tuple[Rejected, ...] = ()


def read_spectrum(path: str | Path, *, columns: str | None = None) -> MeasuredSpectrum:
    """Read a spectrum.

    Parameters
    ----------
    path : str or path
        JCAMP-DX (``.jdx``, ``.dx``, ``.jcamp``), or a table of ``wavenumber`` or ``wavelength``
        and ``transmittance``, ``reflectance`` or (decadic) ``absorbance``, units in the header.
    columns : str, optional
        The columns of a table without a header, in their order; see
        :func:`~lightflyer.foundation.table.read_table`.

    Returns
    -------
    MeasuredSpectrum

    Raises
    ------
    ConfigurationError
        One line that names file and line.
    MissingExtraError
        If a JCAMP-DX file is read and jcamp is not installed.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix == ".jws":
        raise ConfigurationError(
            f"{path}: JASCO's .jws format is not supported; export JCAMP-DX or text"
        )
    if suffix in (".jdx", ".dx", ".jcamp"):
        return _read_jcamp(path)
    return _from_table(read_table(path, COLUMNS, layout=columns))


def _from_table(table: Table) -> MeasuredSpectrum:
    numbers = table.numbers
    if ("wavenumber" in numbers) == ("wavelength" in numbers):
        raise ConfigurationError(f"{table.source}: needs a column wavenumber or wavelength")
    given = [name for name in ("transmittance", "reflectance", "absorbance") if name in numbers]
    if len(given) != 1:
        raise ConfigurationError(
            f"{table.source}: needs one of the columns transmittance, reflectance, absorbance"
        )
    wavenumber = numbers["wavenumber"] if "wavenumber" in numbers else 1.0 / numbers["wavelength"]
    value = numbers[given[0]]
    quantity: Ordinate = "reflectance" if given[0] == "reflectance" else "transmittance"
    if given[0] == "absorbance":
        value = 10.0**-value
    return _sorted(table.source, quantity, wavenumber, value, tuple(table.rejected))


def _sorted(
    source: str, quantity: Ordinate, wavenumber: np.ndarray, value: np.ndarray,
    rejected: tuple[Rejected, ...] = (),
) -> MeasuredSpectrum:  # fmt: skip
    """The spectrum with increasing wavenumber; values at the same wavenumber are averaged."""
    distinct, place, count = np.unique(wavenumber, return_inverse=True, return_counts=True)
    if distinct.size < 2:
        raise ConfigurationError(
            f"{source}: has {distinct.size} wavenumber; a spectrum needs two or more"
        )
    mean = np.bincount(place, value) / count
    return MeasuredSpectrum(source, quantity, distinct, mean, rejected)


def _read_jcamp(path: Path) -> MeasuredSpectrum:
    jcamp = extra("jcamp", "reading JCAMP-DX", "lab")
    try:
        text = path.read_bytes().decode("utf-8", "replace")
    except OSError as error:
        raise ConfigurationError(f"{path}: cannot be read: {error.strerror}") from None
    lines = _prepared(path, text)
    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said):
            content = jcamp.read(lines)
    except Exception as error:  # the parser has no errors of its own
        raise ConfigurationError(f"{path}: cannot be read as JCAMP-DX: {error!r}") from None
    if said.getvalue():  # failed checksums and counts are only printed
        line = said.getvalue().splitlines()[0]
        raise ConfigurationError(f"{path}: is damaged: {line}")
    block = next(
        (one for one in [content, *content.get("children", [])] if np.size(one.get("x")) > 1), None
    )
    if block is None:
        raise ConfigurationError(f"{path}: contains no spectrum")
    return _from_jcamp(path, block)


def _prepared(path: Path, text: str) -> list[str]:
    """Lines of a JCAMP-DX file that its parser can read, and in finite time."""
    if not re.match(r"\s*(?:\$\$.*\n\s*)*##TITLE", text, re.I):
        raise ConfigurationError(f"{path}:1: is not JCAMP-DX: does not start with ##TITLE=")
    if not re.search(r"^##END\s*=", text, re.I | re.M):
        raise ConfigurationError(f"{path}:{len(text.splitlines())}: ends without ##END=")
    points = re.search(r"^##NPOINTS\s*=\s*(\S+)", text, re.I | re.M)
    if points and not (points[1].isascii() and points[1].isdigit()
                       and int(points[1][:12]) <= _MOST_POINTS):  # fmt: skip
        raise ConfigurationError(f'{path}: ##NPOINTS= "{points[1][:20]}" is not a number of points')
    lines = text.splitlines(keepends=True)
    for number, line in enumerate(lines):
        if re.match(r"##XY(?:DATA|POINTS)\s*=", line, re.I):
            label, _, form = line.partition("=")
            lines[number] = f"{label}={re.sub(r'[$][$].*|[ ]', '', form)}"
        elif not line.startswith("##") and re.search(r"[S-Zs]\d{7}", line):
            raise ConfigurationError(f"{path}:{number + 1}: repeats a value too often")
    return lines


def _said(block: dict[str, Any], label: str) -> str:
    """Content of a label, short enough for a message."""
    return " ".join(str(block.get(label, "")).lower().split())[:40]


def _from_jcamp(path: Path, block: dict[str, Any]) -> MeasuredSpectrum:
    x, y = np.asarray(block["x"], float), np.asarray(block["y"], float)
    if x.shape != y.shape or not np.isfinite(x).all() or not np.isfinite(y).all():
        raise ConfigurationError(f"{path}: is damaged: a point lacks one of its two numbers")
    unit = _said(block, "xunits")
    if unit in _ABSCISSAE:
        wavenumber = x * _ABSCISSAE[unit]
    elif unit in _WAVELENGTHS and np.all(x > 0.0):
        wavenumber = 1.0 / (x * _WAVELENGTHS[unit])
    else:
        raise ConfigurationError(f'{path}: ##XUNITS= "{unit}" is not one of 1/CM, MICROMETERS, NM')
    named = _said(block, "yunits")
    value = y / 100.0 if "%" in named or "percent" in named else y
    quantity: Ordinate = "reflectance" if "reflect" in named else "transmittance"
    if "absorbance" in named:
        value = 10.0 ** -np.clip(value, _ABSORBANCE.lowest, _ABSORBANCE.highest)
    elif "transmi" not in named and quantity != "reflectance":
        raise ConfigurationError(
            f'{path}: ##YUNITS= "{named}" is not TRANSMITTANCE, REFLECTANCE or ABSORBANCE'
        )
    outside = (value < _SHARE.lowest) | (value > _SHARE.highest) | (wavenumber <= 0.0)
    if outside.any():
        first = int(np.argmax(outside))
        at = wavenumber[first] / PER_CENTIMETRE
        raise ConfigurationError(
            f"{path}: {quantity} = {value[first]:g} at {at:g} cm^-1 is not "
            f"{_SHARE.allowed}; is it in %?"
        )
    return _sorted(str(path), quantity, wavenumber, value)
