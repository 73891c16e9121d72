"""Tables over wavelength from a user's CSV files: refractive indices and spectra."""

from pathlib import Path

import numpy as np

from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.layout import Column
from lightflyer.foundation.quantity import Length, Quantity
from lightflyer.foundation.table import Table, read_table

_WAVELENGTH = Column(
    "wavelength", Length, ("lambda", "wl"), required=True, suggested_unit="um"
)  # fmt: skip
_INDEX_COLUMNS = (
    _WAVELENGTH,
    Column("n", Quantity("", 0.0, open_below=True), required=True, any_unit=True),
    Column("k", Quantity("", 0.0), required=True, any_unit=True),
)
_SPECTRUM_COLUMNS = (
    _WAVELENGTH,
    Column("irradiance", Quantity("", 0.0), required=True, any_unit=True),
)


def read_index_csv(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Read wavelength, n and k from a CSV file.

    Parameters
    ----------
    path : Path
        Columns ``wavelength [um], n, k``; the wavelength may have any unit of length.

    Returns
    -------
    wavelength : array, shape (m,)
        Increasing [m].
    n, k : array, shape (m,)
        Real and imaginary part of the refractive index [1].

    Raises
    ------
    ConfigurationError
        One line that says what is wrong and where.
    """
    numbers = _over_wavelength(read_table(path, _INDEX_COLUMNS, strict=True)).numbers
    return numbers["wavelength"], numbers["n"], numbers["k"]


def read_spectrum_csv(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Read wavelength and spectral irradiance from a CSV file.

    Parameters
    ----------
    path : Path
        Columns ``wavelength [nm], irradiance``.

    Returns
    -------
    wavelength : array, shape (m,)
        Increasing [m].
    irradiance : array, shape (m,)
        Per wavelength, in the unit of the file.

    Raises
    ------
    ConfigurationError
        One line that says what is wrong and where.
    """
    numbers = _over_wavelength(read_table(path, _SPECTRUM_COLUMNS, strict=True)).numbers
    if not np.any(numbers["irradiance"] > 0.0):
        raise ConfigurationError(f"{path}: irradiance is zero everywhere")
    return numbers["wavelength"], numbers["irradiance"]


def _over_wavelength(table: Table) -> Table:
    """The table, if its wavelengths increase."""
    if len(table) < 2:
        raise ConfigurationError(f"{table.source}: has one row of numbers; two or more are needed")
    falling = np.flatnonzero(np.diff(table.numbers["wavelength"]) <= 0.0)
    if falling.size:
        line = table.lines[falling[0] + 1]
        raise ConfigurationError(f"{table.source}:{line}: wavelengths must increase")
    return table
