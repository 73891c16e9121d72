import re

import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import brentq

import lightflyer as lf
from lightflyer.array import tree
from lightflyer.statics.equations import FlightEquations

SIGMA = 5.670374419e-8
MODEL = lf.BalloonConvection()
GAS = lf.gas.AIR


def state_at(pressure, temperature, **radiation):
    """Black surroundings at the gas temperature unless told otherwise; one structure for all."""
    black = SIGMA * temperature**4
    around = {"infrared_above": black, "infrared_below": black, "ground_view": 1.0}
    radiation = lf.environment.Radiation(**(around | radiation))
    return lf.environment.EnvironmentState(pressure, temperature, 9.7, GAS, radiation)


def balloon_of(**changed):
    film = lf.FilmProperties(0.012, 0.85, 0.8, 0.8, 0.9, 0.8, transmittance=0.05)
    return lf.Balloon(**({"film": film, "radius": 2.9, "payload": 1.0} | changed))


def by_hand(pressure, temperature, irradiance, radius=2.9):
    """Temperature and lift of an opaque-walled balloon, by a scalar root of plain equations."""
    surface = 4.0 * np.pi * radius**2
    # light that passes is absorbed on its next visit, 0.85 of 0.95 a visit
    absorbed = np.pi * radius**2 * irradiance * (0.85 + 0.05 * 0.85 / 0.90)

    def imbalance(warm):
        mean = 0.5 * (warm + temperature)
        viscosity, kappa = GAS.viscosity(mean), GAS.conductivity(mean)
        density = pressure / (GAS.specific_gas_constant * mean)
        prandtl = viscosity * GAS.heat_capacity(mean) / kappa
        rayleigh = 9.7 * (warm - temperature) / mean * (2 * radius) ** 3 * prandtl
        rayleigh *= (density / viscosity) ** 2
        reduced = rayleigh / (1.0 + (0.469 / prandtl) ** (9 / 16)) ** (16 / 9)
        nusselt = 2.0 + ((0.589 * reduced**0.25) ** 6 + (0.15 * reduced ** (1 / 3)) ** 6) ** (1 / 6)
        convected = nusselt * kappa / (2.0 * radius) * surface * (warm - temperature)
        return convected + 0.8 * surface * SIGMA * (warm**4 - temperature**4) - absorbed

    warm = brentq(imbalance, temperature, 600.0, xtol=1e-11)
    density = pressure / (GAS.specific_gas_constant * temperature)
    return warm, density * 4.0 / 3.0 * np.pi * radius**3 * 9.7 * (1.0 - temperature / warm)


@pytest.mark.parametrize("pressure", [101325.0, 5500.0, 100.0])
def test_balance_and_lift_of_a_solar_balloon_by_hand(pressure):
    """The textbook: sunlight against radiation and natural convection, then Archimedes."""
    state = state_at(pressure, 220.0, irradiance=1300.0)
    warm, lift = by_hand(pressure, 220.0, 1300.0)
    found = lf.equilibrium(balloon_of(), state, MODEL)
    # but for the temperature jump, which the plain equations leave out
    assert found.temperature == pytest.approx(warm, rel=1e-5)
    assert found.temperature > warm
    assert lf.lift(balloon_of(), state, MODEL) == pytest.approx(lift, rel=1e-4)
    lost = found.gas_power + found.radiated_power
    assert lost == pytest.approx(found.absorbed_power, rel=1e-10)
    assert abs(found.residual) < 1e-10


def test_free_molecules_take_their_heat():
    pressure, excess = 1e-8, 0.4
    flyer, state = balloon_of(opening_radius=0.5), state_at(pressure, 220.0)
    with lf.float64():
        (envelope,) = MODEL.heat_loss(flyer, state, (excess,))
    speed = np.sqrt(8.0 * GAS.specific_gas_constant * 220.0 / np.pi)
    area = 4.0 * np.pi * 2.9**2 - np.pi * 0.5**2
    assert envelope == pytest.approx(0.75 * 0.9 * pressure * speed * area * excess, rel=1e-6)


def test_nothing_lifts_without_a_difference_of_temperature():
    state = state_at(5500.0, 220.0, irradiance=0.0)
    assert lf.lift(balloon_of(), state, MODEL) == 0.0
    assert lf.equilibrium(balloon_of(), state, MODEL).temperatures == (220.0,)


def test_levitation_of_open_and_closed_balloons():
    state = state_at(2000.0, 225.0, irradiance=1300.0)
    for flyer in (balloon_of(), balloon_of(gas_mass=0.25, molar_mass=4.0026e-3)):
        found = lf.levitate(flyer, state, MODEL)
        assert found.levitates
        lit = tree.replace_at(lambda state: state.radiation.irradiance, state, found.irradiance)
        assert found.irradiance > 10.0
        assert lf.lift(flyer, lit, MODEL) == pytest.approx(lf.statics.weight(flyer, lit), rel=1e-9)
    helium = balloon_of(gas_mass=0.5, molar_mass=4.0026e-3)
    assert lf.levitate(helium, state, MODEL).irradiance == 0.0
    heavy = balloon_of(payload=1e4)
    assert not lf.levitate(heavy, state, MODEL).levitates


def test_cold_sky_takes_lift_from_a_helium_balloon():
    """At night it is colder than the air, and sinks where it floats by day."""
    night = {"irradiance": 0.0, "infrared_above": 0.0, "infrared_below": 150.0}
    flyer = balloon_of(gas_mass=0.45, molar_mass=4.0026e-3)
    state = state_at(5500.0, 230.0, **night)
    found = lf.equilibrium(flyer, state, MODEL)
    assert found.temperature < 230.0
    warm = lf.lift(flyer, state_at(5500.0, 230.0, irradiance=0.0), MODEL)
    assert lf.lift(flyer, state, MODEL) < warm
    # between both the light of levitation is found, below the temperature of the gas
    load = balloon_of(gas_mass=0.45, molar_mass=4.0026e-3, payload=0.0)
    mass = 0.5 * (warm + lf.lift(flyer, state, MODEL)) / 9.7 - load.own_mass
    loaded = tree.replace_at(lambda flyer: flyer.payload, load, mass)
    needed = lf.levitate(loaded, state, MODEL)
    assert needed.irradiance > 0.0
    assert needed.temperature < 230.0


POINT = np.array([2.9, 0.3, 0.012, 0.85, 0.8, 0.7, 0.1, 0.9, 5500.0, 222.0, 1300.0, 0.5])
SLACK = 0.4  # kg of helium


def build(x, closed):
    (radius, opening, density, absorptance, out, within, through, tac, pressure,
     temperature, light, error) = x  # fmt: skip
    film = lf.FilmProperties(
        density, absorptance, out, within, tac, tac, transmittance=through,
        infrared_transmittance=through,
    )  # fmt: skip
    gas = {"gas_mass": SLACK, "molar_mass": 4.0026e-3} if closed else {"opening_radius": opening}
    flyer = lf.Balloon(film, radius, payload=1.0, **gas)
    state = state_at(
        pressure, temperature, irradiance=light, zenith_angle=0.3, albedo=0.2,
        infrared_below=240.0, ground_view=0.99,
    )  # fmt: skip
    return flyer, state, lf.BalloonConvection(error)


def outcomes(x, closed):
    flyer, state, model = build(x, closed)
    balance = lf.equilibrium(flyer, state, model)
    force = FlightEquations(flyer, state, model).upward_force(balance.unknowns)
    return jnp.log(jnp.stack([force, *balance.temperatures]))


@pytest.mark.parametrize("closed", [False, True])
def test_derivatives_jit_and_vmap(require_derivatives, closed):
    require_derivatives(lambda x: outcomes(x, closed), POINT, 5e-6, 5e-8)


def test_error_of_the_law_is_fifteen_percent():
    state = state_at(1e5, 280.0, irradiance=1000.0)
    with lf.float64():
        (plain,) = MODEL.heat_loss(balloon_of(), state, (0.1,))
        (more,) = lf.BalloonConvection(1.0).heat_loss(balloon_of(), state, (0.1,))
    assert more / plain == pytest.approx(np.exp(0.15), rel=1e-3)


def test_own_results():
    """The overpressure of warm air is its height's, that of a full closed balloon its own too."""
    state = state_at(5500.0, 220.0, irradiance=1300.0)
    found = lf.equilibrium(balloon_of(), state, MODEL)
    with lf.float64():
        own = MODEL.own_results(balloon_of(), state, found.unknowns)
    lift = lf.lift(balloon_of(), state, MODEL)
    head = lift / (np.pi * 2.9**3 * 4.0 / 3.0) * 2.0 * 2.9
    assert float(own["overpressure"]) == pytest.approx(head, rel=1e-9)
    assert float(own["film_tension"]) == pytest.approx(0.5 * head * 2.9, rel=1e-9)
    assert float(own["filled_share"]) == 1.0
    tight = balloon_of(gas_mass=1.5, molar_mass=4.0026e-3)
    found = lf.equilibrium(tight, state, MODEL)
    total = 1.5 * 8.314462618 / 4.0026e-3 * found.temperature / float(tight.volume)
    with lf.float64():
        own = MODEL.own_results(tight, state, found.unknowns)
    density = 5500.0 / (GAS.specific_gas_constant * 220.0)
    head = (density - 1.5 / float(tight.volume)) * 9.7 * 5.8
    assert float(own["overpressure"]) == pytest.approx(total - 5500.0 + head, rel=1e-9)
    assert float(own["gas_inside"]) == 1.5


def test_what_is_outside_the_models_range():
    air = state_at(5500.0, 220.0)
    assert MODEL.diagnostics(balloon_of(), air, 300.0) == ()
    (large,) = MODEL.diagnostics(balloon_of(radius=30.0), air, 300.0)
    assert re.match(r"the Rayleigh number outside is \S+ at 5.5e\+03 Pa, above 1e\+12", large)
    slack = balloon_of(gas_mass=0.3, molar_mass=4.0026e-3)
    (told,) = MODEL.diagnostics(slack, state_at(np.array([3e3, 5e4]), 220.0), np.full(2, 250.0))
    assert re.match(r"the gas fills 0.03\d* of the envelope at 5e\+04 Pa: light and heat", told)
    weak = balloon_of(gas_mass=2.0, molar_mass=4.0026e-3, film_strength=50.0)
    (told,) = MODEL.diagnostics(weak, air, 300.0)
    assert re.match(r"the film must withstand \S+ N/m at 5.5e\+03 Pa; its film_strength", told)


def test_published_flight():
    """A balloon of 5.8 m, 1.3 kg of film and 1.7 kg of load floated at 20.3 km, 5.57 kPa.

    Track of flight SHAB-15V over New Mexico on 22 August 2022, 17:35 to 18:18 UTC, the sun 31° to
    24° from the zenith; masses as its own simulation has them. Its film is known as
    charcoal-darkened polyethylene.
    """
    film = lf.FilmProperties(1.3 / (4.0 * np.pi * 2.9**2), 0.9, 0.9, 0.9, 0.9, 0.9)
    flyer = lf.Balloon(film, 2.9, payload=1.7)
    sun = lf.environment.sunlight(zenith_angle=np.radians(28.0), infrared_below=290.0, albedo=0.25)
    earth = lf.Earth(radiation=sun)
    band = lf.levitation_band(flyer, earth, MODEL, (10e3, 30e3))
    assert band.upper == pytest.approx(20.3e3, abs=1.2e3)
    assert earth.state(band.upper).pressure == pytest.approx(5570.0, rel=0.2)


def test_hollow_sphere_that_pumps_nothing_is_a_balloon():
    """The wall of channels, almost without any, beside the film: where no flow carries or cools."""
    wall = lf.FilmProperties(5e-4, 0.9, 0.8, 0.8, 0.9, 0.9)
    hollow = lf.HollowBody(wall, wall, 6.0, 0.1, 1e-7, 1e-4, 2e-4, 5e-8, 1.8, "sphere")
    balloon = lf.Balloon(lf.FilmProperties(1e-3, 0.9, 0.8, 0.8, 0.9, 0.9), 3.0, 0.1)
    pump = lf.HollowPump()
    for pressure in (5500.0, 10.0):
        state = state_at(pressure, 220.0, irradiance=1300.0, albedo=0.3, infrared_below=240.0)
        warm = lf.equilibrium(balloon, state, MODEL).temperature
        assert lf.equilibrium(hollow, state, pump).temperatures == pytest.approx(
            (warm, warm), rel=2e-3
        )
        lifted = lf.lift(balloon, state, MODEL)
        assert lf.lift(hollow, state, pump) == pytest.approx(lifted, rel=0.01)
