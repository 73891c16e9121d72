"""A user's own flyers: two temperatures, and a flow through the body."""

from typing import ClassVar

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import root

import lightflyer as lf
from lightflyer.environment import Attitude, EnvironmentState, Radiation

SIGMA = 5.67e-8


def fourth_power_growth(excess):
    """(1 + θ)⁴ − 1 without cancellation."""
    return excess * (4.0 + excess * (6.0 + excess * (4.0 + excess)))


class Tandem(lf.AbstractFlyer):
    """A sunlit plate above a shaded one, joined by a conductor; both radiate from one side."""

    nodes: ClassVar[tuple[str, ...]] = ("upper", "lower")

    plate_area: float
    conductance: float
    absorptance: float = 0.8
    payload: float = 0.0
    attitude: Attitude | None = None

    @property
    def area(self):
        return self.plate_area

    @property
    def own_mass(self):
        return 2e-3 * self.plate_area

    def beam_areas(self, state):
        light = state.radiation.on_faces(self.attitude)
        return self.plate_area * self.absorptance * light.beam_top, 0.0 * light.beam_top

    def heat_gains(self, state):
        return (np.zeros(()), np.zeros(()))

    def heat_losses(self, state, unknowns):
        upper, lower = unknowns[:2]
        cold = state.temperature
        black = self.plate_area * SIGMA * cold**4
        conducted = self.conductance * cold * (upper - lower)
        return (
            0.1 * black * fourth_power_growth(upper) + conducted,
            0.9 * black * fourth_power_growth(lower) - conducted,
        )

    def describe(self):
        return f"tandem of {self.plate_area * 1e4:g} cm²"


class Push(lf.AbstractForceModel):
    """Free molecules between two plates: the hotter one below would lift, so it is upside down."""

    flyers: ClassVar = (Tandem,)
    molecules: ClassVar = ("diatomic",)
    strength: float = 1.0

    def heat_loss(self, flyer, state, unknowns):
        speed = lf.xp.sqrt(8.0 * 287.05 * state.temperature / np.pi)
        each = 0.75 * speed * flyer.area * state.pressure
        return each * unknowns[0], each * unknowns[1]

    def force(self, flyer, state, unknowns):
        upper, lower = unknowns
        # √(1 + θ₁) − √(1 + θ₂) without cancellation
        difference = (upper - lower) / (lf.xp.sqrt(1.0 + upper) + lf.xp.sqrt(1.0 + lower))
        return self.strength * 0.5 * state.pressure * flyer.area * difference


def state_at(pressure, light=1360.0, temperature=215.0, **radiation):
    radiation = Radiation(light, stefan_boltzmann=SIGMA, **radiation)
    return EnvironmentState(pressure, temperature, 9.8, lf.gas.AIR, radiation)


def reference(flyer, pressure, light, cold=215.0):
    """Temperatures by SciPy, from the equations in kelvins."""
    area, joint = flyer.plate_area, flyer.conductance
    gas = 0.75 * np.sqrt(8.0 * 287.05 * cold / np.pi) * area * pressure / cold

    def balance(temperatures):
        upper, lower = temperatures
        conducted = joint * (upper - lower)
        return [
            0.8 * area * light - gas * (upper - cold) - 0.1 * area * SIGMA * (upper**4 - cold**4)
            - conducted,
            conducted - gas * (lower - cold) - 0.9 * area * SIGMA * (lower**4 - cold**4),
        ]  # fmt: skip

    found = root(balance, [cold + 50.0, cold + 20.0], tol=1e-13)
    assert found.success or np.abs(found.fun).max() < 1e-12
    return found.x


@pytest.mark.parametrize("pressure", [1e-4, 1e-2, 1.0, 100.0])
@pytest.mark.parametrize("conductance", [0.0, 1e-6, 1e-2])
def test_both_temperatures_are_those_of_scipy(pressure, conductance):
    flyer = Tandem(plate_area=4e-4, conductance=conductance)
    result = lf.equilibrium(flyer, state_at(pressure), Push())
    expected = reference(flyer, pressure, 1360.0)
    np.testing.assert_allclose(result.temperatures, expected, rtol=1e-8)
    assert result.temperature_of("upper") == result.temperatures[0] == result.temperature
    assert abs(result.residual) < 1e-10
    balance = result.absorbed_power - result.gas_power - result.radiated_power
    assert abs(balance) < 1e-10 * result.absorbed_power


def test_arrays_equal_scalars_and_microkelvins_keep_their_digits():
    pressures, lights = np.geomspace(1e-3, 1e4, 5)[:, None], np.array([1e-6, 1.0, 1e4])
    flyer = Tandem(plate_area=4e-4, conductance=1e-5)
    grid = lf.equilibrium(flyer, state_at(pressures, lights), Push())
    assert grid.temperature.shape == (5, 3)
    one = lf.equilibrium(flyer, state_at(float(pressures[3, 0]), 1e-6), Push())
    assert one.unknowns[0] < 1e-9
    for node in (0, 1):
        assert grid.unknowns[node][3, 0] == pytest.approx(one.unknowns[node], rel=1e-10)


def test_levitation_finds_irradiance_and_temperatures_together():
    pressures = np.geomspace(1e-3, 30.0, 7)
    flyer = Tandem(plate_area=4e-4, conductance=1e-5)
    found = lf.levitate(flyer, state_at(pressures), Push(4.0))
    assert found.levitates.any()
    assert not found.levitates.all()
    there = found.levitates
    lit = state_at(pressures[there], found.irradiance[there])
    np.testing.assert_allclose(
        lf.lift(flyer, lit, Push(4.0)), lf.statics.weight(flyer, lit), rtol=1e-9
    )
    hottest = lf.equilibrium(flyer, lit, Push(4.0)).temperature
    np.testing.assert_allclose(found.temperature[there], hottest, rtol=1e-9)
    assert np.all(np.isinf(found.irradiance[~there]))
    assert np.all(np.isnan(found.temperature[~there]))
    assert np.all(found.converged)


def test_derivatives_are_those_of_differences(compiled):
    def outcomes(y):
        x = lf.xp.exp(y)
        flyer = Tandem(x[0], x[1], absorptance=x[2])
        state = state_at(x[3], x[4])
        lift, light = lf.lift(flyer, state, Push(4.0)), lf.levitate(flyer, state, Push(4.0))
        return lf.xp.log(lf.xp.stack([lift, light.irradiance]))

    def backward(y):
        found, pull = jax.vjp(outcomes, y)
        return found, jnp.stack([pull(row)[0] for row in jnp.eye(2)])

    start, step = np.log([4e-4, 1e-5, 0.7, 3.0, 1360.0]), 1e-5
    ends = [outcomes(start[:, None] + change) for change in (step * np.eye(5), -step * np.eye(5))]
    batch = np.stack([start, start + 0.1])
    with lf.float64():
        values, slopes = compiled(jax.vmap(backward))(batch)
    np.testing.assert_allclose(slopes[0], (ends[0] - ends[1]) / (2 * step), rtol=2e-6, atol=1e-8)
    np.testing.assert_allclose(values, [outcomes(row) for row in batch], rtol=1e-10)


def test_a_model_says_whom_it_is_for(film, disk):
    with pytest.raises(lf.ParameterError, match="Push is not for Disk; it is for Tandem"):
        lf.lift(disk, state_at(1.0), Push())
    with pytest.raises(lf.ParameterError, match="Lu2023 is not for Tandem; it is for Disk"):
        lf.Setup(Tandem(4e-4, 1e-5), lf.Earth(), lf.Lu2023())


def test_prediction_reports_each_part():
    flyer = Tandem(plate_area=4e-4, conductance=1e-5)
    found = lf.predict(flyer, lf.Earth(), Push(4.0), at=[75e3])
    point = found.summary()["at"][0]
    assert point["temperature_upper_k"] == point["temperature_k"] > point["temperature_lower_k"]
    assert {"temperature_upper", "temperature_lower"} <= set(found.dataset)
    assert found.dataset.attrs["flyer"] == "tandem of 4 cm²"
    low, high = found.bands[0]
    band = lf.levitation_band(flyer, lf.Earth(), Push(4.0))
    assert (low, high) == pytest.approx((band.lower, band.upper), abs=0.05)


class Chimney(Tandem):
    """A tandem through which gas rises: its speed is a third unknown."""

    flows: ClassVar[tuple[str, ...]] = ("speed",)
    resistance: float = 2e-2


class Draught(lf.AbstractForceModel):
    """The speed follows a square law in the mean temperature; the gas carries heat away."""

    flyers: ClassVar = (Chimney,)

    def heat_loss(self, flyer, state, unknowns):
        upper, lower, speed = unknowns
        each = (1.0 + speed) * flyer.area * state.pressure
        return each * upper, each * lower

    def force(self, flyer, state, unknowns):
        return flyer.area * state.pressure * unknowns[2]

    def flow_balance(self, flyer, state, unknowns):
        upper, lower, speed = unknowns
        return (speed + flyer.resistance * speed**2 - 0.5 * (upper + lower),)


def test_a_flow_is_an_unknown_like_any_other():
    flyer = Chimney(plate_area=4e-4, conductance=1e-3)
    result = lf.equilibrium(flyer, state_at(5.0), Draught())
    upper, lower, speed = result.unknowns
    # the root of the square law, in closed form
    mean = 0.5 * (upper + lower)
    expected = (np.sqrt(1.0 + 4.0 * 2e-2 * mean) - 1.0) / (2.0 * 2e-2)
    assert speed == pytest.approx(expected, rel=1e-10)
    taken = (1.0 + speed) * 4e-4 * 5.0 * (upper + lower)
    assert result.gas_power == pytest.approx(taken, rel=1e-12)
    assert result.absorbed_power == pytest.approx(
        result.gas_power + result.radiated_power, rel=1e-10
    )
    assert lf.levitate(flyer, state_at(5.0), Draught()).levitates
