"""Sweeps and searches of a user's own flyer, force model, gas and environment.

The flyer has two plates, of which the upper one is lit; the numbers it is compared with come from
SciPy's root-finder on equations written anew.
"""

from typing import ClassVar

import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import minimize_scalar, root

import lightflyer as lf
from lightflyer.core.quantity import ArealDensity, Coefficient, Fraction, Length, Mass
from lightflyer.design import ObjectDesign
from lightflyer.environment import AbstractEnvironment, Coordinate, EnvironmentState, Radiation
from lightflyer.gas import AbstractGas

SIGMA = 5.670374419e-8
CONDUCTION = 1e-4  # between the plates [W/K]
EXCHANGE, KNEE = 0.3, 20.0  # of the force model; [1], [Pa]
SURFACE, SCALE, TEMPERATURE, GRAVITY = 2.0, 300.0, 250.0, 3.7  # of the shaft; [Pa], [m], ...


class Krypton(AbstractGas):
    name: ClassVar[str] = "krypton"
    molecules: ClassVar[str] = "monatomic"
    specific_gas_constant: float = 99.22
    heat_capacity_ratio: float = 5.0 / 3.0

    def viscosity(self, temperature):
        return 2.5e-5 * temperature / 300.0

    def conductivity(self, temperature):
        return 9e-3 * temperature / 300.0

    def heat_capacity(self, temperature):
        return 248.0 + 0.0 * temperature


class Shaft(AbstractEnvironment):
    """A mine on another planet, denser further down."""

    surface_pressure: float = SURFACE
    radiation: Radiation = Radiation(irradiance=800.0)

    @property
    def coordinate(self):
        return Coordinate(
            name="depth", unit="m", long_name="depth below the surface", lowest=0.0, highest=3e3,
            searched=(0.0, 3e3), logarithmic=False, shown_unit="m",
            easiest_keys=("easiest", "irradiance_w_m2"),
        )  # fmt: skip

    def state(self, coordinate, place=None):
        pressure = self.surface_pressure * jnp.exp(jnp.asarray(coordinate) / SCALE)
        return EnvironmentState(pressure, TEMPERATURE, GRAVITY, Krypton(), self.radiation)


class Twin(lf.AbstractFlyer):
    nodes: ClassVar[tuple[str, ...]] = ("lit", "shaded")

    side: Length
    areal_density: ArealDensity = 1e-2
    absorptance: Fraction = 0.9
    emittance: Fraction = 0.1
    payload: Mass = 0.0
    attitude: None = None

    @property
    def area(self):
        return self.side**2

    @property
    def own_mass(self):
        return self.area * self.areal_density

    def beam_areas(self, state):
        return self.absorptance * self.area, jnp.zeros(())

    def heat_gains(self, state):
        return jnp.zeros(()), jnp.zeros(())

    def heat_losses(self, state, unknowns):
        lit, shaded = unknowns
        black = self.emittance * self.area * SIGMA * state.temperature**4
        across = CONDUCTION * state.temperature * (lit - shaded)
        return black * ((1 + lit) ** 4 - 1) + across, black * ((1 + shaded) ** 4 - 1) - across

    def describe(self):
        return f"twin of {100 * self.side:g} cm"


class Push(lf.AbstractForceModel):
    flyers: ClassVar[tuple[type[lf.AbstractFlyer], ...]] = (Twin,)
    molecules: ClassVar[tuple[str, ...]] = ("monatomic",)

    strength: Coefficient = 0.5

    def heat_loss(self, flyer, state, unknowns):
        speed = state.gas.mean_speed(state.temperature)
        return tuple(EXCHANGE * flyer.area * state.pressure * speed * part for part in unknowns)

    def force(self, flyer, state, unknowns):
        lit, shaded = unknowns
        thrust = self.strength * flyer.area * state.pressure / (1 + (state.pressure / KNEE) ** 2)
        return thrust * (lit - shaded)


def oracle(depth, side=0.02, absorptance=0.9, strength=0.5, irradiance=800.0):
    """Lift over weight and temperature of the lit plate."""
    pressure, area = SURFACE * np.exp(depth / SCALE), side**2
    speed = np.sqrt(8.0 * 99.22 * TEMPERATURE / np.pi)

    def imbalance(unknowns):
        lit, shaded = unknowns
        gas = EXCHANGE * area * pressure * speed * unknowns
        black = 0.1 * area * SIGMA * TEMPERATURE**4 * ((1 + unknowns) ** 4 - 1)
        across = CONDUCTION * TEMPERATURE * (lit - shaded)
        light = absorptance * area * irradiance
        return (gas + black + across * np.array([1, -1]) - light * np.array([1, 0])) / light

    lit, shaded = root(imbalance, [0.5, 0.1], tol=1e-14).x
    lift = strength * area * pressure / (1 + (pressure / KNEE) ** 2) * (lit - shaded)
    return lift / (area * 1e-2 * GRAVITY), TEMPERATURE * (1 + lit)


@pytest.fixture(scope="module")
def setup():
    return lf.Setup(Twin(side=0.02), Shaft(), Push())


@pytest.fixture(scope="module")
def best(setup):
    over = {
        "depth": {"from": "0 m", "to": "3 km"},
        "flyer.side": {"from": "1 cm", "to": "4 cm", "scale": "log"},
    }
    return lf.optimise(setup, maximise="lift_over_weight", over=over, starts=2)


def test_a_sweep_is_the_solution_of_its_equations(setup):
    found = lf.sweep(
        setup.flyer,
        setup.environment,
        setup.model,
        over={"flyer.side": ["1 cm", "3 cm"], "depth": ["100 m", "900 m"]},
        outputs=["lift_over_weight", "temperature_lit"],
    )
    assert found.depth.attrs["units"] == "m"
    assert found.temperature_lit.attrs["long_name"].startswith("temperature of the lit")
    for side in (0.01, 0.03):
        for depth in (100.0, 900.0):
            expected = oracle(depth, side)
            here = found.sel({"flyer.side": side, "depth": depth})
            ours = [float(here[name]) for name in ("lift_over_weight", "temperature_lit")]
            np.testing.assert_allclose(ours, expected, rtol=1e-9)


def test_an_optimum_is_scipys(best):
    found = minimize_scalar(
        lambda depth: -oracle(depth, side=0.04)[0], bounds=(0.0, 3e3), method="bounded",
        options={"xatol": 1e-6},
    )  # fmt: skip
    assert best.value == pytest.approx(-found.fun, rel=1e-9)
    assert best.design["depth"] == pytest.approx(found.x, abs=0.05)
    assert best.active_bounds == {"flyer.side": "high"}
    assert best.agreeing == best.starts == 2
    assert best.elasticities["force.strength"] == pytest.approx(1.0, rel=1e-9)
    above, below = (oracle(found.x, 0.04, absorptance=0.9 * share)[0] for share in (1.001, 0.999))
    slope = (above - below) / (0.002 * best.value)
    assert best.elasticities["flyer.absorptance"] == pytest.approx(slope, rel=1e-4)


def test_a_front_lies_on_the_solution(setup):
    front = lf.pareto(
        setup, maximise="lift_over_weight", minimise="temperature_lit",
        over={"depth": {"from": "0 m", "to": "3 km"}}, population=12, generations=5,
    )  # fmt: skip
    table = front.dataset
    assert table.temperature_lit.attrs["units"] == "K"
    assert table.sizes["design"] > 3
    for row in range(0, table.sizes["design"], 3):
        here = table.isel(design=row)
        expected = oracle(float(here.depth))
        ours = [float(here[name]) for name in ("lift_over_weight", "temperature_lit")]
        np.testing.assert_allclose(ours, expected, rtol=1e-9)
    assert (np.diff(table.temperature_lit) > 0.0).all()  # as the lift grows


def test_sensitivities_are_the_slopes_of_the_solution(setup):
    spread = {"force.strength": 0.005, "environment.radiation.irradiance": 8.0}
    pair = tuple(spread)
    design = ObjectDesign(setup, spread, {pair: 0.5})
    (found,) = lf.sensitivity(design, outputs="lift_over_weight", at={"depth": "900 m"}, points=64)
    assert found.groups == (pair,)
    above, below = (oracle(900.0, irradiance=800.0 * share)[0] for share in (1.001, 0.999))
    slope = (above - below) / (0.002 * found.nominal)
    assert found.nominal == pytest.approx(oracle(900.0)[0], rel=1e-9)
    assert found.elasticity["force.strength"] == pytest.approx(1.0, rel=1e-6)
    assert found.elasticity["environment.radiation.irradiance"] == pytest.approx(slope, rel=1e-5)
    # each has a relative uncertainty of 1 %; together with their correlation
    expected = 0.01 * found.nominal * np.sqrt(1.0 + slope**2 + slope)
    assert found.spread == pytest.approx(expected, rel=0.03)
    assert found.dataset.sizes == {"input": 1}


def test_a_model_for_another_gas_is_refused(setup):
    air = lf.lu2023_earth()
    with pytest.raises(lf.ParameterError, match="Push is not for lu2023-air"):
        lf.sweep(setup.flyer, air, setup.model, over={"altitude": ["70 km"]}, outputs="lift")
