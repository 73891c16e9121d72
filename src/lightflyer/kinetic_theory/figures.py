"""Figure of the gas around a hot disk: temperature and streamlines."""

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lightflyer.files.drawing import figure_for, outline_effects
from lightflyer.files.palette import SKY

if TYPE_CHECKING:
    from lightflyer.kinetic_theory.chamber.solution import ChamberSolution
    from lightflyer.kinetic_theory.solver import Solution

_EXTENT = 3.0
_WIDEST = 6.0  # of a chamber, whose walls are to be seen
_POINTS = 241
_LEVELS = 16


def draw_flow(solution: "Solution | ChamberSolution", ax: Axes, extent: float = _EXTENT) -> Axes:
    """Draw the temperature of the gas and its streamlines in a plane through the axis."""
    chamber = getattr(solution, "chamber", None)
    side, low, high = extent, -extent, extent
    if chamber is not None:
        side = min(extent, chamber.side.distance)
        low, high = max(low, -chamber.floor.distance), min(high, chamber.lid.distance)
    x, z = np.linspace(-side, side, _POINTS), np.linspace(low, high, _POINTS)
    fields = solution.flow(np.abs(x)[None, :], z[:, None])
    filled = ax.contourf(x, z, fields["temperature"], levels=_LEVELS, cmap="inferno")
    label = "$(T - T_c)/T_c$" + (" per unit of the faces'" if solution.is_linear else "")
    ax.figure.colorbar(filled, ax=ax, label=f"{label} [1]")
    outwards = fields["velocity_radial"] * np.sign(x)[None, :]
    ax.streamplot(
        x,
        z,
        outwards,
        fields["velocity_axial"],
        color="white",
        linewidth=0.6,
        density=1.3,
        arrowsize=0.7,
    )
    ax.plot([-1.0, 1.0], [0.0, 0.0], color=SKY, linewidth=3.5, solid_capstyle="butt",
            path_effects=outline_effects(5.5))  # fmt: skip
    ax.set_aspect("equal")
    ax.set_xlim(-side, side)
    ax.set_ylim(low, high)
    if chamber is not None:
        bottom, top, wall = -chamber.floor.distance, chamber.lid.distance, chamber.side.distance
        for surface, across, along in (
            (chamber.floor, [-wall, wall], [bottom, bottom]),
            (chamber.lid, [-wall, wall], [top, top]),
            (chamber.side, [-wall, -wall], [bottom, top]),
            (chamber.side, [wall, wall], [bottom, top]),
        ):
            style = "-" if surface.solid else "--"
            ax.plot(across, along, color="black", linewidth=5.0, linestyle=style)
    ax.set_xlabel("distance from the axis [disk radii]")
    ax.set_ylabel("height [disk radii]")
    words = solution.title.replace("T_h/T_c", "$T_h/T_c$")
    first, _, second = words.partition(" walls, ")
    second, at, place = second.partition(", floor ")
    place = f"\nfloor {place}" if at else ""
    ax.set_title(f"{first} walls\n{second}{place}", fontsize="medium")
    return ax


def flow_figure(solution: "Solution | ChamberSolution", ax: Axes | None = None) -> Figure:
    """A figure with :func:`draw_flow`, up to the reservoir where there is one."""
    figure, ax = figure_for(ax, height=5.0)
    widest = _EXTENT if getattr(solution, "chamber", None) is None else _WIDEST
    draw_flow(solution, ax, min(widest, solution.boundary))
    return figure
