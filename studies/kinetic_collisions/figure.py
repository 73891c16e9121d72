"""Draw docs/images/kinetic-collisions.png: factors of collisions, and direct simulation."""

from pathlib import Path

import numpy as np
from comparison import EXPONENTS, Place, compared

import lightflyer as lf
from lightflyer.files import drawing as plot
from lightflyer.files import palette
from lightflyer.force.kinetic.collisions import FORCE_HEATED, HEAT_HEATED, collision_fit

IMAGE = Path(__file__).parents[2] / "docs" / "images" / "kinetic-collisions.png"
GASES = ("hard spheres", "helium", "argon", "nitrogen")
LABELS = (1.25, 1.15), (2.6, 0.885), (0.035, 0.62), (0.035, 0.68)
HOT = 480.0 / 205.0


def main() -> None:
    """Draw factors of force and heat over the Knudsen number."""
    figure = plot.new_figure(columns=2)
    for ax, quantity in zip(figure.axes, ("force", "heat"), strict=True):
        draw(ax, quantity)
    left, right = figure.axes
    for number, (gas, where) in enumerate(zip(GASES, LABELS, strict=True)):
        left.text(*where, f"{gas}, ω = {EXPONENTS[gas]:g}", color=palette.PALETTE[number])
    right.set_ylim(0.8, None)
    right.text(0.03, 0.81, "solid: as hot as in flight\ndashed: hardly warmer than the gas",
               color="0.3")  # fmt: skip
    figure.savefig(IMAGE, dpi=150)


def draw(ax, quantity: str) -> None:
    """Factors of force or heat: of small differences, at those of flight, and simulated."""
    index, knudsen = ("force", "heat").index(quantity), np.geomspace(0.03, 30.0, 200)
    heated, points = (FORCE_HEATED, HEAT_HEATED)[index], compared(quantity)
    for number, gas in enumerate(GASES):
        kind = "diatomic" if gas == "nitrogen" else "monatomic"
        exponent, colour = EXPONENTS[gas], palette.PALETTE[number]
        with lf.float64():
            factor = np.asarray(collision_fit(kind).factors(knudsen, exponent, 0.5)[index])
            change = float(heated(kind, HOT, exponent))
        ax.semilogx(knudsen, factor, "--", color=colour, lw=1.0)
        ax.semilogx(knudsen, change * factor, color=colour)
        shown = [p for p in points if p.place.gas == gas and p.error < 0.1 and is_hot(p.place)]
        ax.errorbar(
            [p.place.knudsen for p in shown],
            [p.simulated for p in shown],
            [p.error for p in shown],
            fmt="o", color=colour, ms=4, capsize=2,
        )  # fmt: skip
    ax.axhline(1.0, color="0.6", lw=0.8)
    ax.set_xlabel("Knudsen number [1]")
    ax.set_ylabel(f"factor of {quantity} [1]")


def is_hot(place: Place) -> bool:
    """Whether a disk is as hot as in flight."""
    return abs(place.temperature_ratio - HOT) < 0.1


if __name__ == "__main__":
    main()
