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
    droop: np.ndarray,
    *,
    gap: float = 0.0,
    hanging: float | None = None,
) -> Axes:
    """Draw a flyer to scale, in the direction in which it curls most.

    ``places``: distances from its middle along the film [m], shape (n,), and ``droop``: heights
    that its payload gives it there [m]; ``curvature`` of its curl [1/m]; ``gap`` between its
    membranes, and radius of the circle from which a payload is ``hanging`` [m], None without one.
    """
    radius = places[-1]
    ax.plot([-1e3 * radius, 1e3 * radius], [0.0, 0.0], color=GREY, lw=0.8, ls=":", label="flat")
    lower = _arc(places, curvature * places, droop)
    _both_sides(ax, lower, color=BLUE, label="to scale")
    if gap > 0.0:
        slope = np.arctan2(np.gradient(lower[1], places), np.gradient(lower[0], places))
        _both_sides(ax, lower + gap * np.array([-np.sin(slope), np.cos(slope)]), color=BLUE)
    highest = 0.5 * abs(curvature) * radius**2 + float(np.ptp(droop))
    if 0.0 < highest < _SEEN * radius:
        most = _LARGER * radius / highest
        decade = 10.0 ** np.floor(np.log10(most))
        times = decade * max(first for first in (1, 2, 5) if first * decade <= most)
        flat = np.array([lower[0], times * lower[1]])
        _both_sides(ax, flat, color=BLUE, lw=1.0, ls="--", label=f"heights × {times:,.0f}")
    if hanging is not None:
        ends = np.array([np.interp(hanging, places, axis) for axis in lower])
        _both_sides(ax, ends[:, None], color=ORANGE, marker="v", ls="", label="payload hangs here")
    around = _ROOM * 1e3 * radius
    low, high = ax.get_ylim()
    ax.set_ylim(min(low, -around), max(high, around))
    ax.set_aspect("equal", adjustable="box")
    ax.set(xlabel="distance from the middle [mm]", ylabel="height [mm]")
    ax.grid(alpha=0.25)
    legend_below(ax)
    return ax


def _arc(places: np.ndarray, curled: np.ndarray, droop: np.ndarray) -> np.ndarray:
    """Distances from the axis and heights of a film that keeps its length [m], shape (2, n)."""
    angle = curled + np.clip(np.gradient(droop, places), -_UPRIGHT, _UPRIGHT)
    middle, step = 0.5 * (angle[1:] + angle[:-1]), np.diff(places)
    ways = np.array([step * np.cos(middle), step * np.sin(middle)])
    return np.concatenate([np.zeros((2, 1)), np.cumsum(ways, axis=1)], axis=1)


def _both_sides(ax: Axes, line: np.ndarray, **style: object) -> None:
    label = style.pop("label", None)
    across, height = 1e3 * line
    ax.plot(across, height, label=label, **style)  # type: ignore[arg-type]
    ax.plot(-across, height, **style)  # type: ignore[arg-type]
