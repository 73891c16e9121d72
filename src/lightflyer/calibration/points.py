"""Measured levitation points: a CSV with units in its header, and one clear line a mistake.

Such a file looks like this; further columns are optional::

    sample, pressure [mTorr], irradiance [W/m^2], irradiance_uncertainty [W/m^2]
    Ge 2 cm, 30, 1510, 40

"""

import csv
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from lightflyer.film.properties import HIGHEST_TAC
from lightflyer.foundation.checks import require_range
from lightflyer.foundation.errors import ConfigurationError, ParameterError
from lightflyer.foundation.text import read_text
from lightflyer.foundation.units import parse

REQUIRED = ("sample", "pressure", "irradiance")
"""Columns that every file has."""

NUMBERS: dict[str, tuple[str, float, float, bool]] = {
    "pressure": ("Pa", 0.0, math.inf, True),
    "irradiance": ("W/m^2", 0.0, math.inf, True),
    "pressure_uncertainty": ("Pa", 0.0, math.inf, False),
    "irradiance_uncertainty": ("W/m^2", 0.0, math.inf, False),
    "diameter": ("m", 0.0, math.inf, True),
    "areal_density": ("kg/m^2", 0.0, math.inf, True),
    "emittance": ("", 0.0, 1.0, True),
    "absorptance": ("", 0.0, 1.0, True),
    "tac_top": ("", 0.0, HIGHEST_TAC, True),
    "tac_bottom": ("", 0.0, HIGHEST_TAC, True),
}
"""Columns with numbers: unit, lowest and highest allowed value, whether the lowest is excluded."""

SAMPLE_PROPERTIES = (
    "diameter", "areal_density", "emittance", "absorptance", "tac_top", "tac_bottom"
)  # fmt: skip
"""Columns that say what a sample is."""

_TEXTS = ("sample", "figure")
FIGURES = ("2", "5", "S2", "S3")
"""Figures of the paper that points can be drawn in."""

COLUMNS = (*NUMBERS, *_TEXTS)
"""All columns that a file may have."""

_HEADER = re.compile(r"^\s*([A-Za-z_]+)\s*(?:\[\s*(.*?)\s*\])?\s*$")


@dataclass(frozen=True)
class Points:
    """Points of pressure and irradiance at which samples lifted off.

    Attributes
    ----------
    source : str
        Name of the file.
    samples : list of str, length n
        Sample of each point.
    numbers : dict of str to array, shape (n,)
        Columns with numbers, in SI units, by name.
    texts : dict of str to list of str
        Further columns, by name.
    """

    source: str
    samples: list[str]
    numbers: dict[str, np.ndarray]
    texts: dict[str, list[str]] = field(default_factory=dict)

    def __len__(self) -> int:
        """Number of points."""
        return len(self.samples)

    @property
    def pressure(self) -> np.ndarray:
        """Gas pressure [Pa], shape (n,)."""
        return self.numbers["pressure"]

    @property
    def irradiance(self) -> np.ndarray:
        """Irradiance at lift-off [W/m²], shape (n,)."""
        return self.numbers["irradiance"]

    def of(self, sample: str) -> np.ndarray:
        """Which points belong to a sample: bool array, shape (n,)."""
        return np.array([name == sample for name in self.samples], bool)


def read_points(path: str | Path) -> Points:
    """Read measured points.

    Parameters
    ----------
    path : str or path
        CSV with a header such as ``sample, pressure [Torr], irradiance [W/m^2]``.

    Returns
    -------
    Points

    Raises
    ------
    ConfigurationError
        One line that names file, line and column.
    """
    path = Path(path)
    text = read_text(path)
    lines = [
        (number, cells)
        for number, cells in enumerate(csv.reader(text.splitlines(), skipinitialspace=True), 1)
        if any(cell.strip() for cell in cells) and not cells[0].lstrip().startswith("#")
    ]
    if not lines:
        raise ConfigurationError(f"{path}: is empty; its header names {', '.join(REQUIRED)}")
    (header_line, header), *rows = lines
    units = _units(header, f"{path}:{header_line}")
    if not rows:
        raise ConfigurationError(f"{path}: has a header but no points")
    values: dict[str, list[str | float]] = {name: [] for name in units}
    for line, cells in rows:
        for name, value in _row(cells, units, f"{path}:{line}").items():
            values[name].append(value)
    return Points(
        source=str(path),
        samples=[str(name) for name in values["sample"]],
        numbers={
            name: np.array(column, float) for name, column in values.items() if name in NUMBERS
        },
        texts={
            name: [str(value) for value in column]
            for name, column in values.items()
            if name in _TEXTS
        },
    )


def _units(header: Sequence[str], place: str) -> dict[str, str]:
    """Unit of each column, by name, in the order of the file."""
    units: dict[str, str] = {}
    for cell in header:
        match = _HEADER.match(cell)
        if match is None or match[1] not in COLUMNS:
            raise ConfigurationError(
                f'{place}: column "{cell.strip()}" is unknown; there are: {", ".join(COLUMNS)}'
            )
        name, unit = match[1], match[2] or ""
        if name in units:
            raise ConfigurationError(f"{place}: column {name} stands twice")
        if name in NUMBERS:
            wanted = NUMBERS[name][0]
            if wanted and not unit:
                raise ConfigurationError(
                    f'{place}: column {name} has no unit; write "{name} [{wanted}]"'
                )
            _in_si(1.0, name, unit, f"{place}: column {name}")
        units[name] = unit
    for name in REQUIRED:
        if name not in units:
            raise ConfigurationError(f"{place}: the column {name} is missing")
    return units


def _in_si(value: float, name: str, unit: str, place: str) -> float:
    wanted = NUMBERS[name][0]
    try:
        return parse(f"{value!r} {unit}" if unit else value, wanted).value
    except ConfigurationError as error:
        raise ConfigurationError(f"{place}: {error}") from None


def _row(cells: Sequence[str], units: dict[str, str], place: str) -> dict[str, str | float]:
    if len(cells) != len(units):
        raise ConfigurationError(
            f"{place}: has {len(cells)} values, the header has {len(units)} columns"
        )
    row: dict[str, str | float] = {}
    for cell, (name, unit) in zip(cells, units.items(), strict=True):
        if name in _TEXTS:
            if name == "sample" and not cell.strip():
                raise ConfigurationError(f"{place}: the sample has no name")
            if name == "figure" and cell.strip().upper() not in FIGURES:
                raise ConfigurationError(
                    f'{place}: figure "{cell.strip()}" is none of {", ".join(FIGURES)}'
                )
            row[name] = cell.strip()
            continue
        try:
            number = float(cell)
        except ValueError:
            raise ConfigurationError(f'{place}: {name}: "{cell}" is not a number') from None
        _, lowest, highest, open_below = NUMBERS[name]
        try:
            require_range(name, number, lowest, highest, open_below=open_below)
        except ParameterError as error:
            raise ConfigurationError(f"{place}: {error}") from None
        row[name] = _in_si(number, name, unit, f"{place}: {name}")
    return row
