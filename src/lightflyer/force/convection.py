r"""Natural convection around spheres, and the balloon's model: the gas pushes by buoyancy alone.

The heat loss goes from free molecules to conduction and natural convection. The three
limits are joined as resistances in series:

.. math::
    \frac{\theta}{Q} = \frac1{G_c}
        + \frac{1}{G_1}\left[\frac1\alpha - 1 + s(y)\right], \qquad y = \frac{G_1}{G_c}

with the conductance :math:`G_c` of dense gas, that of free molecules at complete accommodation
:math:`G_1`, and the share :math:`s(y)` of the free-molecular resistance that is left where the gas
is denser: one without collisions, and in dense gas what the temperature jump of a wall is.

All take arrays that broadcast, in SI units, and are differentiable. The relative temperature
excess of a surface is :math:`\theta = (T - T_c)/T_c`.
"""

import math
from collections.abc import Mapping
from typing import ClassVar, Literal

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import StandardErrors
from lightflyer.core.validity import Looks, Validity
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.balloon import Balloon
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel, ForceSection, ModelResult
from lightflyer.force.laws.faces import free_molecular_conductance
from lightflyer.force.lu2023 import rayleigh_number
from lightflyer.gas.base import AbstractGas

_CONDUCTION = 2.0  # Nusselt number of a sphere in endless gas at rest, by the diameter
_LAMINAR, _TURBULENT = 0.589, 0.150  # [Churchill1983]; [ChurchillChu1975], 0.387²
_PRANDTL, _PRANDTL_POWER, _RAYLEIGH_POWER = 0.469, 9.0 / 16.0, -16.0 / 9.0  # [Churchill1983]
_SHARPNESS = 6.0  # of the change from laminar to turbulent, as for plates in [Raithby1998]

_JUMP = 1.95  # temperature jump over μ√(2RT)/p at complete accommodation [Sharipov2011]
_JUMP_SHARE = 8.0 / 15.0 * _JUMP / math.sqrt(math.pi)
r"""Share of the free-molecular resistance that the jump of a wall is in dense gas, s(∞) = 0.587.

The jump's resistance with :math:`\kappa = \frac{15}4 R\mu` of a monatomic gas, over that of free
molecules; Maxwell's own estimate is one half, for any gas.
"""
_JUMP_ONSET = 1.4
"""Value of 1/y at which half of the change from 1 to s(∞) is done, inverted: it follows the solved
kinetic equation to 1 % (studies/balloon)."""

OUTER_RAYLEIGH = Validity(
    "the Rayleigh number outside",
    0.0,
    1e12,
    "the law of natural convection is known to about there, and its turbulent branch is used on",
)
"""Range of :func:`sphere_nusselt`: spheres to 1e11 [Churchill1983]_, cylinders to 1e12."""


@entry_point
def sphere_nusselt(rayleigh: Numeric, prandtl: Numeric, at_rest: Numeric = _CONDUCTION) -> Array:
    """Nusselt number of natural convection around a sphere [1]; by the diameter."""
    # .. math::
    #     \mathrm{Nu} = 2 + \left[(0.589\,\Psi^{1/4})^6 + (0.150\,\Psi^{1/3})^6\right]^{1/6},
    #     \qquad \Psi = \mathrm{Ra}
    #     \left[1 + \left(\tfrac{0.469}{\mathrm{Pr}}\right)^{9/16}\right]^{-16/9}
    #
    # The first term is the correlation for laminar flow, of which measurements on spheres follow to
    # Ra = 1e11. The second is the limit of turbulent flow that plates and horizontal cylinders
    # share (Churchill and Chu 1975), taken for a sphere. It reaches the first at Ra = 4e7 in air
    # and is 1.9 times it at 1e11. Models of stratospheric balloons use 0.1 Ra^0.34 there, which is
    # 3 % to 13 % more from 1e9 to 1e12.
    #
    # Source: [Churchill1983]_, [ChurchillChu1975]_; [CarlsonHorn1983]_ for balloons.
    reduced = rayleigh * (1.0 + (_PRANDTL / prandtl) ** _PRANDTL_POWER) ** _RAYLEIGH_POWER
    still = reduced == 0.0  # where the fourth root has no derivative
    root = xp.sqrt(xp.sqrt(xp.where(still, 1.0, reduced)))
    # of (turbulent/laminar)⁶, that is Ψ^(1/2)
    ratio = (_TURBULENT / _LAMINAR) ** _SHARPNESS * root**2
    moved = _LAMINAR * root * (1.0 + ratio) ** (1.0 / _SHARPNESS)
    return at_rest + xp.where(still, 0.0, moved)


def jump_share(density: Numeric) -> Array:
    r"""Share of the free-molecular resistance that is left where molecules collide [1]."""
    # .. math:: s(y) = \frac{1 + 1.4\,s_\infty\,y}{1 + 1.4\,y}, \qquad s_\infty = 0.587
    #
    # Without it the limits would simply be in series, and the heat loss up to 12 % too small.
    #
    # Source: [Sharipov2011]_ for the jump.
    return (1.0 + _JUMP_ONSET * _JUMP_SHARE * density) / (1.0 + _JUMP_ONSET * density)


@entry_point
def joined_conductance(free_molecular: Numeric, dense: Numeric, tac: Numeric) -> Array:
    r"""Heat loss of a body in gas of any density, per relative temperature excess [W]."""
    # .. math:: \frac1G = \frac1{G_c} + \frac1{G_1}\left[\frac1\alpha - 1 + s(y)\right]
    resistance = 1.0 / tac - 1.0 + jump_share(free_molecular / dense)
    return free_molecular * dense / (free_molecular + dense * resistance)


@entry_point
def sphere_conductance(
    excess: Numeric,
    *,
    radius: Numeric,
    tac: Numeric,
    pressure: Numeric,
    temperature: Numeric,
    gravity: Numeric,
    gas: AbstractGas,
    wall_distance: Numeric | None = None,
    convection: Numeric = 1.0,
) -> Array:
    """Heat that the gas around a sphere takes, per relative temperature excess [W]."""
    # Conduction alone follows the linearised Shakhov equation of a monatomic gas at complete
    # accommodation to 1 % (studies/balloon).
    mean = temperature * (1.0 + 0.5 * excess)
    rayleigh = rayleigh_number(
        excess, radius=radius, pressure=pressure, temperature=temperature, gravity=gravity, gas=gas
    )
    at_rest: Numeric = _CONDUCTION
    if wall_distance is not None:
        at_rest = _CONDUCTION / (1.0 - radius / wall_distance)
    nusselt = convection * sphere_nusselt(rayleigh, gas.prandtl_number(mean), at_rest)
    dense = 2.0 * np.pi * radius * nusselt * gas.conductivity(mean) * temperature
    free_molecular = free_molecular_conductance(
        4.0 * np.pi * radius**2,
        1.0,
        pressure,
        gas.mean_speed(temperature),
        gas.heat_capacity_ratio_at(mean),
    )
    return joined_conductance(free_molecular, dense, tac)


_SCATTER = 0.15
"""Standard uncertainty of the law outside, relative [1]: what laws of turbulent convection differ
by, see :func:`~lightflyer.force.convection.sphere_nusselt`."""


_ROUNDING = 1e-9


class BalloonConvection(AbstractForceModel):
    r"""Heat that the gas around takes from a balloon's envelope.

    .. math:: Q = G(\theta)\,\theta

    with the conductance of a sphere (:func:`~lightflyer.force.convection.sphere_conductance`).

    A sphere of one temperature is not pushed by the gas: the buoyancy of the gas within, which is
    the flyer's, is all of the lift.

    Attributes
    ----------
    convection_error : array or None
        Deviation of the truth from the law of convection, in its standard errors of 15 % [1]. A
        flyer file gives it as 0 ± 1, so that it is part of a prediction's uncertainty. None
        stands for zero.

    Notes
    -----
    The balloon drifts with the wind and neither rises nor sinks: convection is natural. The
    envelope has one temperature. In sunlight its upper side is warmer than the lower one, which
    radiation and convection within even out in part.

    References
    ----------
    [Churchill1983]_, [ChurchillChu1975]_
    """

    flyers: ClassVar[tuple[type[AbstractFlyer], ...]] = (Balloon,)
    results: ClassVar[Mapping[str, ModelResult]] = {
        "filled_share": ModelResult("", "share of the envelope's volume that gas fills"),
        "gas_inside": ModelResult("kg", "mass of the gas inside", "g"),
        "overpressure": ModelResult("Pa", "highest overpressure inside, at the top"),
        "film_tension": ModelResult("N/m", "force per length in the film at the top"),
    }

    convection_error: StandardErrors | None = None

    @entry_point
    def heat_loss(
        self, flyer: Balloon, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        (excess,) = unknowns
        error = self.convection_error
        conductance = sphere_conductance(
            excess,
            radius=flyer.radius,
            tac=flyer.film.tac_top,
            pressure=state.pressure,
            temperature=state.temperature,
            gravity=state.gravity,
            gas=state.gas,
            wall_distance=state.wall_distance,
            convection=1.0 if error is None else xp.exp(_SCATTER * error),
        )
        return ((1.0 - flyer.open_share) * conductance * excess,)

    @entry_point
    def force(self, flyer: Balloon, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
        """None on a sphere of one temperature."""
        return 0.0 * (unknowns[0] + state.pressure)

    @entry_point
    def own_results(
        self, flyer: Balloon, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> dict[str, Array]:
        within = flyer.filling(state, unknowns[0])
        outside = state.gas.density(state.pressure, state.temperature)
        # what gas of other weight adds over the height that it fills, at most the balloon's
        lighter = outside - within.mass / within.volume
        head = lighter * state.gravity * 2.0 * flyer.radius
        overpressure = within.overpressure + xp.maximum(head, 0.0)
        return {
            "filled_share": within.volume / flyer.volume,
            "gas_inside": within.mass + 0.0 * within.volume,
            "overpressure": overpressure,
            "film_tension": 0.5 * overpressure * flyer.radius,
        }

    def ranges(self, flyer: Balloon, state: EnvironmentState, temperature: Numeric) -> Looks:
        rayleigh = rayleigh_number(
            temperature / state.temperature - 1.0,
            radius=flyer.radius,
            pressure=state.pressure,
            temperature=state.temperature,
            gravity=state.gravity,
            gas=state.gas,
        )
        yield OUTER_RAYLEIGH, rayleigh

    def remarks(
        self, flyer: Balloon, state: EnvironmentState, temperature: Numeric
    ) -> tuple[str, ...]:
        excess = np.asarray(temperature) / state.temperature - 1.0
        found = self.own_results(flyer, state, (excess,))
        pressure, share, tension = (
            one.ravel()
            for one in np.broadcast_arrays(
                state.pressure, found["filled_share"], found["film_tension"]
            )
        )
        slackest, tightest, said = int(np.argmin(share)), int(np.argmax(tension)), []
        if share[slackest] < 1.0 - _ROUNDING:
            said.append(
                f"the gas fills {share[slackest]:.2g} of the envelope at "
                f"{pressure[slackest]:.3g} Pa: light and heat are those of the full sphere"
            )
        if flyer.film_strength is not None and tension[tightest] > np.min(flyer.film_strength):
            said.append(
                f"the film must withstand {tension[tightest]:.3g} N/m at "
                f"{pressure[tightest]:.3g} Pa; its film_strength is "
                f"{np.min(flyer.film_strength):.3g} N/m"
            )
        return tuple(said)


class BalloonForceSection(ForceSection, of=BalloonConvection):
    """``[force]``: convection and buoyancy of a balloon; the law's own error counts."""

    model: Literal["balloon"]
