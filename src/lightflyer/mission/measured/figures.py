"""Figure of a comparison: both altitudes and the residuals, over time."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from lightflyer.files.drawing import LINES, new_figure, shared_legend
from lightflyer.files.palette import COMPUTED, GREY, MEASURED, PALETTE
from lightflyer.mission.measured.comparison import FIX
from lightflyer.mission.report.dataset import ELAPSED
from lightflyer.mission.report.figures import draw_over_time, shade_nights

if TYPE_CHECKING:
    import xarray as xr

_KILOMETRE = 1e3
_RESIDUALS = {"along": LINES[0], "across": LINES[1]}


def comparison_figure(flown: "xr.Dataset", compared: Sequence["xr.Dataset"]) -> Figure:
    """Draw a flight beside measured tracks.

    Parameters
    ----------
    flown : xarray.Dataset
        From :func:`lightflyer.fly`.
    compared : sequence of xarray.Dataset
        From :func:`lightflyer.mission.compare_track`, one for each track.

    Returns
    -------
    matplotlib.figure.Figure
    """
    figure = new_figure(width=8.0, height=7.5, rows=3)
    heights, vertical, ground = figure.axes
    handles = heights.plot(
        flown.time, flown.altitude / _KILOMETRE, color=COMPUTED, lw=2.5, label="flight"
    )
    colours = [MEASURED, *(one for one in PALETTE if one not in (COMPUTED, MEASURED))]
    last = float(flown[ELAPSED][-1])
    for number, whole in enumerate(compared):
        elapsed = whole.measured_elapsed
        one = whole.isel({FIX: ((elapsed >= 0.0) & (elapsed <= last)).values})
        colour, time = colours[number % len(colours)], one.measured_time
        name = _name_of(one) if len(compared) > 1 else "measured"
        style: dict[str, Any] = {"color": colour, "lw": 1.2}
        handles += heights.plot(time, one.measured_altitude / _KILOMETRE, label=name, **style)
        vertical.plot(time, one.altitude_residual / _KILOMETRE, **style)
        for part, line in _RESIDUALS.items():
            values = one[f"{part}_residual"] / _KILOMETRE
            ground.plot(time, values, ls=line, **style)
    for axes, label in ((vertical, "altitude"), (ground, "place")):
        axes.axhline(0.0, color=GREY, lw=0.8)
        axes.set_ylabel(f"{label}, measured\nless flown [km]")
    heights.set_ylabel("altitude [km]")
    for axes in figure.axes:
        shade_nights(axes, flown)
        draw_over_time(axes, flown)
    for axes in (heights, vertical):
        axes.set_xlabel("")
        axes.tick_params(labelbottom=False)
        axes.xaxis.get_offset_text().set_visible(False)
    handles += [
        Line2D([], [], color=MEASURED, ls=line, lw=1.2, label=f"place {part} the track")
        for part, line in _RESIDUALS.items()
    ]
    shared_legend(figure, [*handles, *heights.patches[:1]], most=3)
    return figure


def _name_of(compared: "xr.Dataset") -> str:
    return str(compared.attrs["source"]).replace("\\", "/").rpartition("/")[2]
