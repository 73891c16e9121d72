"""Winds on pressure levels, put on altitudes by the geopotential or the temperature beside them."""

import math
from typing import Any

import numpy as np

from lightflyer.core import constants
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.units import scale_and_offset
from lightflyer.environment.atmosphere.earth import US1976
from lightflyer.environment.planet import EARTH_PLANET
from lightflyer.environment.wind.gradient import CENTRIFUGAL, normal_gravity
from lightflyer.environment.wind.layouts import called, unit_of
from lightflyer.numerics.interpolation import MOST_UNEVEN, share_of_next

GAS_CONSTANT = constants.GAS_CONSTANT_US1976 / constants.MOLAR_MASS_AIR  # of dry air [J/(kg K)]
_RADIUS = 6.356766e6  # of the Earth in the standard atmosphere [m]; [USSA1976]_
_BETWEEN = 2  # new levels for each of the file's
_FEWEST_LEVELS = 2
_MIXED = -math.log(0.1)  # above a pressure of 0.1 Pa air is lighter, and hot
_LAYER = 120.0, 400.0  # mean temperatures of layers of air [K]
_USUAL = 240.0  # that of all [K]
_MOST_OFF = 1.5  # by which logarithms of pressures differ from the standard atmosphere's
_NEAR = 1.6  # factor by which the air of a right unit may be off the usual one
_OF_HEIGHTS = {"m**2/s**2": 1.0, "m": constants.STANDARD_GRAVITY}
_OF_HEIGHTS |= {"km": 1e3 * _OF_HEIGHTS["m"], "ft": 0.3048 * _OF_HEIGHTS["m"]}
_OF_PRESSURES = {"Pa": 1.0, "hPa": 1e2, "kPa": 1e3}
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


def check_heights(dataset: Any, log_level: np.ndarray, fields: dict[str, np.ndarray]) -> None:
    """Raise where heights contradict pressures, in which case one of them has a wrong unit.

    ``log_level``: as above; ``fields``: geopotential [m²/s²] or height [m], shape (t, z, y, x).
    """
    name = "geopotential" if "geopotential" in fields else "height"
    scale = 1.0 if name == "geopotential" else constants.STANDARD_GRAVITY
    known = (log_level <= _MIXED) & np.isfinite(fields[name]).any(axis=(0, 2, 3))
    if known.sum() < _FEWEST_LEVELS:
        return
    level, geopotential = log_level[known], scale * np.nanmean(fields[name][:, known], (0, 2, 3))
    layers = np.diff(geopotential) / (GAS_CONSTANT * np.diff(level))  # mean temperatures [K]
    standard = -np.log(np.asarray(US1976().pressure(_SEARCHED)))
    height = geopotential / constants.STANDARD_GRAVITY
    off = float(np.median(level - np.interp(height, _SEARCHED, standard)))
    is_air = bool(np.all((layers > _LAYER[0]) & (layers < _LAYER[1])))
    if is_air and abs(off) < _MOST_OFF:
        return
    wrong, unit = dataset["pressure" if is_air else name], "m" if scale > 1.0 else "m**2/s**2"
    units = _OF_PRESSURES if is_air else _OF_HEIGHTS
    factor = np.exp(off) if is_air else _USUAL / np.mean(layers)
    factor *= scale_and_offset(unit_of(wrong), "Pa" if is_air else unit)[0] * scale ** (not is_air)
    meant = [unit for unit, one in units.items() if 1.0 / _NEAR < one / factor < _NEAR]
    own = called(wrong)
    advice = [
        f'if {own} is in {unit}, set dataset["{own}"].attrs["units"] = "{unit}"' for unit in meant
    ]
    (least, most), (low, high) = np.exp(-level[[-1, 0]]) / 100.0, height[[0, -1]] / 1e3
    from_, to = np.interp(level[[0, -1]], standard, _SEARCHED) / 1e3
    raise ConfigurationError(
        f"winds: {called(dataset[name])} puts {most:.4g} to {least:.4g} hPa at {low:.3g} to "
        f"{high:.3g} km, where the standard atmosphere has {from_:.3g} to {to:.3g} km; "
        f"{(*advice, 'check its units and those of the pressures')[0]}"
    )


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
    room = np.gradient(finer) / MOST_UNEVEN  # or the slopes at the ends would rest on little
    return np.array([low, *finer[(finer > low + room) & (finer < high - room)], high])


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
    after = share_of_next(step[:, :-1], step[:, 1:])
    inner = (1.0 - after) * steep[:, :-1] + after * steep[:, 1:]
    first = 2.0 * steep[:, :1] - inner[:, :1]
    last = 2.0 * steep[:, -1:] - inner[:, -1:]
    return np.concatenate([first, inner, last], axis=1)
