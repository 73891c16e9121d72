"""Measured spectra, from the files that instruments write and from tables."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from lightflyer.core.arguments import reads_units
from lightflyer.core.constants import PLANCK, SPEED_OF_LIGHT
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Length, Quantity
from lightflyer.files.table import read_table
from lightflyer.files.table_layout import Column
from lightflyer.lab.readers.formats import Source, read_source
from lightflyer.lab.readers.spectra.formats import format_of, read_raw
from lightflyer.lab.readers.spectra.interpretation import PER_CENTIMETRE as PER_CENTIMETRE
from lightflyer.lab.readers.spectra.interpretation import MeasuredSpectrum as MeasuredSpectrum
from lightflyer.lab.readers.spectra.interpretation import ReadOptions, interpret_spectrum
from lightflyer.lab.readers.spectra.raw import Collection, Ordinate, RawSpectrum, SpectrumMetadata

# as fractions, or as per cent that the header does not mark
_SHARE = Quantity("", -20.0, 150.0)
_ABSORBANCE = Quantity("", -1.0, 1000.0)
AXES: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "wavenumber": lambda wavenumber: wavenumber,
    "wavelength": lambda wavelength: 1.0 / wavelength,
    "photon_energy": lambda energy: energy / (PLANCK * SPEED_OF_LIGHT),
}
"""Columns that say where a point is, and the wavenumber [1/m] that each gives."""

_WORKBOOKS = (".xlsx", ".xlsm")

COLUMNS = (
    Column(
        "wavenumber", Quantity("m^-1", 0.0, open_below=True), ("wavenumbers", "nu", "frequency"),
        suggested_unit="cm^-1",
    ),
    Column("wavelength", Length, ("lambda", "wl"), suggested_unit="um"),
    Column("photon_energy", Quantity("J", 0.0, open_below=True), ("energy",), suggested_unit="eV"),
    Column("transmittance", _SHARE, ("t", "transmission", "%transmittance", "%transmission")),
    Column("reflectance", _SHARE, ("r", "reflection", "%reflectance")),
    Column("absorbance", _ABSORBANCE, ("a", "abs")),
)  # fmt: skip
"""Columns of a spectrum: one of the first three, and one of the others."""

_AS_WRITTEN = tuple(
    replace(one, kind=Quantity(), any_unit=True) if one.name in ("transmittance", "reflectance")
    else one
    for one in COLUMNS
)  # fmt: skip


@reads_units
def read_spectrum(
    path: str | Path,
    *,
    columns: str | None = None,
    quantity: Ordinate | None = None,
    scale: str | None = None,
    spectrum: str | None = None,
    collection: Collection | None = None,
) -> MeasuredSpectrum:
    r"""Read a spectrum of transmittance or reflectance, infrared or UV-visible.

    Parameters
    ----------
    path : str or path
        A file of JASCO (text, ``.jws``), Bruker OPUS, Thermo OMNIC (``.spa``, ``.spg``),
        PerkinElmer (``.sp``, ``.asc``), GRAMS (``.spc``), JCAMP-DX, told apart by content; or a
        table of ``wavenumber``, ``wavelength`` or ``photon_energy`` and ``transmittance``,
        ``reflectance`` or (decadic) ``absorbance``, units in the header.
    columns : str, optional
        The columns of a table without a header, in their order; see
        :func:`~lightflyer.files.table.read_table`.
    quantity : {"transmittance", "reflectance"}, optional
        What an absorbance or an ordinate without a name was measured as, and which of several
        spectra to take. Absorbance is by default that of transmittance.
    scale : {"%", "1"}, optional
        Whether values are per cent or fractions. By default the file's word; where it has none,
        the values tell, which is noted.
    spectrum : str, optional
        Which one of several spectra in the file: its number, counted from 1, or its title.
    collection : {"specular", "diffuse", "total"}, optional
        Light that was collected. By default as the file names its accessory.

    Returns
    -------
    MeasuredSpectrum

    Raises
    ------
    ConfigurationError
        One line that names the file, and the line where there are lines: damaged, of another
        quantity (Kubelka-Munk units, single beam, interferogram), or with several spectra and no
        word on which.
    MissingExtraError
        If the format needs a package that is not installed.
    ParameterError
        If an option is unknown.

    Examples
    --------
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     path = Path(folder) / "film.csv"
    ...     _ = path.write_text("wavelength [nm],%R\n500,40\n1000,35\n")
    ...     found = read_spectrum(path, collection="specular")
    >>> found.quantity, found.wavelength, found.value
    ('reflectance', array([1.e-06, 5.e-07]), array([0.35, 0.4 ]))
    """
    options = ReadOptions(quantity, scale, spectrum, collection)
    options.check()
    workbook = str(path).partition("#")[0].lower().endswith(_WORKBOOKS)
    source = Source(Path(path), b"") if workbook else read_source(Path(path))
    kind = None if workbook else format_of(source)
    if kind is None:
        if spectrum not in (None, "1"):
            source.refuse(f'is a table of one spectrum, not of "{spectrum}"')
        table = read_table(path, COLUMNS, layout=columns)
        as_written = read_table(path, _AS_WRITTEN, layout=columns)
        numbers = table.numbers
        axes = [name for name in AXES if name in numbers]
        if len(axes) != 1:
            raise ConfigurationError(
                f"{table.source}: needs one column wavenumber, wavelength or photon_energy"
            )
        given = [name for name in ("transmittance", "reflectance", "absorbance") if name in numbers]
        chosen = [name for name in given if name == options.quantity] or given
        if len(chosen) != 1:
            raise ConfigurationError(
                f"{table.source}: needs one of the columns transmittance, reflectance, absorbance"
            )
        value, written = numbers[chosen[0]], as_written.numbers[chosen[0]]
        marked = not np.array_equal(value, written) and np.allclose(100.0 * value, written)
        raw = RawSpectrum(
            AXES[axes[0]](numbers[axes[0]]) / PER_CENTIMETRE,
            written if marked else value,
            "cm-1",
            f"{chosen[0]} [%]" if marked else chosen[0],
            SpectrumMetadata("table"),
            notes=tuple(table.notes),
            rejected=tuple(table.rejected),
        )
    else:
        raw = read_raw(source, kind, options)
        if columns is not None:
            raw = replace(raw, notes=(*raw.notes, f"columns are not used: it is {kind.name}"))
    return interpret_spectrum(source, raw, options)
