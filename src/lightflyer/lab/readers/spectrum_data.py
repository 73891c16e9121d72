"""Measured spectra, from the files that instruments write and from tables."""

import struct
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from lightflyer.core.constants import PLANCK, SPEED_OF_LIGHT
from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import ConfigurationError, MissingExtraError
from lightflyer.core.quantity import Length, Quantity
from lightflyer.files.table import read_table
from lightflyer.files.table_layout import Column
from lightflyer.lab.readers import formats, jasco, jcamp_dx, vendors
from lightflyer.lab.readers.interpretation import PER_CENTIMETRE as PER_CENTIMETRE
from lightflyer.lab.readers.interpretation import MeasuredSpectrum as MeasuredSpectrum
from lightflyer.lab.readers.interpretation import ReadOptions, interpret_spectrum, readable, shows

SPECTRUM_FORMATS = [
    formats.Format(vendors.OPUS, formats.starts_with(vendors.OPUS_MAGIC), vendors.read_opus),
    formats.Format(vendors.OMNIC, formats.starts_with(vendors.OMNIC_MAGIC), vendors.read_omnic),
    formats.Format(vendors.SP, formats.starts_with(vendors.SP_MAGIC), vendors.read_sp),
    formats.Format(jasco.JWS, jasco.is_jws, jasco.read_jws),
    formats.Format(vendors.SPC, vendors.is_spc, vendors.read_spc),
    formats.Format(jcamp_dx.FORMAT, jcamp_dx.is_jcamp, jcamp_dx.read_jcamp),
    formats.Format(vendors.ASC, vendors.is_asc, vendors.read_asc),
    formats.Format(jasco.TEXT, jasco.is_jasco_text, jasco.read_jasco_text),
]
"""All formats; binary ones, whose first bytes tell, before text. A plug-in adds its own."""

_BINARY = {".spa": vendors.OMNIC, ".spg": vendors.OMNIC, ".spc": vendors.SPC, ".sp": vendors.SP,
           ".jws": jasco.JWS, ".jrs": jasco.JWS}  # fmt: skip
_LISTED, _TITLE = 8, 40  # spectra that a message names, and characters of a title
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


def format_of(source: formats.Source) -> formats.Format | None:
    """Format of a file."""
    found = formats.find_format(source, SPECTRUM_FORMATS)
    named = _BINARY.get(source.suffix)
    if found is None and named is not None:
        source.refuse(f"is damaged or not {named}, which its name says")
    other = formats.WORDS["not_read"]["spectra"].get(source.suffix)
    if found is None and other is not None:
        source.refuse(f"is {other}, which is not read; export the spectrum as text or JCAMP-DX")
    return found


def read_raw(
    source: formats.Source, kind: formats.Format, options: ReadOptions
) -> formats.RawSpectrum:
    """The spectrum of a file, or the one of several that is asked for."""
    try:
        with np.errstate(all="ignore"):  # what is not finite is refused or left out later
            spectra = kind.read(source)
    except (ConfigurationError, MissingExtraError):
        raise
    # readers of binary formats go beyond the end of a damaged file in many ways
    except (ArithmeticError, LookupError, OSError, TypeError, ValueError, struct.error) as error:
        said = formats.one_line(str(error))[:100]
        raise ConfigurationError(
            f"{source.path}: is damaged and cannot be read as {kind.name}: {said}"
        ) from None
    fit = [one for one in spectra if readable(one)]
    if options.quantity is not None:
        fit = [one for one in fit if shows(one, options.quantity)] or fit
    wanted = options.spectrum
    if wanted is not None:  # its number or title
        if wanted.isascii() and wanted.isdigit() and 1 <= int(wanted[:9]) <= len(spectra):
            return spectra[int(wanted[:9]) - 1]
        titled = [one for one in spectra if one.metadata.sample == wanted.strip()]
        if len(titled) != 1:
            source.refuse(
                f'has {len(titled)} spectra "{wanted[:40]}"; it holds '
                f"{_list_names(spectra, spectra)}"
            )
        return titled[0]
    if len(spectra) == 1:
        return spectra[0]
    if not fit:
        names = sorted({f"{one.ordinate_name} over {one.abscissa_name}" for one in spectra})
        source.refuse(
            f"holds {len(spectra)} spectra, none of transmittance or reflectance: "
            f"{', '.join(names)[:100]}"
        )
    if len(fit) > 1:
        source.refuse(
            f'holds {len(fit)} spectra; choose one with --spectrum (spectrum="1"): '
            f"{_list_names(spectra, fit)}"
        )
    return fit[0]


def _list_names(spectra: list[formats.RawSpectrum], fit: list[formats.RawSpectrum]) -> str:
    names = [
        f"{number} {one.ordinate_name} of {one.metadata.sample[:_TITLE] or 'no title'}"
        for number, one in enumerate(spectra, start=1)
        if any(one is other for other in fit)
    ]
    bare = [name.partition(" ")[2] for name in names]
    for place, one in enumerate(fit) if len(set(bare)) < len(bare) else ():
        x, y = one.abscissa, one.ordinate  # what tells apart those of one name
        names[place] += (
            f" ({len(y)} points from {x[0]:.5g} to {x[-1]:.5g}, {y.min():.3g} to {y.max():.3g})"
        )
    more = f", and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
    return ", ".join(names[:_LISTED]) + more


@reads_units
def read_spectrum(
    path: str | Path,
    *,
    columns: str | None = None,
    quantity: formats.Ordinate | None = None,
    scale: str | None = None,
    spectrum: str | None = None,
    collection: formats.Collection | None = None,
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
    source = formats.Source(Path(path), b"") if workbook else formats.read_source(Path(path))
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
        raw = formats.RawSpectrum(
            AXES[axes[0]](numbers[axes[0]]) / PER_CENTIMETRE, written if marked else value, "cm-1",
            f"{chosen[0]} [%]" if marked else chosen[0], formats.SpectrumMetadata("table"),
            notes=tuple(table.notes), rejected=tuple(table.rejected),
        )  # fmt: skip
    else:
        raw = read_raw(source, kind, options)
        if columns is not None:
            raw = replace(raw, notes=(*raw.notes, f"columns are not used: it is {kind.name}"))
    return interpret_spectrum(source, raw, options)
