"""Figures of fitted spectra: the fits with their residuals, and optical constants."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

from lightflyer.files import drawing
from lightflyer.files.palette import GREY, PALETTE
from lightflyer.film.media.medium import MICROMETRE
from lightflyer.lab.optics.data import ORDINATES

if TYPE_CHECKING:
    from lightflyer.lab.optics.fit import FittedSpectrum, OpticsFit

_HEIGHT = 4.6
_MOST_POINTS = 2000  # drawn of one spectrum
_MARKS = 35  # of its points that are marked, about
_LOGARITHMIC = 3.0  # ratio of wavelengths from which the axis is
_MANTISSAS = (1.0, 2.0, 3.0, 5.0, 7.0)


def spectra(result: "OpticsFit", ax: Axes) -> Axes:
    """Draw spectra over wavelength with what the instruments read by the fit."""
    for number, one in enumerate(result.spectra):
        colour = PALETTE[number % len(PALETTE)]
        x, fitted = _thinned_points(one, one.reading)
        ax.plot(x, fitted, ls=drawing.LINES[number % len(drawing.LINES)], lw=1.2, color=colour,
                label=one.measured.label)  # fmt: skip
        x, measured = _thinned_points(one, one.measured.spectrum.value, _MARKS)
        ax.plot(x, measured, "o", ms=3, mfc="none", mew=0.7, color=colour, zorder=3)
    ax.plot([], [], "o", ms=3, mfc="none", mew=0.7, color=GREY, label="measured, some points")
    ax.plot([], [], "-", lw=1.2, color=GREY, label="fitted")
    values = [part for one in result.spectra for part in (one.reading, one.measured.spectrum.value)]
    ax.set_ylim(min(0.0, *(one.min() for one in values)), max(one.max() for one in values) * 1.05)
    angles = any(one.measured.spectrum.quantity in ORDINATES for one in result.spectra)
    _axis(ax, f"fraction of the light{', or N, C, S' if angles else ''} [1]")
    drawing.legend_below(ax, most=2)
    return ax


def residuals(result: "OpticsFit", ax: Axes) -> Axes:
    """Draw measured less fitted ordinates over wavelength."""
    ax.axhline(0.0, color="black", lw=0.6)
    for number, one in enumerate(result.spectra):
        x, residual = _thinned_points(one, one.residual)
        colour = PALETTE[number % len(PALETTE)]
        label = f"{one.measured.label}: as {one.scatter.independent:.0f} independent points"
        ax.plot(
            x,
            residual,
            lw=0.8,
            ls=drawing.LINES[number % len(drawing.LINES)],
            color=colour,
            label=label,
        )
    _axis(ax, "measured − fitted [1]")
    drawing.legend_below(ax, most=1)
    return ax


def constants(result: "OpticsFit", n_ax: Axes, k_ax: Axes) -> None:
    """Draw n and k of the layers whose constants have fitted numbers, with bands."""
    for number, one in enumerate(result.indices):
        x, colour = one.wavelength / MICROMETRE, PALETTE[number % len(PALETTE)]
        pairs = ((n_ax, one.n, one.n_band), (k_ax, one.k, one.k_band))
        for ax, value, band in pairs:
            ax.plot(x, value, color=colour, label=one.name)
            ax.fill_between(x, *band, color=colour, alpha=0.25, lw=0, label=drawing.BAND)
    for ax, name in ((n_ax, "refractive index n [1]"), (k_ax, "extinction coefficient k [1]")):
        _axis(ax, name)
        drawing.legend_below(ax, most=2)


def _thinned_points(
    one: "FittedSpectrum", value: np.ndarray, most: int = _MOST_POINTS
) -> tuple[np.ndarray, np.ndarray]:
    step = max(1, len(value) // most)
    return one.measured.spectrum.wavelength[::step] / MICROMETRE, value[::step]


def _axis(ax: Axes, y: str) -> None:
    drawn = [
        line.get_xdata() for line in ax.get_lines() if len(np.atleast_1d(line.get_xdata())) > 2
    ]
    low, high = min(np.min(x) for x in drawn), max(np.max(x) for x in drawn)
    if high > _LOGARITHMIC * low:
        ax.set_xscale("log")
        ax.xaxis.set_major_locator(LogLocator(subs=_MANTISSAS))
        ax.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        ax.xaxis.set_minor_formatter(NullFormatter())
    ax.set_xlim(low, high)
    drawing.label_axes(ax, "wavelength [µm]", y)


def optics_figures(result: "OpticsFit") -> dict[str, Figure]:
    """Figures of a fit, by file name without suffix."""
    fits = drawing.new_figure(columns=2, height=_HEIGHT)
    spectra(result, fits.axes[0])
    residuals(result, fits.axes[1])
    if not result.indices:
        return {"optics": fits}
    index = drawing.new_figure(columns=2, height=_HEIGHT)
    constants(result, *index.axes)
    return {"optics": fits, "optics-constants": index}
