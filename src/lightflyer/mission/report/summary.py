"""A mission in numbers, from its dataset."""

import itertools
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.core.clock import date_text, seconds_of
from lightflyer.mission.areas import distances_between, units_of
from lightflyer.mission.path.integration import TerminationReason
from lightflyer.mission.path.motion import ELAPSED
from lightflyer.mission.report.events import Event, at_event, read_events, spans_between
from lightflyer.mission.report.ground import RECEIVER, summarise_station, summarise_telemetry
from lightflyer.mission.report.landing import interval_of, summarise_landing
from lightflyer.mission.transient import summarise_transient

if TYPE_CHECKING:
    import xarray as xr

SECONDS_AN_HOUR = 3600.0
_ENDS = "low", "high"  # of the interval of a share


def summarise(dataset: "xr.Dataset") -> dict[str, Any]:
    """A mission in numbers.

    Parameters
    ----------
    dataset : xarray.Dataset
        From :func:`lightflyer.fly` or :func:`lightflyer.mission.disperse_ensemble`.

    Returns
    -------
    dict
        Ready for JSON, with a unit at the end of each name.
    """
    if "flying" in dataset:
        return _summarise_spread(dataset)
    end, events = float(dataset.end_elapsed), read_events(dataset)
    lowest, highest = (at_event(events, kind) for kind in (Event.LOWEST, Event.HIGHEST))
    spans = day_and_night(dataset)
    altitudes = {
        0.0: float(dataset.altitude[0]),
        **dict(zip(events.elapsed.tolist(), events.altitude.tolist(), strict=True)),
        end: float(dataset.end_altitude),
    }
    nights = [
        {
            "begins": date_after(dataset, begin),
            "ends": date_after(dataset, until),
            "duration_h": (until - begin) / SECONDS_AN_HOUR,
            "altitude_at_begin_km": altitudes[begin] / 1e3,
            "altitude_at_end_km": altitudes[until] / 1e3,
            "whole": begin > 0.0 and until < end,
        }
        for begin, until, is_day in spans
        if not is_day
    ]
    film, highest_temperature = None, dataset.attrs.get("highest_temperature_k")
    if highest_temperature is not None:
        hottest = at_event(events, Event.HOTTEST)[2]
        film = {"bears_k": highest_temperature, "hottest_k": hottest}
    found: dict[str, Any] = {
        "released": date_after(dataset, 0.0),
        "ended": date_after(dataset, end),
        "end": dataset.attrs["end"],
        "end_reason": TerminationReason(int(dataset.end_reason)).name.lower(),
        "duration_h": end / SECONDS_AN_HOUR,
        "end_altitude_km": float(dataset.end_altitude) / 1e3,
        "end_latitude_deg": float(dataset.end_latitude),
        "end_longitude_deg": float(dataset.end_longitude),
        "lowest_altitude_km": lowest[1] / 1e3,
        "lowest_at_h": lowest[0] / SECONDS_AN_HOUR,
        "highest_altitude_km": highest[1] / 1e3,
        "highest_at_h": highest[0] / SECONDS_AN_HOUR,
        "light_h": sum(until - begin for begin, until, day in spans if day) / SECONDS_AN_HOUR,
        "nights": nights,
        "film": film,
        "other_wind": _other_wind(dataset),
    }
    departure = summarise_transient(dataset)
    if departure is not None:
        found["release"] = departure
    if "station" in dataset.attrs:
        found["station"] = summarise_station(dataset)
    if RECEIVER in dataset.dims:
        found["telemetry"] = summarise_telemetry(dataset)
    if "ensemble_flying" in dataset:
        found["ensemble"] = _summarise_ensemble(dataset)
    landing = summarise_landing(dataset)
    if landing is not None:
        found["landing"] = landing
    if "launch_end_reason" in dataset:
        below = dataset.launch_altitude.min(ELAPSED).values
        found["launches"] = [
            {
                "released": date_after(dataset, float(one.launch_delay)),
                "delay_h": float(one.launch_delay) / SECONDS_AN_HOUR,
                "end_reason": TerminationReason(int(one.launch_end_reason)).name.lower(),
                "duration_h": float(one.launch_end_elapsed) / SECONDS_AN_HOUR,
                "end_altitude_km": float(one.launch_end_altitude) / 1e3,
                "lowest_altitude_km": float(below[number]) / 1e3,
            }
            for number, one in ((i, dataset.isel(launch=i)) for i in range(dataset.sizes["launch"]))
        ]
    return found | {name: texts_of(dataset, name) for name in ("assumptions", "warnings")}


def _summarise_spread(dataset: "xr.Dataset") -> dict[str, Any]:
    """The shares of a swarm that still fly, and that are inside each area, at the end."""
    last = dataset.isel({ELAPSED: -1})

    def shares(of: "xr.Dataset", name: str) -> dict[str, float]:
        return {"share": float(of[name]), **{end: float(of[f"{name}_{end}"]) for end in _ENDS}}

    found: dict[str, Any] = {
        "flyer": dataset.attrs["flyer"],
        "members": int(dataset.members),
        "after_h": float(last[ELAPSED]) / SECONDS_AN_HOUR,
        "flying": shares(last, "flying"),
        "inside": {
            str(area.item()): shares(last.sel(area=area), "inside")
            for area in dataset.get("area", ())
        },
    }
    if found["flying"]["share"] > 0.0:
        found |= {
            "middle_latitude_deg": float(last.latitude),
            "middle_longitude_deg": float(last.longitude),
            "middle_altitude_km": float(last.altitude) / 1e3,
            "distance_from_middle_km": float(last.distance) / 1e3,
        }
    return found | {name: texts_of(dataset, name) for name in ("assumptions", "warnings")}


def _other_wind(dataset: "xr.Dataset") -> dict[str, Any] | None:
    """When and where another wind took over from data; None without such a wind."""
    wind = dataset.attrs.get("other_wind")
    if wind is None:
        return None
    last, events = float(dataset.end_elapsed), read_events(dataset)
    kinds = Event.OTHER_WIND_BEGINS, Event.OTHER_WIND_ENDS
    spans = spans_between(events, *kinds, last)
    found = {
        "wind": wind,
        "share": sum(end - begin for begin, end in spans) / last if last else float(bool(spans)),
        "spans_h": [[edge / SECONDS_AN_HOUR for edge in span] for span in spans],
    }
    if spans:
        kinds_of_ends = (*kinds, Event.LOWEST, Event.HIGHEST)
        inside = np.any([(events.elapsed >= low) & (events.elapsed <= up) for low, up in spans], 0)
        altitudes = [*events.altitude[np.isin(events.kind, kinds_of_ends) & inside]]
        if spans[-1][1] == last:
            altitudes.append(float(dataset.end_altitude))
        found["lowest_altitude_km"] = float(min(altitudes)) / 1e3
        found["highest_altitude_km"] = float(max(altitudes)) / 1e3
    return found


def texts_of(dataset: "xr.Dataset", name: str) -> list[str]:
    """Short texts of an attribute."""
    return dataset.attrs[name].splitlines()


def date_after(dataset: "xr.Dataset", elapsed: float) -> str:
    """Date some time after the release, in words."""
    return date_text(seconds_of(dataset.time.values[0]) + elapsed)


def day_and_night(dataset: "xr.Dataset") -> list[tuple[float, float, bool]]:
    """Spans of light and of darkness [s after the release]."""
    last, events = float(dataset.end_elapsed), read_events(dataset)
    days = spans_between(events, Event.LIGHT_BEGINS, Event.LIGHT_ENDS, last)
    edges = [0.0, *(edge for day in days for edge in day), last]
    spans = zip(pairwise(edges), itertools.cycle((False, True)))
    return [(begin, end, is_day) for (begin, end), is_day in spans if begin < end]


def _summarise_ensemble(dataset: "xr.Dataset") -> dict[str, Any]:
    reasons = dataset.ensemble_end_reason.values
    stated, ends = (
        units_of(dataset[f"{prefix}end_latitude"], dataset[f"{prefix}end_longitude"])
        for prefix in ("", "ensemble_")
    )
    apart = distances_between(ends, stated, float(dataset.attrs["planet_radius_km"]))
    found = {
        "members": int(dataset.sizes["member"]),
        "still_flying": float(np.mean(reasons == TerminationReason.STILL_FLYING)),
        "ends": {
            end.name.lower(): int(np.sum(reasons == end))
            for end in TerminationReason
            if np.any(reasons == end)
        },
        "duration_h": interval_of(dataset.ensemble_end_elapsed.values / SECONDS_AN_HOUR),
        "end_altitude_km": interval_of(dataset.ensemble_end_altitude.values / 1e3),
        "distance_from_nominal_end_km": interval_of(apart),
    }
    if "ensemble_station_within" in dataset:
        within = dataset.ensemble_station_within.values
        found["within_station_h"] = interval_of(within / SECONDS_AN_HOUR)
    return found
