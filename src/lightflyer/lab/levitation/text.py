"""Curves through levitation points in words."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from lightflyer.files.result_text import Parts, open_interval_text, table_of

if TYPE_CHECKING:
    from lightflyer.lab.levitation.curve import LevitationCurve

_HEADINGS = ("sample", "points", "W/m²", "95 % interval", "at Pa", "95 % interval")


def curves_parts(curves: "Sequence[LevitationCurve]") -> Parts:
    """Minimum irradiance of each sample and its pressure."""
    rows = []
    for curve in curves:
        rows.append([curve.points.name, str(len(curve.points.pressure))])
        for estimate in (curve.minimum_irradiance, curve.optimal_pressure):
            rows[-1] += [f"{estimate.value:.4g}", open_interval_text(*estimate.interval)]
    yield "minimum irradiance and its pressure:"
    yield table_of(_HEADINGS, rows)
