"""Several smooth curves over the same knots, fast to evaluate in large arrays."""

from dataclasses import dataclass

import numpy as np

from lightflyer.array.memory import kept
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.numerics.power_spline import Sums, spline


@dataclass(frozen=True)
class Curves:
    """Several cubic splines with the same knots, level at both ends and beyond."""

    knots: tuple[float, ...]
    # Value and half the second derivative at the first knot, one for each curve
    constants: tuple[float, ...]
    squares: tuple[float, ...]
    # A sixth of the jumps of the third derivative at all knots but the last, for each curve
    cubes: tuple[tuple[float, ...], ...]

    @classmethod
    def through(cls, knots: np.ndarray, values: np.ndarray) -> "Curves":
        """Splines with two continuous derivatives, and none at the ends; ``knots`` (n,)."""
        width, secant = np.diff(knots), np.diff(values, axis=0) / np.diff(knots)[:, None]
        matrix = np.diag(np.concatenate([[width[0]], width[:-1] + width[1:], [width[-1]]]) / 3.0)
        matrix += np.diag(width / 6.0, 1) + np.diag(width / 6.0, -1)
        level = np.zeros((1, values.shape[1]))
        curvature = np.linalg.solve(matrix, np.diff(secant, axis=0, prepend=level, append=level))
        third = np.diff(curvature, axis=0) / width[:, None]
        jumps = np.diff(third, axis=0, prepend=level) / 6.0
        return cls(
            tuple(knots.tolist()),
            tuple(values[0].tolist()),
            tuple((0.5 * curvature[0]).tolist()),
            tuple(tuple(column) for column in jumps.T.tolist()),
        )

    @kept
    def __call__(self, x: Numeric) -> list[Array]:
        """Values of all curves at ``x``, any shape."""
        inside = xp.clip(x, self.knots[0], self.knots[-1])
        curves = zip(self.constants, self.squares, self.cubes, strict=True)
        return [
            spline(Sums(self.knots[:-1], (constant, 0.0, square, cubes[0]), cubes[1:], 3), inside)
            for constant, square, cubes in curves
        ]
