"""Base class of flyers: what the heat balance and the force models need of them."""

import abc
import dataclasses
from typing import TYPE_CHECKING, Any, ClassVar

from lightflyer.array.namespace import Array, Numeric
from lightflyer.array.records import AbstractClassVar, AbstractVar
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Checked, Mass
from lightflyer.drag.disk import Direction
from lightflyer.environment.base import EnvironmentState
from lightflyer.environment.radiation import Attitude
from lightflyer.film.properties import FilmProperties, lowest_limit
from lightflyer.flyer.shape import Shape

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

    nodes: AbstractClassVar[tuple[str, ...]]
    flows: ClassVar[tuple[str, ...]] = ()
    drag_law: ClassVar[str] = "of its own"
    lifted_by: ClassVar[str] = "the gas around it"
    held_pressure: ClassVar[str | None] = None  # The force model's result that its wall holds
    hangs: ClassVar[str | None] = None  # Why nothing can tilt it, where that is so
    steady: ClassVar[bool] = False  # Whether its steady speed is a result, as of particles
    floats: ClassVar[bool] = False  # Whether buoyancy holds it up, and missions let it settle

    if TYPE_CHECKING:
        # a checker takes annotations for the first arguments of every subclass

        @property
        def payload(self) -> Numeric: ...
        @property
        def attitude(self) -> Attitude | None: ...

    else:
        payload: AbstractVar[Mass]
        attitude: AbstractVar[Attitude | None]

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
        """Light that each node absorbs, per irradiance of the beam [m²], each shape (...)."""

    @abc.abstractmethod
    def heat_gains(self, state: EnvironmentState) -> tuple[Array, ...]:
        """Power that each node absorbs beside the beam [W], each shape (...).

        Diffuse light, and heat radiation beyond that of black surroundings at the gas temperature.
        """

    @abc.abstractmethod
    def heat_losses(self, state: EnvironmentState, unknowns: tuple[Array, ...]) -> tuple[Any, ...]:
        """Power that each node gives away, but not to the gas [W]; zero where all excesses are.

        Radiation to black surroundings at the gas temperature, and radiation and conduction to the
        other nodes.
        """

    @abc.abstractmethod
    def describe(self) -> str:
        """Description in a few words, such as ``"disk of 2 cm"``."""

    @property
    def highest_temperature(self) -> Numeric | None:
        """Temperature that all its films withstand [K]; None where it is not known."""
        return lowest_limit([getattr(self, name) for name in self.film_names()])

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
        """Weight of the gas that the flyer displaces, less that of the gas it holds [N]; upwards.

        By default that of :attr:`displaced_volume`, the same at every temperature.
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
        """Drag of the gas, on top of its force on the flyer at rest [N]; of the sign of the speed.

        ``speed`` [m/s] is relative to the gas, along the axis (broadside) or across it (edgewise).
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
        """Warnings where :meth:`drag` is outside its range or an estimate; arguments are concrete.

        ``temperature`` is that of the hottest node [K]; by default that of the gas.
        """
        del state, speed, direction, temperature
        return ()

    def diagnostics(self, state: EnvironmentState, temperature: Numeric) -> tuple[str, ...]:
        """Warnings where the flyer's own description does not hold, such as its optics.

        ``temperature`` is that of the hottest node [K]; arguments are concrete.
        """
        del state, temperature
        return ()

    @property
    def known_shape(self) -> tuple[str, ...]:
        """What :meth:`shape` knows, by the names of its fields; nothing by default."""
        return ()

    def shape(
        self,
        state: EnvironmentState,
        temperatures: tuple[Array, ...],
        lift: Array,
        pressure: Numeric = 0.0,
    ) -> Shape:
        """How it holds its shape at temperatures of its nodes [K] and a lift [N].

        ``pressure``: within over that outside [Pa], the force model's result :attr:`held_pressure`.
        """
        del state, temperatures, lift, pressure
        raise ConfigurationError(f"{self.describe()}: its layers are not known as a structure")

    def highest_excess(self, state: EnvironmentState, power: Array) -> Array:
        r"""Bound of :math:`|\theta|` [1] when all nodes together absorb a net power [W]."""
        return HIGHEST_TEMPERATURE / state.temperature + 0.0 * power

    def first_guess(self, state: EnvironmentState, excess: Array) -> tuple[Array, ...]:
        """Unknowns from which the search for several begins: nodes, then flows.

        ``excess`` is that of all nodes together, if they had one temperature [1].
        """
        del state
        return (excess,) * len(self.nodes) + (0.0 * excess,) * len(self.flows)
