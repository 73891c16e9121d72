"""What kinetic theory needs of each gas; docs/gases.md has air.

python studies/gases/table.py
"""

import numpy as np

import lightflyer as lf

GASES = ("air", "nitrogen", "oxygen", "argon", "helium", "co2")
TEMPERATURES = np.array([200.0, 300.0, 400.0])
BIRD = {"nitrogen": 0.74, "oxygen": 0.77, "argon": 0.81, "helium": 0.66, "co2": 0.93}
AIR = 0.77
"""Exponents of variable hard spheres for 273 K; [Bird1994], appendix A."""


def exponents():
    """Print the exponents of the viscosity."""
    print("| gas | 200 K | 300 K | 400 K | Bird |\n|---|---|---|---|---|")
    for name in GASES:
        values = lf.gas.GASES[name].viscosity_exponent(TEMPERATURES)
        cells = " | ".join(f"{value:.3f}" for value in values)
        print(f"| {name} | {cells} | {BIRD.get(name, AIR)} |")


def ratios():
    """Print ratios of transport and heat capacity, and collision numbers, at 300 K."""
    print("| gas | κ/(μR) | Eucken factor | Prandtl number | j | Z at 200, 300, 400 K |")
    print("|---|---|---|---|---|---|")
    for name in GASES:
        gas = lf.gas.GASES[name]
        numbers = (gas.reduced_conductivity, gas.eucken_factor, gas.prandtl_number)
        cells = " | ".join(f"{number(300.0):.3f}" for number in numbers)
        collisions = "–"
        if gas.rotation:
            values = gas.rotational_collision_number(TEMPERATURES, BIRD.get(name, AIR))
            collisions = ", ".join(f"{value:.1f}" for value in values)
        degrees = gas.internal_degrees_of_freedom(300.0)
        print(f"| {name} | {cells} | {abs(degrees):.1f} | {collisions} |")


if __name__ == "__main__":
    exponents()
    print()
    ratios()
