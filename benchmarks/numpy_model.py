"""The paper's equations once more, in plain NumPy: an oracle for tests, a peer for benchmarks.

Written from the equations, not from the package, and on purpose in the obvious way: absolute
temperatures, ``**``, both limits joined as printed. Shares no code with lightflyer.
"""

import numpy as np

R = 287.05
GRAVITY = 9.8
STEFAN_BOLTZMANN = 5.67e-8
GAMMA = 1.4
CREEP = 1.14


def viscosity(t):
    """Eq. (11) [Pa s]."""
    return 1.716e-5 * (t / 273.0) ** (2.0 / 3.0)


def conductivity(t):
    """Eq. (12) [W/(m K)]."""
    return 2.38e-4 * t**0.8218


def heat_capacity(t):
    """Eq. (13), corrected [J/(kg K)]."""
    return (28.11 + 1.967e-3 * t + 4.802e-6 * t**2 - 1.966e-9 * t**3) * 1000.0 / 28.97


def mean_speed(t):
    """Mean molecular speed [m/s]."""
    return np.sqrt(8.0 * R * t / np.pi)


def lost_power(hot, cold, pressure, radius, tac_mean, emittance, reported=True):
    """Heat loss of a disk with equal faces [W]; Eqs. (3)-(10), (17)."""
    area, mean, difference = np.pi * radius**2, 0.5 * (hot + cold), hot - cold
    at = cold if reported else mean
    free_molecular = (
        (GAMMA + 1) / (GAMMA - 1) / 8 * mean_speed(at) / at * 2 * area * tac_mean * pressure
    ) * difference
    density = pressure / (R * mean)
    diffusivity = conductivity(mean) / (density * heat_capacity(mean))
    rayleigh = (
        GRAVITY / mean * density * (2 * radius) ** 3 * difference / (viscosity(mean) * diffusivity)
    )
    nusselt = 8 / np.pi + 0.417 * rayleigh**0.25
    continuum = nusselt * np.pi * radius * conductivity(mean) * difference
    continuum = continuum * (2 if reported else 1)
    # the harmonic sum, in the form that is also right at no difference at all
    gas = free_molecular * continuum / np.maximum(free_molecular + continuum, 1e-300)
    return gas + 2 * area * STEFAN_BOLTZMANN * emittance * (hot**4 - cold**4)


def force(hot, cold, pressure, radius, tac_top, tac_bottom, *, reported=True):
    """Photophoretic force with C_fm = 0.4 and C_cont = 3 [N]; Eqs. (18)-(20)."""
    area, mean, difference = np.pi * radius**2, 0.5 * (hot + cold), hot - cold
    asymmetry, tac_mean = tac_bottom - tac_top, 0.5 * (tac_top + tac_bottom)
    free_molecular = area * pressure * asymmetry * difference / (4 * (mean if reported else cold))
    density = pressure / (R * mean)
    continuum = (
        16 * viscosity(mean) * 6 * CREEP * viscosity(mean) / density
        * hot * conductivity(mean) / (radius * pressure * mean_speed(mean))
        * (GAMMA - 1) / (GAMMA + 1) * asymmetry / tac_mean * difference / cold
    )  # fmt: skip
    return 1 / (1 / (0.4 * free_molecular) + 1 / (3 * continuum))
