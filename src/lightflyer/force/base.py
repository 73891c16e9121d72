"""Base class of force models, and ``[force]`` of a flyer file.

A force model answers two questions about a flyer that is not as warm as the gas: how much heat does
the gas take from each part of it, and how strongly does the gas push it? A new model is one small
file with one final class over laws that are plain functions of plain numbers.
"""

import abc
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, ClassVar

from lightflyer.array.namespace import Array, Numeric
from lightflyer.array.records import AbstractClassVar, ShortRepr
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import Checked, quantities_of
from lightflyer.core.validity import Looks, describe
from lightflyer.environment.base import EnvironmentState
from lightflyer.files.section import Alternative
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.gas.base import AbstractGas

ANY_GAS = ("monatomic", "diatomic", "polyatomic")
"""Kinds of molecules, for a model that holds for all of them."""


@dataclass(frozen=True)
class ModelResult(ShortRepr):
    """A result of a force model's own, such as the velocity of the gas through a wall."""

    unit: str  #: SI unit as flyer files write it, such as ``"m/s"``; empty for a pure number
    long_name: str  #: As in datasets and on axes
    #: Unit in tables, figures and JSON, such as ``"mPa"``; empty for the SI unit
    shown_unit: str = ""


class AbstractForceModel(Checked):
    r"""Heat loss to the gas and photophoretic force of one kind of flyer.

    Its methods must broadcast; NumPy does for all but JAX, ``lightflyer.xp`` for that too. They
    take the unknowns of the flyer: the relative temperature excess
    :math:`\theta_i = (T_i - T_c)/T_c` of each node, then its flows.
    The solvers rely on two properties: all heat losses together increase with a common excess and
    are zero at zero excess; the force, where it is positive, does not decrease as the light grows.
    """

    #: Classes of flyers that the model is for
    flyers: AbstractClassVar[tuple[type[AbstractFlyer], ...]]
    #: Kinds of gas that it is for, of :data:`ANY_GAS`
    molecules: ClassVar[tuple[str, ...]] = ANY_GAS
    #: Results of the model's own by name, which :meth:`own_results` computes. They are among the
    #: outputs of predictions, sweeps, optimisations and sensitivities. A flow of the flyer is among
    #: them without being declared; declared here, it gets a unit
    results: ClassVar[Mapping[str, ModelResult]] = MappingProxyType({})
    #: Whether the buoyancy of the flyer adds to the force. A published force that has none, and was
    #: published without, keeps none
    adds_buoyancy: ClassVar[bool] = True
    #: Whether heat loss or force depend on walls around the flyer. Where they do not, a result in a
    #: chamber whose walls are given says so
    feels_walls: ClassVar[bool] = True
    feels_floor: ClassVar[bool] = False  #: The same for a floor and a lid

    @abc.abstractmethod
    def heat_loss(
        self, flyer: Any, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        """Heat that the gas takes from each node [W], each of broadcast shape."""

    @abc.abstractmethod
    def force(self, flyer: Any, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
        """Force of the gas on the flyer along its axis, towards the top face positive [N]."""

    def pushes_unheated(self, flyer: Any, state: EnvironmentState) -> bool:
        """Whether a flyer that is as warm as the gas is pushed too."""
        return False

    def flow_balance(
        self, flyer: Any, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        """Equations of the flyer's flows, one each, scaled to order one and zero in balance."""
        return ()

    def own_results(
        self, flyer: Any, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> dict[str, Any]:
        """Values of :attr:`results` in balance, in SI units; not those of the flyer's flows."""
        return {}

    def ranges(self, flyer: Any, state: EnvironmentState, temperature: Numeric) -> Looks:
        """Ranges in which the model is known to hold, each with a number of the flyer's.

        ``temperature`` is that of the hottest node [K].
        """
        return ()

    def remarks(self, flyer: Any, state: EnvironmentState, temperature: Numeric) -> tuple[str, ...]:
        """What else to warn of; arguments are concrete."""
        return ()

    def diagnostics(
        self, flyer: Any, state: EnvironmentState, temperature: Numeric
    ) -> tuple[str, ...]:
        """Warnings where a flyer or its surroundings are outside the model's range."""
        outside = describe(self.ranges(flyer, state, temperature), state.pressure)
        return outside + self.remarks(flyer, state, temperature)

    @property
    def open_errors(self) -> tuple[str, ...]:
        """Names of its own errors that nobody has stated; a prediction counts them."""
        known = quantities_of(type(self)).items()
        return tuple(
            name for name, one in known if one.in_files is not None and getattr(self, name) is None
        )

    def assumptions(self, flyer: Any) -> tuple[str, ...]:
        """What the model assumes about a flyer that a reader must know, in short texts."""
        return ()

    @classmethod
    def require_flyer(cls, flyer: type[AbstractFlyer]) -> None:
        """Raise :class:`ParameterError` unless the model is for a class of flyers."""
        if not issubclass(flyer, cls.flyers):
            known = ", ".join(kind.__name__ for kind in cls.flyers)
            raise ParameterError(
                f"force model {cls.__name__} is not for {flyer.__name__}; it is for {known}"
            )

    def require_gas(self, gas: AbstractGas) -> None:
        """Raise :class:`ParameterError` unless the model is for a gas."""
        if gas.molecules not in self.molecules:
            raise ParameterError(
                f"force model {type(self).__name__} is not for {gas.name}, whose molecules are "
                f"{gas.molecules}; it is for {' and '.join(self.molecules)} gas"
            )


class ForceSection(Alternative):
    """``[force]``: a force model."""

    choosing_keys: ClassVar[tuple[tuple[str, str], ...]] = (("model", "kinetic"),)
    model_type: ClassVar[type[AbstractForceModel]]
    """Class of the model that the section builds."""

    def __init_subclass__(cls, of: type[AbstractForceModel] | None = None, **options: Any) -> None:
        if of is not None:
            cls.model_type = of
        super().__init_subclass__(of=of, **options)

    def build(self) -> AbstractForceModel:
        """The force model."""
        return self.make()
