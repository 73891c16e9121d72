"""Where a flyer flies: its altitude bands, many flyers at once and differentiable."""

from collections.abc import Callable
from typing import Any

import equinox as eqx
import jax
import jax.numpy as jnp
from jax import Array

from lightflyer.environment.base import AbstractEnvironment
from lightflyer.flight.balance import require_converged
from lightflyer.flight.levitation import lift, weight
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel
from lightflyer.foundation.precision import entry_point
from lightflyer.foundation.rootfind import RootStatus, bracketed_newton, implicit_root
from lightflyer.foundation.types import Numeric

HIGHEST_SEARCHED = 150e3
"""Top of the default search [m]: above, the gas carries no film."""

SPACING = 1000.0
"""Distance of the first look's altitudes [m]."""

MOST_BANDS = 4
"""How many separate bands are told apart."""

_EDGE_TOLERANCE = 1e-10  # of lift over weight; about a micrometre of altitude
_STAGES = 4  # each narrows the search for the peak some fifty times, to millimetres


class AltitudeBand(eqx.Module):
    """Altitudes between which a flyer levitates. Fields have the inputs' broadcast shape.

    Attributes
    ----------
    lower, upper : array
        Edges [m]; NaN where the flyer levitates nowhere.
    exists : bool array
        Whether it levitates anywhere in the searched range.
    lower_open, upper_open : bool array
        Whether the edge is the end of the searched range, not of the flyer's ability.
    converged : bool array
        Whether both edges met their tolerance.
    """

    lower: Numeric
    upper: Numeric
    exists: Numeric
    lower_open: Numeric
    upper_open: Numeric
    converged: Numeric


def altitude_band(
    flyer: AbstractFlyer,
    environment: AbstractEnvironment,
    model: AbstractForceModel,
    altitude_range: tuple[float, float] | None = None,
    *,
    throw: bool = True,
) -> AltitudeBand:
    """The widest altitude band in which a flyer levitates with its payload.

    Parameters
    ----------
    flyer : AbstractFlyer
        Numbers of any shape, which the result has.
    environment : AbstractEnvironment
        One whose coordinate is the altitude; its irradiance is the light available.
    model : AbstractForceModel
    altitude_range : tuple of float, optional
        Searched altitudes [m]; by default the environment's up to 150 km.
    throw : bool
        Raise where an edge has not converged (not under JAX's transformations).

    Returns
    -------
    AltitudeBand
        One band an element.

    Raises
    ------
    ConvergenceError
        If an edge has not converged and ``throw`` is true.

    Notes
    -----
    Edges are roots, not grid points, and differentiable. The first look is every kilometre and at
    the altitude of most lift, so a narrow band is found if it holds that altitude.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> band = lf.altitude_band(lf.Disk(film, radius=0.01), lf.lu2023_earth(), lf.Lu2023())
    >>> print(f"{band.lower / 1e3:.3f} km to {band.upper / 1e3:.3f} km")
    68.022 km to 78.047 km
    """
    bands = altitude_bands(flyer, environment, model, altitude_range, throw=throw)
    return _widest(bands)


def altitude_bands(
    flyer: AbstractFlyer,
    environment: AbstractEnvironment,
    model: AbstractForceModel,
    altitude_range: tuple[float, float] | None = None,
    *,
    throw: bool = True,
) -> AltitudeBand:
    """All altitude bands in which a flyer levitates, lowest first.

    Parameters
    ----------
    flyer, environment, model, altitude_range, throw
        As for :func:`altitude_band`.

    Returns
    -------
    AltitudeBand
        With a leading axis of length :data:`MOST_BANDS` in every field; ``exists`` is false
        where there are fewer bands.

    Raises
    ------
    ConvergenceError
        If an edge has not converged and ``throw`` is true.
    """
    lowest, highest = environment.coordinate_range if altitude_range is None else altitude_range
    if altitude_range is None:
        highest = min(highest, HIGHEST_SEARCHED)
    count = max(3, round((highest - lowest) / SPACING) + 1)
    with jax.enable_x64(True):
        grid = jnp.linspace(lowest, highest, count)
    bands = _altitude_bands(flyer, environment, model, grid)
    if throw:
        require_converged("altitude band", bands.converged, jnp.zeros(()))
    return bands


@entry_point
def _altitude_bands(
    flyer: AbstractFlyer,
    environment: AbstractEnvironment,
    model: AbstractForceModel,
    grid: Array,
) -> AltitudeBand:
    def margin_of(
        flyer: AbstractFlyer, environment: AbstractEnvironment, model: AbstractForceModel
    ) -> Callable[[Array], Array]:
        def margin(altitude: Array) -> Array:
            state = environment.state(altitude)
            return lift(flyer, state, model, throw=False) / weight(flyer, state) - 1.0

        return margin

    margin = margin_of(flyer, environment, model)
    # the table only chooses brackets: the edges' derivative comes from their own equation
    frozen = jax.lax.stop_gradient((flyer, environment, model))
    margins, peak, height = _scan(margin_of(*frozen), grid)
    altitudes, margins = _with_point(grid, margins, peak, height)
    found = [_band(altitudes, margins > 0.0, number) for number in range(1, MOST_BANDS + 1)]
    outside, inside, exists, is_open = (
        jnp.stack(part, axis=1) for part in zip(*found, strict=True)
    )
    edges, status = _edges(margin, outside, inside, exists & ~is_open)
    edges = jnp.where(exists, jnp.where(is_open, inside, edges), jnp.nan)
    return AltitudeBand(
        lower=edges[0],
        upper=edges[1],
        exists=exists[0],
        lower_open=is_open[0],
        upper_open=is_open[1],
        converged=jnp.all(status.converged, axis=0),
    )


def _scan(function: Callable[[Array], Array], grid: Array) -> tuple[Array, Array, Array]:
    """Values of a function on a grid, and its largest value between the grid's points.

    Each stage looks at as many points as the grid has, evenly spaced between the neighbours of
    the last stage's best. One loop does it all because compiling the function costs more than
    running it.

    Parameters
    ----------
    function : callable
        Of a coordinate array of shape (n, ...) whose trailing shape broadcasts.
    grid : array, shape (n,)
        Increasing, evenly spaced coordinates.

    Returns
    -------
    values : array, shape (n, ...)
        On the grid.
    peak, height : array, shape (...)
        Coordinate and value of the maximum.
    """
    shape = jax.eval_shape(function, grid[0]).shape
    fractions = jnp.linspace(0.0, 1.0, grid.size).reshape(-1, *[1] * len(shape))

    def look(ends: tuple[Array, Array], _: None) -> tuple[Any, tuple[Array, ...]]:
        lower, upper = ends
        points = lower + fractions * (upper - lower)
        values = function(points)
        best = jnp.argmax(jnp.where(jnp.isnan(values), -jnp.inf, values), axis=0)

        def at(table: Array, index: Array) -> Array:
            return jnp.take_along_axis(table, index[None], axis=0)[0]

        last = grid.size - 1
        ends = at(points, jnp.maximum(best - 1, 0)), at(points, jnp.minimum(best + 1, last))
        return ends, (values, at(points, best), at(values, best))

    whole = jnp.full(shape, grid[0]), jnp.full(shape, grid[-1])
    _, (values, peaks, heights) = jax.lax.scan(look, whole, None, length=_STAGES)
    return values[0], peaks[-1], heights[-1]


def _with_point(grid: Array, values: Array, point: Array, value: Array) -> tuple[Array, Array]:
    """Insert one more coordinate and value into each element's table."""
    columns = jnp.broadcast_to(grid.reshape(-1, *[1] * point.ndim), values.shape)
    coordinates = jnp.concatenate([columns, point[None]])
    order = jnp.argsort(coordinates, axis=0)
    values = jnp.concatenate([values, value[None]])
    return jnp.take_along_axis(coordinates, order, 0), jnp.take_along_axis(values, order, 0)


def _band(altitudes: Array, flies: Array, number: int) -> tuple[Array, Array, Array, Array]:
    """Where the band of the given number begins and ends in the table.

    Returns, for lower and upper edge stacked, the altitudes just outside and just inside, and
    whether the band exists and is open at that end.
    """
    size = altitudes.shape[0]
    before = jnp.concatenate([jnp.zeros_like(flies[:1]), flies[:-1]])
    member = flies & (jnp.cumsum(flies & ~before, axis=0) == number)
    first = jnp.argmax(member, axis=0)
    last = size - 1 - jnp.argmax(member[::-1], axis=0)
    exists = jnp.any(member, axis=0)

    def at(index: Array) -> Array:
        return jnp.take_along_axis(altitudes, index[None], axis=0)[0]

    outside = jnp.stack([at(jnp.maximum(first - 1, 0)), at(jnp.minimum(last + 1, size - 1))])
    inside = jnp.stack([at(first), at(last)])
    is_open = jnp.stack([first == 0, last == size - 1])
    return outside, inside, jnp.stack([exists, exists]), is_open & exists


def _edges(
    margin: Callable[[Array], Array], outside: Array, inside: Array, wanted: Array
) -> tuple[Array, RootStatus]:
    """Altitudes at which lift equals weight, between points outside and inside the band.

    The unknown is the way from outside (0) to inside (1), along which the margin rises.
    Elements that are not wanted get a stand-in equation with its root half way.
    """
    width = inside - outside

    def residual(way: Array) -> Array:
        return jnp.where(wanted, margin(outside + way * width), way - 0.5)

    half = jnp.full(width.shape, 0.5)

    def search() -> tuple[Array, RootStatus]:
        return bracketed_newton(residual, half - 0.5, half + 0.5, half, _EDGE_TOLERANCE)

    way, status = implicit_root(residual, search, width.shape)
    return outside + way * width, status


@entry_point
def _widest(bands: AltitudeBand) -> AltitudeBand:
    width = jnp.where(bands.exists, bands.upper - bands.lower, -jnp.inf)
    widest = jnp.argmax(width, axis=0)[None]
    return jax.tree.map(lambda field: jnp.take_along_axis(field, widest, axis=0)[0], bands)
