"""n and k of the library's materials, from their pages of refractiveindex.info.

    python studies/library_media/study.py

Writes one table for each page that ``data/materials.toml`` names into ``data/media``, row by row as
the page has it. Where a page has n and k at wavelengths of their own, the table has all of both
within the range that both cover, linear between the page's.
"""

from pathlib import Path

import numpy as np

from lightflyer.film.media.database import database_page, read_yaml
from lightflyer.film.media.library import PAGES

FOLDER = Path(__file__).parents[2] / "src" / "lightflyer" / "data" / "media"


def columns_of(data: list[dict[str, str]]) -> np.ndarray:
    """Wavelength [µm], n and k of the tables of a page, shape (m, 3)."""
    tables = {
        entry["type"].split()[1]: np.array(
            [row.split() for row in entry["data"].splitlines() if row.strip()], float
        )
        for entry in data
    }
    if "nk" in tables:
        return tables["nk"]
    n, k = tables["n"], tables["k"]
    both = np.union1d(n[:, 0], k[:, 0])
    both = both[(both >= max(n[0, 0], k[0, 0])) & (both <= min(n[-1, 0], k[-1, 0]))]
    return np.stack([both, np.interp(both, *n.T), np.interp(both, *k.T)], axis=1)


def main() -> None:
    """Write all tables."""
    FOLDER.mkdir(exist_ok=True)
    for entry in PAGES.values():
        for page in entry.pages:
            found = database_page(f"{page.shelf}/{page.book}/{page.page}")
            rows = columns_of(read_yaml(found.path)["DATA"])
            lines = [
                f"# refractiveindex.info {found.name}: {found.title} (CC0)",
                "wavelength [um],n,k",
                *(",".join(map(repr, row)) for row in rows.tolist()),
            ]
            (FOLDER / page.file).write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
