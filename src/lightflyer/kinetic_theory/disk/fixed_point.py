"""Preconditioned iteration to the solution of the non-linear problem, with Anderson mixing."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from lightflyer.core.errors import ConvergenceError
from lightflyer.core.progress import report

_MOST_ITERATIONS = 60
_MEMORY = 12
_RENEWED = 0.03  # residual below which the preconditioner is renewed, once
_THIN_GAS = 1.0  # δ up to which the linear problem's factors precondition as well


class Problem(NamedTuple):
    """A state of the gas is looked for of which nothing is missing."""

    # What follows from a state, less that state; of its shape
    missing: Callable[[np.ndarray], np.ndarray]
    # From what is missing, the step that would leave nothing missing in the linear problem
    precondition: Callable[[np.ndarray], np.ndarray]
    renew: Callable[[np.ndarray], None]  # Precondition by the equation linearised about a state
    # From a state and a new one, one on the way where what must stay positive at most halves
    damped: Callable[[np.ndarray, np.ndarray], np.ndarray]


def iterate(
    problem: Problem, start: np.ndarray, tolerance: float, rarefaction: float
) -> tuple[np.ndarray, np.ndarray, int]:
    """Iterate until nothing is missing; returns ``state``, ``step``, ``iterations``."""
    renewable = rarefaction > _THIN_GAS
    if renewable:
        problem.renew(start)
    state, residual = start.copy(), np.inf
    steps: list[np.ndarray] = []
    states: list[np.ndarray] = []
    for iteration in range(1, _MOST_ITERATIONS + 1):
        missing = problem.missing(state)
        step = problem.precondition(missing)
        residual = float(np.abs(step).max())
        report(f"solving the non-linear equation, residual {residual:.1e}")
        if residual < tolerance:
            return state, step, iteration
        if not np.isfinite(residual):
            raise ConvergenceError("the non-linear kinetic equation diverged")
        if renewable and residual < _RENEWED:
            # the temperatures are now accurate enough to precondition about
            renewable = False
            problem.renew(state)
            step, steps, states = problem.precondition(missing), [], []
        steps.append(step.ravel())
        states.append(state.ravel())
        del steps[:-_MEMORY], states[:-_MEMORY]
        state = problem.damped(state, _anderson(states, steps).reshape(state.shape))
    raise ConvergenceError(
        f"the non-linear kinetic equation did not converge in {_MOST_ITERATIONS} iterations: "
        f"last residual {residual:.1e}"
    )


def _anderson(states: list[np.ndarray], steps: list[np.ndarray]) -> np.ndarray:
    """Next state by Anderson mixing of the last states and their steps."""
    if len(steps) == 1:
        return states[-1] + steps[-1]
    differences = np.stack([steps[-1] - step for step in steps[:-1]], axis=1)
    weights = np.linalg.lstsq(differences, steps[-1], rcond=1e-12)[0]
    state, step = states[-1].copy(), steps[-1].copy()
    for k, weight in enumerate(weights):
        state -= weight * (states[-1] - states[k])
        step -= weight * (steps[-1] - steps[k])
    return state + step
