"""The uncertain numbers of a design, what they move, and correlations of their errors."""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import xp
from lightflyer.array.records import Module, ShortRepr, field
from lightflyer.core.errors import ParameterError, ParameterWarning
from lightflyer.core.quantity import require_possible
from lightflyer.design.design import AbstractDesign
from lightflyer.numerics.correlation import Correlations, correlation_matrix

_STEP = 1e-3  # relative, over which costly parts of a design are compared
_MOST_DRAWS = 1000
_EVEN = 12.0**-0.5  # standard deviation of a number that lies evenly between -1/2 and 1/2

_ROUNDING = 1e-12  # of a pivot of a correlation matrix, whose diagonal is one


class Change(Module):
    """How the costly part of a design changes with an input."""

    slope: Any  # Change per unit of the input's shift, and of its square
    bend: Any
    # Whether missing data leave the input open: it then goes from -1/2 at the lower bound over 0 at
    # the nominal value to 1/2 at the upper bound, all its values are equally likely, and the bend
    # goes with the size of the shift
    bounded: bool = field(static=True)

    def in_unit(self, unit: float) -> "Change":
        """The change by a shift that is measured in another unit."""
        square = unit if self.bounded else unit**2
        return Change(
            tree.map_leaves(lambda part: unit * np.asarray(part), self.slope),
            tree.map_leaves(lambda part: square * np.asarray(part), self.bend),
            self.bounded,
        )

    def apply(self, prepared: Any, shift: Any) -> Any:
        """The costly part after a shift of the input."""
        bent = shift * (xp.sign(shift) if self.bounded else shift)
        return tree.map_leaves(
            lambda base, slope, bend: base + _beside(shift, slope) + _beside(bent, bend),
            prepared,
            self.slope,
            self.bend,
        )


@dataclass(frozen=True)
class Inputs(ShortRepr):
    """The uncertain numbers of a design."""

    design: AbstractDesign
    names: list[str]  #: Dotted, as ``"film.tac_top"``
    #: shape (k,); in the units of the design: SI, angles in degrees where a file gives them so
    values: np.ndarray
    spreads: np.ndarray  #: shape (k,); their standard uncertainties
    correlation: np.ndarray  #: shape (k, k)
    ranges: np.ndarray  #: shape (k, 2); possible values
    prepared: Any  #: What the design needs to be built with its own numbers
    changes: dict[str, Change]  #: How ``prepared`` changes with each input that moves it

    @property
    def open_names(self) -> tuple[str, ...]:
        """Inputs that missing data leave open."""
        return tuple(name for name, change in self.changes.items() if change.bounded)

    @property
    def covariance(self) -> np.ndarray:
        """Covariance of the inputs, shape (k, k)."""
        return self.correlation * np.outer(self.spreads, self.spreads)

    @property
    def shared(self) -> dict[tuple[str, str], float]:
        """Correlations that are not zero, by the names of the two inputs."""
        rows, columns = np.nonzero(np.triu(self.correlation, 1))
        return {
            (self.names[row], self.names[column]): float(self.correlation[row, column])
            for row, column in zip(rows, columns, strict=True)
        }

    def build(self, values: Any) -> Any:
        """Setup at other values of the inputs; ``values`` (k, ...)."""
        prepared = self.prepared
        for name, change in self.changes.items():
            row = self.names.index(name)
            prepared = change.apply(prepared, values[row] - self.values[row])
        numbers = dict(zip(self.names, values, strict=True))
        for name in self.open_names:
            del numbers[name]
        return self.design.build(numbers, prepared)

    def setup_of(self, samples: np.ndarray) -> Any:
        """Setup whose uncertain numbers are arrays over samples; ``samples`` (samples, k)."""
        if not any(samples is known for known, _ in self._last):
            with warnings.catch_warnings():
                # a sample beyond what is usual is no news: its distribution was stated
                warnings.simplefilter("ignore", ParameterWarning)
                self._last[:] = [(samples, self.build(samples.T[:, :, None]))]
        return self._last[0][1]

    @cached_property
    def _last(self) -> list[tuple[np.ndarray, Any]]:
        """The samples that were asked for last, and their setup: many questions follow."""
        return []


def _beside(shift: Any, change: Any) -> Any:
    """Product of a shift of shape (samples, 1) and a change, of which a table keeps its axis."""
    if np.ndim(change) and np.ndim(shift):
        return shift[..., None] * change
    return shift * change


def uncertain_inputs(design: AbstractDesign) -> Inputs | None:
    """The uncertain numbers of a design that a prediction depends on.

    Parameters
    ----------
    design : AbstractDesign

    Returns
    -------
    Inputs or None
        None where nothing that can be propagated has a ±.
    """
    stated = {
        name: spread
        for name, spread in design.uncertainties.items()
        if spread > 0.0 and name in design.fields
    }
    data_bounds = design.data_bounds()
    if not stated and not data_bounds:
        return None
    names = [*stated, *data_bounds]
    correlation = correlation_matrix(names, design.correlations)
    values = [design.number(name) or 0.0 for name in stated] + [0.0] * len(data_bounds)
    quantities = [design.fields[name].quantity for name in stated]
    ranges = [(quantity.lowest, quantity.highest) for quantity in quantities]
    ranges += [(-0.5, 0.5)] * len(data_bounds)
    costly = design.needs_recompute(list(stated))
    prepared = design.precompute({}) if costly or data_bounds else None
    middle = design.precompute({}, coarse=True) if costly else None
    changes = {}
    for name in costly:
        spread, value = stated[name], design.number(name) or 0.0
        lowest, highest = ranges[names.index(name)]
        both = lowest < value - spread and value + spread < highest
        # a parabola over ± one standard uncertainty where that is possible; else a line towards
        # zero, which no upper limit forbids; from zero upwards
        step = spread if both else (-_STEP * value if value else _STEP * spread)
        there = design.precompute({name: value + step}, coarse=True)
        back = design.precompute({name: value - step}, coarse=True) if both else middle
        found = _between(middle, back, there)
        width = 2.0 * step if both else step
        slope = tree.map_leaves(lambda change, width=width: change / width, found.slope)
        bend = tree.map_leaves(np.zeros_like, slope)
        if both:
            square = width * step
            bend = tree.map_leaves(lambda change, square=square: change / square, found.bend)
        changes[name] = Change(slope, bend, bounded=False)
    changes |= {name: _between(prepared, *ends) for name, ends in data_bounds.items()}
    return Inputs(
        design=design,
        names=names,
        values=np.array(values, float),
        spreads=np.array([*stated.values(), *[_EVEN] * len(data_bounds)]),
        correlation=correlation,
        ranges=np.array(ranges),
        prepared=prepared,
        changes=changes,
    )


def _between(nominal: Any, lower: Any, upper: Any) -> Change:
    """Change between two bounds by way of the nominal value."""

    def slope(low: Any, high: Any) -> Any:
        return np.asarray(high) - np.asarray(low)

    def bend(low: Any, middle: Any, high: Any) -> Any:
        return np.asarray(high) + np.asarray(low) - 2.0 * np.asarray(middle)

    return Change(
        tree.map_leaves(slope, lower, upper),
        tree.map_leaves(bend, lower, nominal, upper),
        bounded=True,
    )


def draw(inputs: Inputs, samples: int, seed: int) -> np.ndarray:
    """Draw inputs; see :func:`draw_possible`, shape (samples, k)."""
    return draw_possible(inputs, samples, seed)[0]


def draw_possible(inputs: Inputs, samples: int, seed: int) -> tuple[np.ndarray, float, str]:
    """Draw inputs from a normal distribution, open ones evenly, and redraw the impossible."""
    # Returns samples, shape (samples, k); the share of draws that were impossible, and why of one.
    # Their distribution is so the stated one on condition that the design is possible: that each
    # number is within its range, and that what belongs together agrees, as where a film absorbs and
    # transmits no more than all of the light.
    # In standard errors: beside a modulus in pascals the decomposition of a covariance would lose
    # Poisson's ratio. The widest come first, so that most files keep the samples of 0.2.0.
    generator, order = np.random.default_rng(seed), np.argsort(-inputs.spreads, kind="stable")
    shared, nowhere = inputs.correlation[np.ix_(order, order)], np.zeros(order.size)
    drawn, refused, why = np.empty((0, inputs.values.size)), 0, ""
    for _ in range(_MOST_DRAWS):
        errors = generator.multivariate_normal(nowhere, shared, samples)
        more = inputs.values + inputs.spreads * errors[:, np.argsort(order)]
        for name in inputs.open_names:
            more[:, inputs.names.index(name)] = generator.uniform(-0.5, 0.5, samples)
        inside = (more > inputs.ranges[:, 0]) & (more < inputs.ranges[:, 1])
        outside = [name for name, kept in zip(inputs.names, inside.T, strict=True) if not all(kept)]
        possible, reason = _possible(inputs, more[np.all(inside, axis=1)])
        refused += samples - len(possible)
        why = why or reason or " and ".join(f"{name} out of its range" for name in outside)
        drawn = np.concatenate([drawn, possible])
        if len(drawn) >= samples:
            return drawn[:samples], refused / (refused + len(drawn)), why
    raise ParameterError(
        f"the uncertainties of {', '.join(inputs.names)} make nearly every sample impossible: {why}"
    )


def _possible(inputs: Inputs, samples: np.ndarray) -> tuple[np.ndarray, str]:
    """Those samples that a design can be built of, and why others cannot."""
    if not len(samples):
        return samples, ""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ParameterWarning)
            require_possible(inputs.setup_of(samples))
    except ParameterError as error:
        if len(samples) == 1:
            return samples[:0], str(error)
        halves = [_possible(inputs, half) for half in np.array_split(samples, 2)]
        return np.concatenate([kept for kept, _ in halves]), halves[0][1] or halves[1][1]
    return samples, ""


def correlated_groups(
    names: Sequence[str], correlations: Correlations
) -> tuple[tuple[str, ...], ...]:
    """Names, those of numbers that are correlated directly or by way of others together."""
    from scipy.sparse.csgraph import connected_components

    count, label = connected_components(correlation_matrix(names, correlations), directed=False)
    groups = [
        tuple(name for name, own in zip(names, label, strict=True) if own == group)
        for group in range(count)
    ]
    return tuple(sorted(groups, key=lambda group: list(names).index(group[0])))


def correlate(shares: np.ndarray, names: Sequence[str], correlations: Correlations) -> np.ndarray:
    r"""Correlated draws from independent ones, by a Gaussian copula, shape (n, k)."""
    # With :math:`z = \Phi^{-1}(u)` and the correlation matrix :math:`R = L L^\mathsf{T}` the draws
    # become :math:`\Phi(L z)`. Each number keeps its own distribution; normal ones have the
    # correlations :math:`R`.
    lower = _factor(correlation_matrix(names, correlations), names)
    changed = [row for row in range(len(names)) if np.any(lower[row, :row])]
    if not changed:
        return shares
    from scipy.special import ndtr, ndtri

    tiny = np.finfo(float).tiny  # the ends themselves have no number, and are no draws
    normal = ndtri(np.clip(shares, tiny, 1.0 - np.finfo(float).epsneg))
    correlated = shares.copy()
    for row in changed:
        correlated[:, row] = ndtr(normal @ lower[row])
    return correlated


def _factor(matrix: np.ndarray, names: Sequence[str]) -> np.ndarray:
    """Cholesky factor; unlike LAPACK's it exists for errors that are the same but for a factor."""
    lower = np.zeros_like(matrix)
    for row in range(len(matrix)):
        for column in range(row):
            left = matrix[row, column] - lower[row, :column] @ lower[column, :column]
            pivot = lower[column, column]
            if pivot == 0.0 and abs(left) > _ROUNDING:
                raise _impossible(matrix, names)
            lower[row, column] = left / pivot if pivot else 0.0
        square = matrix[row, row] - lower[row, :row] @ lower[row, :row]
        if square < -_ROUNDING:
            raise _impossible(matrix, names)
        lower[row, row] = np.sqrt(square) if square > _ROUNDING else 0.0
    return lower


def _impossible(matrix: np.ndarray, names: Sequence[str]) -> ParameterError:
    involved = [name for name, row in zip(names, matrix, strict=True) if np.count_nonzero(row) > 1]
    return ParameterError(
        f"no joint distribution has the correlations stated for {', '.join(involved)}: their "
        "matrix has a negative eigenvalue"
    )
