"""Films with round holes: how much stiffness these leave, and how they raise stress."""

import jax.numpy as jnp
from jax import Array

from lightflyer.core.types import Numeric
from lightflyer.structure.closed_form import closed_form


@closed_form
def perforated_share(open_fraction: Numeric) -> Array:
    r"""Stiffness of a film with round holes over that of a whole one [1]."""
    # .. math:: \frac{1-\beta}{1+2\beta}
    #
    # The bound of isotropic films by Hashin and Shtrikman, which holes in a triangular pattern
    # nearly reach; it does not depend on Poisson's ratio. Source: [Hashin1965]_
    return (1.0 - jnp.asarray(open_fraction)) / (1.0 + 2.0 * open_fraction)


@closed_form
def tension_at_holes(first: Numeric, second: Numeric, open_fraction: Numeric) -> Array:
    r"""Largest tension in a film [Pa], whose whole parts would have two principal stresses [Pa]."""
    # .. math:: \sigma = \frac{3\sigma_1-\sigma_2}{1+2\beta}
    #
    # Kirsch's for a lone hole; for alike stresses Lamé's ring of the hole's share of the area. A
    # bound where holes are many (studies/structure); corners of slots have more.
    larger, smaller = jnp.maximum(first, second), jnp.minimum(first, second)
    share = jnp.asarray(open_fraction)
    return jnp.where(share > 0.0, (3.0 * larger - smaller) / (1.0 + 2.0 * share), larger)
