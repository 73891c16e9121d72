"""Earth: an atmosphere, its gas, gravity and sunlight."""

from typing import Any

import equinox as eqx

from lightflyer.environment.atmosphere.lu2023 import Lu2023Atmosphere
from lightflyer.environment.atmosphere.us1976 import US1976
from lightflyer.environment.base import (
    AbstractAtmosphere,
    AbstractEnvironment,
    EnvironmentState,
)
from lightflyer.environment.radiation import Radiation
from lightflyer.foundation import constants
from lightflyer.foundation.checks import require_positive, require_range
from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.types import Numeric
from lightflyer.gas.gas import AIR, LU2023_AIR, AbstractGas


def earth_gravity(altitude: Numeric) -> Any:
    """Acceleration of free fall at a geometric altitude [m]; [USSA1976]_ Eq. (17)."""
    radius = constants.EARTH_EFFECTIVE_RADIUS
    return constants.STANDARD_GRAVITY * (radius / (radius + altitude)) ** 2


class Earth(AbstractEnvironment):
    """Above a place on Earth; the coordinate is the geometric altitude [m].

    Attributes
    ----------
    atmosphere : AbstractAtmosphere
        Default :class:`US1976`.
    gas : AbstractGas
        Default :data:`lightflyer.AIR`. Its gas constant follows the atmosphere's molar mass.
    gravity : array or None
        Constant gravity [m/s²]; None lets it fall off with altitude.
    radiation : Radiation
        Sunlight and thermal surroundings.

    Examples
    --------
    >>> state = Earth().state(70e3)
    >>> print(f"{state.pressure:.4f} Pa, {state.temperature:.2f} K, {state.gravity:.4f} m/s²")
    5.2209 Pa, 219.58 K, 9.5942 m/s²
    """

    atmosphere: AbstractAtmosphere = US1976()
    gas: AbstractGas = AIR
    gravity: Numeric = None
    radiation: Radiation = Radiation()

    def __check_init__(self) -> None:
        if self.gravity is not None:
            require_positive(gravity=self.gravity)

    @property
    def coordinate_range(self) -> tuple[float, float]:
        """The atmosphere's altitude range [m]."""
        return self.atmosphere.altitude_range

    def state(self, coordinate: Numeric) -> EnvironmentState:
        """Surroundings at an altitude.

        Parameters
        ----------
        coordinate : array, shape (...)
            Geometric altitude [m].

        Returns
        -------
        EnvironmentState

        Raises
        ------
        ParameterError
            If a concrete altitude is outside the atmosphere's range; traced ones give NaN.
        """
        require_range("altitude [m]", coordinate, *self.coordinate_range)
        return _state(self, coordinate)


@entry_point
def _state(earth: Earth, altitude: Numeric) -> EnvironmentState:
    ratio = earth.atmosphere.molar_mass_ratio(altitude)
    gas = eqx.tree_at(
        lambda gas: gas.specific_gas_constant,
        earth.gas,
        earth.gas.specific_gas_constant / ratio,
    )
    return EnvironmentState(
        pressure=earth.atmosphere.pressure(altitude),
        temperature=earth.atmosphere.temperature(altitude),
        gravity=earth_gravity(altitude) if earth.gravity is None else earth.gravity,
        gas=gas,
        radiation=earth.radiation,
    )


def lu2023_earth(irradiance: Numeric = constants.SOLAR_CONSTANT, incidence: Numeric = 0.0) -> Earth:
    """Earth as in the paper: its polynomial atmosphere, gas, gravity and rounded constant.

    Parameters
    ----------
    irradiance : array
        Sunlight [W/m²].
    incidence : array
        Angle between the light and the disk's normal [rad].

    Returns
    -------
    Earth
    """
    return Earth(
        atmosphere=Lu2023Atmosphere(),
        gas=LU2023_AIR,
        gravity=constants.GRAVITY_LU2023,
        radiation=Radiation(
            irradiance, incidence, stefan_boltzmann=constants.STEFAN_BOLTZMANN_LU2023
        ),
    )
