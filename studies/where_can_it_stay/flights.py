"""Many flights of disks together, and whether a disk stays aloft.

A level disk without horizontal wind moves up and down alone, so that two of its flights never
cross: the altitude a day later grows with the altitude now. A disk whose season stands still thus
stays aloft for ever if and only if there is an altitude from which one day takes it back to that
altitude or higher. The largest gain of a day over all altitudes decides.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

import lightflyer as lf
from lightflyer.core.clock import seconds_of
from lightflyer.environment import Daylight, Place, UniformGround, UniformWind
from lightflyer.mission.fleet import Flights, fly_all
from lightflyer.mission.path.attitude import AbstractAttitudeRule, Level
from lightflyer.mission.path.integration import Accuracy, Limits, Start
from lightflyer.mission.path.motion import Vehicle

DAY = 86_400.0
LIMITS = Limits(20e3, 149e3)
NOONS = np.arange(46e3, 82.1e3, 3e3)  # altitudes at noon from which a day is flown [m]
CLOSER = np.array([-2.0, -1.0, 1.0, 2.0]) * 1e3  # around the best of these
RATIO, HALVINGS = 1.6, 4
SIZES = 0.5e-3 * RATIO ** np.arange(9)  # metres, to 21 mm
RATIOS = np.array([0.0, 0.4, 0.8, 1.2, 1.6, 2.0])  # of payload to film
TOLERANCE = 1e-7
KINETIC, LEVEL = lf.Kinetic(), Level()
FILM = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)


@dataclass(frozen=True)
class Case:
    """What is the same for all flights."""

    name: str = "as stated"
    model: lf.AbstractForceModel = KINETIC
    albedo: float = 0.29
    wind_up: float = 0.0
    rule: AbstractAttitudeRule = LEVEL
    film: lf.FilmProperties = FILM

    def but(self, name, **changes):
        """The same case but for some of it."""
        return replace(self, name=name, **changes)

    @cached_property
    def environment(self):
        """Earth with sun, ground and vertical wind."""
        sky = Daylight(ground=UniformGround(albedo=self.albedo))
        start, stop = seconds_of("2026-01-01T00:00Z"), seconds_of("2027-03-01T00:00Z")
        wind = UniformWind(0.0, 0.0, self.wind_up)
        return lf.Earth(sky=sky.over(start, stop), wind=wind)


@dataclass(frozen=True)
class Disks:
    """Disks and their releases; all of one shape."""

    diameter: np.ndarray  # [m]
    latitude: np.ndarray  # [degrees]
    date: np.ndarray  # [s since 2000-01-01 12:00 UTC]
    altitude: np.ndarray  # [m]
    areal_density: np.ndarray  # [kg/m2]
    payload: np.ndarray  # [kg]


def disks(diameter, latitude, date, altitude, areal_density=FILM.areal_density, payload=0.0):
    """Disks of numbers that broadcast."""
    rows = np.broadcast_arrays(diameter, latitude, date, altitude, areal_density, payload)
    return Disks(*(row.astype(float) for row in rows))


def fly(case, flown, days=1, every=None):
    """Altitudes of disks without horizontal wind [m], NaN after the end of a flight.

    The shape is that of the disks and the times ``every`` so many seconds, the last one replaced
    by the altitude of the end.
    """
    diameter, latitude, date, altitude, density, payload = map(np.ravel, vars(flown).values())
    film = replace(case.film, areal_density=density[:, None])
    flyer = lf.Disk(film, radius=0.5 * diameter[:, None], payload=payload[:, None])
    vehicle = Vehicle(lf.Setup(flyer, case.environment, case.model), case.rule)
    start = Start(altitude, Place(np.radians(latitude), 0.0 * latitude, date))
    length = days * DAY
    elapsed = np.linspace(0.0, length, round(length / (every or length)) + 1)
    accuracy = Accuracy.for_duration(length, TOLERANCE)
    found = fly_all(Flights(vehicle, start), LIMITS, elapsed, accuracy)
    altitude = np.column_stack([found.altitude[:, :-1], found.end_altitude])
    return np.where(np.isfinite(altitude), altitude, np.nan).reshape(*flown.diameter.shape, -1)


def largest_gain(case, diameter, latitude, date, **others):
    """Largest altitude gained from one noon to the next over all altitudes at the first [m].

    Numbers broadcast; ``others`` are areal densities and payloads.
    """
    numbers = np.broadcast_arrays(diameter, latitude, date, *others.values())
    numbers = [number[..., None] for number in numbers]
    others = dict(zip(others, numbers[3:], strict=True))

    def gained(noons):
        return fly(case, disks(*numbers[:3], noons, **others))[..., -1] - noons

    first = gained(NOONS)
    around = NOONS[np.argmax(first, axis=-1)][..., None] + CLOSER
    return np.maximum(first.max(axis=-1), gained(around).max(axis=-1))


def largest(stays, coarse, count):
    """Largest of some numbers for which something stays aloft, by bisection beyond ``coarse``.

    ``stays(number, rows)`` takes an array of shape (rows, numbers) or (1, numbers) and the numbers
    of the rows, of which there are ``count``. NaN where none of ``coarse`` stays.
    """
    found = stays(coarse[None, :], np.arange(count))
    last = coarse.size - 1 - np.argmax(found[:, ::-1], axis=1)
    some = np.flatnonzero(found.any(axis=1))
    low = coarse[last[some]]
    high = np.append(coarse, coarse[-1])[last[some] + 1]
    for _ in range(HALVINGS if some.size else 0):
        middle = 0.5 * (low + high)
        up = stays(middle[:, None], some)[:, 0]
        low, high = np.where(up, middle, low), np.where(up, high, middle)
    result = np.full(count, np.nan)
    result[some] = low
    return result


def largest_size(case, latitude, date, areal_density):
    """Largest diameter of SIZES that stays aloft [m]; some smaller disks may not stay.

    Latitudes and dates broadcast to the shape of the result.
    """
    latitude, date = np.broadcast_arrays(latitude, date)
    places = latitude.ravel()[:, None], date.ravel()[:, None]

    def stays(diameter, rows):
        here = (place[rows] for place in places)
        return largest_gain(case, diameter, *here, areal_density=areal_density) >= 0.0

    return largest(stays, SIZES, latitude.size).reshape(latitude.shape)


def largest_payload(case, diameter, latitude, dates, areal_density):
    """Largest payload that stays aloft at all of some dates [kg]; sizes, latitudes broadcast."""
    diameter, latitude = np.broadcast_arrays(diameter, latitude)
    wide, places = diameter.ravel()[:, None], latitude.ravel()[:, None]
    film = areal_density * 0.25 * np.pi * wide**2

    def stays(ratio, rows):
        payload = (ratio * film[rows])[..., None]
        here = wide[rows][..., None], places[rows][..., None], dates
        gain = largest_gain(case, *here, areal_density=areal_density, payload=payload)
        return (gain >= 0.0).all(axis=-1)

    found = largest(stays, RATIOS, diameter.size) * film[:, 0]
    return found.reshape(diameter.shape)
