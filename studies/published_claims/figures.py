"""One row a claim: how far our model is from what was published."""

from pathlib import Path

from lightflyer.files import drawing as plot
from lightflyer.files import palette

IMAGES = Path(__file__).parents[2] / "docs" / "images"

# name, what it says, whether it was seen or computed
ROWS = (
    ("plate", "plate levitates at 10 Pa to 200 Pa\nCortes et al. 2020", True),
    ("device", "1-cm sandwich levitates at 26.7 Pa\nSchafer et al. 2025", True),
    ("ten milligrams", "3-cm-radius sandwich carries 10 mg at 75 km\nSchafer et al. 2025", False),
    ("stratosphere", "10-cm sandwich carries 285 mg at 25 km\nSchafer et al. 2022", False),
    ("kilogram", "10-m rocket carries 1 kg at 80 km\nCelenza et al. 2023", False),
    ("germanium", "germanium doubles the force of a body\nLu et al. 2023", False),
)


def draw(results):
    """Write docs/images/other-claims.png."""
    figure = plot.new_figure(width=8.0, height=4.4)
    axes = figure.axes[0]
    for place, (name, _, seen) in enumerate(ROWS):
        found = results[name]["ratio"]
        middle = found["median"]
        axes.errorbar(
            middle, place, xerr=[[middle - found["low"]], [found["high"] - middle]],
            fmt="o" if seen else "s", color=palette.BLUE if seen else palette.VERMILION, capsize=4,
        )  # fmt: skip
        axes.annotate(
            f"{middle:.2g} ({found['low']:.2g} to {found['high']:.2g})", (middle, place),
            textcoords="offset points", xytext=(0, 8), ha="center", fontsize=9,
            bbox={"color": "white", "pad": 0.5},
        )  # fmt: skip
    axes.axvline(1.0, color="black", lw=1)
    axes.set_yticks(range(len(ROWS)), [text for _, text, _ in ROWS])
    axes.set(
        xscale="log", xlim=(3e-3, 30.0), ylim=(len(ROWS) - 0.5, -0.6),
        xlabel="our force over the force that the claim needs (95 %)",
    )  # fmt: skip
    axes.grid(alpha=0.3, axis="x")
    axes.text(25.0, 0.5, "observed", color=palette.BLUE, ha="right", va="center")
    axes.text(25.0, 3.0, "predicted", color=palette.VERMILION, ha="right", va="center")
    IMAGES.mkdir(parents=True, exist_ok=True)
    plot.save(figure, [IMAGES / "other-claims.png"])
