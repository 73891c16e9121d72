"""The disk of Azadi et al., the plate of Cortes et al. and the sandwich of Schafer et al."""

import sys
from functools import cache
from pathlib import Path

import disks
import numpy as np
from measurements import middle, number, shares

import lightflyer as lf
from lightflyer.environment import Radiation

CLAIMS = Path(__file__).parents[1] / "published_claims"
sys.path.append(str(CLAIMS))

import plates  # noqa: E402  of the study of claims, which has what is guessed of both devices
import sandwiches  # noqa: E402

SAMPLES = 1024
NAMES = (*disks.PROPERTIES, "tac_top", *disks.ERRORS, "light")
PLATE_PRESSURES = plates.OBSERVED  # [Pa]


def azadi(paper, terms, count=SAMPLES):
    """Least light over the light in which 6-mm disks flew, at the best of their pressures.

    Parameters
    ----------
    paper : dict
        Of the file.
    terms : disks.Terms
    count : int
        Of samples; 1 for the middle of all.

    Returns
    -------
    ratio : array, shape (n,)
    temperature : array, shape (n,)
        [K].
    """
    drawn = _drawn(NAMES, count)
    names = (*disks.PROPERTIES, "tac_top")
    film = {name: number(paper[name]).at(drawn[name]) for name in names}
    pressure = number(paper["pressure"])
    lifted = disks.levitation(
        film,
        number(paper["diameter"]).value,
        terms,
        disks.errors_of(drawn),
        lf.Chamber().temperature,
        np.linspace(pressure.low, pressure.high, 5),
    )
    light, temperature, _ = disks.least(lifted, np.linspace(pressure.low, pressure.high, 5))
    return light / number(paper["at_most"]).at(drawn["light"]), temperature


@cache
def _plates(count):
    """Least light [W/m²] and temperature [K] of plates, at the worst of their pressures."""
    drawn = _drawn((*plates.GUESSES, "light"), count)
    guesses = {name: guess.at(drawn[name])[:, None] for name, guess in plates.GUESSES.items()}
    state = lf.Chamber(temperature=plates.LABORATORY).state(PLATE_PRESSURES)
    lifted = lf.levitate(plates.plate(guesses), state, lf.ChannelPump())
    light, temperature = np.asarray(lifted.irradiance), np.asarray(lifted.temperature)
    worst = light.argmax(axis=1)[:, None]
    return (*(np.take_along_axis(x, worst, 1)[:, 0] for x in (light, temperature)), drawn["light"])


def cortes(paper, count=SAMPLES):
    """Least light over the light in which plates flew, at the worst of their pressures."""
    light, temperature, share = _plates(count)
    return light / number(paper["at_most"]).at(share), temperature


@cache
def _sandwiches(count):
    """Least light [W/m²] and temperature [K] of the sandwich.

    Its gap is taken for anything between much narrower and much wider than its holes.
    """
    drawn = _drawn((*sandwiches.DEVICE_GUESSES, "light"), count)
    guesses = {name: guess.at(drawn[name]) for name, guess in sandwiches.DEVICE_GUESSES.items()}
    flyer = sandwiches.sandwich(guesses, sandwiches.DEVICE_RADIUS, sandwiches.DEVICE_GAP, 0.5)
    light = Radiation(irradiance=sandwiches.DEVICE_LIGHT)
    chamber = lf.Chamber(temperature=sandwiches.LABORATORY, radiation=light)
    state, wide = chamber.state(sandwiches.DEVICE_PRESSURE), guesses["width"]
    least = [
        lf.levitate(flyer, state, lf.Kinetic(transmission=transmission))
        for transmission in ("aligned", "wide")
    ]
    narrow, broad = (np.asarray(found.irradiance) for found in least)
    flies = np.isfinite(broad)
    both = np.where(flies, narrow ** (1.0 - wide) * np.where(flies, broad, 1.0) ** wide, np.inf)
    return both, np.asarray(least[0].temperature), drawn["light"]


def schafer(paper, count=SAMPLES):
    """Least light over the light in which the sandwich flew."""
    light, temperature, share = _sandwiches(count)
    return light / number(paper["at_most"]).at(share), temperature


def _drawn(names, count):
    return middle(names) if count == 1 else shares(names, count)
