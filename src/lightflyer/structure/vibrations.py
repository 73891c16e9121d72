"""Lowest frequencies of plates, membranes and spheres, in vacuum if not said otherwise."""

import math

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point

_LOWEST_MEMBRANE = 2.404825557695773  # the first zero of the Bessel function J₀
_LOWEST_SHEAR = 3.054236928227140  # the first zero of the derivative of J₂
_SADDLE = 2.0  # waves around a sphere, of its lowest mode
_RAYLEIGH = _SADDLE * (_SADDLE**2 - 1.0)  # its changes of curvature, over tan²(θ/2)/sin²θ


def _gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Places from 0 to 1 and their weights, for integrals."""
    node, weight = np.polynomial.legendre.leggauss(count)
    return 0.5 * (1.0 + node), 0.5 * weight


_AREAS, _MERIDIAN = _gauss(12), _gauss(24)
UMBRELLA_PLACES = np.sqrt(_AREAS[0])
"""Distances from the middle over a plate's radius, for its mean over the area."""


@entry_point
def free_plate_frequency(
    radius: Numeric, areal_density: Numeric, stiffness: Numeric, poisson: Numeric
) -> Array:
    """Lowest frequency of a free round plate [Hz], whose edge then bends as a saddle."""
    # Ritz's method with (1, r²) r² cos 2φ: 0.4 % above the exact frequency [Leissa1969].
    across = (19.0 + poisson) / 5.0
    square = 480.0 * (across - xp.sqrt(across**2 - 0.2 * (3.0 + poisson) * (1.0 - poisson)))
    return xp.sqrt(square * stiffness / areal_density) / (2.0 * math.pi * radius**2)


@entry_point
def free_shear_frequency(
    radius: Numeric, areal_density: Numeric, shear_stiffness: Numeric
) -> Array:
    """The same of a plate that only shears [Hz]; stiffness [N/m]."""
    return _LOWEST_SHEAR / (2.0 * math.pi * radius) * xp.sqrt(shear_stiffness / areal_density)


@entry_point
def umbrella_frequency(
    profile: Numeric, ring: Numeric, own_mass: Numeric, payload: Numeric
) -> Array:
    r"""Frequency at which a plate and a payload on a ring of it move against each other [Hz].

    ``profile``: rise at :data:`UMBRELLA_PLACES`, on the last axis, and ``ring``: on the ring, per
    load [m/N]; masses [kg].
    """
    # Rayleigh's quotient of the form under a static load, with the centre of mass at rest. A plate
    # held in its middle is 0.6 % above the exact frequency.
    weights = xp.asarray(_AREAS[1])
    mean = xp.sum(weights * profile, axis=-1)
    square = xp.sum(weights * profile**2, axis=-1)
    shift = -(own_mass * mean + payload * ring) / (own_mass + payload)
    inertia = own_mass * (square + shift * (2.0 * mean + shift)) + payload * (ring + shift) ** 2
    return xp.sqrt((mean - ring) / inertia) / (2.0 * math.pi)


@entry_point
def membrane_frequency(radius: Numeric, areal_density: Numeric, tension: Numeric) -> Array:
    """Lowest frequency of a round membrane that is held at its edge [Hz]; ``tension`` [N/m]."""
    return _LOWEST_MEMBRANE / (2.0 * math.pi * radius) * xp.sqrt(tension / areal_density)


@entry_point
def sphere_frequency(
    radius: Numeric,
    areal_density: Numeric,
    membrane: Numeric,
    poisson: Numeric,
    gas_density: Numeric = 0.0,
) -> Array:
    r"""Lowest frequency of a whole thin sphere, which stretches [Hz].

    ``membrane``: :math:`Et` [N/m]; ``gas_density``: of gas within and around, which moves along
    [kg/m³].
    """
    # Lamb's equation, .. math:: (1-\nu^2)x^2 - (7+3\nu)x + 4 = 0, \qquad x = m\omega^2R^2/(Et)
    # of two waves [Leissa1973]; gas adds ρR/2 within and ρR/3 outside to the mass per area.
    half, squared = 0.5 * (7.0 + 3.0 * poisson), 1.0 - poisson**2
    root = 4.0 / (half + xp.sqrt(half**2 - 4.0 * squared))
    moved = gas_density * radius * (1.0 / _SADDLE + 1.0 / (_SADDLE + 1.0))
    return xp.sqrt(root * membrane / (areal_density + moved)) / (2.0 * math.pi * radius)


@entry_point
def open_sphere_frequency(
    radius: Numeric, opening: Numeric, areal_density: Numeric, plate: Numeric, poisson: Numeric
) -> Array:
    r"""Lowest frequency of a sphere with a round opening, which bends without stretching [Hz].

    ``opening``: its radius [m]; ``plate``: bending stiffness [N m].
    """
    # Rayleigh's displacements tan²(θ/2) (sin θ cos 2φ, -sin θ sin 2φ, (2 + cos θ) cos 2φ), θ from
    # the point opposite the opening [Rayleigh1894]. All strain is change of curvature and twist.
    share = opening / xp.asarray(radius)
    end = np.pi - xp.arcsin(share)
    nodes, weights = map(xp.asarray, _MERIDIAN)
    angle = end[..., None] * nodes
    sine, grows = xp.sin(angle), xp.tan(0.5 * angle) ** _SADDLE
    bent = xp.sum(weights * grows**2 / sine**3, axis=-1)
    moves = (2.0 + xp.cos(angle)) ** 2 + 2.0 * sine**2
    moved = xp.sum(weights * grows**2 * moves * sine, axis=-1)
    energy = 4.0 * (1.0 - poisson) * _RAYLEIGH**2 * plate * bent
    return xp.sqrt(energy / (areal_density * moved)) / (2.0 * math.pi * radius**2)
