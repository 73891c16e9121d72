"""Errors that go together: the two accommodation coefficients of a film, measured in one set-up."""

from collections.abc import Sequence

import numpy as np

FACES = ("film.tac_top", "film.tac_bottom")
"""The fields whose errors a flyer file's ``tac_correlation`` is about."""


def correlated_groups(names: Sequence[str], tac_correlation: float) -> tuple[tuple[str, ...], ...]:
    """Uncertain fields, those with correlated errors together.

    Parameters
    ----------
    names : sequence of str
        Dotted.
    tac_correlation : float
        Of the errors of the faces' accommodation coefficients.

    Returns
    -------
    tuple of tuple of str
        In the order in which each group's first field stands.
    """
    if not tac_correlation or not set(FACES) <= set(names):
        return tuple((name,) for name in names)
    pair = tuple(name for name in names if name in FACES)
    return tuple(pair if name == pair[0] else (name,) for name in names if name != pair[1])


def correlate(shares: np.ndarray, names: Sequence[str], tac_correlation: float) -> np.ndarray:
    r"""Shares of independent draws, made to belong to correlated ones.

    A Gaussian copula: with :math:`z = \Phi^{-1}(u)` the second coefficient's becomes
    :math:`\rho z_1 + \sqrt{1 - \rho^2}\,z_2`. Each keeps its own distribution; normal ones have
    the correlation :math:`\rho`.

    Parameters
    ----------
    shares : array, shape (n, k)
        Between 0 and 1, a column for each field.
    names : sequence of str, length k
        Dotted.
    tac_correlation : float

    Returns
    -------
    array, shape (n, k)
    """
    pairs = [group for group in correlated_groups(names, tac_correlation) if len(group) > 1]
    if not pairs:
        return shares
    from scipy.special import ndtr, ndtri

    (pair,) = pairs
    first, second = (list(names).index(name) for name in pair)
    tiny = np.finfo(float).tiny  # the ends themselves have no number, and are no draws
    one, other = ndtri(np.clip(shares[:, [first, second]], tiny, 1.0 - np.finfo(float).epsneg)).T
    correlated = shares.copy()
    rest = np.sqrt(1.0 - tac_correlation**2)
    correlated[:, second] = ndtr(tac_correlation * one + rest * other)
    return correlated
