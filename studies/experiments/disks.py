"""The disks of Lu et al. and Azadi et al.: the least light that the models say they need."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from measurements import middle, number
from scipy.optimize import brentq
from scipy.stats import norm

import lightflyer as lf
from lightflyer.core.constants import STEFAN_BOLTZMANN
from lightflyer.environment import Radiation

FILMS = ("germanium", "nanotubes")
DIAMETERS = (2, 3, 4)  # [cm]
PROPERTIES = ("areal_density", "absorptance", "emittance", "tac_bottom")
ERRORS = ("force_error", "heat_error", "wall_error")
PRESSURES = np.geomspace(0.2, 63.0, 26)  # [Pa]; ten to a decade
NAMES = (
    *(f"{film} {name}" for film in FILMS for name in PROPERTIES),
    *(f"{film} {size} cm" for film in FILMS for size in DIAMETERS),
    *("tac_top", "brightest", "light", *ERRORS),
)
"""What is sampled for the disks of Lu et al."""

_FORCES = 0.3, 4.0  # factors between which that needed is looked for


@dataclass(frozen=True)
class Terms:
    """What a prediction takes into account.

    Attributes
    ----------
    chamber : mapping
        What :class:`lightflyer.Chamber` is told of the chamber's walls.
    model : mapping
        Choices of :class:`lightflyer.Kinetic`.
    areal_density : float or None
        In place of the published range [kg/m²].
    tac_uncertainty : float or None
        Of each TAC, in place of the published one.
    tac_scale : float
        Factor on all TACs.
    tac_together : bool
        All TACs err by the same, so that their differences are as published.
    nanotubes_apart : float or None
        Difference of the TACs of the nanotubes' faces, in place of the one taken.
    reflected : float
        Light that returns onto the other face, over that of the lamps.
    warmer_below : float
        Temperature of all that is seen below, over the gas temperature [K].
    warmer_around : float
        That of all surroundings.
    warmer_floor : float
        Temperature of a solid floor over that of lid and side wall [K].
    germanium : mapping
        Factors on properties of the germanium film.
    rods : float
        Width of film that each of the launchpad's two rods keeps dark [m].
    """

    chamber: Mapping[str, Any] = field(default_factory=dict)
    model: Mapping[str, Any] = field(default_factory=dict)
    areal_density: float | None = None
    tac_uncertainty: float | None = None
    tac_scale: float = 1.0
    tac_together: bool = False
    nanotubes_apart: float | None = None
    reflected: float = 0.0
    warmer_below: float = 0.0
    warmer_around: float = 0.0
    warmer_floor: float = 0.0
    germanium: Mapping[str, float] = field(default_factory=dict)
    rods: float = 0.0


def film(paper, name, shares, terms):
    """Properties of a film of Lu et al., one value for each sample."""
    found = {
        key: number(paper[name][key]).at(shares[f"{name} {key}"])
        for key in ("areal_density", "absorptance", "emittance")
    }
    found["tac_bottom"] = _tac(paper[name]["tac_bottom"], shares, f"{name} tac_bottom", terms)
    found["tac_top"] = _tac(paper["faces"]["tac_top"], shares, "tac_top", terms)
    if name == "nanotubes" and terms.nanotubes_apart is not None:
        found["tac_top"] = found["tac_bottom"] - terms.nanotubes_apart
    if terms.areal_density is not None:
        found["areal_density"] = np.full_like(found["areal_density"], terms.areal_density)
    factors = terms.germanium if name == "germanium" else {}
    return {key: value * factors.get(key, 1.0) for key, value in found.items()}


def _tac(entry, shares, name, terms):
    share = shares["tac_top" if terms.tac_together else name]
    if terms.tac_uncertainty is not None:
        entry = entry | {"uncertainty": terms.tac_uncertainty}
    value = number(entry | {"highest": np.inf}).at(share)
    return np.minimum(terms.tac_scale * value, entry.get("highest", np.inf))


def lit_share(radius, width):
    """Share of a disk's light that two parallel rods under its middle halves leave [1].

    Each lies half a radius from the centre, where its chord is √3 radii long.
    """
    return 1.0 - 2.0 * width * np.sqrt(3.0) * radius / (np.pi * radius**2)


def levitation(found, diameter, terms, errors, temperature, pressures=PRESSURES, model=None):
    """The least light at which disks lift off, at each pressure.

    Parameters
    ----------
    found : mapping of str to array, shape (n,)
        Properties of the films.
    diameter : float
        [m].
    terms : Terms
    errors : mapping of str to array, shape (n,)
        The force model's own errors, in standard errors.
    temperature : float
        Of gas and walls [K].
    pressures : array, shape (p,)
        [Pa].
    model : lightflyer.AbstractForceModel, optional
        In place of the kinetic one of the terms.

    Returns
    -------
    lightflyer.statics.Levitation
        Of shape (n, p).
    """
    column = {name: np.asarray(value)[:, None] for name, value in found.items()}
    radius = 0.5 * diameter
    # what lies in the dark is as cold as the gas and has to be carried
    carried = column["areal_density"] / lit_share(radius, terms.rods)
    emittance = column["emittance"]
    disk = lf.Disk(
        lf.FilmProperties(
            carried, column["absorptance"], emittance, emittance,
            column["tac_top"], column["tac_bottom"],
        ),
        radius=radius,
    )  # fmt: skip
    model = model or lf.Kinetic(**{k: v[:, None] for k, v in errors.items()}, **terms.model)
    over_floor = {}
    if terms.warmer_floor and "floor" in terms.chamber:
        over_floor["floor_temperature"] = temperature + terms.warmer_floor
    chamber = lf.Chamber(
        temperature=temperature,
        radiation=_radiation(terms, temperature),
        **terms.chamber,
        **over_floor,
    )
    return lf.levitate(disk, chamber.state(pressures), model)


def _radiation(terms, temperature):
    """Lamps and heat radiation; which face the lamps light does not matter to a disk."""
    above = temperature + terms.warmer_around
    below = above + terms.warmer_below
    return Radiation(
        albedo=terms.reflected,
        infrared_above=STEFAN_BOLTZMANN * above**4,
        # a floor of another temperature radiates by itself
        infrared_below=None if terms.warmer_floor else STEFAN_BOLTZMANN * below**4,
    )


def least(found, pressures=PRESSURES):
    """Light [W/m²], temperature [K] and pressure [Pa] where the least light suffices.

    Both are infinite where no light suffices at any pressure.
    """
    light = np.asarray(found.irradiance)
    temperature = np.where(np.isfinite(light), np.asarray(found.temperature), np.inf)
    best = light.argmin(axis=1)
    rows = np.arange(best.size)
    return light[rows, best], temperature[rows, best], pressures[best]


def errors_of(shares):
    """The force model's own errors, in standard errors."""
    return {name: norm.ppf(shares[name]) for name in ERRORS}


def predict(paper, shares, terms, forces=None):
    """The least light of all disks of Lu et al.

    Parameters
    ----------
    paper : dict
        Of the file.
    shares : mapping of str to array, shape (n,)
        Of :data:`NAMES`.
    terms : Terms
    forces : mapping of str to float, optional
        Factor on the force on each film; nothing by default.

    Returns
    -------
    dict of (str, int) to tuple of array, shape (n,)
        Light, temperature and pressure, by film and diameter [cm].
    """
    temperature = number(paper["setting"]["temperature"]).value
    found = {}
    for name in FILMS:
        properties = film(paper, name, shares, terms)
        properties["areal_density"] = properties["areal_density"] / (forces or {}).get(name, 1.0)
        for size in DIAMETERS:
            lifted = levitation(properties, 0.01 * size, terms, errors_of(shares), temperature)
            found[name, size] = least(lifted)
    return found


def measured(paper, shares):
    """The same as measured, with its errors; what flew has the most that it can have needed."""
    light, brightest = _reading(paper, "light", shares), number(paper["setting"]["brightest"])
    found = {}
    for name in FILMS:
        for size in DIAMETERS:
            entry = paper[name]["disks"][str(size)]
            lift_off = _lift_off(paper, shares, name, size)
            bound = entry.get("at_most", 0.0) * brightest.at(shares["brightest"])
            found[name, size] = light * lift_off * entry.get("least", bound)
    return found


def measured_reductions(paper, shares):
    """Light that germanium saves, by diameter [cm], with its errors."""
    found = {}
    for size in DIAMETERS:
        errors = [_lift_off(paper, shares, name, size) for name in FILMS]
        left = 1.0 - number(paper["reductions"][str(size)]).value
        found[size] = 1.0 - left * errors[0] / errors[1]
    return found


def _reading(paper, key, shares):
    return number(paper["reading"][key]).at(shares[key])


def _lift_off(paper, shares, name, size):
    return number(paper["reading"]["lift_off"]).at(shares[f"{name} {size} cm"])


def reductions(found):
    """Light that germanium saves over nanotubes, by diameter [cm]; −∞ where it cannot fly."""
    saved = {}
    for size in DIAMETERS:
        light = [found[name, size][0] for name in FILMS]
        both = np.isfinite(light[0])
        saved[size] = np.where(both, 1.0 - np.where(both, light[0], 0.0) / light[1], -np.inf)
    return saved


def likelihood(paper, found, shares):
    """Of what was measured of the 2-cm disks, for each sample.

    Parameters
    ----------
    paper : dict
        Of the file.
    found : dict
        Of :func:`predict`.
    shares : mapping of str to array, shape (n,)
        Those of the scale of the light count, which all disks share.

    Returns
    -------
    array, shape (n,)
        1 where both films need exactly the light that they needed.
    """
    scale, spread = _reading(paper, "light", shares), number(paper["reading"]["lift_off"])
    squares = 0.0
    for name in FILMS:
        measured_light = scale * paper[name]["disks"]["2"]["least"]
        squares += (np.log(found[name, 2][0] / measured_light) / spread.uncertainty) ** 2
    return np.exp(-0.5 * squares)


def forces_needed(paper, terms):
    """Factor on the force of each film with which its 2-cm disk needs the light that it needed.

    Returns
    -------
    dict of str to float
    """
    shares = middle(NAMES)
    temperature = number(paper["setting"]["temperature"]).value
    found = {}
    for name in FILMS:
        properties = film(paper, name, shares, terms)
        goal = np.log(paper[name]["disks"]["2"]["least"])

        def off(factor, properties=properties, goal=goal):
            carried = properties["areal_density"] / np.exp(factor)
            lifted = levitation(
                properties | {"areal_density": carried}, 0.02, terms, errors_of(shares), temperature
            )
            return np.log(least(lifted)[0][0]) - goal

        found[name] = float(np.exp(brentq(off, *np.log(_FORCES), xtol=1e-4)))
    return found
