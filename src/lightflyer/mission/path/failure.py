"""When a flyer fails in flight: its film is hotter than it bears, or tears."""

from typing import Any

from lightflyer.array.namespace import Array, xp
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.mission.path.motion import Craft, Surroundings
from lightflyer.mission.path.termination import TerminationReason
from lightflyer.statics.balance import Equilibrium

_STRESS = "stress_over_strength"


def failures_of(flyer: AbstractFlyer) -> tuple[TerminationReason, ...]:
    """The ends by failure whose limits a flyer states."""
    too_hot = flyer.highest_temperature is not None
    known = too_hot, _STRESS in flyer.known_shape
    ends = TerminationReason.TOO_HOT, TerminationReason.TORN
    return tuple(end for end, is_known in zip(ends, known, strict=True) if is_known)


def loads(craft: Craft, around: Surroundings, heat: Equilibrium) -> Array:
    """Load over what is borne for each of :func:`failures_of`, shape (ends,); above one it fails.

    Zero where it is not known, such as the tension of a film of unknown strength.
    """
    flyer, model, found = around.flyer, craft.setup.model, []
    if flyer.highest_temperature is not None:
        found.append(heat.temperature / flyer.highest_temperature)
    if _STRESS in flyer.known_shape:
        results: dict[str, Any] = {}
        if flyer.held_pressure is not None:
            results = model.own_results(flyer, around.state, heat.unknowns)
        pressure = results.get(flyer.held_pressure or "", 0.0)
        lift = craft.forces(around, heat.unknowns).lift
        shape = flyer.shape(around.state, heat.temperatures, lift, pressure)
        found.append(xp.nan_to_num(xp.asarray(shape.stress_over_strength)))
    return xp.stack([xp.asarray(load, float) for load in found])
