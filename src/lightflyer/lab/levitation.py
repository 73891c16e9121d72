r"""Optimal pressure and minimum irradiance from levitation points.

Points of pressure and irradiance at which a sample lifted off are smoothed by LOESS of degree 2 on
logarithms, and the least irradiance of the curve and its pressure are found, with intervals.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.calibration.points import NUMBERS, SAMPLE_PROPERTIES
from lightflyer.foundation.checks import require_range
from lightflyer.foundation.errors import ConfigurationError, ParameterWarning
from lightflyer.foundation.extras import extra
from lightflyer.foundation.layout import Column
from lightflyer.foundation.quantity import Quantity
from lightflyer.foundation.table import Table, read_table
from lightflyer.lab.estimate import Estimate, central_interval
from lightflyer.lab.record import dataset

if TYPE_CHECKING:
    import xarray as xr

SPAN = 0.75
"""Share of a sample's points that each local fit sees; LOESS's own default."""

BAND_CONFIDENCE = 0.99
"""Of the band about the curve."""

DRAWS = 2000
"""Resamples of the bootstrap."""

_DEGREE = 2
_LEAST_POINTS = 8
_LEAST_PRESSURES = 6
_LEAST_SPREAD = 1e-6  # of log-pressure
_GRID = 300  # pressures of a curve
_LEAST_SHARE_OF_DRAWS = 0.9  # that LOESS must be able to fit

COLUMNS = (
    Column("sample", aliases=("name",), text=True, blank=False),
    Column("launchpad", aliases=("pad",), text=True),
    Column("pressure", NUMBERS["pressure"], ("p", "chamber_pressure"), required=True),
    Column("irradiance", NUMBERS["irradiance"], ("i", "intensity"), required=True),
    Column("floor_gap", Quantity("m", 0.0), ("gap",)),
    *(Column(name, NUMBERS[name]) for name in SAMPLE_PROPERTIES),
)
"""Columns of a file of points."""


@dataclass(frozen=True)
class LiftOffs:
    """Points at which one sample lifted off from one launchpad.

    Attributes
    ----------
    name : str
    pressure : array, shape (n,)
        [Pa].
    irradiance : array, shape (n,)
        [W/m²].
    place : str
        File and lines, for messages.
    floor_gap : float or None
        Between launchpad and floor [m].
    properties : dict of str to float
        What is known of the sample, in SI units, by names from
        :data:`lightflyer.calibration.points.SAMPLE_PROPERTIES`.
    """

    name: str
    pressure: np.ndarray
    irradiance: np.ndarray
    place: str = ""
    floor_gap: float | None = None
    properties: dict[str, float] = field(default_factory=dict)

    @property
    def in_ground_effect(self) -> bool:
        """Whether the gap to the floor is below the disk's diameter."""
        gap, diameter = self.floor_gap, self.properties.get("diameter")
        return gap is not None and diameter is not None and gap < diameter


@dataclass(frozen=True)
class LevitationCurve:
    """The curve through a sample's points, and its least irradiance.

    Attributes
    ----------
    points : LiftOffs
    optimal_pressure : Estimate
        Where the least light is needed [Pa].
    minimum_irradiance : Estimate
        The least light needed [W/m²].
    at_edge : bool
        Whether the least is at the end of the pressures measured, and so no least.
    pressure : array, shape (m,)
        Of the curve [Pa].
    irradiance, lower, upper : array, shape (m,)
        LOESS curve and its 99 % band [W/m²].
    draws : array, shape (b, 2)
        Log-pressure and log-irradiance of the least of every resample.
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
    """How much less light one sample needs than another.

    Attributes
    ----------
    first, second : str
        The sample that needs less, and the other.
    reduction : Estimate
        One minus the ratio of their minimum irradiances [1].
    """

    first: str
    second: str
    reduction: Estimate


def read_lift_offs(path: str | Path, *, columns: str | None = None) -> tuple[list[LiftOffs], Table]:
    """Read levitation points.

    Parameters
    ----------
    path : str or path
        Table with ``pressure`` and ``irradiance``, units in the header; ``sample`` where there is
        more than one, and further ``launchpad``, ``floor_gap`` and what a sample is:
        :data:`lightflyer.calibration.points.SAMPLE_PROPERTIES`.
    columns : str, optional
        The columns in place of a header; see :func:`lightflyer.foundation.table.read_table`.

    Returns
    -------
    samples : list of LiftOffs
        One for every sample on every launchpad.
    table : Table
        What was read.

    Raises
    ------
    ConfigurationError
        One line that names file and line.
    """
    table = read_table(path, COLUMNS, layout=columns)
    samples = table.texts.get("sample", [Path(path).stem] * len(table))
    pads = table.texts.get("launchpad")
    names = (
        samples
        if pads is None
        else [f"{sample} on {pad}" for sample, pad in zip(samples, pads, strict=True)]
    )
    return [_sample(table, names, name) for name in dict.fromkeys(names)], table


def _sample(table: Table, names: Sequence[str], name: str) -> LiftOffs:
    rows = np.flatnonzero([one == name for one in names])
    lines = table.lines[rows]
    place = f"{table.source}:{lines[0]}"

    def only(column: str) -> float | None:
        if column not in table.numbers:
            return None
        values = np.unique(table.numbers[column][rows])
        if values.size > 1:
            raise ConfigurationError(f"{place}: {name} has more than one {column}")
        return float(values[0])

    return LiftOffs(
        name=name,
        pressure=table.numbers["pressure"][rows],
        irradiance=table.numbers["irradiance"][rows],
        place=place,
        floor_gap=only("floor_gap"),
        properties={
            column: value for column in SAMPLE_PROPERTIES if (value := only(column)) is not None
        },
    )


def levitation_curve(
    points: LiftOffs, *, span: float = SPAN, draws: int = DRAWS, seed: int = 0
) -> LevitationCurve:
    r"""LOESS curve through a sample's points, with optimal pressure and minimum irradiance.

    Parameters
    ----------
    points : LiftOffs
        Eight or more, over six or more pressures.
    span : float
        Share of the points that each local fit sees.
    draws : int
        Resamples of the bootstrap.
    seed : int
        Of the resamples.

    Returns
    -------
    LevitationCurve

    Raises
    ------
    ConfigurationError
        If there are too few points, or they are at too few pressures.
    MissingExtraError
        If scikit-misc is not installed.

    Warns
    -----
    ParameterWarning
        If the least irradiance is at the end of the pressures.

    Notes
    -----
    Curve and 99 % band are those of LOESS of degree 2 [Cleveland1988]_ on logarithms. The least
    irradiance is that of the curve to which LOESS of its residuals is added, once ("twicing"
    [Tukey1977]_), which takes out most of the error that smoothing a bend makes. Intervals hold
    the middle 95 % of what resamples of the points give.
    """
    require_range("span", span, 0.1, 1.0)
    require_range("draws", draws, 100)
    _require_enough(points)
    loess = extra("skmisc.loess", "smoothing levitation points", "lab").loess
    x, y = np.log(points.pressure), np.log(points.irradiance)
    grid = np.linspace(x.min(), x.max(), _GRID)
    fitted = _loess(loess, x, y, span)
    if fitted is None:
        raise ConfigurationError(f"{points.place}: LOESS cannot fit {points.name}: add points")
    predicted = fitted.predict(grid, stderror=True)
    band = predicted.confidence(1.0 - BAND_CONFIDENCE)
    best, at_edge = _least(grid, _twice(loess, x, y, span, grid))
    if at_edge:
        warnings.warn(
            f"{points.place}: {points.name} needs least light at the end of its pressures, so "
            "its optimum may lie beyond; measure farther",
            ParameterWarning,
            stacklevel=2,
        )
    resampled = _bootstrap(loess, x, y, span, draws, seed)
    if len(resampled) < _LEAST_SHARE_OF_DRAWS * draws:
        raise ConfigurationError(f"{points.place}: {points.name} has too few points to resample")
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
            f"{place}: {name} has {count} point{'s' * (count != 1)}; a curve takes "
            f"{_LEAST_POINTS} or more"
        )
    if pressures < _LEAST_PRESSURES or np.ptp(np.log(points.pressure)) < _LEAST_SPREAD:
        raise ConfigurationError(
            f"{place}: {name} was measured at {pressures} pressure{'s' * (pressures != 1)}; a "
            f"curve takes {_LEAST_PRESSURES} or more"
        )


def _loess(loess: Any, x: np.ndarray, y: np.ndarray, span: float) -> Any:
    """A fitted curve, or None where the points do not carry one."""
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
    """Vertex of the parabola through the least of equidistant values, and whether it is an end."""
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
    """Value and percentile interval of a positive quantity, from logarithms."""
    low, high = np.exp(central_interval(log_draws))
    value = float(np.exp(log_value))
    spread = value * float(log_draws.std(ddof=1))
    # the estimate itself belongs to its interval, which resamples of few points may leave
    return Estimate(value, (min(float(low), value), max(float(high), value)), unit, spread)


def compare(curves: Sequence[LevitationCurve]) -> list[Comparison]:
    """Reduction of the minimum irradiance between every two samples.

    Parameters
    ----------
    curves : sequence of LevitationCurve

    Returns
    -------
    list of Comparison
        The sample that needs less light stands first.
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
    """The points and the curves of all samples.

    Parameters
    ----------
    curves : sequence of LevitationCurve
    files : sequence of str
        Read.

    Returns
    -------
    xarray.Dataset
        Points over ``point``, curves over ``sample`` and ``node``.
    """
    light = ("W m-2", "irradiance at which the sample lifts off")
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
            "point_sample": ("point", owner, {"units": "1", "long_name": "number of the sample"}),
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
