"""The paper's model in plain NumPy, with every convention that it leaves open as an option.

Written from the equations of Lu et al. (arXiv:2305.19382), with their misprints corrected; it
shares no code with lightflyer. Equation numbers are the paper's.

A heat law and a force law are chosen independently of each other: the temperature at which a disk
levitates follows from the force alone, the irradiance that makes it so warm from the heat alone.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np

R, GAMMA, CREEP, SIGMA = 287.05, 1.4, 1.14, 5.67e-8
C_FM, C_CONT = 0.4, 3.0
TAC_TOP, TAC_BOTTOM, EMISSIVITY, ABSORPTIVITY, AREAL_DENSITY = 0.8, 0.9, 0.08, 0.75, 1e-3
SUNLIGHT = 1360.0
HOTTEST = 3000.0  # no film is left

TEMPERATURES = ("T_c", "T_mean", "T_h")
TACS = {"mean": 0.5 * (TAC_TOP + TAC_BOTTOM), "top": TAC_TOP, "bottom": TAC_BOTTOM}

# What each convention may be. The first of each is what the paper prints.
HEAT = {
    "(4): temperature of the mean speed": ("T_mean", "T_c", "T_h"),
    "(4): temperature that divides": ("T_mean", "T_c", "T_h"),
    "(4): area": ("2A", "A"),
    "(4): TAC": ("mean", "top", "bottom"),
    "(5): counted": ("once", "twice"),
    "(7): Rayleigh term": ("in", "out"),
    "(5), (8)-(13): temperature of the gas": ("T_mean", "T_c", "T_h"),
    "(17): radiating faces": ("two", "one"),
}
FORCE = {
    "(19): temperature that divides": ("T_c", "T_mean", "T_h"),
    "(20): temperature in the numerator": ("T_h", "T_mean", "T_c"),
    "(20): temperature that divides": ("T_c", "T_mean", "T_h"),
    "(20): temperature of the gas": ("T_mean", "T_c", "T_h"),
    "(20): mean TAC": ("mean", "top", "bottom"),
}
ENVIRONMENT = {
    "atmosphere": ("paper", "US 1976"),
    "gas": ("paper", "US 1976"),
    "gravity": ("9.8", "g(h)"),
}

Option = tuple[str, ...]
PRINTED_HEAT = tuple(choices[0] for choices in HEAT.values())
PRINTED_FORCE = tuple(choices[0] for choices in FORCE.values())
PRINTED_ENVIRONMENT = tuple(choices[0] for choices in ENVIRONMENT.values())
REPORTED_HEAT = ("T_c", "T_c", "2A", "mean", "twice", "in", "T_mean", "two")
REPORTED_FORCE = ("T_mean", "T_h", "T_c", "T_mean", "mean")


def all_of(choices: dict[str, Option]) -> list[Option]:
    """Every combination of some conventions."""
    return list(product(*choices.values()))


@dataclass(frozen=True)
class Gas:
    """Transport properties [SI] as functions of temperature."""

    viscosity: Callable
    conductivity: Callable
    heat_capacity: Callable


def _paper_heat_capacity(t):
    return (28.11 + 1.967e-3 * t + 4.802e-6 * t**2 - 1.966e-9 * t**3) * 1000.0 / 28.97


GASES = {
    "paper": Gas(
        lambda t: 1.716e-5 * (t / 273.0) ** (2.0 / 3.0),
        lambda t: 2.38e-4 * t**0.8218,
        _paper_heat_capacity,
    ),
    "US 1976": Gas(  # the standard has no heat capacity of its own but 7/2 R
        lambda t: 1.458e-6 * t**1.5 / (t + 110.4),
        lambda t: 2.64638e-3 * t**1.5 / (t + 245.4 * 10.0 ** (-12.0 / t)),
        lambda t: 3.5 * 287.05287 + 0.0 * t,
    ),
}

_INVERSE = np.array(
    [
        -4.59195520629687e-29, 4.02322550536528e-27, 1.49047601370574e-23, -7.94159585089666e-21,
        2.02100883624221e-18, -3.15169237730408e-16, 3.27061799378819e-14, -2.33217472878003e-12,
        1.14960632799406e-10, -3.86235307877923e-9, 8.52520967699876e-8, -1.14955512755429e-6,
        8.15422681932410e-6, -2.28247698757490e-5, 9.91066193190049e-5, 3.47312785053852e-3,
    ]
)  # fmt: skip


def _paper_air(altitude):
    """Temperature and pressure of (21) and (22), with the coefficients' full digits."""
    kilometres = altitude / 1e3
    integral = np.polyval(np.polyint(_INVERSE), kilometres)
    pressure = 101325.0 * np.exp(-1000.0 * 9.8 / R * integral)
    return 1.0 / np.polyval(_INVERSE, kilometres), pressure


def _standard_air(altitude):
    """Temperature and pressure of the US Standard Atmosphere 1976, 47 km to 86 km."""
    height = 6356766.0 * altitude / (6356766.0 + altitude)  # geopotential
    bases = (
        (47e3, 270.65, 0.0, 110.9063),
        (51e3, 270.65, -2.8e-3, 66.93887),
        (71e3, 214.65, -2.0e-3, 3.956420),
    )
    temperature, pressure = np.full_like(height, np.nan), np.full_like(height, np.nan)
    for base, warm, lapse, start in bases:
        here = height >= base
        above = height[here] - base
        temperature[here] = warm + lapse * above
        if lapse:
            exponent = 9.80665 / (287.05287 * lapse)
            pressure[here] = start * (warm / temperature[here]) ** exponent
        else:
            pressure[here] = start * np.exp(-9.80665 * above / (287.05287 * warm))
    return temperature, pressure


AIRS = {"paper": _paper_air, "US 1976": _standard_air}


@dataclass(frozen=True)
class Place:
    """Surroundings of disks: temperature [K], pressure [Pa], gravity [m/s²], gas, radius [m]."""

    cold: np.ndarray
    pressure: np.ndarray
    gravity: np.ndarray
    gas: Gas
    radius: np.ndarray

    @property
    def area(self):
        """Area of one face [m²]."""
        return np.pi * self.radius**2

    @property
    def weight(self):
        """Weight of the disk [N]."""
        return AREAL_DENSITY * self.area * self.gravity


def place(environment: Option, altitude: np.ndarray, radius: np.ndarray | float) -> Place:
    """Surroundings at altitudes [m] of disks with a radius [m]; both broadcast."""
    atmosphere, gas, gravity = environment
    cold, pressure = AIRS[atmosphere](altitude)
    falls = {"9.8": 9.8 + 0.0 * altitude, "g(h)": 9.80665 * (6356766 / (6356766 + altitude)) ** 2}
    return Place(cold, pressure, falls[gravity], GASES[gas], np.asarray(radius))


def _at(hot, cold) -> dict[str, np.ndarray]:
    return dict(zip(TEMPERATURES, (cold, 0.5 * (hot + cold), hot), strict=True))


def mean_speed(temperature):
    """Equation (6) [m/s]."""
    return np.sqrt(8.0 * R * temperature / np.pi)


def free_molecular_heat(hot, there: Place, speed: str, divisor: str):
    """Equation (4) for a TAC of 1 and the area A [W]."""
    at = _at(hot, there.cold)
    modes = (GAMMA + 1.0) / (GAMMA - 1.0) / 8.0
    drop = hot - there.cold
    return modes * mean_speed(at[speed]) / at[divisor] * there.area * there.pressure * drop


def continuum_heat(hot, there: Place, gas_at: str, rayleigh: str):
    """Equation (5), counted once [W]."""
    at = _at(hot, there.cold)[gas_at]
    drop = hot - there.cold
    conductivity = there.gas.conductivity(at)
    nusselt = 8.0 / np.pi
    if rayleigh == "in":
        density = there.pressure / (R * at)
        diffusivity = conductivity / (density * there.gas.heat_capacity(at))
        number = there.gravity / at * density * (2.0 * there.radius) ** 3 * drop
        nusselt = nusselt + 0.417 * (number / (there.gas.viscosity(at) * diffusivity)) ** 0.25
    return nusselt * np.pi * there.radius * conductivity * drop


def radiated(hot, there: Place):
    """Net radiation of one face [W]."""
    return there.area * SIGMA * EMISSIVITY * (hot**4 - there.cold**4)


def factors(heat: Option) -> tuple[float, float, float]:
    """What multiplies (4), (5) and the radiation of one face."""
    _, _, area, tac, counted, _, _, faces = heat
    return (
        (2.0 if area == "2A" else 1.0) * TACS[tac],
        2.0 if counted == "twice" else 1.0,
        2.0 if faces == "two" else 1.0,
    )


def lost(heat: Option, hot, there: Place):
    """Heat that a disk loses, equations (3) and (17) [W]."""
    speed, divisor, _, _, _, rayleigh, gas_at, _ = heat
    thin, dense, faces = factors(heat)
    first = thin * free_molecular_heat(hot, there, speed, divisor)
    second = dense * continuum_heat(hot, there, gas_at, rayleigh)
    return first * second / (first + second) + faces * radiated(hot, there)


def thin_force(hot, there: Place, divisor: str):
    """Equation (19) [N]."""
    at = _at(hot, there.cold)[divisor]
    return there.area / (4.0 * at) * there.pressure * (TAC_BOTTOM - TAC_TOP) * (hot - there.cold)


def dense_force(hot, there: Place, conventions: Option):
    """Equation (20) with the factor that its misprint lost [N]."""
    numerator, divisor, gas_at, tac = conventions
    at = _at(hot, there.cold)
    gas = at[gas_at]
    viscosity, density = there.gas.viscosity(gas), there.pressure / (R * gas)
    creep = 16.0 * viscosity * 6.0 * CREEP * viscosity / density
    flux = at[numerator] * there.gas.conductivity(gas)
    flux = flux / (there.radius * there.pressure * mean_speed(gas))
    modes = (GAMMA - 1.0) / (GAMMA + 1.0)
    asymmetry = (TAC_BOTTOM - TAC_TOP) / TACS[tac]
    return creep * flux * modes * asymmetry * (hot - there.cold) / at[divisor]


def force(conventions: Option, hot, there: Place):
    """Equation (18) [N]."""
    divisor, *rest = conventions
    thin, dense = thin_force(hot, there, divisor), dense_force(hot, there, tuple(rest))
    return 1.0 / (1.0 / (C_FM * thin) + 1.0 / (C_CONT * dense))


def levitation_temperature(conventions: Option, there: Place, looks: int = 160):
    """Lowest temperature at which the force carries the disk [K]; infinite where none does."""
    steps = np.geomspace(1e-3, 1.0, looks).reshape(-1, *[1] * there.cold.ndim)
    hot = there.cold + steps * (HOTTEST - there.cold)
    carries = force(conventions, hot, there) >= there.weight
    first = np.argmax(carries, axis=0)[None]
    above = np.take_along_axis(hot, first, axis=0)[0]
    below = np.where(first[0] > 0, np.take_along_axis(hot, np.maximum(first - 1, 0), axis=0)[0],
                     there.cold * (1.0 + 1e-12))  # fmt: skip
    for _ in range(40):
        middle = 0.5 * (below + above)
        enough = force(conventions, middle, there) >= there.weight
        below, above = np.where(enough, below, middle), np.where(enough, middle, above)
    return np.where(carries.any(axis=0), above, np.inf)


def levitation_irradiance(heat: Option, hot, there: Place):
    """Irradiance that keeps the disk at a temperature [W/m²]."""
    with np.errstate(invalid="ignore"):
        needed = lost(heat, hot, there) / (there.area * ABSORPTIVITY)
    return np.where(np.isfinite(hot), needed, np.inf)


def temperature_in_light(heats: list[Option], there: Place, irradiance: float = SUNLIGHT):
    """Temperature of the disk in light [K], shape (number of heat laws, ...).

    All of the laws must agree in everything that is not a factor (see :func:`factors`).
    """
    (kind,) = {(heat[0], heat[1], heat[5], heat[6]) for heat in heats}
    speed, divisor, rayleigh, gas_at = kind
    shape = (-1, *[1] * np.broadcast(there.cold, there.radius).ndim)
    thin, dense, faces = (
        np.array(column).reshape(shape) for column in zip(*map(factors, heats), strict=True)
    )
    absorbed = ABSORPTIVITY * irradiance * there.area
    balance = absorbed / (faces * there.area * SIGMA * EMISSIVITY) + there.cold**4
    below = np.broadcast_to(there.cold * (1.0 + 1e-12), balance.shape)
    above = balance**0.25  # without gas
    for _ in range(48):
        middle = 0.5 * (below + above)
        first = thin * free_molecular_heat(middle, there, speed, divisor)
        second = dense * continuum_heat(middle, there, gas_at, rayleigh)
        gone = first * second / (first + second) + faces * radiated(middle, there)
        cool = gone < absorbed
        below, above = np.where(cool, middle, below), np.where(cool, above, middle)
    return 0.5 * (below + above)
