r"""Thermal accommodation coefficient from the power of a heater in thin gas.

A disk held at one temperature loses heat to the gas, to its leads and by radiation. Per area and
temperature difference that is

.. math::
    \frac{P}{A\,\Delta T} = \delta\left[\left(\frac{1}{\alpha h_\mathrm{fm}(p)}
        + \frac{1}{h_\mathrm{cont}(p)}\right)^{-1} + C\right]

with the accommodation coefficient :math:`\alpha`, the ratio :math:`\delta` of effective to
nominal area and an offset :math:`C`. The slope at low pressure is :math:`\delta\alpha`, the
plateau at high pressure :math:`\delta` times a known conductance, and without gas
:math:`\delta C` remains: pressures from one end to the other determine all three. Only because
the plateau is taken to grow with :math:`\delta`, as the slope does, can the three be told apart.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.core.arguments import reads_units
from lightflyer.core.quantity import Fraction, Length
from lightflyer.core.text import correlation_text
from lightflyer.files.result_text import Parts, table_of
from lightflyer.gas.air import AIR
from lightflyer.gas.base import AbstractGas
from lightflyer.lab.estimate import Estimate
from lightflyer.lab.result import LabResult, Series, ambient_doubts
from lightflyer.lab.tac.data import IN_WORDS, TacAccuracy, TacRun
from lightflyer.lab.tac.diagnostics import (
    cut,
    drift_warnings,
    list_lines,
    misfit_warnings,
    model_warnings,
    require_possible,
    result_warnings,
    why_undetermined,
)
from lightflyer.lab.tac.heat_law import (
    KINETIC,
    KINETIC_LAW,
    AbstractHeatLaw,
    Limits,
    nominal_area,
)
from lightflyer.lab.tac.intervals import Solution, positive_estimate, solve
from lightflyer.lab.tac.preparation import (
    LU2023_HEATER_DIAMETER,
    Bench,
    Prepared,
    prepare,
)
from lightflyer.lab.tac.problem import PARAMETERS

if TYPE_CHECKING:
    pass

_PERCENT = 100.0
_NAMES = {"tac": "TAC α", "area_ratio": "area ratio δ", "offset": "offset C"}
_PARAMETERS = ("", "value", "95 % interval", "of the scatter alone", "unit")
_ERRORS = ("error by the fit", "in stated ±", "stated ±", "unit")
_RUNS = ("run", "TAC α", "95 % interval", "area ratio δ", "offset C\n[W/(m² K)]")


@dataclass(frozen=True, repr=False)
class TacFit(LabResult):
    r"""Accommodation coefficient, area ratio and offset of one run."""

    run: TacRun
    kept: np.ndarray  #: shape (n,); rows that are fitted
    #: shape (n,); rows that belong to no curve through the others; they are left out
    off_curve: np.ndarray
    diameter: float  #: Diameter of the heater [m]
    reading: str  #: Name of the law of heat loss
    gas: str  #: Name of the gas
    accuracy: TacAccuracy
    tac: Estimate  #: With the 95 % profile interval of the total uncertainty
    area_ratio: Estimate  #: As ``tac``
    offset: Estimate  #: As ``tac``, in W/(m² K)
    #: The same values with profile intervals of the scatter alone, by name of the parameter
    statistical: dict[str, Estimate]
    #: 95 % intervals of the total uncertainty from the covariance, by name of the parameter
    covariance_intervals: dict[str, tuple[float, float]]
    #: shape (3, 3); total, in the order of :data:`~lightflyer.lab.tac.problem.PARAMETERS`
    covariance: np.ndarray
    #: Best values of the errors that all rows have in common, in their standard errors
    common_errors: dict[str, float]
    scatter: float  #: Relative scatter of the measured conductance about the fit [1]
    #: Rows of neighbouring pressures that deviate from the fit together, 1 where the law fits: the
    #: intervals are those of so many times fewer rows
    alike: float
    #: Coefficient that the same rows give by each of the other laws; None where a fit fails
    by_reading: dict[str, float | None]
    #: shape (m,); measured :math:`P/(A\,\Delta T)` of the fitted rows [W/(m² K)]
    conductance: np.ndarray
    fitted: np.ndarray  #: shape (m,); its fitted value [W/(m² K)]
    weight: np.ndarray  #: shape (m,); factor of the residuals in the fit [m² K/W]
    limits: Limits  #: Conductances of the gas in its two limits
    #: shape (m,); conductance of radiation counted apart from the offset [W/(m² K)]
    radiation: np.ndarray
    undetermined: str | None  #: Why the rows do not determine the coefficient, if they do not
    warnings: tuple[str, ...]  #: What a reader of the result must know

    _figures = "tac.figures:tac_figures"
    _drawing = "tac.figures:plot_tac"

    @property
    def pressure(self) -> np.ndarray:
        """Pressure of the fitted rows [Pa], shape (m,)."""
        return self.run.pressure[self.kept]

    @cached_property
    def order(self) -> np.ndarray:
        """Indices that sort the fitted rows by pressure, shape (m,)."""
        return np.argsort(self.pressure, kind="stable")

    @property
    def rows_used(self) -> int:
        """Number of fitted rows."""
        return int(self.kept.sum())

    @property
    def rows_dropped(self) -> int:
        """Number of rows dropped because the heater was not at its constant temperature."""
        return int((~self.kept & ~self.off_curve).sum())

    @property
    def lines_off_curve(self) -> list[int]:
        """Lines of the rows that belong to no curve through the others."""
        return [int(line) for line in self.run.table.lines[self.off_curve]]

    @property
    def mean_temperature(self) -> float:
        """Mean heater temperature of the fitted rows [K]."""
        return float(self.run.heater_temperature[self.kept].mean())

    @property
    def temperature_variation(self) -> float:
        """Coefficient of variation of the heater temperature over the fitted rows [1]."""
        return float(self.run.heater_temperature[self.kept].std(ddof=1) / self.mean_temperature)

    @property
    def correlation(self) -> np.ndarray:
        """Correlations of the three parameters' total errors [1], shape (3, 3)."""
        spread = np.sqrt(np.diag(self.covariance))
        return np.asarray(self.covariance / np.outer(spread, spread))

    @property
    def slope(self) -> Estimate:
        """Product of coefficient and area ratio [1], which does not need the plateau."""
        tac, ratio = self.tac.value, self.area_ratio.value
        gradient = np.array([ratio, tac])
        variance = float(gradient @ self.covariance[:2, :2] @ gradient)
        return positive_estimate(tac * ratio, float(np.sqrt(variance)))

    def estimates(self) -> dict[str, Estimate]:
        """The three estimates by name."""
        return {name: getattr(self, name) for name in PARAMETERS}

    def series(self) -> list[Series]:
        """The fitted rows."""
        per_area = "W/(m^2 K)"
        said = "power per nominal area and temperature difference"
        return [
            Series("line", self.run.table.lines[self.kept], "", "line in it"),
            Series("pressure", self.pressure, "Pa", "gas pressure"),
            Series("conductance", self.conductance, per_area, said),
            Series("fitted", self.fitted, per_area, "fitted conductance"),
        ]

    def parts(self) -> Parts:
        yield from fit_parts(self)
        yield from errors_parts(self)

    def summary(self) -> dict[str, Any]:
        """The fit as a JSON object."""
        low, high = float(self.pressure.min()), float(self.pressure.max())
        return {
            **{name: estimate.to_json() for name, estimate in self.estimates().items()},
            "statistical_interval_95": {
                name: one.to_json()["interval_95"] for name, one in self.statistical.items()
            },
            "slope": self.slope.to_json(),
            "reading": self.reading,
            "gas": self.gas,
            "tac_by_other_readings": self.by_reading,
            "accuracy": self.accuracy.to_json(),
            "common_errors": self.common_errors,
            "determined": self.undetermined is None,
            "rows_used": self.rows_used,
            "rows_dropped": self.rows_dropped,
            "lines_off_curve": self.lines_off_curve,
            "covariance_interval_95": {
                name: list(ends) for name, ends in self.covariance_intervals.items()
            },
            "covariance": self.covariance.tolist(),
            "correlation": self.correlation.tolist(),
            "scatter": self.scatter,
            "alike_rows": self.alike,
            "heater_temperature": {"mean_k": self.mean_temperature,
                                   "coefficient_of_variation": self.temperature_variation},
            "pressure_range_pa": [low, high],
            "warnings": list(self.warnings),
        }  # fmt: skip


def heater_power(
    pressure: np.ndarray,
    heater_temperature: np.ndarray,
    ambient_temperature: np.ndarray,
    tac: float,
    area_ratio: float,
    offset: float,
    *,
    diameter: float = LU2023_HEATER_DIAMETER,
    law: AbstractHeatLaw = KINETIC_LAW,
    gas: AbstractGas = AIR,
) -> np.ndarray:
    """Power that holds a heater at its temperature: the inverse of :func:`fit_tac` [W]."""
    difference = heater_temperature - ambient_temperature
    limits = law.limits(pressure, ambient_temperature, heater_temperature, diameter, gas)
    conductance = area_ratio * (limits.conductance(tac) + offset)
    return np.asarray(conductance * nominal_area(diameter) * difference)


@reads_units
def fit_tac(
    run: TacRun,
    *,
    diameter: Length = LU2023_HEATER_DIAMETER,
    tolerance: float = 1.0,
    emissivity: Fraction | None = None,
    law: AbstractHeatLaw = KINETIC_LAW,
    gas: AbstractGas = AIR,
    accuracy: TacAccuracy | None = None,
) -> TacFit:
    r"""Fit accommodation coefficient, area ratio and offset to a run.

    Parameters
    ----------
    run : TacRun
    diameter : float
        Diameter of the heater [m]; by default the paper's.
    tolerance : float
        Largest distance of the heater temperature from its median [K]; other rows are dropped.
    emissivity : float, optional
        Emissivity of both faces of the heater [1]. Where given, the radiation
        :math:`2\sigma\varepsilon(T_h^4-T_c^4)/\Delta T` is counted apart from the offset;
        otherwise the offset includes it.
    law : AbstractHeatLaw
        Law of heat loss, one of :data:`~lightflyer.lab.tac.heat_law.HEAT_LAWS` or a
        :class:`~lightflyer.lab.tac.heat_law.KineticLaw` in a chamber. By the paper's equations as
        ``printed`` the coefficient comes out 11 to 20 % larger than by the kinetic equation; as
        ``reported``, which counts the plateau twice, more than twice as large.
    gas : AbstractGas
    accuracy : TacAccuracy, optional
        Accuracies of the instruments; by default those of :class:`TacAccuracy`.

    Returns
    -------
    TacFit

    Raises
    ------
    ParameterError
        If an argument is impossible.
    ConfigurationError
        If there are too few rows at constant temperature, a temperature or a result is
        impossible, many rows are off any curve, or two parameters have the same effect.
    ConvergenceError
        If the fit fails.

    Notes
    -----
    Least squares on the conductance :math:`P/(A\Delta T)`. All rows have the same relative
    scatter, estimated from the residuals; each residual is divided by the conductance of a first
    fit. Errors that all rows have in common are further unknowns with a normal prior of their
    accuracy. A profile interval ends where the sum of squares, minimised over all other unknowns,
    exceeds its minimum by the square of Student's 95 % point.

    References
    ----------
    [Lu2023]_ supplement, Eqs. (3)-(14).
    """
    bench = Bench(diameter, tolerance, emissivity, law, gas, accuracy or TacAccuracy())
    return fit_together([run], bench)[0][0]


def fit_together(runs: Sequence[TacRun], bench: Bench) -> tuple[list[TacFit], np.ndarray]:
    """Fit runs on one bench, each with parameters of its own, and errors that all have in common.

    Also returns the total covariance of the runs' coefficients [1], shape (n, n).
    """
    prepared = [prepare(run, bench) for run in runs]
    solutions, covariance = solve(
        [one.problem for one in prepared], [one.guess for one in prepared]
    )
    fits = [_result(*both, bench) for both in zip(prepared, solutions, strict=True)]
    return fits, covariance


def _result(prepared: Prepared, solution: Solution, bench: Bench) -> TacFit:
    run, problem, others = prepared.run, prepared.problem, prepared.others
    off_curve, reading = prepared.off_curve, bench.law.name
    require_possible(run.source, solution.total, reading)
    undetermined = why_undetermined(solution.total["tac"], problem, solution.scatter)
    estimates, texts = cut(solution.total)
    statistical, _ = cut(solution.statistical)
    normal, _ = cut(solution.total_normal)
    fitted = problem.model(*solution.values.values())
    if off_curve.any():
        lines = [int(line) for line in run.table.lines[off_curve]]
        texts.insert(
            0, f"{list_lines(lines, run.source)}: left out, off the curve of all other rows"
        )
    texts += [
        *run.notes,
        *ambient_doubts(run.ambient_temperature),
        *result_warnings(estimates, reading),
    ]
    texts += model_warnings(estimates["tac"].value, reading, others.get(KINETIC))
    texts += misfit_warnings(solution.alike, len(fitted), solution.values)
    texts += drift_warnings(problem.conductance / fitted - 1.0, problem.pressure, solution.alike)
    if undetermined:
        texts.append(undetermined)
    return TacFit(
        run=run,
        kept=prepared.kept,
        off_curve=off_curve,
        diameter=bench.diameter,
        reading=reading,
        gas=bench.gas.name,
        accuracy=bench.accuracy,
        **estimates,
        statistical=statistical,
        covariance_intervals={name: one.interval for name, one in normal.items()},
        covariance=solution.covariance,
        common_errors={name: solution.values[name] for name in problem.errors.names},
        scatter=solution.scatter,
        alike=solution.alike,
        by_reading=others,
        conductance=problem.conductance,
        fitted=fitted,
        weight=problem.weight,
        limits=problem.limits,
        radiation=problem.radiation,
        undetermined=undetermined,
        warnings=tuple(texts),
    )


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
