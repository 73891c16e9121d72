"""Force on a disk with holes: our solver in open space and in reservoirs beside simulations.

    python studies/kinetic_sandwich_table/figure.py

Writes docs/images/kinetic-sandwich.png from the package's tables and points.jsonl.
"""

import csv
import json
from pathlib import Path

import jax
import numpy as np

import lightflyer as lf
from lightflyer.files import drawing as plot
from lightflyer.files import palette
from lightflyer.force.kinetic.sandwich_table import sandwich_fit
from lightflyer.force.membranes.sandwich import FREE_FORCE, TEMPERATURE_EXCESS

HERE = Path(__file__).parent
IMAGES = HERE.parents[1] / "docs" / "images"
PUBLISHED = HERE.parents[1] / "tests" / "validation" / "schafer2025.csv"
OPEN_FRACTIONS = (0.2, 0.6, 0.9)
MEAN_RATIO = 1.0 + 0.5 * TEMPERATURE_EXCESS  # one face hot


def published_ratios():
    """Rarefactions, and the published force ratio over them by open fraction."""
    lines = (line for line in PUBLISHED.read_text().splitlines() if not line.startswith("#"))
    found = {}
    for row in csv.DictReader(lines):
        beta = float(row["beta"])
        ratio = float(row["force"]) / ((1.0 - beta) * FREE_FORCE)
        found.setdefault(beta, {})[float(row["delta"])] = ratio
    return np.array(list(found[0.0])), {b: np.array(list(r.values())) for b, r in found.items()}


def open_space(delta, beta):
    """Force ratio of the model's table for a monatomic gas and complete accommodation."""
    with lf.float64():
        ratios = jax.jit(sandwich_fit("monatomic").ratios)
        return np.asarray(ratios(delta, beta, 1.0, 1.0 - beta, MEAN_RATIO).force)


def main():
    """Draw the figure and print the ratios of both."""
    rarefaction, simulated = published_ratios()
    lines = (HERE / "points.jsonl").read_text().splitlines()
    solved = [json.loads(line) for line in lines if line.startswith('["published')]
    figure = plot.new_figure(width=6.4, height=4.4)
    (ax,) = figure.axes
    delta = np.geomspace(0.03, 200.0, 200)
    for beta, colour in zip(OPEN_FRACTIONS, palette.PALETTE, strict=False):
        row = simulated[beta]
        ours = open_space(rarefaction, beta)
        print(f"β {beta:g}: open space over published", np.round(ours / row, 3))
        ax.loglog(delta, open_space(delta, beta), color=colour)
        ax.text(215.0, open_space(delta[-1:], beta)[0], f"β = {beta:g}", color=colour, va="center")
        ax.loglog(rarefaction, row, "o", color=colour, markersize=4.0)
        for key, result in solved:
            _, there, _, share = key.split()
            if float(share) == beta:
                ratio = result["published"][0] / ((1.0 - beta) * FREE_FORCE)
                ax.loglog(float(there), ratio, "x", color=colour, markersize=6.0)
    for key, result in solved:
        _, there, boundary, share = key.split()
        published = simulated[float(share)][rarefaction == float(there)][0]
        ratio = result["published"][0] / ((1.0 - float(share)) * FREE_FORCE) / published
        print(f"δ {there}, D {boundary}, β {share}: ours over published {ratio:.3f}")
    ax.text(0.03, 4e-3, "dots: simulations\nlines: kinetic equation, open space\n"
            "crosses: the same, reservoirs at 3 to 10 radii", color="0.3")  # fmt: skip
    ax.set_xlabel("rarefaction δ [1]")
    ax.set_ylabel("force over that of free molecules [1]")
    ax.set(xlim=(0.025, 700.0), ylim=(3e-3, 1.2))
    plot.save(figure, [IMAGES / "kinetic-sandwich.png"])


if __name__ == "__main__":
    main()
