r"""The balloon's model: natural convection around it; the gas pushes by its buoyancy alone."""

from collections.abc import Iterator, Mapping
from typing import ClassVar, Literal

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import StandardErrors
from lightflyer.core.validity import Looks
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.balloon import Balloon
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel, ModelResult
from lightflyer.force.convection import OUTER_RAYLEIGH, sphere_conductance
from lightflyer.force.lu2023 import rayleigh_number
from lightflyer.force.section import ForceSection

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
        del flyer
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
        return tuple(_filling_diagnostics(flyer, state, found))


def _filling_diagnostics(
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
            f"the film must withstand {worst:.3g} N/m at {pressure.ravel()[tightest]:.3g} Pa; its "
            f"film_strength is {np.min(flyer.film_strength):.3g} N/m"
        )


class BalloonForceSection(ForceSection, of=BalloonConvection):
    """``[force]``: convection and buoyancy of a balloon; the law's own error counts."""

    model: Literal["balloon"]
