"""Figures of drift, stability and swarms over altitude."""

from typing import TYPE_CHECKING

from matplotlib.figure import Figure

from lightflyer.files.display_units import suitable
from lightflyer.files.drawing import new_figure, plain_decades, wrap_label
from lightflyer.files.palette import BLUE, GREY

if TYPE_CHECKING:
    import xarray as xr

_PAIRS = (("fastest", "steepest"), ("longest_rod", "growth_rate"), ("count", "layer_radius"))
_WIDE = 30.0  # largest over smallest, from which on an axis is logarithmic


def plot_over_altitude(dataset: "xr.Dataset") -> Figure:
    """The two results over altitude that matter most."""
    figure = new_figure(columns=2, width=4.5, height=3.6)
    pair = next(pair for pair in _PAIRS if pair[0] in dataset)
    for axes, name in zip(figure.axes, pair, strict=True):
        factor, unit = suitable(dataset[name].units, dataset[name])
        values, words = factor * dataset[name], dataset[name].long_name
        axes.plot(dataset.altitude / 1e3, values, color=BLUE)
        if values.min() > 0.0 and values.max() > _WIDE * values.min():
            axes.set_yscale("log")
            plain_decades(axes.yaxis)
        else:
            axes.axhline(0.0, color=GREY, linewidth=0.8)
        axes.set(xlabel="altitude [km]", ylabel=wrap_label(f"{words} [{unit}]" if unit else words))
    return figure
