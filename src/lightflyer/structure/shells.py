"""Thin shells under pressure from outside."""

import math

import jax.numpy as jnp
from jax import Array

from lightflyer.core.types import Numeric
from lightflyer.program.entry_point import entry_point

SPHERE_KNOCK_DOWN = 0.14  # share of the classical pressure that built spheres bear [NASA-SP-8032]
CYLINDER_KNOCK_DOWN = 0.75  # and cylinders under lateral pressure [NASA-SP-8007]


@entry_point
def sphere_buckling_pressure(
    radius: Numeric,
    thickness: Numeric,
    modulus: Numeric,
    poisson: Numeric,
    knock_down: Numeric = SPHERE_KNOCK_DOWN,
) -> Array:
    r"""Pressure at which a thin sphere buckles [Pa]."""
    # .. math:: p = \gamma\,\frac{2E}{\sqrt{3(1-\nu^2)}}\left(\frac tR\right)^2
    #
    # Source: [NASA-SP-8032]_
    slender = jnp.asarray(thickness) / radius
    return knock_down * 2.0 * modulus / jnp.sqrt(3.0 * (1.0 - poisson**2)) * slender**2


@entry_point
def cylinder_buckling_pressure(
    radius: Numeric,
    length: Numeric,
    thickness: Numeric,
    modulus: Numeric,
    poisson: Numeric,
    knock_down: Numeric = CYLINDER_KNOCK_DOWN,
) -> Array:
    r"""Lateral pressure at which a thin cylinder, held round at its ends, buckles [Pa]."""
    # .. math:: p = \gamma\,\frac{\pi\sqrt6}{9(1-\nu^2)^{3/4}}\,
    #     \frac{E\,t^{5/2}}{L\,R^{3/2}}
    #
    # of moderate length. Source: [NASA-SP-8007]_
    of_material = math.pi * math.sqrt(6.0) / 9.0 * modulus / (1.0 - poisson**2) ** 0.75
    return knock_down * of_material * jnp.asarray(thickness) ** 2.5 / (length * radius**1.5)
