"""Force and heat of hollow bodies: published numbers, limits, and the equations in NumPy."""

import re

import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid, trapezoid
from scipy.optimize import brentq, fsolve

import lightflyer as lf
from lightflyer.array import tree
from lightflyer.environment import EnvironmentState, Lu2023Atmosphere, Radiation
from lightflyer.force.convection import sphere_conductance
from lightflyer.force.laws.channels import SLOT, channel_coefficients, direct_share
from lightflyer.force.pumps import celenza2023_laws as published
from lightflyer.force.pumps.hollow_flow import Corrections, Errors, PumpFlow, pump_flow
from lightflyer.gas.molecules import slot_transmission
from lightflyer.statics.equations import FlightEquations

MODEL = lf.HollowPump()
SIGMA = 5.670374419e-8
OFF = dict.fromkeys(Corrections._fields, False)


def make(form="sphere", size=0.1, outlet_radius=0.03, **changed):
    outer = lf.FilmProperties(5e-4, 0.0, 0.8, 0.1, 0.9, 0.8, transmittance=1.0)
    inner = lf.FilmProperties(5e-4, 0.9, 0.15, 0.08, 0.7, 0.9)
    numbers = {
        "open_fraction": 0.5, "channel_width": 4e-4, "wall_thickness": 2e-4,
        "sheet_thickness": 5e-8, "sheet_conductivity": published.SHEET_CONDUCTIVITY,
        "sheet_density": published.SHEET_DENSITY,
    }  # fmt: skip
    return lf.HollowBody(
        outer, inner, size=size, outlet_radius=outlet_radius, form=form, **(numbers | changed)
    )


def published_state(altitude_km):
    """The published surroundings: the paper's polynomial with other constants, and its light."""
    atmosphere = Lu2023Atmosphere()
    ratio = (9.81 / 287.0) / (9.8 / 287.05)
    pressure = 101300.0 * (atmosphere.pressure(altitude_km * 1e3) / 101325.0) ** ratio
    light = Radiation(1000.0 + 3.8 * altitude_km)
    temperature = atmosphere.temperature(altitude_km * 1e3)
    return EnvironmentState(pressure, temperature, 9.8, lf.gas.AIR, light)


def state_at(pressure, temperature=220.0, **radiation):
    return EnvironmentState(pressure, temperature, 9.7, lf.gas.AIR, Radiation(**radiation))


def settled(body, state, model):
    """Temperatures in balance by SciPy, and the force."""
    with lf.float64():
        equations = FlightEquations(body, state, model)
        powers = np.asarray(equations.powers(state.radiation.irradiance))

        def imbalance(unknowns):
            lost = np.asarray(equations.losses(tuple(unknowns)))
            return (lost - powers) / np.abs(powers).max()

        unknowns = fsolve(imbalance, fsolve(imbalance, [0.1, 0.0]), xtol=1e-13)
        assert np.max(np.abs(imbalance(unknowns))) < 1e-9
        temperatures = state.temperature * (1.0 + unknowns)
        return temperatures, float(model.force(body, state, tuple(unknowns)))


@pytest.mark.parametrize(
    ("altitude", "force", "difference"), [(70.0, 4.244468e-5, None), (55.0, 1.06838e-4, 1.303)]
)
def test_published_force_of_a_cone(altitude, force, difference):
    cone = make("cone", 0.1, 0.0202, channel_width=263e-6, wall_thickness=2.121e-6)
    (inner, outer), lifted = settled(cone, published_state(altitude), lf.Celenza2023())
    assert lifted == pytest.approx(force, rel=1e-5)
    if difference is not None:
        assert inner - outer == pytest.approx(difference, abs=0.0005)
    assert outer == pytest.approx(published_state(altitude).temperature, rel=1e-9)


@pytest.mark.parametrize(
    ("form", "outlet_radius", "mass"),
    [("rocket", 4.972650, 1.009), ("cone", 4.972650, 0.770), ("sphere", 3.683375, 0.534)],
)
def test_published_masses_at_80_km(form, outlet_radius, mass):
    """At the point of the published grid that carries most, with channels not wider than long."""
    body = make(
        form, 10.0, outlet_radius, channel_width=1.1634590884e-3, wall_thickness=1.176811952e-3
    )
    _, force = settled(body, published_state(80.0), lf.Celenza2023())
    with lf.float64():
        assert force / 9.8 - float(body.own_mass) == pytest.approx(mass, abs=0.0005)


def test_without_corrections_it_is_the_published_model():
    body, state = make("rocket"), state_at(3.0, irradiance=1200.0, zenith_angle=0.4, albedo=0.3)
    with lf.float64():
        for unknowns in ((0.4, 0.1), (-0.1, 0.2)):
            for ask in ("heat_loss", "force"):
                found, expected = (
                    getattr(model, ask)(body, state, unknowns)
                    for model in (lf.HollowPump(**OFF), lf.Celenza2023())
                )
                np.testing.assert_allclose(found, expected, rtol=1e-14)


@pytest.mark.parametrize("name", OFF)
def test_each_correction_does_something(name):
    """Alone, and to a body in which all of them matter."""
    dense = name == "buoyant_flow"
    body, state = make(wall_thickness=4e-4), published_state(10.0 if dense else 75.0)
    plain, corrected = lf.HollowPump(**OFF), lf.HollowPump(**(OFF | {name: True}))
    with lf.float64():
        answers = [
            [model.force(body, state, (0.5, 0.1)), model.heat_loss(body, state, (0.5, 0.1))[0]]
            for model in (plain, corrected)
        ]
    assert np.max(np.abs(np.array(answers[1]) / answers[0] - 1.0)) > 1e-3


@pytest.mark.parametrize("unknowns", [(0.4, 0.4), (0.6, 0.1), (0.0, 0.3)])
@pytest.mark.parametrize("form", ["cone", "sphere", "rocket"])
def test_limit_of_free_molecules(form, unknowns):
    body, pressure = make(form), 1e-9
    with lf.float64():
        force = float(MODEL.force(body, state_at(pressure), unknowns))
        velocity = float(pump_flow(body, state_at(pressure), unknowns, Corrections()).jet_velocity)
    inner, outer = np.sqrt(1.0 + np.array(unknowns))
    expected = 0.5 * pressure * np.pi * 0.03**2 * 0.5 * (inner - outer)
    assert force == pytest.approx(expected, rel=1e-6, abs=1e-20)
    assert abs(velocity) < 1e-4  # of some 300 m/s


def pressure_of_slow_flow(body):
    """Pressure within over viscosity and velocity at the outlet, as the wall pumps more [1/m]."""
    state, corrections = state_at(1e6, 300.0), Corrections(buoyant_flow=False)
    with lf.float64():
        little, more = (
            pump_flow(body, state, (1e-9, 0.0), corrections, Errors(wall=wall))
            for wall in (1.0, 3.0)
        )
        viscosity = float(lf.gas.AIR.viscosity(300.0))
        velocity = float(more.jet_velocity - little.jet_velocity)
        assert velocity > 0.0
        return float(more.pressure_difference - little.pressure_difference) / viscosity / velocity


def test_slow_flow_through_the_outlet():
    """Sampson's law: v = Δp r/(3πμ)."""
    body = make(outlet_radius=0.03, wall_thickness=1e-3)
    assert pressure_of_slow_flow(body) == pytest.approx(3.0 * np.pi / 0.03, rel=1e-6)


@pytest.mark.parametrize("form", ["cone", "rocket"])
def test_friction_within_a_narrow_body(form):
    """Poiseuille's law along the body, into which gas comes everywhere, by SciPy."""
    size, outlet = 0.1, 0.01
    if form == "rocket":
        end, lid, radius = size + outlet, 0.0, lambda x: outlet + 0.0 * x
    else:
        end, lid, radius = size, np.pi * (0.5 * size) ** 2, lambda x: outlet + 0.4 * x
    x = np.linspace(0.0, end, 20001)
    slope = np.hypot(1.0, np.gradient(radius(x), x))
    wall = cumulative_trapezoid(2.0 * np.pi * radius(x) * slope, x, initial=0.0)
    flux = outlet**2 * (1.0 - wall / (wall[-1] + lid))  # over π and the velocity at the outlet
    rise = cumulative_trapezoid(8.0 * flux / radius(x) ** 4, x, initial=0.0)
    mean = (trapezoid(rise, wall) + lid * rise[-1]) / (wall[-1] + lid)
    sampson = 3.0 * np.pi / outlet
    found = pressure_of_slow_flow(make(form, size, outlet, wall_thickness=1e-3))
    assert found == pytest.approx(sampson + mean, rel=1e-4)
    assert mean > 0.4 * sampson


def test_warm_gas_leaves_above_and_cold_gas_comes_in_below():
    """The flow through each zone of a sphere's wall, by the pressure at its height."""
    body = make(size=10.0, outlet_radius=2.0, wall_thickness=4e-4)
    state = state_at(np.array([100.0, 5000.0]))
    unknowns = (0.4, 0.35)
    with lf.float64():
        flow, still = (
            PumpFlow(*map(np.asarray, pump_flow(body, state, unknowns, corrections)))
            for corrections in (Corrections(), Corrections(buoyant_flow=False))
        )
        surface, outlet = float(body.surface), float(body.outlet_area)
        density = np.asarray(state.gas.density(state.pressure, 220.0))
        heat = float(lf.gas.AIR.heat_capacity(220.0)) * 220.0
        taken = [np.asarray(sum(MODEL.heat_loss(body, state, unknowns)))]
        closed = lf.HollowPump(buoyant_flow=False)
        taken.append(np.asarray(sum(closed.heat_loss(body, state, unknowns))))
    inward = density * np.asarray(flow.wall_velocity)
    # the wall's conductance, from how its flow fell with the pressure
    fallen = density * np.asarray(still.wall_velocity) - inward
    conductance = fallen / np.asarray(flow.pressure_difference - still.pressure_difference)
    low = -np.sqrt(25.0 - 4.0)
    z = np.linspace(low, 5.0, 20001)  # zones of a sphere have areas as their heights
    lifted = density * 9.7 * 0.4 / 1.4 * (z[:, None] - 0.5 * (low + 5.0))
    through = inward - conductance * lifted
    assert np.all(through[0] > 0.0)
    assert through[-1, 0] > 0.0 > through[-1, 1]
    assert flow.exchange[0] == 0.0
    leaving = surface * np.mean(np.maximum(-through, 0.0), axis=0)
    net = np.maximum(-surface * inward, 0.0)
    np.testing.assert_allclose(flow.exchange, leaving - net, rtol=1e-3)
    # the outlet is lower than the middle of the wall, where the pressure within is less
    half = density * 9.7 * 0.4 / 1.4 * 0.5 * (5.0 - low)
    there = np.asarray(flow.pressure_difference) - half
    assert np.all(np.sign(there) == np.sign(flow.jet_velocity))
    assert np.all(there < still.pressure_difference)
    # what leaves is as warm as the outer film; the outlet's own heat changes with its flow
    carried = heat * 0.35 * np.asarray(flow.exchange)
    by_outlet = (
        heat * 0.4 * outlet * np.abs([f.jet_density * f.jet_velocity for f in (flow, still)])
    )
    np.testing.assert_allclose(
        taken[0] - taken[1], carried + by_outlet[0] - by_outlet[1], rtol=0.02
    )


@pytest.mark.parametrize(
    ("name", "scatter", "lowest", "highest"),
    [
        ("wall", 0.10, 1.1, 1.3),
        ("outlet", 0.25, 0.75, 0.98),
        ("force", 0.15, 1.13, 1.162),
        ("heat", 0.10, 1.01, 1.2),
    ],
)
def test_own_errors_of_the_model(name, scatter, lowest, highest):
    """One standard error changes what it is of, and nothing that it is not of."""
    body, unknowns, off = make(), (0.5, 0.1), lf.HollowPump(**{f"{name}_error": 1.0})

    def growth(ask, pressure):
        values = (getattr(model, ask)(body, state_at(pressure), unknowns) for model in (off, MODEL))
        with lf.float64():
            return float(np.divide(*(np.sum(value) for value in values)))

    assert growth("force", 1e-9) == pytest.approx(1.0, rel=1e-6)  # free molecules are exact
    if name == "heat":
        assert growth("force", 30.0) == 1.0
    assert lowest < growth("heat_loss" if name == "heat" else "force", 30.0) < highest
    assert lf.force.pumps.celenza2023._SCATTER._asdict()[name] == scatter


def test_published_force_has_no_buoyancy():
    body, state, unknowns = make(size=1.0), published_state(30.0), (0.3, 0.0)
    with lf.float64():
        warm = float(body.buoyancy(state, unknowns))
        for model, added in ((lf.Celenza2023(), 0.0), (MODEL, warm)):
            force = float(model.force(body, state, unknowns))
            assert warm > 0.1 * force
            equations = FlightEquations(body, state, model)
            up = float(equations.upward_force(unknowns))
            assert up == pytest.approx(force + added, rel=1e-12)
            assert float(equations.buoyancy(unknowns)) == added


@pytest.mark.parametrize("model", [MODEL, lf.Celenza2023()])
def test_no_force_in_an_isothermal_world(model):
    state = state_at(np.array([1e-3, 1.0, 100.0]), irradiance=0.0)
    body = make()
    with lf.float64():
        equations = FlightEquations(body, state, model)
        assert not np.any(equations.powers(0.0))
        assert not np.any(equations.losses((0.0, 0.0)))
        assert not np.any(model.force(body, state, (0.0, 0.0)))


def test_walls_as_warm_as_each_other_hardly_pump():
    """Only what the gas at the outer one is colder than it, less and less in dense gas."""
    state, shares = state_at(np.array([10.0, 100.0, 1000.0, 1e4])), []
    with lf.float64():
        for outer in (0.3, 0.0):
            still = Corrections(buoyant_flow=False)
            flow = pump_flow(make(size=10.0), state, (0.3, outer), still)
            shares.append(np.asarray(flow.jet_velocity))
    assert np.all(np.abs(shares[0]) < [0.01, 0.002, 0.001, 0.001] * shares[1])


def by_hand(body, pressure, temperature, irradiance):
    """Temperatures and force of a sphere by SciPy, for its films, with exact view factors."""
    air, phi, solid = lf.gas.AIR, 0.5, 0.5
    radius, r, width, thick = 0.05, 0.03, 4e-4, 2e-4
    wall = 4.0 * np.pi * radius**2 - 2.0 * np.pi * radius * (radius - np.sqrt(radius**2 - r**2))
    outlet, length = np.pi * r**2, thick / width
    height = radius + np.sqrt(radius**2 - r**2)
    constant, ratio = air.specific_gas_constant, air.heat_capacity_ratio
    sheet = phi * ((1.0 + 1e-7 / width) * (1.0 + 1e-8 / width) - 1.0)
    free = 0.125 * (ratio + 1.0) / (ratio - 1.0) * pressure
    free *= float(air.mean_speed(temperature))  # [W/m²] per relative excess
    facing = 1.0 / (1.0 / 0.8 + 1.0 / 0.7 - 1.0)  # TACs of the faces within the wall
    through = float(slot_transmission(length).through)
    closed_through = 1.0 / (1.0 / facing + 1.0 / through - 1.0)  # cells as wide as the channels
    path = float(lf.gas.mean_free_path(pressure, temperature, air))
    passing = phi * float(direct_share(SLOT, length)) / (1.0 + thick / path)
    sphere = np.sqrt(wall / (4.0 * np.pi))
    around_dense = 4.0 * np.pi * sphere * float(air.conductivity(temperature)) * temperature
    near = free * wall / (free * wall + around_dense)
    density = pressure / (constant * temperature)

    def flow(inner, outer):
        mean, hot = 0.5 * (inner + outer), inner
        speed = np.sqrt(2.0 * constant * mean)
        delta = pressure * width / (float(air.viscosity(mean)) * speed)
        poiseuille, creep = map(float, channel_coefficients(SLOT, delta, length)[:2])
        entrances = np.sqrt(np.pi) * solid / (1.0 + np.pi**1.5 / 16.0 * delta)
        conductance = phi / speed / (length / poiseuille + entrances)  # [kg/(m² s Pa)]
        theta_i, theta_o = inner / temperature - 1.0, outer / temperature - 1.0
        gas_outside = near * ((1.0 - passing) * theta_o + passing * theta_i)
        warm = np.log((1.0 + theta_i) / (1.0 + gas_outside))
        stopping = 2.0 * pressure * np.sinh(0.5 * creep / poiseuille * warm)
        jet = pressure / (constant * hot)
        speed_hot = np.sqrt(2.0 * constant * hot)
        delta_hot = pressure * r / (float(air.viscosity(hot)) * speed_hot)
        kappa = 2.0 / (3.0 * np.sqrt(np.pi))
        resistance = np.sqrt(np.pi) * jet * speed_hot / (1.0 + kappa * delta_hot)
        held = 2.0 * pressure * np.sinh(0.5 * exponent * np.log(hot / temperature))
        area_ratio = outlet / wall

        def imbalance(velocity):
            difference = 0.5 * jet * velocity**2 * (1.0 - area_ratio**2) + resistance * velocity
            pumped = conductance * (stopping - held - lifted - difference) * wall
            return pumped - jet * velocity * outlet

        lifted = 0.5 * density * 9.7 * theta_i / (1.0 + theta_i) * height / (1.0 + path / height)
        velocity = brentq(imbalance, 0.0, 1e4, xtol=1e-14, rtol=1e-14)
        mean, most = jet * velocity * outlet / wall, conductance * lifted
        exchange = wall * (most - mean) ** 2 / (4.0 * most) if most > mean else 0.0
        return velocity, jet, exchange

    from lightflyer.force.laws.channels import ROUND, thermomolecular_exponent

    cold_speed = np.sqrt(2.0 * constant * temperature)
    cold_viscosity = float(air.viscosity(temperature))
    delta_cold = pressure * r / (cold_viscosity * cold_speed)
    exponent = float(thermomolecular_exponent(ROUND, delta_cold, 1e-9))

    def radiation(inner, outer):
        """Net losses per area: wall of two grey plates with channels around a diffuse body."""
        black = SIGMA * temperature**4
        hot, warm = SIGMA * inner**4, SIGMA * outer**4
        exchanged = solid * (hot - warm) / (1.0 / 0.1 + 1.0 / 0.15 - 1.0)
        # within: radiosity of the inner film, from channels and outlet comes that of the gas
        seen = (solid * 0.08 * hot + (phi + outlet / wall) * black) / (
            1.0 - solid * 0.92 + outlet / wall
        )
        return (
            solid * 0.08 * (hot - seen) + exchanged,
            solid * 0.8 * (warm - black) - exchanged,
        )

    def imbalance(temperatures):
        inner, outer = temperatures
        theta_i, theta_o = inner / temperature - 1.0, outer / temperature - 1.0
        mean = 0.5 * (inner + outer)
        conducted = float(air.conductivity(mean)) * temperature / thick

        def gap(share, tac):
            return share / (1.0 / (free * tac) + 1.0 / conducted)

        closed = gap(solid - sheet, closed_through) + sheet * 1.8 / thick * temperature
        open_ = gap(phi, through)
        velocity, jet, exchange = flow(inner, outer)
        exchange *= float(air.heat_capacity(temperature)) * temperature
        still = 1.0 / (
            1.0 / (free * outlet)
            + 1.0 / (4.0 * r * float(air.conductivity(temperature)) * temperature)
        )
        moved = jet * velocity * outlet * float(air.heat_capacity(temperature)) * temperature
        left = moved * theta_i / (1.0 - np.exp(-moved / still))
        around = sphere_conductance(
            theta_o, radius=sphere, tac=0.9 * solid, pressure=pressure, temperature=temperature,
            gravity=9.7, gas=air,
        )  # fmt: skip
        own_i, own_o = radiation(inner, outer)
        # light: through the outer film and the channels, the rest is reflected
        within = phi * np.pi * radius**2 / (wall * (1.0 - solid * 0.1) + outlet)
        light = irradiance * solid * 0.9 * (np.pi * radius**2 + within * wall)
        between = closed * (theta_i - theta_o)
        through_channels = open_ * (theta_i - near * theta_o)
        return [
            wall * (own_i + between + through_channels)
            + left
            - light
            + exchange * (theta_i - theta_o),
            wall * (own_o - between - near * through_channels)
            + float(around) * theta_o
            + exchange * (2.0 * theta_o - theta_i),
        ]

    (inner, outer), _, flag, _ = fsolve(imbalance, [350.0, 300.0], xtol=1e-13, full_output=True)
    assert flag == 1
    velocity, jet, _ = flow(inner, outer)
    delta_size = pressure * radius / (cold_viscosity * cold_speed)
    drag = 1.30 * 8.0 * 0.1 * cold_viscosity * jet * velocity * outlet / (wall * density)
    force = drag / (1.0 + 1.264 / delta_size) + 0.89 * jet * outlet * velocity**2
    force += (
        exponent
        * pressure
        * outlet
        * solid
        * (np.sqrt(inner / temperature) - np.sqrt(outer / temperature))
    )
    return (inner, outer), velocity, force


PRESSURES = np.array([0.3, 3.0, 60.0])


@pytest.fixture(scope="module")
def in_balance():
    """The body at all pressures, by the package."""
    state = state_at(PRESSURES, 230.0, irradiance=1200.0)
    return state, lf.equilibrium(make(), state, MODEL)


@pytest.mark.parametrize("index", range(3))
def test_balance_flow_and_force_against_the_equations_in_numpy(in_balance, index):
    body, (state, found) = make(), in_balance
    with lf.float64():
        temperatures, velocity, force = by_hand(body, PRESSURES[index], 230.0, 1200.0)
        own = MODEL.own_results(body, state, found.unknowns)
        lifted = np.asarray(MODEL.force(body, state, found.unknowns))
        warm = np.asarray(body.buoyancy(state, found.unknowns))
        volume = float(body.volume)
    np.testing.assert_allclose(
        [there[index] for there in found.temperatures], temperatures, rtol=1e-9
    )
    assert float(own["jet_velocity"][index]) == pytest.approx(velocity, rel=1e-8)
    assert lifted[index] == pytest.approx(force, rel=1e-8)
    density = PRESSURES[index] / (lf.gas.AIR.specific_gas_constant * 230.0)
    expected = density * 9.7 * volume * (1.0 - 230.0 / temperatures[0])
    assert warm[index] == pytest.approx(expected, rel=1e-8)


def test_a_dark_outside_pumps_outward():
    """Gas comes in at the outlet then: it pushes down, and leaves no jet."""
    body = make()
    dark = tree.replace_at(
        lambda body: (body.outer.absorptance, body.outer.transmittance), body, (0.9, 0.0)
    )
    # cold within, which a cold ground would see to
    state = state_at(1.0, irradiance=1200.0)
    with lf.float64():
        flow = pump_flow(dark, state, (0.0, 0.4), Corrections())
        thick = state_at(30.0)
        denser = pump_flow(dark, thick, (0.0, 0.4), Corrections())
        force = float(MODEL.force(dark, thick, (0.0, 0.4)))
    assert float(flow.jet_velocity) < 0.0
    assert float(denser.wall_velocity) < 0.0
    assert force < 0.0


POINT = np.array([0.1, 0.03, 0.5, 4e-4, 2e-4, 0.9, 0.1, 0.8, 3.0, 215.0, 1360.0])


def build(x):
    size, outlet, phi, width, thick, absorptance, emittance, tac, pressure, temperature, light = x
    outer = lf.FilmProperties(5e-4, 0.02, 0.8, emittance, 0.9, tac, transmittance=0.9)
    inner = lf.FilmProperties(5e-4, absorptance, emittance, 0.05, tac, 0.9)
    body = lf.HollowBody(
        outer, inner, size, outlet, phi, width, thick, 5e-8, 1.8, "cone", payload=1e-9
    )
    return body, state_at(pressure, temperature, irradiance=light, zenith_angle=0.3, albedo=0.2)


# of a model without correlations of the gas, which are a quarter as long to compile
SHORT = lf.HollowPump(gas_properties=False)


def outcome(x):
    """Lift, in logarithms."""
    body, state = build(x)
    unknowns = lf.equilibrium(body, state, SHORT).unknowns
    return jnp.log(SHORT.force(body, state, unknowns) + body.buoyancy(state, unknowns))[None]


def answers(x, unknowns=(0.5, 0.2)):
    """Force and losses at given temperatures, of order one."""
    body, state = build(x)
    losses = FlightEquations(body, state, MODEL).losses(unknowns)
    return jnp.log(jnp.stack([MODEL.force(body, state, unknowns), losses[0]]))


@pytest.mark.parametrize("function", [outcome, answers])
def test_derivatives_jit_and_vmap(require_derivatives, function):
    require_derivatives(function, POINT, rtol=1e-5, atol=1e-7)


def test_what_is_outside_the_models_range():
    thin, dense = state_at(0.5), state_at(np.array([30.0, 100.0]))
    assert MODEL.diagnostics(make(), dense, 300.0) == ()
    (outlet,) = MODEL.diagnostics(make(), thin, 300.0)
    assert re.match(r"the mean free path over outlet_radius is \S+ at 0.5 Pa, above 0.1", outlet)
    (long,) = MODEL.diagnostics(make(wall_thickness=8e-4), dense, 300.0)
    assert "light and heat radiation" in long
    (short,) = lf.Celenza2023().diagnostics(make(), dense, 300.0)
    assert "below 1: celenza2023 takes channels that are longer than wide" in short


def test_published_model_is_for_air():
    states = {
        gas.name: EnvironmentState(3.0, 220.0, 9.7, gas, Radiation())
        for gas in (lf.gas.ARGON, lf.gas.NITROGEN)
    }
    with pytest.raises(lf.ParameterError, match="Celenza2023 is not for argon"):
        lf.lift(make(), states["argon"], lf.Celenza2023())
    for model in (lf.Celenza2023(), lf.HollowPump(gas_properties=False)):
        with pytest.raises(lf.ParameterError, match="for nitrogen: its constants are those of air"):
            lf.lift(make(), states["nitrogen"], model)
