"""Viscosity and conductivity of dilute helium from the scattering of its atoms.

    python studies/gases/helium.py

Prints both at temperatures from 60 K to 1500 K, and how far the gas ``helium`` is from them. It
takes two seconds.

The radial Schrödinger equation is solved by Numerov's method for every energy and angular momentum
in the potential HFD-B(HE) of [Aziz1987]. Its phase shifts give the cross section of momentum
transfer of second order, and that the collision integrals. Atoms are bosons: even angular momenta
only. Viscosity and conductivity are Kihara's second approximations.
"""

import numpy as np
from scipy import constants
from scipy.interpolate import CubicSpline
from scipy.special import spherical_jn, spherical_yn

from lightflyer.gas import HELIUM

TEMPERATURES = (60.0, 80.0, 100.0, 150.0, 200.0, 298.15, 400.0, 700.0, 1000.0, 1500.0)

MASS = 4.002603254 * constants.atomic_mass
ANGSTROM = 1e-10
KINETIC = constants.hbar**2 / (MASS * constants.k * ANGSTROM**2)  # ħ²/2μ [K Å²]

DEPTH, MINIMUM, CUT = 10.948, 2.963, 1.4826  # [K], [Å], [minimum]
SCALE, SLOPE, CURVATURE = 1.8443101e5, 10.43329537, -2.27965105
DISPERSION = {6: 1.36745214, 8: 0.42123807, 10: 0.17473318}

FARTHEST = 14.0  # [Å], where the potential is 1e-4 of its depth
FORBIDDEN = 40.0  # potential over the energy where waves are taken to begin
ENERGIES = np.geomspace(8.0, 30000.0, 140)  # [K]
GAUSS = np.polynomial.legendre.leggauss(200)


def potential(distance):
    """Energy of two atoms [K] at a distance [Å]."""
    reduced = distance / MINIMUM
    damping = np.where(reduced < CUT, np.exp(-((CUT / reduced - 1.0) ** 2)), 1.0)
    attraction = sum(weight / reduced**power for power, weight in DISPERSION.items())
    repulsion = SCALE * np.exp(-SLOPE * reduced + CURVATURE * reduced**2)
    return DEPTH * (repulsion - damping * attraction)


def phase_shifts(energy):
    """Of all angular momenta that matter at an energy [K]."""
    wave = np.sqrt(energy / KINETIC)
    near = np.linspace(0.3, MINIMUM, 5000)
    first = near[np.argmax(potential(near) < max(FORBIDDEN * energy, 3e4))]
    step = min(0.02, 2.0 * np.pi / wave / 40.0)
    distance = first + step * np.arange(int((FARTHEST - first) / step) + 2)
    momenta = np.arange(int(9.0 * wave) + 15)
    square = (energy - potential(distance)) / KINETIC
    barrier = momenta * (momenta + 1.0)

    def weight(index):
        return 1.0 + step**2 / 12.0 * (square[index] - barrier / distance[index] ** 2)

    before, here = np.zeros(momenta.size), np.full(momenta.size, 1e-30)
    for index in range(1, distance.size - 1):
        after = (12.0 - 10.0 * weight(index)) * here - weight(index - 1) * before
        before, here = here, after / weight(index + 1)
        largest = np.maximum(np.abs(here), 1e-200)
        if index % 20 == 0:
            before, here = before / largest, here / largest
    one, two = wave * distance[-2], wave * distance[-1]
    ratio = before / here
    with np.errstate(all="ignore"):
        tangent = (ratio * two * spherical_jn(momenta, two) - one * spherical_jn(momenta, one)) / (
            ratio * two * spherical_yn(momenta, two) - one * spherical_yn(momenta, one)
        )
    return wave, np.arctan(np.where(np.isfinite(tangent), tangent, 0.0))


def cross_section(energy):
    """Of momentum transfer of second order, for bosons [Å²]."""
    wave, shifts = phase_shifts(energy)
    momenta = np.arange(shifts.size - 2)
    weights = (momenta + 1.0) * (momenta + 2.0) / (2.0 * momenta + 3.0)
    terms = weights * np.sin(shifts[2:] - shifts[:-2]) ** 2
    return 8.0 * np.pi / wave**2 * np.sum(terms[::2])


def transport(temperature, section):
    """Viscosity [Pa s] and conductivity [W/(m K)], of the logarithm of the cross section."""
    low, high = np.log(ENERGIES[0] / temperature), np.log(min(ENERGIES[-1] / temperature, 45.0))
    logarithm = 0.5 * (high - low) * GAUSS[0] + 0.5 * (high + low)
    energy = np.exp(logarithm)
    density = 0.5 * (high - low) * GAUSS[1] * np.exp(section(logarithm + np.log(temperature)))
    second, third = (
        np.sum(0.5 * energy ** (order + 2) * np.exp(-energy) * density) * ANGSTROM**2
        for order in (2, 3)
    )
    growth = (8.0 * third / (4.0 * second) - 7.0) ** 2
    speed = np.sqrt(constants.k * temperature / (np.pi * MASS))
    viscosity = 5.0 * constants.k * temperature / (8.0 * speed * second)
    conductivity = 15.0 / 4.0 * constants.k / MASS * viscosity * (1.0 + growth / 42.0)
    return viscosity * (1.0 + 3.0 * growth / 196.0), conductivity


def main():
    """Print the table."""
    sections = [cross_section(energy) for energy in ENERGIES]
    section = CubicSpline(np.log(ENERGIES), np.log(sections))
    print(f"depth of the potential over that stated: {-potential(MINIMUM) / DEPTH:.7f}")
    print("T [K]   μ [µPa s]   κ [mW/(m K)]   helium's μ, κ over these")
    for temperature in TEMPERATURES:
        viscosity, conductivity = transport(temperature, section)
        ours = HELIUM.viscosity(temperature) / viscosity - 1.0
        theirs = HELIUM.conductivity(temperature) / conductivity - 1.0
        print(
            f"{temperature:7.2f} {viscosity * 1e6:10.4f} {conductivity * 1e3:12.3f}"
            f" {ours:+12.2%} {theirs:+.2%}"
        )


if __name__ == "__main__":
    main()
