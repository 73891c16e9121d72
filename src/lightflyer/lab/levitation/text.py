"""Curves through levitation points in words."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from lightflyer.files.result_text import Parts, open_interval_text, table_of

if TYPE_CHECKING:
    from lightflyer.lab.estimate import Estimate
    from lightflyer.lab.levitation.curve import LevitationCurve

_HEADINGS = ("sample", "points", "W/m²", "95 % interval", "at Pa", "95 % interval")


def curves_parts(curves: "Sequence[LevitationCurve]") -> Parts:
    """What the sample needs that needs least light, and all of them."""
    least = min(curves, key=lambda curve: curve.minimum_irradiance.value)
    words = "needs" if len(curves) == 1 else f"needs the least light of {len(curves)} samples,"
    light, of_light = _number(least.minimum_irradiance)
    place, of_place = _number(least.optimal_pressure)
    yield f"{least.points.name} {words} {light} W/m² ({of_light}), at {place} Pa ({of_place})"
    rows = [
        (
            curve.points.name,
            str(len(curve.points.pressure)),
            *_number(curve.minimum_irradiance),
            *_number(curve.optimal_pressure),
        )
        for curve in curves
    ]
    yield table_of(_HEADINGS, rows, title="minimum irradiance and its pressure")


def _number(found: "Estimate") -> tuple[str, str]:
    return f"{found.value:.4g}", open_interval_text(*found.interval)
