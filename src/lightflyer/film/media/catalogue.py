"""Materials by name: entries of the library, and pages of the database."""

from collections.abc import Callable
from functools import cache, partial
from importlib import resources

import numpy as np

from lightflyer.core.extras import load_plugins
from lightflyer.film.media.database import (
    SITE,
    database_page,
    looks_like_page,
    page_material,
)
from lightflyer.film.media.effective_media import Shape, maxwell_garnett
from lightflyer.film.media.library import (
    MEDIA,
    PAGES,
    TAC_SOURCE,
    VACUUM,
    Page,
    canonical_name,
)
from lightflyer.film.media.materials import Material, Segment, vacuum
from lightflyer.film.media.medium import MICROMETRE, Extrapolation, Medium

_Lookup = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]  # wavelength [m] to n and k


def material(name: str, *, extrapolation: Extrapolation | str = Extrapolation.ERROR) -> Medium:
    """A material by name; its tables are read once.

    Parameters
    ----------
    name : str
        Of the library, such as ``"Ge"``, ``"PET"`` or its other name ``"mylar"``; see
        :func:`material_names`. Or any page of refractiveindex.info, with the extra ``materials``,
        as shelf/book/page such as ``"main/Cr/Johnson"``; see
        :func:`~lightflyer.film.media.database.search_pages`. Or one that a plug-in adds.
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
    entry = PAGES[name]
    return Material(
        name=name,
        segments=tuple(_segment(page, entry.mat_fraction) for page in entry.pages),
        density=entry.density,
        density_source=entry.density_source,
        description=entry.description,
        tac=entry.tac,
        tac_source="" if entry.tac is None else TAC_SOURCE,
        remarks=(entry.remark,) if entry.remark else (),
    )


def _segment(page: Page, mat_fraction: float | None) -> Segment:
    file = resources.files("lightflyer") / "data" / "media" / page.file
    lines = file.read_text(encoding="utf-8").splitlines()
    table = np.loadtxt(lines, delimiter=",", skiprows=2)
    table = table[np.argsort(table[:, 0], kind="stable")].T  # pages may overlap within
    lookup: _Lookup = partial(_index_of, table)
    if mat_fraction is not None:
        lookup = partial(_index_of_mat, lookup, mat_fraction)
    return Segment(
        max(float(table[0, 0]), page.shortest_um) * MICROMETRE,
        min(float(table[0, -1]), page.longest_um) * MICROMETRE,
        f"{SITE} {page.shelf}/{page.book}/{page.page}",
        lookup,
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
