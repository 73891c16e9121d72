"""Forces on a heated vane in words."""

from typing import TYPE_CHECKING

from lightflyer.files.result_text import Parts, table_of
from lightflyer.force.kinetic.walls import IN_WORDS

if TYPE_CHECKING:
    from lightflyer.lab.force.vane import VaneForces

MICRONEWTON = 1e-6
ASSUMES = (
    "assumes a thin vane in open space: neither thickness nor walls of the chamber are part of an "
    "interval"
)
_HEADINGS = (
    "pressure\n[Pa]",
    "Kn",
    "measured\n[µN]",
    "predicted\n[µN]",
    "measured over\npredicted",
)


def force_parts(found: "VaneForces") -> Parts:
    """Largest force, points beside the curve, and their ratio."""
    if found.points is not None:
        count = len(found.points.numbers["force"])
        yield f"measured over predicted, {count} points: {found.ratio} (95 %)"
    at, most = found.largest
    (place,) = (found.pressure == at).nonzero()
    low, high = found.band[:, place[0]] / MICRONEWTON
    (knudsen,) = found.vane.knudsen(found.pressure[place])
    yield (
        f"largest force predicted: {most / MICRONEWTON:.3g} µN ({low:.3g} to {high:.3g}) at "
        f"{at:.3g} Pa, Kn {knudsen:.2g}"
    )
    if found.points is not None:
        pressure, measured = (found.points.numbers[name] for name in ("pressure", "force"))
        rows = zip(
            pressure, found.vane.knudsen(pressure), measured / MICRONEWTON,
            found.predicted / MICRONEWTON, measured / found.predicted, strict=True,
        )  # fmt: skip
        yield table_of(_HEADINGS, ([f"{number:.3g}" for number in row] for row in rows))
    yield IN_WORDS[found.vane.wall]
    yield ASSUMES
