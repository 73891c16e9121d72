"""Where the members of a released swarm are after days: shares, with what chance leaves open."""

from collections.abc import Sequence
from contextlib import nullcontext
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
from lightflyer.core.quantity import require_record
from lightflyer.design.design import AbstractDesign
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.force.base import AbstractForceModel
from lightflyer.mission.areas import AbstractArea, describe_all, unit_vectors
from lightflyer.mission.fleet import BATCH, Ensemble, WorkFolder, describe_work, flights_of
from lightflyer.mission.mission import Mission, times_of
from lightflyer.mission.path.integration import (
    Accuracy,
    Plan,
    Start,
    TerminationReason,
)
from lightflyer.mission.path.motion import ELAPSED, Vehicle, planet_of
from lightflyer.mission.path.release import (
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
    mission: Mission
    start: Start
    areas: tuple[AbstractArea, ...]
    plan: Plan

    @property
    def ensemble(self) -> Ensemble:
        assert self.mission.ensemble is not None
        return self.mission.ensemble

    @property
    def release(self) -> np.ndarray:
        """Unit vector of the place of the release."""
        return np.asarray(unit_vectors(self.start.place.latitude, self.start.place.longitude))

    @property
    def planet_radius(self) -> float:
        return float(planet_of(self.design.setup.environment).radius)

    def size(self, batch: int) -> int:
        return min(MEMBERS, self.ensemble.members - batch * MEMBERS)

    def __call__(self, batch: int) -> tuple[int, Counts]:
        """Fly a batch of members and count them."""
        # a batch's random numbers depend on nothing else; the first are those of fly
        seed = of_batch = self.ensemble.seed
        if batch:
            sequence = np.random.SeedSequence(seed, spawn_key=(batch,))
            of_batch = int(sequence.generate_state(1)[0])
        ensemble = replace(self.ensemble, members=self.size(batch), seed=of_batch)
        rule = self.mission.attitude
        flights = flights_of(self.design, rule, self.start, ensemble, air_seed=seed)
        with reported_as_part(batch * MEMBERS, self.ensemble.members, "flights"):
            tracks, _, _ = fly_flights(flights, self.plan)
        # without the flyer as it is stated
        tracks = tree.map_leaves(lambda leaf: leaf[1:], tracks)
        flying = np.isfinite(tracks.altitude)
        moved = np.where(flying[..., None], tracks.position - self.release, 0.0)
        climbed = np.where(flying, tracks.altitude - float(self.start.altitude), 0.0)
        inside = [
            np.sum(flying & area.contains(self.release + moved, self.planet_radius), axis=0)
            for area in self.areas
        ]
        return batch, Counts(
            flying.sum(axis=0),
            np.reshape(inside, (len(self.areas), self.plan.elapsed.size)).astype(int),
            moved.sum(axis=0),
            np.square(moved).sum(axis=(0, 2)),
            climbed.sum(axis=0),
            np.square(climbed).sum(axis=0),
            np.bincount(np.asarray(tracks.termination), minlength=len(TerminationReason)),
        )

    remotely = __call__

    def receive(self, answer: tuple[int, Counts]) -> tuple[int, Counts]:
        """What a worker sent."""
        return answer


def disperse_ensemble(
    what: Any,
    environment: AbstractEnvironment | None = None,
    model: AbstractForceModel | None = None,
    mission: Mission | None = None,
    *,
    areas: Sequence[AbstractArea] = (),
    folder: str | Path | None = None,
    scheduler: str | None = None,
    **fields: Any,
) -> "xr.Dataset":
    """Spread of a swarm that is released at once: the share still flying, and inside areas.

    Parameters
    ----------
    what, environment, model : optional
        As for :func:`lightflyer.fly`.
    mission : Mission, optional
        With an ensemble: how many members, and what differs from one to another, beside every ± of
        the design. ``every`` is the time between the counts, by default an hour [s].
    areas : sequence of AbstractArea
        Such as :class:`~lightflyer.mission.Circle`.
    folder : path, optional
        Keeps the counts of each batch of members. The same call continues where it was
        interrupted.
    scheduler : str, optional
        Address of a Dask scheduler, on whose workers the members fly; by default they fly in
        threads of this process.
    **fields
        Fields of the mission, such as ``release``, ``duration`` and ``ensemble``: in place of it,
        or in place of fields of it.

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
    mission = Mission(**fields) if mission is None else replace(mission, **fields)
    setup, ensemble = design.setup, require_record("ensemble", (Ensemble,), mission.ensemble)
    limits = limits_of(setup.environment, mission.lowest, mission.highest)
    require_release_inside(mission.release, limits)
    if ensemble.members < 1:
        raise ParameterError(f"a swarm of {ensemble.members} members is none")
    for area in areas:
        if not isinstance(area, AbstractArea):
            raise ParameterError(f"areas are a Circle or a Polygon, not {type(area).__name__}")
    elapsed = times_of(mission.duration, _EVERY if mission.every is None else mission.every)
    # raises where the data of winds or ground do not reach
    start = mission.release.start()
    warnings = [*design.warnings, *require_rule(Vehicle(setup, mission.attitude), start)]
    plan = Plan(limits, elapsed, Accuracy.for_duration(float(elapsed[-1]), mission.tolerance))
    swarm = _Swarm(design, mission, start, tuple(areas), plan)
    batches, work = range(-(-ensemble.members // MEMBERS)), None
    if folder is not None:
        parts = {
            "release": start, "ensemble": ensemble, "attitude": mission.attitude,
            "areas": swarm.areas, "altitudes": limits, "times": elapsed,
        }  # fmt: skip
        described = describe_work(design, parts)
        whole = ensemble.members, ensemble.seed, plan.accuracy, MEMBERS
        described["members, seed of the first batch, accuracy, batch"] = repr(whole)
        work = WorkFolder(Path(folder), "spread.json", "swarm", described)
    stored = {batch: work.read(f"batch-{batch:06d}") for batch in batches if work is not None}
    found = {batch: Counts(**one) for batch, one in stored.items() if one is not None}
    missing = [batch for batch in batches if batch not in found]
    done = sum(swarm.size(batch) for batch in found)
    counted = Counted("flying", ensemble.members, "flights", done)
    remote = scheduler if missing else None
    with nullcontext() if remote is None else connect_client(remote) as client:
        flown = map(swarm, missing)
        for batch, sums in run_on_dask(swarm, missing, client, remote) if remote else flown:
            if work is not None:
                work.write(f"batch-{batch:06d}", sums._asdict())
            found[batch] = sums
            counted.add(swarm.size(batch))
    # in the order of the batches, so that the sums do not depend on who was first
    ordered = [found[batch] for batch in sorted(found)]
    counts = Counts(*(np.sum(parts, axis=0) for parts in zip(*ordered, strict=True)))
    for end in (TerminationReason.NO_DATA, TerminationReason.STEP_LIMIT):
        number = int(counts.ends[int(end)])
        if number:
            warnings.append(
                f"{number} members {end.describe()}; they count as not flying from there on"
            )
    dataset = _dataset(swarm, counts)
    dataset.attrs |= {
        "title": "lightflyer spread",
        "lightflyer_version": lightflyer.__version__,
        "flyer": setup.flyer.describe(),
        "areas": "; ".join(describe_all(areas)),
        "assumptions": "\n".join(assumptions_of(setup, mission.attitude, ensemble, None)),
        "warnings": "\n".join(warnings),
    }
    return dataset


def _dataset(swarm: _Swarm, counts: Counts) -> "xr.Dataset":
    """Shares, and middle and width of what is still aloft; NaN where nothing is."""
    import xarray as xr

    members, elapsed, dataset = swarm.ensemble.members, swarm.plan.elapsed, xr.Dataset()
    about = {"units": "s", "long_name": "time since the release"}
    dataset.coords[ELAPSED] = (ELAPSED, elapsed, about)
    date = {"long_name": "date (UTC)"}
    dates = dates_of(float(swarm.start.place.time) + elapsed)
    dataset.coords["time"] = (ELAPSED, dates, date)

    def add_shares(name: str, dims: tuple[str, ...], counted: np.ndarray, text: str) -> None:
        low, high = binomial_interval(counted, members)
        for end, values, words in (
            ("", counted / members, ""),
            ("_low", low, ", lower end of the 95 % interval"),
            ("_high", high, ", upper end"),
        ):
            dataset[name + end] = (dims, values, {"units": "1", "long_name": text + words})

    add_shares("flying", (ELAPSED,), counts.flying, "share that still flies")
    if swarm.areas:
        dataset.coords["area"] = ("area", describe_all(swarm.areas))
        text = "share that still flies and is inside the area"
        add_shares("inside", ("area", ELAPSED), counts.inside, text)
    flying = np.where(counts.flying > 0, counts.flying, np.nan)
    moved, climbed = counts.moved / flying[:, None], counts.climbed / flying
    scatter = counts.moved_squared / flying - np.square(moved).sum(axis=-1)
    middle = swarm.release + moved
    length = np.linalg.norm(middle, axis=-1)
    latitude, longitude = degrees_of(middle / length[:, None])
    variance = np.maximum(counts.climbed_squared / flying - climbed**2, 0.0)
    # the middle lies inside the planet by 1 - length, and was pushed out to its surface
    distance = swarm.planet_radius * np.sqrt(np.maximum(2.0 * scatter / (1.0 + length), 0.0))
    altitude = float(swarm.start.altitude) + climbed
    for name, values, unit, text in (
        ("latitude", latitude, "degree_north", "latitude of the middle"),
        ("longitude", longitude, "degree_east", "longitude of the middle"),
        ("distance", distance, "m", "root mean square distance from the middle, along chords"),
        ("altitude", altitude, "m", "mean geometric altitude"),
        ("altitude_spread", np.sqrt(variance), "m", "standard deviation of the altitude"),
    ):
        dataset[name] = (ELAPSED, values, {"units": unit, "long_name": text})
    dataset.coords["reason"] = ("reason", [end.name.lower() for end in TerminationReason])
    text = "members by what ended their flight"
    dataset["ends"] = ("reason", counts.ends, {"units": "1", "long_name": text})
    dataset["members"] = ((), members, {"units": "1", "long_name": "members of the swarm"})
    return dataset
