"""Materials by name: entries of the library with their sources, and pages of the database.

The pages are those of the refractiveindex.info database ([Polyanskiy2024]_, CC0); their tables are
in ``data/media``, which ``studies/library_media`` writes.
"""

import dataclasses
import difflib
import tomllib
from collections.abc import Callable
from functools import cache, partial
from importlib import resources
from typing import Any, TypeAlias

import numpy as np

from lightflyer.core.errors import ParameterError
from lightflyer.core.extras import load_plugins
from lightflyer.core.units import Measured
from lightflyer.film.media.compound import Shape, maxwell_garnett
from lightflyer.film.media.database import SITE, database_page, looks_like_page, page_material
from lightflyer.film.media.materials import Material, Segment, material_from_csv, names_file, vacuum
from lightflyer.film.media.medium import MICROMETRE, Extrapolation, Medium

_Lookup: TypeAlias = Callable[
    [np.ndarray], tuple[np.ndarray, np.ndarray]
]  # wavelength [m] to n and k


@dataclasses.dataclass(frozen=True)
class Page:
    """A page of the database, or the part of it in use."""

    shelf: str
    book: str
    page: str
    shortest_um: float = 0.0  # Limits of use within the page's own range [µm]
    longest_um: float = np.inf

    @property
    def file(self) -> str:
        """Its table in ``data/media``."""
        return f"{self.book}-{self.page}.csv"


@dataclasses.dataclass(frozen=True)
class Entry:
    """Pages, density and measured TAC of a material, as in ``data/materials.toml``."""

    description: str
    pages: tuple[Page, ...]  # In order of wavelength
    density_source: str
    density: float | None = None  # [kg/m³]
    tac: Measured | None = None  # Measured thermal accommodation coefficient [1]
    # Temperature at which a film of it melts or loses its shape [K]
    highest_temperature: float | None = None
    # Volume fraction of the pages' medium as a mat of needles in vacuum; None where it is all [1]
    mat_fraction: float | None = None
    remark: str = ""  # What results must say of it
    names: tuple[str, ...] = ()  # Other names of the same material


TAC_SOURCE = "measured in air, Lu et al. (2023), table 1; alumina: text on TACs [Lu2023]"


_FOLDER = resources.files("lightflyer") / "data"
_DATA = (_FOLDER / "materials.toml").read_text(encoding="utf-8")
PAGES = {
    name: Entry(**content | {
        "pages": tuple(Page(**page) for page in content["pages"]),
        "tac": Measured(*content["tac"]) if "tac" in content else None,
        "names": tuple(content.get("names", ())),
    })
    for name, content in tomllib.loads(_DATA).items()
}  # fmt: skip
"""Materials by their name in a flyer file."""

MEDIA: dict[str, Medium] = {}
"""Further ones, which plug-ins add."""

VACUUM = "vacuum"  # Name of empty space, as a part of mixtures

ALIASES = {other: name for name, entry in PAGES.items() for other in entry.names}
ALIASES |= {"air": VACUUM, "void": VACUUM}
"""Other names of the same materials."""


def canonical_name(name: str) -> str:
    """Name of a material in the library, from any of its names in any case."""
    name = " ".join(name.split())
    load_plugins()
    known = {alias.lower(): target for alias, target in ALIASES.items()}
    known |= {target.lower(): target for target in (*PAGES, VACUUM, *MEDIA)}
    if name.lower() in known:
        return known[name.lower()]
    near = difflib.get_close_matches(name.lower(), known, n=3, cutoff=0.5)
    names = list(dict.fromkeys(known[match] for match in near))
    hint = f"did you mean {' or '.join(names)}?" if names else f"the library has {', '.join(PAGES)}"
    raise ParameterError(
        f'material "{name}" is unknown; {hint} (or give a page of refractiveindex.info, as '
        "lightflyer materials --search lists them, or a CSV file of n and k)"
    )


def material(name: str, *, extrapolation: Extrapolation | str = Extrapolation.ERROR) -> Medium:
    """A material by name; its tables are read once.

    Parameters
    ----------
    name : str
        Of the library, such as ``"Ge"``, ``"PET"`` or its other name ``"mylar"``; see
        :func:`material_names`. Or any page of refractiveindex.info, with the extra ``materials``,
        as shelf/book/page such as ``"main/Cr/Johnson"``; see
        :func:`~lightflyer.film.media.database.search_pages`. Or a file, as of
        :func:`material_from_csv`. Or one that a plug-in adds.
    extrapolation : Extrapolation or str
        Policy outside the range of its data.

    Returns
    -------
    Medium
        A :class:`Material`, unless a plug-in adds another one.

    Raises
    ------
    ParameterError
        If the material or the policy is unknown; the message has the nearest names. If a page
        has no n, or numbers that no medium has.

    Notes
    -----
    A page without k gets k = 0, and one with noise of k around zero no negative k. Its remarks,
    and so the results of its films, say so.

    Examples
    --------
    >>> [f"{end * 1e6:g} µm" for end in material("PET").wavelength_range]
    ['0.4 µm', '19.942 µm']
    >>> n, k = material("Ge").index(0.6e-6)
    >>> print(f"{n:.3f} {k:.3f}")
    3.702 2.429
    """
    if names_file(name):
        return material_from_csv(name).with_extrapolation(extrapolation)
    if looks_like_page(name):
        return page_material(database_page(name)).with_extrapolation(extrapolation)
    found = canonical_name(name)
    if found in MEDIA:
        return MEDIA[found].with_extrapolation(extrapolation)
    known = vacuum() if found == VACUUM else _read(found)
    return known.with_extrapolation(extrapolation)


def material_names() -> list[str]:
    """Names of the materials in the library and of plug-ins.

    Returns
    -------
    list of str
    """
    load_plugins()
    return [*PAGES, *MEDIA]


@cache
def _read(name: str) -> Material:
    entry, segments = PAGES[name], []
    for page in entry.pages:
        text = (_FOLDER / "media" / page.file).read_text(encoding="utf-8")
        table = np.loadtxt(text.splitlines(), delimiter=",", skiprows=2)
        table = table[np.argsort(table[:, 0], kind="stable")].T  # pages may overlap within
        lookup: _Lookup = partial(_index_of, table)
        if entry.mat_fraction is not None:
            lookup = partial(_index_of_mat, lookup, entry.mat_fraction)
        shortest = max(float(table[0, 0]), page.shortest_um) * MICROMETRE
        longest = min(float(table[0, -1]), page.longest_um) * MICROMETRE
        source = f"{SITE} {page.shelf}/{page.book}/{page.page}"
        segments.append(Segment(shortest, longest, source, lookup))
    return Material(
        name=name,
        segments=tuple(segments),
        density=entry.density,
        density_source=entry.density_source,
        description=entry.description,
        tac=entry.tac,
        tac_source="" if entry.tac is None else TAC_SOURCE,
        remarks=(entry.remark,) if entry.remark else (),
    )


def _index_of(table: np.ndarray, wavelength: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Values of n and k by a table of wavelength [µm], n and k, linear between its points."""
    at, n, k = table
    return np.interp(wavelength / MICROMETRE, at, n), np.interp(wavelength / MICROMETRE, at, k)


def _index_of_mat(
    solid: _Lookup, fraction: float, wavelength: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Values of n and k of a mat of needles in vacuum."""
    n, k = solid(wavelength)
    pairs = np.stack([np.ones_like(n), n]), np.stack([np.zeros_like(k), k])
    found = maxwell_garnett(
        *pairs, np.array([1.0 - fraction, fraction]), np.array(Shape.MAT.factors)
    )
    return np.asarray(found[0]), np.asarray(found[1])


# --- mechanics ---

MECHANICS = ("modulus", "poisson", "expansion", "stress", "strength")  # as in data/mechanics.toml

_MECHANICS = tomllib.loads((_FOLDER / "mechanics.toml").read_text(encoding="utf-8"))


def mechanics_of(material: str) -> dict[str, Measured]:
    """Mechanical numbers of a material by its name, or by that of a page; empty if unknown."""
    entry = _mechanics(material)
    return {number: Measured(*entry[number]) for number in MECHANICS if number in entry}


def mechanics_source(material: str) -> str:
    """Where these numbers are from."""
    return str(_mechanics(material).get("source", ""))


def _mechanics(material: str) -> dict[str, Any]:
    name = material.split("/")[1] if looks_like_page(material) else material
    return _MECHANICS.get(name) or _MECHANICS.get(name.partition("-")[0], {})  # such as Ge-20nm
