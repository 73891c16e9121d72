"""Uncertainty of a film's properties from those of its layers' numbers."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

import numpy as np

from lightflyer.array import tree
from lightflyer.core.checks import require_range
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import Quantity
from lightflyer.core.units import Measured
from lightflyer.film.optics.stack import Film
from lightflyer.numerics.correlation import Correlations, correlation_matrix

T = TypeVar("T")

_SECOND_ORDER = 0.75  # fourth moment of a standard normal variable, 3, over 2²
_METRES_TO_NANOMETRES = 1e9
_LEAST_VARIANCE = 1e-9  # along a principal axis of correlations: less is rounding


def thickness_uncertainty(
    quantity: Callable[[Film], T],
    film: Film,
    uncertainty: Sequence[float],
    others: Sequence[tuple[Film, Film]] = (),
) -> T:
    r"""Standard uncertainty of anything computed from a film, from that of its thicknesses.

    Parameters
    ----------
    quantity : callable
        Takes a film; returns a number, an array, or a dict, list or tuple of these.
    film : Film
        With concrete thicknesses.
    uncertainty : sequence of float
        Standard uncertainty of each layer's thickness, top to bottom; zero where it is exact [m].
    others : sequence of (Film, Film)
        For each other number with an uncertainty, such as a porosity: the film with the number one
        standard uncertainty above and below its value.

    Returns
    -------
    same structure as ``quantity`` returns
        In the unit of each of its numbers.

    Raises
    ------
    ParameterError
        If there is not one uncertainty a layer, or one is negative or not below its thickness.

    Notes
    -----
    The thicknesses and other numbers are independent and normal. The quantity is computed with
    each at its value, :math:`y`, and one standard uncertainty above and below it,
    :math:`y_i^\pm`. To second order, its mean square deviation from :math:`y` is

    .. math::
        u^2(y) = \sum_i \left(\frac{y_i^+-y_i^-}{2}\right)^2
            + \frac34\sum_i\left(y_i^+ - 2y + y_i^-\right)^2.

    The first sum is the law of propagation of uncertainty; the second counts where the quantity is
    near an extremum, as interference makes it.

    References
    ----------
    [GUM2008]_ 5.1.3, notes 2 and 3, for the differences; 5.1.2 for the second order.

    Examples
    --------
    >>> from lightflyer.film import Film, Layer, material
    >>> film = Film((Layer(material("Ge"), 20e-9),))
    >>> print(f"{thickness_uncertainty(lambda one: one.areal_density, film, [1e-9]) * 1e3:.5f}")
    0.00532
    """
    if len(uncertainty) != len(film.layers):
        raise ParameterError(
            f"{len(uncertainty)} uncertainties of thicknesses are given for "
            f"{len(film.layers)} layers"
        )
    pairs = []
    for number, (layer, spread) in enumerate(zip(film.layers, uncertainty, strict=True)):
        require_range(f"uncertainty of the thickness of {layer.material.name}", spread, 0.0)
        if not spread < layer.thickness:
            nanometres = [_METRES_TO_NANOMETRES * one for one in (layer.thickness, spread)]
            raise ParameterError(
                f"thickness of {layer.material.name} = {nanometres[0]:g} ± {nanometres[1]:g} nm: "
                "± is one standard deviation and must be below the thickness"
            )
        if spread > 0.0:
            change = spread * np.eye(len(film.layers))[number]
            ends = film.thickness + change, film.thickness - change
            pairs.append(tuple(map(film.with_thicknesses, ends)))

    def add(total: np.ndarray, middle: np.ndarray, above: np.ndarray, below: np.ndarray) -> Any:
        first, second = 0.5 * (above - below), above - 2.0 * middle + below
        return total + first**2 + _SECOND_ORDER * second**2

    middle = quantity(film)
    total = tree.map_leaves(lambda one: np.zeros_like(one, float), middle)
    for one, other in (*pairs, *others):
        total = tree.map_leaves(add, total, middle, quantity(one), quantity(other))
    return tree.map_leaves(lambda one: np.sqrt(one)[()], total)


def neighbouring_films(
    film_with: Callable[[Mapping[str, float]], Film],
    numbers: Mapping[str, tuple[Quantity, Measured]],
    correlations: Correlations,
) -> list[tuple[Film, Film]]:
    """Films one standard uncertainty above and below, for each independent error of numbers.

    ``film_with``: the film with other numbers, by name; ``numbers``: their ranges and values, which
    stay within them. Numbers whose errors are correlated change together, along each principal axis
    of their correlations.
    """
    names = list(dict.fromkeys(name for pair in correlations for name in pair))
    variances, axes = np.linalg.eigh(correlation_matrix(names, correlations))
    changes = [
        dict(zip(names, np.sqrt(variance) * axis, strict=True))
        for variance, axis in zip(variances, axes.T, strict=True)
        if variance > _LEAST_VARIANCE
    ]
    changes += [{name: 1.0} for name in numbers if name not in names]

    def end(change: Mapping[str, float], sign: float) -> Film:
        moved = {}
        for name, share in change.items():
            quantity, value = numbers[name]
            number = value.value + sign * share * (value.uncertainty or 0.0)
            moved[name] = min(max(number, quantity.lowest), quantity.highest)
        return film_with(moved)

    return [(end(change, 1.0), end(change, -1.0)) for change in changes]
