"""Figures for print: those of the package, and those that only the explorer has."""

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from lightflyer.comparison import compare
from lightflyer.core.errors import ConfigurationError
from lightflyer.explorer import jobs
from lightflyer.explorer.compute import prediction_of, uncertainty_of
from lightflyer.explorer.maps import Choices, payload_map
from lightflyer.explorer.state import Document, Workplace
from lightflyer.files.drawing import legend_below, new_figure, plain_decades, save
from lightflyer.files.palette import ORANGE, VERMILION

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMATS = ("png", "svg")  # Endings of figures that the page offers

Drawing = Callable[[Workplace, Document, Choices], "Figure"]


def figure_bytes(
    name: str, ending: str, workplace: Workplace, document: Document, choices: Choices
) -> bytes:
    """A figure of the page as a file for print; ``name``: one of :data:`DRAWINGS`."""
    if name not in DRAWINGS or ending not in FORMATS:
        raise ConfigurationError(f"there is no figure {name[:40]}.{ending[:10]}")
    figure = DRAWINGS[name](workplace, document, choices)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, f"{name}.{ending}")
        save(figure, [path])
        return path.read_bytes()


def _predict(panel: str) -> Drawing:
    def draw(workplace: Workplace, document: Document, _: Choices) -> "Figure":
        design = workplace.design(document)
        uncertainty = uncertainty_of(design)
        found: Figure = (
            prediction_of(design).plot(panel) if uncertainty is None else uncertainty.plot(panel)
        )
        return found

    return draw


def _mission(name: str) -> Drawing:
    def draw(workplace: Workplace, document: Document, _: Choices) -> "Figure":
        from lightflyer.mission.report.figures import mission_figures

        return mission_figures(jobs.flown(workplace, document)[1])[name]

    return draw


def _map(workplace: Workplace, document: Document, choices: Choices) -> "Figure":
    data = payload_map(workplace, document, choices)
    figure = new_figure()
    (axes,) = figure.axes
    cells = {name: np.array(column, float) for name, column in data["sources"]["cells"].items()}
    x, y = np.unique(cells["x"]), np.unique(cells["y"])
    values = cells["value"].reshape(x.size, y.size).T
    drawn = axes.pcolormesh(x, y, values, cmap="cividis", shading="nearest", rasterized=True)
    figure.colorbar(drawn, label=f"largest payload [{data['shown']}]")
    axes.set_xscale("log")
    plain_decades(axes.xaxis)
    if data["logarithmic"]:
        axes.set_yscale("log")
        plain_decades(axes.yaxis)
    axes.set(xlim=data["x"], ylim=data["y"], xlabel=data["labels"][0], ylabel=data["labels"][1])
    for source, marker, colour, label in (
        ("best", "*", ORANGE, "optimum"),
        ("here", "x", VERMILION, "this design"),
    ):
        place = data["sources"][source]
        axes.plot(place["x"], place["y"], marker, color=colour, ms=11, label=label)
    legend_below(axes)
    return figure


def _sensitivity(workplace: Workplace, document: Document, choices: Choices) -> "Figure":
    data = jobs.sensitivity(workplace, document, choices)
    bars = data["sources"]["bars"]
    figure = new_figure(height=1.2 + 0.3 * len(bars["name"]))
    (axes,) = figure.axes
    axes.barh(bars["name"], bars["value"], color=bars["colour"])
    axes.axvline(0.0, color="black", lw=0.8)
    axes.set_xlabel(data["labels"][0])
    return figure


DRAWINGS: dict[str, Drawing] = {
    "irradiance": _predict("irradiance"),
    "temperature": _predict("temperature"),
    "payload": _predict("payload"),
    "map": _map,
    "models": lambda workplace, document, _: compare(
        jobs.designs_by_model(workplace, document)[0], samples=0
    ).plot(),
    "film": lambda workplace, document, _: jobs.film_summary(workplace.design(document))[1].plot(),
    "sensitivity": _sensitivity,
    "mission": _mission("altitude"),
    "track": _mission("ground_track"),
}
"""Figures by the name that the page gives them."""
