r"""Gravity waves and tides: air that rises and falls, and is warmer and colder, along a flight.

Waves move a layer of air up by :math:`\zeta`, which cools it as it expands. At some altitude the
temperature differs by

.. math::
    \frac{T'}{T} = \tau = -\frac{N^2}{g}\zeta

for the buoyancy frequency :math:`N`. A wave of intrinsic frequency :math:`\omega` and vertical
wavenumber :math:`m`, whose energy goes up, is :math:`\tau\propto\cos(\omega t+mz+\varphi)`. Air
moves at :math:`w=\partial\zeta/\partial t` and along the ground at :math:`u=wN/\omega`, and its
pressure differs by :math:`p'/p=\int\tau\,dz/H` (linear theory, without the planet's rotation). A
flyer drifts with the air, so it meets waves at their intrinsic frequencies.

Temperatures by gravity waves grow from 0.5 K at 20 km to 8 K at 100 km, with vertical wavelengths
of 10 km to 20 km, and in winter they may be twice those in summer [Rauthe2008]_. Their energy falls
with the frequency as :math:`\omega^{-5/3}` [Manson1999]_. Tides of 24 h and 12 h make 30 % to 50 %
of all fluctuations [Luebken2008]_. They are given random phases: those of the mean tides of
NRLMSIS, 1 K to 4 K from 60 km to 80 km, turn within ten kilometres and with season and latitude,
and where ozone warms the air its temperature does not tell how far it has risen.

Flyers that fly together meet the same waves. The phase at a flyer lags by
:math:`k\cdot(x - x_0)`, with :math:`k = m\omega/N` along the heading and the place :math:`x_0` of
the flyer as it is stated, which goes with the same wind and waves.

What is not known about the wind, as smooth random functions of time.

The horizontal error is a vector in the planet's frame, seen along the ground, so that poles are
nothing special. Each component is a sum of waves whose frequencies are normal around zero with the
width :math:`1/\tau`, and whose amplitudes are normal too. Over an ensemble it is normal with the
covariance :math:`\sigma^2\exp(-t^2/2\tau^2)` [RahimiRecht2007]_.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module
from lightflyer.environment.base import EnvironmentState, Place, Wind
from lightflyer.environment.planet import EARTH_PLANET
from lightflyer.mission.areas import directions, unit_vector
from lightflyer.numerics.interpolation import Spline

_LOWEST, _HIGHEST = (20e3, 0.5), (100e3, 8.0)  # Altitude [m] and temperature by gravity waves [K]
_WAVELENGTHS = 10e3, 20e3  # Vertical, of gravity waves [m]
_TIDAL_WAVELENGTHS = 25e3, 60e3  # from memory; the shorter that of the diurnal tide's first mode
_TIDES = 2.0 * np.pi / 86_400.0 * np.array([1.0, 2.0])  # rad/s
_TIDAL_SHARE = 0.4  # Of the sum of both temperatures
_SPREAD = 0.4  # Of the logarithm of a member's amplitude: seasons and places

_LONGEST_PERIOD, _SHORTEST_PERIOD = 86_400.0, 1800.0
"""Periods of the waves that a flight meets [s]. Shorter ones move air by 100 m at 80 km (root of
the mean square), and would need short steps."""

_BUOYANCY_FREQUENCY = 0.02
"""[rad/s]; between 0.017 and 0.022 from 20 km to 90 km of the US Standard Atmosphere."""

_SCALE_HEIGHT = 7e3  # m
_COUNT = 8  # Gravity waves of one flight


class Tides(NamedTuple):
    """What an environment has of the tides itself, which waves leave out."""

    winds: bool = False  # Along the ground
    warmth: bool = False  # And pressure


NO_TIDES = Tides()


class Waves(Module):
    """Waves along flights; zeros are still air."""

    frequencies: Numeric  # shape (..., waves); [rad/s]
    wavenumbers: Numeric  # shape (..., waves); [rad/m]
    cosines: Numeric  # shape (..., waves); over the climatology's temperature [1]
    sines: Numeric
    # shape (..., 3, waves); along which air moves, in the planet's frame, two of whose parts lie
    # along the ground [1]
    headings: Numeric
    reaches: Numeric  # shape (..., waves); pressure's share over that of temperature [1]
    warms: Numeric = 1.0  # shape (..., waves); zero where the atmosphere has the wave's warmth [1]
    # Unit vector of the middle of those who fly together, over the time since the release; None
    # where each has waves of its own
    middle: Spline | None = None

    def disturb(
        self, state: EnvironmentState, altitude: Numeric, place: Place, elapsed: Numeric
    ) -> EnvironmentState:
        """A state of the air with these waves; ``elapsed``: time since the release [s]."""
        at, height = xp.asarray(elapsed)[..., None], xp.asarray(altitude)[..., None]
        phases = self.frequencies * at + self.wavenumbers * height
        if self.middle is not None:
            away = unit_vector(place.latitude, place.longitude) - self.middle(elapsed)
            # phase over the distance along each axis of the planet's frame, (..., waves, 3) [1]
            length = xp.sqrt(xp.sum(self.headings**2, axis=-2, keepdims=True))
            heading = self.headings / xp.where(length > 0.0, length, 1.0)
            wavenumbers = self.wavenumbers * self.frequencies / _BUOYANCY_FREQUENCY
            lags = xp.swapaxes(EARTH_PLANET.radius * wavenumbers[..., None, :] * heading, -1, -2)
            phases = phases - (lags @ away[..., None])[..., 0]
        cosine, sine = xp.cos(phases), xp.sin(phases)
        size = temperature_by_gravity_waves(altitude) / state.temperature
        warmer = size * xp.sum(self.warms * (self.cosines * cosine + self.sines * sine), axis=-1)
        quarter = self.sines * cosine - self.cosines * sine  # a quarter of a wave ahead
        lift = -size * state.gravity / _BUOYANCY_FREQUENCY**2
        up = lift * xp.sum(self.frequencies * quarter, axis=-1)
        along = (
            lift
            * _BUOYANCY_FREQUENCY
            * xp.moveaxis(xp.sum(self.headings * quarter[..., None, :], axis=-1), -1, 0)
        )
        east, north = (
            sum(one * other for one, other in zip(along, xp.moveaxis(to, -1, 0), strict=True))
            for to in directions(place.latitude, place.longitude)
        )
        wind = Wind(0.0, 0.0, 0.0) if state.wind is None else state.wind
        moved = Wind(wind.east + east, wind.north + north, wind.up + up)
        return replace(
            state,
            temperature=state.temperature * (1.0 + warmer),
            pressure=state.pressure * (1.0 - size * xp.sum(self.reaches * quarter, axis=-1)),
            wind=moved,
        )


def temperature_by_gravity_waves(altitude: Numeric) -> Array:
    """Root of the mean square of the temperature that they add [K]; ``altitude`` [m]."""
    (low, least), (high, most) = _LOWEST, _HIGHEST
    share = xp.clip((altitude - low) / (high - low), -0.5, 1.25)
    return least * (most / least) ** share


def draw_waves(count: int, scale: float, seed: int, known: Tides = NO_TIDES) -> Waves:
    """Waves of many flights, each with its own; ``scale``: their size over the climatology's."""
    generator = np.random.default_rng(seed)
    longest, shortest = 2.0 * np.pi / _LONGEST_PERIOD, 2.0 * np.pi / _SHORTEST_PERIOD
    edges = np.geomspace(longest, shortest, _COUNT + 1)
    parts = np.diff(-(edges ** (-2.0 / 3.0)))  # of the energy, by the integral of its spectrum
    parts /= longest ** (-2.0 / 3.0) - _BUOYANCY_FREQUENCY ** (-2.0 / 3.0)
    places = generator.random((count, _COUNT))
    frequencies = edges[:-1] * (edges[1:] / edges[:-1]) ** places
    tides = np.tile(_TIDES, (count, 1))
    tidal = (_TIDAL_SHARE / (1.0 - _TIDAL_SHARE)) ** 2 / _TIDES.size
    amplitudes = np.sqrt(np.append(parts, np.full(_TIDES.size, tidal)))
    sizes = np.exp(_SPREAD * generator.standard_normal((count, 1)) - _SPREAD**2)  # mean square 1
    amplitudes = scale * sizes * amplitudes
    lengths = [
        low * (high / low) ** generator.random((count, number))
        for (low, high), number in ((_WAVELENGTHS, _COUNT), (_TIDAL_WAVELENGTHS, _TIDES.size))
    ]
    wavenumbers = 2.0 * np.pi / np.concatenate(lengths, axis=1)
    shape = wavenumbers.shape
    winds, warms = np.ones(shape[1]), np.ones(shape)
    winds[_COUNT:], warms[:, _COUNT:] = not known.winds, not known.warmth
    return Waves(
        np.concatenate([frequencies, tides], axis=1),
        wavenumbers,
        amplitudes * generator.standard_normal(shape),
        amplitudes * generator.standard_normal(shape),
        winds * np.sqrt(0.5) * generator.standard_normal((count, 3, shape[1])),
        warms / (wavenumbers * _SCALE_HEIGHT),
        warms,
    )


def describe_waves(scale: float, known: Tides, *, together: bool) -> str:
    """What is assumed about the air's waves, in words."""
    parts = [
        text for has, text in zip(known, ("wind", "temperature and pressure"), strict=True) if has
    ]
    remarks = f"; {' and '.join(parts)} by tides are the environment's own" if parts else ""
    remarks += (
        "; the same for all members, by distance from one that is as stated" if together else ""
    )
    sizes = [scale * float(temperature_by_gravity_waves(height)) for height in (60e3, 80e3)]
    return (
        f"waves: gravity waves of ± {sizes[0]:.2g} K at 60 km and ± {sizes[1]:.2g} K at 80 km, "
        f"tides of {100.0 * _TIDAL_SHARE:.0f} % of both, with the rise and fall, wind and pressure "
        f"that belong to them; periods of {_SHORTEST_PERIOD / 60.0:.0f} min to "
        f"{_LONGEST_PERIOD / 3600.0:.0f} h{remarks}"
    )


_ERROR_WAVES = 6  # Frequencies of one flight


class WindError(Module):
    """Difference of the wind from the environment's, along flights."""

    frequencies: Numeric  # shape (..., waves); [rad/s]
    # shape (..., 4, waves); amplitudes of the components along the axes of the planet's frame, and
    # up [m/s]
    cosines: Numeric
    sines: Numeric

    def add_to_wind(self, wind: Wind, place: Place, elapsed: Numeric) -> Wind:
        """A wind with this error; ``elapsed``: time since the release."""
        phases = self.frequencies * xp.asarray(elapsed)[..., None]
        cosine, sine = xp.cos(phases)[..., None, :], xp.sin(phases)[..., None, :]
        *along, up = xp.moveaxis(xp.sum(self.cosines * cosine + self.sines * sine, axis=-1), -1, 0)
        east, north = (
            sum(one * other for one, other in zip(along, xp.moveaxis(to, -1, 0), strict=True))
            for to in directions(place.latitude, place.longitude)
        )
        return Wind(wind.east + east, wind.north + north, wind.up + up)


def draw_wind_errors(
    count: int, horizontal: float, vertical: float, correlation_time: float, seed: int
) -> WindError:
    """Random errors of the wind, one for each flight."""
    generator = np.random.default_rng(seed)
    spread = np.array([horizontal] * 3 + [vertical])[:, None] / _ERROR_WAVES**0.5
    return WindError(
        generator.standard_normal((count, _ERROR_WAVES)) / correlation_time,
        spread * generator.standard_normal((count, 4, _ERROR_WAVES)),
        spread * generator.standard_normal((count, 4, _ERROR_WAVES)),
    )
