"""Figures of a film by angle: shares of light, emittance, and absorptance over the spectrum."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from lightflyer.files.drawing import legend_below, new_figure
from lightflyer.files.palette import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from lightflyer.film.media.medium import MICROMETRE
from lightflyer.film.optics.angles import with_mean
from lightflyer.film.report.figures import wavelength_axis

if TYPE_CHECKING:
    from lightflyer.film.report.angular_summary import AngularSummary

_HEIGHT = 4.6  # [inch]
_RIGHT_ANGLE = 90.0
_LINES = (("s", ":"), ("p", "--"), ("mean", "-"))
_MOST_TEMPERATURES = 4
_COLOURS = (SKY, BLUE, ORANGE, VERMILION)


def _angle_axis(ax: Axes, label: str) -> None:
    ax.set_xlim(0.0, _RIGHT_ANGLE)
    ax.xaxis.set_major_locator(MultipleLocator(15.0))
    ax.set_xlabel("angle to the film's normal [°]")
    ax.set_ylabel(label)
    ax.set_ylim(bottom=0.0)
    ax.grid(alpha=0.25)


def draw_light(summary: "AngularSummary", ax: Axes) -> Axes:
    """Draw shares of the light over the angle, by polarisation."""
    degrees = np.degrees(summary.incidence)
    colours = {"reflectance": BLUE, "transmittance": GREEN, "absorptance": VERMILION}
    if summary.film.is_rough:
        colours["scattered"] = PURPLE
    for name, colour in colours.items():
        for row, (_, line) in zip(with_mean(getattr(summary.lit, name)), _LINES, strict=True):
            ax.plot(degrees, row, color=colour, ls=line, label=name if line == "-" else None)
    _explain_lines(ax)
    _angle_axis(ax, f"share of {summary.light.name} [1]")
    ax.set_ylim(top=1.0)
    legend_below(ax)
    return ax


def draw_emittance(summary: "AngularSummary", ax: Axes) -> Axes:
    """Draw the directional emittance of the top over the angle, by polarisation."""
    degrees = np.degrees(summary.incidence)
    count = len(summary.temperatures)
    shown = np.unique(np.linspace(0, count - 1, min(count, _MOST_TEMPERATURES)).astype(int))
    for number, colour in zip(shown, _COLOURS, strict=False):
        rows = with_mean(summary.thermal.absorptance[..., number])
        label = f"{summary.temperatures[number]:g} K"
        for row, (_, line) in zip(rows, _LINES, strict=True):
            ax.plot(degrees, row, color=colour, ls=line, label=label if line == "-" else None)
    _explain_lines(ax)
    _angle_axis(ax, "directional emittance of the top [1]")
    legend_below(ax)
    return ax


def _explain_lines(ax: Axes) -> None:
    for name, line in _LINES:
        label = "mean of both" if name == "mean" else f"{name} polarisation"
        ax.plot([], [], color=GREY, ls=line, label=label)


def draw_map(summary: "AngularSummary", ax: Axes) -> Axes:
    """Draw the absorptance of unpolarised light over wavelength and angle."""
    degrees = np.degrees(summary.incidence)
    values = np.asarray(summary.spectral_shares.absorptance).mean(axis=0)
    order = np.argsort(degrees)
    mesh = ax.pcolormesh(
        summary.wavelength / MICROMETRE, degrees[order], values[order], vmin=0.0,
        cmap="cividis", shading="gouraud", rasterized=True,
    )  # fmt: skip
    wavelength_axis(ax)
    ax.grid(visible=False)
    ax.set_xlim(*(summary.wavelength[[0, -1]] / MICROMETRE))
    ax.set_ylim(degrees.min(), degrees.max())
    ax.yaxis.set_major_locator(MultipleLocator(15.0))
    ax.set_ylabel("angle to the film's normal [°]")
    figure = ax.get_figure()
    assert figure is not None
    figure.colorbar(mesh, ax=ax, label="absorptance, mean of both polarisations [1]")
    return ax


def draw_angles(summary: "AngularSummary") -> Figure:
    """Draw shares of the light, and the emittance, side by side."""
    figure = new_figure(columns=2, height=_HEIGHT)
    draw_light(summary, figure.axes[0])
    draw_emittance(summary, figure.axes[1])
    return figure


def angle_figures(summary: "AngularSummary") -> dict[str, Figure]:
    """The figures of a film by angle, by file name without suffix."""
    found = {"film-angles": draw_angles(summary)}
    if np.unique(summary.incidence).size > 1:
        found["film-angles-map"] = new_figure(height=_HEIGHT)
        draw_map(summary, found["film-angles-map"].axes[0])
    return found
