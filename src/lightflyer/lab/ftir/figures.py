"""Figure of infrared spectra, with the spectrum of a black body."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lightflyer.files.drawing import legend_below, new_figure
from lightflyer.files.palette import GREY, ORANGE, PALETTE
from lightflyer.film.optics.spectra import planck
from lightflyer.lab.readers.interpretation import PER_CENTIMETRE

if TYPE_CHECKING:
    from lightflyer.lab.ftir.reduction import Ftir

_HEIGHT = 4.6
_RADIATION_HEIGHT = 0.35  # of the black body's curve, in heights of the axes
_MARGIN = 1.02  # height of the axes over the highest value
_MOST_POINTS = 20_000  # drawn of one spectrum
_TICKS_UM = np.array([0.2, 0.3, 0.4, 0.5, 0.7, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 7.0, 10.0, 15.0,
                      25.0])  # fmt: skip
_BETWEEN_TICKS = 0.045  # of the width of the axes, at least
_MICROMETRES_TIMES_PER_CENTIMETRE = 1e4


def spectra(
    result: "Ftir", ax: Axes, computed: Mapping[str, tuple[np.ndarray, np.ndarray]] | None = None
) -> Axes:
    """Draw spectra over wavenumber, the band, and the spectrum of a black body."""
    low, high = (end / PER_CENTIMETRE for end in result.band)
    ax.axvspan(
        low, high, color=ORANGE, alpha=0.15, lw=0, label=f"averaged over {low:g}–{high:g} cm⁻¹"
    )
    ends = [one.wavenumber[[0, -1]] for one in result.spectra]
    first, last = min(end[0] for end in ends), max(end[1] for end in ends)
    temperature = max(result.uncovered)
    at = np.maximum(np.linspace(first, last, 500), 1.0)
    radiation = planck(1.0 / at, temperature) / at**2
    ax.fill_between(
        at / PER_CENTIMETRE, _RADIATION_HEIGHT * radiation / radiation.max(), color=GREY, alpha=0.3,
        lw=0, label=f"black body, {temperature:g} K, arbitrary height",
    )  # fmt: skip
    drawn = [(one, "-") for one in result.spectra] + [(one, "-.") for one in result.reflectances]
    for number, (one, style) in enumerate(drawn):
        step = max(1, len(one.wavenumber) // _MOST_POINTS)
        ax.plot(one.wavenumber[::step] / PER_CENTIMETRE, one.value[::step], ls=style, lw=1,
                color=PALETTE[number % len(PALETTE)],
                label=f"{one.quantity}, {one.source}")  # fmt: skip
    wavenumber, value = result.emissivity_spectrum()
    step = max(1, len(wavenumber) // _MOST_POINTS)
    wavenumber, value = wavenumber[::step], value[::step]
    name = "emissivity" if result.reflectances else "1 − transmittance, bound of the emissivity"
    ax.plot(wavenumber / PER_CENTIMETRE, value, color=PALETTE[len(drawn) % len(PALETTE)], lw=1,
            label=name)  # fmt: skip
    for name, (wavenumber, value) in (computed or {}).items():
        style = "--" if name == "transmittance" else ":"
        ax.plot(wavenumber / PER_CENTIMETRE, value, color="black", ls=style, lw=1,
                label=f"{name}, computed")  # fmt: skip
    left, right = last / PER_CENTIMETRE, first / PER_CENTIMETRE
    ax.set_xlim(left, right)
    values = np.concatenate([one.value for one in (*result.spectra, *result.reflectances)])
    ax.set_ylim(min(0.0, values.min()), _MARGIN * max(1.0, values.max()))
    ax.set_xlabel("wavenumber [cm⁻¹]")
    ax.set_ylabel("fraction of the light [1]")
    ticks = _MICROMETRES_TIMES_PER_CENTIMETRE / _TICKS_UM
    shown = (ticks > min(left, right)) & (ticks < max(left, right))
    near = np.inf
    for place in np.flatnonzero(shown):  # the wavenumber falls
        shown[place] = near - ticks[place] >= _BETWEEN_TICKS * abs(right - left)
        near = ticks[place] if shown[place] else near
    top = ax.secondary_xaxis("top")
    top.set_xticks(ticks[shown], [f"{tick:g}" for tick in _TICKS_UM[shown]])
    top.set_xlabel("wavelength [µm]")
    legend_below(ax, most=2)
    return ax


def ftir_figures(
    result: "Ftir", computed: Mapping[str, tuple[np.ndarray, np.ndarray]] | None = None
) -> dict[str, Figure]:
    """Figure of spectra, by file name without suffix; ``computed``: see :func:`spectra`."""
    figure = new_figure(height=_HEIGHT)
    spectra(result, figure.axes[0], computed)
    return {"ftir": figure}
