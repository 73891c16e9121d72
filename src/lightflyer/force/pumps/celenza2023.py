"""Hollow bodies as pumps: the heat that the gas takes, the published and the corrected model."""

import abc
from collections.abc import Mapping
from typing import ClassVar, Literal

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import field
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import StandardErrors
from lightflyer.core.validity import Looks
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.hollow import HollowBody
from lightflyer.force.base import AbstractForceModel, ForceSection, ModelResult
from lightflyer.force.pumps.celenza2023_laws import require_air
from lightflyer.force.pumps.hollow_flow import (
    AS_PUBLISHED,
    EXACT,
    FLOW_RESULTS,
    Corrections,
    Errors,
    pump_force,
    pump_ranges,
    pump_results,
)
from lightflyer.force.pumps.hollow_heat import pump_heat
from lightflyer.gas.base import AbstractGas


class AbstractHollowModel(AbstractForceModel):
    """The published model with some corrections, or none."""

    flyers: ClassVar[tuple[type[AbstractFlyer], ...]] = (HollowBody,)
    results: ClassVar[Mapping[str, ModelResult]] = FLOW_RESULTS

    @property
    @abc.abstractmethod
    def corrections(self) -> Corrections:
        """What is on."""

    @property
    def errors(self) -> Errors:
        """Factors of what the model may be off by."""
        return EXACT

    @entry_point
    def heat_loss(
        self, flyer: HollowBody, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        return pump_heat(flyer, state, unknowns, self.corrections, self.errors)

    @entry_point
    def force(
        self, flyer: HollowBody, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> Array:
        return pump_force(flyer, state, unknowns, self.corrections, self.errors)

    @entry_point
    def own_results(
        self, flyer: HollowBody, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> dict[str, Array]:
        return pump_results(flyer, state, unknowns, self.corrections, self.errors)

    def ranges(self, flyer: HollowBody, state: EnvironmentState, temperature: Numeric) -> Looks:
        return pump_ranges(flyer, state, self.corrections)


class Celenza2023(AbstractHollowModel):
    r"""Force of a hollow body as published, with the published code's constants.

    .. math::
        a v^2 + \frac{2A_oAB}{A_t\,\alpha\,\varphi}\,v - \frac{2\gamma\,\Delta T}{\rho\,\alpha} = 0,
        \qquad
        F = C_1\,8D\mu\,\frac{A_o}{A_t}v + C_2\,\rho A_o v^2

    with the flows :math:`\alpha` and :math:`\gamma` through one long channel per pressure and per
    temperature difference, and :math:`\Delta T = \tfrac12 I(1-\varphi)/G` across the wall.

    Notes
    -----
    The light falls on the whole wall at normal incidence and is absorbed where the wall is solid,
    whatever the films' absorptances; half of it passes the wall. The outer film is as warm as the
    gas. Emittances, absorptances, TACs and heat radiation have no effect, as long as the inner film
    absorbs any light. The gas is air. The warm gas within adds no buoyancy, as published.

    For what is wrong with it see :class:`~lightflyer.HollowPump`, whose corrections can be switched
    one by one.

    References
    ----------
    [Celenza2023]_
    """

    feels_walls: ClassVar[bool] = False
    molecules: ClassVar[tuple[str, ...]] = ("diatomic",)
    adds_buoyancy: ClassVar[bool] = False

    @property
    def corrections(self) -> Corrections:
        return AS_PUBLISHED

    def require_gas(self, gas: AbstractGas) -> None:
        """Refuses all but air."""
        super().require_gas(gas)
        require_air("Celenza2023", gas)


class Celenza2023Section(ForceSection, of=Celenza2023):
    """``[force]``: hollow bodies as published."""

    model: Literal["celenza2023"]


_SCATTER = Errors(wall=0.10, outlet=0.25, force=0.15, heat=0.10)
"""Standard errors, relative [1].

- Wall: coefficients of the Shakhov equation are off by up to 3 %, and the same laws give the
  simulated force on a disk with holes within 11 % to 20 %.
- Body and outlet: Sampson's law is for a hole in a plane wall; a jet that contracts as from a sharp
  edge would add 1.7 times the dynamic pressure, a fifth of the resistance at most where the
  published designs are best; Poiseuille's law in the body of a cone or a rocket.
- Drag and jet: in creeping flow the reciprocal theorem gives C₁ = 1.18 for a sphere with a small
  outlet, published is 1.30; solutions for a disk (studies/outer_flow) have 0.77 to 1 of the
  momentum of a jet, published is 0.86 to 0.93; and the interpolation to thin gas.
- Heat: limits of free and dense gas in series, as around a sphere 12 % apart; natural convection
  15 %; cones and rockets taken for spheres of the same area.
"""


class HollowPump(AbstractHollowModel):
    """Force and heat of a hollow body from thin gas to the continuum.

    Each of its nine corrections to :class:`~lightflyer.Celenza2023` is on, unless it is switched
    off. With all of them off its force is that model's.

    Attributes
    ----------
    short_channels : bool
        (1) The entrances of the channels resist, and what drives the flow is the temperature of the
        gas that comes to them.
    projected_light : bool
        (2) Light falls on the area seen from its source, and is absorbed as the films do.
    energy_balance : bool
        (3) Both films radiate, the outer one is cooled by the gas, and gas that flows takes heat.
    viscous_outlet : bool
        (4) Slow and thin gas is held back at the outlet, and on its way there.
    rarefied_force : bool
        (5) The drag of thin gas, and the recoil of free molecules.
    channel_coefficients : bool
        (6) The flow in channels follows from the kinetic equation.
    gas_properties : bool
        (7) Conductivity and viscosity are those of the gas at its temperature.
    jet_density : bool
        (8) The jet is as warm as the inner film.
    buoyant_flow : bool
        (9) Warm gas leaves by the upper part of the wall, and other gas comes in below.
    wall_error, outlet_error, force_error, heat_error : array or None
        Deviation of the truth from the model, in the model's own standard errors [1]: of the
        pressure that the wall pumps up (10 %), of the resistance of body and outlet (25 %), of drag
        and jet (15 %), and of the heat that the gas takes (10 %). A flyer file gives each as 0 ± 1,
        so that they are part of a prediction's uncertainty. None stands for zero.

    Notes
    -----
    The standard errors are estimates, from what the parts of the model are known to be off by where
    they can be compared; the page on hollow bodies has them. Free molecules leave no doubt: their
    recoil is exact.

    The gas within has the temperature of the inner film. The drag and jet coefficients were fitted
    to simulations of dense gas; :meth:`ranges` says where it is not.

    References
    ----------
    [Celenza2023]_ for the equations that are corrected.
    """

    short_channels: bool = field(static=True, default=True)
    projected_light: bool = field(static=True, default=True)
    energy_balance: bool = field(static=True, default=True)
    viscous_outlet: bool = field(static=True, default=True)
    rarefied_force: bool = field(static=True, default=True)
    channel_coefficients: bool = field(static=True, default=True)
    gas_properties: bool = field(static=True, default=True)
    jet_density: bool = field(static=True, default=True)
    buoyant_flow: bool = field(static=True, default=True)
    wall_error: StandardErrors | None = None
    outlet_error: StandardErrors | None = None
    force_error: StandardErrors | None = None
    heat_error: StandardErrors | None = None

    def require_gas(self, gas: AbstractGas) -> None:
        """Refuses all but air without ``gas_properties``."""
        super().require_gas(gas)
        if not self.gas_properties:
            require_air("HollowPump with gas_properties off", gas)

    @property
    def corrections(self) -> Corrections:
        return Corrections(*(getattr(self, name) for name in Corrections._fields))

    @property
    def errors(self) -> Errors:
        given = (getattr(self, f"{name}_error") for name in Errors._fields)
        return Errors(
            *(
                1.0 if error is None else xp.exp(scatter * error)
                for error, scatter in zip(given, _SCATTER, strict=True)
            )
        )


class HollowPumpSection(ForceSection, of=HollowPump):
    """``[force]``: hollow bodies as pumps, all corrections and own errors unless told otherwise."""

    model: Literal["hollow-pump"]
