"""The bands of a prediction in words, in tables and in its figures."""

import re
from typing import TYPE_CHECKING, Any

import numpy as np
from rich.table import Table

from lightflyer.files.palette import GREY
from lightflyer.files.result_text import NARROW, Parts, warning_lines, width_of, wrap

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from lightflyer.uncertainty.propagation import PredictionUncertainty

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

_OPACITY = 0.2
_HEADROOM = 1.1
_FAR = 1e9  # beyond every axis


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


def add_to_figures(figures: "dict[str, Figure]", uncertainty: "PredictionUncertainty") -> None:
    """Shade the 95 % bands around the lines of a prediction's figures."""
    irradiance, temperature = figures["levitation-irradiance"].axes[:2]
    payload = figures["payload"].axes[0]
    for panel, ax in (
        ("irradiance", irradiance),
        ("temperature", temperature),
        ("payload", payload),
    ):
        add_bands(panel, ax, uncertainty)


_BANDS = {
    "irradiance": {"needed to levitate": "levitation_irradiance"},
    "temperature": {"just levitating": "levitation_temperature", "available light": "temperature"},
    "payload": {"largest payload": "payload"},
}
"""By panel, the outputs that have bands, by the ends of their lines' labels."""


def add_bands(panel: str, ax: "Axes", uncertainty: "PredictionUncertainty") -> None:
    """Shade the 95 % bands around the lines of one panel; ``ax``: with that panel; changed."""
    from lightflyer.files.drawing import BAND, legend_below
    from lightflyer.prediction.figures import across, display_unit_at_best

    bands = _BANDS.get(panel, {})
    for label, output in bands.items():  # in the colour of the first line whose label ends so
        scale, _ = display_unit_at_best(uncertainty.prediction, output)
        low, high = uncertainty.low[output] * scale, uncertainty.high[output] * scale
        # a lower end without an upper one: some samples need more light than there is a number for
        ceiling = np.where(np.isfinite(low) & ~np.isfinite(high), _FAR, high)
        lines = (line for line in ax.get_lines() if str(line.get_label()).endswith(label))
        colour = next(lines).get_color()
        places = uncertainty.coordinate * across(uncertainty.prediction)
        ax.fill_between(places, low, ceiling, color=colour, alpha=_OPACITY, lw=0, zorder=0)
    if panel == "payload":
        scale, _ = display_unit_at_best(uncertainty.prediction, "payload")
        bottom, top = ax.get_ylim()
        highest = _HEADROOM * scale * float(np.nanmax(uncertainty.high["payload"]))
        ax.set_ylim(bottom, max(top, highest))
    if bands:
        # one entry for bands of several colours
        ax.fill_between([], [], [], color=GREY, alpha=2.0 * _OPACITY, lw=0, label=BAND)
        legend_below(ax)


def plot_uncertainty(
    uncertainty: "PredictionUncertainty", what: str | None = None, ax: "Axes | None" = None
) -> "Figure":
    """Draw a prediction with its 95 % bands."""
    from lightflyer.prediction.figures import panels

    figure, drawn = panels(uncertainty.prediction, what, ax)
    for panel, axes in drawn:
        add_bands(panel, axes, uncertainty)
    return figure
