r"""What a tilted flyer does against the wind: its horizontal force and its speed through the air.

The force is perpendicular to the faces, so that a tilt :math:`\beta` turns it sideways. A flyer
that holds its altitude with it moves through the air at :math:`U`, where

.. math::
    D_t(U\cos\beta) = W\sin\beta, \qquad F = W\cos\beta + D_n(U\sin\beta)

for the drag edgewise :math:`D_t` and broadside :math:`D_n`, the force :math:`F` and the weight less
buoyancy :math:`W`. Slow, with :math:`D = kU`, that is

.. math::
    U = \frac{W}{k_t}\tan\beta, \qquad
    \frac FW = \cos\beta\left(1 + \frac{k_n}{k_t}\tan^2\beta\right)

Whether a flat flyer keeps level with its payload hanging below it.

The flyer hovers: the force along its normal is its weight and the payload's. With the sideways
motion :math:`x` of its centre, its tilt :math:`\theta` and the angle :math:`\varphi` of the string,
all small, a payload :math:`m_p` on a rod of length :math:`a`, fixed to the flyer at a right angle,
and on a string of length :math:`b` below the rod has

.. math::
    T &= \tfrac12 m_d\dot x^2 + \tfrac12 I_d\dot\theta^2 + \tfrac12 m_p u^2, \quad
        u = \dot x - a\dot\theta - b\dot\varphi \\
    V &= \tfrac12 m_p g(a\theta^2 + b\varphi^2), \quad
    Q_x = (m_d + m_p)g\,\theta - k_e\dot x, \quad Q_\theta = -k_r\dot\theta

and a drag :math:`-k_p u` on the payload. The force follows the tilt, which is what can feed an
oscillation. Heave is apart from this: to first order nothing of it acts on sway and tilt. Light
and force are uniform over the flyer, so that neither has a torque.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module, field
from lightflyer.config.designs import as_design
from lightflyer.core.checks import is_concrete
from lightflyer.core.entry_point import entry_point, reads_units, strip_labels
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import Checked, Distance, Length
from lightflyer.design.diagnostics import diagnose
from lightflyer.design.setup import Setup
from lightflyer.drag.disk import TURNING_DIAGNOSTIC, turning_disk_torque
from lightflyer.environment.base import AbstractEnvironment, EnvironmentState, Place, Wind
from lightflyer.environment.radiation import Attitude
from lightflyer.files.display_units import amount, number_text
from lightflyer.files.result_text import Parts, PrintedResult, rows_of, warning_lines
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.disk import Disk
from lightflyer.flyer.plate import Plate
from lightflyer.flyer.sandwich import Sandwich
from lightflyer.force.base import AbstractForceModel
from lightflyer.mission.path.attitude import Own
from lightflyer.mission.path.motion import (
    Surroundings,
    Vehicle,
    steady_speeds,
    velocity,
    with_attitude,
)
from lightflyer.statics.balance import equilibrium, require_converged

_SLOW = 1e-6  # metres a second; drag is proportional to the speed there
_NEUTRAL = 1e-9  # of the fastest mode: below, a rate is zero but for rounding


class Drift(PrintedResult, Module):
    """Steady motion of a flyer through the air."""

    speed: Array  #: Horizontal, towards the azimuth to which the top face is tilted [m/s]
    climb: Array  #: Vertical, upward positive [m/s]
    force: Array  #: Horizontal force of the gas on the flyer at rest [N]
    #: Vertical force of the gas on the flyer at rest, with buoyancy, over its weight [1]
    lift_over_weight: Array
    #: Where model or drag are beyond their range; none under JAX's transformations
    warnings: tuple[str, ...] = field(static=True, default=())

    def text_parts(self) -> Parts:
        yield rows_of(
            {
                "speed along the tilt": number_text(self.speed, "m/s"),
                "climb": number_text(self.climb, "m/s"),
                "force along the tilt": number_text(self.force, "N"),
                "lift over weight": number_text(self.lift_over_weight, ""),
            }
        )
        yield from warning_lines(self.warnings)


def steady_drift(
    what: Any,
    environment: AbstractEnvironment | None = None,
    model: AbstractForceModel | None = None,
    *,
    altitude: Numeric,
    tilt: Numeric,
    azimuth: Numeric = 0.0,
    place: Place | None = None,
) -> Drift:
    """Steady motion of a tilted flyer through the air, and the force that drives it.

    Parameters
    ----------
    what : AbstractFlyer, Setup, FlyerFile, path of a flyer file, or AbstractDesign
    environment, model : optional
        Where ``what`` is a flyer. The wind is left out.
    altitude : array, shape (...)
        [m].
    tilt : array, shape (...)
        Of the flyer, in place of its own [rad].
    azimuth : array, shape (...)
        Towards which its top face is tilted [rad], from the same axis as the light's.
    place : Place, optional
        Where and when.

    Returns
    -------
    Drift

    Raises
    ------
    ConvergenceError
        If the heat balance of an element has not converged (not under JAX's transformations).
    ConfigurationError
        If this kind of flyer has no law of drag.

    Notes
    -----
    As in missions: force and heat balance are those of a flyer at rest, and the drags broadside
    and edgewise do not know of each other. Differentiable.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> found = lf.mission.steady_drift(
    ...     lf.Disk(film, radius=0.01), lf.Earth(), lf.Lu2023(), altitude=70e3, tilt=0.3
    ... )
    >>> print(f"{found.speed:.2f} m/s along, {found.climb:.2f} m/s up")
    0.98 m/s along, 0.75 m/s up
    """
    setup = as_design(what, environment, model).setup
    height = setup.environment.coordinate.quantity.number("altitude", altitude)
    found, moving = _drift(setup, height, Attitude(tilt, azimuth), place)
    if not is_concrete(found.speed):
        return found
    *told, status, residual = moving
    require_converged("heat balance of the tilted flyer", status, residual)
    state, temperature, axial, slope = strip_labels(tuple(told))
    drags = setup.flyer.drag_diagnostics(state, axial, "broadside", temperature)
    if np.any(slope != 0.0):
        drags += setup.flyer.drag_diagnostics(state, slope, "edgewise", temperature)
    warnings = *diagnose(setup, state, temperature), *dict.fromkeys(drags)
    return replace(found, warnings=warnings)


@entry_point
def _drift(
    setup: Setup, altitude: Numeric, attitude: Attitude, place: Place | None
) -> tuple[Drift, tuple[Any, ...]]:
    """The drift; surroundings, temperature [K], speeds [m/s], and how the heat balance ended."""
    altitude, *angles = xp.broadcast_arrays(altitude, attitude.tilt, attitude.azimuth)
    attitude = Attitude(*angles)
    state = replace(setup.environment.state(altitude, place), wind=None)
    local = Surroundings(with_attitude(setup.flyer, attitude), state, Wind(0.0, 0.0, 0.0))
    vehicle = Vehicle(setup, Own())
    heat = vehicle.heat(local)
    forces = vehicle.forces(local, heat.unknowns)
    axial, slope = steady_speeds(local, forces, heat.unknowns)
    moving = velocity(local, axial, slope)
    speed = moving.east * xp.sin(attitude.azimuth) + moving.north * xp.cos(attitude.azimuth)
    force = setup.model.force(local.flyer, state, heat.unknowns) * xp.sin(attitude.tilt)
    found = Drift(speed, moving.up, force, forces.lift / forces.weight)
    return found, (state, heat.temperature, axial, slope, heat.status, heat.residual)


@dataclass(frozen=True, repr=False)
class Hanging(PrintedResult):
    """How a flyer with a payload below it answers a small disturbance."""

    #: shape (n,); rates of its motions of sway, tilt and swing, the largest real part first [1/s].
    #: Where the flyer is, which nothing restores, is not among them
    modes: np.ndarray
    edgewise_drag: float  #: Drag of the flyer over its speed sideways [N s/m]
    turning_drag: float  #: Torque over its angular velocity about a diameter [N m s]
    #: Rod up to which the same flyer and payload are stable, without string and without drag of the
    #: payload [m]
    longest_rod: float
    warnings: tuple[str, ...]

    def text_parts(self) -> Parts:
        yield rows_of(
            {
                "stable": "yes" if self.stable else "no",
                "fastest growth": f"{self.growth_rate:.4g} 1/s",
                "longest stable rod": amount(self.longest_rod, "m", 4),
            }
        )
        yield from warning_lines(self.warnings)

    @property
    def growth_rate(self) -> float:
        """Largest real part of the modes [1/s]; negative where all disturbances die out."""
        return float(self.modes[0].real)

    @property
    def stable(self) -> bool:
        """Whether all disturbances die out."""
        return self.growth_rate < -_NEUTRAL * float(np.abs(self.modes).max())


class _Hung(Checked):
    """How the payload hangs; checks its numbers."""

    rod: Distance
    string: Distance


@reads_units
def hanging_stability(
    flyer: AbstractFlyer,
    state: EnvironmentState,
    model: AbstractForceModel | None = None,
    *,
    rod: Length,
    string: Distance = 0.0,
    payload_drag: float = 0.0,
) -> Hanging:
    """Whether a flyer with its payload hanging below keeps level.

    Parameters
    ----------
    flyer : Disk, Plate or Sandwich
        With its payload, of which all hangs.
    state : EnvironmentState
        Numbers are scalars.
    model : AbstractForceModel, optional
        For the temperatures in the light of ``state``, which thin gas brakes by. Without one the
        flyer is as warm as the gas.
    rod : float
        Length below the flyer over which the payload is held at a right angle to it: a rod, or
        threads from the rim that meet in a point [m].
    string : float
        Length of a loose string below the rod [m].
    payload_drag : float
        Drag of the payload over its speed [N s/m].

    Returns
    -------
    Hanging

    Raises
    ------
    ConfigurationError
        If the flyer is not flat.
    ParameterError
        If the flyer has no payload, a length is negative, or both are zero.

    Notes
    -----
    For small disturbances of a flyer that hovers in still air. Rod and threads weigh nothing. The
    mass of gas that moves with the flyer is left out: for a 2-cm disk of 1 g/m² 1 % of its own at
    50 km, 0.1 % at 70 km.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> disk, state = lf.Disk(film, radius=0.01, payload=1e-7), lf.Earth().state(70e3)
    >>> found = lf.mission.hanging_stability(disk, state, rod=0.01)
    >>> print(f"{found.growth_rate:.1f} /s, stable up to {1e3 * found.longest_rod:.1f} mm")
    2.7 /s, stable up to 2.1 mm
    """
    if not isinstance(flyer, Disk | Plate | Sandwich):
        raise ConfigurationError(f"hanging_stability is for flat flyers, not {flyer.describe()}")
    if any(
        np.ndim(part) for part in (flyer.radius, flyer.payload, state.pressure, state.temperature)
    ):
        raise ParameterError("hanging_stability is for one flyer at one place: give single numbers")
    hung = _Hung(rod, string)
    rod, string = float(hung.rod), float(hung.string)
    payload, gravity = float(flyer.payload), float(state.gravity)
    if payload <= 0.0:
        raise ParameterError("nothing hangs below the flyer: its payload is zero")
    if rod + string <= 0.0:
        raise ParameterError("the payload hangs at no distance: give a rod or a string")
    if not payload_drag >= 0.0:
        raise ParameterError(f"payload_drag = {payload_drag:g} N s/m must not be negative")
    unknowns: Any = (np.zeros(()),) * (len(flyer.nodes) + len(flyer.flows))
    found: list[str] = []
    if model is not None:
        balance = equilibrium(flyer, state, model)
        unknowns = balance.unknowns
        found += model.diagnostics(flyer, state, np.asarray(balance.temperature))
    tac: tuple[Numeric, Numeric]
    if isinstance(flyer, Disk):
        tac, excess = (flyer.film.tac_top, flyer.film.tac_bottom), (unknowns[0], unknowns[0])
        transmission: Numeric = 0.0
    else:
        tac, excess = (flyer.top.tac_top, flyer.bottom.tac_bottom), (unknowns[0], unknowns[1])
        transmission = flyer.passing_share
    gas = (state.pressure, state.temperature, state.gas)
    turning = float(turning_disk_torque(1.0, flyer.radius, *gas, tac, excess, transmission))
    edgewise = float(flyer.drag(state, unknowns, _SLOW, "edgewise")) / _SLOW
    found += (*flyer.drag_diagnostics(state, _SLOW, "edgewise"), TURNING_DIAGNOSTIC)
    own = float(flyer.own_mass)
    body = _Body(own, 0.25 * own * float(flyer.radius) ** 2, payload, gravity, edgewise, turning)
    modes = modes_of(body, rod, string, payload_drag)
    return Hanging(modes, edgewise, turning, longest_rod(body), tuple(found))


@dataclass(frozen=True)
class _Body:
    """Masses [kg], moment of inertia [kg m²], gravity [m/s²] and drags of a flyer."""

    own_mass: float
    inertia: float
    payload: float
    gravity: float
    edgewise_drag: float
    turning_drag: float


def modes_of(body: _Body, rod: float, string: float, payload_drag: float) -> np.ndarray:
    """Rates of the motions, the largest real part first [1/s]."""
    arms = np.array([1.0, -rod, -string])  # of the payload's speed in sway, tilt and swing
    along = np.outer(arms, arms)
    mass = np.diag([body.own_mass, body.inertia, 0.0]) + body.payload * along
    damping = np.diag([body.edgewise_drag, body.turning_drag, 0.0]) + payload_drag * along
    hung = body.payload * body.gravity
    stiffness = np.diag([0.0, hung * rod, hung * string])
    stiffness[0, 1] = -(body.own_mass + body.payload) * body.gravity  # the force follows the tilt
    free = np.array([True, True, string > 0.0])
    mass, damping, stiffness = (part[np.ix_(free, free)] for part in (mass, damping, stiffness))
    # state: the speeds, then tilt and swing; where the flyer is has no effect
    answer = -np.linalg.solve(mass, np.hstack([damping, stiffness[:, 1:]]))
    angles = len(mass) - 1
    kinematics = np.hstack([np.zeros((angles, 1)), np.eye(angles), np.zeros((angles, angles))])
    modes = np.linalg.eigvals(np.vstack([answer, kinematics]))
    return modes[np.argsort(-modes.real)]


def longest_rod(body: _Body) -> float:
    r"""Longest rod that is stable by Routh's criterion, without string and drag of the payload."""
    # .. math:: k_r(M k_r + I_d k_e + m_p\ell^2k_e) > (M I_d + m_d m_p\ell^2)\,m_p g\,\ell
    total, payload = body.own_mass + body.payload, body.payload
    heavy = payload * body.gravity
    turning, edgewise = body.turning_drag, body.edgewise_drag
    missing = (
        body.own_mass * payload * heavy,
        -turning * payload * edgewise,
        total * body.inertia * heavy,
        -turning * (total * turning + body.inertia * edgewise),
    )
    roots = np.roots(missing)
    real = roots.real[np.abs(roots.imag) < _NEUTRAL * np.abs(roots)]
    return float(real[real > 0.0].min())
