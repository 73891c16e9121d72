r"""The force from kinetic theory: no fitted constants."""

import dataclasses
from collections.abc import Mapping
from typing import Any, ClassVar, Literal

import pydantic

from lightflyer.array.namespace import Array, Numeric
from lightflyer.array.records import field
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Fraction, StandardErrors
from lightflyer.core.validity import Looks
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.disk import Disk
from lightflyer.flyer.sandwich import Sandwich
from lightflyer.force.base import AbstractForceModel, ForceSection
from lightflyer.force.fitted import GASES
from lightflyer.force.kinetic.collisions import Collisions
from lightflyer.force.kinetic.disk import KineticDisk, Polyatomic
from lightflyer.force.kinetic.ratios import FilmBalance
from lightflyer.force.kinetic.sandwich import KineticSandwich
from lightflyer.force.kinetic.walls import Wall
from lightflyer.force.laws.membrane_transmission import Transmission
from lightflyer.gas.base import AbstractGas

_IDLE = {
    "transmission": "transmission = {0.transmission} has no effect: a disk has no holes",
    "polyatomic": "polyatomic = {0.polyatomic} has no effect: the gas is not polyatomic",
    "rotational_accommodation": "rotational_accommodation has no effect: the gas has no rotation",
    "film_balance": "film_balance has no effect: both membranes are isothermal",
}
"""What is said of options that a flyer's model does not have."""

_OF_WALLS = {
    "sharing_error": ("unknown",),
    "wall_error": ("unknown", "accommodated", "cercignani-lampis"),
    "tangential_accommodation": ("cercignani-lampis",),
    "rotational_accommodation": ("cercignani-lampis",),
}
"""Walls that each of these keys is for."""

_ERRORS = {"sharing_error", "wall_error"}


class Kinetic(AbstractForceModel):
    r"""Force and heat loss of a disk or a sandwich from the solved kinetic equation.

    For a disk

    .. math::
        F = \hat F\,\frac{pA}{2}\,\Delta\alpha\left[\sqrt{T_h/T_c}-1\right], \qquad
        Q = \hat Q\,Q_\mathrm{fm}

    with the free-molecular values at walls that re-emit a share :math:`\alpha` of the molecules
    at the wall's temperature and reflect the rest (Maxwell), or those of another ``wall``. The
    ratios
    :math:`\hat F, \hat Q(\mathrm{Kn}, T_h/T_c, \bar\alpha)` come from the package's own solver
    of the kinetic equation (:mod:`lightflyer.kinetic_theory`); the Knudsen number is that of the
    diameter at the gas temperature.

    Attributes
    ----------
    force_error, heat_error : array or None
        Deviation of the truth from the table, in the model's own standard errors [1]: those
        of the table and of the kinetic equation itself. A flyer file gives both as 0 ± 1, so
        that they are part of a prediction's uncertainty. None stands for zero.
    transmission : {"aligned", "wide"}
        How holes and gap of a sandwich let molecules pass; of no effect on a disk.
    polyatomic : {"refused", "scaled"}
        What becomes of a gas such as carbon dioxide. Scaled, it is taken around a disk for a
        diatomic gas that conducts as it does,
        :func:`~lightflyer.force.kinetic.disk.scaled_heat_ratio`.
    wall : {"unknown", "maxwell", "accommodated", "cercignani-lampis"}
        How molecules leave the faces. Maxwell's reflect a share. From accommodated ones
        all leave at one temperature, without collisions :math:`T_c+\alpha(T_h-T_c)`. Those of
        Cercignani and Lampis accommodate normal and tangential motion each on its own. Unknown
        walls are the middle of the first two.
    wall_error : array or None
        Deviation from these walls in standard errors [1], towards Maxwell's; it moves force and
        heat loss together. A flyer file gives it as 0 ± 1. The 95 % error of unknown walls is half
        of the difference of Maxwell's and accommodated ones, with what collisions take away at each
        or with the same at both, whichever is larger. That of accommodated and Cercignani–Lampis
        walls is what collisions change in them beside Maxwell's, which have none.
    sharing_error : array or None
        Deviation of how unknown walls share the difference of their TACs among normal motion,
        tangential motion and rotation, in standard errors [1]: the pair of TACs leaves it open. A
        flyer file gives it as 0 ± 1. At 0 each kind differs as the TACs do. At 1.96 tangential
        motion and rotation accommodate alike on both faces, and thin gas pushes three times as
        hard (twice, of a monatomic gas). At -1.96 the faces differ in how many molecules they
        trap, and it pushes 0.6 times as hard (:mod:`lightflyer.force.kinetic.walls`).
    tangential_accommodation : array or None
        Accommodation coefficient of tangential momentum, of both faces, for Cercignani–Lampis walls
        [1]. The normal motion then accommodates so much that the TACs are those of the energy
        (:func:`~lightflyer.kinetic_theory.walls.normal_accommodation`). Without it tangential
        energy accommodates as the TACs say. What each kind of accommodation pushes is solved
        (:mod:`lightflyer.force.kinetic.walls`).
    rotational_accommodation : array or None
        That of rotational energy of a diatomic gas, likewise.
    collisions : {"vhs", "shakhov"}
        Those of VHS molecules, by factors on what the model equation's take
        (:mod:`lightflyer.force.kinetic.collisions`), or those of the model equation alone, which
        have a wider error.
    film_balance : {"isothermal", "local"}
        Whether a disk has one temperature, or each spot of its film balances the heat that it
        absorbs and loses (:mod:`lightflyer.force.kinetic.ratios`); the temperature is then
        the mean.

    Notes
    -----
    The table is that of the gas's kind, monatomic or diatomic; there is none for others.

    The table is for Kn from 0.006, :math:`T_h/T_c` from 0.5 to 3.5 and mean TACs from 0.1. In
    denser gas the heat loss goes on as that of conduction, the force as :math:`\mathrm{Kn}^2`;
    natural convection is left out. Below Kn = 0.013 what large temperature differences change is
    held. Beyond the temperature ratios and TACs of the table the ratios stay what they are at its
    ends. Each of these has a warning.

    Faces may differ in their TACs by any amount. The viscosity exponent is that of the gas at the
    mean of the two temperatures.

    A sandwich is one thin disk with holes whose faces are at the temperatures of its membranes,
    with a table of its own (:mod:`lightflyer.force.kinetic.sandwich_table`) up to a rarefaction of
    100, Kn = 0.0044; without holes it is the disk. ``transmission`` says how its holes and its gap
    let molecules pass, :func:`lightflyer.force.laws.membrane_transmission.passage`.

    Where the surroundings have a wall (:attr:`EnvironmentState.wall_distance`), force and heat
    are those in a chamber of that radius. With a floor or a lid the surfaces are solid, each at its
    own distance, and a disk of like faces is pushed too
    (:mod:`lightflyer.force.kinetic.chamber`); a floor of another temperature pushes any disk
    (:mod:`lightflyer.force.kinetic.chamber`).

    References
    ----------
    [Shakhov1968]_, [Rykov1975]_; the page on the kinetic force says how far to trust it.
    """

    flyers: ClassVar[tuple[type[AbstractFlyer], ...]] = (Disk, Sandwich)
    molecules: ClassVar[tuple[str, ...]] = GASES
    feels_floor: ClassVar[bool] = True

    force_error: StandardErrors | None = None
    heat_error: StandardErrors | None = None
    transmission: Transmission = field(static=True, default="aligned")
    polyatomic: Polyatomic = field(static=True, default="refused")
    wall: Wall = field(static=True, default="unknown")
    wall_error: StandardErrors | None = None
    sharing_error: StandardErrors | None = None
    tangential_accommodation: Fraction | None = None
    rotational_accommodation: Fraction | None = None
    collisions: Collisions = field(static=True, default="vhs")
    film_balance: FilmBalance = field(static=True, default="isothermal")

    def __check_init__(self) -> None:
        super().__check_init__()
        for kind in (KineticDisk, KineticSandwich):
            self._model(kind)  # raises for an option that is none

    def model_of(self, flyer: AbstractFlyer) -> Any:
        """The model of a disk, or that of a sandwich, with the options that it has."""
        return self._model(KineticSandwich if isinstance(flyer, Sandwich) else KineticDisk)

    def _model(self, kind: type) -> Any:
        return kind(**{one.name: getattr(self, one.name) for one in dataclasses.fields(kind)})

    @property
    def open_errors(self) -> tuple[str, ...]:
        """Known walls do not have every error."""
        walls = (_OF_WALLS.get(name, (self.wall,)) for name in super().open_errors)
        errors = zip(super().open_errors, walls, strict=True)
        return tuple(name for name, those in errors if self.wall in those)

    def assumptions(self, flyer: AbstractFlyer) -> tuple[str, ...]:
        return self.model_of(flyer).assumptions(flyer)

    def require_gas(self, gas: AbstractGas) -> None:
        self._model(KineticDisk).require_gas(gas)

    @entry_point
    def heat_loss(
        self, flyer: Any, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        return self.model_of(flyer).heat_loss(flyer, state, unknowns)

    @entry_point
    def force(self, flyer: Any, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
        return self.model_of(flyer).force(flyer, state, unknowns)

    def pushes_unheated(self, flyer: Any, state: EnvironmentState) -> bool:
        """A disk over a warm floor is pushed."""
        return self.model_of(flyer).pushes_unheated(flyer, state)

    def ranges(self, flyer: Any, state: EnvironmentState, temperature: Numeric) -> Looks:
        return self.model_of(flyer).ranges(flyer, state, temperature)

    def remarks(self, flyer: Any, state: EnvironmentState, temperature: Numeric) -> tuple[str, ...]:
        """Those of the flyer's model, and options that have no effect."""
        model = self.model_of(flyer)
        found = model.remarks(flyer, state, temperature)
        idle = {
            "polyatomic": self.polyatomic != "refused" and state.gas.molecules != "polyatomic",
            "rotational_accommodation": self.rotational_accommodation is not None
            and state.gas.molecules == "monatomic",
        }
        if isinstance(model, KineticDisk):
            idle["transmission"] = self.transmission != "aligned"
        else:
            idle["film_balance"] = self.film_balance != "isothermal"
        return (*found, *(_IDLE[name].format(self) for name, is_set in idle.items() if is_set))


class KineticSection(ForceSection, of=Kinetic):
    """``[force]``: the kinetic equation, solved; its own error counts unless told otherwise."""

    model: Literal["kinetic"] = "kinetic"

    @pydantic.model_validator(mode="before")
    @classmethod
    def _known_walls(cls, content: Any) -> Any:
        """Known walls do not have every error, which then is not among the uncertainties."""
        if not isinstance(content, Mapping):
            return content
        wall = content.get("wall", "unknown")
        idle = {name: walls for name, walls in _OF_WALLS.items() if wall not in walls}
        for name in idle.keys() & content.keys():
            raise ConfigurationError(
                f'{name} has no meaning with wall = "{wall}"; it is for {" or ".join(idle[name])}'
            )
        return dict.fromkeys(idle.keys() & _ERRORS, 0.0) | {**content}
