r"""Optimal pressure and minimum irradiance from levitation points.

LOESS of degree 2 on logarithms smooths the points at which a sample lifted off. The minimum of the
curve is the least irradiance at which the sample levitates.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.foundation.checks import require_range
from lightflyer.foundation.errors import ConfigurationError, ParameterWarning
from lightflyer.foundation.extras import extra
from lightflyer.lab.estimate import Estimate, central_interval
from lightflyer.lab.levitation_data import LiftOffs
from lightflyer.lab.record import dataset

if TYPE_CHECKING:
    import xarray as xr

SPAN = 0.75
"""Fraction of a sample's points in each local fit; the default of LOESS."""

BAND_CONFIDENCE = 0.99
"""Confidence of the band about the curve."""

DRAWS = 2000
"""Number of bootstrap resamples."""

_DEGREE = 2
_LEAST_POINTS = 8
_LEAST_PRESSURES = 6
_LEAST_SPREAD = 1e-6  # of log-pressure
_GRID = 300  # pressures of a curve
_LEAST_FITTED = 0.9  # fraction of the resamples that LOESS must be able to fit


@dataclass(frozen=True)
class LevitationCurve:
    """Curve through a sample's points, with its minimum.

    Attributes
    ----------
    points : LiftOffs
    optimal_pressure : Estimate
        Pressure of the minimum [Pa].
    minimum_irradiance : Estimate
        Least irradiance at which the sample levitates [W/m²].
    at_edge : bool
        Whether the minimum is at the end of the measured pressures, so that the optimum may lie
        beyond.
    pressure : array, shape (m,)
        Pressures of the curve [Pa].
    irradiance, lower, upper : array, shape (m,)
        LOESS curve and its 99 % band [W/m²].
    draws : array, shape (b, 2)
        Logarithms of pressure and irradiance at the minimum of each resample.
    """

    points: LiftOffs
    optimal_pressure: Estimate
    minimum_irradiance: Estimate
    at_edge: bool
    pressure: np.ndarray
    irradiance: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    draws: np.ndarray


@dataclass(frozen=True)
class Comparison:
    """Reduction of the minimum irradiance from one sample to another.

    Attributes
    ----------
    first, second : str
        Sample with the lower minimum irradiance, and the other sample.
    reduction : Estimate
        One minus the ratio of their minimum irradiances [1].
    """

    first: str
    second: str
    reduction: Estimate


def levitation_curve(
    points: LiftOffs, *, span: float = SPAN, draws: int = DRAWS, seed: int = 0
) -> LevitationCurve:
    r"""Fit a LOESS curve to a sample's points, and find its minimum.

    Parameters
    ----------
    points : LiftOffs
        Eight or more, at six or more pressures.
    span : float
        Fraction of the points in each local fit.
    draws : int
        Number of bootstrap resamples.
    seed : int
        Seed of the resampling.

    Returns
    -------
    LevitationCurve

    Raises
    ------
    ConfigurationError
        If there are too few points or pressures.
    MissingExtraError
        If scikit-misc is not installed.

    Warns
    -----
    ParameterWarning
        If the minimum is at the end of the pressures.

    Notes
    -----
    Curve and 99 % band are those of LOESS of degree 2 [Cleveland1988]_ on logarithms. The minimum
    is that of the curve plus LOESS of its residuals ("twicing" [Tukey1977]_), which removes most
    of the bias of smoothing a bend. Intervals are the central 95 % of bootstrap resamples.
    """
    require_range("span", span, 0.1, 1.0)
    require_range("draws", draws, 100)
    _require_enough(points)
    loess = extra("skmisc.loess", "smoothing levitation points", "lab").loess
    x, y = np.log(points.pressure), np.log(points.irradiance)
    grid = np.linspace(x.min(), x.max(), _GRID)
    fitted = _loess(loess, x, y, span)
    if fitted is None:
        raise ConfigurationError(f"{points.place}: LOESS cannot fit {points.name}; add points")
    predicted = fitted.predict(grid, stderror=True)
    band = predicted.confidence(1.0 - BAND_CONFIDENCE)
    best, at_edge = _least(grid, _twice(loess, x, y, span, grid))
    if at_edge:
        warnings.warn(
            f"{points.place}: {points.name} has its minimum at the end of its pressures; the "
            "optimum may lie beyond: extend the measurement",
            ParameterWarning,
            stacklevel=2,
        )
    resampled = _bootstrap(loess, x, y, span, draws, seed)
    if len(resampled) < _LEAST_FITTED * draws:
        raise ConfigurationError(
            f"{points.place}: {points.name} has too few points for a bootstrap"
        )
    estimates = [
        _estimate(value, resampled[:, number], unit)
        for number, (value, unit) in enumerate(zip(best, ("Pa", "W/m^2"), strict=True))
    ]
    return LevitationCurve(
        points=points,
        optimal_pressure=estimates[0],
        minimum_irradiance=estimates[1],
        at_edge=at_edge,
        pressure=np.exp(grid),
        irradiance=np.exp(predicted.values),
        lower=np.exp(band.lower),
        upper=np.exp(band.upper),
        draws=resampled,
    )


def _require_enough(points: LiftOffs) -> None:
    count, pressures = len(points.pressure), np.unique(points.pressure).size
    place, name = points.place, points.name
    if count < _LEAST_POINTS:
        raise ConfigurationError(
            f"{place}: {name} has {count} point{'s' * (count != 1)}; a curve needs "
            f"{_LEAST_POINTS} or more"
        )
    if pressures < _LEAST_PRESSURES or np.ptp(np.log(points.pressure)) < _LEAST_SPREAD:
        raise ConfigurationError(
            f"{place}: {name} was measured at {pressures} pressure{'s' * (pressures != 1)}; a "
            f"curve needs {_LEAST_PRESSURES} or more"
        )


def _loess(loess: Any, x: np.ndarray, y: np.ndarray, span: float) -> Any:
    """Fitted curve, or None where LOESS cannot fit the points."""
    curve = loess(x, y, span=span, degree=_DEGREE)
    try:
        curve.fit()
    except ValueError:
        return None
    return curve


def _twice(
    loess: Any, x: np.ndarray, y: np.ndarray, span: float, grid: np.ndarray
) -> np.ndarray | None:
    """LOESS plus LOESS of its residuals, on a grid."""
    first = _loess(loess, x, y, span)
    if first is None:
        return None
    second = _loess(loess, x, first.outputs.fitted_residuals, span)
    if second is None:
        return None
    values = first.predict(grid).values + second.predict(grid).values
    return values if np.all(np.isfinite(values)) else None


def _least(grid: np.ndarray, values: Any) -> tuple[tuple[float, float], bool]:
    """Vertex of the parabola through the least of equidistant values; whether it is at an end."""
    lowest = int(np.argmin(values))
    if lowest in (0, len(grid) - 1):
        return (float(grid[lowest]), float(values[lowest])), True
    before, here, after = values[lowest - 1 : lowest + 2]
    shift = 0.5 * (before - after) / (before - 2.0 * here + after)
    step = grid[1] - grid[0]
    return (
        float(grid[lowest] + shift * step),
        float(here - 0.25 * (before - after) * shift),
    ), False


def _bootstrap(
    loess: Any, x: np.ndarray, y: np.ndarray, span: float, draws: int, seed: int
) -> np.ndarray:
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(draws):
        rows = rng.integers(0, len(x), len(x))
        grid = np.linspace(x[rows].min(), x[rows].max(), _GRID)
        values = _twice(loess, x[rows], y[rows], span, grid) if grid[0] < grid[-1] else None
        if values is not None:
            found.append(_least(grid, values)[0])
    return np.array(found).reshape(-1, 2)


def _estimate(log_value: float, log_draws: np.ndarray, unit: str) -> Estimate:
    """Positive quantity with its percentile interval, from logarithms."""
    low, high = np.exp(central_interval(log_draws))
    value = float(np.exp(log_value))
    spread = value * float(log_draws.std(ddof=1))
    # resamples of few points may miss the estimate, which belongs to its interval
    return Estimate(value, (min(float(low), value), max(float(high), value)), unit, spread)


def compare(curves: Sequence[LevitationCurve]) -> list[Comparison]:
    """Compare the minimum irradiances of every two samples.

    Parameters
    ----------
    curves : sequence of LevitationCurve

    Returns
    -------
    list of Comparison
        The sample with the lower minimum irradiance is first.
    """
    found = []
    for pair in combinations(curves, 2):
        less, more = sorted(pair, key=lambda curve: curve.minimum_irradiance.value)
        count = min(len(less.draws), len(more.draws))
        ratios = np.exp(less.draws[:count, 1] - more.draws[:count, 1])
        low, high = central_interval(1.0 - ratios)
        value = 1.0 - less.minimum_irradiance.value / more.minimum_irradiance.value
        interval = (min(float(low), value), max(float(high), value))
        reduction = Estimate(value, interval, "", float(ratios.std(ddof=1)))
        found.append(Comparison(less.points.name, more.points.name, reduction))
    return found


def summary(curves: Sequence[LevitationCurve]) -> dict[str, Any]:
    """Samples and their comparisons as a JSON object.

    Parameters
    ----------
    curves : sequence of LevitationCurve

    Returns
    -------
    dict
    """
    return {
        "samples": {
            curve.points.name: {
                "optimal_pressure": curve.optimal_pressure.to_json(),
                "minimum_irradiance": curve.minimum_irradiance.to_json(),
                "points": len(curve.points.pressure),
                "at_edge": curve.at_edge,
                "in_ground_effect": curve.points.in_ground_effect,
            }
            for curve in curves
        },
        "comparisons": [
            {"a": one.first, "b": one.second, "reduction": one.reduction.to_json()}
            for one in compare(curves)
        ],
    }


def to_dataset(curves: Sequence[LevitationCurve], files: Sequence[str]) -> "xr.Dataset":
    """Points and curves of all samples.

    Parameters
    ----------
    curves : sequence of LevitationCurve
    files : sequence of str
        Names of the files read.

    Returns
    -------
    xarray.Dataset
        Points over ``point``, curves over ``sample`` and ``node``.
    """
    light = ("W m-2", "irradiance at lift-off")
    names = [curve.points.name for curve in curves]

    def points(field: str) -> np.ndarray:
        return np.concatenate([getattr(curve.points, field) for curve in curves])

    def nodes(field: str, units: str, long_name: str) -> Any:
        values = np.stack([getattr(curve, field) for curve in curves])
        return ("sample", "node"), values, {"units": units, "long_name": long_name}

    owner = np.repeat(np.arange(len(curves)), [len(curve.points.pressure) for curve in curves])
    return dataset(
        "levitation",
        {
            "point_sample": (
                "point",
                owner,
                {"units": "1", "long_name": "position of the sample, from 0"},
            ),
            "point_pressure": ("point", points("pressure"), _named("Pa", "gas pressure")),
            "point_irradiance": ("point", points("irradiance"), _named(*light)),
            "pressure": nodes("pressure", "Pa", "gas pressure"),
            "irradiance": nodes("irradiance", "W m-2", "LOESS curve of the irradiance"),
            "lower": nodes("lower", "W m-2", "lower end of the 99 % band"),
            "upper": nodes("upper", "W m-2", "upper end of the 99 % band"),
        },
        files,
        samples=", ".join(names),
    )


def _named(units: str, long_name: str) -> dict[str, str]:
    return {"units": units, "long_name": long_name}
