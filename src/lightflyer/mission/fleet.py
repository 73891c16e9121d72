"""Many flights at once: flyers within their uncertainties, other winds, other releases."""

import json
import zipfile
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext, suppress
from dataclasses import replace
from itertools import takewhile
from pathlib import Path
from typing import Any

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Array, Numeric
from lightflyer.array.records import Module, field
from lightflyer.core.atomic_files import output_directory
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import OutputError, ParameterError
from lightflyer.core.progress import asked_to_end, report
from lightflyer.core.quantity import Checked, Distance, Duration, Fraction, Multiple, Speed
from lightflyer.design.design import AbstractDesign, digest
from lightflyer.environment.base import AbstractEnvironment, Place
from lightflyer.environment.planet import EARTH_PLANET
from lightflyer.environment.wind.gridded import winds_in_files
from lightflyer.mission.areas import (
    directions,
    geographic,
    latitude_and_longitude,
    unit_vector,
    unit_vectors,
)
from lightflyer.mission.path.air import Tides, draw_waves, draw_wind_errors
from lightflyer.mission.path.attitude import AbstractAttitudeRule
from lightflyer.mission.path.dynamics import Balanced, follow, scale
from lightflyer.mission.path.integration import (
    Accuracy,
    Limits,
    Start,
    TerminationReason,
    Track,
    integrate,
)
from lightflyer.mission.path.motion import Vehicle, planet_of
from lightflyer.numerics.interpolation import Spline
from lightflyer.uncertainty.inputs import draw, uncertain_inputs


def describe_work(design: AbstractDesign, parts: Mapping[str, Any]) -> dict[str, str]:
    """Everything that decides results, in words that can be compared; ``parts``: pytrees."""
    from lightflyer.compute.store import versions  # with all of a study

    described = dict(design.description()) | versions()
    winds = winds_in_files(design.setup)  # whose data are no numbers of the design
    if winds:
        stores = (str(wind.store.key) for wind in winds if wind.store)
        described["files of the wind"] = ", ".join(stores)
    for name, part in parts.items():
        described[name] = f"{tree.structure(part)} {digest(*tree.leaves(part))}"
    return described


class WorkFolder:
    """Parts of one work in a folder, which is made if there is none; ``kind``: what it is."""

    def __init__(self, folder: Path, record: str, kind: str, described: dict[str, str]) -> None:
        self._folder, path = folder, folder / record
        try:
            there = folder.exists() and (not folder.is_dir() or any(folder.iterdir()))
            stored = json.loads(path.read_text(encoding="utf-8")) if path.exists() else None
        except (OSError, ValueError) as error:
            raise OutputError(f"{path}: cannot be read: {error}") from None
        if stored is None and there:
            raise OutputError(f"{folder}: already exists and is no {kind}; choose another folder")
        if stored == described:
            return
        if stored is not None and any(folder.glob("*.npz")):
            names = {**stored, **described}
            unlike = [name for name in names if stored.get(name) != described.get(name)]
            raise OutputError(
                f"{folder}: holds another {kind}, which differs in {', '.join(unlike[:3])}; choose "
                "another folder or remove it"
            )
        with output_directory(folder, shared=True) as stage:
            stage(record).write_text(json.dumps(described, indent=1), encoding="utf-8")

    def read(self, name: str) -> dict[str, Any] | None:
        """Arrays of a part by name; None where there is none, or not a whole one."""
        try:
            with np.load(self._folder / f"{name}.npz") as content:
                return dict(content)
        except (OSError, ValueError, KeyError, zipfile.BadZipFile, EOFError):
            return None

    def write(self, name: str, arrays: Mapping[str, Any]) -> None:
        """Keep the arrays of a part."""
        with output_directory(self._folder, shared=True) as stage:
            np.savez(stage(f"{name}.npz"), **arrays)

    def tracks(self, number: int, fly: Callable[[], Track]) -> Track:
        """Tracks of flights, by a number: those that are kept, or those flown now."""
        name = f"flights-{number:06d}"
        stored = self.read(name)
        if stored is not None:
            return Track(**stored)
        track = fly()
        interrupted = np.equal(track.termination, TerminationReason.INTERRUPTED)
        if np.size(interrupted) and not np.any(interrupted):
            self.write(name, vars(track))
        return track


def keeps_flights(folder: Path) -> bool:
    """Whether a folder has flights of an interrupted mission."""
    return any(folder.glob("flights-*.npz"))


def forget_flights(folder: Path) -> None:
    """Remove the flights that a folder has kept, and the folder where it has nothing else."""
    for path in (*folder.glob("flights-*.npz"), folder / "flights.json"):
        path.unlink(missing_ok=True)
    with suppress(OSError):
        folder.rmdir()


BATCH = 1024
"""Flights that are integrated together, whose arrays stay in the processor's cache."""

MEMBERS = 200  # of an ensemble, unless it says otherwise
_A_DAY = 86_400.0
_WIND, _RELEASE, _DRAG, _WAVES = 1, 2, 3, 4
"""Added to the seed, so that one does not follow the other."""


class Ensemble(Checked):
    """What is varied at random from flight to flight, beside the design's own uncertainties.

    Attributes
    ----------
    members : int
    seed : int
    together : bool
        Whether members are a swarm that is released at once, which meets one error of the wind and
        the same waves; otherwise each meets its own, as does one flyer on any day.
    wind, vertical_wind : array
        Standard uncertainty of each horizontal component of the wind, and of the vertical one
        [m/s].
    wind_correlation_time : array
        Time over which an error of the wind stays what it is [s].
    waves : array, optional
        Gravity waves and tides over their climatology [1]; zero for still air. By default 1 over
        the Earth, and none elsewhere, where their climatology is not known.
    drag : array
        Relative standard uncertainty of the drag [1]; by default that of the law of a disk, whose
        largest part is its warmth.
    altitude, distance, time, velocity : array
        Standard uncertainty of the release: of its altitude [m], of its place northward and
        eastward [m], of its time [s], and of each component of its velocity [m/s].
    """

    members: int = field(static=True, default=MEMBERS)
    seed: int = field(static=True, default=0)
    together: bool = field(static=True, default=False)
    wind: Speed = 0.0
    vertical_wind: Speed = 0.0
    wind_correlation_time: Duration = _A_DAY
    waves: Multiple | None = None
    drag: Fraction = 0.02
    altitude: Distance = 0.0
    distance: Distance = 0.0
    time: Numeric = 0.0
    velocity: Speed = 0.0

    def __check_init__(self) -> None:
        members: Any = self.members
        if not isinstance(members, int | np.integer):
            raise ParameterError(f"members = {members} must be a whole number")

    def waves_over(self, environment: AbstractEnvironment) -> float:
        """Size of the waves in some air, over their climatology."""
        known = planet_of(environment).name == EARTH_PLANET.name
        if self.waves is None:
            return float(known)
        scale = float(self.waves)
        if scale > 0.0 and not known:
            raise ParameterError(
                f"waves = {scale:g}: their climatology is the Earth's; over "
                f"{planet_of(environment).name} leave waves out"
            )
        return scale


class Flights(Module):
    """Flights that are computed together."""

    vehicle: Vehicle  # Numbers that differ from flight to flight have the shape (flights, 1, ...)
    starts: Start  # Numbers have the shape (flights, ...)
    together: bool = field(static=True, default=False)  # Whether members are one swarm

    @property
    def count(self) -> int:
        return len(self.starts.altitude)

    @property
    def varied(self) -> list[Array]:
        """Numbers of the vehicle that differ from flight to flight."""
        shape = self.count, 1
        return [leaf for leaf in tree.leaves(self.vehicle) if np.shape(leaf)[:2] == shape]


def flights_of(
    design: AbstractDesign,
    rule: AbstractAttitudeRule,
    start: Start,
    ensemble: Ensemble | None = None,
    delays: Sequence[float] = (),
    *,
    air_seed: int | None = None,
) -> Flights:
    """The flyer as it is stated, the members of an ensemble, and further launches.

    ``air_seed``: of the air that members meet together, unless it is the ensemble's.
    """
    launches, environment = len(delays), design.setup.environment
    altitude, time = float(start.altitude), float(start.place.time)
    if ensemble is None:
        later = np.array([0.0, *delays])
        place = _move(start.place, 0.0 * later, 0.0 * later)
        moving = start.velocity
        if moving is not None:
            moving = np.broadcast_to(moving, (later.size, 3))
        starts = Start(altitude + 0.0 * later, Place(*place, time + later), moving)
        return Flights(Vehicle(design.setup, rule), starts)
    if start.velocity is None and np.any(ensemble.velocity):
        raise ParameterError(
            "a velocity that is uncertain needs one of the release; add [mission.release]"
        )
    members, seed = ensemble.members, ensemble.seed
    setup = design.setup
    inputs = uncertain_inputs(design)
    if inputs is not None:
        stated, drawn = inputs.values[None], draw(inputs, members, seed)
        setup = inputs.setup_of(
            np.concatenate([stated, drawn, np.repeat(stated, launches, axis=0)])
        )

    def among_others(drawn: np.ndarray) -> np.ndarray:
        """With zeros for the flyer as it is stated and for the launches."""
        return np.pad(drawn, [(1, launches)] + [(0, 0)] * (drawn.ndim - 1))

    # members meet the air one by one, or all the same
    count, times = (1, members) if ensemble.together else (members, 1)
    of_air = seed if air_seed is None or not ensemble.together else air_seed

    def met(drawn: Any) -> Any:
        return tree.map_leaves(
            lambda part: among_others(np.repeat(part, times, axis=0))[:, None], drawn
        )

    wind, vertical, hours = map(
        float, (ensemble.wind, ensemble.vertical_wind, ensemble.wind_correlation_time)
    )
    errors = waves = drag = None
    if wind or vertical:
        errors = met(draw_wind_errors(count, wind, vertical, hours, of_air + _WIND))
    size = ensemble.waves_over(environment)
    if size:
        waves = met(draw_waves(count, size, of_air + _WAVES, tides_of(environment)))
    if np.any(ensemble.drag):
        normal = np.random.default_rng(seed + _DRAG).standard_normal(members)
        drag = np.exp(among_others(float(ensemble.drag) * normal))[:, None]
    vehicle = Vehicle(setup, rule, errors, waves, drag)
    generator = np.random.default_rng(seed + _RELEASE)
    away = float(ensemble.distance) / float(planet_of(environment).radius)
    spread = np.array([away, away, float(ensemble.altitude), float(ensemble.time)])
    normal = spread * generator.standard_normal((members, 4))
    kicks = float(ensemble.velocity) * generator.standard_normal((members, 3))
    north, east, higher, later = among_others(normal).T
    later[later.size - launches :] = delays
    place, moving = _move(start.place, north, east), start.velocity
    if moving is not None:
        moving = np.asarray(moving) + among_others(kicks)
    starts = Start(altitude + higher, Place(*place, time + later), moving)
    return Flights(vehicle, starts, ensemble.together)


def tides_of(environment: AbstractEnvironment) -> Tides:
    """What an environment has of the tides itself."""
    parts = (getattr(environment, name, None) for name in ("wind", "atmosphere"))
    return Tides(*(bool(getattr(part, "has_tides", False)) for part in parts))


@entry_point
def _move(place: Place, north: Any, east: Any) -> tuple[Array, Array]:
    """Latitudes and longitudes some angles to the north and east of a place."""
    to_east, to_north = directions(place.latitude, place.longitude)
    here = unit_vector(place.latitude, place.longitude)
    return latitude_and_longitude(here + north[:, None] * to_north + east[:, None] * to_east)


def fly_all(
    flights: Flights,
    limits: Limits,
    elapsed: np.ndarray,
    accuracy: Accuracy,
    first: Track | None = None,
    work: WorkFolder | None = None,
) -> Track:
    """Trajectories of flights in balance; ``elapsed``: times to keep, shape (times,).

    Fewer than there are flights where a user asks for an early end. ``first``: that of the first
    flight, where it is known. ``work``: has those of an interrupted call.
    """
    if flights.together and flights.vehicle.waves is not None:
        (vehicle, start), (member, _) = flight_of(flights, 0), flight_of(flights, 1)
        guiding = replace(vehicle, wind_error=member.wind_error, waves=member.waves)
        guide, _ = follow(guiding, start, limits, elapsed, accuracy)
        last = int(np.flatnonzero(np.isfinite(guide.altitude))[-1])
        latitude, longitude = geographic(np.asarray(guide.position)[: last + 1])
        turned = np.unwrap(longitude)
        # after its end a flight goes on along the parallel, as it did at last
        rate = (
            (turned[last] - turned[last - 1]) / (elapsed[last] - elapsed[last - 1]) if last else 0.0
        )
        at = np.minimum(np.arange(elapsed.size), last)
        middle = unit_vectors(latitude[at], turned[at] + rate * (elapsed - elapsed[at]))
        assert flights.vehicle.waves is not None
        waves = replace(flights.vehicle.waves, middle=Spline.through(elapsed, np.asarray(middle)))
        flights = replace(flights, vehicle=replace(flights.vehicle, waves=waves))
    count, alone = flights.count, int(first is not None)
    states = scale(flights.starts)
    law = Balanced(flights.vehicle, np.reshape(flights.starts.place.time, (-1, 1)), limits)
    flown: dict[int, float] = {}  # of each batch, in flights

    def compute(begin: int) -> Track | None:
        if asked_to_end():
            return None
        rows = np.arange(begin, min(begin + BATCH, count))

        def tell(share: float) -> None:
            flown[begin] = share * rows.size
            report("flying", alone + int(sum([*flown.values()])), count, "flights")

        def fly() -> Track:
            return integrate(law.take(rows), states[rows], elapsed, accuracy, tell).track

        return fly() if work is None else work.tracks(begin, fly)

    def whole(track: Track | None) -> bool:
        interrupted = TerminationReason.INTERRUPTED
        return track is not None and not np.any(np.equal(track.termination, interrupted))

    begins = range(alone, count, BATCH)
    tracks = [] if first is None else [tree.map_leaves(lambda leaf: np.asarray(leaf)[None], first)]
    workers = 1
    if len(begins) > 1:
        from lightflyer.compute.scheduler import processors  # with all of a study

        workers = min(processors(), len(begins))
    with ThreadPoolExecutor(workers) if workers > 1 else nullcontext() as pool:
        found = map(compute, begins) if pool is None else pool.map(compute, begins)
        for begin, some in zip(begins, takewhile(whole, found), strict=False):
            tracks.append(some)
            flown[begin] = min(BATCH, count - begin)
    tracks = tracks or [unflown(take(flights, np.arange(0)), elapsed)]
    return tree.map_leaves(lambda *parts: np.concatenate(parts), *tracks)


def unflown(flights: Flights, elapsed: np.ndarray) -> Track:
    """Tracks of flights that have not begun."""
    count, starts = flights.count, flights.starts
    known: dict[str, Any] = {
        "altitude": np.full((count, elapsed.size), np.inf),
        "position": np.full((count, elapsed.size, 3), np.inf),
        "end_elapsed": np.zeros(count),
        "end_altitude": np.array(starts.altitude),
        "end_position": np.array(unit_vectors(starts.place.latitude, starts.place.longitude)),
        "termination": np.full(count, int(TerminationReason.STILL_FLYING)),
        "steps": np.zeros(count, int),
    }
    known["altitude"][:, 0], known["position"][:, 0] = known["end_altitude"], known["end_position"]
    return Track(**known)


def note(
    tracks: Track, rows: np.ndarray, elapsed: np.ndarray, times: np.ndarray, found: Track
) -> None:
    """Write down where some flights are from one time to another, and how they end.

    ``elapsed``: times of the tracks; ``times``: those of what was found, among which they are.
    """
    now = np.flatnonzero((elapsed > times[0]) & (elapsed <= times[-1]))
    kept = np.searchsorted(times, elapsed[now])
    for name in ("altitude", "position"):
        getattr(tracks, name)[np.ix_(rows, now)] = getattr(found, name)[:, kept]
    for name in ("end_elapsed", "end_altitude", "end_position", "termination"):
        getattr(tracks, name)[rows] = getattr(found, name)
    tracks.steps[rows] += found.steps


def take(flights: Flights, rows: np.ndarray) -> Flights:
    """Some of the flights."""
    vehicle = tree.take_rows(flights.vehicle, (flights.count, 1), rows)
    starts = tree.map_leaves(lambda leaf: np.asarray(leaf)[rows], flights.starts)
    return replace(flights, vehicle=vehicle, starts=starts)


def flight_of(flights: Flights, row: int) -> tuple[Vehicle, Start]:
    """Who flies one of the flights, and from where; the vehicle's numbers have the shape (1, 1)."""
    one = take(flights, np.array([row]))
    return one.vehicle, tree.map_leaves(lambda leaf: leaf[0], one.starts)
