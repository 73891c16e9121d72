"""``lightflyer materials``: the library of materials for layers."""

from typing import Any

from rich.table import Table

from lightflyer.cli.options import Json
from lightflyer.cli.output import print_json, printer


def materials_command(*, json_output: Json = False) -> None:
    """List the materials for layers, with wavelength range, density and source.

    Parameters
    ----------
    json_output
        Print one JSON object instead of a table.
    """
    from lightflyer.film.catalogue import material, material_names
    from lightflyer.film.library import ALIASES
    from lightflyer.film.materials import MICROMETRE

    found = [material(name) for name in material_names()]
    described: list[dict[str, Any]] = [
        {
            "name": one.name,
            "other_names": [alias for alias, target in ALIASES.items() if target == one.name],
            "description": one.description,
            "wavelength_range_um": [end / MICROMETRE for end in one.wavelength_range],
            "density_kg_m3": one.density,
            "density_source": one.density_source,
            "tac": None if one.tac is None else one.tac.value,
            "tac_uncertainty": None if one.tac is None else one.tac.uncertainty,
            "tac_source": one.tac_source,
            "source": one.source,
        }
        for one in found
    ]
    if json_output:
        print_json({"materials": described})
        return
    console = printer()
    for entry in described:
        console.print(_table(entry))
    console.print('a CSV file works too: material = "mine.csv", columns wavelength [um],n,k')


def _table(entry: dict[str, Any]) -> Table:
    first, last = entry["wavelength_range_um"]
    density, tac = entry["density_kg_m3"], entry["tac"]
    also = f" (also {', '.join(entry['other_names'])})" if entry["other_names"] else ""
    rows = Table(box=None, padding=(0, 1), show_header=False)
    rows.add_column(width=10, style="bold")
    rows.add_column(width=8)
    rows.add_column(overflow="fold")
    rows.add_row(entry["name"], "what", f"{entry['description']}{also}")
    rows.add_row("", "range", f"{first:.5g} µm to {last:.5g} µm, {entry['source']}")
    known = "unknown" if density is None else f"{density / 1e3:g} g/cm³"
    rows.add_row("", "density", f"{known}; {entry['density_source']}")
    if tac is not None:
        rows.add_row("", "TAC", f"{tac:g} ± {entry['tac_uncertainty']:g}; {entry['tac_source']}")
    return rows
