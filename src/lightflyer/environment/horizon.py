r"""Light at the edges: the sun's disk at a horizon, the limb of a planet, the terminator below.

All of it is smooth in the sun's direction and in altitude, as trajectories need.

View factor from a plane face to the planet below it.

With the half-angle :math:`\gamma` of the planet's disk as seen from the flyer,
:math:`\sin\gamma = R/(R+h)`, a face that looks straight down sees the share
:math:`\sin^2\gamma` of it.
"""

from typing import Final

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.transformations import custom_jvp
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import Altitude, Checked, Length, Refractivity
from lightflyer.numerics.special import erf

_SMALLEST = 1e-12  # of sines and roots below, where a branch that is not taken would divide by zero


@entry_point
def ground_view_factor(angle: Numeric, straight_down: Numeric) -> Array:
    r"""View factor from a plane element to a sphere, for any orientation [1]."""
    # With :math:`s=\sin\gamma` and the angle :math:`\theta` between the face's normal and the
    # direction to the centre, :math:`F = s^2\cos\theta` as long as the whole sphere is in front of
    # the plane; between there and the angle at which all of it is behind,
    #
    # .. math::
    #     F = \frac1\pi\left[\frac\pi2 - \arcsin\frac{\cos\gamma}{\sin\theta}
    #         + s^2\cos\theta\,\arccos(-\cot\gamma\cot\theta)
    #         - \cos\gamma\sqrt{s^2-\cos^2\theta}\right]
    #
    # Differentiable but where the plane touches the sphere.
    #
    # Source: [Howell2010]_, differential planar element to a sphere, for any tilt.
    cosine, sine = xp.cos(angle), xp.sin(angle)
    away = 1.0 - straight_down  # cos²γ
    whole = straight_down * cosine
    cut = cosine**2 < straight_down
    root = xp.sqrt(xp.where(cut, xp.maximum(straight_down - cosine**2, _SMALLEST), 1.0))
    safe_sine = xp.where(cut, xp.maximum(sine, _SMALLEST), 1.0)
    far = xp.sqrt(xp.maximum(away, _SMALLEST))
    ratio = xp.clip(far / safe_sine, 0.0, 1.0)
    near = xp.sqrt(xp.maximum(straight_down, _SMALLEST))
    cotangents = xp.clip(-(far / near) * cosine / safe_sine, -1.0, 1.0)
    part = 0.5 * np.pi - xp.arcsin(ratio) + whole * xp.arccos(cotangents) - far * root
    return xp.where(cut, part / np.pi, xp.maximum(whole, 0.0))


@entry_point
def sphere_view_factor(straight_down: Numeric) -> Array:
    r"""View factor from a whole sphere to the planet, the mean over its surface [1]."""
    # .. math:: F = \frac{1 - \cos\gamma}2
    #
    # Differentiable but above an endless plane.
    #
    # Source: [Howell2010]_, sphere to sphere, the one much smaller than the other.
    endless = straight_down >= 1.0
    cosine = xp.where(endless, 0.0, xp.sqrt(xp.where(endless, 1.0, 1.0 - straight_down)))
    return 0.5 * (1.0 - cosine)


_SMOOTHED = 500.0  # altitude within which the horizon of a flyer near the limb is smoothed [m]

# Gauss-Legendre nodes and weights on 0 to 1, for the ground's distance from the horizon
_NODES, _WEIGHTS = (
    0.5 * (values + offset)
    for values, offset in zip(np.polynomial.legendre.leggauss(5), (1.0, 0.0), strict=True)
)


@custom_jvp
def _share_above(position: Array) -> Array:
    """Share of a unit disk beyond a straight edge at ``-position`` from its centre."""
    half_angle = xp.arccos(-xp.clip(position, -1.0, 1.0))
    return (half_angle - xp.sin(half_angle) * xp.cos(half_angle)) / np.pi


@_share_above.defjvp
def _share_above_slope(primals: tuple[Array], tangents: tuple[Array]) -> tuple[Array, Array]:
    (position,), (change,) = primals, tangents
    return _share_above(position), 2.0 / np.pi * _half_chord(position) * change


@custom_jvp
def _mean_above(position: Array) -> Array:
    """Mean of ``max(position + x, 0)`` over the points (x, y) of a unit disk."""
    lens = _half_chord(position) ** 3
    return position * _share_above(position) + lens * 2.0 / (3.0 * np.pi)


@_mean_above.defjvp
def _mean_above_slope(primals: tuple[Array], tangents: tuple[Array]) -> tuple[Array, Array]:
    (position,), (change,) = primals, tangents
    return _mean_above(position), _share_above(position) * change


def _half_chord(position: Array) -> Array:
    square = 1.0 - position**2
    inside = square > 0.0
    return xp.where(inside, xp.sqrt(xp.where(inside, square, 1.0)), 0.0)


@entry_point
def visible_share(elevation: Numeric, angular_radius: Numeric) -> Array:
    """Share of the sun's disk above a straight horizon [1]; zero to one."""
    # .. math:: \frac{\varphi - \sin\varphi\cos\varphi}{\pi},
    #     \qquad \cos\varphi = -\frac{\text{elevation}}{\text{angular radius}}
    #
    # The disk is evenly bright. Once continuously differentiable.
    return _share_above(elevation / angular_radius)


@entry_point
def facing_share(cosine: Numeric, angular_radius: Numeric) -> Array:
    r"""Irradiance of a face in the light of a small disk, per irradiance of one that faces it."""
    # The mean of :math:`\max(\cos\theta, 0)` over the disk: the cosine of its centre's incidence as
    # long as all of it is in front of the face, and a smooth passage to zero.
    #
    # The disk is flat and evenly bright: off by the square of its angular radius. Twice
    # continuously differentiable.
    return _mean_above(cosine / angular_radius) * angular_radius


class Limb(Checked):
    r"""The edge of a planet and its air, as the sun's rays pass it.

    An opaque edge at ``height`` stands for air and clouds that dim the rays the more the lower they
    pass: behind it is no light, before it all of it. It lets through as much light in all, while
    the sun sets, as the air does. A ray along this edge is bent by

    .. math:: \alpha = N\sqrt{\frac{2\pi a}{H}}

    with the refractivity N there, the scale height H and the distance a to the planet's centre.
    Half of that happens before the edge, and of the other half, what lies below the flyer.


    Notes
    -----
    The bending is that of air whose density falls exponentially, over heights that are small
    against the planet.
    """

    height: Altitude = 20e3  #: Altitude of the edge [m]
    #: Refractive index of the air at that height, less one [1]
    refractivity: Refractivity = 2.01e-5
    scale_height: Length = 6.38e3  #: In which the air's density falls by a factor e [m]

    def at(self, height: Numeric) -> "Limb":
        """The limb at another height, of the same air."""
        return Limb(height, _refractivity(self, height), self.scale_height)


@entry_point
def _refractivity(limb: Limb, height: Numeric) -> Array:
    return limb.refractivity * xp.exp((limb.height - height) / limb.scale_height)


@entry_point
def horizon_depression(limb: Limb, altitude: Numeric, radius: Numeric) -> Array:
    """Angle below the horizontal at which a planet's limb hides the centre of the sun [rad]."""
    # The dip of the limb, :math:`\arccos\frac{(1+N)(R+h_l)}{R+h}`, and the bending of the rays
    # along it, :math:`\frac\alpha2\left(1+\operatorname{erf}\sqrt{\frac{h-h_l}{H}}\right)`.
    #
    # Smooth in altitude: within 500 m of the limb's height the dip passes to zero, and below, the
    # horizon is level and the bending that of the limb's half. Differentiable.
    # of a refracted ray, the refractive index times the distance is what a straight one keeps
    lowest = (radius + limb.height) * (1.0 + limb.refractivity)
    above = radius + altitude - lowest
    clear = 0.5 * (above + xp.sqrt(above**2 + _SMOOTHED**2))
    dip = xp.arctan2(xp.sqrt(clear * (2.0 * lowest + clear)), lowest)
    bending = limb.refractivity * xp.sqrt(2.0 * np.pi * lowest / limb.scale_height)
    passed = erf(xp.sqrt(clear / limb.scale_height))
    return dip + 0.5 * bending * (1.0 + passed)


@custom_jvp
def _mean_over_turn(constant: Array, amplitude: Array) -> Array:
    r"""Mean of ``max(constant + amplitude cos x, 0)`` over a turn of x, for amplitude ≥ 0."""
    lit = _lit_angle(constant, amplitude)
    return (constant * lit + amplitude * xp.sin(lit)) / np.pi


@_mean_over_turn.defjvp
def _mean_over_turn_slope(
    primals: tuple[Array, Array], tangents: tuple[Array, Array]
) -> tuple[Array, Array]:
    # the angle's own change has no part, as the function is zero there
    lit = _lit_angle(*primals)
    change = (lit * tangents[0] + xp.sin(lit) * tangents[1]) / np.pi
    return _mean_over_turn(*primals), change


def _lit_angle(constant: Array, amplitude: Array) -> Array:
    moving = amplitude > xp.abs(constant)
    ratio = xp.where(moving, constant / xp.where(moving, amplitude, 1.0), xp.sign(constant))
    return xp.arccos(-ratio)


@entry_point
def lit_ground(zenith_angle: Numeric, ground_view: Numeric) -> Array:
    r"""Mean cosine of the sun's incidence on the ground below a flyer [1]."""
    # Weighted as a level face sees the ground: with the angle :math:`\psi` of a ring of ground from
    # the flyer's nadir, seen from the planet's centre,
    #
    # .. math::
    #     \int_0^1\left\langle\max(\cos z\cos\psi+\sin z\sin\psi\cos\phi,\,0)
    #     \right\rangle_\phi\,2t\,\mathrm dt,
    #     \qquad \psi = \arccos t - \arcsin\left(\sin\gamma\sqrt{1-t^2}\right)
    #
    # The sum has five terms and is within 8e-5 of the integral up to 150 km over Earth. Light that
    # the air above the dark ground scatters is left out. Differentiable.
    sine = xp.sqrt(ground_view)[..., None] * np.sqrt(1.0 - _NODES**2)
    distance = np.arccos(_NODES) - xp.arcsin(sine)
    overhead = xp.cos(zenith_angle)[..., None] * xp.cos(distance)
    sideways = xp.sin(zenith_angle)[..., None] * xp.sin(distance)
    lit = _mean_over_turn(overhead, xp.abs(sideways))
    return xp.sum(2.0 * _NODES * _WEIGHTS * lit, axis=-1)


EARTH_LIMB: Final = Limb()
"""Earth's limb at 20 km, with a standard uncertainty of 2 km, and the air of the US Standard
Atmosphere there. The height follows from scattering by molecules, ozone, and clouds up to 8 km, as
in ``studies/limb``: 18 km without clouds, 22 km with clouds up to 12 km."""
