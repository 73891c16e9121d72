"""Optimal pressure and minimum irradiance from levitation points.

Local regression of degree 2 on logarithms, twice, smooths the points at which a sample lifted off.
The minimum of the curve is the least irradiance at which the sample levitates.

Beside the points stand model curves, and a calibration of the model to them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.calibration.calibration import Calibration, step_warning
from lightflyer.calibration.fitting import calibrate
from lightflyer.calibration.gauge import CENTRE, found_step, require_step
from lightflyer.calibration.inputs import INSTRUMENTS, instruments, target_of
from lightflyer.calibration.points import LEAST_PROBABILITY, Points, doubts, log_uncertainty
from lightflyer.config.designs import as_design
from lightflyer.core.checks import require_range
from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import ConfigurationError, Doubt
from lightflyer.core.quantity import Fraction, Irradiance
from lightflyer.design.setup import Setup
from lightflyer.files.result_text import Parts, PrintedResult, open_interval_text, table_of
from lightflyer.lab.estimate import CONFIDENCE, Estimate, central_interval
from lightflyer.lab.levitation.data import LiftOffs, Minimum, minimum, smoother
from lightflyer.lab.result import (
    LabResult,
    Reported,
    Series,
    csv_text,
    dataset,
    joint_warnings,
    plain,
    variables,
)
from lightflyer.statics.levitation import levitate

if TYPE_CHECKING:
    import xarray as xr

SPAN = 0.75  # Fraction of a sample's points in each local fit; the default of LOESS
DRAWS = 2000  # Number of simulated measurements

LEAST_POINTS, LEAST_PRESSURES = 8, 6
"""Fewest points and pressures of a curve."""

_PERCENT = 100.0
_LEAST_SPREAD = 1e-6  # of log-pressure, and of a curve's log-irradiance
_TOO = ("those of the scatter", "too wide")  # of more and of less scatter than stated
_FAR_ABOVE = 3.0  # times the stated scatter, from which the points are in doubt
_NO_MINIMUM = 0.9  # share of the measured log-pressures within the interval of the optimum
_HEADINGS = ("sample", "points", "W/m²", "95 % interval", "at Pa", "95 % interval")

_BEYOND = 1.5  # factor by which a model's curve extends beyond the measured pressures
_PRESSURES = 200


@dataclass(frozen=True, repr=False)
class LevitationCurve(LabResult):
    """Curve through a sample's points, with its minimum."""

    points: LiftOffs
    #: Pressure of the minimum [Pa]; its interval contains the gauge's calibration
    optimal_pressure: Reported[Estimate]
    #: Least irradiance at which the sample levitates [W/m²]; its interval contains the light
    #: meter's calibration
    minimum_irradiance: Reported[Estimate]
    #: Whether the minimum is at the end of the measured pressures, so that the optimum may lie
    #: beyond: then its interval is open there, and that of the irradiance below
    at_edge: Reported[bool]
    pressure: np.ndarray  #: shape (m,); pressures of the curve [Pa]
    irradiance: np.ndarray  #: shape (m,); the curve [W/m²]
    #: shape (m,); its 95 % band, which contains the instruments' calibration [W/m²]
    lower: np.ndarray
    upper: np.ndarray  #: As ``lower``
    #: shape (b, 2); draws of the logarithms of pressure and irradiance at the true minimum, without
    #: the instruments' calibration
    draws: np.ndarray
    step: Reported[float] = 0.0  #: Step in which the light was raised [W/m²], 0 for none
    warnings: tuple[str, ...] = ()  #: What a reader of the result must know, one line each

    _drawing = "levitation.figures:levitation_curves"
    _several = True
    _height = 5.2

    def series(self) -> list[Series]:
        """The curve and its band over pressure."""
        return [
            Series("pressure", self.pressure, "Pa", "gas pressure"),
            Series("irradiance", self.irradiance, "W/m^2", "curve of the irradiance"),
            Series("lower", self.lower, "W/m^2", "lower end of the 95 % band"),
            Series("upper", self.upper, "W/m^2", "upper end of the 95 % band"),
        ]

    def parts(self) -> Parts:
        yield from curves_parts([self])


@dataclass(frozen=True, repr=False)
class Comparison(PrintedResult):
    """Reduction of the minimum irradiance from one sample to another."""

    first: str  #: Sample with the lower minimum irradiance
    second: str  #: The other sample
    #: One minus the ratio of their minimum irradiances [1]. The light meter's calibration is common
    #: to both and not in the interval
    reduction: Estimate

    def text_parts(self) -> Parts:
        low, high = (_PERCENT * end for end in self.reduction.interval)
        yield (
            f"{self.first} needs {_PERCENT * self.reduction.value:.1f} % less light than "
            f"{self.second} ({low:.1f} to {high:.1f} %)"
        )


@reads_units
def levitation_curve(
    points: LiftOffs,
    *,
    span: float = SPAN,
    draws: int = DRAWS,
    seed: int = 0,
    step: Irradiance = 0.0,
    pressure_accuracy: Fraction | None = None,
    irradiance_accuracy: Fraction | None = None,
) -> LevitationCurve:
    r"""Fit a smooth curve to a sample's points, and find its minimum.

    Parameters
    ----------
    points : LiftOffs
        Eight or more, at six or more pressures.
    span : float
        Fraction of the points in each local fit.
    draws : int
        Number of simulated measurements.
    seed : int
        Seed of the simulation.
    step : float
        Step in which the light was raised until the sample lifted off [W/m²], 0 where it was
        raised steadily.
    pressure_accuracy, irradiance_accuracy : float, optional
        Relative standard uncertainty of the calibration of pressure gauge and light meter. Where
        none is stated, a warning says what is assumed.

    Returns
    -------
    LevitationCurve

    Raises
    ------
    ConfigurationError
        If there are too few points or pressures, or only some have an uncertainty.
    ParameterError
        If an accuracy is not between 0 and 1, or the step is not smaller than every irradiance.

    Notes
    -----
    The curve is LOESS of degree 2 [Cleveland1988]_ on logarithms plus LOESS of its residuals
    ("twicing" [Tukey1977]_), which removes most of the bias of smoothing a bend. Points weigh by
    their uncertainties where these are stated. The 95 % intervals of curve and minimum are those of
    simulated measurements; see :mod:`lightflyer.lab.levitation.data`.
    """
    require_range("span", span, 0.1, 1.0)
    require_range("draws", draws, 100)
    accuracies, assumed = instruments(pressure_accuracy, irradiance_accuracy)
    count, pressures = len(points.pressure), np.unique(points.pressure).size
    if count < LEAST_POINTS:
        raise ConfigurationError(
            f"{points.place}: {points.name} has {count} point{'s' * (count != 1)}; a curve needs "
            f"{LEAST_POINTS} or more"
        )
    if pressures < LEAST_PRESSURES or np.ptp(np.log(points.pressure)) < _LEAST_SPREAD:
        raise ConfigurationError(
            f"{points.place}: {points.name} was measured at {pressures} "
            f"pressure{'s' * (pressures != 1)}; a curve needs {LEAST_PRESSURES} or more"
        )
    require_step(step, points.irradiance, points.place)
    x, y = np.log(points.pressure), np.log(points.irradiance - CENTRE * step)
    stated = None  # of each log-irradiance, that of pressure included
    if points.uncertainties.keys() & {"irradiance_uncertainty", "pressure_uncertainty"}:
        order = np.unique(x, return_index=True)[1]
        slope = np.gradient(smoother(x, x, span)[order] @ y, x[order])
        numbers = {
            "pressure": points.pressure, "irradiance": points.irradiance, **points.uncertainties
        }  # fmt: skip
        stated = log_uncertainty(numbers, np.interp(x, x[order], slope), points.place)
    least = minimum(
        x, points.irradiance, span=span, draws=draws, seed=seed, step=step, stated=stated
    )  # fmt: skip
    pressure, irradiance, band = _estimates(least, tuple(accuracies.values()), seed)
    said = list(points.notes)
    if least.gap is not None:
        low, high = np.exp(least.gap)
        said.append(Doubt(
            f"{points.place}: {points.name} has no point between {low:.3g} and {high:.3g} Pa, "
            "where its minimum lies: it is read across the gap, as far as the points on either "
            "side tell; measure there"
        ))  # fmt: skip
    if least.edge:
        said.append(Doubt(
            f"{points.place}: {points.name} has its minimum at the end of its pressures; the "
            "optimum may lie beyond: extend the measurement"
        ))  # fmt: skip
    elif pressure.interval[0] == 0.0 or not np.isfinite(pressure.interval[1]):
        said.append(
            f"{points.place}: the optimum of {points.name} may lie beyond its pressures: extend "
            "the measurement"
        )
    inside = np.clip(np.log(np.maximum(pressure.interval, 1e-300)), least.grid[0], least.grid[-1])
    if np.ptp(inside) > _NO_MINIMUM * np.ptp(least.grid) or np.ptp(least.curve) < _LEAST_SPREAD:
        said.append(Doubt(f"{points.place}: the points of {points.name} show no minimum"))
    if least.probability < LEAST_PROBABILITY or least.probability > 1.0 - LEAST_PROBABILITY:
        text = (
            f"the points of {points.name} scatter {least.excess:.2g} times as much as their stated "
            f"uncertainties say: intervals are {_TOO[least.excess < 1.0]}"
        )
        said.append(Doubt(text) if least.excess > _FAR_ABOVE else text)
    if least.alike > 1.0:
        said.append(
            f"residuals of {points.name} at neighbouring pressures are alike: the curve does not "
            "follow its points; intervals are wider for it; try a narrower --span"
        )
    found = None if step else found_step(points.irradiance)
    if found is not None:
        said.append(step_warning(points.name, found))
    of_points = doubts(points.pressure, points.irradiance, points.properties.get("diameter"))
    said += [Doubt(f"{points.name}: {text}") for text in of_points]
    if points.in_ground_effect:
        gap, diameter = 1e3 * float(points.floor_gap or 0.0), 1e3 * points.properties["diameter"]
        said.append(
            f"{points.place}: {points.name} is in ground effect: the floor is {gap:.3g} mm below, "
            f"less than the diameter of {diameter:.3g} mm"
        )
    return LevitationCurve(
        points, pressure, irradiance, least.edge != 0, np.exp(least.grid), np.exp(least.curve),
        lower=np.exp(np.minimum(band[0], least.curve)),
        upper=np.exp(np.maximum(band[1], least.curve)),
        draws=np.stack([least.places, least.values], axis=1), step=step,
        warnings=(*said, *assumed),
    )  # fmt: skip


def _estimates(
    least: Minimum, accuracies: tuple[float, ...], seed: int
) -> tuple[Estimate, Estimate, np.ndarray]:
    """Optimum, least irradiance and log-irradiances of the band, with the instruments' errors."""
    rng = np.random.default_rng([seed, len(least.places)])
    gauge, meter = (one * rng.normal(size=len(least.places)) for one in accuracies)
    found = []
    for logarithm, draws, unit in (
        (least.place, least.places + gauge, "Pa"), (least.value, least.values + meter, "W/m^2")
    ):  # fmt: skip
        one, value = Estimate.of_draws(logarithm, draws), float(np.exp(logarithm))
        low, high = map(float, np.exp(one.interval))
        found.append(Estimate(value, (low, high), unit, value * (one.uncertainty or 0.0)))
    pressure, irradiance = found
    low, high = pressure.interval
    tail = 0.5 * (1.0 - CONFIDENCE)
    if np.mean(least.edges == -1) > tail:
        low = 0.0
    if np.mean(least.edges == 1) > tail:
        high = np.inf
    pressure = replace(pressure, interval=(low, high))
    if least.edge:
        irradiance = replace(irradiance, interval=(0.0, irradiance.interval[1]))
    slope = np.gradient(least.curve, least.grid)
    band = central_interval(least.curves + meter[:, None] - np.outer(gauge, slope), axis=0)
    return pressure, irradiance, band


def compare(curves: Sequence[LevitationCurve]) -> list[Comparison]:
    """Compare the minimum irradiances of every two samples.

    Parameters
    ----------
    curves : sequence of LevitationCurve

    Returns
    -------
    list of Comparison
        The sample with the lower minimum irradiance is first. Both are taken to be measured with
        the same light meter, whose calibration then cancels.
    """
    found = []
    # two samples simulated from one seed have the same errors
    shuffle = np.random.default_rng(len(curves)).permutation
    for pair in combinations(curves, 2):
        less, more = sorted(pair, key=lambda curve: curve.minimum_irradiance.value)
        count = min(len(less.draws), len(more.draws))
        ratios = np.exp(less.draws[:count, 1] - shuffle(more.draws[:count, 1]))
        value = 1.0 - less.minimum_irradiance.value / more.minimum_irradiance.value
        reduction = Estimate.of_draws(value, 1.0 - ratios)
        found.append(Comparison(less.points.name, more.points.name, reduction))
    return found


def summary(curves: Sequence[LevitationCurve]) -> dict[str, Any]:
    """Samples and their comparisons as a JSON object."""
    return {
        "samples": {
            curve.points.name: curve.reported()
            | {"points": len(curve.points.pressure)}
            | {"in_ground_effect": curve.points.in_ground_effect}
            for curve in curves
        },
        "warnings": joint_warnings([("", curve.warnings) for curve in curves]),
        "comparisons": [
            {"a": one.first, "b": one.second, "reduction": plain(one.reduction)}
            for one in compare(curves)
        ],
    }


def to_dataset(curves: Sequence[LevitationCurve], files: Sequence[str]) -> "xr.Dataset":
    """Points of all samples over ``point``, curves over ``sample`` and ``node``."""
    lots = [curve.points for curve in curves]
    owner = np.repeat(np.arange(len(lots)), [len(one.pressure) for one in lots])
    pressure, irradiance = (
        np.concatenate([getattr(one, name) for one in lots]) for name in ("pressure", "irradiance")
    )
    points = [
        Series("point_sample", owner, "", "position of the sample, from 0"),
        Series("point_pressure", pressure, "Pa", "gas pressure"),
        Series("point_irradiance", irradiance, "W/m^2", "irradiance at lift-off"),
    ]
    lines = [
        of_samples[0]._replace(values=np.stack([one.values for one in of_samples]))
        for of_samples in zip(*(curve.series() for curve in curves), strict=True)
    ]
    return dataset(
        "levitation",
        variables("point", points) | variables(("sample", "node"), lines),
        files,
        warnings=joint_warnings([("", curve.warnings) for curve in curves]),
        samples=", ".join(one.name for one in lots),
    )


def tables(curves: Sequence[LevitationCurve]) -> dict[str, str]:
    """Curve of each sample with its 95 % band as CSV, by file name."""
    return {
        f"levitation-curve-{number}.csv": csv_text(
            [f"# {one.points.name}; 95 % band"], one.series()
        )
        for number, one in enumerate(curves, start=1)
    }


def curves_parts(curves: Sequence[LevitationCurve]) -> Parts:
    """What the sample needs that needs least light, and all of them."""
    least = min(curves, key=lambda curve: curve.minimum_irradiance.value)
    words = "needs" if len(curves) == 1 else f"needs the least light of {len(curves)} samples,"
    rows = {
        curve.points.name: [
            text
            for one in (curve.minimum_irradiance, curve.optimal_pressure)
            for text in (f"{one.value:.4g}", open_interval_text(*one.interval))
        ]
        for curve in curves
    }
    light, of_light, place, of_place = rows[least.points.name]
    yield f"{least.points.name} {words} {light} W/m² ({of_light}), at {place} Pa ({of_place})"
    counts = [str(len(curve.points.pressure)) for curve in curves]
    cells = ((name, count, *row) for (name, row), count in zip(rows.items(), counts, strict=True))
    yield table_of(_HEADINGS, cells, title="minimum irradiance and its pressure")


def model_curve(points: LiftOffs, setup: Setup) -> tuple[np.ndarray, np.ndarray]:
    """Irradiance at which the model levitates, a little beyond the pressures of a sample."""
    low, high = points.pressure.min() / _BEYOND, points.pressure.max() * _BEYOND
    pressure = np.geomspace(low, high, _PRESSURES)
    design = as_design(setup)
    values: dict[str, float] = {}
    for name, value in points.properties.items():
        target = target_of(design, name, describes_flyer=True)
        values |= dict.fromkeys(target.fields, target.factor * value)
    sample = design.build(values)
    found = levitate(sample.flyer, sample.environment.state(pressure), sample.model, throw=False)
    return pressure, np.where(found.levitates, found.irradiance, np.nan)


def calibrate_curves(
    curves: Sequence[LevitationCurve],
    what: Any,
    *,
    keep_ground_effect: bool = False,
    pressure_accuracy: float | None = None,
    irradiance_accuracy: float | None = None,
) -> Calibration:
    """Fit the force coefficients to the points of all samples."""
    lots = []
    for curve in curves:
        lot, count = curve.points, len(curve.points.pressure)
        gap = None if keep_ground_effect else lot.floor_gap
        numbers = {"pressure": lot.pressure, "irradiance": lot.irradiance, **lot.uncertainties}
        numbers |= {name: np.full(count, value) for name, value in lot.properties.items()}
        numbers["floor_gap"] = np.full(count, np.inf if gap is None else gap)
        lots.append(Points(lot.place, [lot.name] * count, numbers).with_step(curve.step))
    shared = set.intersection(*(set(one.numbers) for one in lots))
    whole = Points(
        source=lots[0].source,
        samples=[name for one in lots for name in one.samples],
        numbers={
            name: np.concatenate([one.numbers[name] for one in lots])
            for name in lots[0].numbers
            if name in shared
        },
        step=max(curve.step for curve in curves),
    )
    return calibrate(
        what,
        points=whole.without_ground_effect(),
        pressure_accuracy=pressure_accuracy,
        irradiance_accuracy=irradiance_accuracy,
    )


def measured_coefficients(fit: Calibration) -> dict[str, Estimate]:
    """Fitted parameters with what goes into the flyer file that the fit started from."""
    found = {}
    meters = [fit.contributions[one] for one in INSTRUMENTS if one in fit.contributions]
    for row, name in enumerate(fit.names):
        value = float(fit.values[row])
        calibration = [value * float(shares[row]) for shares in meters]
        spread = math.hypot(fit.standard_uncertainties[row], *calibration)
        low, high = map(float, fit.total_intervals[row])
        found[name] = Estimate(value, (low, high), "", spread)
    return found
