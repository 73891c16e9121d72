"""The uncertain numbers of a design, and what they move."""

import warnings
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from lightflyer.flight.design import AbstractDesign
from lightflyer.foundation.errors import ParameterError, ParameterWarning
from lightflyer.foundation.precision import float64, quick_entry_point
from lightflyer.uncertainty.correlation import correlation_matrix

_STEP = 1e-3  # relative, over which costly parts of a design are compared
_MOST_DRAWS = 1000
_EVEN = 12.0**-0.5  # standard deviation of a number that lies evenly between -1/2 and 1/2


@dataclass(frozen=True)
class Inputs:
    """The uncertain numbers of a design.

    Attributes
    ----------
    design : AbstractDesign
    names : list of str
        Dotted, as ``"film.tac_top"``.
    values, spreads : array, shape (k,)
        Values and standard uncertainties, in the units of the design: SI, angles in degrees where
        a flyer file gives them so.
    correlation : array, shape (k, k)
    ranges : array, shape (k, 2)
        Possible values.
    prepared : pytree or None
        What the design needs to be built with its own numbers.
    prepared_slopes : dict of str to pytree
        Change of ``prepared`` per unit of each input that moves it.
    prepared_bends : dict of str to pytree
        For each input that missing data leave open, change of ``prepared`` per unit of its size:
        such an input goes from -1/2 at the lower bound over 0 at the nominal value to 1/2 at the
        upper bound, and all its values are equally likely.
    """

    design: AbstractDesign
    names: list[str]
    values: np.ndarray
    spreads: np.ndarray
    correlation: np.ndarray
    ranges: np.ndarray
    prepared: Any
    prepared_slopes: dict[str, Any]
    prepared_bends: dict[str, Any]

    @property
    def open_names(self) -> tuple[str, ...]:
        """Inputs that missing data leave open."""
        return tuple(self.prepared_bends)

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
        """Setup at other values of the inputs.

        Parameters
        ----------
        values : array, shape (k, ...)
            Concrete or traced; not checked.

        Returns
        -------
        Setup
            Numbers that depend on the inputs have the trailing shape of ``values``.
        """
        prepared = self.prepared
        for name, slope in self.prepared_slopes.items():
            row = self.names.index(name)
            shift = values[row] - self.values[row]
            prepared = jax.tree.map(
                lambda base, change, shift=shift: base + _beside(shift, change), prepared, slope
            )
        for name, bend in self.prepared_bends.items():
            size = jnp.abs(values[self.names.index(name)])
            prepared = jax.tree.map(
                lambda base, change, size=size: base + _beside(size, change), prepared, bend
            )
        numbers = dict(zip(self.names, values, strict=True))
        for name in self.open_names:
            del numbers[name]
        return self.design.build(numbers, prepared)

    def setup_and_tangents(self) -> tuple[Any, list[Any]]:
        """Setup at the inputs' values, and its derivative in each of them.

        Returns
        -------
        setup : Setup
            Every number an array.
        tangents : list of Setup, length k
        """
        structure = jax.tree.structure(self.build(self.values))

        def leaves(inputs: Any) -> list[Any]:
            return [jnp.asarray(leaf, float) for leaf in jax.tree.leaves(self.build(inputs))]

        @quick_entry_point
        def both(values: Any, directions: Any) -> Any:
            base, push = jax.linearize(leaves, values)
            return base, jax.vmap(push)(directions)

        base, tangents = both(self.values, np.eye(len(self.values)))
        moved = [
            jax.tree.unflatten(structure, [leaf[row] for leaf in tangents])
            for row in range(len(self.values))
        ]
        return jax.tree.unflatten(structure, base), moved

    def setup_of(self, samples: np.ndarray) -> Any:
        """Setup whose uncertain numbers are arrays over samples.

        Parameters
        ----------
        samples : array, shape (samples, k)

        Returns
        -------
        Setup
            Numbers that depend on the inputs have shape (samples, 1).
        """
        with float64(), warnings.catch_warnings():
            # a sample beyond what is usual is no news: its distribution was stated
            warnings.simplefilter("ignore", ParameterWarning)
            return self.build(samples.T[:, :, None])


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
    open_parts = design.open_parts()
    if not stated and not open_parts:
        return None
    names = [*stated, *open_parts]
    correlation = correlation_matrix(names, design.correlations)
    values = [design.number(name) or 0.0 for name in stated] + [0.0] * len(open_parts)
    quantities = [design.fields[name].quantity for name in stated]
    ranges = [(quantity.lowest, quantity.highest) for quantity in quantities]
    ranges += [(-0.5, 0.5)] * len(open_parts)
    costly = design.costly(list(stated))
    prepared = design.prepare({}) if costly or open_parts else None
    slopes = {
        name: _prepared_slope(design, prepared, name, values[names.index(name)], stated[name])
        for name in costly
    }
    halves = {name: _halves(prepared, ends) for name, ends in open_parts.items()}
    return Inputs(
        design=design,
        names=names,
        values=np.array(values, float),
        spreads=np.array([*stated.values(), *[_EVEN] * len(open_parts)]),
        correlation=correlation,
        ranges=np.array(ranges),
        prepared=prepared,
        prepared_slopes=slopes | {name: slope for name, (slope, _) in halves.items()},
        prepared_bends={name: bend for name, (_, bend) in halves.items()},
    )


def _halves(nominal: Any, ends: tuple[Any, Any]) -> tuple[Any, Any]:
    """Mean slope from the lower to the upper bound, and the bend that lets the nominal be met."""
    lower, upper = ends
    slope = jax.tree.map(lambda low, high: np.asarray(high) - np.asarray(low), lower, upper)
    bend = jax.tree.map(
        lambda low, middle, high: np.asarray(high) + np.asarray(low) - 2.0 * np.asarray(middle),
        lower,
        nominal,
        upper,
    )
    return slope, bend


def _prepared_slope(
    design: AbstractDesign, prepared: Any, name: str, value: float, spread: float
) -> Any:
    """Change of a design's costly part per unit of one input."""
    # towards zero, which no upper limit forbids; from zero upwards
    step = -_STEP * value if value else _STEP * spread
    moved = design.prepare({name: value + step})
    return jax.tree.map(
        lambda there, here: (np.asarray(there) - np.asarray(here)) / step, moved, prepared
    )


def draw(inputs: Inputs, samples: int, seed: int) -> np.ndarray:
    """Draw inputs from a normal distribution, open ones evenly, and redraw the impossible.

    Parameters
    ----------
    inputs : Inputs
    samples, seed : int

    Returns
    -------
    array, shape (samples, k)

    Raises
    ------
    ParameterError
        If nearly every draw is impossible.
    """
    generator = np.random.default_rng(seed)
    drawn = np.empty((0, inputs.values.size))
    for _ in range(_MOST_DRAWS):
        more = generator.multivariate_normal(inputs.values, inputs.covariance, samples)
        for name in inputs.open_names:
            more[:, inputs.names.index(name)] = generator.uniform(-0.5, 0.5, samples)
        inside = (more > inputs.ranges[:, 0]) & (more < inputs.ranges[:, 1])
        drawn = np.concatenate([drawn, more[np.all(inside, axis=1)]])
        if len(drawn) >= samples:
            return drawn[:samples]
    raise ParameterError(
        f"the uncertainties of {', '.join(inputs.names)} make nearly every sample impossible"
    )
