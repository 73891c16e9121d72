"""``lightflyer materials``: the library of materials for layers, and the pages to search."""

import itertools
import re
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter
from rich.table import Table

from lightflyer.cli.options import Json
from lightflyer.cli.output import print_json, printer

if TYPE_CHECKING:
    from lightflyer.film.media.database import DatabasePage
    from lightflyer.film.media.medium import Medium

_GIGA = 1e-9
_SHOWN = 40  # pages that a search prints
_IN_FULL = 3  # materials and pages up to which it prints all that is known of them
_RANGE = 16  # characters of a range of wavelengths
_ELEMENT = re.compile(r"[A-Z][a-z]?")


def materials_command(
    *,
    search: Annotated[str | None, Parameter(consume_multiple=False)] = None,
    json_output: Json = False,
) -> None:
    """List the materials for layers, with wavelength range, density and source.

    Any page of refractiveindex.info is a material too, by its name shelf/book/page.

    Parameters
    ----------
    search
        List materials and pages that have all these words, such as "Cr", "germanium film" or
        "SiO2 Malitson": of formula, name, author or year.
    json_output
        Print one JSON object instead of a table.
    """
    from lightflyer.film.media.database import search_pages
    from lightflyer.film.media.library import material, material_names

    known = [material(name) for name in material_names()]
    described = [_describe(one) for one in known]
    pages: list[DatabasePage] = []
    if search is not None:
        found = search_pages(search)
        pages = sorted(found, key=lambda page: not _ELEMENT.fullmatch(page.formula.split()[0]))
        words, told = set(search.lower().split()), ("name", "description", "source")
        texts = (" ".join([*(one[key] for key in told), *one["other_names"]]) for one in described)
        found_in = [words <= set(re.split(r"[\s,/]+", text.lower())) for text in texts]
        described = [*itertools.compress(described, found_in)]
    if json_output:
        listed = {} if search is None else {"pages": [_page(page) for page in pages]}
        print_json({"materials": described} | listed)
        return
    console = printer()
    if search is not None and len(described) + len(pages) > _IN_FULL:
        # a line for each material of the package, then for each page, elements first
        shown = [*described, *map(_page, pages[:_SHOWN])]
        rows = Table(box=None, padding=(0, 1), show_header=False)
        longest = max(len(entry["name"]) for entry in shown)
        rows.add_column(style="bold", no_wrap=True, min_width=longest)  # it is typed
        rows.add_column(no_wrap=True, min_width=_RANGE)
        rows.add_column(no_wrap=True, overflow="ellipsis")
        for entry in shown:
            ends = "–".join(f"{end:.3g}" for end in entry["wavelength_range_um"])
            rows.add_row(entry["name"], f"{ends} µm", entry.get("title") or entry["description"])
        console.print(rows)
        left = len(pages[_SHOWN:])
        more = f"{left} more pages of refractiveindex.info have it: give more words; "
        console.print(
            f"{more * bool(left)}few are shown with sources and densities; --json has all"
        )
        return
    for entry in described:
        console.print(_table(entry))
    if search is not None:
        shown = [_page(page) for page in pages]
        width = max((len(entry["name"]) for entry in shown), default=0)
        for entry in shown:
            first, last = entry["wavelength_range_um"]
            rows = _rows(width)
            group = f" ({entry['group']})" if entry["group"] else ""
            rows.add_row(entry["name"], "what", f"{entry['formula']}{group}: {entry['title']}")
            parts = [f"{' and '.join(entry['quantities'])}, {first:.5g} µm to {last:.5g} µm"]
            if entry["temperature_K"] is not None:
                parts.append(f"{entry['temperature_K']:g} K")
            if entry["density_kg_m3"] is not None:
                parts.append(f"{entry['density_kg_m3'] / 1e3:g} g/cm³")
            parts += filter(None, (entry["direction"], entry["comments"]))
            rows.add_row("", "range", ", ".join(parts))
            rows.add_row("", "source", entry["reference"])
            console.print(rows)
        count = f"{len(pages)} page{'s' * (len(pages) > 1)} of refractiveindex.info"
        console.print(count if pages else f'no page of refractiveindex.info has "{search}"')
        return
    console.print('a page of refractiveindex.info works too: find it by --search "words"')
    console.print('a CSV file works too: material = "mine.csv", columns wavelength [um],n,k')


def _describe(one: "Medium") -> dict[str, Any]:
    from lightflyer.film.media.library import ALIASES, mechanics_of, mechanics_source
    from lightflyer.film.media.medium import MICROMETRE

    tac = getattr(one, "tac", None)
    return {
        "name": one.name,
        "other_names": [alias for alias, target in ALIASES.items() if target == one.name],
        "description": getattr(one, "description", ""),
        "wavelength_range_um": [end / MICROMETRE for end in one.wavelength_range],
        "density_kg_m3": one.density,
        "density_source": one.density_source,
        "tac": None if tac is None else tac.value,
        "tac_uncertainty": None if tac is None else tac.uncertainty,
        "tac_source": getattr(one, "tac_source", ""),
        "mechanics": {name: list(value) for name, value in mechanics_of(one.name).items()},
        "mechanics_source": mechanics_source(one.name),
        "source": one.source,
    }


def _page(page: "DatabasePage") -> dict[str, Any]:
    """What is known of a page, as JSON."""
    from lightflyer.film.media.database import page_details
    from lightflyer.film.media.medium import MICROMETRE

    details = page_details(page)
    return {
        "name": page.name,
        "formula": page.formula,
        "title": page.title,
        "group": page.group,
        "wavelength_range_um": [details.shortest / MICROMETRE, details.longest / MICROMETRE],
        "quantities": [name for name, has in (("n", details.has_n), ("k", details.has_k)) if has],
        "temperature_K": details.temperature,
        "density_kg_m3": details.density,
        "direction": details.direction,
        "comments": details.comments,
        "reference": details.reference,
    }


def _table(entry: dict[str, Any]) -> Table:
    first, last = entry["wavelength_range_um"]
    density, tac = entry["density_kg_m3"], entry["tac"]
    also = f" (also {', '.join(entry['other_names'])})" if entry["other_names"] else ""
    rows = _rows()
    rows.add_row(entry["name"], "what", f"{entry['description']}{also}")
    rows.add_row("", "range", f"{first:.5g} µm to {last:.5g} µm, {entry['source']}")
    known = "unknown" if density is None else f"{density / 1e3:g} g/cm³"
    rows.add_row("", "density", f"{known}; {entry['density_source']}")
    if tac is not None:
        rows.add_row("", "TAC", f"{tac:g} ± {entry['tac_uncertainty']:g}; {entry['tac_source']}")
    solid = (
        f"{name} {value * _GIGA:.3g} ± {spread * _GIGA:.2g} GPa"
        for name, (value, spread) in entry["mechanics"].items()
        if name in ("modulus", "stress", "strength")
    )
    if entry["mechanics"]:
        rows.add_row("", "solid", f"{', '.join(solid)}; {entry['mechanics_source']}")
    return rows


def _rows(width: int = 10) -> Table:
    rows = Table(box=None, padding=(0, 1), show_header=False)
    rows.add_column(width=width, style="bold")
    rows.add_column(width=8)
    rows.add_column(overflow="fold")
    return rows
