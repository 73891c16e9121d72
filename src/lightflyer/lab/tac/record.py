"""Records of fitted accommodation coefficients: the JSON object and the dataset."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.lab.estimate import Estimate, weighted_mean
from lightflyer.lab.result import csv_text, dataset, joint_warnings
from lightflyer.lab.tac.diagnostics import BOUNDS, POSSIBLE_TAC
from lightflyer.lab.tac.fit import TacFit
from lightflyer.lab.tac.problem import PARAMETERS

if TYPE_CHECKING:
    import xarray as xr

_ROUNDING = 1e-12  # relative


def mean_tac(fits: Sequence[TacFit]) -> Estimate:
    """Mean accommodation coefficient of several runs; see :func:`mean_of`."""
    return mean_of(fits, "tac")


def correlation_between_samples(fits: Sequence[TacFit]) -> float:
    """Correlation of the coefficients' errors between two samples measured on one bench [1]."""
    common = float(np.mean([_common_part(fit, "tac") for fit in fits]))
    total = mean_tac(fits).uncertainty or 0.0
    return min((common / total) ** 2, 1.0) if total else 0.0


def mean_of(fits: Sequence[TacFit], name: str) -> Estimate:
    """Mean of one parameter over runs on one bench."""
    if len(fits) == 1:
        return fits[0].estimates()[name]
    common = float(np.mean([_common_part(fit, name) for fit in fits]))
    mean = weighted_mean([with_spread(fit.statistical[name]) for fit in fits], common=common)
    low, high = BOUNDS[name]
    interval = (max(mean.interval[0], low), min(mean.interval[1], high))
    return Estimate(mean.value, interval, mean.unit, mean.uncertainty)


def why_no_property(fits: Sequence[TacFit]) -> str | None:
    """Why the coefficient cannot be that of a film, in one line; None if it can."""
    for fit in fits:
        if fit.undetermined:
            return fit.undetermined
    mean, first = mean_tac(fits), fits[0]
    said = (
        f"{first.run.source}: accommodation coefficient {mean.value:.3g} by the reading "
        f"{first.reading}"
    )
    if mean.interval[0] > POSSIBLE_TAC:
        return f"{said} is above 1 beyond its uncertainty"
    return None


def _common_part(fit: TacFit, name: str) -> float:
    """Standard uncertainty from errors that all rows, and all runs, have in common."""
    total, part = fit.estimates()[name].uncertainty, fit.statistical[name].uncertainty
    return math.sqrt(max((total or 0.0) ** 2 - (part or 0.0) ** 2, 0.0))


def with_spread(estimate: Estimate) -> Estimate:
    """The estimate; rows computed by a model have rounding for a spread, not zero."""
    spread = max(estimate.uncertainty or 0.0, _ROUNDING * abs(estimate.value))
    return Estimate(estimate.value, estimate.interval, estimate.unit, spread)


def warnings_of(fits: Sequence[TacFit]) -> list[str]:
    """Warnings of all runs; see :func:`~lightflyer.lab.record.joint_warnings`."""
    return joint_warnings([(fit.run.source, fit.warnings) for fit in fits])


def summary(fits: Sequence[TacFit]) -> dict[str, Any]:
    """One run, or the mean of several with each of them, as a JSON object."""
    related = {"correlation_between_samples": correlation_between_samples(fits)}
    if len(fits) == 1:
        return fits[0].summary() | related
    return related | {
        **{name: mean_of(fits, name).to_json() for name in PARAMETERS},
        "reading": fits[0].reading,
        "gas": fits[0].gas,
        "determined": all(fit.undetermined is None for fit in fits),
        "rows_used": sum(fit.rows_used for fit in fits),
        "rows_dropped": sum(fit.rows_dropped for fit in fits),
        "runs": {fit.run.source: fit.summary() for fit in fits},
        "warnings": warnings_of(fits),
    }


def to_dataset(fits: Sequence[TacFit], warnings: Sequence[str] | None = None) -> "xr.Dataset":
    """Rows of all runs over ``row``; ``warnings``: in place of those of the fits."""
    per_area = "W m-2 K-1"

    def joined(values: Sequence[np.ndarray], units: str, long_name: str) -> Any:
        return "row", np.concatenate(values), {"units": units, "long_name": long_name}

    run = [np.full(fit.rows_used, number) for number, fit in enumerate(fits)]
    return dataset(
        "thermal accommodation coefficient",
        {
            "run": joined(run, "1", "position of the file, from 0"),
            "line": joined([fit.run.table.lines[fit.kept] for fit in fits], "1", "line in it"),
            "pressure": joined([fit.pressure for fit in fits], "Pa", "gas pressure"),
            "conductance": joined(
                [fit.conductance for fit in fits], per_area,
                "power per nominal area and temperature difference",
            ),
            "fitted": joined([fit.fitted for fit in fits], per_area, "fitted conductance"),
        },
        [fit.run.source for fit in fits],
        warnings=warnings_of(fits) if warnings is None else warnings,
        reading=fits[0].reading,
        gas=fits[0].gas,
    )  # fmt: skip


def tables(fits: Sequence[TacFit]) -> dict[str, str]:
    """Fitted rows of each run as CSV, by file name."""
    return {
        f"tac-rows-{number}.csv": csv_text(
            [f"# {fit.run.source}"],
            fit.series(),
        )
        for number, fit in enumerate(fits, start=1)
    }  # fmt: skip
