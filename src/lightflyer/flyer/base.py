"""Base class of flyers: what the heat balance and the force models need of them."""

import abc
import dataclasses
from typing import TYPE_CHECKING, Any, ClassVar

import equinox as eqx
from jax import Array

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Checked, Mass
from lightflyer.core.types import Numeric
from lightflyer.drag.disk import Direction
from lightflyer.environment.base import EnvironmentState
from lightflyer.environment.radiation import Attitude
from lightflyer.film.properties import FilmProperties

HIGHEST_TEMPERATURE = 3000.0
"""Highest temperature of the search [K]: no film survives it, and the gas correlations end
below it."""


class AbstractFlyer(Checked):
    r"""A body with one or several temperatures. Subclasses are final.

    The temperatures, one for each of :attr:`nodes`, are unknowns of the heat balance. They are
    handed to flyers and force models as relative excesses over the gas,
    :math:`\theta_i = (T_i - T_c)/T_c`, in a tuple of arrays in the order of the nodes, which stays
    exact where flyer and gas differ by a microkelvin. Further unknowns of :attr:`flows` follow in
    the same tuple.

    Attributes
    ----------
    nodes : tuple of str
        Names of the temperatures, such as ``("top", "bottom")``.
    flows : tuple of str
        Names of further unknowns, for which the force model gives an equation each.
    drag_law : str
        What :meth:`drag` rests on, in a few words.
    payload : array
        Mass carried beside the flyer's own [kg].
    attitude : Attitude or None
        How the flyer lies; None stands for level.
    """

    nodes: eqx.AbstractClassVar[tuple[str, ...]]
    flows: ClassVar[tuple[str, ...]] = ()
    drag_law: ClassVar[str] = "of its own"

    if TYPE_CHECKING:
        # a checker takes annotations for the first arguments of every subclass

        @property
        def payload(self) -> Numeric: ...
        @property
        def attitude(self) -> Attitude | None: ...

    else:
        payload: eqx.AbstractVar[Mass]
        attitude: eqx.AbstractVar[Attitude | None]

    @property
    @abc.abstractmethod
    def area(self) -> Numeric:
        """Area seen from above when level [m²]."""

    @property
    @abc.abstractmethod
    def own_mass(self) -> Numeric:
        """Mass without payload [kg]."""

    @abc.abstractmethod
    def beam_areas(self, state: EnvironmentState) -> tuple[Array, ...]:
        """Light that each node absorbs, per irradiance of the beam.

        Parameters
        ----------
        state : EnvironmentState

        Returns
        -------
        tuple of array, shape (...)
            One for each node [m²].
        """

    @abc.abstractmethod
    def heat_gains(self, state: EnvironmentState) -> tuple[Array, ...]:
        """Power that each node absorbs beside the beam.

        Diffuse light, and heat radiation beyond that of black surroundings at the gas temperature.

        Parameters
        ----------
        state : EnvironmentState

        Returns
        -------
        tuple of array, shape (...)
            One for each node [W].
        """

    @abc.abstractmethod
    def heat_losses(self, state: EnvironmentState, unknowns: tuple[Array, ...]) -> tuple[Any, ...]:
        """Power that each node gives away by radiation and conduction, but not to the gas.

        Parameters
        ----------
        state : EnvironmentState
        unknowns : tuple of array, shape (...)
            Relative temperature excess of each node [1], then the flows.

        Returns
        -------
        tuple of array, shape (...)
            One for each node [W], zero where all excesses are: radiation to black surroundings at
            the gas temperature, radiation and conduction to the other nodes.
        """

    @abc.abstractmethod
    def describe(self) -> str:
        """Description in a few words, such as ``"disk of 2 cm"``."""

    @property
    def highest_temperature(self) -> Numeric | None:
        """Temperature that all its films bear [K]; None where it is not known."""
        limits = [getattr(self, name).highest_temperature for name in self.film_names()]
        return min((limit for limit in limits if limit is not None), default=None)

    @classmethod
    def film_names(cls) -> tuple[str, ...]:
        """Names of the fields that are films."""
        fields = dataclasses.fields(cls)
        return tuple(field.name for field in fields if field.type is FilmProperties)

    @property
    def mass(self) -> Numeric:
        """Mass with payload [kg]."""
        return self.own_mass + self.payload

    @property
    def displaced_volume(self) -> Numeric:
        """Volume of gas that the flyer displaces [m³]; zero for films."""
        return 0.0

    def buoyancy(self, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Numeric:
        """Weight of the gas that the flyer displaces, less that of the gas it holds.

        Parameters
        ----------
        state : EnvironmentState
        unknowns : tuple of array, shape (...)
            Relative temperature excess of each node [1], then the flows.

        Returns
        -------
        array, broadcast shape
            Upward positive [N]. By default that of :attr:`displaced_volume`, the same at every
            temperature; a body that holds warm gas has its own.
        """
        del unknowns
        volume = self.displaced_volume
        if isinstance(volume, float) and volume == 0.0:
            return 0.0
        return state.gas.density(state.pressure, state.temperature) * volume * state.gravity

    def drag(
        self,
        state: EnvironmentState,
        unknowns: tuple[Array, ...],
        speed: Numeric,
        direction: Direction = "broadside",
    ) -> Array:
        """Drag of the gas on the flyer that moves through it.

        Parameters
        ----------
        state : EnvironmentState
        unknowns : tuple of array, shape (...)
            Relative temperature excess of each node [1], then the flows.
        speed : array, shape (...)
            Of the flyer relative to the gas, of either sign [m/s].
        direction : {"broadside", "edgewise"}
            Whether it moves along its axis or across it.

        Returns
        -------
        array, broadcast shape
            Force against the motion, of the sign of the speed [N]. It comes on top of the force of
            the gas on the flyer at rest.

        Raises
        ------
        ConfigurationError
            If the class has no law of drag.
        """
        del state, unknowns, speed, direction
        raise ConfigurationError(
            f"{type(self).__name__} has no law of drag: give its class a method drag()"
        )

    def drag_diagnostics(
        self,
        state: EnvironmentState,
        speed: Numeric,
        direction: Direction = "broadside",
        temperature: Numeric | None = None,
    ) -> tuple[str, ...]:
        """Warnings, in words, where :meth:`drag` is outside its range or an estimate.

        Parameters
        ----------
        state : EnvironmentState
            Concrete numbers, at one place or many.
        speed : array, shape (...)
            As for :meth:`drag`; concrete [m/s].
        direction : {"broadside", "edgewise"}
        temperature : array, shape (...), optional
            Of the flyer's hottest node there, concrete [K]; by default that of the gas.

        Returns
        -------
        tuple of str
        """
        del state, speed, direction, temperature
        return ()

    def diagnostics(self, state: EnvironmentState, temperature: Numeric) -> tuple[str, ...]:
        """Warnings, in words, where the flyer's own description does not hold, such as its optics.

        Parameters
        ----------
        state : EnvironmentState
            Concrete numbers, at one place or many.
        temperature : array, shape (...)
            Of the flyer's hottest node there, concrete [K].

        Returns
        -------
        tuple of str
        """
        del state, temperature
        return ()

    def highest_excess(self, state: EnvironmentState, power: Array) -> Array:
        r"""Bound of the size of the excesses when the flyer absorbs a power.

        Parameters
        ----------
        state : EnvironmentState
        power : array, shape (...)
            Net power absorbed by all nodes together [W]; negative below gas temperature.

        Returns
        -------
        array, shape (...)
            Largest possible :math:`|\theta|` [1].
        """
        return HIGHEST_TEMPERATURE / state.temperature + 0.0 * power

    def first_guess(self, state: EnvironmentState, excess: Array) -> tuple[Array, ...]:
        """Unknowns from which the search for several begins.

        Parameters
        ----------
        state : EnvironmentState
        excess : array, shape (...)
            Excess at which all nodes together are in balance if they had one temperature [1].

        Returns
        -------
        tuple of array, shape (...)
            One for each node, then one for each flow.
        """
        del state
        return (excess,) * len(self.nodes) + (0.0 * excess,) * len(self.flows)
