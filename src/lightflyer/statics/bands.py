"""Bands of altitude or pressure in which flyers levitate, many at once and differentiable.

The search of :mod:`lightflyer.statics.grid_refinement` for JAX. Four looks narrow a kilometre to a
millimetre. Edges are then roots of their own equation.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from lightflyer.array import tree
from lightflyer.array.memory import traced_once
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module, field
from lightflyer.array.transformations import repeat, shape_of, stop_gradient
from lightflyer.core.checks import is_traced, require_range
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import require_record
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.files.display_units import number_text, suitable
from lightflyer.files.result_text import Parts, PrintedResult, rows_of
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel
from lightflyer.numerics.rootfind import (
    RootOutcome,
    SolverStatus,
    find_root,
    implicit_root,
)
from lightflyer.statics.balance import require_converged, status_lines
from lightflyer.statics.equations import FlightEquations
from lightflyer.statics.grid_refinement import (
    EDGE_TOLERANCE,
    at,
    band_brackets,
    best_of,
    first_largest,
    with_point,
)
from lightflyer.statics.loads import lift_and_payload

MOST_BANDS = 4  # Greatest number of separate bands of one flyer

_STAGES = 4  # each narrows the search for the peak some fifty times, to millimetres
_POINTS = 151  # of the first look where a coordinate has no step of its own


class Band(PrintedResult, Module):
    """Range of the coordinate in which a flyer levitates. Fields have the inputs' shape."""

    #: Edges, in the unit of the environment's coordinate; NaN where the flyer levitates nowhere
    lower: Numeric
    #: Edges, in the unit of the environment's coordinate; NaN where the flyer levitates nowhere
    upper: Numeric
    exists: Numeric  #: Whether it levitates anywhere in the searched range
    #: Whether the edge is the end of the searched range, not of the flyer's ability
    lower_open: Numeric
    #: Whether the edge is the end of the searched range, not of the flyer's ability
    upper_open: Numeric
    #: Why the search for the edges ended, a :class:`~lightflyer.numerics.rootfind.SolverStatus`
    status: Numeric
    unit: str = field(static=True)  #: SI unit of the edges

    def text_parts(self) -> Parts:
        traced = is_traced(self)
        if not (traced or np.any(self.exists)):
            yield "levitates nowhere in the searched range"
            return
        factor, unit = (1.0, self.unit) if traced else suitable(self.unit, self.upper)
        edges = {"from": (self.lower, self.lower_open), "to": (self.upper, self.upper_open)}
        yield rows_of(
            {
                f"levitates {word}": number_text(edge * factor, unit) + _open_text(is_open)
                for word, (edge, is_open) in edges.items()
            }
        )
        yield from status_lines(self.status)

    @property
    def converged(self) -> Numeric:
        """True where both edges met their tolerance."""
        return self.status == SolverStatus.CONVERGED


def _open_text(is_open: Numeric) -> str:
    """Whether an edge is the end of the searched range, in words."""
    if is_traced(is_open) or not np.any(is_open):
        return ""
    return f", {'' if np.all(is_open) else 'in part '}the end of the searched range"


def levitation_band(
    flyer: AbstractFlyer,
    environment: AbstractEnvironment,
    model: AbstractForceModel,
    search_range: tuple[float, float] | None = None,
    *,
    usable: bool = False,
    throw: bool = True,
) -> Band:
    """The widest band of altitude, or pressure, in which a flyer levitates with its payload.

    Parameters
    ----------
    flyer : AbstractFlyer
        Numbers of any shape, which the result has.
    environment : AbstractEnvironment
        Its irradiance is the light available.
    model : AbstractForceModel
    search_range : tuple of float, optional
        Coordinates searched, altitudes [m] or pressures [Pa]; by default what the environment
        finds worth searching.
    usable : bool
        Whether its films must withstand their temperature in the band, where the flyer states what
        that is.
    throw : bool
        Raise where an edge has not converged (not under JAX's transformations).

    Returns
    -------
    Band
        One band an element.

    Raises
    ------
    ConvergenceError
        If an edge has not converged and ``throw`` is true.
    ParameterError
        If the model is not for the flyer or the gas.

    Notes
    -----
    Edges are roots, not grid points, and differentiable. The first look is every kilometre (in a
    chamber, 150 steps of equal ratio) and at the coordinate of most lift, so a narrow band is
    found if it holds that coordinate.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> band = lf.levitation_band(lf.Disk(film, radius=0.01), lf.lu2023_earth(), lf.Lu2023())
    >>> print(f"{band.lower / 1e3:.3f} km to {band.upper / 1e3:.3f} km")
    68.022 km to 78.047 km
    """
    return widest(
        levitation_bands(flyer, environment, model, search_range, usable=usable, throw=throw)
    )


def levitation_bands(
    flyer: AbstractFlyer,
    environment: AbstractEnvironment,
    model: AbstractForceModel,
    search_range: tuple[float, float] | None = None,
    *,
    usable: bool = False,
    throw: bool = True,
) -> Band:
    """All bands in which a flyer levitates, lowest first.

    Parameters
    ----------
    flyer, environment, model, search_range, usable, throw
        As for :func:`levitation_band`.

    Returns
    -------
    Band
        With a leading axis of length :data:`MOST_BANDS` in every field; ``exists`` is false
        where there are fewer bands.

    Raises
    ------
    ConvergenceError
        If an edge has not converged and ``throw`` is true.
    """
    require_record("environment", (AbstractEnvironment,), environment)
    coordinate = environment.coordinate
    low, high = coordinate.searched
    if search_range is not None:
        low, high = coordinate.quantity.number("search_range", search_range)
        require_range("upper end of search_range", high, low, open_below=True)
    count = (
        _POINTS if coordinate.step is None else max(3, round((high - low) / coordinate.step) + 1)
    )
    first, last = (xp.log(low), xp.log(high)) if coordinate.logarithmic else (low, high)
    grid = xp.linspace(first, last, count)
    searched = _Searched(flyer, environment, model, coordinate.logarithmic, usable)
    bands = _levitation_bands(searched, grid)
    if throw:
        require_converged("levitation band", bands.status, np.zeros(()))
    return bands


class _Searched(Module):
    """Function to search, and the coordinate to search along."""

    flyer: AbstractFlyer
    environment: AbstractEnvironment
    model: AbstractForceModel
    logarithmic: bool = field(static=True)
    usable: bool = field(static=True)

    @traced_once
    def margin(self, place: Array) -> Array:
        """Lift over weight, minus one, at a coordinate or its logarithm."""
        # or, where less, by how much the films are cooler than they may be, as a share of that
        place = xp.exp(place) if self.logarithmic else place
        state, highest = self.environment.state(place), self.flyer.highest_temperature
        equations = FlightEquations(self.flyer, state, self.model)
        force, _, balance = lift_and_payload(equations)
        margin = force / equations.weight - 1.0
        if not self.usable or highest is None:
            return margin
        return xp.minimum(margin, 1.0 - balance.temperature / highest)


@entry_point
def _levitation_bands(searched: _Searched, grid: Array) -> Band:
    # the table only chooses brackets: the edges' derivative comes from their own equation
    frozen = stop_gradient(searched)
    margins, peak, height = scan(frozen.margin, grid)
    places, margins = with_point(grid, margins, peak, height)
    found = [band_brackets(places, margins > 0.0, number) for number in range(1, MOST_BANDS + 1)]
    outside, inside, exists, is_open = (xp.stack(part, axis=1) for part in zip(*found, strict=True))
    edges, outcome = _edges(searched.margin, outside, inside, exists & ~is_open)
    edges = xp.where(is_open, inside, edges)
    edges = xp.exp(edges) if searched.logarithmic else edges
    edges = xp.where(exists, edges, np.nan)
    return Band(
        lower=edges[0],
        upper=edges[1],
        exists=exists[0],
        lower_open=is_open[0],
        upper_open=is_open[1],
        status=xp.max(outcome.status, axis=0),
        unit=searched.environment.coordinate.unit,
    )


def scan(function: Callable[[Array], Array], grid: Array) -> tuple[Array, Array, Array]:
    """Values of a function on a grid, and its largest value between the grid's points."""
    # Each stage looks at as many points as the grid has, evenly spaced between the neighbours of
    # the last stage's best. One loop does it all because compiling the function costs more than
    # running it.
    shape = shape_of(function, grid[0])
    fractions = xp.linspace(0.0, 1.0, grid.size).reshape(-1, *[1] * len(shape))

    def look(ends: tuple[Array, Array]) -> tuple[Any, tuple[Array, ...]]:
        lower, upper = ends
        points = lower + fractions * (upper - lower)
        values = function(points)
        best, before, after = best_of(values)
        return (at(points, before), at(points, after)), (values, at(points, best), at(values, best))

    whole = xp.full(shape, grid[0]), xp.full(shape, grid[-1])
    _, (values, peaks, heights) = repeat(look, whole, _STAGES)
    return values[0], peaks[-1], heights[-1]


def _edges(
    margin: Callable[[Array], Array], outside: Array, inside: Array, wanted: Array
) -> tuple[Array, RootOutcome]:
    """Places at which lift equals weight, between points outside and inside the band."""
    # The unknown is the way from outside (0) to inside (1), along which the margin rises. Elements
    # that are not wanted get a stand-in equation with its root half way.
    width = inside - outside

    def residual(way: Array) -> Array:
        return xp.where(wanted, margin(outside + way * width), way - 0.5)

    half = xp.full(width.shape, 0.5)

    def search() -> tuple[Array, RootOutcome]:
        return find_root(residual, half - 0.5, half + 0.5, half, EDGE_TOLERANCE)

    way, outcome = implicit_root(residual, search)
    return outside + way * width, outcome


@entry_point
def widest(bands: Band) -> Band:
    """The widest of some bands, whose leading axis it lacks."""
    width = xp.where(bands.exists, bands.upper - bands.lower, -np.inf)
    number_of_widest = first_largest(width)
    numbers = np.arange(width.shape[0], dtype=np.int32).reshape(-1, *[1] * (width.ndim - 1))

    def of_widest(field: Array) -> Array:
        # chosen band by band: JAX cannot transpose a lookup within a caller's single precision
        chosen = field[0]
        for number, entry in zip(numbers[1:], field[1:], strict=True):
            chosen = xp.where(number == number_of_widest, entry, chosen)
        return chosen

    return tree.map_leaves(of_widest, bands)
