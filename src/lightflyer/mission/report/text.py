"""Missions and swarms in words: lines and tables."""

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from rich.table import Table

from lightflyer.design.diagnostics import TOO_HOT
from lightflyer.files.result_text import Parts, as_text, rows_of, table_of, warning_lines, wrap
from lightflyer.mission.report.summary import summarise
from lightflyer.mission.transient import transient_text

if TYPE_CHECKING:
    import xarray as xr

_MOST_SPANS = 3  # of the other wind that are named
_MOST_ROWS = 12  # of nights and of launches in a table; the summary has all


def mission_parts(dataset: "xr.Dataset") -> Parts:
    """Release, end and extremes of a flight, its nights, and those flown beside it."""
    found, names = summarise(dataset), ("latitude", "longitude", "altitude")
    begin = place_text(*(dataset[name].values[0] for name in names))
    rows = {"flyer": dataset.attrs["flyer"], "released": f"{found['released']}, {begin}"}
    if "release" in found:
        rows["at first"] = transient_text(found["release"])
    end = place_text(*(dataset[f"end_{name}"] for name in names))
    rows |= {"ended": f"{found['ended']}, {end}", "because": f"it {found['end']}"}
    film, warnings = found["film"], found["warnings"]
    if film is not None:
        rows["film"] = f"at most {film['hottest_k']:.0f} K, and withstands {film['bears_k']:.0f} K"
        warnings = [text for text in warnings if not text.startswith(TOO_HOT)]  # as said there
    rows["aloft"] = f"{found['duration_h']:.2f} h, {found['light_h']:.2f} h in light"
    for name in ("lowest", "highest"):
        altitude, when = found[f"{name}_altitude_km"], found[f"{name}_at_h"]
        rows[name] = f"{_decimals(altitude)} km, {when:.2f} h after the release"
    if "station" in found:
        stay = found["station"]
        left = stay["left_after_h"]
        leaves = "does not leave it" if left is None else f"leaves it first after {left:.2f} h"
        if stay["within_h"] == 0.0:
            leaves = "does not reach it"
        rows["station"] = (
            f"{stay['within_h']:.2f} h {stay['place']}, {leaves}; at most "
            f"{stay['farthest_km']:.1f} km from its middle"
        )
    passes = found.get("telemetry", {}).get("passes")
    if passes:
        bits = found["telemetry"]["data_bit"]
        sent = "" if bits is None else f", {bits:.4g} bit"
        count = f"{len(passes)} pass" + "es" * (len(passes) > 1)
        rows["in sight"] = f"{found['telemetry']['in_sight_h']:.2f} h in {count}{sent}"
    elif "telemetry" in found:
        rows["in sight"] = "of no receiver"
    if found["other_wind"] is not None:
        rows["data end"] = _other_wind_text(found["other_wind"])
    yield rows_of(rows)
    if found["nights"]:
        yield _nights(found["nights"])
    if passes:
        titles = ["passes", "receiver", "begins", "ends", "highest [deg]", "range [km]"]
        titles += ["margin [dB]", "bit"] * ("data_bit" in passes[0])
        lines = [
            (
                one["receiver"],
                one["begin"],
                one["end"],
                f"{one['highest_elevation_deg']:.1f}",
                f"{one['nearest_km']:.0f} to {one['farthest_km']:.0f}",
                *(f"{one[name]:.4g}" for name in ("least_margin_db", "data_bit") if name in one),
            )
            for one in passes
        ]
        yield _table(*titles, rows=lines, more=True)
    if "ensemble" in found:
        yield _ensemble(found["ensemble"])
    if "landing" in found:
        yield from _landing(found["landing"])
    if "launches" in found:
        headings = ("launches", "released", "aloft [h]", "lowest [km]", "at the end [km]", "end")
        numbers = ("duration_h", "lowest_altitude_km", "end_altitude_km")
        lines = [
            (one["released"], *(f"{one[name]:.2f}" for name in numbers), _reason(one["end_reason"]))
            for one in found["launches"]
        ]
        yield _table(*headings, rows=lines, more=True)
    yield from map(wrap, (*found["assumptions"], *warning_lines(warnings)))


def _other_wind_text(found: dict[str, Any]) -> str:
    """When another wind took over from the data."""
    spans = [f"{begin:.2f} h to {end:.2f} h" for begin, end in found["spans_h"]]
    if not spans:
        return "never met on the way"
    more = f" and {len(spans) - _MOST_SPANS} times more" if len(spans) > _MOST_SPANS else ""
    low, high = found["lowest_altitude_km"], found["highest_altitude_km"]
    when = ", ".join(spans[:_MOST_SPANS]) + more
    return (
        f"the other wind blew {100.0 * found['share']:.0f} % of the time, {when}, "
        f"at {low:.1f} km to {high:.1f} km"
    )


def spread_parts(dataset: "xr.Dataset") -> Parts:
    """The shares of a swarm that still fly, and that are inside each area, at the end."""
    found = summarise(dataset)
    yield f"{found['flyer']}, {found['members']} members"
    lines = []
    for label, one in {"still aloft": found["flying"], **found["inside"]}.items():
        share, low, high = (f"{100.0 * one[end]:.3g}" for end in ("share", "low", "high"))
        lines.append((label, f"{share} %", f"{low} % to {high} %"))
    headings = "", "share", "95 %"
    yield table_of(headings, lines, title=f"after {found['after_h']:.4g} h", pad_edge=False)
    if "middle_altitude_km" in found:
        middle = found["middle_latitude_deg"], found["middle_longitude_deg"]
        yield (
            f"middle {place_text(*middle, 1e3 * found['middle_altitude_km'])}, "
            f"root mean square distance from it {found['distance_from_middle_km']:.4g} km"
        )
    yield from map(wrap, warning_lines(found["warnings"]))


def describe(dataset: "xr.Dataset") -> str:
    """A mission or the spread of a swarm as a short text.

    Parameters
    ----------
    dataset : xarray.Dataset
        From :func:`lightflyer.fly` or :func:`lightflyer.mission.disperse_ensemble`.

    Returns
    -------
    str

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> flown = lf.fly(
    ...     lf.Disk(film, radius=0.005), lf.Earth(), lf.FreeMolecular(), duration="6 h",
    ...     release=lf.Release("75 km", latitude=45.0, longitude=0.0, time="2026-06-21T12:00Z"),
    ... )
    >>> print(describe(flown).splitlines()[3])
    because   it is still aloft at the end of its time
    """
    return as_text(spread_parts(dataset) if "flying" in dataset else mission_parts(dataset))


def place_text(latitude: Any, longitude: Any, altitude: Any = None) -> str:
    """A place and an altitude, if there is one, in words; angles in degrees."""
    north, east = "N" if latitude >= 0.0 else "S", "E" if longitude >= 0.0 else "W"
    degrees = f"{abs(float(latitude)):.2f}° {north}, {abs(float(longitude)):.2f}° {east}"
    return degrees if altitude is None else f"{degrees}, {_decimals(float(altitude) / 1e3)} km"


def _decimals(value: float) -> str:
    """Two decimals, without the sign of the zero that rounding leaves at the ground."""
    return f"{round(value, 2) + 0.0:.2f}"


def square_kilometres(area: float) -> str:
    """An area [km²] to three digits, without a power of ten."""
    rounded = float(f"{area:.3g}")
    return f"{rounded / 1e6:g} million" if rounded >= 1e6 else f"{rounded:,.6g}"


def _table(
    title: str,
    *headings: str,
    rows: Iterable[Sequence[str]] = (),
    more: bool = False,
    caption: str = "",
) -> Table:
    """A table, of which a summary has the rows that are one too many; ``more``: say so."""
    lines = list(rows)
    table = table_of(headings, lines[:_MOST_ROWS], title=title, pad_edge=False)
    if more and len(lines) > _MOST_ROWS:
        caption = f"and {len(lines) - _MOST_ROWS} more in the summary"
    if caption:
        table.caption, table.caption_justify = caption, "left"
    return table


def _nights(nights: list[dict[str, Any]]) -> Table:
    lines = [
        (
            night["begins"],
            night["ends"] if night["whole"] else f"{night['ends']} *",
            f"{night['duration_h']:.2f}",
            *(_decimals(night[f"altitude_at_{name}_km"]) for name in ("begin", "end")),
        )
        for night in nights
    ]
    whole = all(night["whole"] for night in nights[:_MOST_ROWS])
    caption = "" if whole else "* not the whole night: the mission begins or ends in it"
    headings = "nights", "begins", "ends", "hours", "at its begin\n[km]", "at its end\n[km]"
    return _table(*headings, rows=lines, caption=caption)


def _intervals(title: str, found: Mapping[str, Mapping[str, float]]) -> Table:
    """Medians and 95 % intervals, by what they are of."""
    ends = ("low", "median", "high")
    lines = [(name, *(_decimals(one[end]) for end in ends)) for name, one in found.items()]
    headings = "95 % interval", "from", "median", "to"
    return table_of(headings, lines, title=title, pad_edge=False)


def _ensemble(found: dict[str, Any]) -> Table:
    members = found["members"]
    ends = (
        f"{100.0 * count / members:.1f} % {_reason(end)}" for end, count in found["ends"].items()
    )
    rows = {
        "time aloft [h]": "duration_h",
        "altitude at the end [km]": "end_altitude_km",
        "distance from the stated flyer's end [km]": "distance_from_nominal_end_km",
        "time within the station [h]": "within_station_h",
    }
    intervals = {name: found[key] for name, key in rows.items() if key in found}
    return _intervals(f"{members} flights: {', '.join(ends)}", intervals)


def _landing(found: dict[str, Any]) -> Parts:
    """Where and when flights land, and how long they are below flight levels."""
    share, low, high = (100.0 * found["landed"][end] for end in ("share", "low", "high"))
    title = f"landings: {share:.3g} % of {found['flights']} flights"
    if found["flights"] > 1:
        title += f" ({low:.3g} % to {high:.3g} %)"
    if "centre_latitude_deg" in found:
        middle = found["centre_latitude_deg"], found["centre_longitude_deg"]
        title += f", about {place_text(*middle)}"
    rows = {
        "time until the landing [h]": "after_h",
        "distance from the release [km]": "distance_from_release_km",
    }
    intervals = {name: found[key] for name, key in rows.items() if key in found}
    intervals |= {f"time below {name} [h]": one for name, one in found["below_h"].items()}
    yield _intervals(title, intervals)
    objects = f"{found['objects']:,} object" + "s" * (found["objects"] > 1)
    for area in found["areas"]:
        long, wide = area["half_axes_km"]
        sizes = (area[f"{key}_km2"] for key in ("area", "low", "high"))
        size, low, high = map(square_kilometres, sizes)
        yield (
            f"{100.0 * area['holds']:.0f} % land within {size} km² ({low} to {high}), "
            f"an ellipse of {2.0 * long:.4g} by {2.0 * wide:.4g} km: "
            f"{area['objects_per_km2']:.3g} per km² of {objects}"
        )
    yield (
        f"the Reynolds number at the end is {found['stated_end_reynolds']:.3g}; the drag is that "
        "of a body that keeps its attitude"
    )
    if "airspace" in found:
        densest = found["airspace"]
        yield (
            f"at most {densest['objects_per_km3']:.3g} per km³ of {objects} below the highest "
            f"flight level, {densest['at_h']:.2f} h after the release"
        )


def _reason(name: str) -> str:
    return name.replace("still_flying", "still aloft").replace("_", " ")
