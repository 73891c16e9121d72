"""The bands of a prediction in words: lines and tables."""

import re
from typing import Any

from rich.table import Table

from lightflyer.files.result_text import NARROW, Parts, warning_lines, width_of, wrap

_UNITS = {
    "km": "km", "mg": "mg", "k": "K", "w_m2": "W/m²", "g_m2": "g/m²", "pa": "Pa", "h": "h",
    "un": "µN", "m_s": "m/s",
}  # fmt: skip
_GROUPS = {
    "verdict": "released",
    "verdict.rest": "at rest",
    "verdict.best": "best, the film surviving",
    "best": "peak of lift",
}
_ROUNDING = 1e-12
_OF_MODEL = re.compile(r"force\.\w+_error")  # inputs that are errors of the force model itself


def band_parts(uncertainty: dict[str, Any], width: int = NARROW) -> Parts:
    """The 95 % bands of all results but those asked for one by one, from a summary."""
    results, width = uncertainty["results"], min(width, NARROW)
    both = ["first order", "Monte Carlo"]
    kept = [*both, "samples"], both, ["Monte Carlo" if uncertainty["samples"] else "first order"]
    tables = [_bands_table(results, columns) for columns in kept]
    fitting = (table for table in tables if width_of(table).maximum <= width)
    yield next(fitting, tables[-1])
    yield wrap(f"from {sources_line(uncertainty)}", width)
    yield from (wrap(line, width) for line in warning_lines(uncertainty["warnings"]))


def sources_line(uncertainty: dict[str, Any], *, short: bool = False) -> str:
    """What the bands are from, by a summary; ``short``: without the names of the model's errors."""
    correlation = uncertainty["tac_correlation"]
    note = "" if correlation is None else f", TAC errors correlated by {correlation:g}"
    sources = []
    own = [name for name in uncertainty["inputs"] if _OF_MODEL.fullmatch(name)]
    stated = [name for name in uncertainty["inputs"] if name not in own]
    if stated:
        sources.append(f"the ± of {', '.join(stated)}{note}")
    if own:
        sources.append("the force model's own errors" + ("" if short else f" ({', '.join(own)})"))
    if uncertainty["between_bounds"]:
        names = ", ".join(uncertainty["between_bounds"])
        sources.append(f"the bounds of {names}")
    return ", and ".join(sources)


def _bands_table(results: dict[str, Any], columns: list[str]) -> Table:
    """Table of bands by some methods, and of the samples that have such a result."""
    table = Table(box=None, padding=(0, 1, 0, 0))  # so that it fits into 80 columns
    table.add_column("95 % band of", no_wrap=True)
    for heading in ("value", *columns):
        table.add_column(heading, justify="right", no_wrap=True)
    shown = ""
    for name, result in results.items():
        group, _, entry = name.rpartition(".")
        if name.startswith("at["):
            continue
        if group != shown:
            table.add_row(_in_words(group))
            shown = group
        sampled = result.get("monte_carlo")
        share = f"{100.0 * sampled['share_of_samples']:.0f} %" if sampled else "–"
        spans = {
            "first order": _span(result["first_order"], result["value"]),
            "Monte Carlo": _span(sampled, result["value"]),
            "samples": share,
        }
        cells = [f"{result['value']:.4g}", *(spans[column] for column in columns)]
        table.add_row(f"  {_in_words(entry)}", *cells)
    return table


def _in_words(name: str) -> str:
    """Name of a result without what JSON needs, as ``payload [mg]`` of ``payload_mg``."""
    name = _GROUPS.get(name, name.replace("verdict.", ""))
    for ending, unit in _UNITS.items():
        if name.endswith(f"_{ending}"):
            name = f"{name.removesuffix(f'_{ending}')} [{unit}]"
    return name.replace("_", " ")


def _span(band: dict[str, Any] | None, value: float) -> str:
    if band is None:
        return "–"
    if band["low"] is None:
        spread = band.get("standard_uncertainty")
        if spread is not None and spread < _ROUNDING * abs(value):
            spread = 0.0  # of what a limit fixes, such as the temperature that a film withstands
        return "–" if spread is None else f"± {spread:.3g}"
    high = "∞" if band["high"] is None else f"{band['high']:.4g}"
    return f"{band['low']:.4g} to {high}"
