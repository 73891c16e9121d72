"""The page of the model, written again from its formulas alone, beside the package."""

import numpy as np
import pytest
from scipy.optimize import brentq

import lightflyer as lf
from lightflyer.force.lu2023 import PRINTED, REPORTED

SIGMA, GAS_CONSTANT, MOLAR_MASS = 5.670374419e-8, 8.314462618, 0.0289644
RADIUS, WEIGHT, ALBEDO, INFRARED = 0.01, 1e-3, 0.29, 240.0
ABSORPTANCE, EMITTANCE, TAC_TOP, TAC_BOTTOM = 0.75, 0.08, 0.8, 0.9
EARTH = 6371008.8
FILM = lf.FilmProperties(
    WEIGHT, ABSORPTANCE, EMITTANCE, EMITTANCE, tac_top=TAC_TOP, tac_bottom=TAC_BOTTOM
)


@pytest.mark.parametrize("altitude", [70e3, 74e3, 78e3])
@pytest.mark.parametrize("reading", [REPORTED, PRINTED])
def test_light_that_levitates_by_the_formulas_of_the_page(altitude, reading):
    printed = reading is PRINTED
    state = lf.Earth().state(altitude)
    gas, p, cold, g = state.gas, *(float(x) for x in (state.pressure, state.temperature,
                                                     state.gravity))  # fmt: skip
    area, mean_tac, difference = np.pi * RADIUS**2, (TAC_TOP + TAC_BOTTOM) / 2, TAC_BOTTOM - TAC_TOP

    def speed(temperature):
        return np.sqrt(8 * GAS_CONSTANT * temperature / (np.pi * MOLAR_MASS))

    def heat_and_force(hot):
        mean, warmer = 0.5 * (hot + cold), hot - cold
        mu, kappa, heat = (
            float(f(mean)) for f in (gas.viscosity, gas.conductivity, gas.heat_capacity)
        )
        gamma = float(gas.heat_capacity_ratio_at(mean))
        density = p * MOLAR_MASS / (GAS_CONSTANT * mean)
        at = mean if printed else cold
        thin = (gamma + 1) / (gamma - 1) / 8 * speed(at) / at * 2 * area * mean_tac * p * warmer
        rayleigh = g * density * (2 * RADIUS) ** 3 * warmer / (mean * mu * kappa) * density * heat
        dense = (8 / np.pi + 0.417 * rayleigh**0.25) * np.pi * RADIUS * kappa * warmer
        dense *= 1 if printed else 2
        linear = p * area / 4 * difference * warmer / (cold if printed else mean)
        creep = 16 * mu * 6 * 1.14 * mu / density * hot * kappa / (RADIUS * p * speed(mean))
        creep *= (gamma - 1) / (gamma + 1) * difference / mean_tac * warmer / cold
        return 1 / (1 / thin + 1 / dense), 1 / (1 / (0.4 * linear) + 1 / (3.0 * creep))

    hot = brentq(lambda t: heat_and_force(t)[1] - WEIGHT * area * g, cold + 1.0, 1500.0, xtol=1e-10)
    view = (EARTH / (EARTH + altitude)) ** 2
    lost = heat_and_force(hot)[0] + area * SIGMA * 2 * EMITTANCE * (hot**4 - cold**4)
    gained = area * EMITTANCE * (view * INFRARED - 2 * SIGMA * cold**4)
    light = (lost - gained) / (area * ABSORPTANCE * (1 + ALBEDO * view))
    found = lf.levitate(lf.Disk(FILM, RADIUS), state, lf.Lu2023(reading=reading))
    assert float(found.irradiance) == pytest.approx(
        light, rel=1e-4
    )  # constants of the standard atmosphere
    if altitude == 78e3 and not printed:
        assert light == pytest.approx(817.0, rel=1e-3)
