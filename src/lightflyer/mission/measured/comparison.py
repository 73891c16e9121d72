"""A flight beside a measured track: how far they are apart, and what would explain it."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.config.designs import as_design
from lightflyer.core.clock import date_text, dates_of
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.progress import asked_to_end
from lightflyer.core.quantity import require_record
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.force.base import AbstractForceModel
from lightflyer.mission.measured.explanation import (
    Question,
    alikeness,
    explain,
    rms_of,
    weights_of,
)
from lightflyer.mission.measured.geometry import apart
from lightflyer.mission.measured.track import MeasuredTrack, read_track
from lightflyer.mission.measured.winds import WindOfTrack, wind_differences
from lightflyer.mission.mission import times_of
from lightflyer.mission.path.attitude import AbstractAttitudeRule, Own
from lightflyer.mission.path.dynamics import follow
from lightflyer.mission.path.integration import TOLERANCE, Accuracy
from lightflyer.mission.path.moments import Variable
from lightflyer.mission.path.motion import Craft, planet_of
from lightflyer.mission.path.release import (
    Release,
    limits_of,
    require_at_rest,
    require_release_inside,
    require_rule,
)
from lightflyer.mission.report.dataset import degrees_of
from lightflyer.mission.report.summary import SECONDS_AN_HOUR

if TYPE_CHECKING:
    import xarray as xr

FIX, PERIOD, BAND, TRACK = "fix", "period", "band", "measured_track"  # Dimensions

_ELSEWHERE = 5e5  # from a flight, where a track of it is not [m]
_WHOLE = 0.99  # share of the time that is as good as all of it
_METRES, _SPEED = "m", "m s-1"
_KILOMETRES = 100.0  # how much lower than the release a track in metres is not
_OF_FIXES = {
    "measured_elapsed": Variable("s", "time of the fix since the release"),
    "measured_altitude": Variable(_METRES, "measured altitude"),
    "measured_latitude": Variable("degree_north", "measured latitude"),
    "measured_longitude": Variable("degree_east", "measured longitude"),
    "flown_altitude": Variable(_METRES, "altitude of the flight at the time of the fix"),
    "flown_latitude": Variable("degree_north", "latitude of the flight at the time of the fix"),
    "flown_longitude": Variable("degree_east", "longitude of the flight at the time of the fix"),
    "altitude_residual": Variable(_METRES, "measured altitude less that of the flight"),
    "along_residual": Variable(_METRES, "measured place ahead of the flight's, along the track"),
    "across_residual": Variable(_METRES, "measured place to the right of the flight's"),
    "distance": Variable(_METRES, "distance over ground between measured place and flight"),
}
_OF_WINDS = {
    "lowest": Variable("", "lower end of the {}"),
    "highest": Variable("", "upper end of the {}"),
    "east": Variable(_SPEED, "eastward velocity of the track less that of the flyer"),
    "north": Variable(_SPEED, "northward velocity of the track less that of the flyer"),
    "duration": Variable("s", "time of the mean"),
    "altitude": Variable(_METRES, "mean measured altitude"),
}
_UNITS = {"mass": ("kg", "mass to add to the flyer"), "vertical_wind": (_SPEED, "wind upwards")}


def compare_track(
    track: str | Path | MeasuredTrack,
    what: Any,
    environment: AbstractEnvironment | None = None,
    model: AbstractForceModel | None = None,
    *,
    release: Release,
    duration: Any,
    attitude: AbstractAttitudeRule | None = None,
    lowest: Any = None,
    highest: Any = None,
    tolerance: float = TOLERANCE,
    explained: bool = True,
) -> "xr.Dataset":
    """Compare a flight with a measured track.

    Parameters
    ----------
    track : str, path or MeasuredTrack
        A table, a GPX or a KML file; see :func:`lightflyer.mission.read_track`.
    what, environment, model, release, duration, attitude, lowest, highest, tolerance
        As of :func:`lightflyer.fly`.
    explained : bool
        Whether to look for the mass and for the vertical wind that would explain the altitudes,
        for which some twenty flights are flown.

    Returns
    -------
    xarray.Dataset
        Over ``fix``: both altitudes and places, and residuals, measured less flown. Over ``period``
        and ``band``: the measured velocity less the flyer's in the wind in use, in means over time
        and over altitude.
        Attributes name the file, and what was done to its fixes.

    Raises
    ------
    ConfigurationError
        If the track cannot be read, or shares no time with the flight.
    ParameterError
        As of :func:`lightflyer.fly`.

    Notes
    -----
    The number that explains most brings the altitudes nearest to the measured ones, in the mean
    square over time, for flights in the wind that the track shows. Its 95 % interval counts
    residuals that are alike as one. A mass stands for all that weighs or lifts as much: a wrong
    absorptance looks like it.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> compared = compare_track(
    ...     lf.mission.MeasuredTrack.from_arrays(
    ...         ["2026-06-21T12:00Z", "2026-06-21T12:30Z"], [45.0, 45.0], [0.0, 0.1], [75e3, 78e3]
    ...     ),
    ...     lf.Disk(film, radius=0.005), lf.Earth(), lf.FreeMolecular(), duration="1 h",
    ...     release=lf.Release("75 km", latitude=45.0, longitude=0.0, time="2026-06-21T12:00Z"),
    ...     explained=False,
    ... )
    >>> print(f"{float(compared.distance[-1]):.0f} m apart")
    7863 m apart
    """
    rule = require_record("attitude", (AbstractAttitudeRule,), attitude or Own())
    setup = as_design(what, environment, model).setup
    measured = track if isinstance(track, MeasuredTrack) else read_track(track)
    limits = limits_of(setup.environment, lowest, highest)
    require_release_inside(release, limits)
    require_at_rest(release, "a flight beside a measured track")
    start = release.start()
    require_rule(Craft(setup, rule), start)
    span = float(times_of(duration)[-1])
    craft, released = Craft(setup, rule), float(release.time)
    require_comparable(measured, release, span)
    accuracy = Accuracy.for_duration(span, tolerance)
    _, way = follow(craft, start, limits, np.array([0.0, span]), accuracy)
    if asked_to_end():
        raise KeyboardInterrupt
    elapsed, end = measured.time - released, float(way.times[-1])
    require_comparable(measured, release, end)
    beside = (elapsed >= 0.0) & (elapsed <= end)
    heights, places = way(np.clip(elapsed, 0.0, end))
    between = apart(measured, places, float(planet_of(setup.environment).radius))
    flown = {"flown_altitude": heights}
    flown["flown_latitude"], flown["flown_longitude"] = degrees_of(places)
    flown |= {"altitude_residual": measured.altitude - heights, "distance": between.distance}
    flown |= {"along_residual": between.along, "across_residual": between.across}
    columns = {
        "measured_elapsed": elapsed,
        "measured_altitude": measured.altitude,
        "measured_latitude": measured.latitude,
        "measured_longitude": measured.longitude,
        **{name: np.where(beside, values, np.nan) for name, values in flown.items()},
    }
    dataset = _dataset(measured, columns)
    shared = (measured.time[beside][0], measured.time[beside][-1])
    by_time, by_altitude = wind_differences(measured, craft, shared, released)
    _add_winds(dataset, PERIOD, "s", by_time._asdict())
    _add_winds(dataset, BAND, _METRES, by_altitude._asdict())
    notes = [*measured.notes]
    hours, told = (float(one) / SECONDS_AN_HOUR for one in (np.ptp(shared), by_time.duration.sum()))
    if told < _WHOLE * hours:
        notes.append(
            f"the wind is told for {told:.2f} h of {hours:.2f} h: elsewhere the track has gaps, or "
            "the flyer's velocity is not known for want of wind or air"
        )
    nearest = float(np.min(between.distance[beside]))
    if nearest > _ELSEWHERE:
        notes.append(
            f"the track is nowhere nearer than {nearest / 1e3:.0f} km to the flight: it is of "
            "another one, or latitude and longitude are exchanged"
        )
    if not beside.all():
        notes.append(
            f"{np.sum(~beside)} of {beside.size} fixes are before the release or after the "
            "flight's end, and are not compared"
        )
    if explained:
        there: Any = WindOfTrack.of(by_time)
        carried = Craft(setup, rule, there)
        asked = Question(carried, start, limits, elapsed, measured.altitude, span)
        notes += _explain(dataset, asked)
    dataset.attrs = {"source": measured.source, "notes": "\n".join(notes)}
    return dataset


def join_comparisons(compared: Sequence["xr.Dataset"]) -> "xr.Dataset":
    """Comparisons of one flight with several tracks, over ``measured_track``."""
    import xarray as xr

    rows = (FIX, PERIOD, BAND)  # numbered, so that shorter ones are filled up
    about = {name: {"long_name": f"number of the {name}"} for name in rows}
    parts = [
        one.assign_coords({name: (name, np.arange(one.sizes[name]), about[name]) for name in rows})
        for one in compared
    ]
    joined = xr.concat(parts, TRACK, join="outer", data_vars="all", combine_attrs="override")
    for name in ("source", "notes"):
        joined.coords[f"{TRACK}_{name}"] = (TRACK, [one.attrs[name] for one in compared])
    return joined


def require_comparable(track: MeasuredTrack, release: Release, span: float) -> None:
    """Raise unless a track has two fixes within the span of a flight [s], in its unit of length."""
    released, highest = float(release.time), float(track.altitude.max())
    end = released + span
    count = np.sum((track.time >= released) & (track.time <= end))
    if count < 2:
        spans = (track.time[0], track.time[-1]), (released, end)
        measured, flown = (" to ".join(map(date_text, one)) for one in spans)
        raise ConfigurationError(
            f"{track.source}: {'one' if count else 'none'} of its fixes, of {measured}, lies "
            f"within the flight, of {flown}; give [mission] the date of the track"
        )
    if highest < float(release.altitude) / _KILOMETRES:
        raise ConfigurationError(
            f"{track.source}: its altitudes are at most {highest:.0f} m, and the flight begins at "
            f"{float(release.altitude):.0f} m; if they are kilometres, write so in the header, "
            '"altitude [km]"'
        )


def _dataset(track: MeasuredTrack, columns: dict[str, np.ndarray]) -> "xr.Dataset":
    import xarray as xr

    dataset = xr.Dataset(
        {name: (FIX, columns[name], _about(one)) for name, one in _OF_FIXES.items()}
    )
    date = {"long_name": "date of the fix (UTC)"}
    dataset["measured_time"] = (FIX, dates_of(track.time), date)
    return dataset


def _add_winds(
    dataset: "xr.Dataset", dimension: str, unit: str, means: dict[str, np.ndarray]
) -> None:
    for name, values in means.items():
        about = _OF_WINDS[name]
        told = Variable(about.unit or unit, about.long_name.format(dimension))
        dataset[f"{dimension}_{name}"] = (dimension, values, _about(told))


def _explain(dataset: "xr.Dataset", asked: Question) -> list[str]:
    """Add what explains the altitudes best, and say what cannot be told."""
    low, high = float(asked.limits.lowest), float(asked.limits.highest)
    used = (asked.elapsed >= 0.0) & (asked.elapsed <= asked.duration)
    used &= (asked.altitude >= low) & (asked.altitude <= high)
    if used.sum() < 3:
        return ["fewer than three fixes lie within the limits of the mission: nothing is explained"]
    asked = asked._replace(elapsed=asked.elapsed[used], altitude=asked.altitude[used])
    stated = asked.flown(asked.craft)
    found = explain(asked, stated)
    if found is None:
        return ["interrupted: what would explain the altitudes was not looked for"]
    weights = weights_of(asked.elapsed)
    before = rms_of(asked.altitude - stated, weights)
    mass = float(np.asarray(asked.craft.setup.flyer.mass))
    dataset["flyer_mass"] = _scalar(mass, "kg", "mass of the flyer as stated")
    dataset["altitude_rms"] = _scalar(before, _METRES, "rms of the altitudes' residuals")
    for name, one in found.items():
        unit, words = _UNITS[name]
        for end in ("value", "low", "high"):
            said = words if end == "value" else f"{words}, {end} end of its 95 % interval"
            dataset[f"{name}_{end}"] = _scalar(getattr(one, end), unit, said)
        rms = f"rms of the altitudes' residuals after the {name.replace('_', ' ')}"
        dataset[f"{name}_rms"] = _scalar(one.rms, _METRES, rms)
    alike = alikeness([one.effect for one in found.values()], weights)
    words = "correlation of what mass and vertical wind change of the altitudes"
    dataset["explanations_alike"] = _scalar(alike, "1", words)
    independent = min(found.values(), key=lambda one: one.rms).independent
    words = "number of independent ones that the better explanation's residuals are worth"
    dataset["independent_residuals"] = _scalar(independent, "1", words)
    return [
        f"the {name.replace('_', ' ')} lies at an end of what was searched: it explains little"
        for name, one in found.items()
        if one.at_end
    ]


def _scalar(value: float, unit: str, words: str) -> tuple[tuple[()], float, dict[str, str]]:
    return (), value, _about(Variable(unit, words))


def _about(one: Variable) -> dict[str, str]:
    return {"units": one.unit, "long_name": one.long_name}
