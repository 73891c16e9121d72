"""Models on arrays of a third library, which allows nothing that the standard does not promise."""

import array_api_strict as strict
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.array import tree
from lightflyer.array.namespace import within

FILM = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
DISK = lf.Disk(FILM, radius=0.01)
STATE = lf.lu2023_earth().state(72e3)


def to_strict(leaf):
    return strict.asarray(float(leaf)) if isinstance(leaf, float | np.floating) else leaf


# the others take more from NumPy than the standard has, such as splines, or its older names
@pytest.mark.parametrize("model", [lf.Lu2023(), lf.FreeMolecular()])
@pytest.mark.parametrize("method", ["force", "heat_loss"])
def test_a_model_follows_its_arguments(model, method):
    excess = np.array([-0.2, 0.1, 0.5, 1.5])
    expected = getattr(model, method)(DISK, STATE, (excess,))
    with within():
        found = getattr(model, method)(
            *tree.map_leaves(to_strict, (DISK, STATE)), (strict.asarray(excess),)
        )
    for one, other in zip(tree.leaves(found), tree.leaves(expected), strict=True):
        assert type(one) is type(strict.asarray(0.0))
        np.testing.assert_allclose(np.asarray(one), other, rtol=1e-15)
