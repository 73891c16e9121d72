"""The way of one flyer, by SciPy's LSODA: nothing is compiled.

Near its balance a balloon's motion is stiff, and LSODA goes on with long steps there. Its steps do
not depend on the times that are kept, which lie between them.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from lightflyer.core.progress import report
from lightflyer.mission.path.integration import (
    ALTITUDE_SCALE,
    Accuracy,
    Limits,
    Start,
    Track,
    scale_state,
    steady_rate,
)
from lightflyer.mission.path.motion import Craft
from lightflyer.mission.path.termination import TerminationReason
from lightflyer.program.entry_point import bind, entry_point

_ROUNDING = 1e-13  # relative tolerance: SciPy wants one, the absolute one decides
_AN_HOUR = 3600.0

_rate = entry_point(steady_rate)
_scaled = entry_point(scale_state)


def follow(craft: Craft, start: Start, limits: Limits, elapsed: Any, accuracy: Accuracy) -> Track:
    """Track of one flyer whose numbers are known; ``elapsed`` (times,)."""
    from scipy.integrate import LSODA

    state = np.asarray(_scaled(start))
    rate = bind(_rate, craft, start, limits, example=(0.0, state))
    solver = LSODA(
        lambda time, flown: rate(np.float64(time), flown),
        float(elapsed[0]),
        state,
        float(elapsed[-1]),
        max_step=accuracy.longest,
        rtol=_ROUNDING,
        atol=accuracy.tolerance,
    )
    kept = np.full((len(elapsed), state.size), np.inf)
    kept[0] = state
    steps, known, end = 0, 1, None
    while solver.status == "running" and steps < accuracy.steps and end is None:
        solver.step()
        steps += 1
        report("flying", int(solver.t / _AN_HOUR), int(elapsed[-1] / _AN_HOUR), "h")
        if solver.status == "failed" or not np.isfinite(solver.y).all():
            break
        between = solver.dense_output()
        end = _leaves(between, solver.t_old, solver.t, limits)
        until = solver.t if end is None else end[0]
        count = int(np.searchsorted(elapsed, until, side="right"))
        if count > known:
            kept[known:count] = between(elapsed[known:count]).T
            known = count
    over = {"finished": TerminationReason.STILL_FLYING, "running": TerminationReason.STEP_LIMIT}
    reason = over.get(solver.status, TerminationReason.NO_DATA) if end is None else end[1]
    last = solver.y if end is None else between(end[0])
    length = np.linalg.norm(kept[:, :3], axis=1, keepdims=True)
    with np.errstate(invalid="ignore"):
        position = np.where(np.isfinite(length), kept[:, :3] / length, np.inf)
    found: dict[str, Any] = {
        "altitude": kept[:, 3] * ALTITUDE_SCALE,
        "position": position,
        "end_elapsed": np.float64(solver.t if end is None else end[0]),
        "end_altitude": last[3] * ALTITUDE_SCALE,
        "end_position": last[:3] / np.linalg.norm(last[:3]),
        "termination": np.int64(reason),
        "steps": np.int64(steps),
    }
    return Track(**found)


def _leaves(
    between: Callable[[float], np.ndarray], start: float, end: float, limits: Limits
) -> tuple[float, TerminationReason] | None:
    """When and how a flyer leaves its limits in a step, or None where it does not."""
    from scipy.optimize import brentq

    found = []
    for bound, sign, reason in (
        (limits.lowest, 1.0, TerminationReason.LOWEST_ALTITUDE),
        (limits.highest, -1.0, TerminationReason.HIGHEST_ALTITUDE),
    ):

        def inside(time: float, bound: Any = bound, sign: float = sign) -> float:
            return float(sign * (between(time)[3] - bound / ALTITUDE_SCALE))

        if inside(end) < 0.0:
            found.append((start if inside(start) <= 0.0 else brentq(inside, start, end), reason))
    return min(found, default=None)
