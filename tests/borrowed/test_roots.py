"""Public reports of root finding: functions whose roots are known.

`numerics/test_rootfind.py` has the cases of https://github.com/scipy/scipy/issues/3089 and
https://github.com/patrick-kidger/optimistix/pull/209.
"""

import math

import numpy as np
import pytest

from lightflyer.numerics.rootfind import SolverStatus, find_root, reach


def solve(residual, lower, upper, guess):
    root, outcome = find_root(residual, *(np.asarray(one, float) for one in (lower, upper, guess)))
    return float(root), SolverStatus(int(outcome.status))


def test_a_product_of_residuals_that_underflows():
    """https://github.com/scipy/scipy/issues/13737

    https://github.com/openturns/openturns/issues/1805: an end of the bracket was returned.
    """
    level = 1.9151695967140057e-174
    root, status = solve(lambda x: np.exp(x) / level - 1.0, -450.0, -350.0, -360.0)
    assert status is SolverStatus.CONVERGED
    assert root == pytest.approx(math.log(level), rel=1e-12)


def test_what_is_never_reached():
    """https://github.com/boostorg/math/issues/1005: f = x had a root in 1 to 3.

    https://github.com/patrick-kidger/optimistix/issues/206: a root at 5, sought below 2, ended
    the program. x/(1 + x) reaches 0.5 at 1, and never 2.
    """
    top = np.array(1e3)
    wanted = np.array([0.5, 2.0])
    found, within, _ = reach(lambda x: x / (1.0 + x), top, top / (1.0 + top), wanted)
    assert within.tolist() == [True, False]
    assert found[0] == pytest.approx(1.0, rel=1e-10)


@pytest.mark.parametrize("end", [2.0, 3.0])
def test_a_root_at_an_end_of_the_bracket(end):
    """https://github.com/scipy/scipy/issues/20293: a good end was not what came out."""
    root, status = solve(lambda x: x - end, 2.0, 3.0, 2.4)
    assert status is SolverStatus.CONVERGED
    assert root == pytest.approx(end, rel=1e-12)
