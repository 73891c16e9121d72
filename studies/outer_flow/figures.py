"""Figures of the study."""

from pathlib import Path

import claim
import findings
import numpy as np

import lightflyer as lf
from lightflyer.files import drawing as plot
from lightflyer.files import palette
from lightflyer.force.laws.outer_flow import CREEPING, through_flow_coefficient

IMAGES = Path(__file__).parents[2] / "docs" / "images"
EDGE = 3.0  # of the drawn part of the flow, in radii
LEVELS = np.linspace(-2.95, -0.05, 30)  # of the stream function; −0.5 ends at the rim


def draw_all(results):
    """Write the figures of the docs."""
    IMAGES.mkdir(parents=True, exist_ok=True)
    draw_flow(IMAGES / "outer-flow.png")
    draw_claim(results["claim"], IMAGES / "claim-25-km.png")


def draw_flow(path):
    """Streamlines in creeping and in fast flow, and the force over the Reynolds number."""
    figure = plot.new_figure(columns=2, width=5.2, height=4.6)
    lines, force = figure.axes
    table = findings.read("streamlines")
    for reynolds, side in zip(np.unique(table["reynolds"]), (-1.0, 1.0), strict=True):
        _streamlines(lines, table, reynolds, side)
    lines.plot([-1.0, 1.0], [0.0, 0.0], color="black", lw=3)
    lines.axvline(0.0, color=palette.GREY, lw=0.8)
    lines.set(
        xlim=(-EDGE, EDGE), ylim=(-EDGE, EDGE), aspect="equal", xlabel="r / a", ylabel="z / a"
    )
    _force(force)
    plot.save(figure, [path])


def _streamlines(axes, table, reynolds, side):
    here = table["reynolds"] == reynolds
    axes.tricontour(
        side * table["r"][here], table["z"][here], table["psi"][here],
        levels=LEVELS, colors=palette.BLUE, linestyles="solid",
        linewidths=1.0,
    )  # fmt: skip
    axes.text(
        0.5 * side * EDGE, 0.94 * EDGE, f"Re = {reynolds:g}", ha="center", va="top",
        bbox={"color": "white"},
    )  # fmt: skip


def _force(axes):
    reynolds, value, _ = findings.coefficients()
    smooth = np.geomspace(0.01, 2000.0, 300)
    with lf.float64():
        formula = np.asarray(through_flow_coefficient(smooth))
    axes.plot(smooth, formula, color=palette.BLUE)
    axes.plot(reynolds, value, "o", color="black", ms=5)
    axes.axhline(CREEPING, color=palette.GREEN, ls="--", lw=1)
    axes.plot(smooth, np.pi * smooth, color=palette.VERMILION, ls=":")
    axes.set(
        xscale="log", yscale="log", xlabel="Reynolds number ρau/μ", ylabel="force over μau",
        ylim=(8.0, 8e3), xlim=(0.01, 2000.0),
    )  # fmt: skip
    axes.text(0.013, 18.5, "Stokes: 16", color=palette.GREEN)
    axes.text(4.0, 9.0, "jet: ρu²πa²", color=palette.VERMILION)
    axes.text(0.013, 200.0, "formula;\ndots: Navier–Stokes\n(OpenFOAM)", color=palette.BLUE)
    axes.grid(alpha=0.3)


def draw_claim(found, path):
    """What the device carries over the temperature difference of its membranes."""
    figure = plot.new_figure(width=6.4, height=4.6)
    axes = figure.axes[0]
    difference = np.geomspace(0.02, 100.0, 200)
    with lf.float64():
        around = claim.Surroundings()
        lines = (
            ("endless sheet", (0.12, 2000.0), palette.VERMILION, "--",
             around.slab(difference, claim.OPEN_FRACTION)),
            ("flow, as fast as effusion", (0.1, 8.0), palette.ORANGE, "-",
             around.flow(around.effusion(difference))),
            ("flow, transmitting disk", (2.2, 0.25), palette.BLUE, "-",
             around.flow(around.transmitting_disk(difference, claim.OPEN_FRACTION))),
        )  # fmt: skip
    for label, where, colour, style, force in lines:
        axes.plot(difference, claim.mass(force, around.gravity), color=colour, ls=style)
        axes.text(*where, label, color=colour)
    sunlight, warm = found["available_difference_k"], found["by_warm_air_mg"]
    axes.axvspan(sunlight["low"], sunlight["high"], color=palette.YELLOW, alpha=0.4, lw=0)
    axes.text(sunlight["high"] * 1.1, 2e-4, "difference in sunlight (95 %)", color=palette.GREY)
    axes.axhspan(warm["low"], warm["high"], color=palette.GREY, alpha=0.4, lw=0)
    axes.text(95.0, warm["low"] * 0.7, "lift of the air that it warms", ha="right", va="top",
              color=palette.GREY)  # fmt: skip
    axes.axhline(found["claimed_mg"], color="black", ls=":")
    axes.text(1.0, found["claimed_mg"] * 1.15, "published payload")
    axes.set(
        xscale="log", yscale="log", xlim=(0.02, 100.0), ylim=(1e-4, 1e4),
        xlabel="temperature difference of the membranes [K]", ylabel="force over weight of 1 mg",
    )  # fmt: skip
    axes.grid(alpha=0.3)
    plot.save(figure, [path])
