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
"""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module, field
from lightflyer.config.designs import as_design
from lightflyer.core.arguments import strip_labels
from lightflyer.core.checks import is_concrete
from lightflyer.core.entry_point import entry_point
from lightflyer.design.diagnostics import diagnose
from lightflyer.design.setup import Setup
from lightflyer.environment.base import AbstractEnvironment, EnvironmentState, Place, Wind
from lightflyer.environment.radiation import Attitude
from lightflyer.files.display_units import number_text
from lightflyer.files.result_text import Parts, PrintedResult, rows_of, warning_lines
from lightflyer.force.base import AbstractForceModel
from lightflyer.mission.path.attitude import Own
from lightflyer.mission.path.motion import (
    Craft,
    Surroundings,
    steady_speeds,
    velocity,
    with_attitude,
)
from lightflyer.statics.balance import require_converged


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
    require_converged("heat balance of the tilted flyer", moving.status, moving.residual)
    return replace(found, warnings=_warnings(setup, strip_labels(moving)))


class _Moving(NamedTuple):
    """What warnings hang on: surroundings, temperature [K], speeds [m/s], how the search ended."""

    state: EnvironmentState
    temperature: Array
    axial: Array
    slope: Array
    status: Array
    residual: Array


@entry_point
def _drift(
    setup: Setup, altitude: Numeric, attitude: Attitude, place: Place | None
) -> tuple[Drift, _Moving]:
    altitude, *angles = xp.broadcast_arrays(altitude, attitude.tilt, attitude.azimuth)
    attitude = Attitude(*angles)
    state = replace(setup.environment.state(altitude, place), wind=None)
    around = Surroundings(with_attitude(setup.flyer, attitude), state, Wind(0.0, 0.0, 0.0))
    craft = Craft(setup, Own())
    heat = craft.heat(around)
    forces = craft.forces(around, heat.unknowns)
    axial, slope = steady_speeds(around, forces, heat.unknowns)
    moving = velocity(around, axial, slope)
    speed = moving.east * xp.sin(attitude.azimuth) + moving.north * xp.cos(attitude.azimuth)
    force = setup.model.force(around.flyer, state, heat.unknowns) * xp.sin(attitude.tilt)
    found = Drift(speed, moving.up, force, forces.lift / forces.weight)
    return found, _Moving(state, heat.temperature, axial, slope, heat.status, heat.residual)


def _warnings(setup: Setup, moving: _Moving) -> tuple[str, ...]:
    flyer, state, temperature = setup.flyer, moving.state, moving.temperature
    drags = flyer.drag_diagnostics(state, moving.axial, "broadside", temperature)
    if np.any(moving.slope != 0.0):
        drags += flyer.drag_diagnostics(state, moving.slope, "edgewise", temperature)
    return (*diagnose(setup, state, temperature), *dict.fromkeys(drags))
