"""Atmospheres of Mars: a profile of temperature in hydrostatic equilibrium."""

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import field
from lightflyer.core import constants
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import Altitude, Checked, Pressure, TemperatureOffset
from lightflyer.core.text import span
from lightflyer.environment.base import AbstractAtmosphere, Place
from lightflyer.environment.planet import MARS_PLANET
from lightflyer.files.table import shipped_table
from lightflyer.numerics.interpolation import Spline

SURFACE_PRESSURE = 636.0
"""At the areoid, mean of the northern summer [Pa]; [Seiff1982]_ as in [Pitts1990]_ table XI.

Within a Martian year it varies by some 15 %, because the polar caps take up and give off carbon
dioxide.
"""

SURFACE_PRESSURE_SPREAD, TEMPERATURE_SPREAD = 60.0, 6.0
"""Standard deviations that stand for weather and season [Pa], [K]; see the page about Mars."""

MOLAR_MASS = 43.49  # Mean molar mass [kg/kmol]; [Seiff1982]_

_GAS_CONSTANT = 1e3 * constants.BOLTZMANN * constants.AVOGADRO  # [J/(kmol K)]
_METRES_PER_KILOMETRE = 1e3
COSPAR = "northern summer of Mars by COSPAR"  # Name of the default profile

_TOP = 130e3  # of the default profile [m]
_FEWEST_ROWS = 4

# Gauss-Legendre nodes and weights on 0 to 1, for the hydrostatic integral between table rows
_NODES, _WEIGHTS = (
    0.5 * (values + offset)
    for values, offset in zip(np.polynomial.legendre.leggauss(3), (1.0, 0.0), strict=True)
)


def _monotone(altitude: np.ndarray, temperature: np.ndarray) -> Spline:
    """Cubic that does not overshoot between rows."""
    from scipy.interpolate import PchipInterpolator  # slow to import, as in Spline

    slopes = PchipInterpolator(altitude, temperature).derivative()(altitude)
    return Spline.hermite(altitude, temperature, slopes)


@cache
def cospar_profile() -> Spline:
    """Temperature of the reference atmosphere of COSPAR, 0 to 130 km [K]."""
    rows = shipped_table("mars_cospar.csv").numbers
    return _monotone(rows["altitude_km"] * _METRES_PER_KILOMETRE, rows["temperature"])


class MarsAtmosphere(Checked, AbstractAtmosphere):
    r"""Air of Mars: a profile of temperature, and the pressure that carries what is above.

    .. math:: p(h) = p_0 \exp\left(-\int_0^h
        \frac{M g(h')}{R^*\,[T(h') + \Delta T]}\,\mathrm dh'\right)

    Attributes
    ----------
    profile : Spline
        Temperature over altitude [K], from 0 m up; default the reference atmosphere of COSPAR.
    surface_pressure : array
        :math:`p_0` at altitude 0 [Pa].
    temperature_offset : array
        :math:`\Delta T`, added everywhere [K]. Its uncertainty, and that of the surface pressure,
        stand for weather and season.
    molar_mass : array
        M [kg/kmol], the same at all altitudes.
    top : float
        Altitude at which the profile ends [m].
    name : str
        What results call the profile.

    Raises
    ------
    ParameterError
        If a concrete number is out of range.

    Notes
    -----
    Differentiable in altitude and in every number; the temperature once continuously, the
    logarithm of pressure twice. Hydrostatic to 1e-6 with the planet's gravity. The default's
    pressures agree with those of the source's own table, which has three digits, within 1.3 % up
    to 100 km. Altitudes count from the areoid, where the mean pressure is about 610 Pa; the ground
    lies between 8 km below it and 21 km above.

    References
    ----------
    [Seiff1982]_, as tabulated by [Pitts1990]_ table XI.

    Examples
    --------
    >>> air = MarsAtmosphere()
    >>> print(f"{air.temperature(50e3):.1f} K, {air.pressure(50e3):.2f} Pa")
    152.2 K, 3.16 Pa
    """

    profile: Spline = field(default_factory=cospar_profile)
    surface_pressure: Pressure = SURFACE_PRESSURE
    temperature_offset: TemperatureOffset = 0.0
    molar_mass: Numeric = MOLAR_MASS
    top: float = field(static=True, default=_TOP)
    name: str = field(static=True, default=COSPAR)

    @classmethod
    def from_table(
        cls,
        altitude: ArrayLike,
        temperature: ArrayLike,
        surface_pressure: float,
        molar_mass: float = MOLAR_MASS,
        name: str = "a profile of its own",
    ) -> "MarsAtmosphere":
        """Atmosphere with a profile of one's own, such as one of the Mars Climate Database."""
        altitudes, kelvin = np.asarray(altitude, float), np.asarray(temperature, float)
        if altitudes.ndim != 1 or altitudes.shape != kelvin.shape or altitudes.size < _FEWEST_ROWS:
            raise ParameterError(
                f"altitude and temperature must be {_FEWEST_ROWS} numbers or more, as many of each"
            )
        if altitudes[0] != 0.0 or not np.all(np.diff(altitudes) > 0.0):
            raise ParameterError("altitude must increase from 0 m")
        if not np.all(np.isfinite(kelvin) & (kelvin > 0.0)):
            raise ParameterError("temperature must be positive")
        profile, top = _monotone(altitudes, kelvin), float(altitudes[-1])
        return cls(profile, surface_pressure, molar_mass=molar_mass, top=top, name=name)

    @property
    def altitude_range(self) -> tuple[float, float]:
        """0 m to the top of the profile, by default 130 km."""
        return 0.0, self.top

    def describe(self) -> str:
        return (
            f"atmosphere: {self.name}, {span(self.surface_pressure)} Pa at altitude 0, "
            f"{span(self.temperature_offset)} K added, the same everywhere and always"
        )

    @entry_point
    def temperature(self, altitude: Altitude, place: Place | None = None) -> Any:
        return self._nan_outside(altitude, self.profile(altitude) + self.temperature_offset)

    @entry_point
    def pressure(self, altitude: Altitude, place: Place | None = None) -> Any:
        # integral of g/T from altitude 0 [m²/(s² K)]
        nodes, offset = xp.asarray(self.profile.nodes), xp.asarray(self.temperature_offset)
        start, width = nodes[:-1, None], xp.diff(nodes)[:, None]
        between, offsets, of_offset = start + _NODES * width, offset, None
        if isinstance(offset, np.ndarray) and offset.ndim:  # the same for many altitudes
            offsets, of_offset = np.unique(offset, return_inverse=True)
        whole = self._integrand(between, offsets[..., None, None]) * _WEIGHTS * width
        below = xp.cumsum(xp.sum(whole, axis=-1), axis=-1)
        below = xp.concatenate([xp.zeros_like(below[..., :1]), below[..., :-1]], axis=-1)
        piece = xp.clip(xp.searchsorted(nodes, altitude, side="right") - 1, 0, nodes.size - 2)
        rest = (altitude - nodes[piece])[..., None]
        within = nodes[piece][..., None] + _NODES * rest
        partial = xp.sum(self._integrand(within, offset[..., None]) * _WEIGHTS * rest, axis=-1)
        shape = xp.broadcast_shapes(xp.shape(offset), xp.shape(altitude))
        if offset.ndim == 0:
            below = below[piece]
        elif of_offset is not None:
            row = np.broadcast_to(of_offset.reshape(offset.shape), shape)
            below = below[row, xp.broadcast_to(piece, shape)]
        else:
            rows = xp.broadcast_to(below, (*shape, below.shape[-1]))
            piece = xp.broadcast_to(piece, shape)[..., None]
            below = xp.take_along_axis(rows, piece, axis=-1)[..., 0]
        exponent = self.molar_mass / _GAS_CONSTANT * (below + partial)
        return self._nan_outside(altitude, self.surface_pressure * xp.exp(-exponent))

    @entry_point
    def molar_mass_ratio(self, altitude: Altitude, place: Place | None = None) -> Any:
        """One: the composition is the same at all altitudes."""
        return self._nan_outside(altitude, xp.ones_like(altitude))

    def _integrand(self, altitude: Array, offset: Array) -> Array:
        return MARS_PLANET.gravity_at(altitude) / (self.profile(altitude) + offset)
