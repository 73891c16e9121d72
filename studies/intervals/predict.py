"""``predict``: a file states measured values, each off by an error of its own ±; truth by NumPy.

The truth is the paper's model in plain NumPy (``benchmarks/numpy_model.py``) with SciPy's
root-finder and minimiser, at the true values.
"""

import sys
from functools import cache
from pathlib import Path

import numpy as np
from scipy.optimize import brentq, minimize_scalar
from trial import Trial

import lightflyer as lf
from lightflyer.core.units import Measured

sys.path.append(str(Path(__file__).parents[2] / "benchmarks"))
import numpy_model

COMMAND = "predict"

RADIUS, LIGHT, ALTITUDE = 0.01, 1360.0, 72e3
TRUTH = {
    "areal_density": 1e-3,
    "absorptance": 0.75,
    "emittance": 0.08,
    "tac_top": 0.8,
    "tac_bottom": 0.9,
}
SPREAD = {"areal_density": 3e-5, "absorptance": 0.02, "emittance": 0.005}
CONDITIONS = {"TACs ± 0.01": 0.01, "TACs ± 0.03": 0.03}
AREA = np.pi * RADIUS**2
HOTTEST = 3000.0


@cache
def air(altitude):
    """Pressure [Pa] and temperature [K] of the paper's atmosphere."""
    atmosphere = lf.environment.Lu2023Atmosphere()
    return float(atmosphere.pressure(altitude)), float(atmosphere.temperature(altitude))


def force(hot, altitude):
    """Force of the true disk [N]."""
    pressure, cold = air(altitude)
    return numpy_model.force(
        hot, cold, pressure, RADIUS, TRUTH["tac_top"], TRUTH["tac_bottom"]
    )  # fmt: skip


def loss(hot, altitude):
    """Heat loss of the true disk [W]."""
    pressure, cold = air(altitude)
    mean = 0.5 * (TRUTH["tac_top"] + TRUTH["tac_bottom"])
    return numpy_model.lost_power(hot, cold, pressure, RADIUS, mean, TRUTH["emittance"])


def temperature(altitude):
    """Temperature of the true disk in the light [K]."""
    gained = AREA * TRUTH["absorptance"] * LIGHT
    return brentq(lambda hot: loss(hot, altitude) / gained - 1.0, air(altitude)[1] + 1e-6, HOTTEST)


def payload(altitude):
    """Payload of the true disk [kg]."""
    own = AREA * TRUTH["areal_density"]
    return force(temperature(altitude), altitude) / numpy_model.GRAVITY - own


def least_light(altitude):
    """Irradiance at which the true disk levitates [W/m²]; infinite where none does."""
    weight = AREA * TRUTH["areal_density"] * numpy_model.GRAVITY
    if force(HOTTEST, altitude) < weight:
        return np.inf
    cold = air(altitude)[1]
    hot = brentq(lambda hot: force(hot, altitude) / weight - 1.0, cold + 1e-6, HOTTEST)
    return loss(hot, altitude) / (AREA * TRUTH["absorptance"])


@cache
def truth():
    """The true results, by their names in the prediction's summary."""
    best = minimize_scalar(lambda h: -payload(h), bounds=(60e3, 90e3), options={"xatol": 1.0})
    easiest = minimize_scalar(lambda h: least_light(h), bounds=(60e3, 85e3), options={"xatol": 1.0})
    lower, upper = (brentq(payload, end, best.x) for end in (60e3, 90e3))
    return {
        "altitude_band_km.lower": lower / 1e3,
        "altitude_band_km.upper": upper / 1e3,
        "minimum_irradiance.value_w_m2": easiest.fun,
        "best.payload_mg": -best.fun * 1e6,
        "best.temperature_k": temperature(best.x),
        "at[0].levitation_irradiance_w_m2": least_light(ALTITUDE),
        "at[0].temperature_k": temperature(ALTITUDE),
        "at[0].lift_over_weight": 1.0 + payload(ALTITUDE) / (AREA * TRUTH["areal_density"]),
    }


def trials(seed):
    """One file of measured values for each condition, and the bands that the command prints."""
    rng = np.random.default_rng(seed)
    found = []
    for words, tac in CONDITIONS.items():
        spread = SPREAD | {"tac_top": tac, "tac_bottom": tac}
        film = {
            name: Measured(TRUTH[name] + error * rng.normal(), error)
            for name, error in spread.items()
        }
        file = lf.FlyerFile(
            flyer={"diameter": f"{2 * RADIUS} m"},
            film=film,
            environment={"atmosphere": "lu2023", "irradiance": f"{LIGHT} W/m^2"},
            force={"model": "lu2023"},
        )
        prediction = lf.predict(file, at=[ALTITUDE])
        results = lf.propagate(file, prediction=prediction, seed=seed).summary()["results"]
        for name, true in truth().items():
            for method in ("monte_carlo", "first_order"):
                band = results.get(name, {}).get(method)
                if band is None or band["low"] is None:
                    continue  # the file's flyer has no such result, and none is printed
                high = np.inf if band["high"] is None else band["high"]
                label = name.replace("at[0]", "at 72 km").replace("_", " ")
                method = method.replace("_", " ")
                found.append(Trial(f"{label} by {method}, {words}", true, band["low"], high))
    return found
