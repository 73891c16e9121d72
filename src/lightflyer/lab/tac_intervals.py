"""Intervals of a heater's fitted parameters, from their covariance and from the profile."""

import warnings
from typing import Any

import numpy as np
from scipy import stats

from lightflyer.lab.estimate import CONFIDENCE, Estimate
from lightflyer.lab.tac_problem import PARAMETERS, Problem, import_lmfit, minimise

_UNITS = ("", "", "W/(m^2 K)")
_ROUNDING = 1e-10  # relative scatter that is rounding, not noise


def covariance_estimates(result: Any, freedom: int) -> dict[str, Estimate]:
    """Parameters with the symmetric intervals of their covariance.

    Parameters
    ----------
    result : lmfit.minimizer.MinimizerResult
    freedom : int
        Degrees of freedom.

    Returns
    -------
    dict of str to Estimate
        By names of :data:`~lightflyer.lab.tac_problem.PARAMETERS`.
    """
    spread = np.sqrt(np.diag(np.asarray(result.covar)))
    return {
        name: Estimate.normal(float(result.params[name].value), float(one), unit, freedom)
        for name, one, unit in zip(PARAMETERS, spread, _UNITS, strict=True)
    }


def profile_estimates(
    problem: Problem, minimizer: Any, result: Any, by_covariance: dict[str, Estimate]
) -> dict[str, Estimate]:
    """Parameters with the intervals of the profile likelihood.

    Parameters
    ----------
    problem : Problem
    minimizer, result
        From :func:`~lightflyer.lab.tac_problem.minimise`.
    by_covariance : dict of str to Estimate
        From :func:`covariance_estimates`. Rows computed by a model have no scatter and no profile;
        they keep these intervals.

    Returns
    -------
    dict of str to Estimate
        An end that does not exist is infinite.
    """
    if result.chisqr < (len(problem.conductance) - len(PARAMETERS)) * _ROUNDING**2:
        return by_covariance
    profile = _profile_intervals(problem, minimizer, result)
    return {
        name: Estimate(one.value, profile[name], one.unit, one.uncertainty)
        for name, one in by_covariance.items()
    }


def _profile_intervals(
    problem: Problem, minimizer: Any, result: Any
) -> dict[str, tuple[float, float]]:
    lmfit = import_lmfit()
    grouped = problem.grouped()
    if grouped is not problem:
        values = [float(result.params[name].value) for name in PARAMETERS]
        minimizer, result = minimise(grouped, values)
        variance = float(np.mean(problem.residuals(*values) ** 2))

        def probability(best: Any, other: Any) -> float:
            return float(stats.chi2.cdf((other.chisqr - best.chisqr) / variance, 1))
    else:

        def probability(best: Any, other: Any) -> float:
            return float(lmfit.confidence.f_compare(best, other))

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # an end that is not found is infinite, which says so
        found = lmfit.conf_interval(minimizer, result, sigmas=[CONFIDENCE], prob_func=probability)
    return {name: (float(ends[0][1]), float(ends[-1][1])) for name, ends in found.items()}
