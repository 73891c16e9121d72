"""Uncertainty of a film's properties from that of its layers' thicknesses."""

import dataclasses
from collections.abc import Callable, Sequence
from typing import TypeVar

import numpy as np

from lightflyer.array import tree
from lightflyer.core.checks import require_range
from lightflyer.core.errors import ParameterError
from lightflyer.film.optics.stack import Film

T = TypeVar("T")

_SECOND_ORDER = 0.75  # fourth moment of a standard normal variable, 3, over 2²
_METRES_TO_NANOMETRES = 1e9


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
    _check(film, uncertainty)
    middle = quantity(film)
    total = tree.map_leaves(lambda one: np.zeros_like(one, float), middle)
    pairs = [
        (_change(film, number, spread), _change(film, number, -spread))
        for number, spread in enumerate(uncertainty)
        if spread > 0.0
    ]
    for above, below in (*pairs, *others):
        total = tree.map_leaves(_add, total, middle, quantity(above), quantity(below))
    return tree.map_leaves(lambda one: np.sqrt(one)[()], total)


def _add(total: np.ndarray, middle: np.ndarray, above: np.ndarray, below: np.ndarray) -> np.ndarray:
    first, second = 0.5 * (above - below), above - 2.0 * middle + below
    return np.asarray(total + first**2 + _SECOND_ORDER * second**2)


def _change(film: Film, number: int, change: float) -> Film:
    layers = list(film.layers)
    thickness = layers[number].thickness + change
    layers[number] = dataclasses.replace(layers[number], thickness=thickness)
    return dataclasses.replace(film, layers=tuple(layers))


def _check(film: Film, uncertainty: Sequence[float]) -> None:
    if len(uncertainty) != len(film.layers):
        raise ParameterError(
            f"{len(uncertainty)} uncertainties of thicknesses are given for "
            f"{len(film.layers)} layers"
        )
    for layer, spread in zip(film.layers, uncertainty, strict=True):
        require_range(f"uncertainty of the thickness of {layer.material.name}", spread, 0.0)
        if not spread < layer.thickness:
            nanometres = [_METRES_TO_NANOMETRES * one for one in (layer.thickness, spread)]
            raise ParameterError(
                f"thickness of {layer.material.name} = {nanometres[0]:g} ± {nanometres[1]:g} nm: "
                "± is one standard deviation and must be below the thickness"
            )
