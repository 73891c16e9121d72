"""Figures of a film: its spectra, what each layer absorbs, and both by angle."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, MultipleLocator, NullFormatter, StrMethodFormatter

from lightflyer.files.drawing import figure_for, legend_below, new_figure
from lightflyer.files.palette import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, YELLOW
from lightflyer.film.media.medium import MICROMETRE
from lightflyer.film.optics.spectra import SPECTRUM_RANGE, am0, planck

if TYPE_CHECKING:
    from lightflyer.film.angles import AngularSummary
    from lightflyer.film.summary import FilmSummary

_HEIGHT = 4.6  # [inch]
_TICKS_UM = (0.3, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0)
_SHOWN_TEMPERATURE = 300.0
_SHADED_HEIGHT = 0.45  # of a spectrum drawn behind the curves, over the height of the axes
_LAYER_COLOURS = (BLUE, ORANGE, GREEN, VERMILION, SKY, PURPLE, YELLOW, GREY)
_RIGHT_ANGLE = 90.0
_LINES = (("s", ":"), ("p", "--"), ("mean", "-"))
_MOST_TEMPERATURES = 4
_COLOURS = (SKY, BLUE, ORANGE, VERMILION)


def wavelength_axis(ax: Axes) -> None:
    """Make a horizontal axis that of the wavelengths, and the vertical one that of shares."""
    ax.set_xscale("log")
    ax.set_xlim(SPECTRUM_RANGE[0] / MICROMETRE, SPECTRUM_RANGE[1] / MICROMETRE)
    ax.xaxis.set_major_locator(FixedLocator(_TICKS_UM))
    ax.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.set_xlabel("wavelength [µm]")
    ax.set_ylim(0.0, 1.0)
    ax.grid(alpha=0.25)


def _shade(ax: Axes, wavelength: np.ndarray, shape: np.ndarray, label: str, colour: str) -> None:
    """Shade a spectrum per logarithm of wavelength, so that equal areas are equal powers."""
    per_log = wavelength * shape
    ax.fill_between(
        wavelength / MICROMETRE,
        _SHADED_HEIGHT * per_log / per_log.max(),
        color=colour,
        alpha=0.18,
        lw=0,
    )
    ax.plot([], [], color=colour, alpha=0.35, lw=6, label=label)


def _mark_extrapolated(ax: Axes, summary: "FilmSummary") -> None:
    """Hatch the wavelengths drawn at which a material has no data."""
    drawn = summary.wavelength[[0, -1]]
    data = summary.film.data_range
    label: str | None = "optical data extrapolated"
    for left, right in ((drawn[0], min(data[0], drawn[1])), (max(data[1], drawn[0]), drawn[1])):
        if right > left:
            ends = left / MICROMETRE, right / MICROMETRE
            ax.axvspan(*ends, facecolor="none", edgecolor=GREY, hatch="//", lw=0, alpha=0.4,
                       label=label)  # fmt: skip
            label = None


def draw_spectra(summary: "FilmSummary", ax: Axes) -> Axes:
    """Draw reflectance, transmittance and absorptance with the light and heat radiation."""
    for light, colour in dict(zip((summary.light, am0()), (SKY, ORANGE), strict=True)).items():
        inside = (light.wavelength > SPECTRUM_RANGE[0]) & (light.wavelength < SPECTRUM_RANGE[1])
        _shade(ax, light.wavelength[inside], light.irradiance[inside], light.name, colour)
    wide = np.geomspace(*SPECTRUM_RANGE, 400)
    hottest = float(summary.temperatures.max())
    for temperature, colour in ((_SHOWN_TEMPERATURE, GREY), (hottest, VERMILION)):
        label = f"black body, {temperature:g} K"
        _shade(ax, wide, planck(wide, temperature), label, colour)
    micrometres, optics = summary.wavelength / MICROMETRE, summary.optics
    _mark_extrapolated(ax, summary)
    ax.plot(micrometres, optics.reflectance, color=BLUE, ls="--", label="reflectance")
    ax.plot(micrometres, optics.transmittance, color=GREEN, ls="-.", label="transmittance")
    ax.plot(micrometres, optics.absorptance, color=VERMILION, label="absorptance")
    wavelength_axis(ax)
    ax.set_ylabel("share of light, normal incidence on top [1]\n(shaded: arbitrary height)")
    legend_below(ax)
    return ax


def draw_layers(summary: "FilmSummary", ax: Axes) -> Axes:
    """Draw the absorptance of each layer, stacked."""
    labels = [f"{layer.material.name}, {layer.thickness_text}" for layer in summary.film.layers]
    colours = [_LAYER_COLOURS[index % len(_LAYER_COLOURS)] for index in range(len(labels))]
    parts = summary.optics.layer_absorptance
    ax.stackplot(summary.wavelength / MICROMETRE, parts, labels=labels, colors=colours, lw=0)
    _mark_extrapolated(ax, summary)
    wavelength_axis(ax)
    ax.set_ylabel("absorptance, normal incidence on top [1]")
    legend_below(ax, title="layers, top to bottom")
    return ax


def film_figures(summary: "FilmSummary") -> dict[str, Figure]:
    """The figures of a film, by file name without suffix."""
    first, second = new_figure(height=_HEIGHT), new_figure(height=_HEIGHT)
    draw_spectra(summary, first.axes[0])
    draw_layers(summary, second.axes[0])
    return {"film-spectra": first, "film-layers": second}


def plot_film(summary: "FilmSummary", ax: Axes | None = None) -> Figure:
    """Draw a film."""
    if ax is None:
        figure = new_figure(columns=2, height=_HEIGHT)
        draw_layers(summary, figure.axes[1])
        ax = figure.axes[0]
    figure, ax = figure_for(ax)
    draw_spectra(summary, ax)
    return figure


# --- by angle ---


def _angle_axis(ax: Axes, label: str) -> None:
    ax.set_xlim(0.0, _RIGHT_ANGLE)
    ax.xaxis.set_major_locator(MultipleLocator(15.0))
    ax.set_xlabel("angle to the film's normal [°]")
    ax.set_ylabel(label)
    ax.set_ylim(bottom=0.0)
    ax.grid(alpha=0.25)


def draw_light(summary: "AngularSummary", ax: Axes) -> Axes:
    """Draw shares of the light over the angle, by polarisation."""
    degrees, light = np.degrees(summary.incidence), summary.lit.with_mean()
    colours = {"reflectance": BLUE, "transmittance": GREEN, "absorptance": VERMILION}
    if summary.film.is_rough:
        colours["scattered"] = PURPLE
    for name, colour in colours.items():
        for row, (_, line) in zip(light[name], _LINES, strict=True):
            ax.plot(degrees, row, color=colour, ls=line, label=name if line == "-" else None)
    _explain_lines(ax)
    _angle_axis(ax, f"share of {summary.light.name} [1]")
    ax.set_ylim(top=1.0)
    legend_below(ax)
    return ax


def draw_emittance(summary: "AngularSummary", ax: Axes) -> Axes:
    """Draw the directional emittance of the top over the angle, by polarisation."""
    degrees, emittance = np.degrees(summary.incidence), summary.thermal.with_mean()["absorptance"]
    count = len(summary.temperatures)
    shown = np.unique(np.linspace(0, count - 1, min(count, _MOST_TEMPERATURES)).astype(int))
    for number, colour in zip(shown, _COLOURS, strict=False):
        rows = emittance[..., number]
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
