"""Points at which samples lifted off, their files, and the minimum of a smooth curve through them.

Local regression is linear in the data: for given pressures the smoothed curve is a matrix times
the measured logarithms. That makes the scatter's degrees of freedom [Cleveland1988]_ and simulated
measurements cheap to find, for few points too, where resampling the points themselves fails.
"""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.calibration.gauge import CENTRE, UNIFORM_SPREAD, Gauge, end_text, rows_at_the_end
from lightflyer.calibration.points import (
    LEAST_PROBABILITY,
    LEVITATION_COLUMNS,
    SAMPLE_PROPERTIES,
    read_points,
)
from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import ConfigurationError
from lightflyer.files.table import Table

COLUMNS = LEVITATION_COLUMNS
"""Columns of a file of levitation points, the same as for a calibration."""

DEGREE = 2  # Degree of the local polynomials

_GRID = 300  # places of the curve
_GAP = 0.2  # of the log-pressures, in one step between neighbours
_DEGREES = 3  # coefficients of the parabola that a curve across a gap leaves
_RATIOS = np.geomspace(1.0, 1e12, 49)  # of its bends' variance to the scatter's, log-pressures 0..1
_UNLIKELY = 1e-4  # of the likeliest ratio
_LEAST_LIGHT = 0.25  # of a step, that a simulated reading is kept above
_TINY = 1e-9  # of a local fit's singular values


@dataclass(frozen=True)
class LiftOffs(ShortRepr):
    """Points at which one sample lifted off from one launchpad."""

    name: str
    pressure: np.ndarray  #: shape (n,); [Pa]
    irradiance: np.ndarray  #: shape (n,); [W/m²]
    place: str = ""  #: File and first line, for messages
    floor_gap: float | None = None  #: Distance between launchpad and floor [m]
    #: Known properties of the sample in SI units, by names of
    #: :data:`lightflyer.calibration.points.SAMPLE_PROPERTIES`
    properties: dict[str, float] = field(default_factory=dict)
    #: shape (n,); stated standard uncertainties, by the names of their columns
    uncertainties: dict[str, np.ndarray] = field(default_factory=dict)
    notes: tuple[str, ...] = ()  #: What was done to the points, one line each

    @property
    def in_ground_effect(self) -> bool:
        """Whether the gap to the floor is smaller than the disk's diameter."""
        gap, diameter = self.floor_gap, self.properties.get("diameter")
        return gap is not None and diameter is not None and gap < diameter


@reads_units
def read_lift_offs(
    path: str | Path, *, columns: str | None = None, gauge: Gauge | None = None
) -> tuple[list[LiftOffs], Table]:
    """Read levitation points, by :func:`~lightflyer.calibration.points.read_points`.

    Parameters
    ----------
    path : str or path
        Table with ``pressure`` and ``irradiance``, units in the header; ``sample`` where there is
        more than one; optionally ``launchpad``, ``floor_gap`` and properties of the sample:
        :data:`lightflyer.calibration.points.SAMPLE_PROPERTIES`.
    columns : str, optional
        The columns in the order of the file, in place of a header; see
        :func:`~lightflyer.files.table.read_table`.
    gauge : Gauge, optional
        What the gauge shows of a pressure; by default the pressure itself.

    Returns
    -------
    samples : list of LiftOffs
        One for every sample on every launchpad.
    table : Table
        Table that was read, with its rejected rows.

    Raises
    ------
    ConfigurationError
        One line that names file and line.
    """
    points = read_points(path, columns=columns, gauge=gauge)
    lots = []
    for name in dict.fromkeys(points.samples):
        here = points.where(points.of(name))
        ends = rows_at_the_end(here.pressure, here.irradiance)
        said = [
            f"{np.sum(here.pressure[ends] == one)} points of {name} are left out: {end_text(one)}"
            for one in np.unique(here.pressure[ends])
        ]
        here = here.where(~ends)
        place = f"{here.source}:{here.lines[0]}"
        properties = {}
        for column in ("floor_gap", *SAMPLE_PROPERTIES):
            if column not in here.numbers:
                continue
            values = np.unique(here.numbers[column])
            if values.size > 1:
                raise ConfigurationError(f"{place}: {name} has more than one {column}")
            properties[column] = float(values[0])
        floor_gap = properties.pop("floor_gap", None)
        numbers = here.numbers.items()
        uncertainties = {name: one for name, one in numbers if name.endswith("_uncertainty")}
        lots.append(LiftOffs(
            name, here.pressure, here.irradiance, place, floor_gap, properties, uncertainties,
            (*here.notes, *said),
        ))  # fmt: skip
    return lots, points.table


@dataclass(frozen=True)
class Minimum:
    """Minimum of a curve of log-irradiance over log-pressure."""

    place: float  # Logarithms of pressure and irradiance
    value: float  # Logarithms of pressure and irradiance
    edge: int  # -1 or 1 where it is at the first or last pressure, otherwise 0
    places: np.ndarray  # shape (b,); draws from the distribution of the true minimum
    values: np.ndarray
    edges: np.ndarray  # shape (b,); the same as ``edge`` of each draw
    grid: np.ndarray  # shape (m,); log-pressures of the curve
    curve: np.ndarray  # shape (m,); log-irradiance there
    curves: np.ndarray  # shape (b, m); draws from the distribution of the true curve
    alike: float  # Points at neighbouring pressures that deviate from the curve together
    # Scatter over what is stated, and the probability of more by chance; NaN where none is stated
    excess: float
    probability: float
    gap: tuple[float, float] | None  # Log-pressures between which no point is, and the minimum is


def smoother(
    x: np.ndarray, places: np.ndarray, span: float, weight: np.ndarray | float = 1.0
) -> np.ndarray:
    """Matrix of local regression with LOESS' tricube weights, shape (m, n); ``weight`` (n,)."""
    count = max(int(span * x.size), DEGREE + 1)
    distance = np.abs(places[:, None] - x)
    reach = np.sort(distance, axis=1)[:, count - 1 : count]
    reach = np.where(reach > 0.0, reach, 1.0)
    root = np.sqrt(np.clip(1.0 - (distance / reach) ** 3, 0.0, None) ** 3 * weight)
    powers = (x - places[:, None])[..., None] ** np.arange(DEGREE + 1)
    return np.asarray(np.linalg.pinv(powers * root[..., None], _TINY)[:, 0, :] * root)


def across(
    x: np.ndarray,
    y: np.ndarray,
    grid: np.ndarray,
    error: np.ndarray,
    draws: int,
    rng: np.random.Generator,
    known: float | None,
) -> tuple[np.ndarray, np.ndarray]:
    """Curve through points on both sides of a gap, shape (m,), and draws of it, shape (b, m).

    ``error``: the points' scatter, shape (n,), in units of ``known``, or of what is unknown.
    """
    # [Wahba1978]_: of a parabola whose second derivative walks at random, the expected curve is the
    # quintic smoothing spline. How far it walks, the points tell; before them, Jeffreys' prior.
    # They are projected where the parabola is none, and its covariance is diagonal.
    places, s = ((one - grid[0]) / np.ptp(grid) for one in (grid, x))
    powers = np.vander(s, _DEGREES)
    free = np.linalg.qr(powers / error[:, None], mode="complete")[0][:, _DEGREES:]
    bends, axes = np.linalg.eigh(free.T @ (_bends(s, s) / np.outer(error, error)) @ free)
    variance = 1.0 + np.outer(_RATIOS, np.maximum(bends, 0.0))
    square = np.sum((axes.T @ (free.T @ (y / error))) ** 2 / variance, axis=1)
    share, count = 1.0 - 1.0 / variance, bends.size
    told = np.sum(share**2, axis=1) - (0.0 if known else np.sum(share, axis=1) ** 2 / count)
    misfit = square / known**2 if known else count * np.log(square)
    chance = np.exp(-0.5 * (np.sum(np.log(variance), axis=1) + misfit - misfit.min()))
    chance *= np.sqrt(np.maximum(told, 0.0))
    chance[chance < _UNLIKELY * chance.max()] = 0.0
    chance /= chance.sum()
    which = rng.choice(_RATIOS.size, draws, p=chance)
    spread = (
        np.full(draws, known) if known else np.sqrt(square[which] / rng.chisquare(count, draws))
    )
    everywhere = np.concatenate([places, s])
    values, vectors = np.linalg.eigh(_bends(everywhere, everywhere))
    walk = vectors * np.sqrt(np.maximum(values, 0.0))
    curve, curves = np.zeros(grid.size), np.empty((draws, grid.size))
    for number in np.flatnonzero(chance):
        ratio, here = _RATIOS[number], np.flatnonzero(which == number)
        inverse = np.linalg.inv(ratio * _bends(s, s) + np.diag(error**2))
        parabola = np.linalg.solve(powers.T @ inverse @ powers, powers.T @ inverse)
        rest = ratio * _bends(places, s) @ inverse @ (np.eye(x.size) - powers @ parabola)
        spline = np.vander(places, _DEGREES) @ parabola + rest
        # a walk, less what the spline makes of it and of scatter
        drawn = np.sqrt(ratio) * rng.normal(size=(here.size, everywhere.size)) @ walk.T
        noise = drawn[:, grid.size :] + error * rng.normal(size=(here.size, x.size))
        off = drawn[:, : grid.size] - noise @ spline.T
        curve += chance[number] * (spline @ y)
        curves[here] = spline @ y + spread[here, None] * off
    return curve, curves


def _bends(s: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Covariance of what random walks from 0 are when integrated twice, shape (m, n)."""
    first = np.minimum.outer(s, t)
    apart = np.abs(np.subtract.outer(s, t))
    return np.asarray(first**3 * (first**2 / 20.0 + first * apart / 8.0 + apart**2 / 12.0))


def minimum(
    x: np.ndarray,
    light: np.ndarray,
    *,
    span: float,
    draws: int,
    seed: int,
    step: float = 0.0,
    stated: np.ndarray | None = None,
) -> Minimum:
    """Find the minimum of the curve through points, and simulate its error; ``stated`` (n,) [1]."""
    from scipy.special import chdtrc  # slow to import

    from lightflyer.numerics.residuals import alike_points

    # The curve is smoothed and its residuals are smoothed and added ("twicing"). Simulated
    # measurements have the curve found, normal scatter that would leave the residuals found, and,
    # with steps, light raised in the same steps from a random start. Their minima's errors are
    # those of the result: taken off the irradiance, and added to the pressure with another error as
    # large as what twicing moves it by. Where the uncertainty of each log-irradiance is stated,
    # points weigh by it, and scatter so unless they scatter more.
    rng = np.random.default_rng(seed)
    y = np.log(light - CENTRE * step)
    grid = np.linspace(x.min(), x.max(), _GRID)
    rounding = UNIFORM_SPREAD * step / np.exp(y)
    error = np.ones(x.size) if stated is None else np.hypot(stated, rounding)
    weight = (error.min() / error) ** 2
    once, at_points = smoother(x, grid, span, weight), smoother(x, x, span, weight)
    again = 2.0 * np.eye(x.size) - at_points
    twice, fitted = once @ again, at_points @ again @ y
    (place,), (value,), (edge,) = _least(grid, (twice @ y)[None])
    (start,), (bottom,), _ = _least(grid, (twice @ fitted)[None])
    other = _least(grid, (once @ y)[None])[0]
    distinct = np.unique(x)
    step_at = int(np.argmax(np.diff(distinct)))
    low, high = float(distinct[step_at]), float(distinct[step_at + 1])
    wide = high - low > _GAP * np.ptp(distinct) and low < place < high
    gap = (low, high) if wide else None  # without points, around the minimum
    residual = (np.eye(x.size) - at_points @ again) * error / error[:, None]
    square = residual.T @ residual
    first = np.trace(square)
    freedom = first**2 / np.trace(square @ square)  # by Satterthwaite's approximation
    misfit = residual @ (y / error)  # its square, unlike y @ square @ y, is never below zero
    variance = float(misfit @ misfit) / first

    probability = float(chdtrc(freedom, freedom * variance))
    # Normal scatter, each draw in units of the scatter that its own residuals would suggest: a draw
    # of the ratio of a curve's error to its estimated scatter, few points or many
    normal = rng.normal(size=(draws, x.size))
    spread = np.sqrt(variance * first / np.sum((normal @ residual.T) ** 2, axis=1))
    alike = alike_points(((y - fitted) / error)[np.argsort(x, kind="stable")])
    if stated is not None:
        spread = np.outer(spread if probability < LEAST_PROBABILITY else np.ones(draws), stated)
    else:
        rounded = UNIFORM_SPREAD * step * np.sqrt(np.mean(np.exp(-2.0 * fitted)))
        spread = np.sqrt(np.maximum(spread**2 - rounded**2, 0.0))[:, None]
    simulated = fitted + np.sqrt(alike) * spread * normal
    if step:
        # the middle of the steps in which each is met
        origin = step * rng.random((draws, 1))
        met = origin + step * np.ceil((np.exp(simulated) - origin) / step)
        simulated = np.log(np.maximum(met - CENTRE * step, _LEAST_LIGHT * step))
    curves = simulated @ twice.T
    places, values, edges = _least(grid, curves)
    smoothing = np.abs(place - other) * rng.normal(size=draws)
    curve, places = twice @ y, place + (places - start) + smoothing
    curves, values = twice @ (y + fitted) - curves, value - (values - bottom)
    if gap is not None:
        least = float(error.min())
        known = None if stated is None or probability < LEAST_PROBABILITY else least
        curve, curves = across(x, y, grid, error / least, draws, rng, known)
        (place,), (value,), (edge,) = _least(grid, curve[None])
        places, values, edges = _least(grid, curves)
    return Minimum(
        float(place), float(value), int(edge), places, values, edges, grid, curve, curves,
        alike, np.nan if stated is None else float(np.sqrt(variance)),
        np.nan if stated is None else probability, gap,
    )  # fmt: skip


def _least(grid: np.ndarray, curves: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices of parabolas through the least values of curves, shape (b, m), and their edges."""
    lowest, last = np.argmin(curves, axis=1), grid.size - 1
    rows, inside = np.arange(len(curves)), np.clip(lowest, 1, last - 1)
    before, here, after = (curves[rows, inside + place] for place in (-1, 0, 1))
    edges = np.where(lowest == 0, -1, np.where(lowest == last, 1, 0))
    with np.errstate(divide="ignore", invalid="ignore"):
        shift = 0.5 * (before - after) / (before - 2.0 * here + after)
    shift = np.where(np.isfinite(shift), np.clip(shift, -1.0, 1.0), 0.0)
    places = grid[inside] + shift * (grid[1] - grid[0])
    values = here - 0.25 * (before - after) * shift
    at_edge = edges != 0
    return (
        np.where(at_edge, grid[lowest], places),
        np.where(at_edge, curves[rows, lowest], values),
        edges,
    )
