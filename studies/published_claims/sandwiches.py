"""Sandwiches of Schafer et al.: one that flew in a chamber, one designed for 75 km."""

import numpy as np
from sampling import Guess, drawn

import lightflyer as lf

SAMPLES = 512
BEST, WIDE = "kinetic", "kinetic, wide gap"
BETWEEN = "kinetic, holes unknown"
DEVICE_RADIUS, DEVICE_PRESSURE, DEVICE_LIGHT, DEVICE_GAP = 5e-3, 26.7, 750.0, 125e-6
LARGE_RADIUS, LARGE_ALTITUDE, LARGE_PAYLOAD = 0.03, 75e3, 10e-6
LABORATORY = 293.0  # [K], guessed
ALUMINA, CHROMIUM = 3.0e3 * 100e-9, 7.19e3 * 10e-9  # areal densities [kg/m²]
ALUMINA_CONDUCTIVITY, ALUMINA_DENSITY = 1.8, 3.0e3

OPTICS = {
    "absorptance": Guess(0.5, 0.9),  # of the lower film
    "top_transmittance": Guess(0.8, 0.95),
    "emittance": Guess(0.05, 0.3),  # of three faces
    "bottom_emittance": Guess(0.03, 0.3),  # of the lowest face
    "tac": Guess(0.8, 1.0),
}
DEVICE_GUESSES = {
    **OPTICS,
    "support_fraction": Guess(1e-4, 1e-3, logarithmic=True),
    "width": Guess(0.0, 1.0),  # of the gap against the holes: 0 narrow, or holes aligned; 1 wide
}
LARGE_GUESSES = {**OPTICS, "support_fraction": Guess(1e-5, 3e-4, logarithmic=True)}
GAPS = np.geomspace(1e-4, 3e-3, 9)
OPEN_FRACTIONS = np.array([0.3, 0.5, 0.7])


def sandwich(guesses, radius, gap, open_fraction, payload=0.0):
    """The device, once for each guess."""
    top = lf.FilmProperties(
        ALUMINA, 0.02, guesses["emittance"], guesses["emittance"], guesses["tac"],
        guesses["tac"], transmittance=guesses["top_transmittance"],
    )  # fmt: skip
    bottom = lf.FilmProperties(
        ALUMINA + CHROMIUM, guesses["absorptance"], guesses["emittance"],
        guesses["bottom_emittance"], guesses["tac"], guesses["tac"],
    )  # fmt: skip
    return lf.Sandwich(
        top, bottom, radius, gap, open_fraction, 0.5 * gap, guesses["support_fraction"],
        ALUMINA_CONDUCTIVITY, payload, support_density=ALUMINA_DENSITY,
    )  # fmt: skip


def device(guesses=None, names=None):
    """Lift over weight where it was seen to levitate, by all models or those named."""
    guesses = guesses or drawn(DEVICE_GUESSES, SAMPLES)
    light = lf.environment.Radiation(irradiance=DEVICE_LIGHT)
    state = lf.Chamber(temperature=LABORATORY, radiation=light).state(DEVICE_PRESSURE)
    flyer = sandwich(guesses, DEVICE_RADIUS, DEVICE_GAP, 0.5)
    found = {
        name: ratio(flyer, state, model)
        for name, model in models().items()
        if name in (names or models())
    }
    if names:
        return found
    wide = guesses["width"]
    found[BETWEEN] = found[BEST] ** (1.0 - wide) * found[WIDE] ** wide
    return found


def ratio(flyer, state, model):
    """Lift over weight with payload."""
    return np.asarray(lf.lift(flyer, state, model)) / np.asarray(lf.statics.weight(flyer, state))


def large():
    """Lift over weight with 10 mg at 75 km, and payload [kg]; gap and holes at their best."""
    guesses = {name: value[:, None, None] for name, value in drawn(LARGE_GUESSES, SAMPLES).items()}
    state = lf.Earth().state(LARGE_ALTITUDE)
    found = {}
    for name, model in models().items():
        bare, laden = (
            sandwich(guesses, LARGE_RADIUS, GAPS[:, None], OPEN_FRACTIONS, payload)
            for payload in (0.0, LARGE_PAYLOAD)
        )
        carried = np.asarray(lf.payload(bare, state, model))
        found[name] = ratio(laden, state, model).max(axis=(1, 2)), carried.max(axis=(1, 2))
    return found


def models():
    """Those of a sandwich: as published, and in open space; with holes above each other or not."""
    return {
        "schafer2025": lf.Schafer2025(),
        BEST: lf.Kinetic(),
        WIDE: lf.Kinetic(transmission="wide"),
    }
