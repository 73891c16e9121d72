"""A vacuum chamber with a lamp."""

from lightflyer.environment.base import AbstractEnvironment, EnvironmentState
from lightflyer.environment.radiation import Radiation
from lightflyer.foundation import constants
from lightflyer.foundation.checks import require_positive, require_range
from lightflyer.foundation.types import Numeric
from lightflyer.gas.gas import AIR, AbstractGas


class Chamber(AbstractEnvironment):
    """Inside a vacuum chamber; the coordinate is the pressure [Pa].

    Attributes
    ----------
    temperature : array
        Temperature of gas and walls [K].
    gas : AbstractGas
        Default :data:`lightflyer.AIR`.
    gravity : array
        [m/s²].
    radiation : Radiation
        The lamp. Thermal surroundings are walls at the gas temperature unless it says more.
    pressure_range : tuple of float
        Lowest and highest pressure of interest [Pa].
    radius : array or None
        Distance from the flyer to the walls [m], which slow down no flow where it is None. Only
        the kinetic force model takes it into account.

    Raises
    ------
    ParameterError
        If a concrete value is not positive or the range is empty.
    """

    temperature: Numeric = 295.0
    gas: AbstractGas = AIR
    gravity: Numeric = constants.STANDARD_GRAVITY
    radiation: Radiation = Radiation()
    pressure_range: tuple[Numeric, Numeric] = (1e-2, 1e3)
    radius: Numeric = None

    def __check_init__(self) -> None:
        require_positive(temperature=self.temperature, gravity=self.gravity)
        lowest, highest = self.pressure_range
        require_positive(pressure_range=lowest)
        require_range("radius", self.radius, 0.0, open_below=True)
        require_range("upper end of pressure_range", highest, lowest, open_below=True)

    @property
    def coordinate_range(self) -> tuple[float, float]:
        """The pressure range [Pa]."""
        return self.pressure_range

    def state(self, coordinate: Numeric) -> EnvironmentState:
        """Surroundings at a pressure, which may lie outside the range of interest.

        Parameters
        ----------
        coordinate : array, shape (...)
            Pressure [Pa].

        Returns
        -------
        EnvironmentState

        Raises
        ------
        ParameterError
            If a concrete pressure is not positive.
        """
        require_positive(pressure=coordinate)
        return EnvironmentState(
            pressure=coordinate,
            temperature=self.temperature,
            gravity=self.gravity,
            gas=self.gas,
            radiation=self.radiation,
            wall_distance=self.radius,
        )
