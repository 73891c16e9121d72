import jax
import jax.numpy as jnp
import numpy as np
import pytest

from lightflyer.numerics.batches import in_batches


@pytest.mark.parametrize("count", [1, 6, 7, 8, 20, 21])
def test_any_length_gives_what_one_call_gives_and_compiles_once(count):
    traces = []

    @jax.jit
    def function(x, table, factor):
        traces.append(x.shape)
        return {"rows": factor * table.sum(axis=1) + x, "table": factor * table}, 2.0 * factor

    x, table = np.arange(float(count)), np.arange(3.0 * count).reshape(count, 3)
    found, scalar = in_batches(function, (x, table, 3.0), size=7)
    np.testing.assert_allclose(found["rows"], 3.0 * table.sum(axis=1) + x, rtol=1e-6)
    np.testing.assert_allclose(found["table"], 3.0 * table, rtol=1e-6)
    assert float(scalar) == 6.0
    assert traces == [(7,)]


def test_the_last_batch_is_filled_with_its_last_row():
    seen = []
    in_batches(lambda x: seen.append(x.copy()) or x, (np.arange(5),), size=3)
    np.testing.assert_array_equal(seen, [[0, 1, 2], [3, 4, 4]])


def test_flags_stay_flags():
    found = in_batches(lambda x: (x > 1.5, jnp.asarray(x)), (np.arange(4.0),), size=3)
    np.testing.assert_array_equal(found[0], [False, False, True, True])
    assert found[0].dtype == bool
