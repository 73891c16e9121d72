"""Tabulated curves as piecewise cubics that JAX evaluates."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from lightflyer.pytree.lazy_jax import Array, jnp
from lightflyer.pytree.module import Module


class Spline(Module):
    """Piecewise cubic."""

    nodes: Any  # shape (n,); increasing abscissae
    # shape (4, n - 1); of each piece, in powers of the distance to its left node, highest first
    coefficients: Any

    @classmethod
    def through(cls, nodes: ArrayLike, values: ArrayLike) -> "Spline":
        """Twice continuously differentiable cubic through points ("not-a-knot" ends)."""
        from scipy.interpolate import CubicSpline  # half a second that most uses can spare

        spline = CubicSpline(nodes, values)
        return cls(nodes=np.asarray(spline.x), coefficients=np.asarray(spline.c))

    @classmethod
    def hermite(cls, nodes: np.ndarray, values: np.ndarray, slopes: np.ndarray) -> "Spline":
        """Once continuously differentiable cubic through points with known slopes."""
        width = np.diff(nodes)
        secant = np.diff(values) / width
        left, right = slopes[:-1], slopes[1:]
        cubic = (left + right - 2.0 * secant) / width**2
        quadratic = (3.0 * secant - 2.0 * left - right) / width
        return cls(nodes=nodes, coefficients=np.stack([cubic, quadratic, left, values[:-1]]))

    def __call__(self, x: Any) -> Array:
        """Value at ``x``, any shape; the outer pieces continue beyond the table."""
        nodes, coefficients = jnp.asarray(self.nodes), jnp.asarray(self.coefficients)
        piece = jnp.clip(jnp.searchsorted(nodes, x, side="right") - 1, 0, nodes.size - 2)
        cubic, quadratic, linear, constant = coefficients[:, piece]
        distance = x - nodes[piece]
        return constant + distance * (linear + distance * (quadratic + distance * cubic))
