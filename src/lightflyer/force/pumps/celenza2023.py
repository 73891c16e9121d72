"""The model of Celenza, Eskenazi and Bargatin for hollow bodies, as published."""

from collections.abc import Mapping
from typing import ClassVar, Literal

from jax import Array

from lightflyer.core.types import Numeric
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.hollow import HollowBody
from lightflyer.force.base import AbstractForceModel, ModelResult
from lightflyer.force.pumps.celenza2023_laws import require_air
from lightflyer.force.pumps.hollow_flow import (
    AS_PUBLISHED,
    FLOW_RESULTS,
    pump_diagnostics,
    pump_force,
    pump_results,
)
from lightflyer.force.pumps.hollow_heat import pump_heat
from lightflyer.force.section import ForceSection
from lightflyer.gas.base import AbstractGas
from lightflyer.program.entry_point import entry_point


class Celenza2023(AbstractForceModel):
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

    flyers: ClassVar[tuple[type[AbstractFlyer], ...]] = (HollowBody,)
    feels_walls: ClassVar[bool] = False
    molecules: ClassVar[tuple[str, ...]] = ("diatomic",)
    results: ClassVar[Mapping[str, ModelResult]] = FLOW_RESULTS
    adds_buoyancy: ClassVar[bool] = False

    def require_gas(self, gas: AbstractGas) -> None:
        """See :meth:`AbstractForceModel.require_gas`: air of whatever correlations."""
        super().require_gas(gas)
        require_air("Celenza2023", gas)

    @entry_point
    def heat_loss(
        self, flyer: HollowBody, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        """See :meth:`AbstractForceModel.heat_loss`."""
        return pump_heat(flyer, state, unknowns, AS_PUBLISHED)

    @entry_point
    def force(
        self, flyer: HollowBody, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> Array:
        """See :meth:`AbstractForceModel.force`."""
        return pump_force(flyer, state, unknowns, AS_PUBLISHED)

    @entry_point
    def own_results(
        self, flyer: HollowBody, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> dict[str, Array]:
        """See :meth:`AbstractForceModel.own_results`."""
        return pump_results(flyer, state, unknowns, AS_PUBLISHED)

    def diagnostics(
        self,
        flyer: HollowBody,
        state: EnvironmentState,
        temperature: Numeric,  # noqa: ARG002
    ) -> tuple[str, ...]:
        """See :meth:`AbstractForceModel.diagnostics`."""
        return pump_diagnostics(flyer, state, AS_PUBLISHED)


class Celenza2023Section(ForceSection, of=Celenza2023):
    """``[force]``: hollow bodies as published."""

    model: Literal["celenza2023"]
