import subprocess
import sys

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.compute.evaluation import jit_with_options
from lightflyer.core.entry_point import elementwise_entry_point, entry_point


@lf.entry_point
def third(x):
    return x / 3.0


@pytest.mark.parametrize("value", [1.0, 1, np.float32(1), np.ones(3), jnp.ones(3, jnp.float32)])
def test_results_are_float64_numpy_arrays_whatever_comes_in(value):
    result = third(value)
    assert result.dtype == np.float64
    assert not isinstance(result, jax.Array)
    np.testing.assert_array_equal(result, np.ones_like(result) / 3.0)


def test_other_code_keeps_its_precision():
    assert jnp.ones(1).dtype == jnp.float32
    third(1.0)
    assert jnp.ones(1).dtype == jnp.float32


def test_inside_callers_single_precision_jit_the_work_is_double():
    # 1 + 1e-12 is 1 in single precision
    inner = lf.entry_point(lambda x: (x + 1e-12) - x)
    assert float(jax.jit(lambda x: inner(x))(1.0)) == pytest.approx(1e-12, rel=1e-3)


def test_float64_context_gives_gradients_all_digits():
    cube = lf.entry_point(lambda x: x**3)
    with lf.float64():
        slope = jax.grad(cube)(0.1)
    assert float(slope) == pytest.approx(0.03, rel=1e-15)


@pytest.mark.slow
def test_process_with_the_switch_on_gives_the_same_numbers():
    code = (
        "import lightflyer as lf, jax.numpy as jnp\n"
        "film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, 0.8, 0.9)\n"
        "state = lf.lu2023_earth().state(72e3)\n"
        "print(repr(float(lf.lift(lf.Disk(film, 0.01), state, lf.Lu2023()))), jnp.ones(1).dtype)"
    )
    outputs = {}
    for switch in ("0", "1"):
        outputs[switch] = subprocess.run(
            [sys.executable, "-c", code],
            env={"JAX_ENABLE_X64": switch},
            capture_output=True,
            text=True,
            check=True,
        ).stdout.split()
    assert outputs["0"][0] == outputs["1"][0]
    assert [outputs["0"][1], outputs["1"][1]] == ["float32", "float64"]


def test_errors_of_the_function_are_its_own():
    def broken(x):
        raise ValueError("mine")

    with pytest.raises(ValueError, match="mine"):
        entry_point(broken)(1.0)


@pytest.mark.parametrize("size", [6, 7, 10, 11, 12, 30])
def test_pieces_make_the_same_whole(monkeypatch, size):
    monkeypatch.setattr("lightflyer.core.entry_point.ROWS", 10)

    def function(x, y):
        return {"sum": x["a"] + 10.0 * x["b"] + y, "constant": 2.0 * y}

    x = {"a": np.arange(float(size)), "b": np.linspace(0.0, 1.0, size)}
    result = elementwise_entry_point(lambda x, y: function(x, y))(x, 3.0)
    np.testing.assert_allclose(result["sum"], x["a"] + 10.0 * x["b"] + 3.0, rtol=1e-15)
    assert result["constant"] == 6.0


def test_pieces_keep_shapes_and_leave_tables_whole(monkeypatch):
    monkeypatch.setattr("lightflyer.core.entry_point.ROWS", 10)
    grid = np.arange(24.0).reshape(4, 6)
    doubled = elementwise_entry_point(lambda x: 2.0 * x)
    np.testing.assert_array_equal(doubled(grid), 2.0 * grid)
    table = np.linspace(0.0, 1.0, 5)
    interpolated = elementwise_entry_point(lambda x, table: np.interp(x, np.arange(5.0), table))
    np.testing.assert_allclose(
        interpolated(np.linspace(0.0, 4.0, 33), table), np.linspace(0.0, 1.0, 33), atol=1e-15
    )


def test_options_that_this_xla_does_not_know_are_left_out():
    options = {"xla_backend_optimization_level": 0, "xla_of_tomorrow": True, "xla_of_old": 1}
    twice = jit_with_options(lambda x: 2.0 * x, options)
    assert float(twice(3.0)) == float(twice(3.0)) == 6.0
    wrong = jit_with_options(lambda x: x, {"xla_backend_optimization_level": "no number"})
    with pytest.raises(jax.errors.JaxRuntimeError, match="not a valid"):
        wrong(1.0)
