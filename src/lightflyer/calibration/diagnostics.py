"""What a reader of a calibration must know, in words."""

import math

import numpy as np

from lightflyer.calibration.calibration import Calibration
from lightflyer.calibration.gauge import found_step
from lightflyer.calibration.inputs import target_of
from lightflyer.core.errors import Doubt
from lightflyer.core.quantity import Quantity

LEAST_PROBABILITY = 0.01
"""Probability of chi-squared below which, or above one minus which, a warning says so."""

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


def diagnose(fit: Calibration) -> list[str]:
    """Diagnostics of a fit, one line each."""
    return [
        *fit.problem.model.design.warnings,
        *_about_columns(fit),
        *_about_errors(fit),
        *_about_intervals(fit),
        *_about_coverage(fit),
        *_about_inputs(fit),
        *_about_steps(fit),
    ]


def _about_columns(fit: Calibration) -> list[str]:
    """That a number is stated for the points, and yet fitted."""
    design, points = fit.problem.model.design, fit.points
    stated = {target_of(design, name, describes_flyer=True).fields for name in points.properties}
    return [
        f"{one.name} is fitted: its column in {points.source} is only where the fit starts"
        for one in fit.problem.parameters
        if one.target.fields in stated
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
                else f"within their ±, {_largest(fit, row)} allow any value"
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


def _largest(fit: Calibration, row: int) -> str:
    """Inputs that most of a parameter's uncertainty comes from."""
    squares = {name: float(shares[row] ** 2) for name, shares in fit.contributions.items()}
    whole = math.fsum(squares.values())
    large = [name for name, square in squares.items() if square > _LARGE_SHARE * whole]
    return " and ".join(large)


def _about_inputs(fit: Calibration) -> list[str]:
    inputs, design = fit.problem.inputs, fit.problem.model.design
    said = [
        f"the ± of {name} is not in the total: a column or parameter of another name replaces it"
        for name in inputs.left_out
    ]
    named = {name.partition("[")[0].rpartition(".")[2] for name in inputs.names}
    fitted = {
        field.rpartition(".")[2]
        for parameter in fit.problem.parameters
        for field in parameter.target.fields
    }
    numbers = {field.rpartition(".")[2] for field in design.quantities}
    bare = [
        name for name in ("tac_top", "tac_bottom") if name in numbers and name not in named | fitted
    ]
    if bare:
        said.append(
            f"{' and '.join(bare)} ha{'ve' if len(bare) > 1 else 's'} no ±, usually the largest "
            'part of a total interval; write it into the flyer file, such as "0.90 ± 0.03"'
        )
    return said


def _about_steps(fit: Calibration) -> list[str]:
    points = fit.points
    said = []
    for sample in dict.fromkeys(points.samples):
        step = found_step(points.irradiance[points.of(sample)])
        if step is not None and not points.step:
            said.append(step_warning(sample, step))
    return said


def step_warning(sample: str, step: float) -> str:
    """Warning of steps of the light that nobody stated."""
    return (
        f"the irradiances of {sample} lie on steps of {step:g} W/m^2: if the light was raised in "
        f"such steps, state step = {step:g} W/m^2, or results are half a step too high"
    )
