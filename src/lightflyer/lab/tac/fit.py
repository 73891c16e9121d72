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

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np

from lightflyer.core.entry_point import reads_units
from lightflyer.core.quantity import Fraction, Length
from lightflyer.core.text import correlation_text
from lightflyer.files.result_text import Parts, table_of
from lightflyer.gas.air import AIR
from lightflyer.gas.base import AbstractGas
from lightflyer.lab.estimate import Estimate, weighted_mean
from lightflyer.lab.result import (
    LabResult,
    Reported,
    Series,
    Shown,
    ambient_doubts,
    csv_text,
    dataset,
    joint_warnings,
    plain,
    variables,
)
from lightflyer.lab.tac import preparation
from lightflyer.lab.tac.data import IN_WORDS, TacAccuracy, TacRun
from lightflyer.lab.tac.intervals import HeaterSolution, positive_estimate, solve
from lightflyer.lab.tac.preparation import LU2023_HEATER_DIAMETER, Bench, Prepared, prepare
from lightflyer.lab.tac.problem import (
    KINETIC,
    KINETIC_LAW,
    PARAMETERS,
    AbstractHeatLaw,
    Limits,
    nominal_area,
)

if TYPE_CHECKING:
    import xarray as xr

_PERCENT = 100.0
_ROUNDING = 1e-12  # relative
_MOST_LINES = 8  # of a file, that a message lists
_PARAMETERS = ("", "value", "95 % interval", "of the scatter alone", "unit")
_ERRORS = ("error by the fit", "in standard errors", "standard error", "unit")
_RUNS = ("run", "TAC α", "95 % interval", "area ratio δ", "offset C\n[W/(m² K)]")


@dataclass(frozen=True, repr=False)
class TacFit(LabResult):
    r"""Accommodation coefficient, area ratio and offset of one run."""

    run: TacRun
    kept: np.ndarray  #: shape (n,); rows that are fitted
    #: shape (n,); rows that belong to no curve through the others; they are left out
    off_curve: np.ndarray
    diameter: float  #: Diameter of the heater [m]
    reading: Reported[str]  #: Name of the law of heat loss
    gas: Reported[str]  #: Name of the gas
    accuracy: TacAccuracy
    #: With the 95 % profile interval of the total uncertainty
    tac: Annotated[Estimate, Shown("TAC α")]
    area_ratio: Annotated[Estimate, Shown("area ratio δ")]  #: As ``tac``
    offset: Annotated[Estimate, Shown("offset C")]  #: As ``tac``, in W/(m² K)
    #: The same values with profile intervals of the scatter alone, by name of the parameter
    statistical: dict[str, Estimate]
    #: 95 % intervals of the total uncertainty from the covariance, by name of the parameter
    covariance_intervals: Annotated[
        dict[str, tuple[float, float]], Shown(key="covariance_interval_95")
    ]
    #: shape (3, 3); total, in the order of :data:`~lightflyer.lab.tac.problem.PARAMETERS`
    covariance: Reported[np.ndarray]
    #: Best values of the errors that all rows have in common, in their standard errors
    common_errors: Reported[dict[str, float]]
    #: Relative scatter of the measured conductance about the fit [1]
    scatter: Reported[float]
    #: Rows of neighbouring pressures that deviate from the fit together, 1 where the law fits: the
    #: intervals are those of so many times fewer rows
    alike: Annotated[float, Shown(key="alike_rows")]
    #: Coefficient that the same rows give by each of the other laws; None where a fit fails
    by_reading: Annotated[dict[str, float | None], Shown(key="tac_by_other_readings")]
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
    _drawing = "tac.figures:effective_conductance"
    _several = True

    @property
    def pressure(self) -> np.ndarray:
        """Pressure of the fitted rows [Pa], shape (m,)."""
        return self.run.pressure[self.kept]

    @cached_property
    def order(self) -> np.ndarray:
        """Indices that sort the fitted rows by pressure, shape (m,)."""
        return np.argsort(self.pressure, kind="stable")

    @property
    def rows_used(self) -> Reported[int]:
        """Number of fitted rows."""
        return int(self.kept.sum())

    @property
    def rows_dropped(self) -> Reported[int]:
        """Number of rows dropped because the heater was not at its constant temperature."""
        return int((~self.kept & ~self.off_curve).sum())

    @property
    def lines_off_curve(self) -> Reported[list[int]]:
        """Lines of the rows that belong to no curve through the others."""
        return [int(line) for line in self.run.table.lines[self.off_curve]]

    @property
    def mean_temperature(self) -> Annotated[float, Shown(key="heater_temperature.mean_k")]:
        """Mean heater temperature of the fitted rows [K]."""
        return float(self.run.heater_temperature[self.kept].mean())

    @property
    def temperature_variation(
        self,
    ) -> Annotated[float, Shown(key="heater_temperature.coefficient_of_variation")]:
        """Coefficient of variation of the heater temperature over the fitted rows [1]."""
        return float(self.run.heater_temperature[self.kept].std(ddof=1) / self.mean_temperature)

    @property
    def correlation(self) -> Reported[np.ndarray]:
        """Correlations of the three parameters' total errors [1], shape (3, 3)."""
        spread = np.sqrt(np.diag(self.covariance))
        return np.asarray(self.covariance / np.outer(spread, spread))

    @property
    def slope(self) -> Reported[Estimate]:
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
        yield from self.fit_parts()
        yield from self.errors_parts()

    def fit_parts(self) -> Parts:
        """Parameters of the run."""
        yield (
            f"{self.run.source}: heater at {self.mean_temperature:.2f} K, coefficient of variation "
            f"{_PERCENT * self.temperature_variation:.2g} %; {self.rows_used} rows used, "
            f"{self.rows_dropped} dropped for their temperature"
        )
        of_scatter = [*(one.interval_text() for one in self.statistical.values()), ""]
        shown = self.labelled() | {"slope δα": self.slope}
        rows = [
            (
                name,
                f"{one.value:.4g}",
                one.interval_text(),
                text,
                one.unit.replace("^2", "²") or "1",
            )
            for (name, one), text in zip(shown.items(), of_scatter, strict=True)
        ]
        yield table_of(_PARAMETERS, rows, left=(0, 2, 3, 4))
        others = ", ".join(
            f"{one:.3g} by {name}" for name, one in self.by_reading.items() if one is not None
        )
        yield (
            f"reading {self.reading}, gas {self.gas}; the same rows give α = {others}\n"
            f"rows scatter by {_PERCENT * self.scatter:.2g} % about the fit; "
            f"{correlation_text('αδC', self.covariance)}"
        )

    def errors_parts(self) -> Parts:
        """Errors of the instruments by the fit; those of runs fitted together are the same."""
        errors = []
        for name, pull in self.common_errors.items():
            words, scale, unit = IN_WORDS[name]
            errors.append(
                (words, f"{pull:+.2f}", f"{scale * getattr(self.accuracy, name):g}", unit)
            )
        yield table_of(_ERRORS, errors, left=(0, 3))

    def summary(self) -> dict[str, Any]:
        """The fit as a JSON object."""
        scatter = {name: one["interval_95"] for name, one in plain(self.statistical).items()}
        return {
            **self.reported(),
            "statistical_interval_95": scatter,
            "accuracy": self.accuracy.to_json(),
            "determined": self.undetermined is None,
            "pressure_range_pa": [float(self.pressure.min()), float(self.pressure.max())],
            "warnings": list(self.warnings),
        }


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
        Law of heat loss, one of :data:`~lightflyer.lab.tac.problem.HEAT_LAWS` or a
        :class:`~lightflyer.lab.tac.problem.KineticLaw` in a chamber. By the paper's equations as
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


def _result(prepared: Prepared, solution: HeaterSolution, bench: Bench) -> TacFit:
    run, problem, reading = prepared.run, prepared.problem, bench.law.name
    preparation.require_possible(run.source, solution.total, reading)
    undetermined = preparation.why_undetermined(solution.total["tac"], problem, solution.scatter)
    estimates, texts = preparation.cut(solution.total)
    fitted = problem.model([*solution.values.values()])
    off = [int(line) for line in run.table.lines[prepared.off_curve]]
    if off:
        shown, more = ", ".join(map(str, off[:_MOST_LINES])), len(off) - _MOST_LINES
        shown += f" and {more} more" if more > 0 else ""
        texts.insert(0, f"{run.source}:{shown}: left out, off the curve of all other rows")
    texts += [
        *run.notes,
        *ambient_doubts(run.ambient_temperature),
        *preparation.result_warnings(estimates, reading),
    ]
    kinetic = prepared.others.get(KINETIC)
    if kinetic is not None:  # by the paper's formulas
        error = _PERCENT * (estimates["tac"].value / kinetic - 1.0)
        texts.append(
            f"the reading {reading} gives a coefficient {error:+.0f} % from that of the kinetic "
            f"equation ({kinetic:.3g}); the interval leaves this error of the formula out"
        )
    texts += preparation.misfit_warnings(solution.alike, len(fitted), solution.values)
    texts += preparation.drift_warnings(
        problem.conductance / fitted - 1.0, problem.pressure, solution.alike
    )
    if undetermined:
        texts.append(undetermined)
    return TacFit(
        run=run,
        kept=prepared.kept,
        off_curve=prepared.off_curve,
        diameter=bench.diameter,
        reading=reading,
        gas=bench.gas.name,
        accuracy=bench.accuracy,
        **estimates,
        statistical=preparation.cut(solution.statistical)[0],
        covariance_intervals={
            name: one.interval for name, one in preparation.cut(solution.total_normal)[0].items()
        },
        covariance=solution.covariance,
        common_errors={name: solution.values[name] for name in problem.errors},
        scatter=solution.scatter,
        alike=solution.alike,
        by_reading=prepared.others,
        conductance=problem.conductance,
        fitted=fitted,
        weight=problem.weight,
        limits=problem.limits,
        radiation=problem.radiation,
        undetermined=undetermined,
        warnings=tuple(texts),
    )


def with_spread(estimate: Estimate) -> Estimate:
    """The estimate; rows computed by a model have rounding for a spread, not zero."""
    spread = max(estimate.uncertainty or 0.0, _ROUNDING * abs(estimate.value))
    return replace(estimate, uncertainty=spread)


@dataclass(frozen=True)
class TacRuns:
    """Runs of one surface on one bench."""

    fits: Sequence[TacFit]

    @property
    def warnings(self) -> list[str]:
        """What a reader of the results must know."""
        return joint_warnings([(fit.run.source, fit.warnings) for fit in self.fits])

    @property
    def headline(self) -> str:
        """The coefficient."""
        return f"TAC α {self.mean()}"

    def mean(self, name: str = "tac") -> Estimate:
        """Mean accommodation coefficient, or another parameter."""
        if len(self.fits) == 1:
            return self.fits[0].estimates()[name]
        each = [with_spread(fit.statistical[name]) for fit in self.fits]
        mean = weighted_mean(each, common=self._common_part(name))
        low, high = preparation.BOUNDS[name]
        return replace(mean, interval=(max(mean.interval[0], low), min(mean.interval[1], high)))

    def _common_part(self, name: str) -> float:
        """Standard uncertainty from errors that all rows, and all runs, have in common."""
        total, part = np.array([
            [one[name].uncertainty or 0.0 for one in (fit.estimates(), fit.statistical)]
            for fit in self.fits
        ]).T  # fmt: skip
        return float(np.sqrt(np.maximum(total**2 - part**2, 0.0)).mean())

    @property
    def correlation_between_samples(self) -> float:
        """Correlation of the coefficients' errors between two samples measured on one bench [1]."""
        total = self.mean().uncertainty or 0.0
        return min((self._common_part("tac") / total) ** 2, 1.0) if total else 0.0

    def why_no_property(self) -> str | None:
        """Why the coefficient cannot be that of a film, in one line; None if it can."""
        for fit in self.fits:
            if fit.undetermined:
                return fit.undetermined
        mean, first = self.mean(), self.fits[0]
        if mean.interval[0] <= preparation.POSSIBLE_TAC:
            return None
        return (
            f"{first.run.source}: accommodation coefficient {mean.value:.3g} by the reading "
            f"{first.reading} is above 1 beyond its uncertainty"
        )

    def parts(self) -> Parts:
        """Each run; of several a table, like the paper's table S2, and the mean."""
        for fit in self.fits:
            yield from fit.parts()
        if len(self.fits) > 1:
            rows = []
            for fit in self.fits:
                low, high = fit.tac.interval
                rows.append((
                    fit.run.source, f"{fit.tac.value:.3f}", f"{low:.3f} to {high:.3f}",
                    f"{fit.area_ratio.value:.3f}", f"{fit.offset.value:.3f}",
                ))  # fmt: skip
            yield table_of(_RUNS, rows)
            yield f"mean accommodation coefficient {self.mean()}"

    def summary(self) -> dict[str, Any]:
        """One run, or the mean of several with each of them, as a JSON object."""
        fits = self.fits
        related = {"correlation_between_samples": self.correlation_between_samples}
        if len(fits) == 1:
            return fits[0].summary() | related
        return related | {
            **{name: plain(self.mean(name)) for name in PARAMETERS},
            "reading": fits[0].reading,
            "gas": fits[0].gas,
            "determined": all(fit.undetermined is None for fit in fits),
            "rows_used": sum(fit.rows_used for fit in fits),
            "rows_dropped": sum(fit.rows_dropped for fit in fits),
            "runs": {fit.run.source: fit.summary() for fit in fits},
            "warnings": self.warnings,
        }

    def to_dataset(self, warnings: Iterable[str]) -> "xr.Dataset":
        """Rows of all runs over ``row``."""
        fits = self.fits
        number = np.repeat(np.arange(len(fits)), [fit.rows_used for fit in fits])
        rows = [
            of_runs[0]._replace(values=np.concatenate([one.values for one in of_runs]))
            for of_runs in zip(*(fit.series() for fit in fits), strict=True)
        ]
        return dataset(
            "thermal accommodation coefficient",
            variables("row", [Series("run", number, "", "position of the file, from 0"), *rows]),
            [fit.run.source for fit in fits],
            warnings=warnings,
            reading=fits[0].reading,
            gas=fits[0].gas,
        )

    def tables(self) -> dict[str, str]:
        """Fitted rows of each run as CSV, by file name."""
        return {
            f"tac-rows-{number}.csv": csv_text([f"# {fit.run.source}"], fit.series())
            for number, fit in enumerate(self.fits, start=1)
        }
