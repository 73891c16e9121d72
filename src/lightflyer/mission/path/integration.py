"""The way of a flyer through the air, integrated over time.

Position and altitude are scaled so that one absolute tolerance holds for both: no direction on the
planet is special, and a case that is rotated as a whole gives the rotated trajectory.
"""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.core.types import Numeric
from lightflyer.environment.base import Place, Wind
from lightflyer.environment.planet import Planet
from lightflyer.mission.path.failure import failures_of, loads
from lightflyer.mission.path.motion import Craft, settle, steady_speeds, velocity
from lightflyer.mission.path.position import directions, latitude_and_longitude, unit_vector
from lightflyer.mission.path.termination import TerminationReason
from lightflyer.pytree.lazy_jax import Array, jax, jnp
from lightflyer.pytree.module import Module, field

if TYPE_CHECKING:
    import diffrax  # a third of a second, and the flight of one flyer does without

ALTITUDE_SCALE = 100e3  # Altitude that counts as much as one radian along the ground [m]

TOLERANCE = 1e-8
"""Error of a step, of the position in radians and of the altitude in :data:`ALTITUDE_SCALE`."""

LONGEST_STEP = 1800.0  # Longest step [s]: a short day must not lie between two looks

_FIRST_STEP = 10.0  # seconds
_SHORTEST_STEP = 1e-3  # seconds: below, there is something that cannot be integrated
_STEPS_AN_HOUR = 200  # at most, on average; a day takes about a hundred, that of a balloon 1300
_FEWEST_STEPS = 2000
_SECONDS_AN_HOUR = 3600.0
_EVENT_TOLERANCE = 1e-10  # of the conditions below, which are altitudes in ALTITUDE_SCALE


class Start(Module):
    """Where and when a flyer is released."""

    altitude: Numeric  # [m]
    place: Place
    # Over ground, to the east, north and up [m/s], shape (3,); None for at rest in the air
    velocity: Numeric | None = None


class Track(Module):
    """A trajectory."""

    altitude: Array  #: shape (times,); [m]; infinite after the end
    position: Array  #: shape (times, 3); unit vector in the planet's frame; infinite after the end
    end_elapsed: Array  #: Time since the release [s] and altitude [m] at the end
    end_altitude: Array  #: Time since the release [s] and altitude [m] at the end
    end_position: Array  #: shape (3,)
    termination: Array  #: A :class:`~lightflyer.mission.path.termination.TerminationReason`
    steps: Array  #: Steps taken, the rejected ones included


class Limits(Module):
    """Altitudes between which a mission goes on."""

    lowest: Numeric  # [m]
    highest: Numeric  # [m]

    def inside(self, altitude: Array) -> Array:
        """The nearest altitude that the environment knows [m]."""
        return jnp.clip(altitude, self.lowest, self.highest)


class Accuracy(Module):
    """How a trajectory is integrated."""

    steps: int = field(static=True)  # Limit of their number
    # Error of a step; see :data:`TOLERANCE`
    tolerance: float = field(static=True, default=TOLERANCE)
    # Step that is not exceeded; see :data:`LONGEST_STEP`
    longest: float = field(static=True, default=LONGEST_STEP)

    @classmethod
    def for_duration(
        cls, duration: float, tolerance: float = TOLERANCE, longest: float = LONGEST_STEP
    ) -> "Accuracy":
        """For a mission of some duration."""
        steps = duration / _SECONDS_AN_HOUR * _STEPS_AN_HOUR + 2.0 * duration / longest
        return cls(max(_FEWEST_STEPS, math.ceil(steps)), tolerance, longest)


def track(craft: Craft, start: Start, limits: Limits, elapsed: Array, accuracy: Accuracy) -> Track:
    """Trajectory of one flyer in balance at each moment; ``elapsed`` (times,)."""
    # Differentiable in every number of craft and start, backwards; see
    # :func:`lightflyer.mission.trajectory`.
    import diffrax

    def rate(time: Any, flown: Array, _: Any) -> Array:
        return steady_rate(craft, start, limits, time, flown)

    failures = failures_of(craft.setup.flyer)

    def spare(time: Any, flown: Array) -> Array:
        return 1.0 - loads_of_state(craft, start, limits, time, flown)

    solution = diffrax.diffeqsolve(
        diffrax.ODETerm(rate),
        diffrax.Tsit5(),
        t0=elapsed[0],
        t1=elapsed[-1],
        dt0=min(_FIRST_STEP, accuracy.longest),
        y0=scale_state(start),
        saveat=save_at(elapsed),
        stepsize_controller=controller(accuracy),
        event=events(limits, failures, spare),
        max_steps=accuracy.steps,
        throw=False,
    )
    return track_of(solution, failures)


def loads_of_state(craft: Craft, start: Start, limits: Limits, elapsed: Any, flown: Array) -> Array:
    """Loads over what is borne in a scaled state, as :func:`~.failure.loads` has them."""
    altitude, place = altitude_and_place(start, flown, elapsed)
    around = craft.surroundings(limits.inside(altitude), place, elapsed)
    return loads(craft, around, craft.heat(around))


def steady_rate(craft: Craft, start: Start, limits: Limits, elapsed: Any, flown: Array) -> Array:
    """Rate of a scaled state at which heat and forces are in balance [1/s], shape (4,)."""
    altitude, place = altitude_and_place(start, flown, elapsed)

    def force(altitude: Array) -> tuple[Array, Any]:
        around = craft.surroundings(limits.inside(altitude), place, elapsed)
        unknowns = craft.heat(around).unknowns
        forces = craft.forces(around, unknowns)
        return forces.axial, (around, forces, unknowns)

    if not craft.setup.flyer.floats:
        _, (around, forces, unknowns) = force(altitude)
        axial, slope = steady_speeds(around, forces, unknowns)
    else:
        axial_force, change, (around, forces, unknowns) = jax.jvp(
            force, (altitude,), (jnp.ones_like(altitude),), has_aux=True
        )
        axial, slope = steady_speeds(around, forces, unknowns)
        axial = settle(axial, axial_force, -change)
    return rate_of(velocity(around, axial, slope), place, altitude, craft.planet)


def controller(accuracy: Accuracy, shortest: float = _SHORTEST_STEP) -> "diffrax.PIDController":
    """Controller of the steps' length."""
    import diffrax

    return diffrax.PIDController(
        rtol=0.0,
        atol=accuracy.tolerance,
        pcoeff=0.2,
        icoeff=0.4,
        dtmin=shortest,
        dtmax=accuracy.longest,
        force_dtmin=False,
    )


def scale_state(start: Start) -> Array:
    """State of a release: a unit vector, and the altitude in :data:`ALTITUDE_SCALE`."""
    position = unit_vector(start.place.latitude, start.place.longitude)
    return jnp.append(position, jnp.asarray(start.altitude) / ALTITUDE_SCALE)


def altitude_and_place(start: Start, flown: Array, elapsed: Array) -> tuple[Array, Place]:
    """Altitude and place of a scaled state; returns ``altitude`` [m], ``place``."""
    latitude, longitude = latitude_and_longitude(flown[:3])
    return flown[3] * ALTITUDE_SCALE, Place(latitude, longitude, start.place.time + elapsed)


def rate_of(moving: Wind, place: Place, altitude: Array, planet: Planet) -> Array:
    """Rate of a scaled state [1/s], shape (4,); ``moving``: velocity over ground."""
    to_east, to_north = directions(place.latitude, place.longitude)
    along = moving.north / (planet.curvature_radius(place.latitude, 0.0) + altitude)
    across = moving.east / (planet.curvature_radius(place.latitude, 0.5 * np.pi) + altitude)
    return jnp.append(across * to_east + along * to_north, moving.up / ALTITUDE_SCALE)


def save_at(elapsed: Array) -> "diffrax.SaveAt":
    """What to keep: the state at some times and at the end."""
    import diffrax

    return diffrax.SaveAt(subs=(diffrax.SubSaveAt(ts=elapsed), diffrax.SubSaveAt(t1=True)))


def events(
    limits: Limits,
    failures: tuple[TerminationReason, ...] = (),
    spare: Callable[[Any, Array], Array] | None = None,
) -> "diffrax.Event":
    """The ends of a mission: the lowest and the highest altitude, and failures.

    ``spare``: what is left before each failure at a time and a state, shape (failures,) [1].
    """
    import diffrax
    import optimistix

    def low(t: Array, y: Array, args: Any, **_: Any) -> Array:
        del t, args
        return y[3] - limits.lowest / ALTITUDE_SCALE

    def high(t: Array, y: Array, args: Any, **_: Any) -> Array:
        del t, args
        return limits.highest / ALTITUDE_SCALE - y[3]

    conditions: list[Any] = [low, high]
    for number in range(len(failures)):
        assert spare is not None

        def left(t: Array, y: Array, args: Any, number: int = number, **_: Any) -> Array:
            del args
            return spare(t, y)[number]

        def failed(t: Array, y: Array, args: Any, number: int = number, **_: Any) -> Array:
            del args  # a flyer that is released as it fails passes no limit
            return spare(t, y)[number] < 0.0

        conditions += [left, failed]
    finder: Any = optimistix.Newton(_EVENT_TOLERANCE, _EVENT_TOLERANCE)
    falling = (False, False, *(False, None) * len(failures))
    return diffrax.Event(tuple(conditions), finder, direction=falling)


def track_of(solution: "diffrax.Solution", failures: tuple[TerminationReason, ...] = ()) -> Track:
    """Trajectory of a solution that was kept as :func:`save_at` has it."""
    import diffrax

    results: Any = solution
    (kept, last), (fell, rose, *failed) = results.ys, results.event_mask
    over = solution.result == diffrax.RESULTS.successful
    limited = solution.result == diffrax.RESULTS.max_steps_reached
    termination = jnp.asarray(int(TerminationReason.NO_DATA))
    broken = [at_once | later for at_once, later in zip(failed[::2], failed[1::2], strict=True)]
    for holds, reason in (
        (limited, TerminationReason.STEP_LIMIT),
        (over, TerminationReason.STILL_FLYING),
        *zip(broken, failures, strict=True),
        (rose, TerminationReason.HIGHEST_ALTITUDE),
        (fell, TerminationReason.LOWEST_ALTITUDE),
    ):
        termination = jnp.where(holds, int(reason), termination)
    length = jnp.linalg.norm(kept[:, :3], axis=1, keepdims=True)
    end = last[0]
    return Track(
        altitude=kept[:, 3] * ALTITUDE_SCALE,
        position=kept[:, :3] / length,
        end_elapsed=results.ts[1][0],
        end_altitude=end[3] * ALTITUDE_SCALE,
        end_position=end[:3] / jnp.linalg.norm(end[:3]),
        termination=termination,
        steps=solution.stats["num_steps"],
    )
