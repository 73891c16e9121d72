"""What a flyer at rest gains, loses and carries: what balance and levitation solve."""

from collections.abc import Callable
from functools import reduce, wraps
from typing import Any

import numpy as np

from lightflyer.array.memory import is_traceable, kept, part_known, traced_once
from lightflyer.array.namespace import Array, Numeric, as_numpy, double, xp
from lightflyer.array.records import Module, field
from lightflyer.core.checks import is_traced
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import require_fit, require_record, shapes_in
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel


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


class _Begun(Module):
    """A function of unknowns of one shape, as far as it does not depend on them."""

    values: tuple[Array, ...]
    rest: Any = field(static=True)
    shape: tuple[int, ...] = field(static=True)


def _of_unknowns(method: Callable[..., Any]) -> Callable[..., Any]:
    """Let a method go on from where it has begun."""
    once = traced_once(method)

    @wraps(method)
    def wrapper(equations: "FlightEquations", unknowns: tuple[Any, ...]) -> Any:
        begun = equations.begun.get(method.__name__)
        if begun is not None and all(xp.shape(one) == begun.shape for one in unknowns):
            return begun.rest(begun.values, tuple(map(double, unknowns)))
        return once(equations, unknowns)

    return wrapper


class FlightEquations(Module):
    """Powers and forces of a flyer at rest, by its unknowns: excess of each node, then flows."""

    flyer: AbstractFlyer
    state: EnvironmentState
    model: AbstractForceModel
    begun: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:  # also where a public function makes it of given parts
        require_record("flyer", (AbstractFlyer,), self.flyer)
        require_record("state", (EnvironmentState,), self.state)
        require_record("model", (AbstractForceModel,), self.model)
        self.model.require_flyer(type(self.flyer))
        self.model.require_gas(self.state.gas)

    def __check_init__(self) -> None:
        require_fit({
            **shapes_in(self.flyer, "flyer."),
            **shapes_in(self.state, "state."),
            **shapes_in(self.model),
        })  # fmt: skip

    def begin(self, *, with_force: bool = False) -> "FlightEquations":
        """The same for a search: JAX computes now what all its steps have in common."""
        parts = self.flyer, self.state, self.model
        if self.begun or not is_traceable(parts):
            return self
        shape = np.broadcast_shapes(*(one for part in parts for one in shapes_in(part).values()))
        unknowns = self.unknowns_at(xp.zeros(shape))
        begun: dict[str, Any] = {"light": _areas_and_gains(self.flyer, self.state)}
        for name in ("heat_flows", "_flow_balance", "upward_force")[: 3 if with_force else 2]:
            method = getattr(FlightEquations, name).__wrapped__

            def whole(parts: Any, unknowns: Any, method: Any = method) -> Any:
                return method(FlightEquations(*parts), unknowns)

            begun[name] = _Begun(*part_known(whole, parts, unknowns, name), shape)
        return FlightEquations(*parts, begun)

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
        areas, gains = self._areas_and_gains
        return tuple(irradiance * area + gain for area, gain in zip(areas, gains, strict=True))

    @property
    def _areas_and_gains(self) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
        return self.begun.get("light") or _areas_and_gains(self.flyer, self.state)

    def irradiance_for(self, loss: Array) -> tuple[Array, Array]:
        """Irradiance under which all nodes together gain a power [W/m²], and whether one does."""
        area, gain = map(total, self._areas_and_gains)
        needed = loss - gain
        return needed / xp.where(area > 0.0, area, 1.0), area > 0.0

    @_of_unknowns
    def heat_flows(self, unknowns: tuple[Any, ...]) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
        """Power that each node loses to the gas, and by radiation and to the others [W]."""
        gas: Any = self.model.heat_loss(self.flyer, self.state, unknowns)
        nodes = self.flyer.nodes
        if not isinstance(gas, tuple) or len(gas) != len(nodes):
            given = f"{len(gas)}" if isinstance(gas, tuple) else type(gas).__name__
            raise ParameterError(
                f"heat_loss() of {type(self.model).__name__} must give a tuple with a power for "
                f"each node of the flyer ({', '.join(nodes)}), not {given}"
            )
        for power in gas:
            self._require_fit("heat_loss", power, unknowns)
        return as_numpy(gas), self.flyer.heat_losses(self.state, unknowns)

    def losses(self, unknowns: tuple[Any, ...]) -> tuple[Array, ...]:
        """Power that each node loses [W]."""
        return tuple(taken + given for taken, given in zip(*self.heat_flows(unknowns), strict=True))

    def balance(self, unknowns: tuple[Array, ...]) -> tuple[tuple[Array, ...], ...]:
        """What each node loses to the gas and else [W], and the equations of flows [1]."""
        return *self.heat_flows(unknowns), self._flow_balance(unknowns)

    @_of_unknowns
    def _flow_balance(self, unknowns: tuple[Array, ...]) -> tuple[Array, ...]:
        return as_numpy(tuple(self.model.flow_balance(self.flyer, self.state, unknowns)))

    @_of_unknowns
    def upward_force(self, unknowns: tuple[Any, ...]) -> Array:
        """Vertical part of the gas's force, and the flyer's buoyancy [N]."""
        force = self.model.force(self.flyer, self.state, unknowns)
        if not hasattr(force, "dtype") and not isinstance(force, int | float):
            raise ParameterError(f"force() must give an array, not {type(force).__name__}")
        self._require_fit("force", force, unknowns)
        force = as_numpy(force)
        if self.flyer.attitude is not None:
            force = force * xp.cos(self.flyer.attitude.tilt)
        return force + self.buoyancy(unknowns)

    def _require_fit(self, method: str, found: Any, unknowns: tuple[Any, ...] = ()) -> None:
        """Raise unless a model of the user's gives numbers, of the shape of what it was given."""
        if type(self.model).__module__.startswith("lightflyer.") or is_traced(found):
            return
        name = f"{method}() of {type(self.model).__name__}"
        if np.asarray(found).dtype.kind not in "fiu":
            raise ParameterError(f"{name} must give real numbers, not {found!s:.40}")
        if isinstance(found, np.ndarray | np.generic) and found.dtype == np.float32:
            raise ParameterError(f"{name} gives float32, too coarse for a balance; use float64")
        parts = (self.flyer, "flyer."), (self.state, "state."), (self.model, "")
        shapes = [shape for part in parts for shape in shapes_in(*part).values()]
        expected = np.broadcast_shapes(*shapes, *map(np.shape, unknowns))
        try:
            fits = np.broadcast_shapes(np.shape(found), expected) == expected
        except ValueError:
            fits = False
        if not fits:
            raise ParameterError(
                f"{name} gives an array of shape {np.shape(found)} where flyer and surroundings "
                f"have {expected}"
            )

    def require_force(self, force: Any, converged: Any) -> None:
        """Raise unless a force of a model is a number wherever the heat is in balance."""
        if not is_traced(force) and np.any(~np.isfinite(force) & converged):
            given = "NaN" if np.any(np.isnan(force) & converged) else "an infinite value"
            raise ParameterError(
                f"force() of {type(self.model).__name__} gives {given} at temperatures that "
                "balance the heat"
            )

    def buoyancy(self, unknowns: tuple[Any, ...]) -> Numeric:
        """Buoyancy that the model adds to its force [N]; zero for a published one that has none."""
        if not self.model.adds_buoyancy:
            return 0.0 * unknowns[0]
        return self.flyer.buoyancy(self.state, unknowns)

    def largest_payload(self, lift: Numeric) -> Numeric:
        """Mass that a lift carries beside the flyer's own [kg]."""
        return lift / self.state.gravity - self.flyer.own_mass


@kept
@traced_once
def _areas_and_gains(
    flyer: AbstractFlyer, state: EnvironmentState
) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
    """Light that each node absorbs, per irradiance [m²], and its other gains [W]."""
    return flyer.beam_areas(state), flyer.heat_gains(state)


def total(parts: tuple[Numeric, ...]) -> Any:
    """Sum over the nodes."""
    return reduce(lambda one, other: one + other, parts)
