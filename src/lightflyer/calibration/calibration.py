"""Numbers that were fitted to levitation points, their uncertainties, text and diagnostics."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.special import chdtrc

from lightflyer.calibration.gauge import found_step
from lightflyer.calibration.inputs import target_of
from lightflyer.calibration.points import LEAST_PROBABILITY, Points
from lightflyer.calibration.problem import Problem
from lightflyer.config.update import Fitted
from lightflyer.core.errors import Doubt, ParameterError
from lightflyer.core.quantity import Quantity
from lightflyer.core.text import correlation_text, rounded
from lightflyer.design.setup import Setup
from lightflyer.files.display_units import suitable
from lightflyer.files.result_text import (
    Parts,
    PrintedResult,
    listed,
    open_interval_text,
    table_of,
    warning_lines,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_NORMAL = 1.959963984540054  # half width of a normal 95 % interval, in standard deviations

_FIT = ("parameter", "value", "given inputs\n95 %", "total\n95 %", "total\n±")

FAR_ABOVE = 3.0
"""Scatter over what the points' uncertainties say, from which the fit is in doubt."""

_SCATTER = Quantity(
    likely=(0.0, 0.25), known="repeated levitations of one film agree within some percent"
)
_USUAL = {
    "c_fm": Quantity(
        likely=(0.1, 4.0), known="the paper has 0.4, its uncertain TACs leave it 0.21 to 2.4"
    ),
    "c_cont": Quantity(
        likely=(0.3, 30.0), known="the paper has 3; a tenth or ten times it is of another unit"
    ),
}
"""Of coefficients in the limits of thin and of dense gas."""

_UNLIKE = 3.0  # points of neighbouring pressures that err alike, from which the fit is in doubt
_COVERED = 0.5  # of the force at some point, for a coefficient to be that of the points
_LARGE_SHARE = 0.1  # of the inputs' variance, for an input to be named
_LIMITS = {"c_fm": "lower", "c_cont": "higher"}
"""Coefficients of the limits of thin and of dense gas, and where these are."""

_AT_END = 1e-3  # relative distance of a value from the end of its range


@dataclass(frozen=True, repr=False)
class Calibration(PrintedResult):
    """A fit of parameters to levitation points."""

    problem: Problem  #: Design, points and parameters
    values: np.ndarray  #: shape (p,); fitted parameters, in SI units
    #: shape (p, p); covariance of the values by the points' scatter, to first order: at the inputs
    #: as given
    covariance: np.ndarray
    #: shape (p, 2); 95 % profile-likelihood intervals, at the inputs as given. An end beyond which
    #: the points set no bound is zero, infinite, or the largest possible value
    intervals: np.ndarray
    #: shape (p, p); covariance that also contains the inputs' uncertainties, to first order
    total_covariance: np.ndarray
    #: shape (p, 2); 95 % intervals that also contain the inputs' uncertainties
    total_intervals: np.ndarray
    #: shape (p,); relative standard uncertainty of each parameter by each input, to first order
    contributions: dict[str, np.ndarray]
    #: Root of the mean square of the residuals in log-irradiance per degree of freedom [1]
    scatter: float
    estimated_scatter: bool  #: Whether the points' uncertainty was estimated from their scatter
    #: Sum of the squared residuals over the points' stated uncertainties; NaN where none are stated
    chi_squared: float
    freedom: int  #: Degrees of freedom of ``chi_squared``
    error_scale: float  #: Factor by which the stated uncertainties were multiplied
    residuals: np.ndarray  #: shape (n,); measured minus fitted log-irradiance
    #: Points of neighbouring pressures whose residuals are alike: 1 where the model fits. Intervals
    #: from an estimated scatter are those of so many times fewer points
    alike: float
    #: shape (n,); standard uncertainty of each point's log-irradiance, that of pressure included
    uncertainty: np.ndarray
    fitted: np.ndarray  #: shape (n,); fitted irradiance [W/m²]
    warnings: tuple[str, ...]  #: What a reader of the result must know, one line each

    @property
    def names(self) -> list[str]:
        """Names of the parameters, ``"emittance[Ge 2 cm]"`` where one is of one sample alone."""
        return self.problem.names

    @property
    def points(self) -> Points:
        """The points."""
        return self.problem.points

    @property
    def standard_uncertainties(self) -> np.ndarray:
        """Square roots of the covariance's diagonal, shape (p,): at the inputs as given."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def total_standard_uncertainties(self) -> np.ndarray:
        """Square roots of the total covariance's diagonal, shape (p,)."""
        return np.sqrt(np.diag(self.total_covariance))

    @property
    def reduced_chi_squared(self) -> float:
        """Chi-squared over its degrees of freedom; NaN where it has none."""
        return self.chi_squared / self.freedom if self.freedom else math.nan

    @property
    def chi_squared_probability(self) -> float:
        """Probability of a larger chi-squared, if the stated uncertainties are right."""
        return float(chdtrc(self.freedom, self.chi_squared)) if self.freedom else math.nan

    @property
    def setup(self) -> Setup:
        """The design with the fitted values of the parameters that all samples share."""
        shared = {
            field: parameter.target.factor * float(value)
            for parameter, value in zip(self.problem.parameters, self.values, strict=True)
            if parameter.chosen.all()
            for field in parameter.target.fields
        }
        model = self.problem.model
        return model.design.build(shared, model.prepared)

    def for_flyer_file(self) -> dict[tuple[str, str], Fitted]:
        """Values with total ± by section and key of a flyer file.

        Those that all samples share. The ± is that of a normal distribution as wide as the total
        95 % interval.

        Raises
        ------
        ParameterError
            If all parameters are of single samples, or one is of a part of a section.
        """
        found = {}
        for row, parameter in enumerate(self.problem.parameters):
            spread, ends = self.total_standard_uncertainties[row], self.total_intervals[row]
            if np.all(np.isfinite(ends)):
                spread = np.ptp(ends) / (2.0 * _NORMAL)
            for field in parameter.target.fields if parameter.chosen.all() else ():
                factor, (section, dot, key) = parameter.target.factor, field.partition(".")
                if not dot or "." in key:
                    raise ParameterError(f"{field} stands in a part of a section: write it by hand")
                value = factor * float(self.values[row])
                unit = parameter.target.quantity.unit
                found[section, key] = Fitted(value, factor * float(spread), unit)
        if not found:
            raise ParameterError(
                f"{', '.join(self.names)}: of one sample each; a flyer file has one flyer"
            )
        return found

    def plot(self, ax: "Axes | None" = None) -> "Figure":
        """Draw the points with the fit, and the residuals."""
        from lightflyer.calibration.figures import plot_calibration

        return plot_calibration(self, ax)

    def text_parts(self) -> Parts:
        yield from fit_parts(self)
        yield from warning_lines(self.warnings)

    def summary(self) -> dict[str, Any]:
        """The fit as a JSON object; what is infinite or unknown is null."""
        return {
            "parameters": {
                name: {
                    "value": float(self.values[row]),
                    "standard_uncertainty": _plain(self.standard_uncertainties[row]),
                    "interval_95": _plain(self.intervals[row]),
                    "total_standard_uncertainty": _plain(self.total_standard_uncertainties[row]),
                    "total_interval_95": _plain(self.total_intervals[row]),
                    "relative_uncertainty_by_input": {
                        input_: _plain(shares[row]) for input_, shares in self.contributions.items()
                    },
                }
                for row, name in enumerate(self.names)
            },
            "interval_95": "at the inputs as given: by the points' scatter alone",
            "total_interval_95": "by the points' scatter and the uncertainties of the inputs",
            "inputs_in_total": list(self.contributions),
            "covariance": _plain(self.covariance),
            "total_covariance": _plain(self.total_covariance),
            "points": len(self.points),
            "samples": list(dict.fromkeys(self.points.samples)),
            "scatter_log_irradiance": self.scatter,
            "scatter_is_estimated": self.estimated_scatter,
            "reduced_chi_squared": _plain(self.reduced_chi_squared),
            "chi_squared_probability": _plain(self.chi_squared_probability),
            "stated_errors_scaled_by": self.error_scale,
            "alike_points": self.alike,
            "warnings": list(self.warnings),
        }


def _plain(numbers: Any) -> Any:
    """Numbers as JSON has them."""
    if np.ndim(numbers):
        return [_plain(one) for one in numbers]
    return float(numbers) if np.isfinite(numbers) else None


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
    samples = len(set(fit.points.samples))
    points = f"{len(fit.points)} points of {samples} sample{'s' * (samples > 1)}"
    yield f"{points} give {listed(found)}; brackets: total 95 % intervals"
    yield table_of(_FIT, rows)
    # what the intervals of the table contain, in words
    kind = "estimated from the scatter" if fit.estimated_scatter else "as stated in the file"
    if fit.error_scale != 1.0:
        kind = f"as stated in the file, times {fit.error_scale:.3g}"
    chi_squared = (
        f"; reduced chi-squared {fit.reduced_chi_squared:.3g}"
        if math.isfinite(fit.reduced_chi_squared)
        else ""
    )
    yield (
        f"{points} scatter by {rounded(100.0 * fit.scatter)} % of the irradiance; their "
        f"uncertainty is {kind}{chi_squared}"
    )
    yield "given inputs: the points' scatter alone, everything else exactly as stated"
    shares = ", ".join(
        f"{name} ({', '.join(f'{rounded(100.0 * share)} %' for share in values)})"
        for name, values in fit.contributions.items()
    )
    yield f"total: also the ± of {shares or 'nothing else, since nothing has one'}"
    if len(fit.names) > 1:
        yield f"{correlation_text(fit.names, fit.covariance)} (given inputs)"


def diagnose(fit: Calibration) -> list[str]:
    """Diagnostics of a fit, one line each."""
    design, points = fit.problem.model.design, fit.points
    # numbers that are stated for the points, and yet fitted
    stated = {target_of(design, name, describes_flyer=True).fields for name in points.properties}
    columns = (
        f"{one.name} is fitted: its column in {points.source} is only where the fit starts"
        for one in fit.problem.parameters
        if one.target.fields in stated
    )
    inputs = fit.problem.inputs
    said = [
        f"the ± of {name} is not in the total: a column or parameter of another name replaces it"
        for name in inputs.left_out
    ]
    named = {name.partition("[")[0].rpartition(".")[2] for name in inputs.names}
    named |= {field.rpartition(".")[2] for one in fit.problem.parameters
              for field in one.target.fields}  # fmt: skip
    numbers = {field.rpartition(".")[2] for field in design.quantities}
    bare = [name for name in ("tac_top", "tac_bottom") if name in numbers - named]
    if bare:
        said.append(
            f"{' and '.join(bare)} ha{'ve' if len(bare) > 1 else 's'} no ±, usually the largest "
            'part of a total interval; write it into the flyer file, such as "0.90 ± 0.03"'
        )
    samples = () if points.step else dict.fromkeys(points.samples)
    steps = {sample: found_step(points.irradiance[points.of(sample)]) for sample in samples}
    return [
        *design.warnings,
        *columns,
        *_about_errors(fit),
        *_about_intervals(fit),
        *_about_coverage(fit),
        *said,
        *(step_warning(sample, step) for sample, step in steps.items() if step is not None),
    ]


def _about_errors(fit: Calibration) -> list[str]:
    if not fit.freedom:
        return [
            Doubt("there are as many parameters as points: nothing shows whether the model fits")
        ]
    said: list[str] = []
    if fit.alike > 1.0:
        count = len(fit.points)
        text = (
            "residuals at neighbouring pressures are alike, as if of only "
            f"{count / fit.alike:.0f} points in place of {count}: the model does not fit them; "
            "intervals are wider for it"
        )
        said.append(Doubt(text) if fit.alike > _UNLIKE else text)
    if fit.estimated_scatter:
        unlikely = _SCATTER.unlikely(fit.scatter)
        return [*said, Doubt(f"scatter of the points {unlikely}")] if unlikely else said
    if fit.error_scale != 1.0:
        if fit.error_scale < FAR_ABOVE:
            return said
        text = f"the stated uncertainties of the points had to be scaled by {fit.error_scale:.3g}"
        return [*said, Doubt(f"{text}: the model, or something not stated, does not fit")]
    found = f"reduced chi-squared {fit.reduced_chi_squared:.3g}, {fit.freedom} degrees of freedom"
    ratio = math.sqrt(fit.reduced_chi_squared)
    if fit.chi_squared_probability < LEAST_PROBABILITY:
        text = (
            f"the points scatter {ratio:.3g} times as much as their stated uncertainties say "
            f"({found}): the intervals are too narrow; scale the errors, or find what the "
            "uncertainties or the model leave out"
        )
        return [*said, Doubt(text) if ratio >= FAR_ABOVE else text]
    if fit.chi_squared_probability > 1.0 - LEAST_PROBABILITY:
        return [
            f"the points scatter only {ratio:.2g} times as much as their stated uncertainties say "
            f"({found}): the intervals may be too wide"
        ]
    return said


def _about_intervals(fit: Calibration) -> list[str]:
    said: list[str] = []
    for row, (name, parameter) in enumerate(zip(fit.names, fit.problem.parameters, strict=True)):
        usual = _USUAL.get(name.rpartition(".")[2], parameter.target.quantity)
        doubt = usual.unlikely(fit.values[row])
        said += [Doubt(f"{name} = {doubt}")] if doubt else []
        squares = {key: float(shares[row] ** 2) for key, shares in fit.contributions.items()}
        whole = math.fsum(squares.values())
        large = [key for key, square in squares.items() if square > _LARGE_SHARE * whole]
        least, most = parameter.ends
        at = np.exp(parameter.log_bounds)
        if np.any(np.abs(fit.values[row] / at - 1.0) < _AT_END):
            said.append(
                Doubt(
                    f"{name} = {fit.values[row]:.4g} is the end of its range: the points, or the "
                    "inputs, do not fit a value inside; fix it, or check the inputs"
                )
            )
        for end, bound, word, limit in (
            (0, least, "lower", f"zero ({least:g})" if least else "zero"),
            (1, most, "upper", f"{most:g}, the largest possible value"),
        ):
            if fit.total_intervals[row, end] != bound:
                continue
            why = (
                "the points do not determine it there"
                if fit.intervals[row, end] == bound
                else f"within their ±, {' and '.join(large)} allow any value"
            )
            if math.isinf(bound) or bound == 0.0:
                said.append(Doubt(f"{name} has no {word} bound: {why}"))
            else:
                said.append(f"the interval of {name} is cut at {limit}: {why}")
    return said


def _about_coverage(fit: Calibration) -> list[Doubt]:
    """That no point is where a force coefficient, which is named as that of a limit, counts."""
    slopes = np.abs(fit.problem.linearise(np.log(fit.values)).jacobian)
    rows = {
        name.rpartition(".")[2]: row
        for row, name in enumerate(fit.names)
        if name.rpartition(".")[2] in _LIMITS
    }
    if not rows:
        return []
    # where the light grows as the force falls, that of both together is at least 1
    whole = np.maximum(slopes[:, list(rows.values())].sum(axis=1), 1.0)
    said = []
    for name, row in rows.items():
        share = slopes[:, row] / whole
        best = int(np.argmax(share))
        if share[best] < _COVERED:
            said.append(
                Doubt(
                    f"{name} limits the force at no point: by at most {100.0 * share[best]:.0f} %, "
                    f"at {fit.points.pressure[best]:.3g} Pa; points at {_LIMITS[name]} pressures "
                    "would measure it"
                )
            )
    return said


def step_warning(sample: str, step: float) -> str:
    """Warning of steps of the light that nobody stated."""
    return (
        f"the irradiances of {sample} lie on steps of {step:g} W/m^2: if the light was raised in "
        f"such steps, state step = {step:g} W/m^2, or results are half a step too high"
    )
