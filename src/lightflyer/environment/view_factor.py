r"""View factor from a plane face to the planet below it.

With the half-angle :math:`\gamma` of the planet's disk as seen from the flyer,
:math:`\sin\gamma = R/(R+h)`, a face that looks straight down sees the share
:math:`\sin^2\gamma` of it.
"""

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point

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
