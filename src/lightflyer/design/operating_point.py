"""One flyer in one place, and everything that follows, computed when it is first asked for."""

from collections.abc import Iterable
from functools import cached_property
from typing import Any

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Numeric, xp
from lightflyer.array.transformations import stop_gradient
from lightflyer.budget.payload import Needs, light_on_cells
from lightflyer.core.errors import ParameterError
from lightflyer.core.validity import covers
from lightflyer.design.setup import Setup
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.shape import Shape
from lightflyer.statics.balance import Equilibrium, equilibrium
from lightflyer.statics.bands import Band, levitation_bands, scan, widest
from lightflyer.statics.equations import FlightEquations
from lightflyer.statics.levitation import Levitation, levitate
from lightflyer.statics.sinking import (
    Sinking,
    in_the_dark,
    night_length,
    night_places,
    sinking,
    sinks_level,
    steady_speed,
)

_LOOKS = 101  # places of the first look for the largest payload


def sinks_at_night(setup: Setup) -> bool:
    """Whether there is a way down for the flyer, and a steady speed on it."""
    return setup.environment.coordinate.name == "altitude" and sinks_level(setup.flyer)


def _list_names(names: Iterable[str]) -> str:
    return ", ".join(sorted(names)) or "none"


class OperatingPoint:
    """A setup at a coordinate, to be used within a public function.

    Parameters
    ----------
    setup : Setup
    coordinate : array, shape (...), optional
        Altitude [m] or pressure [Pa]; not needed by what is searched over it.
    irradiance : array, shape (...), optional
        In place of the environment's [W/m²].
    """

    def __init__(
        self, setup: Setup, coordinate: Numeric | None = None, irradiance: Numeric | None = None
    ):
        self.setup, self.coordinate, self._irradiance = setup, coordinate, irradiance
        self.converged: Any = True
        self.exists: Any = True
        self.residual: Any = 0.0

    @property
    def flyer(self) -> Any:
        """The flyer."""
        return self.setup.flyer

    @cached_property
    def state(self) -> EnvironmentState:
        """Surroundings."""
        state = self.setup.environment.state(self.coordinate)
        if self._irradiance is None:
            return state
        return tree.replace_at(lambda state: state.radiation.irradiance, state, self._irradiance)

    @cached_property
    def equations(self) -> FlightEquations:
        """Powers and forces in the available light."""
        return FlightEquations(self.flyer, self.state, self.setup.model)

    @cached_property
    def balance(self) -> Equilibrium:
        """Heat balance in the available light."""
        found = equilibrium(self.flyer, self.state, self.setup.model, throw=False)
        self._note(found)
        return found

    @cached_property
    def flows(self) -> dict[str, Any]:
        """Flows of the flyer in the available light, by name."""
        values = self.balance.unknowns[len(self.flyer.nodes) :]
        return dict(zip(self.flyer.flows, values, strict=True))

    @cached_property
    def own_results(self) -> dict[str, Any]:
        """Results of the force model's own in the available light, and flows, by name."""
        model = self.setup.model
        own = model.own_results(self.flyer, self.state, self.balance.unknowns)
        declared = set(model.results) - set(self.flows)
        if set(own) != declared:
            raise ParameterError(
                f"force model {type(model).__name__} declares the results "
                f"{_list_names(declared)} and computes {_list_names(own)}"
            )
        return self.flows | own

    @cached_property
    def buoyancy(self) -> Any:
        """Buoyancy in the available light [N]."""
        return self.equations.buoyancy(self.balance.unknowns)

    @cached_property
    def levitation(self) -> Levitation:
        """Light, temperature and load at which the flyer just levitates."""
        found = levitate(self.flyer, self.state, self.setup.model, throw=False)
        self._note(found)
        return found

    @cached_property
    def sinking(self) -> Sinking:
        """How fast it sinks in the dark."""
        equations = FlightEquations(self.flyer, in_the_dark(self.state), self.setup.model)
        found: Sinking = sinking(equations)
        return found

    @cached_property
    def lift(self) -> Any:
        """Vertical force in the available light, with buoyancy [N]."""
        return self.equations.upward_force(self.balance.unknowns)

    @cached_property
    def weight(self) -> Any:
        """Weight with payload [N]."""
        return self.equations.weight

    @cached_property
    def shape(self) -> Shape:
        """How the flyer holds its shape in the available light."""
        held = self.flyer.held_pressure
        pressure = 0.0 if held is None else self.own_results.get(held, 0.0)
        found: Shape = self.flyer.shape(self.state, self.balance.temperatures, self.lift, pressure)
        return found

    @cached_property
    def bearable_wind(self) -> Any:
        """Speed of air along the axis whose drag is the largest load on the held flyer."""
        unknowns, flyer, state = self.balance.unknowns, self.flyer, self.state
        load = xp.asarray(self.shape.bearable_load)
        speed, _ = steady_speed(lambda speed: flyer.drag(state, unknowns, speed), load)
        return speed

    @cached_property
    def climb_speed(self) -> Any:
        """Speed upwards at which drag balances lift and weight in the available light [m/s]."""
        unknowns, flyer, state = self.balance.unknowns, self.flyer, self.state
        force = xp.asarray(self.lift - self.weight)
        speed, _ = steady_speed(lambda speed: flyer.drag(state, unknowns, speed), force)
        return speed

    @cached_property
    def payload(self) -> Any:
        """Largest payload in the available light [kg]."""
        return self.equations.largest_payload(self.lift)

    @property
    def usable(self) -> Any:
        """One where it levitates in the available light and its films survive, else zero."""
        flies = self.lift >= self.weight
        highest = self.flyer.highest_temperature
        cool = True if highest is None else self.balance.temperature <= highest
        return xp.where(flies & cool, 1.0, 0.0)

    @property
    def covered(self) -> Any:
        """One where force model and gas are within their ranges, else zero."""
        state, hottest = self.state, self.balance.temperature
        looks = (
            *self.setup.model.ranges(self.flyer, state, hottest),
            *state.gas.ranges(state.temperature),
            *state.gas.ranges(hottest),
        )
        return xp.where(covers(looks), 1.0, 0.0)

    @cached_property
    def needs(self) -> Needs:
        """What the payload of the budget needs in the available light."""
        if self.setup.budget is None:
            raise ParameterError("the setup has no budget of a payload")
        return self.setup.budget.needs(light_on_cells(self.state.radiation, self.flyer.attitude))

    @cached_property
    def band(self) -> Band:
        """Widest band of the coordinate in which it levitates."""
        return widest(self._bands(usable=False))

    @cached_property
    def usable_band(self) -> Band:
        """Widest part of the bands in which its films survive."""
        return widest(self._usable_bands)

    @cached_property
    def _usable_bands(self) -> Band:
        return self._bands(usable=True)

    def _bands(self, *, usable: bool) -> Band:
        setup = self.setup
        found = levitation_bands(
            setup.flyer,
            setup.environment,
            setup.model,
            setup.searched,
            usable=usable,
            throw=False,
        )
        self.converged = self.converged & xp.all(found.converged, axis=0)
        return found

    @cached_property
    def rest(self) -> "OperatingPoint":
        """The upper edge of the widest band, at which it comes to rest when released."""
        return self.at(self.band.upper, self.band.exists & ~self.band.upper_open)

    @cached_property
    def peak(self) -> "OperatingPoint":
        """The place of the largest payload, whatever its films withstand."""
        low, high = (xp.asarray(end, float) for end in self.setup.searched)
        return self.at(self._place_of_most(low, high), True)

    @cached_property
    def usable_payload(self) -> Any:
        """Largest payload where its films survive [kg]; NaN where they do nowhere."""
        parts = self._usable_bands
        low, high = (
            xp.where(parts.exists, edge, self.setup.searched[0])
            for edge in (parts.lower, parts.upper)
        )
        found = self.at(self._place_of_most(low, high), parts.exists)
        known = parts.exists & ~xp.isnan(found.payload)
        most = xp.max(xp.where(known, found.payload, -np.inf), axis=0)
        return xp.where(xp.any(known, axis=0), most, np.nan)

    @cached_property
    def longest_night(self) -> Any:
        """Time to sink in the dark from its place of rest to the lower edge of the band [s]."""
        setup, band = self.setup, self.band
        if not sinks_at_night(setup):
            return np.nan
        low, high = setup.searched
        start, end = (
            xp.where(self.rest.exists, edge, other)
            for edge, other in ((band.upper, high), (band.lower, low))
        )
        places = xp.moveaxis(night_places(start, end), -1, 0)  # elements are the last axes
        speed = OperatingPoint(setup, places).sinking.speed
        night = night_length(start, end, xp.moveaxis(speed, 0, -1))
        return xp.where(self.rest.exists, night, np.nan)

    def at(self, coordinate: Numeric, exists: Any) -> "OperatingPoint":
        """The same flyer at places, of which only those that exist must converge."""
        found = OperatingPoint(
            self.setup, xp.where(exists, coordinate, self.setup.searched[0]), self._irradiance
        )
        balance = found.balance  # which notes whether it converged
        found.exists = exists
        self.converged = self.converged & xp.all(balance.converged | ~exists)
        return found

    def _place_of_most(self, low: Any, high: Any) -> Any:
        """Place of the largest payload in ranges; at an end it moves with that."""
        frozen = stop_gradient((self.setup, low, high))

        def payload(way: Any) -> Any:
            setup, low, high = frozen
            return OperatingPoint(setup, low + way * (high - low), self._irradiance).payload

        _, way, _ = scan(payload, xp.linspace(0.0, 1.0, _LOOKS))
        return low + way * (high - low)

    def _note(self, found: Equilibrium | Levitation) -> None:
        self.converged = self.converged & found.converged
        self.residual = self.residual + xp.abs(found.residual)
