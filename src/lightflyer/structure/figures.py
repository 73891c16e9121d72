"""Figure of a curled and drooping flyer, cut through its middle."""

import numpy as np
from matplotlib.axes import Axes

from lightflyer.files.drawing import legend_below
from lightflyer.files.palette import BLUE, GREY, ORANGE

_UPRIGHT = 0.5 * np.pi  # beyond which no payload turns a film
_SEEN = 0.02  # height over the radius below which heights are drawn larger besides
_ROOM = 0.3  # height over the radius that is drawn at least
_LARGER = 0.25  # height over the radius to which they are drawn at most


def draw_cross_section(
    ax: Axes,
    places: np.ndarray,
    curvature: float,
    droops: np.ndarray,
    *,
    gap: float = 0.0,
    hanging: float | None = None,
    one_side: bool = False,
) -> Axes:
    """Draw a flyer to scale, in the direction in which it curls most.

    ``places``: distances from its middle along the film [m], shape (n,), and ``droops``: heights
    that its payload gives it there, on the right and on the left [m], shape (2, n); ``curvature``
    of its curl [1/m]; ``gap`` between its membranes, and radius of the circle from which a payload
    is ``hanging`` [m], None without one, or on ``one_side`` alone.
    """
    radius = places[-1]
    ax.plot([-1e3 * radius, 1e3 * radius], [0.0, 0.0], color=GREY, lw=0.8, ls=":", label="flat")
    shallow = 0.5 * abs(curvature) * radius**2 + float(np.ptp([0.0, *droops.ravel()]))
    times = _enlarged(shallow / radius)
    for side, droop in zip((1.0, -1.0), droops, strict=True):
        lower = _arc(places, curvature * places, droop) * np.array([[side], [1.0]])
        name = "_" if side < 0.0 else ""
        ax.plot(*(1e3 * lower), color=BLUE, label=f"{name}to scale")
        if gap > 0.0:
            along = side * np.gradient(lower, axis=1)
            across = np.array([-along[1], along[0]]) / np.hypot(*along)  # upwards
            ax.plot(*(1e3 * (lower + gap * across)), color=BLUE)
        if times > 1.0:
            ax.plot(1e3 * lower[0], 1e3 * times * lower[1], color=BLUE, lw=1.0, ls="--",
                    label=f"{name}heights × {times:,.0f}")  # fmt: skip
        if hanging is not None and not (one_side and name):
            ends = [np.interp(hanging, places, axis) for axis in 1e3 * lower]
            ax.plot(*ends, color=ORANGE, marker="v", ls="", label=f"{name}payload hangs here")
    around = _ROOM * 1e3 * radius
    low, high = ax.get_ylim()
    ax.set_ylim(min(low, -around), max(high, around))
    ax.set_aspect("equal", adjustable="box")
    ax.set(xlabel="distance from the middle [mm]", ylabel="height [mm]")
    ax.grid(alpha=0.25)
    legend_below(ax)
    return ax


def _enlarged(height: float) -> float:
    """How many times larger heights are drawn besides; ``height``: over the radius."""
    if not 0.0 < height < _SEEN:
        return 1.0
    decade = 10.0 ** np.floor(np.log10(_LARGER / height))
    return float(decade * max(first for first in (1, 2, 5) if first * decade * height <= _LARGER))


def _arc(places: np.ndarray, curled: np.ndarray, droop: np.ndarray) -> np.ndarray:
    """Distances from the axis and heights of a film that keeps its length [m], shape (2, n)."""
    angle = curled + np.clip(np.gradient(droop, places), -_UPRIGHT, _UPRIGHT)
    middle, step = 0.5 * (angle[1:] + angle[:-1]), np.diff(places)
    ways = np.array([step * np.cos(middle), step * np.sin(middle)])
    return np.concatenate([np.zeros((2, 1)), np.cumsum(ways, axis=1)], axis=1)
