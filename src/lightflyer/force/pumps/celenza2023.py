"""The model of Celenza, Eskenazi and Bargatin for hollow bodies, as published."""

from typing import ClassVar, Literal

from lightflyer.force.pumps.celenza2023_laws import require_air
from lightflyer.force.pumps.hollow_flow import AS_PUBLISHED, Corrections
from lightflyer.force.pumps.hollow_model import AbstractHollowModel
from lightflyer.force.section import ForceSection
from lightflyer.gas.base import AbstractGas


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
