from typing import ClassVar

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.force.convection import (
    joined_conductance,
    jump_share,
    sphere_conductance,
    sphere_nusselt,
)
from lightflyer.gas import AIR, AbstractGas

BOLTZMANN_R = 208.13  # argon's specific gas constant [J/(kg K)]
STRATOSPHERE = {"temperature": 220.0, "gravity": 9.7, "gas": AIR}


class HardAtoms(AbstractGas):
    """A monatomic gas of Pr = 2/3."""

    name: ClassVar[str] = "atoms"
    molecules: ClassVar[str] = "monatomic"
    specific_gas_constant: float = BOLTZMANN_R
    heat_capacity_ratio: float = 5.0 / 3.0

    def viscosity(self, temperature):
        return 2e-5 + 0.0 * temperature

    def conductivity(self, temperature):
        return 3.75 * BOLTZMANN_R * self.viscosity(temperature)

    def heat_capacity(self, temperature):
        return 2.5 * BOLTZMANN_R + 0.0 * temperature


def conducted(rarefaction, tac=1.0, excess=1e-6):
    """Heat loss of a sphere without gravity over that to free molecules, by pa/(μ√(2RT))."""
    temperature, radius = 300.0, 0.01
    speed = np.sqrt(2.0 * BOLTZMANN_R * temperature)
    pressure = rarefaction * 2e-5 * speed / radius
    found = sphere_conductance(
        excess, radius=radius, tac=tac, pressure=pressure, temperature=temperature, gravity=1e-30,
        gas=HardAtoms(),
    )  # fmt: skip
    # four thirds of kinetic energy 2kT a molecule, at n v̄/4 of them
    free = 4.0 * np.pi * radius**2 * pressure * np.sqrt(8.0 * BOLTZMANN_R * temperature / np.pi) / 2
    return found / free


def test_free_molecules():
    for tac in (1.0, 0.6):
        assert conducted(1e-9, tac) == pytest.approx(tac, rel=1e-6)
    # of air, with rotation: (γ+1)/(γ−1)/8 = 3/4 of p v̄ a degree of relative excess
    pressure, radius = 1e-9, 0.5
    found = sphere_conductance(0.3, radius=radius, tac=0.8, pressure=pressure, **STRATOSPHERE)
    speed = np.sqrt(8.0 * AIR.specific_gas_constant * 220.0 / np.pi)
    expected = 0.75 * 0.8 * pressure * speed * 4.0 * np.pi * radius**2
    assert found == pytest.approx(expected, rel=1e-6)


def test_temperature_jump_in_dense_gas():
    """Fourier's law, less the published jump of 1.95 μ√(2RT)/p in distance."""
    rarefaction = 1e3
    ratio = conducted(rarefaction)
    fourier = 15.0 * np.sqrt(np.pi) / 8.0 / rarefaction  # over free molecules
    assert (fourier / ratio - 1.0) * rarefaction == pytest.approx(1.95, rel=0.01)


# linearised Shakhov equation, solved along rays: studies/balloon/sphere_conduction.py
SHAKHOV = {0.03: 0.99645, 0.1: 0.98702, 0.3: 0.95638, 1.0: 0.84278}


@pytest.mark.parametrize(("rarefaction", "ratio"), SHAKHOV.items())
def test_conduction_between_the_limits(rarefaction, ratio):
    assert conducted(rarefaction) == pytest.approx(ratio, rel=0.01)


def test_accommodation_is_a_resistance_of_its_own():
    for rarefaction in (0.01, 1.0, 100.0):
        resistances = [1.0 / conducted(rarefaction, tac) for tac in (1.0, 0.5, 0.25)]
        np.testing.assert_allclose(np.diff(resistances), [1.0, 2.0], rtol=1e-9)


def test_shell_of_gas_within_cold_walls():
    """Between concentric spheres 4πκ/(1/r − 1/R)."""
    radius, walls = 0.02, 0.05
    found = sphere_conductance(
        1e-9, radius=radius, tac=1.0, pressure=1e9, temperature=300.0, gravity=1e-40,
        gas=HardAtoms(), wall_distance=walls,
    )  # fmt: skip
    kappa = 3.75 * BOLTZMANN_R * 2e-5
    expected = 4.0 * np.pi * kappa * 300.0 / (1.0 / radius - 1.0 / walls)
    assert found == pytest.approx(expected, rel=1e-6)


def test_nusselt_number_beside_published_laws():
    laminar = np.array([1e-6, 1.0, 1e3, 1e5])
    factor = (1.0 + (0.469 / 0.71) ** (9.0 / 16.0)) ** (4.0 / 9.0)
    expected = 2.0 + 0.589 * laminar**0.25 / factor  # Churchill 1983
    np.testing.assert_allclose(sphere_nusselt(laminar, 0.71), expected, rtol=0.01)
    # an example of the equation solver EES: 19.52 for the same correlation
    assert sphere_nusselt(1.5e6, 2.0) == pytest.approx(19.52, rel=0.035)
    turbulent = np.geomspace(1e9, 1e12, 7)
    balloons = 0.1 * turbulent**0.34  # Carlson and Horn 1983
    np.testing.assert_allclose(sphere_nusselt(turbulent, 0.71), balloons, rtol=0.13)
    assert sphere_nusselt(0.0, 0.71) == 2.0
    assert np.all(np.diff(sphere_nusselt(np.geomspace(1e-3, 1e13, 60), 0.71)) > 0.0)


def test_heat_grows_with_the_excess_and_vanishes_with_it():
    excess = np.concatenate([-np.geomspace(0.9, 1e-9, 40), [0.0], np.geomspace(1e-9, 8.0, 40)])
    for pressure in (1e-4, 1.0, 1e3, 1e5):
        heat = excess * sphere_conductance(
            excess, radius=3.0, tac=0.9, pressure=pressure, **STRATOSPHERE
        )
        assert heat[40] == 0.0
        assert np.all(np.diff(heat) > 0.0)


POINT = np.array([0.2, 1.5, 0.8, 300.0, 230.0, 9.6, 0.9])


def heat(x):
    excess, radius, tac, pressure, temperature, gravity, convection = x
    return excess * sphere_conductance(
        excess, radius=radius, tac=tac, pressure=pressure, temperature=temperature,
        gravity=gravity, gas=AIR, convection=convection,
    )  # fmt: skip


def test_derivatives_jit_and_vmap(require_derivatives):
    """In thin and in dense gas; of logarithms."""

    def heats(x):
        others = [[*x[:3], share * x[3], *x[4:]] for share in (3e-6, 1.0, 200.0)]
        return lf.xp.log(lf.xp.stack([heat(other) for other in others]))

    require_derivatives(heats, POINT, rtol=1e-6, atol=1e-9)


def test_derivative_without_a_difference():
    with lf.float64():
        slope = np.asarray(jax.grad(heat)(jnp.asarray([0.0, *POINT[1:]])))
    assert slope[0] > 0.0
    np.testing.assert_array_equal(slope[1:], 0.0)


def test_laws_of_shares():
    assert jump_share(0.0) == 1.0
    assert jump_share(1e12) == pytest.approx(8.0 / 15.0 * 1.95 / np.sqrt(np.pi), rel=1e-9)
    assert joined_conductance(2.0, 1e15, 0.5) == pytest.approx(1.0, rel=1e-9)
