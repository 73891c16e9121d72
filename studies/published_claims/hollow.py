"""Hollow bodies of Celenza et al.: a kilogram at 80 km, and what germanium adds."""

import numpy as np
from sampling import Guess, drawn

import lightflyer as lf
from lightflyer.force.pumps import celenza2023_laws as published

SAMPLES = 256
ALTITUDE, SIZE, CLAIMED = 80e3, 10.0, 1.0  # [m], [m], [kg]
# Where the published grid carries most: rocket, cone, sphere.
OUTLETS = {"rocket": 4.972650, "cone": 4.972650, "sphere": 3.683375}  # radius [m]
WIDTH, THICKNESS = 1.1634590884e-3, 1.176811952e-3  # of channels and wall [m]
FILM = 5e-4  # areal density of each film [kg/m²]
OPEN_FRACTION, SHEET = 0.5, 50e-9

GUESSES = {
    "absorptance": Guess(0.7, 0.95),  # of the inner film
    "emittance_in": Guess(0.05, 0.3),
    "emittance_out": Guess(0.3, 0.9),
    "tac": Guess(0.8, 1.0),
    "film": Guess(0.15e-3, 0.5e-3),  # areal density of each film, as published at most [kg/m²]
}
WIDTHS = np.geomspace(1e-4, 3e-2, 9)
RELATIVE_THICKNESSES = np.array([0.5, 1.0, 2.0, 4.0])
RELATIVE_OUTLETS = np.array([0.15, 0.3, 0.45])  # over the size; of a sphere and a cone

GERMANIUM_FILM, NANOTUBE_FILM = 0.08, 0.48  # emittances, Lu et al. 2023
ABSORPTANCE = 0.75  # of both, Lu et al. 2023
GERMANIUM_GUESSES = {
    "altitude": Guess(60e3, 80e3),
    "size": Guess(0.1, 10.0, logarithmic=True),
    "width": Guess(1e-4, 3e-3, logarithmic=True),
    "relative_thickness": Guess(0.5, 3.0),
    "relative_outlet": Guess(0.15, 0.45),
    "emittance_out": Guess(0.05, 0.9),
    "tac": Guess(0.8, 1.0),
}


def body(form, size, outlet, width, thickness, guesses, payload=0.0):
    """A body with a wall of two films, once for each guess."""
    outside, inside = guesses["emittance_out"], guesses["emittance_in"]
    outer = lf.FilmProperties(
        guesses["film"], 0.0, outside, outside, guesses["tac"], guesses["tac"], transmittance=1.0
    )
    inner = lf.FilmProperties(
        guesses["film"], guesses["absorptance"], inside, inside, guesses["tac"], guesses["tac"]
    )
    return lf.HollowBody(
        outer, inner, size, outlet, OPEN_FRACTION, width, thickness, SHEET,
        published.SHEET_CONDUCTIVITY, form, sheet_density=published.SHEET_DENSITY, payload=payload,
    )  # fmt: skip


def published_surroundings():
    """Air and light of the published code at 80 km."""
    atmosphere = lf.environment.Lu2023Atmosphere()
    # with its rounded constants
    ratio = (9.81 / 287.0) / (9.8 / 287.05)
    pressure = 101300.0 * (atmosphere.pressure(ALTITUDE) / 101325.0) ** ratio
    light = lf.environment.Radiation(1000.0 + 3.8 * ALTITUDE / 1e3)
    return lf.environment.EnvironmentState(
        pressure, atmosphere.temperature(ALTITUDE), 9.8, lf.gas.AIR, light
    )


def as_published():
    """Payload of each form by the published model, and by the corrected one [kg]."""
    plain = {
        "absorptance": 0.9, "emittance_in": 0.08, "emittance_out": 0.8, "tac": 0.9, "film": FILM,
    }  # fmt: skip
    places = {
        "celenza2023": (lf.Celenza2023(), published_surroundings()),
        "hollow-pump": (lf.HollowPump(), lf.Earth().state(ALTITUDE)),
    }
    return {
        form: {
            name: float(lf.payload(body(form, SIZE, outlet, WIDTH, THICKNESS, plain), state, model))
            for name, (model, state) in places.items()
        }
        for form, outlet in OUTLETS.items()
    }


def kilogram(form="rocket", guesses=None):
    """Lift over weight with a kilogram, as designed, for each guess."""
    guesses = guesses or drawn(GUESSES, SAMPLES)
    state = lf.Earth().state(ALTITUDE)
    flyer = body(form, SIZE, OUTLETS[form], WIDTH, THICKNESS, guesses, CLAIMED)
    return ratio(flyer, state)


def ratio(flyer, state):
    """Lift over weight with payload."""
    lift = np.asarray(lf.lift(flyer, state, lf.HollowPump()))
    return lift / np.asarray(lf.statics.weight(flyer, state))


def designed_anew(form):
    """Lift over weight with a kilogram, and payload [kg], channels and outlet at their best."""
    guesses = {name: one[:, None, None, None] for name, one in drawn(GUESSES, SAMPLES).items()}
    state = lf.Earth().state(ALTITUDE)
    width = WIDTHS[:, None, None]
    thickness = width * RELATIVE_THICKNESSES[:, None]
    outlet = SIZE * RELATIVE_OUTLETS
    bare, laden = (
        body(form, SIZE, outlet, width, thickness, guesses, payload) for payload in (0.0, CLAIMED)
    )
    carried = np.asarray(lf.payload(bare, state, lf.HollowPump()))
    every = (1, 2, 3)
    return ratio(laden, state).max(axis=every), carried.max(axis=every)


def germanium(form="sphere"):
    """Force with a film of germanium over that with one of nanotubes, for each guess."""
    guesses = drawn(GERMANIUM_GUESSES, SAMPLES)
    state = lf.Earth().state(guesses["altitude"])
    width, size = guesses["width"], guesses["size"]
    forces = []
    for emittance in (GERMANIUM_FILM, NANOTUBE_FILM):
        numbers = {
            "film": FILM, "absorptance": ABSORPTANCE, "emittance_in": emittance,
            "emittance_out": guesses["emittance_out"], "tac": guesses["tac"],
        }  # fmt: skip
        flyer = body(
            form, size, size * guesses["relative_outlet"], width,
            width * guesses["relative_thickness"], numbers,
        )  # fmt: skip
        found = lf.equilibrium(flyer, state, lf.HollowPump())
        with lf.float64():
            forces.append(np.asarray(lf.HollowPump().force(flyer, state, found.unknowns)))
    return forces[0] / forces[1], guesses
