"""The coefficients that ship are those of the tables that ship."""

import numpy as np
import pytest
from kinetic_fits import make
from kinetic_fits.common import plain

from lightflyer.force import fitted


def numbers_in(content):
    if isinstance(content, dict):
        content = list(content.values())
    return (
        np.concatenate([numbers_in(one) for one in content])
        if isinstance(content, list)
        else (np.array([content], float))
    )


@pytest.fixture(scope="module")
def fits():
    return make.fits()


def test_every_fit_is_that_of_its_table(fits):
    """Digits of coefficients are the linear algebra's; a changed table changes many of them."""
    shipped = fitted._shipped()
    assert shipped.keys() == fits.keys()
    for name, by_gas in fits.items():
        assert shipped[name].keys() == by_gas.keys()
        for gas, fit in by_gas.items():
            found, expected = numbers_in(plain(fit)), numbers_in(shipped[name][gas])
            assert found == pytest.approx(expected, rel=1e-5, abs=1e-7 * abs(expected).max()), name


def test_a_gas_without_a_table_is_refused():
    with pytest.raises(ValueError, match="is not one of monatomic, diatomic"):
        fitted.fitted(tuple, "sharing", "polyatomic")
