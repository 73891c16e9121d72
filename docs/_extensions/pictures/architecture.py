"""How the parts of the package fit, in one picture."""

from __future__ import annotations

from html import escape

_BOXES = (
    # x, y, width, title, what it gives
    (10, 10, 215, "Flyer", ("film, shape, mass:", "heat per node, area, weight")),
    (252, 10, 215, "Environment", ("Earth, Mars, chamber:", "p, T, gas, gravity, light")),
    (494, 10, 215, "Force model", ("lift and heat loss", "at given temperatures")),
    (131, 122, 457, "Heat balance", ("absorbed + other gains = gas + radiated: one root per node,",
                                     "with its derivative from the residual at the root")),
    (131, 224, 457, "Levitation", ("lift = weight: irradiance, payload, edges of the band", "")),
    (131, 310, 457, "Verdict", ("where it flies, where its film survives,",
                                "where the model may be believed")),
)  # fmt: skip
_GUESTS = ("predict", "sweep", "optimise", "uncertainty", "mission", "compare")
_TALL = 78
_SHORT = 62


def _box(x: float, y: float, width: float, title: str, lines: tuple[str, ...]) -> str:
    tall = _TALL if all(lines) else _SHORT
    texts = "".join(
        f'<text class="lf-quiet" x="{x + width / 2:g}" y="{y + 44 + 17 * at:g}" '
        f'text-anchor="middle">{escape(line)}</text>'
        for at, line in enumerate(lines)
    )
    return (
        f'<rect class="lf-box" x="{x:g}" y="{y:g}" width="{width:g}" height="{tall}" rx="6"/>'
        f'<text class="lf-title" x="{x + width / 2:g}" y="{y + 24:g}" text-anchor="middle">'
        f"{escape(title)}</text>{texts}"
    )


def _arrow(x1: float, y1: float, x2: float, y2: float) -> str:
    return (
        f'<path class="lf-flow" d="M{x1:g} {y1:g}L{x2:g} {y2 - 6:g}"/>'
        f'<polygon class="lf-flow" points="{x2:g},{y2:g} {x2 - 5:g},{y2 - 9:g} '
        f'{x2 + 5:g},{y2 - 9:g}"/>'
    )


def html() -> str:
    """The picture."""
    boxes = "".join(_box(*one) for one in _BOXES)
    arrows = "".join(
        _arrow(*ends)
        for ends in ((118, 88, 200, 122), (360, 88, 360, 122), (602, 88, 520, 122),
                     (360, 200, 360, 224), (360, 286, 360, 310))
    )  # fmt: skip
    guests = ""
    for at, name in enumerate(_GUESTS):
        x = 10 + 118 * at
        arrows += _arrow(min(max(x + 54, 150), 570), 388, x + 54, 424)
        guests += (
            f'<rect class="lf-box lf-guest" x="{x}" y="424" width="109" height="36" rx="6"/>'
            f'<text x="{x + 54.5:g}" y="447" text-anchor="middle">{name}</text>'
        )
    label = (
        "Flyer, environment and force model meet in the heat balance. Levitation and the verdict "
        "follow from it. Predictions, sweeps, searches, uncertainties, missions and comparisons "
        "use them."
    )
    return (
        '<figure class="lf-figure"><svg class="lf-drawing lf-wide-drawing" '
        f'viewBox="0 0 720 470" role="img" aria-label="{escape(label)}">'
        f"{arrows}{boxes}{guests}</svg></figure>"
    )
