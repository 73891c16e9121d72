"""Numbers whose errors are correlated, such as two coefficients measured in one set-up."""

from collections.abc import Sequence

import numpy as np

from lightflyer.core.errors import ParameterError
from lightflyer.numerics.correlation import Correlations, correlation_matrix

_ROUNDING = 1e-12  # of a pivot of a correlation matrix, whose diagonal is one


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
