"""What a flyer at rest gains, loses and carries: what balance and levitation solve."""

from collections.abc import Callable
from functools import reduce
from typing import Any, TypeAlias

from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import require_fit, require_record, shapes_in
from lightflyer.core.types import Numeric
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel
from lightflyer.program.entry_point import entry_point
from lightflyer.pytree.lazy_jax import Array, jax, jnp
from lightflyer.pytree.module import Module


@entry_point
def weight(flyer: AbstractFlyer, state: EnvironmentState) -> Numeric:
    """Weight of a flyer with its payload [N].

    Parameters
    ----------
    flyer : AbstractFlyer
    state : EnvironmentState

    Returns
    -------
    array, broadcast shape
    """
    return flyer.mass * state.gravity


Balance: TypeAlias = Callable[..., tuple[tuple[Array, ...], ...]]
"""By the unknowns: what each node loses to the gas and else [W], and the equations of flows [1]."""


class FlightEquations(Module):
    """Powers and forces of a flyer at rest, by its unknowns: excess of each node, then flows."""

    flyer: AbstractFlyer
    state: EnvironmentState
    model: AbstractForceModel

    def __check_init__(self) -> None:
        require_record("flyer", (AbstractFlyer,), self.flyer)
        require_record("state", (EnvironmentState,), self.state)
        require_record("model", (AbstractForceModel,), self.model)
        self.model.require_flyer(type(self.flyer))
        self.model.require_gas(self.state.gas)
        require_fit({
            **shapes_in(self.flyer, "flyer."),
            **shapes_in(self.state, "state."),
            **shapes_in(self.model),
        })  # fmt: skip

    @property
    def has_one_unknown(self) -> bool:
        """Whether one temperature is all that is unknown."""
        return len(self.flyer.nodes) == 1 and not self.flyer.flows

    @property
    def lifts_unheated(self) -> bool:
        """Whether the flyer may be lifted though it is no warmer than the gas."""
        buoyant = type(self.flyer).buoyancy is not AbstractFlyer.buoyancy
        return buoyant or self.model.pushes_unheated(self.flyer, self.state)

    @property
    def weight(self) -> Numeric:
        """Weight with payload [N]."""
        return weight(self.flyer, self.state)

    def unknowns_at(self, excess: Any) -> tuple[Any, ...]:
        """Unknowns of a flyer whose nodes are equally warm and in which nothing flows [1]."""
        return (excess,) * len(self.flyer.nodes) + (0.0 * excess,) * len(self.flyer.flows)

    def powers(self, irradiance: Numeric) -> tuple[Array, ...]:
        """Net power that each node absorbs under an irradiance of the beam [W]."""
        areas, gains = self.flyer.beam_areas(self.state), self.flyer.heat_gains(self.state)
        return tuple(irradiance * area + gain for area, gain in zip(areas, gains, strict=True))

    def irradiance_for(self, loss: Array) -> tuple[Array, Array]:
        """Irradiance under which all nodes together gain a power [W/m²], and whether one does."""
        area = total(self.flyer.beam_areas(self.state))
        needed = loss - total(self.flyer.heat_gains(self.state))
        return needed / jnp.where(area > 0.0, area, 1.0), area > 0.0

    def heat_flows(self, unknowns: tuple[Any, ...]) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
        """Power that each node loses to the gas, and by radiation and to the others [W]."""
        gas = self.model.heat_loss(self.flyer, self.state, unknowns)
        gas = require_record("heat_loss()", (tuple,), gas)
        return gas, self.flyer.heat_losses(self.state, unknowns)

    def losses(self, unknowns: tuple[Any, ...]) -> tuple[Array, ...]:
        """Power that each node loses [W]."""
        return tuple(taken + given for taken, given in zip(*self.heat_flows(unknowns), strict=True))

    def trace_balance(self, shape: tuple[int, ...]) -> Balance:
        """All but the powers of the equations, traced once for all who call it."""

        def balance(*unknowns: Array) -> tuple[tuple[Array, ...], ...]:
            flows = self.model.flow_balance(self.flyer, self.state, unknowns)
            return *self.heat_flows(unknowns), tuple(flows)

        traced = jax.jit(balance)
        return lambda *unknowns: traced(*(jnp.broadcast_to(one, shape) for one in unknowns))

    def trace_whole_balance(self, powers: tuple[Array, ...]) -> tuple[Balance, tuple[int, ...]]:
        """The same in the shape that it gives with the powers, and that shape."""
        # traced once more only where the shape of the powers is not the whole one
        nothing = self.unknowns_at(jnp.zeros(()))
        given = jnp.shape(total(powers))
        balance = self.trace_balance(given)
        gas, own, _ = jax.eval_shape(balance, *nothing)
        shape = jnp.broadcast_shapes(given, *(part.shape for part in (*gas, *own)))
        return (balance if shape == given else self.trace_balance(shape)), shape

    def upward_force(self, unknowns: tuple[Any, ...]) -> Array:
        """Vertical part of the gas's force, and the flyer's buoyancy [N]."""
        force = self.model.force(self.flyer, self.state, unknowns)
        if not hasattr(force, "dtype") and not isinstance(force, float):
            raise ParameterError(f"force() must give an array, not {type(force).__name__}")
        if self.flyer.attitude is not None:
            force = force * jnp.cos(self.flyer.attitude.tilt)
        return force + self.buoyancy(unknowns)

    def buoyancy(self, unknowns: tuple[Any, ...]) -> Numeric:
        """Buoyancy that the model adds to its force [N]; zero for a published one that has none."""
        if not self.model.adds_buoyancy:
            return 0.0 * unknowns[0]
        return self.flyer.buoyancy(self.state, unknowns)

    def largest_payload(self, lift: Numeric) -> Numeric:
        """Mass that a lift carries beside the flyer's own [kg]."""
        return lift / self.state.gravity - self.flyer.own_mass


def total(parts: tuple[Numeric, ...]) -> Any:
    """Sum over the nodes."""
    return reduce(lambda one, other: one + other, parts)
