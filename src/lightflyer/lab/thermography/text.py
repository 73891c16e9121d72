"""Radiative properties in words."""

from typing import TYPE_CHECKING

from lightflyer.files.result_text import Parts, listed
from lightflyer.lab.estimate import estimate_table

if TYPE_CHECKING:
    from lightflyer.lab.thermography.reduction import RadiativeProperties


def finding_parts(result: "RadiativeProperties") -> Parts:
    """The properties in a sentence."""
    found = result.name_properties(result.first_order)
    yield f"{listed(f'{name} {one}' for name, one in found.items())}, {result.meaning}"


def properties_parts(result: "RadiativeProperties") -> Parts:
    """The properties with both intervals, and the uncertainties of the readings."""
    second = result.name_properties(result.monte_carlo)
    rows = []
    for name, estimate in result.name_properties(result.first_order).items():
        rows += [(name, estimate), ("  by Monte Carlo", second[name])]
    yield estimate_table(rows, result.meaning)
    method = result.readings.method
    spreads = ", ".join(
        f"{name.removesuffix('_temperature')} {one:.2g}"
        for name, one in zip(method.readings, result.readings.uncertainties, strict=True)
    )
    yield f"standard uncertainties of the readings: {spreads} {method.unit}".rstrip()
