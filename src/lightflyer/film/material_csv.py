"""Reading tables over wavelength from CSV files, with one clear line for every mistake."""

import csv
import re
from pathlib import Path

import numpy as np

from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.text import read_text

_WAVELENGTH_UNITS = {"nm": 1e-9, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "m": 1.0}

_WAVELENGTH = re.compile(r"^(?:wavelength|lambda|wl)(?:\s*[\[(]\s*(.*?)\s*[\])]|_(\w+))?$", re.I)


def read_index_csv(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Wavelength [m], n and k of a CSV file.

    Parameters
    ----------
    path : Path
        Columns ``wavelength [um], n, k``; the unit may be nm, um (or µm) or m.

    Returns
    -------
    wavelength, n, k : array, shape (m,)

    Raises
    ------
    ConfigurationError
        One line that says what is wrong and where.
    """
    wavelength, columns = _read(path, ("n", "k"))
    n, k = columns
    if np.any(n <= 0.0):
        raise ConfigurationError(f"{path}: n must be positive; it is {n[n <= 0.0][0]:g}")
    if np.any(k < 0.0):
        raise ConfigurationError(f"{path}: k must be zero or positive; it is {k[k < 0.0][0]:g}")
    return wavelength, n, k


def read_spectrum_csv(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Wavelength [m] and spectral irradiance, in any unit per wavelength, of a CSV file.

    Parameters
    ----------
    path : Path
        Columns ``wavelength [nm], irradiance``.

    Returns
    -------
    wavelength, irradiance : array, shape (m,)

    Raises
    ------
    ConfigurationError
        One line that says what is wrong and where.
    """
    wavelength, (irradiance,) = _read(path, ("irradiance",))
    if np.any(irradiance < 0.0) or not np.any(irradiance > 0.0):
        raise ConfigurationError(f"{path}: irradiance must not be negative, nor zero everywhere")
    return wavelength, irradiance


def _read(path: Path, names: tuple[str, ...]) -> tuple[np.ndarray, list[np.ndarray]]:
    text = read_text(path)
    lines = [
        (number, row)
        for number, row in enumerate(csv.reader(text.splitlines()), start=1)
        if any(cell.strip() for cell in row) and not row[0].lstrip().startswith("#")
    ]
    expected = f"wavelength [um],{','.join(names)}"
    if len(lines) < 3:
        raise ConfigurationError(
            f'{path}: needs a line of names, "{expected}", and two or more lines of numbers'
        )
    scale, positions = _columns(path, lines[0], names, expected)
    table = np.array([_numbers(path, line, positions) for line in lines[1:]])
    falling = np.flatnonzero(np.diff(table[:, 0]) <= 0.0)
    if falling.size:
        number = lines[falling[0] + 2][0]
        raise ConfigurationError(f"{path}:{number}: wavelengths must increase from line to line")
    if table[0, 0] <= 0.0:
        raise ConfigurationError(f"{path}:{lines[1][0]}: wavelength must be positive")
    return table[:, 0] * scale, list(table[:, 1:].T)


def _columns(
    path: Path, header: tuple[int, list[str]], names: tuple[str, ...], expected: str
) -> tuple[float, list[int]]:
    """Metres per unit of the wavelength, and the positions of wavelength and ``names``."""
    number, cells = header
    stripped = [cell.strip() for cell in cells]
    plain = [re.split(r"[\s\[(_]", cell)[0].lower() for cell in stripped]
    found = [(index, _WAVELENGTH.match(cell)) for index, cell in enumerate(stripped)]
    wavelengths = [(index, match) for index, match in found if match]
    if not wavelengths:
        raise ConfigurationError(
            f'{path}:{number}: has no column "wavelength"; the line of names is "{expected}"'
        )
    index, match = wavelengths[0]
    unit = match[1] or match[2]
    if unit not in _WAVELENGTH_UNITS:
        said = f'unit "{unit}" of wavelength is unknown' if unit else "wavelength has no unit"
        raise ConfigurationError(f"{path}:{number}: {said}; write [nm], [um] or [m]")
    for name in names:
        if name not in plain:
            raise ConfigurationError(
                f'{path}:{number}: has no column "{name}"; the line of names is "{expected}"'
            )
    return _WAVELENGTH_UNITS[unit], [index, *(plain.index(name) for name in names)]


def _numbers(path: Path, line: tuple[int, list[str]], positions: list[int]) -> list[float]:
    number, cells = line
    values = []
    for position in positions:
        cell = cells[position].strip() if position < len(cells) else ""
        try:
            value = float(cell)
        except ValueError:
            value = np.nan
        if not np.isfinite(value):
            said = f'"{cell}" is not a number' if cell else f"column {position + 1} is empty"
            raise ConfigurationError(f"{path}:{number}: {said}")
        values.append(value)
    return values
