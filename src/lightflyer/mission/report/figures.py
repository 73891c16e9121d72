"""Figures of missions, swarms and what is found over altitude."""

import itertools
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.dates import AutoDateLocator, ConciseDateFormatter
from matplotlib.figure import Figure

from lightflyer.environment.planet import EARTH_PLANET
from lightflyer.files.display_units import suitable
from lightflyer.files.drawing import (
    INTERVAL,
    LINES,
    legend_below,
    new_figure,
    plain_decades,
    wrap_label,
)
from lightflyer.files.palette import BLUE, GREY, ORANGE, PALETTE, SKY, VERMILION
from lightflyer.files.table import shipped_table
from lightflyer.mission.areas import describe_place
from lightflyer.mission.path.motion import ELAPSED
from lightflyer.mission.report.ground import RECEIVER
from lightflyer.mission.report.landing import Landings, landings_of, outline_in_map
from lightflyer.mission.report.summary import day_and_night
from lightflyer.mission.report.text import square_kilometres

if TYPE_CHECKING:
    import xarray as xr


MOST_LINES = 100  # tracks of an ensemble that are drawn one by one

_NIGHT = "#D8DCE6"
_KILOMETRE = 1e3
_INTERVAL = (2.5, 97.5)
_FEWEST_FLYING = 10  # members below which their interval says nothing
_LEAST_VIEW = 20.0  # degrees of a map's width and height
_MOST_NAMED = 16  # launches in a legend
_WORLD = 300.0  # degrees of a map's width from which on the whole world is drawn
_MARGIN = 1.2
_ENDS = "", "_low", "_high"  # of the names of a share and its interval
_LABEL = 30  # characters of a line in a legend
_QUARTER_TURN, _HALF_TURN, _TURN = 90.0, 180.0, 360.0
_FLATTEST = 0.2  # cosine of the latitude beyond which a map is not stretched further


def mission_figures(dataset: "xr.Dataset") -> dict[str, Figure]:
    """Figures of a mission; by file name without ending."""
    figures = {
        "altitude": _altitude(dataset),
        "ground_track": _ground_track(dataset),
        "flight": _flight(dataset),
    }
    if "ensemble_flying" in dataset:
        figures["survival"] = _survival(dataset)
    if "station_distance" in dataset:
        figures["station"] = _station(dataset)
    if RECEIVER in dataset.dims:
        figures["telemetry"] = _telemetry(dataset)
    if "launch_altitude" in dataset:
        figures["launches"] = _launches(dataset)
    landings = landings_of(dataset)
    if landings is not None and landings.landed.any():
        figures["landing"] = _landing(dataset, landings)
    return figures


def plot_spread(dataset: "xr.Dataset") -> Figure:
    """Shares of a swarm that still fly, and that are inside areas, over time."""
    figure, axes = _over_time(dataset)
    shares = {"still aloft": [dataset["flying" + end].values for end in _ENDS]}
    for number, area in enumerate(dataset.area.values if "area" in dataset.coords else ()):
        shares[str(area)] = [dataset["inside" + end].values[number] for end in _ENDS]
    looks = zip(itertools.cycle(PALETTE), itertools.cycle(LINES), strict=False)
    for (name, values), (colour, line) in zip(shares.items(), looks, strict=False):
        share, low, high = 100.0 * np.array(values)
        label = wrap_label(name, _LABEL)
        axes.plot(dataset.time.values, share, color=colour, ls=line, label=label)
        axes.fill_between(dataset.time.values, low, high, color=colour, alpha=0.2, lw=0.0)
    axes.set_ylim(0.0, 105.0)
    axes.set_ylabel(f"share of {int(dataset.members)} members [%]")
    figure.legend(title=f"shaded: {INTERVAL}", fontsize="small", loc="outside right upper")
    return figure


def _altitude(dataset: "xr.Dataset") -> Figure:
    figure, axes = _over_time(dataset, nights=True)
    time = dataset.time.values
    if "ensemble_altitude" in dataset:
        _draw_spread(axes, time, dataset.ensemble_altitude.values / _KILOMETRE)
    axes.plot(time, dataset.altitude / _KILOMETRE, color=BLUE, label="flyer as stated")
    end = time[0] + np.timedelta64(round(float(dataset.end_elapsed) * 1e9), "ns")
    altitude = float(dataset.end_altitude) / _KILOMETRE
    axes.plot(end, altitude, "o", color=VERMILION, label=f"end: {dataset.attrs['end']}")
    axes.set_ylabel("altitude [km]")
    legend_below(axes)
    return figure


def _flight(dataset: "xr.Dataset") -> Figure:
    """Lift over weight, light and temperature over time."""
    figure, _ = _over_time(dataset, 3, nights=True, height=7.0)
    time = dataset.time.values
    lift, light, heat = figure.axes
    lift.axhline(1.0, color=GREY, linewidth=0.8)
    lift.plot(time, dataset.lift_over_weight, color=BLUE)
    lift.set_ylabel("lift / weight")
    light.plot(time, dataset.irradiance, color=ORANGE, label="light there is")
    if "light_share" in dataset:
        let_in = dataset.irradiance * dataset.light_share
        light.plot(time, let_in, color=GREY, linestyle="--", label="let in")
        light.legend(fontsize="small")
    light.set_ylim(bottom=0.0)
    light.set_ylabel("light [W/m²]")
    heat.plot(time, dataset.temperature, color=VERMILION, label="flyer")
    heat.plot(time, dataset.gas_temperature, color=GREY, linestyle="--", label="gas")
    heat.set_ylabel("temperature [K]")
    for axes in (lift, light):
        axes.set_xlabel("")
        axes.tick_params(labelbottom=False)
        axes.xaxis.get_offset_text().set_visible(False)
    legend_below(heat)
    return figure


def _ground_track(dataset: "xr.Dataset") -> Figure:
    figure = new_figure(width=8.0, height=4.6)
    (axes,) = figure.axes
    view = map_view(dataset)
    for line in shores(dataset):
        axes.plot(*line, color=GREY, linewidth=0.6)
    if "ensemble_longitude" in dataset:
        tracks = zip(
            dataset.ensemble_longitude.values[:MOST_LINES],
            dataset.ensemble_latitude.values[:MOST_LINES],
            strict=True,
        )
        for longitude, latitude in tracks:
            axes.plot(*view.line(longitude, latitude), color=SKY, linewidth=0.4)
        axes.plot(
            view.points(dataset.ensemble_end_longitude.values),
            dataset.ensemble_end_latitude.values,
            ".",
            color=ORANGE,
            markersize=3.0,
            label="ends of the ensemble",
        )
    longitude, latitude = dataset.longitude.values, dataset.latitude.values
    axes.plot(*view.line(longitude, latitude), color=BLUE, label="flyer as stated")
    axes.plot(view.points(longitude[:1]), latitude[:1], "^", color=BLUE, label="release")
    end = view.points(np.array([float(dataset.end_longitude)]))
    axes.plot(end, float(dataset.end_latitude), "o", color=VERMILION, label="end")
    axes.set_xlim(view.west, view.east)
    axes.set_ylim(view.south, view.north)
    middle = np.cos(np.radians(0.5 * (view.south + view.north)))
    axes.set_aspect(1.0 / max(middle, _FLATTEST), adjustable="box")
    axes.set_xlabel("longitude [°]")
    axes.set_ylabel("latitude [°]")
    legend_below(axes)
    return figure


def _survival(dataset: "xr.Dataset") -> Figure:
    figure, axes = _over_time(dataset, nights=True)
    flying = np.isfinite(dataset.ensemble_altitude.values).mean(axis=0)
    axes.step(dataset.time.values, 100.0 * flying, where="post", color=BLUE)
    axes.set_ylim(0.0, 105.0)
    axes.set_ylabel("share still aloft [%]")
    return figure


def _station(dataset: "xr.Dataset") -> Figure:
    """Distance from a place near which the flyer is to stay."""
    figure, axes = _over_time(dataset, nights=True)
    time = dataset.time.values
    if "ensemble_station_distance" in dataset:
        _draw_spread(axes, time, dataset.ensemble_station_distance.values / _KILOMETRE)
    axes.plot(time, dataset.station_distance / _KILOMETRE, color=BLUE, label="flyer as stated")
    radius = dataset.attrs["station_radius_km"]
    axes.axhline(radius, color=GREY, linestyle="--", label=dataset.attrs["station"])
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel("distance from the station's\nmiddle [km]")
    legend_below(axes)
    return figure


def _telemetry(dataset: "xr.Dataset") -> Figure:
    """Margin of the radio link, or elevation without a link, while receivers see the flyer."""
    name, label = "margin", "margin of the link while\nin sight [dB]"
    if f"{RECEIVER}_{name}" not in dataset:
        name, label = "elevation", "elevation while\nin sight [deg]"
    figure, axes = _over_time(dataset, nights=True)
    shown = dataset[f"{RECEIVER}_{name}"].where(
        dataset.receiver_elevation >= dataset.receiver_lowest_elevation
    )
    for colour, line in zip(_colours(shown.sizes[RECEIVER]), shown, strict=True):
        axes.plot(dataset.time.values, line, color=colour, label=str(line[RECEIVER].item()))
    axes.axhline(0.0, color=GREY, linestyle="--")
    axes.set_ylabel(label)
    legend_below(axes)
    return figure


def _launches(dataset: "xr.Dataset") -> Figure:
    """Altitude over time since each release."""
    figure = new_figure(width=8.0)
    (axes,) = figure.axes
    hours = dataset[ELAPSED].values / 3600.0
    delays = dataset.launch_delay.values / 3600.0
    colours = _colours(len(delays))
    for delay, line, colour in zip(delays, dataset.launch_altitude.values, colours, strict=True):
        axes.plot(hours, line / _KILOMETRE, color=colour, label=f"+{delay:.4g} h")
    axes.set_xlabel("time since the release [h]")
    axes.set_ylabel("altitude [km]")
    if len(delays) <= _MOST_NAMED:
        figure.legend(title="released", fontsize="small", loc="outside right upper")
    return figure


def _landing(dataset: "xr.Dataset", landings: Landings) -> Figure:
    """Landings and the areas that hold shares of them, in an equal-area map."""
    figure = new_figure(width=8.0, height=6.0)
    (axes,) = figure.axes
    release = landings.map.plane(dataset.latitude.values[:1], dataset.longitude.values[:1])
    drawn = [landings.points, release]
    axes.plot(*landings.points.T / _KILOMETRE, ".", color=ORANGE, ms=4.0, label="landings")
    for area, line in zip(landings.areas, LINES, strict=False):
        drawn.append(outline_in_map(area))
        low, size, high = (square_kilometres(one / 1e6) for one in (area.low, area.size, area.high))
        label = f"{100.0 * area.share:.0f} % land here: {size} km²\n({low} to {high})"
        axes.plot(*drawn[-1].T / _KILOMETRE, color=BLUE, ls=line, label=label)
    axes.plot(*release.T / _KILOMETRE, "^", color=VERMILION, label="release")
    low, high = (edge(np.concatenate(drawn), axis=0) / _KILOMETRE for edge in (np.min, np.max))
    room = 0.5 * _MARGIN * max(*(high - low), 1.0)
    edges = np.array([-room, room]) + 0.5 * (low + high)[:, None]
    axes.set(xlim=edges[0], ylim=edges[1])
    axes.set_aspect("equal", adjustable="box")
    for longitude, latitude in shores(dataset)[:1]:
        shore = landings.map.plane(latitude, longitude) / _KILOMETRE
        axes.plot(*shore.T, color=GREY, lw=0.6, zorder=0)
    (latitude,), (longitude,) = landings.map.places(np.zeros((1, 2)))
    middle = describe_place(round(float(latitude), 2), round(float(longitude), 2))
    axes.set_xlabel(f"east of {middle} [km]")
    axes.set_ylabel("north of it [km]")
    legend_below(axes, most=2)
    return figure


def _colours(count: int) -> list[Any]:
    from matplotlib import colormaps

    return [colormaps["viridis"](share) for share in np.linspace(0.0, 0.9, count)]


def _over_time(
    dataset: "xr.Dataset", rows: int = 1, *, nights: bool = False, height: float = 4.2
) -> tuple[Figure, Axes]:
    """A figure whose axes have the time of a flight, and perhaps its nights; and the first axes."""
    figure = new_figure(width=8.0, height=height, rows=rows)
    start = dataset.time.values[0]
    for axes in figure.axes:
        label = "night at the flyer"
        for begin, end, is_day in day_and_night(dataset) if nights else ():
            if not is_day:
                ends = [start + np.timedelta64(round(1e9 * edge), "ns") for edge in (begin, end)]
                axes.axvspan(*ends, color=_NIGHT, linewidth=0.0, zorder=0, label=label)
                label = ""
        locator = AutoDateLocator()  # type: ignore[no-untyped-call]
        axes.xaxis.set_major_locator(locator)
        written = ConciseDateFormatter(locator)  # type: ignore[no-untyped-call]
        axes.xaxis.set_major_formatter(written)
        axes.set_xlim(start, dataset.time.values[-1])
        axes.set_xlabel("UTC")
    return figure, figure.axes[0]


def _draw_spread(axes: Axes, time: np.ndarray, values: np.ndarray) -> None:
    """95 % interval of an ensemble, or its members where they are too few for one; (n, times)."""
    enough = np.isfinite(values).sum(axis=0) >= _FEWEST_FLYING
    if not enough.any():
        for number, line in enumerate(values):
            label = "" if number else "members of the ensemble"
            axes.plot(time, line, color=SKY, linewidth=0.8, label=label)
        return
    ends = np.full((2, time.size), np.nan)
    ends[:, enough] = np.nanpercentile(values[:, enough], _INTERVAL, axis=0)
    label = "95 % of the ensemble still aloft"
    axes.fill_between(time, *ends, color=SKY, alpha=0.5, linewidth=0.0, label=label)


class MapView(NamedTuple):
    """Edges of a map [deg]; the western one may lie beyond the date line."""

    west: float
    east: float
    south: float
    north: float

    def points(self, longitude: np.ndarray) -> np.ndarray:
        """Longitudes as the map has them."""
        middle = 0.5 * (self.west + self.east)
        found: np.ndarray = middle + (longitude - middle + _HALF_TURN) % _TURN - _HALF_TURN
        return found

    def line(self, longitude: np.ndarray, latitude: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """A line as the map has it, with gaps where it leaves at one edge and enters at another."""
        placed = self.points(longitude)
        jumps = np.flatnonzero(np.abs(np.diff(placed)) > _HALF_TURN) + 1
        return np.insert(placed, jumps, np.nan), np.insert(latitude, jumps, np.nan)


def map_view(dataset: "xr.Dataset") -> MapView:
    """What a map of a flight shows: all that is drawn, or the whole world."""
    longitude, latitude = [dataset.longitude.values], [dataset.latitude.values]
    if "ensemble_longitude" in dataset:
        longitude += list(dataset.ensemble_longitude.values)
        latitude += list(dataset.ensemble_latitude.values)
    # going on beyond the date line instead of jumping over the map
    known = (line[np.isfinite(line)] for line in longitude)
    unbroken = np.concatenate([np.unwrap(line, period=_TURN) for line in known])
    west, east = unbroken.min(), unbroken.max()
    south, north = np.nanmin(np.concatenate(latitude)), np.nanmax(np.concatenate(latitude))
    width = max(_LEAST_VIEW, _MARGIN * (east - west), _MARGIN * (north - south))
    if width > _WORLD:
        return MapView(-_HALF_TURN, _HALF_TURN, -_QUARTER_TURN, _QUARTER_TURN)
    height = max(_MARGIN * (north - south), 0.5 * width)
    middle, centre = 0.5 * (east + west), 0.5 * (south + north)
    return MapView(
        middle - 0.5 * width,
        middle + 0.5 * width,
        max(centre - 0.5 * height, -_QUARTER_TURN),
        min(centre + 0.5 * height, _QUARTER_TURN),
    )


def shores(dataset: "xr.Dataset") -> list[tuple[np.ndarray, np.ndarray]]:
    """Coastlines for a map of a flight, west and east of the date line too; none but on Earth."""
    if dataset.attrs["planet"] != EARTH_PLANET.name:
        return []
    longitude, latitude = coastline()
    return [(longitude + turn, latitude) for turn in (-_TURN, 0.0, _TURN)]


@cache
def coastline() -> tuple[np.ndarray, np.ndarray]:
    """Coastlines as one line with gaps [deg], shape (n,); -180 to 180; NaN between two lines."""
    # Source: [NaturalEarth]_, physical vectors, 1:110 million.
    rows = shipped_table("coastline.csv").numbers
    gaps = np.flatnonzero(np.diff(rows["line"])) + 1
    return np.insert(rows["longitude"], gaps, np.nan), np.insert(rows["latitude"], gaps, np.nan)


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
