"""Figures of a prediction: irradiance, temperature and payload over altitude or pressure."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lightflyer.core.errors import ParameterError
from lightflyer.core.units import scale_and_offset
from lightflyer.design.outputs import OUTPUTS, node_outputs
from lightflyer.files.drawing import (
    fade,
    figure_for,
    hatch,
    legend_below,
    new_figure,
    outline_effects,
    plain_decades,
)
from lightflyer.files.palette import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from lightflyer.flyer.base import AbstractThinFlyer
from lightflyer.prediction.evaluator import POINTS, Evaluator
from lightflyer.structure.figures import draw_cross_section

if TYPE_CHECKING:
    from lightflyer.prediction.prediction import Prediction

IRRADIANCE_SPAN = 30.0  # Upper limit of the axes over the least irradiance

_AROUND = 0.1  # of the searched range, drawn on each side of the best where nothing levitates
_HEADROOM = 0.15  # above the hottest temperature
_MARGIN = 20.0  # kelvins below the coldest
_RISE = 7.0  # of a text from its point [points]
_ROOM = 0.12  # of the range, drawn beyond the best
_WHOLE = 100.0  # W/m², from which on an irradiance is written without decimals
_BELOW = 0.4  # of the least irradiance, drawn below it
_WITH_LEGEND = 5.0  # height of a figure [inch]
_CUT = 3.0  # height of a figure of a flyer cut through [inch]
_ALONG = 201  # places along a film
_NODE_COLOURS = (ORANGE, SKY, PURPLE, GREEN)


def across(prediction: "Prediction") -> float:
    """Factor from the coordinate's SI unit to the one shown."""
    where = prediction.coordinate
    return scale_and_offset(where.unit, where.shown_unit)[0]


def display_unit_at_best(prediction: "Prediction", output: str) -> tuple[float, str]:
    """Factor from an output's SI unit, and the unit, that suit its value at the best."""
    return OUTPUTS[output].display_unit_for(prediction.best.values[output])


def closer(prediction: "Prediction") -> "Prediction":
    """The prediction with a finer table where it is drawn, for smooth curves."""
    low, high = (end / across(prediction) for end in _shown_range(prediction))
    spaced = np.geomspace if prediction.coordinate.logarithmic else np.linspace
    fine = spaced(low, high, POINTS)[1:-1]
    found = Evaluator(prediction.setup)(fine)
    coordinates, first = np.unique(
        np.concatenate([prediction.coordinates, fine]), return_index=True
    )
    table = {
        name: np.concatenate([values, found[name]])[first]
        for name, values in prediction.table.items()
    }
    drawn = replace(prediction, coordinates=coordinates, table=table)
    drawn.__dict__["verdict"] = prediction.verdict  # the figures show the one that is told
    return drawn


def _shown_range(prediction: "Prediction") -> tuple[float, float]:
    """Range worth drawing, in the unit shown: where flight takes not many times the light."""
    logarithmic = prediction.coordinate.logarithmic
    places, best = prediction.coordinates, prediction.best.coordinate
    if logarithmic:
        places, best = np.log(places), float(np.log(best))
    if prediction.easiest is not None:
        least = prediction.easiest.values["levitation_irradiance"]
        needed = prediction.table["levitation_irradiance"]
        # what warm gas lifts in the dark is drawn wherever light can lift it
        light = np.flatnonzero(needed < (IRRADIANCE_SPAN * least or np.inf))
        low, high = places[light[0]], places[light[-1]]
    else:
        around = _AROUND * (places[-1] - places[0])
        low, high = best - around, best + around
    if best < low:
        low = best - _ROOM * (high - best)
    elif best > high:
        high = best + _ROOM * (best - low)
    ends = np.clip([low, high], places[0], places[-1])
    low, high = across(prediction) * (np.exp(ends) if logarithmic else ends)
    return float(low), float(high)


def _write_at(
    prediction: "Prediction", ax: Axes, text: str, point: tuple[float, float], rise: float
) -> None:
    """Write above or below a point, in the units shown, within the axes."""
    ends, place = np.array(_shown_range(prediction)), point[0]
    if prediction.coordinate.logarithmic:
        ends, place = np.log(ends), float(np.log(place))
    share = (place - ends[0]) / np.ptp(ends)
    aside, aligned = 0.0, "center"
    if not _ROOM < share < 1.0 - _ROOM:
        aside, aligned = (abs(rise), "left") if share < _ROOM else (-abs(rise), "right")
    ax.annotate(
        text, point, (aside, rise), textcoords="offset points", ha=aligned,
        va="bottom" if rise > 0.0 else "top", fontsize="small",
    )  # fmt: skip


def _shade_bands(prediction: "Prediction", ax: Axes) -> None:
    """Shade where the flyer levitates, and hatch where its film does not survive that."""
    factor, usable = across(prediction), prediction.verdict.usable
    for index, (low, high) in enumerate(prediction.bands):
        label = "levitates in this light" if index == 0 else None
        ax.axvspan(factor * low, factor * high, color=GREEN, alpha=0.15, lw=0, label=label)
        inside = [edge for part in usable if low <= part[0] <= high for edge in part]
        ends = [low, *inside, high]
        for start, end in zip(ends[::2], ends[1::2], strict=True):
            if end > start:
                hatch(ax, factor * start, factor * end)


def _coordinate_axis(prediction: "Prediction", ax: Axes) -> None:
    where, places = prediction.coordinate, across(prediction) * prediction.coordinates
    # what is drawn where force model or gas are outside their ranges is faded
    outside = np.r_[False, prediction.table["covered"] < 1.0, False]
    middles = np.r_[places[0], 0.5 * (places[1:] + places[:-1]), places[-1]]
    for start, end in np.flatnonzero(np.diff(outside)).reshape(-1, 2):
        fade(ax, middles[start], middles[end])
    low, high = _shown_range(prediction)
    if where.logarithmic:
        ax.set_xscale("log")
        plain_decades(ax.xaxis)
    ax.set_xlim(low, high)
    ax.set_xlabel(f"{where.long_name.rpartition(' ')[2]} [{where.shown_unit}]")
    ax.grid(alpha=0.25, which="both" if where.logarithmic else "major")
    if where.name != "pressure":
        log_pressure = np.log10(prediction.table["pressure"])

        def to_log_pressure(x: Any) -> np.ndarray:
            return np.interp(x, places, log_pressure)

        def to_place(x: Any) -> np.ndarray:
            return np.interp(x, log_pressure[::-1], places[::-1])

        top = ax.secondary_xaxis("top", functions=(to_log_pressure, to_place))
        decades = np.arange(np.floor(log_pressure.min()), np.ceil(log_pressure.max()) + 1)
        ticks = np.add.outer(decades, np.log10([1.0, 3.0])).ravel()
        inside = (ticks > to_log_pressure(high)) & (ticks < to_log_pressure(low))
        top.set_xticks(ticks[inside], [f"{float(f'{10**tick:.1g}'):g}" for tick in ticks[inside]])
        top.set_xlabel("pressure [Pa]")


def irradiance(prediction: "Prediction", ax: Axes) -> Axes:
    """Draw the smallest irradiance that levitates the flyer, and what is available."""
    factor, available = across(prediction), prediction.available
    needed = prediction.table["levitation_irradiance"]
    _shade_bands(prediction, ax)
    shown = np.where(np.isfinite(needed), needed, np.nan)
    label = "needed to levitate" if prediction.easiest is not None else "_needed to levitate"
    ax.plot(factor * prediction.coordinates, shown, color=BLUE, label=label)
    ax.axhline(available, color=ORANGE, ls="--", label="available")
    ax.set_yscale("log")
    plain_decades(ax.yaxis)
    ax.set_ylabel("irradiance [W/m²]")
    _coordinate_axis(prediction, ax)
    low, high = _BELOW * available, IRRADIANCE_SPAN * available
    if prediction.easiest is None:
        ax.text(0.5, 0.6, "does not levitate", transform=ax.transAxes, ha="center")
    else:
        least = prediction.easiest.values["levitation_irradiance"]
        point = factor * prediction.easiest.coordinate
        ax.plot(point, least, "o", color=BLUE, ms=5)
        light = f"{least:.0f}" if least >= _WHOLE else f"{least:.3g}"
        where = f"{light} W/m²\nat {point:.3g} {prediction.coordinate.shown_unit}"
        _write_at(prediction, ax, where, (point, least), -_RISE)
        low, high = _BELOW * min(least, available), IRRADIANCE_SPAN * max(least, available) / 2.0
    if low > 0.0:
        ax.set_ylim(low, high)
    else:  # which no logarithmic axis can show
        ax.set_yscale("linear")
        ax.set_ylim(0.0, 2.0 * available)
    legend_below(ax)
    return ax


def temperature(prediction: "Prediction", ax: Axes) -> Axes:
    """Draw the flyer's temperatures, in the available light and when it just levitates."""
    places, table = across(prediction) * prediction.coordinates, prediction.table
    nodes = node_outputs(prediction.setup.flyer)
    _shade_bands(prediction, ax)
    hottest_label = "hottest part" if nodes else "flyer"
    label = f"{hottest_label}, available light"
    # a part of the flyer is the hottest one and drawn over it
    (line,) = ax.plot(places, table["temperature"], color=VERMILION, label=label)
    if nodes:
        line.set(lw=4.0, alpha=0.45)
    for colour, name in zip(_NODE_COLOURS, nodes, strict=False):
        words = name.removeprefix("temperature_").replace("_", " ")
        ax.plot(places, table[name], color=colour, ls="--", label=f"{words}, available light")
    label = f"{hottest_label}, just levitating"
    if prediction.easiest is None:
        label = f"_{label}"  # no light lifts it: the curve and its entry are empty
    ax.plot(places, table["levitation_temperature"], color=BLUE, ls="-.", label=label)
    ax.plot(places, table["gas_temperature"], color=GREY, ls=":", label="gas")
    low, high = _shown_range(prediction)
    shown = (places >= low) & (places <= high)
    coldest, hottest = table["gas_temperature"][shown].min(), table["temperature"][shown].max()
    if prediction.easiest is not None:
        hottest = max(hottest, prediction.easiest.values["levitation_temperature"])
    limit = prediction.verdict.highest_temperature
    if limit is not None:
        hottest = max(hottest, limit)
        ax.axhline(limit, color=VERMILION, lw=0.8, ls="--", label=f"film withstands {limit:.0f} K")
    ax.set_ylim(coldest - _MARGIN, hottest + _HEADROOM * (hottest - coldest))
    ax.set_ylabel("temperature [K]")
    _coordinate_axis(prediction, ax)
    legend_below(ax)
    return ax


def payload(prediction: "Prediction", ax: Axes) -> Axes:
    """Draw the largest payload, with the relative payload on the right."""
    factor, (scale, unit) = across(prediction), display_unit_at_best(prediction, "payload")
    place = prediction.verdict.best or prediction.best
    values = place.values
    best, point = values["payload"] * scale, factor * place.coordinate
    own_mass = float(prediction.setup.flyer.own_mass) * scale
    _shade_bands(prediction, ax)
    places, payloads = factor * prediction.coordinates, prediction.table["payload"] * scale
    ax.plot(places, payloads, color=BLUE, label="largest payload")
    ax.plot(point, best, "o", color=BLUE, ms=5)
    where = f"{best:.3g} {unit}\nat {point:.3g} {prediction.coordinate.shown_unit}"
    _write_at(prediction, ax, where, (point, best), _RISE)
    ax.axhline(0.0, color=GREY, lw=0.8)
    low = min(0.0, best) - 0.35 * max(abs(best), 0.3 * own_mass)
    highest = prediction.best.values["payload"] * scale
    ax.set_ylim(low, highest + 0.3 * (highest - low))
    ax.set_ylabel(f"largest payload [{unit}]")

    def relative(mass: Any) -> Any:
        return mass / own_mass

    def absolute(ratio: Any) -> Any:
        return ratio * own_mass

    right = ax.secondary_yaxis("right", functions=(relative, absolute))
    right.set_ylabel("relative payload [own mass]")
    _coordinate_axis(prediction, ax)
    legend_below(ax)
    return ax


def temperature_map(prediction: "Prediction", ax: Axes) -> Axes:
    """Draw the flyer's temperature over pressure and irradiance, with the levitation curve."""
    found, factor, where = prediction.map, across(prediction), prediction.coordinate
    assert found is not None  # the caller has looked
    image = ax.contourf(
        factor * found.coordinate,
        found.irradiance,
        found.temperature.T,
        levels=24,
        cmap="cividis",
    )
    ax.figure.colorbar(image, ax=ax, label="flyer temperature [K]")
    needed = prediction.table["levitation_irradiance"]
    places = factor * prediction.coordinates
    shown = np.where(np.isfinite(needed), needed, np.nan)
    for label, drawn, style in (
        ("least irradiance that levitates the flyer", shown, "-"),
        ("available light", np.full(places.shape, prediction.available), "--"),
    ):
        ax.plot(places, drawn, ls=style, color="white", lw=1.8, label=label,
                path_effects=outline_effects())  # fmt: skip
    if where.logarithmic:
        ax.set_xscale("log")
        plain_decades(ax.xaxis)
    ax.set_xlim(places[0], places[-1])
    ax.set_ylim(found.irradiance[0], found.irradiance[-1])
    ax.set_xlabel(f"{where.long_name.rpartition(' ')[2]} [{where.shown_unit}]")
    ax.set_ylabel("irradiance [W/m²]")
    legend_below(ax)
    return ax


def shape(prediction: "Prediction", ax: Axes) -> Axes:
    """Draw a thin flyer cut through its middle, to scale, where it carries most."""
    flyer, place = prediction.setup.flyer, prediction.verdict.best or prediction.best
    assert isinstance(flyer, AbstractThinFlyer)  # the caller has looked
    nodes = node_outputs(flyer) or ("temperature",)
    state = prediction.setup.environment.state(place.coordinate)
    places = np.linspace(0.0, float(flyer.radius), _ALONG)
    temperatures: tuple[Any, ...] = tuple(place.values[name] for name in nodes)
    bent = flyer.bent(state, temperatures)
    curvature, droops = float(bent.curl.largest), np.array(bent.cut(places))
    hangs = float(bent.plate.ring) if float(flyer.payload) else None
    gap = float(getattr(flyer, "gap", getattr(flyer, "height", 0.0)))
    return draw_cross_section(
        ax, places, curvature, droops, gap=gap, hanging=hangs, one_side=bent.plate.at_three_points
    )


PANELS: "dict[str, Callable[[Prediction, Axes], Axes]]" = {
    "irradiance": irradiance,
    "temperature": temperature,
    "payload": payload,
    "map": temperature_map,
    "shape": shape,
}
"""What can be drawn of a prediction, by name."""


def panels(
    prediction: "Prediction", what: str | None, ax: Axes | None
) -> tuple[Figure, Iterator[tuple[str, Axes]]]:
    """A figure with some of :data:`PANELS` drawn, and which of its axes shows what."""
    absent = {
        "map": prediction.map is None,
        "shape": "deflection" not in prediction.setup.flyer.known_shape,
    }
    there = [name for name in PANELS if not absent.get(name, False)]
    if what is not None and what not in there:
        raise ParameterError(f'plot: what = "{what}": choose from {", ".join(there)}')
    if what is None and ax is not None:
        raise ParameterError(f"plot: axes hold one panel: say what, one of {', '.join(there)}")
    prediction = closer(prediction)
    if what is None:
        rows = -(-len(there) // 2)
        figure = new_figure(columns=2, rows=rows, height=rows * _WITH_LEGEND)
        chosen = list(zip(there, figure.axes, strict=False))
        for spare in figure.axes[len(there) :]:
            spare.remove()
    else:
        figure, ax = figure_for(ax, height=_WITH_LEGEND)
        chosen = [(what, ax)]
    for name, axes in chosen:
        PANELS[name](prediction, axes)
    return figure, iter(chosen)


def plot_prediction(
    prediction: "Prediction", what: str | None = None, ax: Axes | None = None
) -> Figure:
    """Draw a prediction; ``what``: one of :data:`PANELS`; by default all that there are."""
    figure, _ = panels(prediction, what, ax)
    return figure


def prediction_figures(prediction: "Prediction") -> dict[str, Figure]:
    """The figures of a prediction, by file name without suffix."""
    prediction = closer(prediction)
    both, carried = new_figure(columns=2, height=_WITH_LEGEND), new_figure(height=_WITH_LEGEND)
    left, right = both.axes
    irradiance(prediction, left)
    temperature(prediction, right)
    payload(prediction, carried.axes[0])
    figures = {"levitation-irradiance": both, "payload": carried}
    if prediction.map is not None:
        figures["temperature-map"] = new_figure(height=_WITH_LEGEND)
        temperature_map(prediction, figures["temperature-map"].axes[0])
    if "deflection" in prediction.setup.flyer.known_shape:
        figures["shape"] = new_figure(height=_CUT)
        shape(prediction, figures["shape"].axes[0])
    return figures
