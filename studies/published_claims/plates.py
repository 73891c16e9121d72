"""The nanocardboard plate of Cortes et al., which levitated at 10 Pa to 200 Pa."""

import numpy as np
from sampling import Guess, drawn

import lightflyer as lf

SAMPLES = 512
RADIUS = 4e-3
LABORATORY = 293.0  # [K], guessed
CHANNEL = {"channel_width": 50e-6, "channel_length": 500e-6, "spacing": 50e-6}
SHEET, CONDUCTIVITY = 50e-9, 1.8  # alumina
OBSERVED = np.array([10.0, 30.0, 100.0, 200.0])  # [Pa]
AROUND = np.array([1.0, 3.0, *OBSERVED, 500.0, 1e3, 1e4])

GUESSES = {
    "irradiance": Guess(8e3, 12e3),
    "height": Guess(40e-6, 100e-6),
    "absorptance": Guess(0.3, 0.95),  # of the lower film
    "emittance": Guess(0.05, 0.3),
    "tac": Guess(0.7, 1.0),
    "areal_density": Guess(0.4e-3, 1.0e-3),
}


def plate(guesses):
    """The plate, once for each guess."""
    top, bottom = (
        lf.FilmProperties(
            1.5e-4, absorptance, guesses["emittance"], guesses["emittance"], guesses["tac"],
            guesses["tac"], transmittance=through,
        )
        for absorptance, through in ((0.02, 0.9), (guesses["absorptance"], 0.0))
    )  # fmt: skip
    return lf.Plate(
        top, bottom, RADIUS, height=guesses["height"], wall_thickness=SHEET,
        wall_conductivity=CONDUCTIVITY, areal_density=guesses["areal_density"], **CHANNEL,
    )  # fmt: skip


def levitation(guesses=None):
    """Lift over weight, for each guess and pressure around the observed ones."""
    guesses = guesses or drawn(GUESSES, SAMPLES)
    guesses = {name: value[:, None] for name, value in guesses.items()}
    light = lf.environment.Radiation(irradiance=guesses["irradiance"])
    state = lf.Chamber(temperature=LABORATORY, radiation=light).state(AROUND)
    flyer = plate(guesses)
    lift = np.asarray(lf.lift(flyer, state, lf.ChannelPump()))
    return lift / np.asarray(lf.statics.weight(flyer, state))
