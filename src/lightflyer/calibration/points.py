"""Measured levitation points, read from a CSV file with units in its header.

Such a file looks like this; further columns are optional::

    sample, pressure [mTorr], irradiance [W/m^2], irradiance_uncertainty [W/m^2]
    Ge 2 cm, 30, 1510, 40

"""

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.layout import Column
from lightflyer.foundation.quantity import (
    AccommodationCoefficient,
    ArealDensity,
    Emittance,
    Fraction,
    Irradiance,
    Length,
    Pressure,
    Quantity,
    quantity_of,
)
from lightflyer.foundation.table import Table, read_table

REQUIRED = ("sample", "pressure", "irradiance")
"""Columns that every file has."""


def _positive(kind: object) -> Quantity:
    return replace(quantity_of(kind) or Quantity(), open_below=True)


_PRESSURE = Column("pressure", Pressure, required=True)
_IRRADIANCE = Column("irradiance", _positive(Irradiance), required=True)
_SAMPLE_COLUMNS = (
    Column("diameter", Length),
    Column("areal_density", ArealDensity),
    Column("emittance", Emittance),
    Column("absorptance", _positive(Fraction)),
    Column("tac_top", AccommodationCoefficient),
    Column("tac_bottom", AccommodationCoefficient),
)
_UNCERTAINTIES = (_PRESSURE.uncertainty(), _IRRADIANCE.uncertainty())
_COLUMNS = (
    Column("sample", text=True, required=True, blank=False),
    _PRESSURE,
    _IRRADIANCE,
    *_UNCERTAINTIES,
    *_SAMPLE_COLUMNS,
    Column("figure", text=True),
)

NUMBERS: dict[str, Quantity] = {one.name: one.quantity for one in _COLUMNS if not one.text}
"""Columns of numbers: unit and possible range by name."""

SAMPLE_PROPERTIES = tuple(column.name for column in _SAMPLE_COLUMNS)
"""Columns that describe a sample."""

COLUMNS = (*NUMBERS, *(column.name for column in _COLUMNS if column.text))
"""All columns that a file may have."""

FIGURES = ("2", "5", "S2", "S3")
"""Figures of the paper in which points can be drawn."""


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

    @property
    def has_uncertainty(self) -> bool:
        """Whether uncertainties are stated."""
        return any(column.name in self.numbers for column in _UNCERTAINTIES)

    @property
    def properties(self) -> dict[str, np.ndarray]:
        """Columns that describe the samples, by name: arrays of shape (n,)."""
        measured = {column.name for column in (_PRESSURE, _IRRADIANCE, *_UNCERTAINTIES)}
        return {name: column for name, column in self.numbers.items() if name not in measured}

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
    table = read_table(path, _COLUMNS, strict=True, closed=True)
    _require_figures(table)
    return Points(table.source, table.texts["sample"], table.numbers, table.texts)


def _require_figures(table: Table) -> None:
    for line, figure in zip(table.lines, table.texts.get("figure", ()), strict=False):
        if figure.upper() not in FIGURES:
            raise ConfigurationError(
                f'{table.source}:{line}: figure = "{figure}" is not one of {", ".join(FIGURES)}'
            )
