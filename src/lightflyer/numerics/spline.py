"""Tabulated curves as piecewise cubics that JAX evaluates."""

from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from lightflyer.array.namespace import Array, xp
from lightflyer.array.records import Module


class Spline(Module):
    """Piecewise cubic."""

    is_table: ClassVar[bool] = True  # Its arrays are nodes, not elements

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
        """Value at ``x``, any shape; the outer pieces continue beyond the table.

        Axes of values that are vectors come last.
        """
        nodes, coefficients = xp.asarray(self.nodes), xp.asarray(self.coefficients)
        piece = xp.clip(xp.searchsorted(nodes, x, side="right") - 1, 0, nodes.size - 2)
        cubic, quadratic, linear, constant = coefficients[:, piece]
        distance = x - nodes[piece]
        distance = distance.reshape(distance.shape + (1,) * (coefficients.ndim - 2))
        return constant + distance * (linear + distance * (quadratic + distance * cubic))
