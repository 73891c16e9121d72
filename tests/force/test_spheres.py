"""Forces on spheres, and the heat that gas takes from them."""

import json
from pathlib import Path

import jax.numpy as jnp
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.array import tree
from lightflyer.force import spheres

GAS = lf.gas.AIR
STUDY = Path(__file__).parents[2] / "studies" / "sphere_force" / "results.json"
SOLVED = json.loads(STUDY.read_text(encoding="utf-8"))
SIGMA = 5.670374419e-8
ROHATSCHEK, FREE = lf.Rohatschek1995(), lf.force.FreeMolecularSphere()
KINETIC = lf.KineticSphere()
MODELS = (ROHATSCHEK, KINETIC, FREE)


def sphere_of(**changed):
    numbers = {
        "radius": 2e-6, "absorption_efficiency": 0.8, "emittance": 0.3, "conductivity": 0.4,
        "tac_top": 0.8, "tac_bottom": 0.9, "density": 1500.0, "upright": "dipole",
    }  # fmt: skip
    return lf.Sphere(**(numbers | changed))


def state_at(pressure=5500.0, temperature=220.0, gas=GAS, **radiation):
    radiation = lf.environment.Radiation(**radiation)
    return lf.environment.EnvironmentState(pressure, temperature, 9.7, gas, radiation)


def force(model, flyer, state, mean, side):
    """At an excess of the mean, and an amplitude over the gas temperature."""
    with lf.float64():
        return float(model.force(flyer, state, (mean + side, mean - side)))


# --- free molecules ---


def summed(flyer, state, mean, side, cosine=1.0):
    """Momentum of what leaves each patch of the surface; ``cosine``: of the axis's tilt."""
    points, weights = np.polynomial.legendre.leggauss(400)
    turn = np.linspace(0.0, 2.0 * np.pi, 720, endpoint=False) + 1e-3
    total = 0.0
    # patches by their angle from the axis, of each half
    for tac, low in ((flyer.tacs[1], -1.0), (flyer.tacs[0], 0.0)):
        along = (low + 0.5 * (points + 1.0))[:, None]
        across = np.sqrt(1.0 - along**2) * np.cos(turn)
        up = along * cosine + across * np.sqrt(1.0 - cosine**2)
        root = np.sqrt(1.0 + tac * (mean + side * up))
        ring = 0.5 * weights * (2.0 * np.pi * flyer.radius**2)
        total -= np.sum(ring[:, None] * 0.5 * state.pressure * root * up) / turn.size
    return float(total)


@pytest.mark.parametrize("mean", [-0.8, -0.3, 0.0, 1e-3, 0.7, 6.0])
@pytest.mark.parametrize("side", [0.0, 1e-7, 1e-3, -0.15])
def test_free_molecules_by_a_sum_over_the_surface(mean, side):
    flyer, state = sphere_of(), state_at()
    expected = summed(flyer, state, mean, side)
    found = force(FREE, flyer, state, mean, side)
    scale = np.pi * flyer.radius**2 * state.pressure
    assert found == pytest.approx(expected, rel=1e-8, abs=1e-15 * scale)


@pytest.mark.parametrize("side", [1e-6, 1e-2, 0.15])
def test_alike_halves_by_a_sum_over_the_surface(side):
    """However small the difference is beside a temperature far from that of the gas."""
    flyer, state = sphere_of(tac_bottom=None), state_at()
    for mean in (-0.8, 0.3, 6.0):
        expected = summed(flyer, state, mean, side)
        assert force(FREE, flyer, state, mean, side) == pytest.approx(expected, rel=1e-7, abs=0.0)


def test_tumbling_is_the_mean_over_all_attitudes():
    flyer, state = sphere_of(tac_top=0.5, upright="nothing"), state_at()
    points, weights = np.polynomial.legendre.leggauss(8)
    mean = sum(
        0.5 * weight * summed(flyer, state, 0.5, 0.1, point)
        for point, weight in zip(points, weights, strict=True)
    )
    assert force(FREE, flyer, state, 0.5, 0.1) == pytest.approx(mean, rel=1e-5, abs=0.0)


# --- Rohatschek ---


@pytest.mark.parametrize("pressure", [0.1, 100.0, 3000.0, 1e5])
@pytest.mark.parametrize("tac", [0.3, 1.0])
def test_rohatschek_by_its_limits_in_series(pressure, tac):
    """The interpolation is that of both limits as resistances: written from these."""
    temperature, radius, light, conductivity = 250.0, 1.5e-6, 900.0, 0.4
    eta, kappa = float(GAS.viscosity(temperature)), 1.14
    density = pressure / (GAS.specific_gas_constant * temperature)
    gradient = 0.5 * light / conductivity  # J1 I/k
    thin = np.pi / 3.0 * tac * pressure * radius**3 * gradient / temperature
    dense = 4.0 * np.pi * kappa * eta**2 * radius * gradient / (density * temperature)
    expected = 1.0 / (1.0 / thin + 1.0 / dense)
    flyer = sphere_of(radius=radius, tac_top=tac, tac_bottom=None)
    state = state_at(pressure, temperature)
    side = gradient * radius / temperature
    found = force(ROHATSCHEK, flyer, state, 0.0, side)
    assert found == pytest.approx(-expected, rel=1e-10, abs=0.0)
    unlike = sphere_of(radius=radius)
    with lf.float64():
        heat = sum(ROHATSCHEK.heat_loss(unlike, state, (1e-3, 1e-3)))
    # by the mean free path η = ρ c̄ λ/2 of the paper's day
    path = 2.0 * eta / (density * np.sqrt(8.0 * GAS.specific_gas_constant * temperature / np.pi))
    speed = 2.0 * eta / (density * path)
    turn = np.sqrt(3.0 * np.pi * kappa) * speed**2 * density * path / (4.0 * radius)
    ratio = float(GAS.heat_capacity_ratio_at(temperature))
    most = (ratio - 1.0) / (ratio + 1.0) * (0.1 / 0.85) * heat / (2.0 * speed)
    found = force(ROHATSCHEK, unlike, state, 1e-3, 0.0)
    assert found == pytest.approx(most / (1.0 + (pressure / turn) ** 2), rel=1e-10, abs=0.0)


def test_amplitude_is_the_closed_form():
    """A = J₁ I a/(k + h a), of gas in between and radiation."""
    for pressure in (1.0, 1e3, 1e5):
        flyer = sphere_of(radius=2e-5, upright="nothing", conductivity=0.05, tac_bottom=0.8)
        state = state_at(pressure, irradiance=2000.0)
        found = lf.equilibrium(flyer, state, ROHATSCHEK)
        mean = 0.5 * sum(found.unknowns)
        film, warm = 220.0 * (1.0 + 0.5 * mean), 220.0 * (1.0 + mean)
        speed = np.sqrt(8.0 * GAS.specific_gas_constant * 220.0 / np.pi)
        ratio = float(GAS.heat_capacity_ratio_at(film))
        thin = 0.125 * (ratio + 1.0) / (ratio - 1.0) * speed * pressure / 220.0
        dense = 2.0 * float(GAS.conductivity(film)) / 2e-5
        y = thin / dense
        jump = 8.0 / 15.0 * 1.95 / np.sqrt(np.pi)
        share = (1.0 + 1.4 * jump * y) / (1.0 + 1.4 * y)
        h = 1.0 / (1.0 / dense + (1.0 / 0.8 - 1.0 + share) / thin) + 4.0 * 0.3 * SIGMA * warm**3
        amplitude = 0.4 * 2000.0 * 2e-5 / (0.05 + h * 2e-5)
        difference = found.temperatures[0] - found.temperatures[1]
        assert 0.5 * difference == pytest.approx(amplitude, rel=1e-9, abs=0.0)
        with lf.float64():
            own = ROHATSCHEK.own_results(flyer, state, found.unknowns)
        assert float(own["side_difference"]) == pytest.approx(2.0 * amplitude, rel=1e-9, abs=0.0)


# --- between both limits ---


@pytest.mark.parametrize("mean", [-0.5, 1e-3, 2.0])
def test_kinetic_force_of_free_molecules(mean):
    """In thin gas it is that of free molecules, however hot the sphere."""
    flyer, thin = sphere_of(tac_top=0.5), state_at(1e-6)
    for side in (0.0, 1e-3):
        expected = summed(flyer, thin, mean, side)
        assert force(KINETIC, flyer, thin, mean, side) == pytest.approx(expected, rel=1e-6, abs=0.0)


def test_kinetic_force_of_dense_gas():
    """Thermal creep: F = 4π κ η² A/(ρ T), where the jump of the temperature is left behind."""
    flyer = sphere_of(radius=100.0, tac_top=0.6, tac_bottom=None)
    state = lf.environment.EnvironmentState(1e6, 220.0, 1e-6, GAS, lf.environment.Radiation())
    density = 1e6 / (GAS.specific_gas_constant * 220.0)
    creep = 4.0 * np.pi * 1.14 * float(GAS.viscosity(220.0)) ** 2 / density
    assert force(KINETIC, flyer, state, 0.0, 1e-9) == pytest.approx(
        -creep * 1e-9, rel=1e-6, abs=0.0
    )


def test_kinetic_force_is_that_of_the_kinetic_equation():
    """Shakhov's equation solved around a sphere: studies/sphere_force."""
    for delta, found in SOLVED.items():
        share = float(spheres.transition_share(float(delta)))
        assert share == pytest.approx(
            found["force"], rel=0.05 if float(delta) > 4.0 else 0.03, abs=0.0
        )
        # the harmonic's heat, of a monatomic gas at complete accommodation
        dense = 2.0 * 15.0 / 8.0 * np.sqrt(np.pi) / float(delta)
        heat = float(lf.force.convection.joined_conductance(1.0, dense, 1.0))
        assert heat == pytest.approx(found["heat"], rel=0.03, abs=0.0)


def test_the_gas_sees_what_leaves_the_wall():
    """Partial accommodation in series with the gas: the temperature of what leaves, by iteration.

    A wall of TAC α at T is one of α = 1 at the temperature T_e of what leaves it, where
    α (T − T_in) = T_e − T_in and the heat is that of a wall at T_e.
    """
    pressure, side = 3000.0, 1e-7
    state = state_at(pressure)
    whole, part = sphere_of(tac_top=1.0, tac_bottom=None), sphere_of(tac_top=0.3, tac_bottom=None)
    with lf.float64():
        free = (FREE.heat_loss(whole, state, (side, -side))[0]) / side
        lost = (KINETIC.heat_loss(whole, state, (side, -side))[0]) / side
        partly = (KINETIC.heat_loss(part, state, (side, -side))[0]) / side
    leaving = 0.0
    for _ in range(200):
        arriving = leaving - lost / free * leaving  # heat is what leaves less what arrives
        leaving = 0.3 + 0.7 * arriving
    assert partly == pytest.approx(lost * leaving, rel=1e-9, abs=0.0)
    ratio = force(KINETIC, part, state, 0.0, side) / force(KINETIC, whole, state, 0.0, side)
    assert ratio == pytest.approx(leaving, rel=1e-6, abs=0.0)


def test_unlike_halves_are_a_first_harmonic_of_what_leaves():
    """In linear theory a step of the temperature pushes as its first harmonic, 3/4 of the step."""
    state, small, step = state_at(3000.0), 1e-7, 1e-4
    flyer = sphere_of(tac_top=0.6 - step / 2, tac_bottom=0.6 + step / 2)
    alike = sphere_of(tac_top=1.0, tac_bottom=None)
    with lf.float64():
        heat = 2.0 * KINETIC.heat_loss(flyer, state, (small, small))[0]
        free = 2.0 * FREE.heat_loss(alike, state, (small, small))[0] / small
        lost = KINETIC.heat_loss(alike, state, (small, -small))[0] * 4.0 / small
    # (1/α - 1) of the heat separates wall and what leaves, and what leaves is cooled itself
    harmonic = 0.75 * step * heat / free / 0.36 / (1.0 + lost / free * (1.0 / 0.6 - 1.0))
    pushed = force(KINETIC, alike, state, 0.0, harmonic)
    assert force(KINETIC, flyer, state, small, 0.0) == pytest.approx(-pushed, rel=1e-5, abs=0.0)


# --- heat and drag ---


def test_heat_in_both_limits():
    """Free molecules take ᾱ p c̄ A (γ+1)/(8(γ−1)) θ, dense gas 4π k a ΔT."""
    flyer, state = sphere_of(), state_at(1e-6)
    speed = np.sqrt(8.0 * GAS.specific_gas_constant * 220.0 / np.pi)
    ratio, excess = float(GAS.heat_capacity_ratio_at(220.0 * 1.1)), 0.2
    area = 4.0 * np.pi * 4e-12
    # convection, and the jump of the temperature, hardly count in what is large, and still
    large = sphere_of(radius=0.1)
    still = lf.environment.EnvironmentState(1e7, 220.0, 1e-6, GAS, lf.environment.Radiation())
    with lf.float64():
        thin = sum(ROHATSCHEK.heat_loss(flyer, state, (excess, excess)))
        dense = sum(ROHATSCHEK.heat_loss(large, still, (1e-36, 1e-36)))
        uneven = ROHATSCHEK.heat_loss(large, still, (1e-36, -1e-36))
    expected = 0.125 * (ratio + 1.0) / (ratio - 1.0) * speed * area * 0.85 * 1e-6 * excess
    assert thin == pytest.approx(expected, rel=1e-6, abs=0.0)
    conducted = 4.0 * np.pi * float(GAS.conductivity(220.0)) * 0.1 * 220.0 * 1e-36
    assert dense == pytest.approx(conducted, rel=1e-6, abs=0.0)
    # the first harmonic falls off as 1/r², and loses 2 k A/a per area
    assert uneven[0] == pytest.approx(0.5 * conducted, rel=1e-6, abs=0.0)
    assert uneven[1] == pytest.approx(-uneven[0], rel=1e-12, abs=0.0)


@pytest.mark.parametrize(("pressure", "temperature"), [(101325.0, 288.15), (5475.0, 216.65)])
def test_sinking_in_air_by_cunninghams_law(pressure, temperature):
    """Of solid spheres by Allen and Raabe (1985): C = 1 + Kn (1.142 + 0.558 exp(-0.999/Kn))."""
    flyer = sphere_of(radius=1.2e-6, tac_top=1.0, tac_bottom=None)
    state = state_at(pressure, temperature)
    speed = float(lf.statics.sinking_speed(flyer, state))
    path = float(lf.gas.mean_free_path(state.pressure, state.temperature, GAS))
    kn = path / flyer.radius
    slip = 1.0 + kn * (1.142 + 0.558 * np.exp(-0.999 / kn))
    drag = 6.0 * np.pi * float(GAS.viscosity(state.temperature)) * flyer.radius / slip
    weight = float(lf.statics.weight(flyer, state))
    assert speed == pytest.approx(weight / drag, rel=0.03, abs=0.0)


# --- through the package ---

POINT = np.array([2e-6, 0.8, 0.3, 0.4, 0.8, 0.9, 1500.0, 0.2, 1e-7, 300.0, 222.0, 1300.0, 0.3])


def build(x):
    (radius, absorbed, emittance, conductivity, top, bottom, density, asymmetry, offset,
     pressure, temperature, light, error) = x  # fmt: skip
    flyer = lf.Sphere(
        radius, absorbed, emittance, conductivity, top, bottom, density, asymmetry=asymmetry,
        upright="gravity", mass_offset=offset,
    )  # fmt: skip
    around = {"infrared_above": 10.0, "infrared_below": 240.0, "ground_view": 0.99}
    state = state_at(
        pressure, temperature, irradiance=light, zenith_angle=0.3, albedo=0.2, **around
    )
    return flyer, state, error


def outcomes(x):
    """Through the balance of one model, and force and heat of the others at its temperatures."""
    flyer, state, error = build(x)
    model = lf.KineticSphere(error)
    balance = lf.equilibrium(flyer, state, model)
    found = [lf.lift(flyer, state, model) * 1e15, *balance.temperatures]
    for other in (lf.Rohatschek1995(error), FREE):
        pushed = other.force(flyer, state, balance.unknowns)
        lost = other.heat_loss(flyer, state, balance.unknowns)
        found += [1e15 * pushed, *(1e9 * power for power in lost)]
    return jnp.stack(found)


def test_derivatives_jit_and_vmap(require_derivatives):
    require_derivatives(outcomes, POINT, 1e-5, 1e-5)


@pytest.mark.parametrize("model", MODELS, ids=lambda model: type(model).__name__)
def test_levitation_is_where_the_lift_is_the_weight(model):
    flyer, state = sphere_of(radius=1e-6, tac_top=0.7), state_at(300.0, irradiance=1300.0)
    found = lf.levitate(flyer, state, model)
    lit = tree.replace_at(lambda state: state.radiation.irradiance, state, found.irradiance)
    assert found.levitates
    assert lf.lift(flyer, lit, model) == pytest.approx(
        lf.statics.weight(flyer, lit), rel=1e-9, abs=0.0
    )
    # the same from below carries a sphere of alike halves
    below = state_at(300.0, irradiance=1.0, zenith_angle=np.pi)
    alike = sphere_of(radius=1e-6, tac_bottom=None, conductivity=0.05)
    carried = lf.levitate(alike, below, model)
    assert carried.levitates
    assert not lf.levitate(alike, state, model).levitates
    lit = tree.replace_at(lambda state: state.radiation.irradiance, below, carried.irradiance)
    assert lf.lift(alike, lit, model) == pytest.approx(
        lf.statics.weight(alike, lit), rel=1e-9, abs=0.0
    )


def test_downward_force_where_the_air_is_warmer_than_the_particle():
    """Keith (2010), figure 2: it changes its sign about the stratopause, as heat flows backwards.

    A sphere that reflects sunlight and radiates is colder there than the air of the US Standard
    Atmosphere: the force of unlike halves vanishes just where radiation alone makes it as warm.
    """
    flyer = sphere_of(
        radius=5e-7, absorption_efficiency=0.1, emittance=0.8, asymmetry=0.0,
        infrared_asymmetry=0.0, tac_top=0.8, tac_bottom=0.95,
    )  # fmt: skip
    sun = lf.environment.sunlight(infrared_below=SIGMA * 255.0**4)  # of the figure
    earth = lf.Earth(radiation=sun)
    altitudes = np.linspace(30e3, 75e3, 901)
    state = earth.state(altitudes)
    lift = lf.lift(flyer, state, KINETIC)
    changes = altitudes[:-1][np.diff(np.sign(lift)) != 0.0]
    assert changes.size == 2
    assert np.all(lift[(altitudes > changes[0] + 100.0) & (altitudes < changes[1])] < 0.0)
    # sunlight, half of that reflected below, and heat of half of the directions
    view = 0.5 * (1.0 - np.sqrt(1.0 - (6371.0 / (6371.0 + changes / 1e3)) ** 2))
    light = 1361.0 * (0.25 + 0.29 * view) * 0.1 / 0.8 + view * SIGMA * 255.0**4
    balanced = (light / SIGMA) ** 0.25
    np.testing.assert_allclose(earth.state(changes).temperature, balanced, rtol=2e-3)


def test_focused_light_draws_a_sphere_towards_it():
    state = state_at(300.0, irradiance=1300.0)
    away, towards = (
        lf.lift(sphere_of(tac_bottom=None, asymmetry=one), state, ROHATSCHEK) for one in (0.1, -0.1)
    )
    assert away < 0.0 < towards


def test_the_side_follows_the_light_and_halves_need_a_hold():
    state = state_at(300.0, irradiance=1300.0)
    held, tumbling, alike = (
        lf.lift(flyer, state, ROHATSCHEK)
        for flyer in (
            sphere_of(),
            sphere_of(upright="nothing"),
            sphere_of(tac_top=0.85, tac_bottom=0.85),
        )
    )
    assert held > 0.0
    assert tumbling == pytest.approx(alike, rel=1e-9, abs=0.0)


@pytest.mark.parametrize(("model", "error"), [(ROHATSCHEK, 0.3), (KINETIC, 0.1)])
def test_error_of_the_force(model, error):
    flyer, state = sphere_of(), state_at(300.0)
    once = force(type(model)(1.0), flyer, state, 0.1, 0.01)
    assert once / force(model, flyer, state, 0.1, 0.01) == pytest.approx(
        np.exp(error), rel=1e-9, abs=0.0
    )


def test_what_is_outside_the_models_range():
    state = state_at(300.0)
    assert ROHATSCHEK.diagnostics(sphere_of(), state, 240.0) == ()
    (hot,) = ROHATSCHEK.diagnostics(sphere_of(), state, 400.0)
    assert hot.startswith("T_h/T_c is 1.82 at 300 Pa, above 1.2: rohatschek1995 is for a sphere")
    assert KINETIC.diagnostics(sphere_of(), state, 400.0) == ()
    (hot,) = KINETIC.diagnostics(sphere_of(), state, 500.0)
    assert hot.startswith("T_h/T_c is 2.27 at 300 Pa, above 2: what collisions leave of the force")
    (dense,) = FREE.diagnostics(sphere_of(radius=1e-4), state, 240.0)
    assert dense.startswith("the Knudsen number is")
    with pytest.raises(lf.ParameterError, match="Rohatschek1995 is not for Disk"):
        lf.Rohatschek1995.require_flyer(lf.Disk)
