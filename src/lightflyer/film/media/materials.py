"""Materials of measured n and k, and their files, as laboratories and databases write them.

A :class:`Material` interpolates measured n and k between the wavelengths of its source and
knows where they end. Outside that range it raises, unless the user has chosen one of the named
:class:`~lightflyer.film.media.medium.Extrapolation` policies; every result then lists the materials
that were extrapolated.
"""

import re
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from lightflyer.array.namespace import Numeric
from lightflyer.array.records import field
from lightflyer.core.checks import require_range
from lightflyer.core.constants import PLANCK, SPEED_OF_LIGHT
from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.extras import extra
from lightflyer.core.quantity import Density, Length, Quantity
from lightflyer.core.text import read_content
from lightflyer.core.units import Measured
from lightflyer.files.table import Table, read_columns, read_table
from lightflyer.files.table_file import Lines, plain_text, read_lines
from lightflyer.files.table_layout import Column
from lightflyer.film.media.medium import GIVEN, MICROMETRE, DataMedium, Extrapolation

ROOM_TEMPERATURES = (270.0, 320.0)  # Temperatures of samples that need no mention [K]

_WIDEST_STEP = 0.01  # relative: what lies between two sources' ends closer than this is no gap

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


class Segment(NamedTuple):
    """A stretch of wavelengths with one source."""

    shortest: float  # Wavelengths covered [m]
    longest: float  # Wavelengths covered [m]
    source: str  # Database page or file
    # Takes wavelengths inside [m], returns n and k [1]
    lookup: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]


class Material(DataMedium):
    """Complex refractive index n + ik and mass density of a material, from fixed tables.

    Raises
    ------
    ParameterError
        If a density is negative.
    """

    name: str = field(static=True)
    #: In order of wavelength. Across a gap between two of them n and k are linear
    segments: tuple[Segment, ...] = field(static=True)
    #: Mass density [kg/m³]; None where it depends on the sample and must be given
    density: Numeric | None = None
    density_source: str = field(static=True, default="")
    description: str = field(static=True, default="")  #: What was measured
    #: Thermal accommodation coefficient of its surface in air [1]; None if never measured
    tac: Measured | None = field(static=True, default=None)
    tac_source: str = field(static=True, default="")
    #: Policy outside the range
    extrapolation: Extrapolation = field(static=True, default=Extrapolation.ERROR)
    #: What a reader of results must know of the tables, one line each
    remarks: tuple[str, ...] = field(static=True, default=())
    #: Of the sample, where it is stated [K]
    temperature: float | None = field(static=True, default=None)

    def __check_init__(self) -> None:
        require_range(f"density of {self.name}", self.density, 0.0)

    @property
    def wavelength_range(self) -> tuple[float, float]:
        return self.segments[0].shortest, self.segments[-1].longest

    @property
    def gaps(self) -> tuple[tuple[float, float], ...]:
        """Wavelengths between two sources [m], across which n and k are linear."""
        ends = zip(self.segments, self.segments[1:], strict=False)
        found = ((left.longest, right.shortest) for left, right in ends)
        return tuple(gap for gap in found if gap[1] > gap[0] * (1.0 + _WIDEST_STEP))

    @property
    def diagnostics(self) -> tuple[str, ...]:
        """Warns of gaps between sources and an unusual temperature, and repeats remarks."""
        gaps = (
            f"{self.name} has no optical data from {gap[0] / MICROMETRE:.4g} µm to "
            f"{gap[1] / MICROMETRE:.4g} µm; n and k are linear between these"
            for gap in self.gaps
        )
        coldest, hottest = ROOM_TEMPERATURES
        usual = self.temperature is None or coldest <= self.temperature <= hottest
        sample = () if usual else (f"{self.name} has n and k at {self.temperature:g} K",)
        return (*gaps, *sample, *self.remarks)

    @property
    def source(self) -> str:
        return "; ".join(segment.source for segment in self.segments)

    def index(self, wavelength: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Index and extinction as NumPy arrays."""
        wavelength = np.asarray(wavelength, float)
        self.require_covered(wavelength)
        inside = np.clip(wavelength, *self.wavelength_range).ravel()
        n, k = np.empty_like(inside), np.empty_like(inside)
        for segment in self.segments:
            here = (inside >= segment.shortest) & (inside <= segment.longest)
            n[here], k[here] = segment.lookup(inside[here])
        for left, right in zip(self.segments, self.segments[1:], strict=False):
            gap = (inside > left.longest) & (inside < right.shortest)
            if np.any(gap):
                ends = np.array([left.longest, right.shortest])
                start, stop = left.lookup(ends[:1]), right.lookup(ends[1:])
                n[gap], k[gap] = (
                    np.interp(inside[gap], ends, np.concatenate(pair))
                    for pair in zip(start, stop, strict=True)
                )
        if self.extrapolation is Extrapolation.LOSSLESS:
            k = np.where(self.covers(wavelength).ravel(), k, 0.0)
        return n.reshape(wavelength.shape)[()], k.reshape(wavelength.shape)[()]


def vacuum() -> Material:
    """Empty space, for pores and gaps.

    Returns
    -------
    Material

    Examples
    --------
    >>> print(*vacuum().index(1e-6))
    1.0 0.0
    """
    return _VACUUM


def _nothing(wavelength: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.ones_like(wavelength), np.zeros_like(wavelength)


_VACUUM = Material(
    name="vacuum",
    segments=(Segment(0.0, np.inf, "n = 1, k = 0", _nothing),),
    density=0.0,
    density_source="empty",
)


@reads_units
def tabulated_material(
    name: str,
    wavelength: Length,
    n: np.ndarray,
    k: np.ndarray,
    *,
    density: Density | None = None,
    tac: Measured | None = None,
    source: str = "given in Python",
) -> Material:
    """Material from a table of n and k.

    Parameters
    ----------
    name : str
    wavelength : array, shape (m,)
        Increasing, at least two [m].
    n, k : array, shape (m,)
        Refractive index and extinction coefficient [1].
    density : float, optional
        Mass density [kg/m³].
    tac : Measured, optional
        Thermal accommodation coefficient of its surface [1].
    source : str
        Origin of the numbers.

    Returns
    -------
    Material

    Raises
    ------
    ParameterError
        If wavelengths do not increase, a value is not finite, n is not positive or k negative.
    """
    table = np.array([wavelength, n, k], float)
    if table.ndim != 2 or table.shape[1] < 2 or not np.all(np.isfinite(table)):
        raise ParameterError(f"{name}: needs two or more wavelengths with finite n and k")
    if np.any(np.diff(table[0]) <= 0.0) or table[0, 0] <= 0.0:
        raise ParameterError(f"{name}: wavelengths must be positive and increase")
    if np.any(table[1] <= 0.0) or np.any(table[2] < 0.0):
        raise ParameterError(f"{name}: n must be positive and k zero or positive")

    def lookup(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.interp(points, table[0], table[1]), np.interp(points, table[0], table[2])

    segment = Segment(float(table[0, 0]), float(table[0, -1]), source, lookup)
    return Material(
        name=name,
        segments=(segment,),
        density=density,
        density_source="" if density is None else GIVEN,
        tac=tac,
        tac_source="" if tac is None else GIVEN,
    )


def material_from_csv(
    path: str | Path, *, density: float | None = None, tac: Measured | None = None
) -> Material:
    """Material from a CSV file of wavelength, n and k.

    Parameters
    ----------
    path : str or path
        Comma-separated; the first line not starting with ``#`` names the columns, with the
        unit of the wavelength: ``wavelength [um],n,k``.
    density : float, optional
        Mass density [kg/m³].
    tac : Measured, optional
        Thermal accommodation coefficient of its surface [1].

    Returns
    -------
    Material
        Named as the file.

    Raises
    ------
    ConfigurationError
        One line that says what is wrong and where.
    """
    path = Path(path)
    wavelength, n, k = read_index_csv(path)
    return tabulated_material(
        path.name, wavelength, n, k, density=density, tac=tac, source=str(path)
    )


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
    entries = page.get("DATA") if isinstance(page, dict) else None
    if not isinstance(entries, list):
        raise ConfigurationError(f"{path}: is not a page of refractiveindex.info: it has no DATA")
    tables: dict[str, np.ndarray] = {}  # of n, k or nk, wavelengths in metres
    for entry in entries:
        kind = str(entry.get("type", "")) if isinstance(entry, dict) else ""
        first, _, name = kind.partition(" ")
        if first != "tabulated" or name not in ("n", "k", "nk"):
            continue
        if name in tables:
            raise ConfigurationError(f"{path}: holds two tables of {name}")
        damaged = ConfigurationError(f"{path}: its table of {name} is damaged")
        try:
            lines = str(entry.get("data", "")).split("\n")
            rows = np.array([line.split() for line in lines if line.strip()], float).T
        except ValueError:
            raise damaged from None
        whole = rows.ndim == 2 and len(rows) == len(name) + 1 and rows.shape[1] > 1
        if not (whole and np.isfinite(rows).all() and np.all(rows[0] > 0.0)):
            raise damaged
        rows[0] *= MICROMETRE
        for letter, values in zip(name, rows[1:], strict=True):
            if np.any(values < 0.0) or (letter == "n" and np.any(values == 0.0)):
                raise ConfigurationError(f"{path}: its table of {name} has an impossible {letter}")
        # by wavelength: published pages may be unsorted, and overlap where they were joined
        distinct, which, count = np.unique(rows[0], return_inverse=True, return_counts=True)
        means = np.array([np.bincount(which, values) / count for values in rows])
        if np.any(np.abs(rows - means[:, which]) > _JOINED * means[:, which]):
            raise ConfigurationError(f"{path}: its table of {name} has two values at a wavelength")
        tables[name] = np.stack([distinct, *means[1:]])
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
