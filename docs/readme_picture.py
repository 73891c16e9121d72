"""Draw the picture of the README into docs/images, light and dark: ``make picture``.

Left, why a film rises. Right, how strongly the disk of ``make demo`` is lifted over altitude, with
its 95 % band: all numbers are those of ``lightflyer predict``.
"""

from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

import lightflyer as lf
from lightflyer.cli.commands.init import templates

IMAGES = Path(__file__).parent / "images"
SCHEMES = {
    "light": {"ink": "#1f2328", "soft": "#656d76", "sun": "#d9822b", "film": "#1f2328",
              "gas": "#0969da", "lift": "#1a7f37", "paper": "none"},
    "dark": {"ink": "#e6edf3", "soft": "#9198a1", "sun": "#f2a33c", "film": "#e6edf3",
             "gas": "#58a6ff", "lift": "#3fb950", "paper": "none"},
}  # fmt: skip
LOW, HIGH = 64.0, 90.0  # km
WIDTH, HEIGHT = 10.0, 3.9  # inches
RAYS = (-2.7, -1.6, -0.5, 0.6, 1.7, 2.8)  # where they meet the film
MOLECULES = (-2.15, -1.05, 0.05, 1.15, 2.25)  # places along the film
SHORT = 0.75  # length of the arrow of a molecule that leaves the top face
STRETCH = 7.0  # of what is longer below


def demo() -> lf.prediction.Prediction:
    """The prediction of the disk of ``make demo``."""
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "flyer.toml"
        path.write_text(templates()["laden"].read(), encoding="utf-8")
        return lf.predict(path)


def arrow(ax: Axes, start: tuple[float, float], end: tuple[float, float], **style: Any) -> None:
    """An arrow between two places of the drawing."""
    properties = {"arrowstyle": "-|>", "lw": 1.8, "shrinkA": 0, "shrinkB": 0, **style}
    ax.annotate("", end, start, arrowprops=properties)


def draw_why(ax: Axes, found: lf.prediction.Prediction, ink: dict[str, str]) -> None:
    """A film in sunlight, and the molecules that leave its faces."""
    film = found.setup.flyer.film
    ax.set(xlim=(-5.3, 4.6), ylim=(-3.2, 3.4), aspect="equal")
    ax.axis("off")
    for place in RAYS:
        arrow(ax, (place - 0.75, 3.2), (place, 0.25), color=ink["sun"], lw=1.3)
    ax.text(-5.2, 3.1, "sunlight\nwarms\nthe film", color=ink["sun"], ha="left", va="top")
    ax.plot([-3.0, 3.0], [0.0, 0.0], color=ink["film"], lw=6, solid_capstyle="round")
    for place in MOLECULES:
        for side, share in ((1.0, film.tac_top), (-1.0, film.tac_bottom)):
            # the energy beyond that of the gas goes with the accommodation coefficient
            length = SHORT * (1.0 + STRETCH * (float(share) / float(film.tac_top) - 1.0))
            arrow(ax, (place, 0.25 * side), (place, side * (0.25 + length)), color=ink["gas"])
            ax.plot([place], [0.25 * side], "o", color=ink["gas"], ms=5)
    arrow(ax, (3.9, -0.6), (3.9, 1.3), color=ink["lift"], lw=5, mutation_scale=24)
    ax.text(3.9, 1.45, "lift", color=ink["lift"], ha="center", va="bottom", weight="bold")
    why = "thin gas leaves the bottom face with more energy\nthan the top: that pushes the film up"
    ax.text(0.0, -2.15, why, color=ink["gas"], ha="center", va="top")


def draw_where(ax: Axes, found: lf.prediction.Prediction, ink: dict[str, str]) -> None:
    """Lift over weight over altitude, with its band, and where the disk rests."""
    bands = found.uncertainty
    across, name = 1e-3, "lift_over_weight"
    ax.fill_betweenx(across * bands.coordinate, bands.low[name], bands.high[name],
                     color=ink["lift"], alpha=0.22, lw=0, label="95 % band")  # fmt: skip
    altitude = across * found.coordinates
    ax.plot(found.table[name], altitude, color=ink["lift"], lw=2.2, label="lift")
    ax.axvline(1.0, color=ink["ink"], lw=1.2)
    ax.text(1.0, HIGH + 0.4, "its weight", color=ink["ink"], ha="center", va="bottom", size=9.5)
    rest = found.verdict.rest
    assert rest is not None  # the disk of the demo flies
    place, heat = across * rest.coordinate, rest.values["temperature"]
    low, high = bands.bands["verdict.rest.temperature_k"]
    ax.plot([1.0], [place], "o", color=ink["ink"], ms=7, zorder=5)
    told = f"rests at {place:.1f} km\nand {heat:.0f} K ({low:.0f} to {high:.0f})"
    ax.annotate(told, (1.0, place), (1.45, 88.0), color=ink["ink"], size=10, va="center",
                arrowprops={"arrowstyle": "-", "color": ink["soft"]})  # fmt: skip
    carried = 1e6 * float(found.setup.flyer.payload)
    wide = 2e3 * float(found.setup.flyer.radius)
    ax.text(1.83, 76.5, "95 % band", color=ink["lift"], ha="center", va="center", size=10)
    ax.text(2.32, 65.0, f"a disk of {wide:g} mm\nwith {carried:g} mg aboard,\nlet go over Earth",
            color=ink["ink"], size=9.5, ha="right", va="bottom")  # fmt: skip
    ax.set(xlim=(0.0, 2.4), ylim=(LOW, HIGH), xlabel="lift over weight", ylabel="altitude [km]")
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        ax.spines[side].set_color(ink["soft"])
    ax.tick_params(colors=ink["soft"], labelcolor=ink["ink"])
    ax.xaxis.label.set_color(ink["ink"])
    ax.yaxis.label.set_color(ink["ink"])


def main() -> None:
    """Draw both."""
    found = demo()
    rest, bands = found.verdict.rest, found.uncertainty.bands
    assert rest is not None  # the disk of the demo flies
    low, high = bands["verdict.rest.temperature_k"]
    heat = f"{rest.values['temperature']:.0f} K ({low:.0f} to {high:.0f})"
    about = f"The disk of make demo rests at {rest.coordinate / 1e3:.1f} km, {heat}"
    with mpl.rc_context({"svg.hashsalt": "lightflyer", "font.size": 11}):
        for scheme, ink in SCHEMES.items():
            figure = Figure(figsize=(WIDTH, HEIGHT), layout="constrained", facecolor="none")
            why, where = figure.subplots(1, 2, width_ratios=(1.25, 1.0))
            where.set_facecolor("none")
            draw_why(why, found, ink)
            draw_where(where, found, ink)
            FigureCanvasSVG(figure).print_svg(
                IMAGES / f"lightflyer-{scheme}.svg",
                metadata={"Date": None, "Creator": None, "Description": about},
            )


if __name__ == "__main__":
    main()
