"""The materials that the package knows: pages of n and k, densities and TACs, with their sources.

The pages are those of the refractiveindex.info database ([Polyanskiy2024]_, CC0); their tables are
in ``data/media``, which ``studies/library_media`` writes.
"""

import dataclasses
import difflib
import tomllib
from importlib import resources
from typing import Any

import numpy as np

from lightflyer.core.errors import ParameterError
from lightflyer.core.extras import load_plugins
from lightflyer.core.units import Measured
from lightflyer.film.media.medium import Medium


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


def _entry(pages: Any, tac: Any = None, names: Any = (), **others: Any) -> Entry:
    measured = None if tac is None else Measured(*tac)
    return Entry(
        pages=tuple(Page(**page) for page in pages), tac=measured, names=tuple(names), **others
    )


_DATA = (resources.files("lightflyer") / "data" / "materials.toml").read_text(encoding="utf-8")
PAGES = {name: _entry(**content) for name, content in tomllib.loads(_DATA).items()}
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
