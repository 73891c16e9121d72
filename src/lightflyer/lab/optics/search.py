"""The minima of a problem, the errors of its points, and the intervals of its numbers."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import qmc

from lightflyer.core.errors import ConvergenceError
from lightflyer.lab.estimate import student_factor
from lightflyer.lab.optics.model import LEAST_ERROR, FilmProblem, FilmSolution
from lightflyer.numerics.residuals import correlation_length

STARTS = 16  # Points between the bounds from which minima are looked for

_ROUNDS = 4  # of the points' errors, each from the residuals before
_SETTLED = 0.05  # relative change of the errors
_SAME = 0.01  # distance of two minima, in shares of the way between the bounds
_FEWEST = 2.0  # independent points of a spectrum, at least
_MOST_LOST = 0.9  # share of the independent points that a fit takes up, at most
_STEPS = 12  # outward, of the end of an interval
_GROWTH = 1.6
_REFINEMENTS = 8
_FINE = 0.02  # of a standard error, to which an end is found
_LEAST_REACH = 1e-6  # between the bounds
_BETTER = 0.5  # fall of the cost that makes another point the minimum


@dataclass(frozen=True)
class Scatter:
    """How the points of a spectrum scatter about its fit."""

    deviation: float  # Standard deviation of the residuals [1]
    length: float  # Points in which they are alike: one if they are independent
    independent: float  # Points that are independent of each other, in effect
    freedom: float  # Degrees of freedom of the error of a point, whose length is itself estimated

    @property
    def error(self) -> float:
        """Standard error of a point, as if points were independent [1]."""
        return float(max(self.deviation, LEAST_ERROR) * np.sqrt(self.length))


@dataclass(frozen=True)
class FilmFit:
    """The best minimum with what else there is."""

    problem: FilmProblem  # With the points' errors that the residuals show
    best: FilmSolution
    # Other minima, and by how much their cost exceeds the best
    rivals: tuple[tuple[FilmSolution, float], ...]
    scatter: tuple[Scatter, ...]  # One per spectrum
    freedom: float  # Degrees of freedom

    @property
    def factor(self) -> float:
        """Half width of a 95 % interval in standard errors."""
        return student_factor(self.freedom)


def scatter_of(problem: FilmProblem, solution: FilmSolution) -> tuple[Scatter, ...]:
    """Scatter of each spectrum about a solution."""
    found = []
    readings, common = problem.readings(solution), problem.common_errors(solution)
    for one, reading, alike in zip(problem.spectra, readings, common, strict=True):
        residual = one.spectrum.value - reading
        length, freedom = correlation_length(residual)
        length = min(alike * length, residual.size / _FEWEST)
        found.append((residual, length, residual.size / length, freedom))
    independent = sum(count for _, _, count, _ in found)
    lost = min(problem.determined_numbers(solution) / independent, _MOST_LOST)
    return tuple(
        Scatter(float(np.sqrt(np.mean(residual**2) / (1.0 - lost))), length, count, freedom)
        for residual, length, count, freedom in found
    )


def search(problem: FilmProblem, *, starts: int = STARTS, seed: int = 0) -> FilmFit:
    """Find the minima from several starts, and the points' errors from the residuals."""
    # The first start is the numbers' own.
    nominal = problem.model.positions(np.array([one.start for one in problem.free]))
    others = qmc.LatinHypercube(len(nominal), rng=np.random.default_rng(seed)).random(starts - 1)
    # what is known beforehand may be wrong: it has no say in how well the spectra can be fitted
    alone = replace(problem, informed=False)
    found = [alone.minimise(start) for start in (_inside(nominal), *others)]
    found = [one for one in found if alone.is_possible(one)]
    if not found:
        raise ConvergenceError(
            "no film between the bounds has optical constants at all wavelengths of the spectra"
        )
    minima = _distinct(found)
    for _ in range(_ROUNDS):  # with errors of the points that fit the residuals of the best
        before = np.array(alone.spread)
        errors = tuple(one.error for one in scatter_of(alone, minima[0]))
        alone = replace(alone, spread=errors)
        minima = _refit(alone, minima)
        if np.allclose(before, errors, rtol=_SETTLED):
            break
    scatter, number = scatter_of(alone, minima[0]), alone.determined_numbers(minima[0])
    problem = replace(alone, informed=True)
    if any(one.prior is not None for one in problem.free):
        minima = _refit(problem, [*minima, replace(minima[0], position=nominal)])
    return _fit(problem, minima, scatter, number)


def _fit(
    problem: FilmProblem,
    minima: Sequence[FilmSolution],
    scatter: tuple[Scatter, ...],
    determined: float,
) -> FilmFit:
    best, *others = minima
    known = sum(min(one.freedom, one.independent) for one in scatter)
    return FilmFit(
        problem=problem,
        best=best,
        rivals=tuple((one, one.cost - best.cost) for one in others),
        scatter=scatter,
        freedom=max(1.0, known - determined),
    )


def _refit(problem: FilmProblem, minima: Sequence[FilmSolution]) -> list[FilmSolution]:
    return _distinct([problem.minimise(_inside(one.position), one.errors) for one in minima])


def _inside(position: np.ndarray) -> np.ndarray:
    """A start off the bounds, where lmfit's bounded numbers have no derivative."""
    return np.clip(position, _SAME, 1.0 - _SAME)


def _distinct(minima: Sequence[FilmSolution]) -> list[FilmSolution]:
    kept: list[FilmSolution] = []
    for one in sorted(minima, key=lambda one: one.cost):
        if all(np.max(np.abs(one.position - other.position)) > _SAME for other in kept):
            kept.append(one)
    return kept


def intervals(fit: FilmFit) -> tuple[FilmFit, list[tuple[float, float]]]:
    """Ends of the 95 % intervals of the free numbers, where the profile of the cost tells."""
    for _ in range(_ROUNDS):
        better: list[FilmSolution] = []  # than the best so far
        spreads = np.sqrt(np.diag(fit.problem.covariance(fit.best)))
        ends = [
            (_end(fit, number, -1, spread, better), _end(fit, number, 1, spread, better))
            for number, spread in enumerate(spreads)
        ]
        if not better:
            break
        least = min(better, key=lambda one: one.cost)
        minima = _refit(fit.problem, [least, fit.best, *(one for one, _ in fit.rivals)])
        fit = _fit(fit.problem, minima, fit.scatter, fit.problem.determined_numbers(least))
    return fit, ends


def _end(fit: FilmFit, number: int, sign: int, spread: float, better: list[FilmSolution]) -> float:
    """Where the least cost with a number held is as high as at the end of its interval."""
    best, limit = fit.best.position[number], 1.0 if sign > 0 else 0.0

    def excess(at: float, near: FilmSolution) -> tuple[float, FilmSolution]:
        inside = _inside(near.position)
        inside[number] = at
        found = fit.problem.minimise(inside, near.errors, held={number: at})
        more = found.cost - fit.best.cost
        if more < -_BETTER:
            better.append(found)
        return float(np.sqrt(max(more, 0.0))) - fit.factor, found

    inner, within, near = best, -fit.factor, fit.best
    reach = max(fit.factor * spread, _LEAST_REACH)
    for _ in range(_STEPS):
        outer = float(np.clip(best + sign * reach, 0.0, 1.0))
        beyond, found = excess(outer, near)
        if beyond >= 0.0:
            break
        if outer == limit:
            return limit
        inner, within, near, reach = outer, beyond, found, _GROWTH * reach
    for _ in range(_REFINEMENTS):
        # the root of the cost is nearly linear in the number
        middle = inner - within * (outer - inner) / (beyond - within)
        there, found = excess(middle, near)
        if abs(there) < _FINE:
            return float(middle)
        if there >= 0.0:
            outer, beyond = middle, there
        else:
            inner, within, near = middle, there, found
    return float(0.5 * (inner + outer))
