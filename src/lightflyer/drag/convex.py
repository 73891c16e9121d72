r"""Drag of closed convex bodies in gas of any density: spheres exactly, others by their outline.

Drag is written as :math:`F = G\,p\,A\,s` as in :mod:`lightflyer.drag.disk`, with the silhouette
:math:`A` along the motion, and

.. math::
    \frac1G = \frac1{G_\mathrm{fm}} + \frac{b}{G_\mathrm{d}}, \qquad
    G_\mathrm{d} = \frac{6\pi\,a_d\,r}{A\,\delta}\,\Phi(\mathrm{Re})\,\frac{\mu_f}{\mu}, \qquad
    b = 1 - A_2\,\mathrm{Kn}\left(1 - e^{-A_3/\mathrm{Kn}}\right)

- To **free molecules** every part of the surface is known; what it needs is the area and
  :math:`\oint\nu^2\,dA` with the cosine :math:`\nu` between normal and motion.
- In **dense gas** the body is a sphere whose diameter is one third that of the circle of its
  silhouette and two thirds that of the sphere of its surface [Leith1987]_.
- **Between** it is Cunningham's law of a sphere, with :math:`A_1` from slip at the wall and
  :math:`A_1 + A_2` from free molecules.
"""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import short_repr
from lightflyer.core.entry_point import entry_point
from lightflyer.drag import free_molecular
from lightflyer.drag.similarity import (
    SLOW,
    SPHERE_REYNOLDS,
    THIN,
    WARMTH,
    molecular_speed,
    rarefaction_parameter,
    reynolds_number,
    sphere_inertia,
    viscosity_growth,
)
from lightflyer.gas.base import AbstractGas

_SQRT_PI = math.sqrt(math.pi)
_STOKES = 6.0
_SLIP, _SLIP_OF_TAC = 1.018, 0.1211  # viscous slip [SharipovSeleznev1998]
_CUNNINGHAM_EXPONENT = 0.999  # A3 for Kn = λ/r, [AllenRaabe1985]
_LEITH_SILHOUETTE = 1.0 / 3.0  # the rest is that of the surface


class Outline(NamedTuple):
    r"""Outline of a closed convex body as it moves."""

    silhouette: Numeric  #: shape (...); area seen along the motion [m²]
    surface: Numeric  #: shape (...) [m²]
    #: shape (...); :math:`\oint\nu^2\,dA` with the cosine of normal and motion [m²]
    facing: Numeric

    def __repr__(self) -> str:
        return short_repr(self)

    @property
    def radius(self) -> Array:
        """Radius of the sphere that dense gas drags alike in slow flow [m]."""
        seen = xp.sqrt(xp.asarray(self.silhouette) / math.pi)
        around = 0.5 * xp.sqrt(xp.asarray(self.surface) / math.pi)
        return _LEITH_SILHOUETTE * seen + (1.0 - _LEITH_SILHOUETTE) * around


@entry_point
def sphere_outline(radius: Numeric) -> Outline:
    """Outline of a sphere."""
    square = np.pi * xp.asarray(radius) ** 2
    return Outline(square, 4.0 * square, 4.0 * square / 3.0)


@entry_point
def convex_drag(
    speed: Numeric,
    outline: Outline,
    pressure: Numeric,
    temperature: Numeric,
    gas: AbstractGas,
    tac: Numeric = 1.0,
    excess: Numeric = 0.0,
) -> Array:
    """Drag of a closed convex body [N]; force against the motion, of the sign of the speed."""
    # Differentiable, and odd in the speed. A sphere is within 3 % of measurements in slow flow, and
    # within 6 % at Reynolds numbers to 3e5. Other bodies are estimates: within about 10 % in slow
    # flow of dense gas, while at Reynolds numbers above 100 blunt ones have up to three times the
    # drag of a sphere.
    #
    # Source: [Epstein1924]_, [AllenRaabe1985]_, [Leith1987]_.
    radius = outline.radius
    speed_ratio = speed / molecular_speed(temperature, gas)
    delta = rarefaction_parameter(pressure, temperature, radius, gas)
    # what arrives grows with the speed as for a sphere
    across = xp.asarray(outline.surface) - outline.facing
    arriving = (2.0 - tac) * outline.facing + tac * 0.5 * across
    faster = free_molecular.sphere(speed_ratio, 0.0, 1.0) / free_molecular.sphere(0.0, 0.0, 1.0)
    leaving = 0.5 * _SQRT_PI * tac * xp.sqrt(1.0 + excess) * outline.facing
    thin = 2.0 / _SQRT_PI * arriving * faster + leaving
    width = xp.sqrt(outline.silhouette / math.pi)
    inertia = sphere_inertia(reynolds_number(speed_ratio, delta) * width / radius)
    growth = viscosity_growth(excess, delta, temperature, gas)
    dense = _STOKES * math.pi * radius**2 * inertia * growth / delta
    resistance = 1.0 / thin + cunningham_share(delta, tac) / dense
    return pressure * speed_ratio / resistance


def cunningham_share(rarefaction: Numeric, tac: Numeric) -> Array:
    """Share of the resistance of dense gas that a slow sphere meets [1]; one in dense gas."""
    tac = xp.asarray(tac)
    knudsen = 0.5 * _SQRT_PI / rarefaction  # by the radius
    slip = (2.0 - tac) / tac * (_SLIP - _SLIP_OF_TAC * (1.0 - tac)) * 2.0 / _SQRT_PI
    limit = 2.0 * _STOKES / (_SQRT_PI * free_molecular.sphere(0.0, tac, 1.0))
    return 1.0 + (limit - slip) * knudsen * xp.expm1(-_CUNNINGHAM_EXPONENT / knudsen)


def convex_diagnostics(
    speed: Numeric,
    outline: Outline,
    pressure: Numeric,
    temperature: Numeric,
    gas: AbstractGas,
    body_temperature: Numeric | None = None,
) -> Iterator[str]:
    """Where the drag of a convex body is outside its range, in words."""
    delta = rarefaction_parameter(pressure, temperature, outline.radius, gas)
    speed_ratio = np.abs(speed) / molecular_speed(temperature, gas)
    yield from SLOW.diagnostics(np.where(delta > THIN, speed_ratio, 0.0), pressure)
    yield from SPHERE_REYNOLDS.diagnostics(reynolds_number(speed_ratio, delta), pressure)
    if body_temperature is not None:
        excess = body_temperature / np.asarray(temperature) - 1.0
        yield from WARMTH.diagnostics(viscosity_growth(excess, delta, temperature, gas), pressure)
