"""Cells in a plane through the axis, finer near the disk and finest at its edge."""

import math
from typing import NamedTuple

import numpy as np

from dsmc.vessel import PARTS, Vessel

FINE, MIDDLE, COARSE = 1, 2, 4
_NEAR_EDGE = 0.2  # from the edge, where cells are fine
_NEAR_DISK = (1.6, 0.6)  # radius and height up to which cells are of middle size
# weight of a particle of each size of cell, over that in the middle
_RELATIVE_WEIGHT = {FINE: 0.5, MIDDLE: 1.0, COARSE: 2.0}


class Cells(NamedTuple):
    """Cells, each a few squares of a grid in radius and height.

    Attributes
    ----------
    vessel : Vessel
    square : float
        Width of the grid's squares.
    below : int
        Rows of squares below the disk.
    lookup : array, shape (columns, rows)
        Cell of each square.
    volume : array, shape (cells,)
    weight : array, shape (cells,)
        Molecules that a particle stands for.
    radius, height : array, shape (cells,)
        Of the centres.
    """

    vessel: Vessel
    square: float
    below: int
    lookup: np.ndarray
    volume: np.ndarray
    weight: np.ndarray
    radius: np.ndarray
    height: np.ndarray


def build_cells(vessel: Vessel, width: float, particles: float) -> Cells:
    """Cells of a vessel.

    Parameters
    ----------
    vessel : Vessel
        Its distances are multiples of half the width.
    width : float
        Of the cells near the disk; half that at its edge, twice further out.
    particles : float
        In a cell of this width at the disk's edge radius. Nearer the axis there are fewer.

    Returns
    -------
    Cells

    Raises
    ------
    ValueError
        If a distance is not a multiple of half the width.
    """
    square = 0.5 * width
    below, columns, above = (round(distance / square) for distance in vessel.distance)
    for name, distance in zip(PARTS, vessel.distance, strict=True):
        if not fits(distance, width):
            raise ValueError(f"{name} {distance:g} is not a multiple of half the width {width:g}")
    column, row = np.meshgrid(np.arange(columns), np.arange(-below, above), indexing="ij")
    size = _sizes(column, row, square)
    _, lookup = np.unique(
        np.stack([size, column // size, row // size]).reshape(3, -1), axis=1, return_inverse=True
    )
    lookup = lookup.reshape(-1)
    squares = np.bincount(lookup)
    around = np.bincount(lookup, (2.0 * math.pi * square * (column + 0.5)).ravel())
    radius = around / (2.0 * math.pi * squares)
    relative = np.empty(squares.size)
    relative[lookup] = np.vectorize(_RELATIVE_WEIGHT.get)(size).ravel()
    unit = 2.0 * math.pi * width**2 / particles
    return Cells(
        vessel=vessel,
        square=square,
        below=below,
        lookup=lookup.reshape(column.shape).astype(np.int32),
        volume=around * square**2,
        weight=unit * relative * np.maximum(radius, 1.0),
        radius=radius,
        height=square * (np.bincount(lookup, row.ravel()) / squares + 0.5),
    )


def fits(distance: float, width: float) -> bool:
    """Whether a distance is a multiple of half the width of cells."""
    squares = distance / (0.5 * width)
    return abs(squares - round(squares)) < 1e-6


def _sizes(column: np.ndarray, row: np.ndarray, square: float) -> np.ndarray:
    """Width of the cell of each square, in squares."""
    # of the block of coarse or middle cells that it lies in, so that a block is of one size
    size = np.full(column.shape, COARSE)
    radius, height = _centres(column, row, COARSE, square)
    size[(radius < _NEAR_DISK[0]) & (np.abs(height) < _NEAR_DISK[1])] = MIDDLE
    radius, height = _centres(column, row, MIDDLE, square)
    at_edge = (np.abs(radius - 1.0) < _NEAR_EDGE) & (np.abs(height) < _NEAR_EDGE)
    size[at_edge & (size == MIDDLE)] = FINE
    return size


def _centres(
    column: np.ndarray, row: np.ndarray, size: int, square: float
) -> tuple[np.ndarray, np.ndarray]:
    """Centre of the block of some squares' width that each square lies in."""
    return tuple((index // size + 0.5) * size * square for index in (column, row))
