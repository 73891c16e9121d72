"""Correlations of errors as a matrix."""

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import numpy as np

Correlations: TypeAlias = Mapping[tuple[str, str], float]
"""Correlation of the errors of two numbers, by their names in either order."""


def correlation_matrix(names: Sequence[str], correlations: Correlations) -> np.ndarray:
    """Correlations as a matrix, shape (k, k); those of numbers without a name are left out."""
    matrix = np.eye(len(names))
    row = {name: number for number, name in enumerate(names)}
    for (first, second), value in correlations.items():
        if first in row and second in row:
            matrix[row[first], row[second]] = matrix[row[second], row[first]] = value
    return matrix
