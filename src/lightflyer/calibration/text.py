"""A calibration in words: lines and tables."""

import math
from typing import TYPE_CHECKING, Any

from lightflyer.core.text import correlation_text, rounded
from lightflyer.files.display_units import suitable
from lightflyer.files.result_text import Parts, listed, open_interval_text, table_of

if TYPE_CHECKING:
    from lightflyer.calibration.bayes import Posterior
    from lightflyer.calibration.calibration import Calibration

_FIT = ("parameter", "value", "given inputs\n95 %", "total\n95 %", "total\n±")
_POSTERIOR = ("posterior\nat given inputs", "mean", "standard\ndeviation", "95 % interval",
              "R-hat", "effective")  # fmt: skip


def fit_parts(fit: "Calibration") -> Parts:
    """The parameters in a sentence, with both intervals, and what these contain."""
    found, rows = [], []
    for row, (name, value) in enumerate(zip(fit.names, fit.values, strict=True)):
        factor, unit = suitable(fit.problem.parameters[row].target.quantity.unit, value)
        total = open_interval_text(*(factor * fit.total_intervals[row]))
        shown = f"{factor * value:.4g}"
        found.append(f"{name} {' '.join(filter(None, (shown, unit)))} ({total})")
        rows.append(
            (
                f"{name} [{unit}]" if unit else name,
                shown,
                open_interval_text(*(factor * fit.intervals[row])),
                total,
                rounded(factor * fit.total_standard_uncertainties[row]),
            )
        )
    yield f"{_points(fit)} give {listed(found)}; brackets: total 95 % intervals"
    yield table_of(_FIT, rows)
    yield from _explain(fit)
    if len(fit.names) > 1:
        yield f"{correlation_text(fit.names, fit.covariance)} (given inputs)"


def _explain(fit: "Calibration") -> list[str]:
    """What the intervals of the table contain, in words."""
    kind = "estimated from the scatter" if fit.estimated_scatter else "as stated in the file"
    if fit.error_scale != 1.0:
        kind = f"as stated in the file, times {fit.error_scale:.3g}"
    chi_squared = (
        f"; reduced chi-squared {fit.reduced_chi_squared:.3g}"
        if math.isfinite(fit.reduced_chi_squared)
        else ""
    )
    shares = ", ".join(
        f"{name} ({_percentages(values)})" for name, values in fit.contributions.items()
    )
    return [
        f"{_points(fit)} scatter by {rounded(100.0 * fit.scatter)} % of the irradiance; their "
        f"uncertainty is {kind}{chi_squared}",
        "given inputs: the points' scatter alone, everything else exactly as stated",
        f"total: also the ± of {shares or 'nothing else, since nothing has one'}",
    ]


def _points(fit: "Calibration") -> str:
    samples = len(set(fit.points.samples))
    return f"{len(fit.points)} points of {samples} sample{'s' * (samples > 1)}"


def _percentages(shares: Any) -> str:
    """Relative standard uncertainty of each parameter by one input."""
    return ", ".join(f"{rounded(100.0 * share)} %" for share in shares)


def posterior_parts(drawn: "Posterior") -> Parts:
    """Mean, interval and convergence of each parameter."""
    rows = (
        (
            name,
            f"{found['mean']:.4g}",
            rounded(found["standard_deviation"]),
            "{:.4g} to {:.4g}".format(*found["interval_95"]),
            f"{found['r_hat']:.3f}",
            f"{found['effective_draws']:.0f}",
        )
        for name, found in drawn.summary()["parameters"].items()
    )
    yield table_of(_POSTERIOR, rows)
    chains, draws = drawn.draws.shape[:2]
    yield f"{chains * draws} draws in {chains} chains, {drawn.divergences} divergent"
