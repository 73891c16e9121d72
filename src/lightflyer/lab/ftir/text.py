"""Emissivity from infrared spectra in words."""

from typing import TYPE_CHECKING

from lightflyer.files.result_text import Parts, table_of
from lightflyer.lab.readers.spectra.names import PER_CENTIMETRE

if TYPE_CHECKING:
    from rich.table import Table

    from lightflyer.lab.ftir.reduction import Ftir

_PERCENT = 100.0


def finding_parts(result: "Ftir") -> Parts:
    """The emissivity over the band, or its bound, in a sentence."""
    low, high = (end / PER_CENTIMETRE for end in result.covered)
    found = f"at most {result.at_most:.4g}" if result.emissivity is None else result.emissivity
    part = f", {_PERCENT * (1.0 - result.uncovered_band):.0f} % of the band"
    said = part * bool(result.uncovered_band)
    yield f"emissivity {found}, over {low:.5g} to {high:.5g} cm⁻¹{said}"


def ftir_parts(result: "Ftir") -> Parts:
    """Means over the band, and those weighted with Planck's spectrum."""
    low, high = (end / PER_CENTIMETRE for end in result.covered)
    accuracy = f"{_PERCENT * result.accuracy:.3g} %"
    yield f"over {low:.5g} to {high:.5g} cm⁻¹, 95 % intervals with an accuracy of {accuracy}:"
    yield f"  transmittance {result.transmittance.band}"
    if result.reflectance is None:
        yield f"  1 - transmittance {result.upper_bound}"
        yield f"  upper bound: emissivity at most {result.at_most:.4g} (95 %, one-sided)"
    else:
        yield f"  reflectance {result.reflectance.band}"
        yield f"  emissivity {result.emissivity}"
    if result.uncovered_band:
        yield f"  {_PERCENT * result.uncovered_band:.1f} % of the band has no data"
    yield (
        "weighted with Planck's spectrum over the measured wavenumbers; total: nothing or\n"
        "everything is emitted outside them"
    )
    yield _planck_table(result)


def _planck_table(result: "Ftir") -> "Table":
    """Planck-weighted means, and bounds with what lies outside the data."""
    measured, bounds = result.reflectance is not None, result.total_bounds()
    headings = (
        "at\n[K]", "\ntransmittance", "\nemissivity" if measured else "1 - trans-\nmittance",
        "\n95 % interval", "outside\nthe data",
        "total,\nbounds" if measured else "total, at\nmost (95 %)",
    )  # fmt: skip
    rows = []
    for temperature, estimate in result.planck_emissivity.items():
        ends, (least, most) = estimate.interval, bounds[temperature]
        rows.append((
            f"{temperature:g}", f"{result.transmittance.planck[temperature].value:.4f}",
            f"{estimate.value:.4f}", f"{ends[0]:.4f} to {ends[1]:.4f}",
            f"{_PERCENT * result.uncovered[temperature]:.1f} %",
            f"{least:.3f} to {most:.3f}" if measured else f"{most:.3f}",
        ))  # fmt: skip
    return table_of(headings, rows, left=())
