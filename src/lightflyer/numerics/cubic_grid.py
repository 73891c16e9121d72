"""Tables on rectangular grids, interpolated by local cubics with a continuous derivative."""

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from lightflyer.array.namespace import Array, xp
from lightflyer.array.records import Module, field

_ORDER = 4  # coefficients of a cubic, and nodes that one piece looks at
MOST_UNEVEN = 3.0  # ratio of neighbouring widths up to which a parabola is trusted


class Axis(Module):
    """Nodes along one dimension of a table, and the cubic Hermite pieces between them."""

    is_table: ClassVar[bool] = True  # Its arrays are nodes, not elements

    # The slope at a node is that of the parabola through it and its two neighbours; at an end of
    # the axis, of the parabola through the last three nodes. Three nodes make one parabola, two a
    # line, one a constant. Where widths are uneven, see :func:`share_of_next`.

    nodes: Any  # shape (n,)
    # shape (pieces,); first of the nodes that a piece looks at; on an axis with a period, the next
    # after the last is the first again
    first: Any
    # shape (pieces, window, 4); weight of each of these nodes, in powers of the position within the
    # piece, 0 to 1
    powers: Any
    period: float | None = field(static=True)

    def __init__(self, nodes: ArrayLike, period: float | None = None):
        nodes = np.asarray(nodes, float)
        reach = nodes
        if period is not None:
            reach = np.concatenate([nodes[-1:] - period, nodes, nodes[:2] + period])
        window = min(_ORDER, reach.size)
        pieces = np.arange(max(reach.size - 1, 1))
        first = np.clip(pieces - 1, 0, reach.size - window)
        powers = np.array([_piece(reach, int(piece), window) for piece in pieces])
        if period is not None:
            own = slice(1, nodes.size + 1)
            first, powers = (first[own] - 1) % nodes.size, powers[own]
        self.nodes, self.first, self.powers, self.period = nodes, first, powers, period

    def weights(self, x: Any) -> tuple[Array, Array]:
        """Nodes that count at a position, and by how much; returns ``index``, ``weight``."""
        nodes, powers = xp.asarray(self.nodes), xp.asarray(self.powers)
        if self.period is not None:
            x = nodes[0] + xp.mod(x - nodes[0], self.period)
        pieces, window = powers.shape[:2]
        piece = xp.clip(xp.searchsorted(nodes, x, side="right") - 1, 0, pieces - 1)
        following = nodes[(piece + 1) % nodes.size]
        if self.period is not None:
            following = xp.where(piece + 1 < nodes.size, following, nodes[0] + self.period)
        width = following - nodes[piece] if nodes.size > 1 else 1.0
        along = (x - nodes[piece]) / width
        power = xp.stack([along**0, along, along**2, along**3], axis=-1)
        weight = xp.sum(powers[piece] * power[..., None, :], axis=-1)
        first = xp.asarray(self.first)[piece].astype(int)
        return (first[..., None] + xp.arange(window)) % nodes.size, weight


def _piece(nodes: np.ndarray, piece: int, window: int) -> np.ndarray:
    """Weights of the nodes around a piece in powers of the position, shape (window, 4)."""
    powers = np.zeros((window, _ORDER))
    if window == 1:
        powers[0, 0] = 1.0
        return powers
    start = int(np.clip(piece - 1, 0, nodes.size - window))
    left, right = np.eye(window)[[piece - start, piece + 1 - start]]
    near, width = nodes[start : start + window], nodes[piece + 1] - nodes[piece]
    slope_left, slope_right = (width * _slope(near, piece - start + end) for end in (0, 1))
    powers[:, 0] = left
    powers[:, 1] = slope_left
    powers[:, 2] = 3.0 * (right - left) - 2.0 * slope_left - slope_right
    powers[:, 3] = 2.0 * (left - right) + slope_left + slope_right
    return powers


def _slope(nodes: np.ndarray, at: int) -> np.ndarray:
    """Weights of the nodes in the derivative at one of them, of the parabola around it."""
    width = np.diff(nodes)
    secants = np.diff(np.eye(nodes.size), axis=0) / width[:, None]
    if width.size == 1:
        return secants[0]
    inner = int(np.clip(at, 1, width.size - 1))
    after = share_of_next(*width[inner - 1 : inner + 1])
    slope = (1.0 - after) * secants[inner - 1] + after * secants[inner]
    return slope if inner == at else 2.0 * secants[0 if at == 0 else -1] - slope


def share_of_next(before: Any, after: Any) -> Any:
    """Share of the secant after a node in the slope there; ``before``, ``after``: the widths.

    That of the parabola through three nodes, which rests on the narrower width. A step between
    nodes that almost coincide would swing the curve over the wide one beside it, by as much as the
    widths differ: beyond a ratio of 3 its share falls with the square of their ratio.
    """
    ratio = before / after
    uneven = np.maximum(ratio, 1.0 / ratio)
    narrow = uneven / (1.0 + uneven)
    limit = MOST_UNEVEN / (1.0 + MOST_UNEVEN) * (MOST_UNEVEN / uneven) ** 2
    narrow = np.where(uneven > MOST_UNEVEN, limit, narrow)
    return np.where(ratio > 1.0, narrow, 1.0 - narrow)


def interpolate(table: Any, axes: Sequence[Axis], position: Sequence[Any]) -> Array:
    """Value of a table between its nodes, once continuously differentiable, shape (..., ...)."""
    found = [axis.weights(x) for axis, x in zip(axes, xp.broadcast_arrays(*position), strict=True)]
    spread = []
    for number, (index, _) in enumerate(found):
        shape = [1] * len(found)
        shape[number] = index.shape[-1]
        spread.append(index.reshape(*index.shape[:-1], *shape))
    values = xp.asarray(table)[tuple(spread)]
    for _, weight in found:
        leading = weight.ndim - 1
        shape = [*weight.shape, *[1] * (values.ndim - weight.ndim)]
        values = xp.sum(weight.reshape(shape) * values, axis=leading)
    return values
