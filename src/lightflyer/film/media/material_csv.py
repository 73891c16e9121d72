"""Refractive indices and spectra from a user's files, as laboratories and databases write them."""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from lightflyer.core.constants import PLANCK, SPEED_OF_LIGHT
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.extras import extra
from lightflyer.core.quantity import Length, Quantity
from lightflyer.core.text import read_content
from lightflyer.files.table import Table, read_columns, read_table
from lightflyer.files.table_file import Lines, plain_text, read_lines
from lightflyer.files.table_layout import Column
from lightflyer.film.media.medium import MICROMETRE

SUFFIXES = (".csv", ".txt", ".tsv", ".dat", ".nk", ".xlsx", ".yml", ".yaml")
"""Ends of the names of files with refractive indices."""

_SHEET = re.compile(r"\.xlsx#[^/]*$", re.I)
_ROUNDED = 0.01  # relative difference of two columns that give the same wavelength
_JOINED = 0.05  # from the mean of two values where a published table has been joined

Indices = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Wavelength [m], increasing; n and k [1]: arrays of shape (m,)."""

_POSITIVE = Quantity("", 0.0, open_below=True)
_WAVELENGTH = Column("wavelength", Length, ("lambda", "wl", "λ"), suggested_unit="um")
_ABSCISSAE = (
    _WAVELENGTH,
    Column("photon_energy", Quantity("J", 0.0, open_below=True), ("energy", "hv", "hν"),
           suggested_unit="eV"),
    Column("wavenumber", Quantity("m^-1", 0.0, open_below=True), ("wavenumbers", "nu", "ν"),
           suggested_unit="cm^-1"),
    Column("frequency", Quantity("Hz", 0.0, open_below=True), ("f", "freq"), suggested_unit="THz"),
)  # fmt: skip
_N = Column("n", _POSITIVE, ("refractive_index", "n_real", "real_n"))
_K = Column("k", Quantity("", 0.0), ("extinction_coefficient", "extinction", "kappa", "κ"))
_REAL = Column("permittivity_real", Quantity(), (
    "eps1", "eps_1", "e1", "ε1", "ε_1", "ε'", "epsilon1", "epsilon_1", "eps_real", "eps_r",
    "epsilon_real", "real_epsilon", "real_permittivity",
))  # fmt: skip
_IMAGINARY = Column("permittivity_imaginary", Quantity("", 0.0), (
    "eps2", "eps_2", "e2", "ε2", "ε_2", "ε''", 'ε"', "epsilon2", "epsilon_2", "eps_imag", "eps_i",
    "epsilon_imag", "epsilon_imaginary", "imaginary_epsilon", "imaginary_permittivity",
))  # fmt: skip
_INDEX_COLUMNS = (*_ABSCISSAE, _N, _K, _REAL, _IMAGINARY)
_SPECTRUM_COLUMNS = (
    Column("wavelength", Length, ("lambda", "wl"), required=True, suggested_unit="um"),
    Column("irradiance", Quantity("W/m^3", 0.0), required=True, assumed_unit="W/m^3"),
)
# the two blocks that refractiveindex.info writes one below the other, in micrometres
_BLOCK = re.compile(r'^\s*"?(?:wl|wavelength)\b.*[,;\t]\s*"?([nk])"?\s*$', re.I)
_BLOCK_WAVELENGTH = Column("wavelength", Length, ("wl",), required=True, assumed_unit="um")
_PAGE = re.compile(r"^\s*DATA\s*:", re.M)
_NEEDED = "wavelength (or photon_energy, wavenumber, frequency), n and k (or eps1 and eps2)"


def names_file(name: str) -> bool:
    """Whether the name of a material is meant as a file."""
    return name.lower().endswith(SUFFIXES) or bool(_SHEET.search(name))


def read_index_csv(path: Path) -> Indices:
    """Read wavelength, n and k from a file; returns ``wavelength`` (m,) [m], ``n, k`` (m,) [1]."""
    path = Path(path)
    if path.suffix.lower() in (".yml", ".yaml"):
        return _read_page(path)
    if blocks := _blocks(path):
        curves = []
        for lines, column in zip(blocks, (_N, _K), strict=True):
            table = read_columns(lines, (_BLOCK_WAVELENGTH, column))
            wavelength, order = _wavelength(table)
            curves.append((wavelength, table.numbers[column.name][order]))
        return _common(path, *curves)
    table = read_table(path, _INDEX_COLUMNS, strict=True, preamble=True)
    wavelength, order = _wavelength(table)
    n, k = _n_and_k(table)
    return wavelength, n[order], k[order]


def read_spectrum_csv(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Read wavelength and spectral irradiance from a table; ``path`` [nm]."""
    table = read_table(path, _SPECTRUM_COLUMNS, strict=True)
    wavelength, order = _wavelength(table)
    irradiance = table.numbers["irradiance"][order]
    if not np.any(irradiance > 0.0):
        raise ConfigurationError(f"{path}: irradiance is zero everywhere")
    return wavelength, irradiance


def _wavelength(table: Table) -> tuple[np.ndarray, slice]:
    """Wavelengths of a table, increasing [m], and its rows in their order."""
    factors = {"photon_energy": PLANCK * SPEED_OF_LIGHT, "frequency": SPEED_OF_LIGHT}
    lengths = {
        name: values if name == "wavelength" else factors.get(name, 1.0) / values
        for name, values in table.numbers.items()
        if name in [one.name for one in _ABSCISSAE]
    }
    if not lengths:
        needed = ", ".join(one.with_unit for one in _ABSCISSAE)
        raise ConfigurationError(f"{table.source}: needs one of the columns {needed}")
    (given, length), *others = lengths.items()
    for other, values in others:
        wrong = np.flatnonzero(np.abs(values - length) > _ROUNDED * length)
        if wrong.size:
            line = table.lines[wrong[0]]
            raise ConfigurationError(f"{table.source}:{line}: {given} and {other} do not agree")
    if len(table) < 2:
        raise ConfigurationError(f"{table.source}: has one row of numbers; two or more are needed")
    order = slice(None, None, -1 if length[-1] < length[0] else 1)
    steps = np.diff(length)
    wrong = np.flatnonzero(steps * np.sign(length[-1] - length[0]) <= 0.0)
    if wrong.size:
        line = table.lines[wrong[0] + 1]
        what = "appears twice" if steps[wrong[0]] == 0.0 else "is out of order: sort the rows"
        raise ConfigurationError(f"{table.source}:{line}: the {given} {what}")
    return length[order], order


def _n_and_k(table: Table) -> tuple[np.ndarray, np.ndarray]:
    has = set(table.numbers)
    indices, permittivity = {"n", "k"} & has, {_REAL.name, _IMAGINARY.name} & has
    if len(indices) == 2:
        return table.numbers["n"], table.numbers["k"]
    if len(permittivity) == 2 and not indices:
        root = np.sqrt(table.numbers[_REAL.name] + 1j * table.numbers[_IMAGINARY.name])
        zero = np.flatnonzero(root.real <= 0.0)
        if zero.size:
            raise ConfigurationError(
                f"{table.source}:{table.lines[zero[0]]}: n = 0 follows from this permittivity; n "
                "must be positive"
            )
        return root.real, root.imag
    if indices == {"n"} and not permittivity:
        raise ConfigurationError(
            f"{table.source}: has n but no k; add a column k, of zeros where the material is clear"
        )
    found = ", ".join([*table.numbers, *table.unused])
    raise ConfigurationError(f"{table.source}: needs {_NEEDED}; its columns: {found}")


def _blocks(path: Path) -> list[Lines]:
    """Blocks of a CSV file of refractiveindex.info, n first; empty for any other file."""
    file, *sheets = read_lines(path)
    if sheets:
        return []
    heads = [
        (number, match[1].lower())
        for number, line in enumerate(file.lines)
        if (match := _BLOCK.match(line))
    ]
    if [name for _, name in heads] != ["n", "k"] or heads[0][0]:
        return []
    below = heads[1][0]
    # blank lines keep the numbers of the lines
    return [
        file._replace(lines=file.lines[:below], ended=True),
        file._replace(lines=[""] * below + file.lines[below:]),
    ]


def _common(
    path: Path, n: tuple[np.ndarray, np.ndarray], k: tuple[np.ndarray, np.ndarray]
) -> Indices:
    """Two curves at all wavelengths that both cover, linear between their points."""
    low, high = max(n[0][0], k[0][0]), min(n[0][-1], k[0][-1])
    if not low < high:
        raise ConfigurationError(f"{path}: n and k have no wavelengths in common")
    wavelength = np.union1d(n[0], k[0])
    wavelength = wavelength[(wavelength >= low) & (wavelength <= high)]
    return wavelength, np.interp(wavelength, *n), np.interp(wavelength, *k)


def _read_page(path: Path) -> Indices:
    """Refractive indices of a page of refractiveindex.info in YAML."""
    yaml = extra("yaml", f"{path}: a page of refractiveindex.info", "materials")
    text = plain_text(read_content(path), str(path))
    try:
        page = yaml.safe_load(text)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        place = f"{path}:{mark.line + 1}" if mark else str(path)
        raise ConfigurationError(f"{place}: cannot be read as YAML") from None
    except (ValueError, RecursionError):  # of scalars such as impossible dates
        raise ConfigurationError(f"{path}: cannot be read as YAML") from None
    tables = dict(_tables(path, page))
    if "nk" in tables and len(tables) == 1:
        wavelength, n, k = tables["nk"]
        return wavelength, n, k
    if set(tables) == {"n", "k"}:
        (at_n, n), (at_k, k) = tables["n"], tables["k"]
        return _common(path, (at_n, n), (at_k, k))
    raise ConfigurationError(
        f"{path}: holds no table of n and k; a page with a formula is known by its name, such as "
        '"main/SiO2/Malitson"'
    )


def _tables(path: Path, page: object) -> Iterator[tuple[str, np.ndarray]]:
    """Kind (n, k or nk) and columns of each table of a page, wavelengths in metres."""
    entries = page.get("DATA") if isinstance(page, dict) else None
    if not isinstance(entries, list):
        raise ConfigurationError(f"{path}: is not a page of refractiveindex.info: it has no DATA")
    seen = set()
    for entry in entries:
        kind = str(entry.get("type", "")) if isinstance(entry, dict) else ""
        first, _, name = kind.partition(" ")
        if first != "tabulated" or name not in ("n", "k", "nk"):
            continue
        if name in seen:
            raise ConfigurationError(f"{path}: holds two tables of {name}")
        seen.add(name)
        try:
            lines = str(entry.get("data", "")).split("\n")
            rows = np.array([line.split() for line in lines if line.strip()], float).T
        except ValueError:
            raise ConfigurationError(f"{path}: its table of {name} is damaged") from None
        whole = rows.ndim == 2 and len(rows) == len(name) + 1 and rows.shape[1] > 1
        if not (whole and np.isfinite(rows).all()):
            raise ConfigurationError(f"{path}: its table of {name} is damaged")
        rows[0] *= MICROMETRE
        if not np.all(rows[0] > 0.0):
            raise ConfigurationError(f"{path}: its table of {name} is damaged")
        for letter, values in zip(name, rows[1:], strict=True):
            if np.any(values < 0.0) or (letter == "n" and np.any(values == 0.0)):
                raise ConfigurationError(f"{path}: its table of {name} has an impossible {letter}")
        # by wavelength: published pages may be unsorted, and overlap where they were joined
        distinct, place, count = np.unique(rows[0], return_inverse=True, return_counts=True)
        means = np.array([np.bincount(place, values) / count for values in rows])
        if np.any(np.abs(rows - means[:, place]) > _JOINED * means[:, place]):
            raise ConfigurationError(f"{path}: its table of {name} has two values at a wavelength")
        yield name, np.stack([distinct, *means[1:]])
