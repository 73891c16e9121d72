"""Atmospheres of Earth without a date: the US Standard Atmosphere 1976, and the paper's."""

import math
from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from types import ModuleType
from typing import Any

import numpy as np

from lightflyer.array.namespace import Array, xp
from lightflyer.core import constants
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import Altitude
from lightflyer.environment.base import AbstractAtmosphere, Place
from lightflyer.files.table import shipped_table
from lightflyer.gas.air import US1976_AIR
from lightflyer.numerics.interpolation import Spline
from lightflyer.numerics.polynomials import polynomial

# [USSA1976] table 4: bases of the layers below 86 km in geopotential altitude [m'], and the
# gradients of molecular-scale temperature above them [K/m'].
_LAYER_BASES = np.array([0.0, 11e3, 20e3, 32e3, 47e3, 51e3, 71e3])
_LAPSE_RATES = np.array([-6.5e-3, 0.0, 1.0e-3, 2.8e-3, 0.0, -2.8e-3, -2.0e-3])
_SEA_LEVEL_TEMPERATURE = 288.15
_HOMOSPHERE_TOP = 86e3
_US1976_TOP = 1000e3
_METRES_PER_KILOMETRE = 1e3

# [USSA1976] table 8: ratio of the mean molar mass to its sea-level value, 80 km to 86 km.
_RATIO_ALTITUDES = np.arange(80e3, 86.1e3, 0.5e3)
_RATIO_DEFICITS = [0, 4, 11, 29, 59, 91, 130, 171, 214, 259, 306, 359, 421]  # millionths
_RATIOS = 1.0 - 1e-6 * np.array(_RATIO_DEFICITS)

# [USSA1976] Eqs. (25), (27), (29), (31): kinetic temperature above 86 km.
_T7 = 186.8673
_Z8, _T_CENTRE, _ELLIPSE_A, _ELLIPSE_B = 91e3, 263.1905, -76.3232, -19.9429e3
_Z9, _T9, _LAPSE_9 = 110e3, 240.0, 12e-3
_Z10, _T10, _T_INFINITY, _DECAY = 120e3, 360.0, 1000.0, 0.01875e-3

# [USSA1976] table 2: effective collision diameter [m].
_COLLISION_DIAMETER = 3.65e-10

# Hydrostatic constant g0 M0 / R* [K/m'].
_HYDROSTATIC = constants.STANDARD_GRAVITY * constants.MOLAR_MASS_AIR / constants.GAS_CONSTANT_US1976


def _layer_bases() -> tuple[np.ndarray, np.ndarray]:
    """Molecular-scale temperature [K] and log-pressure at the base of each layer."""
    temperature, log_pressure = [_SEA_LEVEL_TEMPERATURE], [np.log(constants.SEA_LEVEL_PRESSURE)]
    for thickness, lapse in zip(np.diff(_LAYER_BASES), _LAPSE_RATES, strict=False):
        below = temperature[-1]
        above = below + lapse * thickness
        mean = (above - below) / np.log(above / below) if lapse else below
        temperature.append(above)
        log_pressure.append(log_pressure[-1] - _HYDROSTATIC * thickness / mean)
    return np.array(temperature), np.array(log_pressure)


_BASE_TEMPERATURES, _BASE_LOG_PRESSURES = _layer_bases()


def geopotential_altitude(altitude: Altitude) -> Any:
    """Geopotential [m'] of a geometric altitude [m]; [USSA1976]_ Eq. (18)."""
    radius = constants.EARTH_EFFECTIVE_RADIUS
    return radius * altitude / (radius + altitude)


def _in_layers(altitude: Array) -> tuple[Array, Array]:
    """Molecular-scale temperature [K] and log-pressure below 86 km."""
    geopotential = geopotential_altitude(altitude)
    layer = xp.searchsorted(xp.asarray(_LAYER_BASES[1:]), geopotential, side="right")
    base = xp.asarray(_BASE_TEMPERATURES)[layer]
    lapse = xp.asarray(_LAPSE_RATES)[layer]
    above_base = geopotential - xp.asarray(_LAYER_BASES)[layer]
    isothermal = lapse == 0.0
    safe_lapse = xp.where(isothermal, 1.0, lapse)
    integral = xp.where(
        isothermal,
        above_base / base,
        # the argument is chosen, too, so that the unused branch has no NaN derivative
        xp.log1p(xp.where(isothermal, 0.0, safe_lapse * above_base / base)) / safe_lapse,
    )
    log_pressure = xp.asarray(_BASE_LOG_PRESSURES)[layer] - _HYDROSTATIC * integral
    return base + lapse * above_base, log_pressure


@cache
def _upper_table() -> tuple[Spline, np.ndarray]:
    """The standard's table above 86 km: log-pressure, and molar-mass ratio at the nodes."""
    rows = shipped_table("us1976_upper.csv").numbers
    altitude, pressure = rows["altitude_km"] * _METRES_PER_KILOMETRE, rows["pressure"]
    temperature = np.asarray(_upper_temperature(altitude, np))
    ratio = rows["molar_mass"] / constants.MOLAR_MASS_AIR
    # joined at 86 km to the layers below: same pressure, same composition
    thickness = geopotential_altitude(_HOMOSPHERE_TOP) - _LAYER_BASES[-1]
    lapse, base = _LAPSE_RATES[-1], _BASE_TEMPERATURES[-1]
    ratio[0] = _RATIOS[-1]
    log_pressure = np.log(pressure)
    log_pressure[0] = (
        _BASE_LOG_PRESSURES[-1] - _HYDROSTATIC * np.log1p(lapse * thickness / base) / lapse
    )
    # the slopes need no fit: the air is in hydrostatic equilibrium, from 93 km to 110 km nearly so
    radius = constants.EARTH_EFFECTIVE_RADIUS
    gravity_ratio = (radius / (radius + altitude)) ** 2
    slopes = -_HYDROSTATIC * gravity_ratio * ratio / temperature
    return Spline.hermite(altitude, log_pressure, slopes), ratio


def _upper_temperature(altitude: Altitude, xp: ModuleType = xp) -> Any:
    """Kinetic temperature above 86 km [K], with the array module that ``altitude`` is of."""
    radius = constants.EARTH_EFFECTIVE_RADIUS
    along = xp.clip((altitude - _Z8) / _ELLIPSE_B, -0.99, 0.0)
    ellipse = _T_CENTRE + _ELLIPSE_A * xp.sqrt(1.0 - along**2)
    linear = _T9 + _LAPSE_9 * (altitude - _Z9)
    reduced = (altitude - _Z10) * (radius + _Z10) / (radius + altitude)
    exponential = _T_INFINITY - (_T_INFINITY - _T10) * xp.exp(-_DECAY * reduced)
    above = xp.where(altitude < _Z10, linear, exponential)
    return xp.where(altitude < _Z8, _T7, xp.where(altitude < _Z9, ellipse, above))


def _temperature(altitude: Array) -> Array:
    molecular_scale, _ = _in_layers(xp.minimum(altitude, _HOMOSPHERE_TOP))
    kinetic = molecular_scale * _ratio_in_layers(altitude)
    return xp.where(altitude < _HOMOSPHERE_TOP, kinetic, _upper_temperature(altitude))


def _ratio_in_layers(altitude: Array) -> Array:
    return xp.interp(altitude, xp.asarray(_RATIO_ALTITUDES), xp.asarray(_RATIOS))


def _pressure(altitude: Array) -> Array:
    _, layers = _in_layers(xp.minimum(altitude, _HOMOSPHERE_TOP))
    upper = _upper_table()[0](altitude)
    return xp.exp(xp.where(altitude < _HOMOSPHERE_TOP, layers, upper))


def _molar_mass_ratio(altitude: Array) -> Array:
    log_pressure, ratio = _upper_table()
    upper = xp.interp(altitude, xp.asarray(log_pressure.nodes), xp.asarray(ratio))
    return xp.where(altitude < _HOMOSPHERE_TOP, _ratio_in_layers(altitude), upper)


class US1976(AbstractAtmosphere):
    """The US Standard Atmosphere 1976.

    Below 86 km it is the standard's own equations, with the molar-mass ratio that turns
    molecular-scale into kinetic temperature above 80 km. From 86 km to 1000 km temperature is
    the standard's equation, pressure a cubic through its table with the hydrostatic slope at
    each row, molar mass linear between the rows. The rows are 1 km to 25 km apart.

    Notes
    -----
    Methods take altitudes [m] of any shape. The temperature's derivative jumps at the layers'
    boundaries, as the standard has it. The standard's own table departs from hydrostatic
    equilibrium by up to 0.3 % per kilometre between 93 km and 110 km, because it computes the
    gases one by one and changes the mass that nitrogen diffuses with at 100 km.

    References
    ----------
    [USSA1976]_.

    Examples
    --------
    >>> print(f"{US1976().temperature(70e3):.2f} K, {US1976().pressure(70e3):.4f} Pa")
    219.58 K, 5.2209 Pa
    """

    @property
    def altitude_range(self) -> tuple[float, float]:
        """0 m to 1000 km."""
        return 0.0, _US1976_TOP

    def describe(self) -> str:
        return "atmosphere: US Standard Atmosphere 1976, the same everywhere and always"

    @entry_point
    def temperature(self, altitude: Altitude, place: Place | None = None) -> Any:
        return self._nan_outside(altitude, _temperature(altitude))

    @entry_point
    def pressure(self, altitude: Altitude, place: Place | None = None) -> Any:
        return self._nan_outside(altitude, _pressure(altitude))

    @entry_point
    def molar_mass_ratio(self, altitude: Altitude, place: Place | None = None) -> Any:
        return self._nan_outside(altitude, _molar_mass_ratio(altitude))

    @entry_point
    def density(self, altitude: Altitude) -> Any:
        """Mass density [kg/m³]."""
        molar_mass = constants.MOLAR_MASS_AIR * _molar_mass_ratio(altitude)
        per_temperature = molar_mass / constants.GAS_CONSTANT_US1976
        density = _pressure(altitude) * per_temperature / _temperature(altitude)
        return self._nan_outside(altitude, density)

    @entry_point
    def viscosity(self, altitude: Altitude) -> Any:
        """Dynamic viscosity [Pa s]; the standard gives it to 86 km, NaN above."""
        viscosity = US1976_AIR.viscosity(_temperature(altitude))
        return xp.where(altitude <= _HOMOSPHERE_TOP, self._nan_outside(altitude, viscosity), np.nan)

    @entry_point
    def mean_free_path(self, altitude: Altitude) -> Any:
        r"""Mean free path as the standard defines it [m]."""
        # .. math:: L = \frac{R^* T}{\sqrt2\, \pi N_A \sigma^2 p}
        #
        # with a fixed collision diameter: 4 % above :func:`lightflyer.gas.mean_free_path` at sea
        # level. The force models use the latter.
        cross_section = xp.sqrt(2.0) * np.pi * _COLLISION_DIAMETER**2
        number_density = (
            constants.AVOGADRO_US1976
            * _pressure(altitude)
            / (constants.GAS_CONSTANT_US1976 * _temperature(altitude))
        )
        return self._nan_outside(altitude, 1.0 / (cross_section * number_density))


# Inverse temperature [1/K] as a polynomial in altitude [km], lowest power first. The paper
# prints three digits of each, which is useless above 20 km; these come with the code of
# [Celenza2020].
_INVERSE_TEMPERATURE = (
    3.47312785053852e-3,
    9.91066193190049e-5,
    -2.28247698757490e-5,
    8.15422681932410e-6,
    -1.14955512755429e-6,
    8.52520967699876e-8,
    -3.86235307877923e-9,
    1.14960632799406e-10,
    -2.33217472878003e-12,
    3.27061799378819e-14,
    -3.15169237730408e-16,
    2.02100883624221e-18,
    -7.94159585089666e-21,
    1.49047601370574e-23,
    4.02322550536528e-27,
    -4.59195520629687e-29,
)
_LU2023_TOP = 120e3  # the polynomial has a pole at about 125 km
_MIDDLE = 60  # km, from which altitudes are counted: from the ground, nine digits are left of 16


def _from_middle(coefficients: Sequence[Fraction]) -> tuple[float, ...]:
    """Coefficients of the same polynomial in (altitude / middle) − 1; computed without rounding."""
    powers = range(len(coefficients))
    return tuple(
        float(sum(math.comb(power, kept) * coefficients[power] * _MIDDLE**power
                  for power in powers[kept:]))
        for kept in powers
    )  # fmt: skip


_EXACT = [*map(Fraction, _INVERSE_TEMPERATURE)]
_CENTRED = _from_middle(_EXACT)
_INTEGRAL = _from_middle([Fraction(0), *(one / (power + 1) for power, one in enumerate(_EXACT))])


def _place(altitude: Altitude) -> Any:
    return altitude / (_MIDDLE * _METRES_PER_KILOMETRE) - 1.0


class Lu2023Atmosphere(AbstractAtmosphere):
    r"""Polynomial atmosphere of the paper, 0 to 120 km.

    .. math::
        T_c^{-1}(h) = \sum_k a_k h^k, \qquad
        p(h) = p_0 \exp\!\left(-\frac{g}{R}\int_0^h T_c^{-1}\,\mathrm dh\right)

    with the paper's g = 9.8 m/s² and R = 287.05 J/(kg K).

    References
    ----------
    [Lu2023]_ Eqs. (21) and (22), with the factor 1000 that (22) needs; coefficients from
    [Celenza2020]_.

    Examples
    --------
    >>> atmosphere = Lu2023Atmosphere()
    >>> print(f"{atmosphere.temperature(70e3):.4f} K, {atmosphere.pressure(70e3):.5f} Pa")
    220.0640 K, 4.71544 Pa
    """

    @property
    def altitude_range(self) -> tuple[float, float]:
        """0 m to 120 km."""
        return 0.0, _LU2023_TOP

    def describe(self) -> str:
        return "atmosphere: the polynomial of Lu and others (2023), the same everywhere and always"

    @entry_point
    def temperature(self, altitude: Altitude, place: Place | None = None) -> Any:
        return self._nan_outside(altitude, 1.0 / polynomial(_CENTRED, _place(altitude)))

    @entry_point
    def pressure(self, altitude: Altitude, place: Place | None = None) -> Any:
        integral = _METRES_PER_KILOMETRE * polynomial(_INTEGRAL, _place(altitude))
        exponent = constants.GRAVITY_LU2023 / constants.GAS_CONSTANT_LU2023 * integral
        return self._nan_outside(altitude, constants.SEA_LEVEL_PRESSURE * xp.exp(-exponent))

    @entry_point
    def molar_mass_ratio(self, altitude: Altitude, place: Place | None = None) -> Any:
        """One: the paper's gas does not change with altitude."""
        return xp.ones_like(altitude)
