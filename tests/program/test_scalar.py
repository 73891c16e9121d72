"""The emitter: each primitive in JavaScript and in Python gives what JAX gives."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from lightflyer.core.precision import float64
from lightflyer.numerics.system import solve_system
from lightflyer.program.operations import RULES, UnsupportedError
from lightflyer.program.scalar import python
from lightflyer.program.scalar.javascript import Tables, number, write_function
from lightflyer.program.scalar.python import compile_numbers
from lightflyer.program.tracing import trace, trace_numbers

TABLE = np.array([0.0, 0.5, 2.0, 3.0, 7.0])
MATRIX = np.array([[1.0, -2.0, 0.5], [0.25, 4.0, -1.0], [3.0, 0.125, 2.0]])


def _sorted_place(x, y):
    return jnp.searchsorted(jnp.asarray(TABLE), jnp.stack([x, y, x * y]), side="right")


def _rows(x, y):
    """Rows and elements of constant and of computed arrays, by computed indices."""
    whole = (3.0 * jnp.abs(x)).astype(int) % 7
    own = jnp.stack([x, y, x + y, x - y])
    parts = [
        jnp.asarray(MATRIX)[whole],
        jnp.asarray(TABLE)[jnp.stack([whole, 0 * whole, whole - 9])],
        own[whole][None],
        own.at[whole].get(mode="fill", fill_value=-5.0)[None],
        jax.lax.dynamic_slice(jnp.asarray(MATRIX), (whole, whole - 1), (2, 2)).ravel(),
    ]
    return jnp.concatenate(parts)


def _shapes(x, y):
    cube = jnp.arange(12.0).reshape(2, 3, 2) * x + y
    return (
        jnp.flip(cube.transpose(2, 0, 1), 1).sum(1)[:, ::2].ravel(),
        cube.max((0, 2)), cube.min(), cube.prod(2).ravel()[1:5:2],
        jnp.cumsum(cube, 1)[0], jax.lax.cumsum(cube[0, 0], reverse=True),
        jnp.any(cube > 3.0), jnp.all(cube > -50.0),
        MATRIX @ jnp.stack([x, y, 1.0 + 0 * x]), MATRIX[:2] @ MATRIX.T * x,
    )  # fmt: skip


def _collatz(x, y):
    """Nested loops, a variable without effect, variables that swap, and what does not change."""

    def step(state):
        number, total, other, unused = state
        inner, _ = jax.lax.while_loop(
            lambda s: s[1] < 3, lambda s: (s[0] + jnp.sin(x) * y * number, s[1] + 1), (total, 0)
        )
        following = jnp.where(number % 2 < 1.0, number / 2, 3 * number + 1)
        return following, other, inner - total, unused + total

    start = jnp.floor(5.0 + jnp.abs(x)), y, x, x
    return jax.lax.while_loop(lambda state: state[0] > 1.0, step, start)[:3]


def _scans(x, y):
    def step(carry, row):
        return carry * x + row[0], carry - row[1]

    rows = jnp.stack([jnp.array([1.0, 2.0, 3.0]), jnp.stack([x, y, x])], 1)
    return jax.lax.scan(step, y, rows), jax.lax.scan(step, y, rows, reverse=True)


@jax.custom_jvp
def _own_derivative(x):
    return jnp.where(x > 0.0, jnp.sqrt(jnp.abs(x)), x)


_own_derivative.defjvp(lambda given, slopes: (_own_derivative(*given), 2.0 * slopes[0]))


def _root(x):
    """Root of t³ + t = x, by an implicit function."""

    def solve(f, start):
        return jax.lax.fori_loop(0, 40, lambda _, t: t - f(t) / (3.0 * t * t + 1.0), start)

    return jax.lax.custom_root(
        lambda t: t * (t * t + 1.0) - x, 0.0 * x, solve, lambda f, y: y / f(jnp.ones_like(y))
    )


def _system(x, y):
    """Two equations by the package's own solver, whose loops are Equinox's."""
    found, outcome = solve_system(
        lambda at: (at[0] ** 3 + at[1] - x, at[1] ** 3 + 2.0 * at[0] - y),
        lambda: (x, y),
        lower=(-1e3, -1e3),
    )
    return *found, outcome.status


FUNCTIONS = {
    "sums": lambda x, y: (
        x - (y - x), x - y - x, x + y * (x + y), -x - -y, x / (y / x), -(1.0 - x)
    ),
    "powers": lambda x, y: (
        x**2, x**-3, jnp.abs(x) ** y, x**7, jnp.square(y), jax.lax.integer_pow(x, 0)
    ),
    "roots": lambda x, y: (jnp.sqrt(x), jnp.cbrt(y), jax.lax.rsqrt(jnp.abs(x))),
    "exponentials": lambda x, y: (
        jnp.exp(x), jnp.expm1(x), jnp.log(y), jnp.log1p(y), jax.nn.sigmoid(x)
    ),
    "angles": lambda x, y: (
        jnp.sin(x), jnp.cos(y), jnp.tan(x), jnp.arcsin(x / 10), jnp.arccos(y / 10), jnp.arctan(x),
        jnp.arctan2(x, y), jnp.sinh(x), jnp.cosh(y), jnp.tanh(x),
    ),
    "wholes": lambda x, y: (
        jnp.floor(x), jnp.ceil(y), jnp.trunc(x), x.astype(int), jnp.sign(y), jnp.abs(x),
        (7 * x).astype(int) // 3, (7 * y).astype(int) % 4, jax.lax.rem(x, y),
        jax.lax.div((9 * x).astype(int), 4),
    ),
    "order": lambda x, y: (
        x < y, x <= y, x > y, x >= y, x == y, x != y, jnp.maximum(x, y), jnp.minimum(x, y),
        jnp.clip(x, -0.5, 0.5), jnp.isfinite(x), jnp.isnan(y),
    ),
    "logic": lambda x, y: (
        (x > 0) & (y > 0), (x > 0) | ~(y > 0), (x > 0) ^ (y > 0), x.astype(bool), 1.0 * (x > y)
    ),
    "choices": lambda x, y: (
        jnp.where(x > y, jnp.where(y > 0, x, 2.0), y),
        jax.lax.select_n((2.0 * y).astype(int) % 3, x, y, x * y),
        jax.lax.switch((2.0 * x).astype(int), [lambda a: a, jnp.sin, lambda a: a * y], x),
    ),
    "constants": lambda x, y: (
        x * 0.0 + y, x + np.inf, y * np.nan, x - 1e-300, y + 1.7976931348623157e308, x * (2 - 1)
    ),
    "search": _sorted_place,
    "interpolation": lambda x, y: jnp.interp(jnp.stack([x, y]), TABLE, TABLE**2),
    "rows": _rows,
    "shapes": _shapes,
    "while": _collatz,
    "scan": _scans,
    "system": _system,
    "own derivative": lambda x, y: (
        _own_derivative(x), jax.grad(_own_derivative)(y), _root(x), jax.grad(_root)(y)
    ),
}  # fmt: skip
FOR_PYTHON = {
    "further": lambda x, y: (
        jax.lax.erf(x), jax.lax.erfc(y), jax.lax.erf_inv(x / 10), jax.lax.lgamma(jnp.abs(x) + 2.5),
        jnp.exp2(x), jnp.round(y), jnp.nextafter(x, 9.0), jnp.arctanh(x / 10), jnp.arcsinh(y),
        jnp.arccosh(y), jnp.exp(500.0 * x), jnp.log(0.0 * x), (x - x) / (y - y), x / (y - y),
    ),
}  # fmt: skip
"""What a page does without."""
POINTS = [
    (0.3, 0.7), (-1.2, 2.5), (2.0, 2.0), (4.1, -3.3), (-0.5, -0.25), (1.0, 0.0), (0.0, -0.0),
    (np.inf, 1.0), (1.5, np.nan),
]  # fmt: skip
FINITE = POINTS[:-2]
_JSON = {np.inf: "Infinity"}
# a loop may not end, and what is not finite is no whole number
NEED_FINITE = {"while", "system", "own derivative", "wholes", "choices", "rows"}


def _points(name):
    return FINITE if name in NEED_FINITE else POINTS


def _compiled(function, given=(), shapes=()):
    with float64():
        program = trace_numbers(function, 2)
    return compile_numbers(program, dict(given), dict(shapes))


def _written(function, tables, name="f", count=2):
    with float64():
        program = trace_numbers(function, count)
    return write_function(name, program, tables)


@pytest.fixture(scope="module")
def computed(run_javascript, numbers):
    """What JavaScript makes of every function at every point, in one process."""
    tables, places = Tables(), {name: f"f{index}" for index, name in enumerate(FUNCTIONS)}
    script = "".join(
        _written(function, tables, places[name]) for name, function in FUNCTIONS.items()
    )
    # JSON has neither infinity nor NaN; any other word is NaN
    script += "const call = (name, given) => eval(name)(...given.map(Number)).map(Number);"
    calls = [
        ("call", (places[name], [_JSON.get(value, str(value)) for value in point]))
        for name in FUNCTIONS
        for point in _points(name)
    ]
    found = iter(run_javascript(tables.text() + script, calls))
    return {name: [numbers(next(found)) for _ in _points(name)] for name in FUNCTIONS}


@pytest.fixture(scope="module")
def expected():
    """What JAX makes of them, in one program."""

    def every(names, x, y):
        return {
            name: [jnp.ravel(leaf).astype(float) for leaf in jax.tree.leaves(every_one[name](x, y))]
            for name in names
        }

    every_one = FUNCTIONS | FOR_PYTHON

    found = {}
    with float64():
        for names, points in (
            (NEED_FINITE, FINITE),
            (every_one.keys() - NEED_FINITE, POINTS),
        ):
            program = jax.jit(jax.vmap(partial(every, sorted(names))))
            found |= program(*jnp.array(points).T)
    return {name: np.concatenate(leaves, 1) for name, leaves in found.items()}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_javascript_gives_what_jax_gives(name, computed, expected):
    np.testing.assert_allclose(computed[name], expected[name], rtol=1e-13, atol=1e-300)


@pytest.mark.parametrize("name", FUNCTIONS | FOR_PYTHON)
def test_python_gives_what_jax_gives(name, expected):
    function = _compiled((FUNCTIONS | FOR_PYTHON)[name])
    found = [np.concatenate([*map(np.ravel, function(point))]) for point in _points(name)]
    np.testing.assert_allclose(found, expected[name], rtol=1e-13, atol=1e-300)


def test_python_looks_up_what_is_given_and_computes_it_once():
    table = np.linspace(0.0, 5.0, 1000) ** 2

    def function(x, table):
        return table[(100.0 * x).astype(int)] * jnp.sin(table[7]), jnp.stack([x > 1.0, x < 1.0])

    with float64():
        program, _ = trace(lambda leaves: function(*leaves), [(), (1000,)], ["<f8", "<f8"])
    call = compile_numbers(program, {1: table}, {})
    for x in (0.25, 1.5, 1e3, -1.0):
        values, flags = call([np.float64(x)])
        place = int(np.clip(100 * x + (1000 if x < 0 else 0), 0, 999))
        assert values == table[place] * np.sin(table[7])
        assert flags.tolist() == [x > 1.0, x < 1.0]
        assert flags.dtype == bool


def test_python_takes_arrays_as_they_are_stated():
    with float64():
        program, _ = trace(lambda leaves: leaves[0] @ leaves[1], [(2, 2), (2,)], ["<f8", "<f8"])
    matrix, vector = np.array([[1.0, 2.0], [3.0, 5.0]]), np.array([0.5, -1.0])
    (found,) = compile_numbers(program, {}, {0: (2, 2), 1: (2,)})([matrix, vector])
    np.testing.assert_array_equal(found, matrix @ vector)


@pytest.mark.parametrize(
    ("function", "said"),
    [
        (lambda x, y: jax.lax.erf_inv(x) + y, '"erf_inv" is not written'),
        (lambda x, y: x.astype(jnp.float32) + y, "float32: numbers are"),
        (lambda x, y: jax.lax.complex(x, y), '"complex" is not written'),
        (lambda x, y: x.astype(int) & y.astype(int), "truth values only"),
        (lambda x, y: jax.lax.scan(lambda c, _: (c * y, None), x, None, 1000)[0], "1000 steps"),
        (
            lambda x, y: jax.lax.cond(
                x > 0,
                lambda a: jax.lax.while_loop(lambda t: t < 9, lambda t: t + 1, a),
                lambda a: a,
                y,
            ),
            'inside of "cond"',
        ),
    ],
)
def test_what_cannot_be_written_is_refused_by_name(function, said):
    with pytest.raises(UnsupportedError, match=said):
        _written(function, Tables())


def test_equal_work_is_done_once_and_idle_work_not_at_all():
    def function(x, y):
        idle = jnp.tan(y)
        return jnp.exp(x) * y + jnp.exp(x) / y + 0.0 * jnp.where(True, 1.0, idle)

    text = _written(function, Tables())
    assert text.count("Math.exp") == 1
    assert "Math.tan" not in text


def test_a_loop_does_not_repeat_what_does_not_change():
    def function(x, y):
        return jax.lax.while_loop(lambda t: t < 9.0, lambda t: t + jnp.exp(x) * jnp.sin(t), y)

    before, inside = _written(function, Tables()).split("for(;;)")
    assert "Math.exp" in before
    assert "Math.exp" not in inside
    assert "Math.sin" in inside


def test_numbers_keep_every_bit():
    values = [0.1, 1 / 3, -2.5e-308, 5e-324, 1.7976931348623157e308, -0.0, 123456789.0, 1e22]
    assert [float(number(value)) for value in values] == values
    assert number(-0.0) == "-0"


def test_python_is_written_once_for_all_that_may_be_given(monkeypatch):
    """Numbers, small arrays and tables; but where a number is 0 or 1."""
    count, original = [], python.write_graph
    monkeypatch.setattr(python, "write_graph", lambda *given: count.append(1) or original(*given))

    def function(x, factor, axis, table):
        place = jnp.searchsorted(axis, x)
        return factor * x + axis[place], table[place] + jnp.sum(axis) / factor

    with float64():
        shapes = [(), (), (5,), (2000,)]
        program, _ = trace(lambda leaves: function(*leaves), shapes, ["<f8"] * 4)
    rng = np.random.default_rng(1)
    for factor in (2.5, -7.0, 0.5):
        axis, table = np.sort(rng.random(5)), rng.random(2000)
        call = compile_numbers(program, {1: factor, 2: axis, 3: table}, {})
        for x in (0.25, axis[2], 2.0):
            found = call([np.float64(x)])
            place = min(int(np.searchsorted(axis, x)), 4)
            own = table[int(np.searchsorted(axis, x))]
            assert found == pytest.approx([factor * x + axis[place], own + axis.sum() / factor])
    assert len(count) == 1
    compile_numbers(program, {1: 1.0, 2: axis, 3: table}, {})
    assert len(count) == 2


def test_two_tables_that_were_one_may_differ_later():
    with float64():
        program, _ = trace(
            lambda leaves: (
                leaves[1][leaves[0].astype(int)] - 2.0 * leaves[2][leaves[0].astype(int)]
            ),
            [(), (1000,), (1000,)],
            ["<f8"] * 3,
        )
    one, other = np.arange(1000.0), np.arange(1000.0) ** 2
    for first, second in ((one, one), (one, other), (other, one)):
        (found,) = compile_numbers(program, {1: first, 2: second}, {})([np.float64(7.0)])
        assert found == first[7] - 2.0 * second[7]


def test_python_that_raises_is_written_anew(monkeypatch):
    call = _compiled(lambda x, y: jnp.where(y == 0.0, x, x / y) + jnp.log(y), {0: 3.0})
    (found,) = call([2.0])
    assert found == 1.5 + np.log(2.0)
    monkeypatch.setattr(python, "_QuickPython", None)  # from the first on that raises
    for y in (0.0, 2.0, np.inf, np.nan, -1.0):
        with np.errstate(all="ignore"):
            wanted = np.where(y == 0.0, 3.0, np.divide(3.0, y)) + np.log(y)
        assert call([y])[0] == pytest.approx(wanted, rel=1e-15, nan_ok=True)


def test_parts_of_a_row_of_objects_are_arrays():
    """As JAX since 0.12 takes rows apart; Python's iteration gives the objects themselves."""
    parts = RULES["unstack"]({}, np.array([{}, {}], object), shape=[2], axis=0)
    assert [(part.shape, part.dtype) for part in parts] == [((), object)] * 2
