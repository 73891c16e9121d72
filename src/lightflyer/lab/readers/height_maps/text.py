"""Matrices of heights in text files, Gwyddion's text export among them."""

import re
from pathlib import Path

import numpy as np

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.units import parse, scale_and_offset
from lightflyer.lab.readers.height_maps.channel import Channel
from lightflyer.lab.readers.number_matrix import NumberMatrix, read_number_matrix

_GWYDDION = ("Channel", "Width", "Height", "Value units")  # the lines of its header
_GWYDDION_LINE = re.compile(r"^#\s*([^:]+?)\s*:\s*(.+?)\s*$")
_LEAST_SIDE = 2  # places of a list along x and along y
_UNEVEN = 0.2  # of a step, by which the places of a list may be rounded


def read_matrix(
    path: Path, size: float | None, unit: str | None
) -> tuple[Channel, tuple[str, ...]]:
    """Read a matrix of heights; returns ``channel``, ``notes``."""
    matrix = read_number_matrix(path, "heights")
    stated = _stated(matrix.above)
    matrix, aspect = _from_list(path, matrix)
    unit = unit or stated.get("Value units")
    if unit is None:
        raise ConfigurationError(f'{path}: its heights have no unit; state it by --unit "nm"')
    try:
        scale = scale_and_offset(unit, "m")[0]
        width = parse(stated["Width"], "m").value if size is None and "Width" in stated else size
        length = parse(stated["Height"], "m").value if "Height" in stated else None
    except ConfigurationError as error:
        raise ConfigurationError(f"{path}: {error}") from None
    if width is None:
        raise ConfigurationError(f'{path}: has no width; state it by --size "10 um"')
    rows, columns = matrix.values.shape
    if length is None or size is not None:
        length = width * rows / columns * aspect
    return Channel(stated.get("Channel", ""), unit, (rows, columns), width, length,
                   lambda: matrix.values * scale), matrix.notes  # fmt: skip


def _stated(above: tuple[str, ...]) -> dict[str, str]:
    """What Gwyddion's header says, by its English words; it is written in the user's language."""
    said = [match.groups() for line in above if (match := _GWYDDION_LINE.match(line))]
    english = {name: text for name, text in said if name in _GWYDDION}
    for at in range(len(said) - 1):
        # the two lengths are width and height, whatever they are called
        if not english and all(_is_length(said[at + more][1]) for more in (0, 1)):
            texts = [text for _, text in said[max(at - 1, 0) : at + 3]]
            return dict(zip(_GWYDDION[0 if at else 1 :], texts, strict=False))
    return english


def _is_length(text: str) -> bool:
    try:
        return parse(text, "m").value > 0.0 and text[:1].isdigit() and not text[-1:].isdigit()
    except ConfigurationError:
        return False


def _from_list(path: Path, matrix: NumberMatrix) -> tuple[NumberMatrix, float]:
    """The matrix of a list of x, y and height, and the length of its pixels over their width."""
    values = matrix.values
    if values.shape[1] != 3 or len(values) < _LEAST_SIDE**2:
        return matrix, 1.0
    (x, column), (y, row) = (np.unique(values[:, axis], return_inverse=True) for axis in (0, 1))
    if len(x) * len(y) != len(values) or len(np.unique(row * len(x) + column)) != len(values):
        raise ConfigurationError(
            f"{path}: has three columns, as a list of x, y and height, but no full grid of "
            f"{len(x)} x {len(y)} places; export a matrix"
        )
    steps = [np.diff(one) for one in (x, y)]
    if len(x) < _LEAST_SIDE or len(y) < _LEAST_SIDE or any(
        np.ptp(one) > _UNEVEN * one.mean() for one in steps
    ):  # fmt: skip
        raise ConfigurationError(f"{path}: its list of x, y and height is no even grid")
    heights = np.empty((len(y), len(x)))
    heights[row, column] = values[:, 2]
    note = f"a list of x, y and height is read as {len(x)} x {len(y)} pixels"
    found = matrix._replace(values=heights, notes=(*matrix.notes, note))
    return found, float(steps[1].mean() / steps[0].mean())
