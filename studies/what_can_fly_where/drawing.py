"""Figures of the study, and its table."""

import numpy as np
from kinds import KINDS

from lightflyer.files import drawing as plot
from lightflyer.files import palette

LOOKS = {
    "disk, kinetic theory": (palette.BLUE, "-"),
    "disk, fit of Lu et al.": (palette.BLUE, "--"),
    "sandwich, own solver": (palette.VERMILION, "-"),
    "sandwich, table of Schafer et al.": (palette.VERMILION, "--"),
    "nanocardboard plate": (palette.GREEN, "-"),
    "hollow sphere, corrected": (palette.PURPLE, "-"),
    "hollow sphere, as published": (palette.PURPLE, "--"),
    "hollow rocket, corrected": ("black", "-"),
    "hollow rocket, as published": ("black", "--"),
    "solar balloon": (palette.ORANGE, "-"),
}
"""Colour of the body; broken lines are models as published."""

SHOWN = {
    "payload": (1.0, 1e-10, "largest payload"),
    "payload_per_area": (1e3, 1e-3, "largest payload per area [g/m²]"),
}
"""Factor to the unit shown, lower end of the axis, label."""

_NO_RANGE = ("the flyer reaches", "the best design does not lift", "holes of")
_OPACITY = 0.15


def draw_all(rows, folder):
    """Payload for each largest size, and payload per area."""
    rows = [row for row in rows if "trouble" not in row]
    sizes = sorted({row["largest_m"] for row in rows})
    figure = plot.new_figure(columns=len(sizes), width=4.8, height=6.4)
    for largest, ax in zip(sizes, figure.axes, strict=True):
        for kind in KINDS:
            found = [row for row in rows if row["kind"] == kind.name
                     and row["objective"] == "payload" and row["largest_m"] == largest]  # fmt: skip
            line(ax, kind, found, "payload")
        size = f"{largest:g} m" if largest >= 1.0 else f"{100.0 * largest:g} cm"
        finish(ax, "payload", f"no larger than {size}")
    tops = [ax.get_ylim()[1] for ax in figure.axes]
    for ax in figure.axes:
        ax.set_ylim(SHOWN["payload"][1], max(tops))
    legend(figure)
    plot.save(figure, [folder / "payload.png"])

    figure = plot.new_figure(width=7.2, height=6.4)
    for kind in KINDS:
        line(figure.axes[0], kind, best_per_area(rows, kind), "payload_per_area")
    finish(figure.axes[0], "payload_per_area", "at the best size")
    legend(figure)
    plot.save(figure, [folder / "payload-per-area.png"])


def best_per_area(rows, kind):
    """The rows of most payload per area over the sizes, one an altitude."""
    found = {}
    for row in rows:
        if row["kind"] == kind.name:
            key = row["altitude_km"]
            if key not in found or row["payload_per_area"] > found[key]["payload_per_area"]:
                found[key] = row
    return [found[key] for key in sorted(found)]


def within_range(row):
    """Whether the model is within its range at the design."""
    return not [text for text in row["warnings"] if not text.startswith(_NO_RANGE)]


def line(ax, kind, rows, output):
    """One kind: a line with its band, and dots where its model is within its range."""
    if not rows:
        return
    scale, least, _ = SHOWN[output]
    colour, style = LOOKS[kind.name]
    altitude = np.array([row["altitude_km"] for row in rows])
    value = scale * np.array([row[output] for row in rows])
    low, high = scale * np.array([row[f"{output}_95"] for row in rows]).T
    flies = value > 0.0
    shown = np.where(flies, value, np.nan)
    ax.plot(altitude, shown, color=colour, ls=style, lw=1.5, label=kind.name)
    ax.fill_between(altitude, np.maximum(low, 0.1 * least), np.maximum(high, 0.1 * least),
                    where=high > 0.0, color=colour, alpha=_OPACITY, lw=0)  # fmt: skip
    known = flies & np.array([within_range(row) for row in rows])
    ax.plot(altitude[known], shown[known], "o", color=colour, ms=4)
    outside = flies & ~known
    ax.plot(altitude[outside], shown[outside], "o", color=colour, ms=4, mfc="white")


def finish(ax, output, title):
    """Axes of a panel."""
    ax.set_yscale("log")
    if output == "payload":
        ax.yaxis.set_major_formatter(lambda kilograms, _: in_words(kilograms))
    else:
        plot.plain_decades(ax.yaxis)
    ax.set_ylim(bottom=SHOWN[output][1])
    ax.set_xlim(18.0, 102.0)
    ax.set(xlabel="altitude [km]", ylabel=SHOWN[output][2], title=title)
    ax.grid(alpha=0.25)


def in_words(kilograms):
    """A mass in the unit that suits it."""
    units = {"kg": 1.0, "g": 1e-3, "mg": 1e-6, "µg": 1e-9}
    unit = next((unit for unit, size in units.items() if kilograms >= 0.99 * size), "µg")
    return f"{kilograms / units[unit]:.3g} {unit}"


def legend(figure):
    """One legend of all kinds below the panels."""
    found = {}
    for ax in figure.axes:
        found |= dict(zip(*reversed(ax.get_legend_handles_labels()), strict=True))
    handles = [found[name] for name in LOOKS if name in found]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, fontsize="small",
                  title="shaded: 95 % bands; open dots: the model is beyond its range",
                  title_fontsize="small")  # fmt: skip
