"""Where the members of a released swarm are after days: shares, with what chance leaves open."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

import lightflyer
from lightflyer.array import tree
from lightflyer.compute.scheduler import connect_client, run_on_dask
from lightflyer.config.designs import as_design
from lightflyer.core.clock import dates_of
from lightflyer.core.errors import ParameterError
from lightflyer.core.progress import Counted, reported_as_part
from lightflyer.design.design import AbstractDesign
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.force.base import AbstractForceModel
from lightflyer.mission.areas import AbstractArea, describe_all, unit_vectors
from lightflyer.mission.fleet import BATCH, Ensemble, flights_of
from lightflyer.mission.kept import WorkFolder, describe_work
from lightflyer.mission.mission import times_of
from lightflyer.mission.path.attitude import AbstractAttitudeRule, Own
from lightflyer.mission.path.integration import (
    TOLERANCE,
    Accuracy,
    Plan,
    Start,
    TerminationReason,
    Track,
)
from lightflyer.mission.path.motion import ELAPSED, Vehicle, planet_of
from lightflyer.mission.path.release import (
    Release,
    limits_of,
    require_release_inside,
    require_rule,
)
from lightflyer.mission.report.assumptions import assumptions_of
from lightflyer.mission.report.dataset import degrees_of
from lightflyer.mission.report.landing import binomial_interval
from lightflyer.mission.transient import fly_flights

if TYPE_CHECKING:
    import xarray as xr

MEMBERS = 8 * BATCH - 1
"""Members that are flown and counted together; with them goes the flyer as it is stated."""

_EVERY = 3600.0  # seconds between counts where nobody asks for a spacing
_STUDY = "spread.json"


class Counts(NamedTuple):
    """Sums over members, which is all that is kept of them."""

    flying: np.ndarray  # shape (times,); members that still fly
    inside: np.ndarray  # shape (areas, times); those of them inside each area
    # shape (times, 3); sum of the differences of their unit vectors from that of the release
    moved: np.ndarray
    moved_squared: np.ndarray  # shape (times,); sum of the squares of these
    # shape (times,); sums of their altitudes above the release's [m], and of the squares [m²]
    climbed: np.ndarray
    climbed_squared: np.ndarray
    ends: np.ndarray  # shape (reasons,); members by what ended their flight


@dataclass(frozen=True)
class _Swarm:
    """Everything that a batch of members needs, wherever it is flown."""

    design: AbstractDesign
    rule: AbstractAttitudeRule
    start: Start
    ensemble: Ensemble
    areas: tuple[AbstractArea, ...]
    plan: Plan

    @property
    def batches(self) -> int:
        """How many there are."""
        return -(-self.ensemble.members // MEMBERS)

    def size(self, batch: int) -> int:
        return min(MEMBERS, self.ensemble.members - batch * MEMBERS)

    def seed(self, batch: int) -> int:
        """Of a batch's random numbers, which depend on nothing else; the first are those of fly."""
        if batch == 0:
            return self.ensemble.seed
        sequence = np.random.SeedSequence(self.ensemble.seed, spawn_key=(batch,))
        return int(sequence.generate_state(1)[0])

    def __call__(self, batch: int) -> tuple[int, Counts]:
        """Fly a batch of members and count them."""
        ensemble = replace(self.ensemble, members=self.size(batch), seed=self.seed(batch))
        seed = self.ensemble.seed
        flights = flights_of(self.design, self.rule, self.start, ensemble, air_seed=seed)
        with reported_as_part(batch * MEMBERS, self.ensemble.members, "flights"):
            tracks, _, _ = fly_flights(flights, self.plan)
        # without the flyer as it is stated
        return batch, _counts_of(tree.map_leaves(lambda leaf: leaf[1:], tracks), self)

    remotely = __call__

    def receive(self, answer: tuple[int, Counts]) -> tuple[int, Counts]:
        """What a worker sent."""
        return answer


def disperse_ensemble(
    what: Any,
    environment: AbstractEnvironment | None = None,
    model: AbstractForceModel | None = None,
    *,
    release: Release,
    duration: Any,
    ensemble: Ensemble,
    areas: Sequence[AbstractArea] = (),
    every: Any = _EVERY,
    attitude: AbstractAttitudeRule | None = None,
    lowest: Any = None,
    highest: Any = None,
    tolerance: float = TOLERANCE,
    folder: str | Path | None = None,
    scheduler: str | None = None,
) -> "xr.Dataset":
    """Spread of a swarm that is released at once: the share still flying, and inside areas.

    Parameters
    ----------
    what, environment, model, release, duration, attitude, lowest, highest, tolerance
        As for :func:`lightflyer.fly`.
    ensemble : Ensemble
        How many members, and what differs from one to another, beside every ± of the design.
    areas : sequence of AbstractArea
        Such as :class:`~lightflyer.mission.Circle`.
    every : float
        Time between the counts [s].
    folder : path, optional
        Keeps the counts of each batch of members. The same call continues where it was
        interrupted.
    scheduler : str, optional
        Address of a Dask scheduler, on whose workers the members fly; by default they fly in
        threads of this process.

    Returns
    -------
    xarray.Dataset
        Over ``elapsed`` and ``area``: ``flying`` and ``inside``, shares of all members, with the
        95 % intervals of a binomial share (Clopper and Pearson) in ``flying_low`` and so on; of
        those that still fly the middle ``latitude``, ``longitude``, the root mean square
        ``distance`` from it, mean and standard deviation of the altitude.

    Raises
    ------
    ParameterError
        As :func:`lightflyer.fly`.
    OutputError
        If the folder holds another swarm, or something else.

    Notes
    -----
    The interval is what the finite number of members leaves open. Wrong inputs are not in it.
    Members do not feel each other.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> swarm = lf.mission.disperse_ensemble(
    ...     lf.Disk(film, radius=0.005), lf.Earth(), lf.Lu2023(), duration="6 h", every="3 h",
    ...     release=lf.Release("75 km", latitude=45.0, longitude=0.0, time="2026-06-21T12:00Z"),
    ...     ensemble=lf.mission.Ensemble(members=50, wind=15.0),
    ...     areas=[lf.mission.Circle(45.0, 0.0, "300 km")],
    ... )
    >>> f"{float(swarm.inside[0, -1]):.2f}"
    '0.48'
    """
    design = as_design(what, environment, model)
    setup, rule = design.setup, attitude or Own()
    limits = limits_of(setup.environment, lowest, highest)
    require_release_inside(release, limits)
    _require_members(ensemble, areas)
    elapsed = times_of(duration, every)
    # raises where the data of winds or ground do not reach
    start = release.start()
    remarks = require_rule(Vehicle(setup, rule), start)
    accuracy = Accuracy.for_duration(float(elapsed[-1]), tolerance)
    plan = Plan(limits, elapsed, accuracy)
    swarm = _Swarm(design, rule, start, ensemble, tuple(areas), plan)
    counts = _count(swarm, None if folder is None else Path(folder), scheduler)
    dataset = _dataset(swarm, counts)
    dataset.attrs |= {
        "title": "lightflyer spread",
        "lightflyer_version": lightflyer.__version__,
        "flyer": setup.flyer.describe(),
        "areas": "; ".join(describe_all(areas)),
        "assumptions": "\n".join(assumptions_of(setup, rule, ensemble, None)),
        "warnings": "\n".join((*design.warnings, *remarks, *_diagnostics(counts))),
    }
    return dataset


def _require_members(ensemble: Ensemble, areas: Sequence[AbstractArea]) -> None:
    if ensemble.members < 1:
        raise ParameterError(f"a swarm of {ensemble.members} members is none")
    for area in areas:
        if not isinstance(area, AbstractArea):
            raise ParameterError(f"areas are a Circle or a Polygon, not {type(area).__name__}")


def _counts_of(tracks: Track, swarm: _Swarm) -> Counts:
    flying = np.isfinite(tracks.altitude)
    moved = np.where(flying[..., None], tracks.position - _release(swarm), 0.0)
    climbed = np.where(flying, tracks.altitude - float(swarm.start.altitude), 0.0)
    radius = float(planet_of(swarm.design.setup.environment).radius)
    inside = [
        np.sum(flying & area.contains(_release(swarm) + moved, radius), axis=0)
        for area in swarm.areas
    ]
    return Counts(
        flying.sum(axis=0),
        np.reshape(inside, (len(swarm.areas), swarm.plan.elapsed.size)).astype(int),
        moved.sum(axis=0),
        np.square(moved).sum(axis=(0, 2)),
        climbed.sum(axis=0),
        np.square(climbed).sum(axis=0),
        np.bincount(np.asarray(tracks.termination), minlength=len(TerminationReason)),
    )


def _release(swarm: _Swarm) -> np.ndarray:
    """Unit vector of the place of the release."""
    place = swarm.start.place
    return np.asarray(unit_vectors(place.latitude, place.longitude))


def _count(swarm: _Swarm, folder: Path | None, scheduler: str | None) -> Counts:
    """Sums over all batches: those that a folder has, and those that are flown now."""
    kept = None if folder is None else WorkFolder(folder, _STUDY, "swarm", _describe(swarm))
    found: dict[int, Counts] = {}
    for batch in range(swarm.batches):
        stored = None if kept is None else kept.read(_name(batch))
        if stored is not None:
            found[batch] = Counts(**stored)
    missing = [batch for batch in range(swarm.batches) if batch not in found]
    done = sum(swarm.size(batch) for batch in found)
    counted = Counted("flying", swarm.ensemble.members, "flights", done)
    for batch, counts in _fly(swarm, missing, scheduler):
        if kept is not None:
            kept.write(_name(batch), counts._asdict())
        found[batch] = counts
        counted.add(swarm.size(batch))
    # in the order of the batches, so that the sums do not depend on who was first
    ordered = [found[batch] for batch in sorted(found)]
    return Counts(*(np.sum(parts, axis=0) for parts in zip(*ordered, strict=True)))


def _fly(swarm: _Swarm, missing: list[int], scheduler: str | None) -> Iterator[tuple[int, Counts]]:
    if scheduler is None:
        yield from map(swarm, missing)
    elif missing:
        with connect_client(scheduler) as client:
            yield from run_on_dask(swarm, missing, client, scheduler)


def _name(batch: int) -> str:
    return f"batch-{batch:06d}"


def _describe(swarm: _Swarm) -> dict[str, str]:
    """Everything that decides the counts, in words that can be compared."""
    parts = {
        "release": swarm.start,
        "ensemble": swarm.ensemble,
        "attitude": swarm.rule,
        "areas": swarm.areas,
        "altitudes": swarm.plan.limits,
        "times": swarm.plan.elapsed,
    }
    whole = (swarm.ensemble.members, swarm.ensemble.seed, swarm.plan.accuracy, MEMBERS)
    told = describe_work(swarm.design, parts)
    return told | {"members, seed of the first batch, accuracy, batch": repr(whole)}


def _dataset(swarm: _Swarm, counts: Counts) -> "xr.Dataset":
    import xarray as xr

    members, flying = swarm.ensemble.members, counts.flying
    dataset = xr.Dataset()
    about = {"units": "s", "long_name": "time since the release"}
    dataset.coords[ELAPSED] = (ELAPSED, swarm.plan.elapsed, about)
    date = {"long_name": "date (UTC)"}
    released = float(swarm.start.place.time)
    dataset.coords["time"] = (ELAPSED, dates_of(released + swarm.plan.elapsed), date)
    _add_shares(dataset, "flying", (ELAPSED,), flying, members, "share that still flies")
    if swarm.areas:
        dataset.coords["area"] = ("area", describe_all(swarm.areas))
        text = "share that still flies and is inside the area"
        _add_shares(dataset, "inside", ("area", ELAPSED), counts.inside, members, text)
    for name, (values, unit, text) in _moments(swarm, counts).items():
        dataset[name] = (ELAPSED, values, {"units": unit, "long_name": text})
    reasons = [end.name.lower() for end in TerminationReason]
    dataset.coords["reason"] = ("reason", reasons)
    text = "members by what ended their flight"
    dataset["ends"] = ("reason", counts.ends, {"units": "1", "long_name": text})
    dataset["members"] = ((), members, {"units": "1", "long_name": "members of the swarm"})
    return dataset


def _add_shares(
    dataset: "xr.Dataset",
    name: str,
    dimensions: tuple[str, ...],
    counts: np.ndarray,
    members: int,
    text: str,
) -> None:
    low, high = binomial_interval(counts, members)
    parts = {"": counts / members, "_low": low, "_high": high}
    ends = {"": "", "_low": ", lower end of the 95 % interval", "_high": ", upper end"}
    for end, values in parts.items():
        dataset[name + end] = (dimensions, values, {"units": "1", "long_name": text + ends[end]})


def _moments(swarm: _Swarm, counts: Counts) -> dict[str, tuple[np.ndarray, str, str]]:
    """Middle and width of what still flies; NaN where nothing does."""
    flying = np.where(counts.flying > 0, counts.flying, np.nan)
    moved = counts.moved / flying[:, None]
    scatter = counts.moved_squared / flying - np.square(moved).sum(axis=-1)
    middle = _release(swarm) + moved
    length = np.linalg.norm(middle, axis=-1)
    latitude, longitude = degrees_of(middle / length[:, None])
    radius = float(planet_of(swarm.design.setup.environment).radius)
    climbed = counts.climbed / flying
    variance = np.maximum(counts.climbed_squared / flying - climbed**2, 0.0)
    altitude = float(swarm.start.altitude) + climbed
    # the middle lies inside the planet by 1 - length, and was pushed out to its surface
    distance = radius * np.sqrt(np.maximum(2.0 * scatter / (1.0 + length), 0.0))
    return {
        "latitude": (latitude, "degree_north", "latitude of the middle"),
        "longitude": (longitude, "degree_east", "longitude of the middle"),
        "distance": (distance, "m", "root mean square distance from the middle, along chords"),
        "altitude": (altitude, "m", "mean geometric altitude"),
        "altitude_spread": (np.sqrt(variance), "m", "standard deviation of the altitude"),
    }


def _diagnostics(counts: Counts) -> Iterator[str]:
    for end in (TerminationReason.NO_DATA, TerminationReason.STEP_LIMIT):
        number = int(counts.ends[int(end)])
        if number:
            yield f"{number} members {end.describe()}; they count as not flying from there on"
