import re

import jax.numpy as jnp
import numpy as np
import pytest
from kinetic_fits.perforated import perforated_disk_table
from scipy.optimize import brentq, fsolve

import lightflyer as lf
from lightflyer.array import tree
from lightflyer.force.kinetic.ratios import kinetic_fit
from lightflyer.force.laws.channels import (
    SLOT,
    channel_coefficients,
    channel_conductance,
    gas_at_faces,
)
from lightflyer.force.laws.disk_gas import disk_surroundings, recoil_ratio
from lightflyer.force.membranes.sandwich import perforated_disk_fit
from lightflyer.force.pumps.channel_pump import outer_resistance, through_flow
from lightflyer.statics.equations import FlightEquations

MODEL = lf.ChannelPump()
GAS = lf.gas.AIR
SIGMA = 5.670374419e-8
R = 287.05
AREA = np.pi * 4e-3**2


def make(**changed):
    top = lf.FilmProperties(1.5e-4, 0.02, 0.10, 0.15, 0.7, 0.8, transmittance=0.9)
    bottom = lf.FilmProperties(2.5e-4, 0.80, 0.20, 0.10, 0.6, 0.9)
    numbers = {
        "radius": 4e-3, "channel_width": 50e-6, "channel_length": 500e-6, "spacing": 50e-6,
        "height": 80e-6, "wall_thickness": 50e-9, "wall_conductivity": 1.8, "wall_density": 3e3,
    }  # fmt: skip
    return lf.Plate(top, bottom, **(numbers | changed))


def black(**changed):
    """Of which every molecule leaves as warm as a face or a channel's wall is."""
    films = [lf.FilmProperties(2e-4, 0.5, 0.1, 0.1, 1.0, 1.0) for _ in range(2)]
    return tree.replace_at(lambda flyer: (flyer.top, flyer.bottom), make(**changed), films)


def state_at(pressure, temperature=280.0, irradiance=0.0, **radiation):
    radiation = lf.environment.Radiation(irradiance, **radiation)
    return lf.environment.EnvironmentState(pressure, temperature, 9.7, GAS, radiation)


# -- the gas outside ------------------------------------------------------------------------------


def test_gas_around_a_disk_beside_kinetic_solutions():
    delta = np.geomspace(0.05, 15.0, 12)
    fit, knudsen = kinetic_fit("monatomic"), 0.25 * np.sqrt(np.pi) / delta
    with lf.float64():
        around, recoil = disk_surroundings(delta), recoil_ratio(delta)
        heat, force = fit.heat_ratio(knudsen, 1.0, 1.0), fit.force_ratio(knudsen, 1.0, 1.0)
        # an isothermal disk, and one whose faces differ in TAC
        np.testing.assert_allclose(around.common / (1.0 + around.common), heat, rtol=0.012)
        np.testing.assert_allclose(recoil, force / heat, rtol=0.04)
    # one face as warm as the other is cold; in denser gas the table's ends near the disk
    table = perforated_disk_table()
    assert table.open_fraction[0] == 0.0
    with lf.float64():
        around = disk_surroundings(table.rarefaction[:7])
        ratio = np.asarray(around.difference / (1.0 + around.difference))
    np.testing.assert_allclose(ratio, table.difference_ratio[0, :7], rtol=0.08)


def test_conduction_of_a_disk_in_dense_gas():
    """8κaΔT of both faces in open space."""
    delta = 1e4
    with lf.float64():
        per_face = float(disk_surroundings(delta).common) / np.sqrt(np.pi)  # in units of p v A θ
    # κT = 15/4 Rμ T of a monatomic gas, with μ = p a/(δ v) and RT = v²/2
    assert per_face == pytest.approx(4.0 / np.pi * 15.0 / 8.0 / delta, rel=0.03)


def force_of_thin_disk(beta, delta):
    """By the laws of this model, of a disk with holes for free molecules, in pA/4 · sΔθ."""
    solid = 1.0 - beta
    warm, cold = gas_at_faces(0.5, -0.5, solid, solid, beta, disk_surroundings(delta))
    pump = 0.5 * (warm - cold)  # of p
    viscosity = 0.5 / delta
    flow = through_flow(
        pump, solid * np.sqrt(np.pi) / beta, outer_resistance(1.0, 0.5, viscosity, 1.0),
        radius=1.0, density=1e-6 * viscosity, viscosity=viscosity,
    )  # fmt: skip
    recoil = 0.25 * recoil_ratio(delta) * (solid - beta * (warm - cold))
    return (flow.difference + recoil) / (0.25 * solid)


@pytest.mark.parametrize("beta", [0.1, 0.3])
def test_pump_and_recoil_make_the_force_on_a_perforated_disk(beta):
    """Simulated by Schafer et al. within a wall, whose effect a disk without holes shows."""
    simulated = perforated_disk_fit().force_ratio
    with lf.float64():
        for delta in (0.1, 0.5, 1.0, 2.0, 5.0):
            wall = float(simulated(0.0, delta) / recoil_ratio(delta))
            expected = float(simulated(beta, delta)) / wall
            assert force_of_thin_disk(beta, delta) == pytest.approx(expected, rel=0.11)


@pytest.mark.parametrize("beta", [0.1, 0.5, 0.8])
def test_limits_of_the_force_on_a_perforated_disk(beta):
    with lf.float64():
        # dense gas in open space: gas difference and Stokes' law by hand
        dense = force_of_thin_disk(beta, 1e8) * 0.25 * (1.0 - beta)
        assert dense == pytest.approx(4.0 / np.pi**1.5 * beta / (1.0 + beta) / 1e8, rel=0.03)
        # free molecules
        assert force_of_thin_disk(beta, 1e-7) == pytest.approx(1.0, rel=1e-6)


# -- limits ---------------------------------------------------------------------------------------


def test_free_molecules_push_as_they_leave():
    """Nothing is pumped; black faces and channels leave what comes straight through alone."""
    plate, pressure = black(), 1e-7
    state = state_at(pressure)
    top, bottom = 0.1, 0.4
    with lf.float64():
        force = MODEL.force(plate, state, (top, bottom))
        results = MODEL.own_results(plate, state, (top, bottom))
    length = 80.0 / 50.0
    straight = np.hypot(1.0, length) - length
    share = 1.0 - float(plate.open_fraction) * straight
    expected = 0.5 * pressure * AREA * share * (np.sqrt(1.0 + bottom) - np.sqrt(1.0 + top))
    assert force == pytest.approx(expected, rel=1e-6)
    assert abs(results["pressure_difference"]) < 1e-6 * pressure
    free = 0.75 * np.sqrt(8.0 * R * 280.0 / np.pi) * pressure * AREA  # (γ+1)/(γ−1)/8 of air
    with lf.float64():
        taken = MODEL.heat_loss(plate, state, (top, bottom))
    assert sum(taken) == pytest.approx(share * free * (top + bottom), rel=2e-3)


def coefficient(reynolds, creeping=16.0):
    """Force of the flow around a disk over μau, as docs/outer-flow.md has it."""
    return np.hypot(creeping, (2.21 + 6.57 / np.sqrt(5.12 + reynolds)) * reynolds)


def test_dense_gas_is_pushed_by_the_pump_alone():
    plate, state = black(radius=0.1), state_at(1e5)
    with lf.float64():
        force = float(MODEL.force(plate, state, (0.10, 0.11)))
        results = {
            name: float(value)
            for name, value in MODEL.own_results(plate, state, (0.10, 0.11)).items()
        }
    assert force == pytest.approx(results["pressure_difference"] * np.pi * 0.1**2, rel=0.06)
    velocity, density = results["flow_velocity"], 1e5 / (R * 280.0)
    viscosity = float(GAS.viscosity(280.0 * (1.0 + 0.25 * 0.21)))
    assert results["reynolds_number"] == pytest.approx(
        density * 0.1 * velocity / viscosity, rel=1e-4
    )
    around = coefficient(results["reynolds_number"]) * viscosity * 0.1 * velocity
    assert results["pressure_difference"] * np.pi * 0.1**2 == pytest.approx(around, rel=1e-3)
    # the channel: Maxwell's creep and Poiseuille's flow, thirty paths wide
    mean = 280.0 * 1.105
    viscosity, speed = float(GAS.viscosity(mean)), np.sqrt(2.0 * R * mean)
    delta = 1e5 * 50e-6 / (viscosity * speed)
    stopping = 1.175 / delta / (delta / 6.0 + 1.018) * 1e5 * 0.01 / 1.105
    assert results["stopping_pressure"] == pytest.approx(stopping, rel=0.05)


PRESSURES = np.array([1e-3, 0.3, 30.0, 3e3, 1e5])


def test_no_force_without_a_temperature_difference():
    state, scale = state_at(PRESSURES, 240.0), PRESSURES * AREA
    in_the_dark = lf.equilibrium(make(), state, MODEL)  # all as warm as the gas
    with lf.float64():
        for unlike in (make(), black()):  # faces of unlike TACs push only where they are warmer
            np.testing.assert_array_equal(MODEL.force(unlike, state, in_the_dark.unknowns), 0.0)
            np.testing.assert_array_equal(MODEL.heat_loss(unlike, state, (0.0, 0.0)), 0.0)
        push = np.asarray(MODEL.force(black(), state, (0.3, 0.3)))
        assert np.all(np.abs(push) < 1e-14 * scale)
        one, other = (
            np.asarray(MODEL.force(black(), state, pair)) for pair in ((0.1, 0.3), (0.3, 0.1))
        )
    assert np.all(one > 0.0)
    np.testing.assert_allclose(one, -other, rtol=1e-12)


def test_own_error_of_the_model():
    """One standard error of the model moves force and heat loss by their stated shares."""
    state, faces = state_at(30.0), (0.2, 0.3)
    off = lf.ChannelPump(force_error=1.0, heat_error=-1.0)
    with lf.float64():
        force = float(off.force(make(), state, faces) / MODEL.force(make(), state, faces))
        heat = [float(sum(model.heat_loss(make(), state, faces))) for model in (off, MODEL)]
    assert force == pytest.approx(1.1, rel=1e-12)
    assert heat[0] / heat[1] == pytest.approx(0.95, rel=1e-12)


# -- the whole flyer ------------------------------------------------------------------------------


def by_hand(flyer, pressure, temperature, irradiance):
    """Both temperatures, the force and the velocity from the equations, written for NumPy."""
    width, long, space, height, a = 50e-6, 500e-6, 50e-6, 80e-6, 4e-3
    phi = width * long / ((width + space) * (long + space))
    walls = 2.0 * (width + long) * 50e-9 / ((width + space) * (long + space))
    length = height / width
    straight = np.hypot(1.0, length) - length
    coming = np.arcsinh(length)
    root = np.hypot(1.0, length)
    collided = 1.5 * (length - coming) ** 2
    collided /= length**3 + 3.0 * length**2 + 4.0 - (length**2 + 4.0) * root
    through = 0.5 * (1.0 + root - length) - collided
    gamma = float(GAS.heat_capacity_ratio)

    def free(at):  # black face, per area and K
        return (
            (gamma + 1.0) / (gamma - 1.0) / 8.0 * np.sqrt(8.0 * R_AIR * at / np.pi) * pressure / at
        )

    def gas_temperatures(temperatures):
        top, bottom = temperatures
        mean, outer = 0.5 * (top + bottom), 0.5 * temperature + 0.25 * (top + bottom)
        kappa, mu = float(GAS.conductivity(mean)), float(GAS.viscosity(mean))
        delta = pressure * width / (mu * np.sqrt(2.0 * R_AIR * mean))
        passing = phi * straight / (1.0 + 2.0 / np.sqrt(np.pi) * delta * length)
        taking = np.array([0.7, 0.9]) * (1.0 - phi) + phi - passing
        mu, kappa_outer = float(GAS.viscosity(outer)), float(GAS.conductivity(outer))
        delta_a = pressure * a / (mu * np.sqrt(2.0 * R_AIR * temperature))
        internal = 4.0 / 15.0 * kappa_outer / (mu * R_AIR) / (0.25 * (gamma + 1) / (gamma - 1))
        with lf.float64():
            common, difference = (float(c) for c in disk_surroundings(delta_a, internal))
        heat = np.array([
            [taking[0] + passing + 0.5 * (common + difference),
             -passing + 0.5 * (common - difference)],
            [-passing + 0.5 * (common - difference),
             taking[1] + passing + 0.5 * (common + difference)],
        ])  # fmt: skip
        excess = np.linalg.solve(heat, taking * (np.array([top, bottom]) - temperature))
        gap = 1.0 / (1.0 / 0.8 + 1.0 / 0.6 - 1.0)
        inside = (1.0 - phi) / (height / kappa + 1.0 / (gap * free(mean)))
        inside += phi / (height / kappa + 1.0 / ((through - straight) * free(mean)))
        return excess, taking, passing, delta, delta_a, inside

    def imbalance(temperatures):
        top, bottom = temperatures
        excess, taking, _, _, _, inside = gas_temperatures(temperatures)
        to_gas = free(temperature) * taking * (np.array([top, bottom]) - temperature - excess)
        upward = (inside + walls * 1.8 / height) * (bottom - top)
        solid = 1.0 - phi
        # infrared: radiosities between the films by two equations
        emitted = (
            SIGMA
            * solid
            * np.array([0.10, 0.15, 0.20, 0.10])
            * np.repeat(np.array([top, bottom]) ** 4, 2)
        )
        world = SIGMA * temperature**4
        reflect_t, reflect_b = 1.0 - phi - solid * 0.15, 1.0 - phi - solid * 0.20
        up, down = np.linalg.solve(
            [[1.0, -reflect_b], [-reflect_t, 1.0]],
            [phi * world + emitted[2], phi * world + emitted[1]],
        )
        infrared = np.array([
            solid * (0.10 * world + 0.15 * up) - emitted[0] - emitted[1],
            solid * (0.10 * world + 0.20 * down) - emitted[2] - emitted[3],
        ])  # fmt: skip
        # light: 0.9 passes, the upper film reflects 0.08 and the lower one 0.2
        series = 0.9 / (1.0 - 0.08 * 0.2) * irradiance * solid
        sun = np.array([solid * irradiance * 0.02 + 0.02 * 0.2 * series, 0.8 * series])
        return sun + infrared - to_gas + np.array([upward, -upward])

    found, _, flag, _ = fsolve(imbalance, [350.0, 360.0], xtol=1e-13, full_output=True)
    assert flag == 1
    excess, taking, passing, delta, delta_a, _ = gas_temperatures(found)
    mean, outer = found.mean(), 0.5 * temperature + 0.5 * found.mean()
    with lf.float64():
        flow, creep = (float(g) for g in channel_coefficients(SLOT, delta, length))
        conduct = float(channel_conductance(SLOT, delta, length, phi))
        ratio = float(recoil_ratio(delta_a)) / np.sqrt(
            1.0 + 2.0 / np.sqrt(np.pi) * delta_a * height / a
        )
    gas = 1.0 + excess / temperature
    stopping = 2.0 * pressure * np.sinh(0.5 * creep / flow * np.log(gas[1] / gas[0]))
    density, fast = pressure / (R_AIR * temperature), np.sqrt(2.0 * R_AIR * mean)
    viscous = 16.0 * float(GAS.viscosity(outer)) / (np.pi * a)
    thin = 2.0 * np.sqrt(np.pi) * pressure / np.sqrt(2.0 * R_AIR * temperature)

    def pressure_left(u):
        return stopping - density * fast / (phi * conduct) * u

    slow = np.pi * a / (float(GAS.viscosity(outer)) * (1.0 / viscous + 1.0 / thin))

    def resisting(u):
        reynolds = density * a * u / float(GAS.viscosity(outer))
        return coefficient(reynolds, slow) * float(GAS.viscosity(outer)) * u / (np.pi * a)

    velocity = brentq(lambda u: pressure_left(u) - resisting(u), 0.0, 100.0, xtol=1e-15)
    roots, near = np.sqrt(found / temperature) - 1.0, np.sqrt(gas) - 1.0
    leaving = taking * roots + (1.0 - taking - passing) * near + passing * near[::-1]
    recoil = 0.5 * pressure * ratio * (leaving[1] - leaving[0])
    return found, AREA * (resisting(velocity) + recoil), velocity


R_AIR = float(GAS.specific_gas_constant)


def test_balance_force_and_flow_against_the_equations_in_numpy():
    flyer = make()
    state = state_at(PRESSURES, 240.0, irradiance=5000.0)
    expected = [by_hand(flyer, pressure, 240.0, 5000.0) for pressure in PRESSURES]
    temperatures, force, velocity = (np.array(part).T for part in zip(*expected, strict=True))
    found = lf.equilibrium(flyer, state, MODEL)
    np.testing.assert_allclose(found.temperatures, temperatures, rtol=1e-9)
    with lf.float64():
        lift = MODEL.force(flyer, state, found.unknowns)
        results = MODEL.own_results(flyer, state, found.unknowns)
        # of the pump, a difference of temperatures that nearly cancels
        np.testing.assert_allclose(lift, force, rtol=1e-7)
        np.testing.assert_allclose(results["flow_velocity"], velocity, rtol=1e-7)
    # energy closes
    lost = found.gas_power + found.radiated_power
    np.testing.assert_allclose(lost, found.absorbed_power, rtol=1e-10)


POINT = np.array([4e-3, 50e-6, 600e-6, 60e-6, 80e-6, 60e-9, 0.8, 0.2, 0.7, 40.0, 230.0, 4000.0])


def build(x):
    radius, width, long, space, height, wall, *others = x
    absorptance, emittance, tac, pressure, temperature, light = others
    top = lf.FilmProperties(1.5e-4, 0.02, emittance, emittance, 0.8, tac, transmittance=0.9)
    bottom = lf.FilmProperties(2e-4, absorptance, emittance, 0.05, tac, 0.6)
    flyer = lf.Plate(
        top, bottom, radius, width, long, space, height, wall, 1.8, payload=1e-9, wall_density=3e3
    )
    return flyer, state_at(pressure, temperature, irradiance=light, zenith_angle=0.3, albedo=0.2)


def outcomes(x):
    """Lift, temperatures and velocity, of order one."""
    flyer, state = build(x)
    balance = lf.equilibrium(flyer, state, MODEL)
    force = FlightEquations(flyer, state, MODEL).upward_force(balance.unknowns)
    velocity = MODEL.own_results(flyer, state, balance.unknowns)["flow_velocity"]
    return jnp.log(jnp.stack([force, *balance.temperatures, velocity]))


def test_derivatives_jit_and_vmap(require_derivatives):
    require_derivatives(outcomes, POINT, rtol=5e-6, atol=1e-7)


def test_what_is_outside_the_models_range():
    state = state_at(30.0, irradiance=5000.0)
    assert MODEL.diagnostics(make(), state, 400.0) == ()
    short, slots = sorted(
        MODEL.diagnostics(make(height=20e-6, channel_length=100e-6), state, 400.0), reverse=True
    )
    assert short.startswith("height over channel_width is 0.4 at 30 Pa, below 0.5: channel-pump")
    assert slots.startswith("channel_length over channel_width is 2 at 30 Pa, below 10: channel")
    wide = make(radius=0.3, height=500e-6)
    (fast,) = MODEL.diagnostics(wide, state_at(np.array([1.0, 300.0]), irradiance=5000.0), 400.0)
    assert re.match(r"the Reynolds number of the flow \(radius\) is \S+ at 300 Pa, above 1", fast)
    huge = make(radius=50.0, height=2e-3, channel_width=400e-6, channel_length=4e-3)
    (*_, extrapolated) = MODEL.diagnostics(huge, state_at(3e3, irradiance=5000.0), 400.0)
    assert "the flow through the disk is" in extrapolated
    assert extrapolated.endswith("above 1e+03: the force of the flow is extrapolated")
