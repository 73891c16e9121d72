"""Physical constants, each once: value, unit, source.

Constants that belong to one published model (layer tables, fitted exponents) live with that
model; those shared by several modules live here.
"""

from typing import Final

BOLTZMANN: Final = 1.380649e-23  # Boltzmann constant [J/K]; exact, [CODATA2018]_
AVOGADRO: Final = 6.02214076e23  # Avogadro constant [1/mol]; exact, [CODATA2018]_

STEFAN_BOLTZMANN: Final = 5.670374419e-8
"""Stefan-Boltzmann constant [W/(m² K⁴)]; exact to the digits shown, [CODATA2018]_."""

ZERO_CELSIUS: Final = 273.15  # Zero of the Celsius scale [K]; exact, [BIPM2019]_
STANDARD_GRAVITY: Final = 9.80665  # Standard acceleration of free fall [m/s²]; exact, [BIPM2019]_

EARTH_EFFECTIVE_RADIUS: Final = 6_356_766.0
"""Effective Earth radius of the US Standard Atmosphere [m]; [USSA1976]_ table 2."""

TOTAL_SOLAR_IRRADIANCE: Final = 1361.0
"""Sunlight above the atmosphere at the mean distance of the sun [W/m²]; [Gueymard2018]_.

Over the year it varies by 3.4 % about this mean.
"""

ASTRONOMICAL_UNIT: Final = 149_597_870_700.0
"""Astronomical unit [m]; exact, [IAU2012]_ resolution B2."""

MARS_GRAVITATIONAL_PARAMETER: Final = 4.28284e13
"""Gravitational constant times the mass of Mars [m³/s²]; [Folkner2014]_."""

SOLAR_RADIUS: Final = 6.957e8  # Nominal radius of the sun [m]; [IAU2015]_ resolution B3
SOLAR_CONSTANT_LU2023: Final = 1360.0  # Sunlight above the atmosphere as [Lu2023]_ rounds it [W/m²]

GAS_CONSTANT_US1976: Final = 8314.32
"""Molar gas constant as defined by the US Standard Atmosphere [J/(kmol K)]; [USSA1976]_ table 2.

Not the CODATA value: the standard's tables are reproduced only with the standard's constant.
"""

AVOGADRO_US1976: Final = 6.022169e26
"""Avogadro constant as defined by the US Standard Atmosphere [1/kmol]; [USSA1976]_ table 2."""

MOLAR_MASS_AIR: Final = 28.9644  # Mean molar mass of sea-level air [kg/kmol]; [USSA1976]_ table 2
GRAVITY_LU2023: Final = 9.8  # Gravity in the paper [m/s²]; [Lu2023]_ Eq. (22)

STEFAN_BOLTZMANN_LU2023: Final = 5.67e-8
"""Stefan-Boltzmann constant behind the paper's computed values [W/(m² K⁴)].

The paper prints none. With the three-digit value the reference figures of the two readings
are reproduced to all their digits; with the CODATA value they are off by up to 2e-5.
"""

GAS_CONSTANT_LU2023: Final = 287.05
"""Specific gas constant of air in the paper [J/(kg K)]; [Lu2023]_."""

SEA_LEVEL_PRESSURE: Final = 101_325.0  # Standard pressure at sea level [Pa]; [USSA1976]_
PLANCK: Final = 6.62607015e-34  # Planck constant [J s]; exact, [CODATA2018]_
SPEED_OF_LIGHT: Final = 299_792_458.0  # Speed of light in vacuum [m/s]; exact, [CODATA2018]_

NORMAL_HALF_WIDTH_95: Final = 1.959963984540054
"""Standard deviations in half the interval that holds 95 % of a normal distribution."""
