"""Least squares for a heater's conductance: model, derivatives, first guess and minimisation."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from lightflyer.core.errors import ConfigurationError, ConvergenceError
from lightflyer.lab.tac.data import CommonErrors
from lightflyer.lab.tac.heat_law import Limits

PARAMETERS = ("tac", "area_ratio", "offset")  # Fitted parameters: α, δ and C

TAC_BOUNDS = (1e-6, 20.0)
"""Bounds of the fit; wider than possible, so that what is impossible shows."""

_STARTS = np.geomspace(0.02, 3.0, 60)  # coefficients tried for a first guess
_RANK_TOLERANCE = 1e-7  # of the scaled Jacobian's singular values
_GROUPS = 5_000  # of rows of neighbouring pressure that replace a very long run in its profile


@dataclass(frozen=True)
class HeaterProblem:
    """Conductances of a run, measured and modelled."""

    # The unknowns are the three of :data:`PARAMETERS` and, where ``errors`` has any, as many
    # errors that all rows have in common, each in standard errors about zero.

    source: str  # Name of the file, for messages
    # Measured power per nominal area and temperature difference [W/(m² K)], shape (m,)
    conductance: np.ndarray
    pressure: np.ndarray  # [Pa], shape (m,)
    limits: Limits  # Limits of the gas
    radiation: np.ndarray  # Radiation counted apart from the offset [W/(m² K)], shape (m,)
    weight: np.ndarray  # Factor of the residuals [m² K/W], shape (m,)
    errors: CommonErrors

    def with_common_errors(self, common: Sequence[float]) -> "HeaterProblem":
        """The problem of the three parameters alone, at given errors of all rows."""
        given = np.array(common, float)
        shift = float(given @ self.errors.log_pressure)
        rising = np.exp(shift) + float(given @ self.errors.zero) / self.pressure
        logarithms = self.limits.log_continuum.copy()
        logarithms[0] += self.limits.slope * shift + given @ self.errors.log_continuum
        amplitude = np.exp(given @ self.errors.log_conductance)
        limits = replace(
            self.limits,
            free_molecular=self.limits.free_molecular * rising,
            log_continuum=logarithms,
        )
        return replace(
            self, conductance=self.conductance / amplitude, limits=limits,
            weight=self.weight * amplitude, errors=CommonErrors.none(len(self.conductance)),
        )  # fmt: skip

    def without_common_errors(self) -> "HeaterProblem":
        return self.with_common_errors([0.0] * len(self.errors.names))

    def _gas(self, tac: float, common: np.ndarray) -> tuple[np.ndarray, ...]:
        """Both limits at a coefficient, derivative of the dense one, and the thin one's factor."""
        shift = float(common @ self.errors.log_pressure)
        factor = np.exp(shift)
        at_one = tac * self.limits.free_molecular
        thin = at_one * (factor + float(common @ self.errors.zero) / self.pressure)
        logarithm, per_tac = self.limits.log_continuum_at(tac)
        shifted = self.limits.slope * shift + common @ self.errors.log_continuum
        return thin, np.exp(logarithm + shifted), per_tac, at_one * factor

    def model(self, tac: float, area_ratio: float, offset: float, *common: float) -> np.ndarray:
        """Conductance per nominal area [W/(m² K)], shape (m,)."""
        given = np.array(common or np.zeros(len(self.errors.names)))
        thin, dense, *_ = self._gas(tac, given)
        amplitude = np.exp(given @ self.errors.log_conductance)
        gas = thin * dense / (thin + dense)
        return np.asarray(area_ratio * amplitude * (gas + self.radiation + offset))

    def residuals(self, *unknowns: float) -> np.ndarray:
        """Weighted residuals of the rows [1], shape (m,)."""
        return (self.model(*unknowns) - self.conductance) * self.weight

    def jacobian(self, tac: float, area_ratio: float, offset: float, *common: float) -> np.ndarray:
        """Derivatives of the residuals by the unknowns, shape (3 + k, m)."""
        given, errors = np.array(common), self.errors
        thin, dense, per_tac, scaled = self._gas(tac, given)
        amplitude = area_ratio * np.exp(given @ errors.log_conductance)
        share = dense / (thin + dense)  # of the resistance, that is of thin gas
        by_thin, by_log_dense = share**2, (1.0 - share) ** 2 * dense
        inside = thin * dense / (thin + dense) + self.radiation + offset
        by_tac = by_thin * thin / tac + by_log_dense * per_tac
        by_pressure = by_thin * scaled + by_log_dense * self.limits.slope
        by_zero = by_thin * tac * self.limits.free_molecular / self.pressure
        columns = [amplitude * by_tac, amplitude / area_ratio * inside, amplitude]
        for number in range(len(errors.names)):
            of_gas = (
                errors.log_pressure[number] * by_pressure
                + errors.zero[number] * by_zero
                + errors.log_continuum[number] * by_log_dense
            )
            columns.append(amplitude * (of_gas + errors.log_conductance[number] * inside))
        return np.stack(columns) * self.weight

    def group(self) -> "HeaterProblem":
        """Rows of neighbouring pressure averaged, each group weighted by its size."""
        # A profile of very many rows would take long. Within a group the model hardly changes, and
        # the scatter within it does not depend on the parameters.
        if len(self.conductance) <= 2 * _GROUPS:
            return self
        groups = np.array_split(np.argsort(self.pressure, kind="stable"), _GROUPS)
        sizes = np.array([len(rows) for rows in groups])
        first = np.concatenate([[0], np.cumsum(sizes)[:-1]])
        order = np.concatenate(groups)
        means = self._each(lambda one: np.add.reduceat(one[..., order], first, axis=-1) / sizes)
        return replace(means, weight=means.weight * np.sqrt(sizes))

    def rows(self, kept: np.ndarray) -> "HeaterProblem":
        """The same problem with some of its rows; ``kept`` is boolean, shape (m,)."""
        return self._each(lambda one: one[..., kept])

    def _each(self, change: Callable[[np.ndarray], np.ndarray]) -> "HeaterProblem":
        """The problem with changed arrays, of shape (m,) or (k, m)."""
        limits, errors = self.limits, self.errors
        return replace(
            self, conductance=change(self.conductance), pressure=change(self.pressure),
            radiation=change(self.radiation), weight=change(self.weight),
            limits=replace(
                limits, free_molecular=change(limits.free_molecular), slope=change(limits.slope),
                log_continuum=change(limits.log_continuum),
            ),
            errors=replace(
                errors, log_continuum=change(errors.log_continuum),
                log_conductance=change(errors.log_conductance),
            ),
        )  # fmt: skip


@dataclass(frozen=True)
class JointProblem:
    """Runs on one bench, each with parameters of its own, with the errors that all have in common.

    The unknowns are the parameters of each run in turn, and then the errors.
    """

    runs: tuple[HeaterProblem, ...]

    @property
    def source(self) -> str:
        """Names of the files, for messages."""
        return ", ".join(dict.fromkeys(run.source for run in self.runs))

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters, those of several runs with the run's number."""
        if len(self.runs) == 1:
            return PARAMETERS
        return tuple(f"{name}_{run}" for run in range(len(self.runs)) for name in PARAMETERS)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the unknowns."""
        return (*self.parameters, *self.runs[0].errors.names)

    def _parts(self, unknowns: Sequence[float]) -> list[tuple[HeaterProblem, Sequence[float]]]:
        last, width = len(self.parameters), len(PARAMETERS)
        return [
            (run, [*unknowns[number * width : (number + 1) * width], *unknowns[last:]])
            for number, run in enumerate(self.runs)
        ]

    def residuals(self, *unknowns: float) -> np.ndarray:
        """Weighted residuals of all rows, and of the common errors once [1]."""
        rows = [run.residuals(*part) for run, part in self._parts(unknowns)]
        return np.concatenate([*rows, unknowns[len(self.parameters) :]])

    def jacobian(self, *unknowns: float) -> np.ndarray:
        """Derivatives of the residuals by the unknowns, shape (3 n + k, m + k)."""
        last, width = len(self.parameters), len(PARAMETERS)
        blocks = []
        for number, (run, part) in enumerate(self._parts(unknowns)):
            of_run = run.jacobian(*part)
            block = np.zeros((len(unknowns), of_run.shape[1]))
            block[number * width : (number + 1) * width] = of_run[:width]
            block[last:] = of_run[width:]
            blocks.append(block)
        return np.concatenate([*blocks, np.eye(len(unknowns))[:, last:]], axis=1)


def first_guess(problem: HeaterProblem) -> tuple[float, float, float]:
    """Best of many coefficients; area ratio and offset by linear least squares for each."""
    weight = problem.weight
    best, least = (1.0, 1.0, 0.0), np.inf
    for tac in _STARTS:
        gas = problem.limits.conductance(float(tac)) + problem.radiation
        design = np.stack([gas * weight, weight], axis=1)
        (ratio, product), *_ = np.linalg.lstsq(design, problem.conductance * weight)
        cost = float(np.sum((design @ (ratio, product) - problem.conductance * weight) ** 2))
        if cost < least and ratio > 0.0:
            best, least = (float(tac), float(ratio), float(product / ratio)), cost
    return best


def require_distinct(problem: HeaterProblem, values: Sequence[float]) -> None:
    """Raise unless the pressures determine all three parameters."""
    jacobian = problem.without_common_errors().jacobian(*values)
    scaled = jacobian / np.maximum(np.linalg.norm(jacobian, axis=1, keepdims=True), 1e-300)
    singular = np.sqrt(np.maximum(np.linalg.eigvalsh(scaled @ scaled.T), 0.0))
    if singular[0] < _RANK_TOLERANCE * singular[-1]:
        raise ConfigurationError(
            f"{problem.source}: its pressures do not determine accommodation coefficient, area "
            "ratio and offset separately; they must reach from free-molecular gas to the plateau"
        )


def minimise(
    problem: HeaterProblem | JointProblem, start: Sequence[float], *, scale: bool = True
) -> Any:
    """Minimise the sum of squares by lmfit; its result."""
    import lmfit  # takes a while

    joint = JointProblem((problem,)) if isinstance(problem, HeaterProblem) else problem
    parameters, last = lmfit.Parameters(), len(joint.parameters)
    bounds = (TAC_BOUNDS, (0.0, np.inf), (-np.inf, np.inf))
    for number, (name, value) in enumerate(zip(joint.names, start, strict=True)):
        low, high = bounds[number % len(PARAMETERS)] if number < last else bounds[-1]
        parameters.add(name, value=value, min=low, max=high)
    result = lmfit.minimize(
        lambda given: joint.residuals(*(float(given[name]) for name in joint.names)),
        parameters, scale_covar=scale, col_deriv=1, ftol=1e-14, xtol=1e-12, gtol=1e-14,
        Dfun=lambda given: joint.jacobian(*(float(given[name]) for name in joint.names)),
    )  # fmt: skip
    if result.covar is None or not np.all(np.isfinite(result.covar)):
        raise ConvergenceError(f"{joint.source}: the fit failed: {result.message}")
    return result
