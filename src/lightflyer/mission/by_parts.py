"""Many flights through winds of large files, of which parts are in memory one after the other.

Flights go on in stages of some hours. In each, those that are in one part of the winds fly
together, then others in theirs. What leaves its part reads others.
"""

import math
from functools import partial
from itertools import pairwise

import numpy as np

from lightflyer.array import tree
from lightflyer.core.entry_point import entry_point
from lightflyer.core.progress import asked_to_end, report
from lightflyer.environment.base import Place
from lightflyer.environment.wind.gridded import hold, parts_at, winds_in_files
from lightflyer.mission.fleet import (
    Flights,
    around_guide,
    fly_all,
    guide_of,
    law_of,
    note,
    unflown,
)
from lightflyer.mission.kept import Keep, keep_nothing
from lightflyer.mission.path.dynamics import follow, scale
from lightflyer.mission.path.integration import (
    ALTITUDE_SCALE,
    Accuracy,
    Law,
    Limits,
    Track,
    integrate,
)
from lightflyer.mission.path.position import latitude_and_longitude
from lightflyer.mission.path.termination import TerminationReason

_places = entry_point(latitude_and_longitude)
_FEW = 4  # flights that each find their parts of the winds by themselves


def fly_many(
    flights: Flights,
    limits: Limits,
    elapsed: np.ndarray,
    accuracy: Accuracy,
    first: Track | None = None,
    keep: Keep = keep_nothing,
) -> Track:
    """Trajectories of flights as of :func:`~.fleet.fly_all`, whatever size their wind has."""
    if flights.together and flights.craft.waves is not None:
        guide, _ = follow(*guide_of(flights), limits, elapsed, accuracy)
        flights = around_guide(flights, guide, elapsed)
    if not winds_in_files(flights.craft) or flights.count - (first is not None) <= _FEW:
        return fly_all(flights, limits, elapsed, accuracy, first, keep)
    law, known = law_of(flights, limits), int(first is not None)
    states, tracks = scale(flights.starts), unflown(flights, elapsed)
    flying, groups = np.ones(flights.count, bool), 0
    if first is not None:
        flying[0] = False
        for whole, one in zip(*map(tree.leaves, (tracks, first)), strict=True):
            whole[0] = one
    stages = math.ceil((elapsed[-1] - elapsed[0]) / law.ahead)
    edges = np.linspace(elapsed[0], elapsed[-1], 1 + stages)
    for stage, (since, until) in enumerate(pairwise(edges)):
        report("flying", stage, stages, "stages")
        times = np.union1d([since, until], elapsed[(elapsed > since) & (elapsed < until)])
        left = np.flatnonzero(flying)
        while left.size:
            place = Place(*_places(states[left, :3]), law.released[left, 0] + since)
            here = hold(parts_at(flights.craft.setup, Place(*(part[0] for part in place))), place)
            here[0] = True
            rows, left = left[here], left[~here]
            fly = partial(_fly, law.take(rows), states[rows], times, accuracy)
            found, groups = keep(groups, fly), groups + 1
            if asked_to_end() or np.any(found.termination == TerminationReason.INTERRUPTED):
                return tree.map_leaves(lambda leaf: leaf[:known], tracks)
            note(tracks, rows, elapsed, times, found)
            height = found.end_altitude[:, None] / ALTITUDE_SCALE
            states[rows] = np.concatenate([found.end_position, height], axis=1)
            flying[rows] = found.termination == TerminationReason.STILL_FLYING
    return tracks


def _fly(law: Law, states: np.ndarray, times: np.ndarray, accuracy: Accuracy) -> Track:
    return integrate(law, states, times, accuracy).track
