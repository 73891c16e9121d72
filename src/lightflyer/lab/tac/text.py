"""Accommodation coefficients in words."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from lightflyer.core.text import correlation_text
from lightflyer.files.result_text import Parts, table_of
from lightflyer.lab.estimate import Estimate
from lightflyer.lab.tac.accuracy import IN_WORDS

if TYPE_CHECKING:
    from lightflyer.lab.tac.difference import TacDifference
    from lightflyer.lab.tac.fit import TacFit

_PERCENT = 100.0
_NAMES = {"tac": "TAC α", "area_ratio": "area ratio δ", "offset": "offset C"}
_PARAMETERS = ("", "value", "95 % interval", "of the scatter alone", "unit")
_ERRORS = ("error by the fit", "in stated ±", "stated ±", "unit")
_FACES = ("", "value", "95 % interval", "standard uncertainty")
_RUNS = ("run", "TAC α", "95 % interval", "area ratio δ", "offset C\n[W/(m² K)]")


def fit_parts(fit: "TacFit") -> Parts:
    """Parameters of one run."""
    yield (
        f"{fit.run.source}: heater at {fit.mean_temperature:.2f} K, coefficient of variation "
        f"{_PERCENT * fit.temperature_variation:.2g} %; {fit.rows_used} rows used, "
        f"{fit.rows_dropped} dropped for their temperature"
    )
    rows = [
        _parameter(_NAMES[name], one, fit.statistical[name].interval_text())
        for name, one in fit.estimates().items()
    ]
    slope = _parameter("slope δα", replace(fit.slope, unit=""), "")
    yield table_of(_PARAMETERS, [*rows, slope], left=(0, 2, 3, 4))
    others = ", ".join(
        f"{one:.3g} by {name}" for name, one in fit.by_reading.items() if one is not None
    )
    yield (
        f"reading {fit.reading}, gas {fit.gas}; the same rows give α = {others}\n"
        f"rows scatter by {_PERCENT * fit.scatter:.2g} % about the fit; "
        f"{correlation_text('αδC', fit.covariance)}"
    )


def errors_parts(fit: "TacFit") -> Parts:
    """Errors of the instruments that the fit takes; those of runs fitted together are the same."""
    errors = []
    for name, pull in fit.common_errors.items():
        words, scale, unit = IN_WORDS[name]
        errors.append((words, f"{pull:+.2f}", f"{scale * getattr(fit.accuracy, name):g}", unit))
    yield table_of(_ERRORS, errors, left=(0, 3))


def _parameter(name: str, one: Estimate, of_scatter: str) -> tuple[str, ...]:
    """Row of a parameter with its total and statistical intervals."""
    unit = one.unit.replace("^2", "²") or "1"
    return name, f"{one.value:.4g}", one.interval_text(), of_scatter, unit


def runs_parts(fits: "Sequence[TacFit]", mean: Estimate) -> Parts:
    """Table of runs, like the paper's table S2, and the mean of their coefficients."""
    rows = []
    for fit in fits:
        low, high = fit.tac.interval
        numbers = f"{fit.tac.value:.3f}", f"{low:.3f} to {high:.3f}"
        rows.append((
            fit.run.source, *numbers, f"{fit.area_ratio.value:.3f}", f"{fit.offset.value:.3f}"
        ))  # fmt: skip
    yield table_of(_RUNS, rows)
    yield f"mean accommodation coefficient {mean}"


def difference_parts(found: "TacDifference") -> Parts:
    """Difference of two faces, their coefficients, and the runs of each."""
    rows = [
        (name, f"{one.value:.4g}", one.interval_text(), f"{one.uncertainty:.2g}")
        for name, one in (
            ("TAC α, top less bottom", found.difference),
            ("TAC α, top", found.tac_top),
            ("TAC α, bottom", found.tac_bottom),
        )
    ]
    yield table_of(_FACES, rows, left=(0, 2))
    yield (
        f"the errors of both have a correlation of {found.tac_correlation:.4g}; if they shared "
        f"nothing, the difference would be uncertain by {found.unshared:.2g}"
    )
    if found.other_face is not None:
        yield (
            "α of each run below is the mean of that of the sample and that of the heater's other "
            f"face, {found.other_face.value:g}"
        )
    for name, fits in (("top", found.top), ("bottom", found.bottom)):
        yield f"{name} face"
        for fit in fits:
            yield from fit_parts(fit)
    yield from errors_parts(found.fits[0])
