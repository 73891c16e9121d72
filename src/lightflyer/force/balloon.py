r"""The balloon's model: convection around and within; the gas pushes by its buoyancy alone."""

import math
from collections.abc import Iterator, Mapping
from typing import ClassVar, Literal

import jax.numpy as jnp
import numpy as np
from jax import Array

from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.balloon import Balloon
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel, ModelResult
from lightflyer.force.convection import (
    OUTER_RAYLEIGH,
    inner_sphere_conductance,
    sphere_conductance,
)
from lightflyer.force.lu2023 import rayleigh_number
from lightflyer.force.section import ForceSection
from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.quantity import StandardErrors
from lightflyer.foundation.types import Numeric
from lightflyer.foundation.units import Measured

_OUTER_SCATTER = 0.15
"""Standard uncertainty of the law outside, relative [1]: what laws of turbulent convection differ
by, see :func:`~lightflyer.force.convection.sphere_nusselt`."""

_INNER_SCATTER = 0.5 * math.log(2.5)
"""Standard uncertainty of the law within, of its logarithm [1]: two in use differ 2.5 times."""


class BalloonConvection(AbstractForceModel):
    r"""Heat that a balloon's envelope exchanges with the gas outside and inside.

    .. math::
        Q_\mathrm{envelope} = G_o\,\theta_e - G_i\,(\theta_g - \theta_e), \qquad
        Q_\mathrm{gas} = G_i\,(\theta_g - \theta_e)

    with the conductances of :mod:`lightflyer.force.convection`.

    A sphere of one temperature is not pushed by the gas: the buoyancy of the gas within, which is
    the flyer's, is all of the lift.

    Attributes
    ----------
    outer_error, inner_error : array or None
        Deviation of the truth from the laws of convection outside and inside, in their standard
        errors [1]: 15 % and a factor of 1.6. A flyer file gives both as 0 ± 1, so that they are
        part of a prediction's uncertainty. None stands for zero.

    Notes
    -----
    The balloon drifts with the wind and neither rises nor sinks: convection is natural. The
    envelope has one temperature. In sunlight its upper side is warmer than the lower one, which
    radiation and convection within even out in part.

    Without a source of heat in the gas within, it is as warm as the envelope, whatever the law of
    convection there.

    References
    ----------
    [Churchill1983]_, [CarlsonHorn1983]_
    """

    flyers: ClassVar[tuple[type[AbstractFlyer], ...]] = (Balloon,)
    results: ClassVar[Mapping[str, ModelResult]] = {
        "filled_share": ModelResult("", "share of the envelope's volume that gas fills"),
        "gas_inside": ModelResult("kg", "mass of the gas inside", "g"),
        "overpressure": ModelResult("Pa", "highest overpressure inside, at the top"),
        "film_tension": ModelResult("N/m", "force per length in the film at the top"),
    }

    outer_error: StandardErrors | None = None
    inner_error: StandardErrors | None = None

    @entry_point
    def heat_loss(
        self, flyer: Balloon, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        """See :meth:`AbstractForceModel.heat_loss`."""
        envelope, gas = unknowns
        inner = inner_sphere_conductance(
            gas,
            envelope,
            radius=flyer.radius,
            tac=flyer.film.tac_bottom,
            pressure=state.pressure,
            temperature=state.temperature,
            gravity=state.gravity,
            gas=state.gas,
            convection=_factor(self.inner_error, _INNER_SCATTER),
        )
        outward = inner * (gas - envelope)
        return self._outer_heat(flyer, state, envelope) - outward, outward

    @entry_point
    def force(self, flyer: Balloon, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
        """See :meth:`AbstractForceModel.force`: none on a sphere of one temperature."""
        del flyer
        return 0.0 * (unknowns[0] + state.pressure)

    def own_results(
        self, flyer: Balloon, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> dict[str, Array]:
        """See :meth:`AbstractForceModel.own_results`."""
        within = flyer.filling(state, unknowns[1])
        outside = state.gas.density(state.pressure, state.temperature)
        # what gas of other weight adds over the height that it fills, at most the balloon's
        lighter = outside - within.mass / within.volume
        head = lighter * state.gravity * 2.0 * flyer.radius
        overpressure = within.overpressure + jnp.maximum(head, 0.0)
        return {
            "filled_share": within.volume / flyer.volume,
            "gas_inside": within.mass + 0.0 * within.volume,
            "overpressure": overpressure,
            "film_tension": 0.5 * overpressure * flyer.radius,
        }

    def caveats(
        self, flyer: Balloon, state: EnvironmentState, temperature: Numeric
    ) -> tuple[str, ...]:
        """See :meth:`AbstractForceModel.caveats`."""
        excess = np.asarray(temperature) / state.temperature - 1.0
        rayleigh = rayleigh_number(
            excess,
            radius=flyer.radius,
            pressure=state.pressure,
            temperature=state.temperature,
            gravity=state.gravity,
            gas=state.gas,
        )
        return (
            *OUTER_RAYLEIGH.caveats(rayleigh, state.pressure),
            *_of_filling(flyer, state, self.own_results(flyer, state, (excess, excess))),
            *_of_power(flyer),
        )

    def _outer_heat(self, flyer: Balloon, state: EnvironmentState, excess: Array) -> Array:
        share = 1.0 - flyer.open_share
        return (
            excess
            * share
            * sphere_conductance(
                excess,
                radius=flyer.radius,
                tac=flyer.film.tac_top,
                pressure=state.pressure,
                temperature=state.temperature,
                gravity=state.gravity,
                gas=state.gas,
                wall_distance=state.wall_distance,
                convection=_factor(self.outer_error, _OUTER_SCATTER),
            )
        )


def _factor(error: Numeric | None, scatter: float) -> Numeric:
    return 1.0 if error is None else jnp.exp(error * scatter)


def _of_filling(
    flyer: Balloon, state: EnvironmentState, found: Mapping[str, Array]
) -> Iterator[str]:
    pressure, share, tension = np.broadcast_arrays(
        state.pressure, found["filled_share"], found["film_tension"]
    )
    slackest, tightest = int(np.argmin(share)), int(np.argmax(tension))
    if share.ravel()[slackest] < 1.0 - _ROUNDING:
        yield (
            f"the gas fills {share.ravel()[slackest]:.2g} of the envelope at "
            f"{pressure.ravel()[slackest]:.3g} Pa: light and heat are those of the full sphere"
        )
    worst = tension.ravel()[tightest]
    if flyer.film_strength is not None and worst > np.min(flyer.film_strength):
        yield (
            f"the film must bear {worst:.3g} N/m at {pressure.ravel()[tightest]:.3g} Pa, and its "
            f"film_strength is {np.min(flyer.film_strength):.3g} N/m"
        )


def _of_power(flyer: Balloon) -> Iterator[str]:
    if flyer.molar_mass is not None and np.any(np.asarray(flyer.power) > 0.0):
        yield (
            "the heat from the gas within to the envelope is that of the gas around, and the gas "
            "within is another one"
        )


_ROUNDING = 1e-9


class BalloonForceSection(ForceSection):
    """``[force]``: convection and buoyancy of a balloon; the laws' own errors count."""

    model_type: ClassVar[type[AbstractForceModel]] = BalloonConvection

    model: Literal["balloon"]
    outer_error: StandardErrors = Measured(0.0, 1.0)
    inner_error: StandardErrors = Measured(0.0, 1.0)

    def build(self) -> BalloonConvection:
        """The force model."""
        return BalloonConvection(self.outer_error.value, self.inner_error.value)
