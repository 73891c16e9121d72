"""Winds on pressure levels, put on altitudes by the geopotential or the temperature beside them."""

from typing import Any

import numpy as np

from lightflyer.core import constants
from lightflyer.environment.atmosphere.us1976 import US1976
from lightflyer.environment.planet import EARTH_PLANET
from lightflyer.environment.wind.gradient import CENTRIFUGAL, normal_gravity

GAS_CONSTANT = constants.GAS_CONSTANT_US1976 / constants.MOLAR_MASS_AIR  # of dry air [J/(kg K)]
_RADIUS = 6.356766e6  # of the Earth in the standard atmosphere [m]; [USSA1976]_
_BETWEEN = 2  # new levels for each of the file's
_SEARCHED = np.linspace(0.0, 100e3, 20001)  # altitudes of the standard atmosphere [m]


def altitude_of(geopotential: Any, latitude: Any) -> Any:
    """Altitude over the ellipsoid [m] of a geopotential [m²/s²], at a latitude [rad]."""
    # .. math:: \Phi = g R h/(R + h), \qquad R = a/(1 + f + m - 2f\sin^2\varphi)
    #
    # Source: [NIMA2000]_ ch. 4, to the second order of h/a.
    flattening = EARTH_PLANET.flattening
    sine = np.sin(latitude)
    linear = 1.0 + flattening + CENTRIFUGAL - 2.0 * flattening * sine**2
    radius = EARTH_PLANET.equatorial_radius / linear
    flat = geopotential / normal_gravity(sine)
    return radius * flat / (radius - flat)


def hydrostatic_geopotential(log_level: np.ndarray, temperature: np.ndarray) -> np.ndarray:
    """Geopotential of levels [m²/s²] from their temperature, shape (t, z, y, x) [K].

    ``log_level``: negative logarithm of their pressures in Pa, increasing. The lowest lies where
    the US Standard Atmosphere has it.
    """
    standard = np.log(np.asarray(US1976().pressure(_SEARCHED)))
    lowest = np.interp(log_level[0], -standard, _SEARCHED)
    base = constants.STANDARD_GRAVITY * _RADIUS * lowest / (_RADIUS + lowest)
    mean = 0.5 * (temperature[:, 1:] + temperature[:, :-1])
    thickness = GAS_CONSTANT * mean * np.diff(log_level)[:, None, None]
    above = np.cumsum(thickness, axis=1)
    return base + np.concatenate([0.0 * above[:, :1], above], axis=1)


def new_levels(mean: np.ndarray, low: float, high: float) -> np.ndarray:
    """Levels [m] that are the same everywhere, from ``low`` to ``high``; ``mean``: of the file's.

    They are to lie between the highest place of the lowest level and the lowest of the highest.
    """
    places = np.arange(_BETWEEN * (mean.size - 1) + 1) / _BETWEEN
    finer = np.interp(places, np.arange(mean.size), mean)
    return np.array([low, *finer[(finer > low + 1.0) & (finer < high - 1.0)], high])


def on_altitudes(
    altitude: np.ndarray, fields: list[np.ndarray], new: np.ndarray
) -> list[np.ndarray]:
    """Fields on new levels [m], shape (z,); each array but these (t, z, y, x)."""
    slopes = [_slopes(altitude, field) for field in fields]
    found = [np.empty((field.shape[0], new.size, *field.shape[2:])) for field in fields]
    for number, level in enumerate(new):
        below = (altitude <= level).sum(axis=1, keepdims=True) - 1
        below = np.clip(below, 0, altitude.shape[1] - 2)

        def end(values: np.ndarray, step: int, below: np.ndarray = below) -> np.ndarray:
            return np.take_along_axis(values, below + step, axis=1)[:, 0]

        width = end(altitude, 1) - end(altitude, 0)
        x = (level - end(altitude, 0)) / width
        rest = 1.0 - x
        for out, field, slope in zip(found, fields, slopes, strict=True):
            out[:, number] = (
                end(field, 0) * rest**2 * (1.0 + 2.0 * x)
                + end(field, 1) * x**2 * (1.0 + 2.0 * rest)
                + width * x * rest * (end(slope, 0) * rest - end(slope, 1) * x)
            )
    return found


def _slopes(altitude: np.ndarray, field: np.ndarray) -> np.ndarray:
    """Slope at each level of the parabola through it and its neighbours, over the altitude."""
    step = np.diff(altitude, axis=1)
    steep = np.diff(field, axis=1) / step
    if steep.shape[1] == 1:
        return np.concatenate([steep, steep], axis=1)
    before, after = step[:, :-1], step[:, 1:]
    inner = (steep[:, :-1] * after + steep[:, 1:] * before) / (before + after)
    first = 2.0 * steep[:, :1] - inner[:, :1]
    last = 2.0 * steep[:, -1:] - inner[:, -1:]
    return np.concatenate([first, inner, last], axis=1)
