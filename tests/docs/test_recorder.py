"""The calculator's recorder: JavaScript of a function gives what NumPy gives."""

import math
import subprocess
import sys

import numpy as np
import pytest

from lightflyer.array import tree
from lightflyer.array.namespace import within, xp
from lightflyer.array.transformations import (
    custom_jvp,
    either,
    repeat,
    repeat_while,
    stop_gradient,
    with_slopes,
)
from lightflyer.numerics.interpolation import Axis, Spline, Sums, interpolate, spline
from lightflyer.numerics.polynomials import polynomial
from lightflyer.numerics.rootfind import find_power_root, implicit_root
from lightflyer.numerics.special import erf, xlogy
from lightflyer.numerics.system import solve_system

pytest.importorskip("calculator.recorder")
from calculator.graph import UnsupportedError
from calculator.javascript import Tables, number, write_function
from calculator.recorder import NotKnownError, Recorder

from .conftest import EXTENSIONS

TABLE = np.array([0.0, 0.5, 2.0, 3.0, 7.0])
MATRIX = np.array([[1.0, -2.0, 0.5], [0.25, 4.0, -1.0], [3.0, 0.125, 2.0]])
AXES = Axis(TABLE), Axis([-1.0, 0.0, 2.0], period=4.0)
GRID = np.sin(np.arange(15.0)).reshape(5, 3)
SPLINE = Spline.through(TABLE, np.exp(-TABLE))
SUMS = Sums((0.0, 0.5, 2.0, 3.0), (1.0, -0.5, 0.25, 0.1), (0.3, -0.4, 0.2), 3)
COEFFICIENTS = (((1.0, 2.0), (0.5, -1.0)), ((0.25, 0.0), (3.0, 0.125)), ((0.0, 0.5), (1.0, 1.0)))


def _rows(x, y):
    """Rows and elements of known and of recorded arrays, by recorded places."""
    whole = xp.floor(3.0 * xp.abs(x)).astype(int) % 3
    table, matrix, own = xp.asarray(TABLE), xp.asarray(MATRIX), xp.stack([x, y, x + y])
    places = xp.stack([whole, 0 * whole, (whole + 1) % 3])
    parts = [matrix[whole], matrix[:, whole], matrix[1:, None, whole][:, 0], table[places],
             own[places], own[whole][None], matrix[places, places], xp.stack([own, own])[:, whole],
             (table > 1.0)[places] * 1.0]  # fmt: skip
    return xp.concatenate(parts)


def _shapes(x, y):
    cube = xp.arange(12.0).reshape(2, 3, 2) * x + y
    return (
        xp.flip(xp.moveaxis(cube, 2, 0), 1).sum(1)[:, ::2], cube.max((0, 2)), cube.min(),
        cube.prod(2).reshape(6)[1:5:2], xp.cumsum(cube, axis=1)[0], xp.any(cube > 3.0),
        xp.all(cube > -50.0), xp.sum(MATRIX * xp.stack([x, y, 1.0 + 0.0 * x]), axis=-1),
        xp.zeros_like(cube) + xp.ones_like(x), xp.full_like(cube, 2) * y, xp.full((2,), x),
        *xp.broadcast_arrays(x, cube[0, 0]), xp.ndim(cube), xp.atleast_1d(y),
    )  # fmt: skip


def _collatz(x, y):
    """Nested loops, a variable without effect, variables that swap, and what does not change."""

    def step(state):
        count, total, other, unused, same = state
        inner, _ = repeat_while(
            lambda s: s[1] < 3, lambda s: (s[0] + xp.sin(x) * same * count, s[1] + 1), (total, 0)
        )
        following = xp.where(count % 2 < 1.0, count / 2, 3 * count + 1)
        return following, other, inner - total, unused + total, same

    start = xp.floor(5.0 + xp.abs(x)), y, x, x, y
    return repeat_while(lambda state: state[0] > 1.0, step, start)[:3]


def _repeated(x, y):
    return repeat(lambda carry: (carry * x + y, xp.stack([carry, x - carry])), y, 3)


def _slopes(x, y):
    """Derivatives of every operation that has one, in each argument."""

    def function(point):
        a, b = point
        size = xp.sqrt(a * a + b * b + 1.0)
        return (
            a + b - 2.0 * a * b, a / size, -xp.abs(a) * b, xp.exp(-size) + xp.expm1(0.1 * b),
            xp.log(size) + xp.log1p(size), xp.sin(a) * xp.cos(b), xp.sinh(0.1 * a),
            xp.cosh(0.1 * b),
            size**2.5, size**-3, size**0.3, 1.5**a, xp.maximum(a, b - 0.1), xp.minimum(a, b - 0.1),
            xp.where(a > 0.05, b * a, -b), xp.sign(a) + xp.floor(b),
            polynomial(COEFFICIENTS, a, b, size),
            spline(SUMS, size), SPLINE(size),
        )  # fmt: skip

    return with_slopes(function, (x, y))


@custom_jvp
def _own_derivative(x):
    return xp.where(x > 0.0, xp.sqrt(xp.abs(x)), x)


def _root(x, y):
    """Root of t³ + t = |x| + 1, within a search and in a loop."""

    def root(goal):
        return implicit_root(
            lambda t: t * (t * t + 1.0) - goal,
            lambda: find_power_root(lambda t: t * (t * t + 1.0), goal, 1e-9 + 0 * goal, goal, goal),
        )

    found, outcome = root(xp.abs(x) + 1.0)
    return found, outcome.converged, _own_derivative(stop_gradient(y))


def _system(x, y):
    found, outcome = solve_system(
        lambda at: (at[0] ** 3 + at[1] - x, at[1] ** 3 + 2.0 * at[0] - y),
        lambda: (xp.asarray(x, float), xp.asarray(y, float)),
        lower=(-1e3, -1e3),
    )
    return *found, outcome.status


FUNCTIONS = {
    "sums": lambda x, y: (
        x - (y - x), x - y - x, x + y * (x + y), -x - -y, x / (y / x), -(1.0 - x), 2.0 - (-x) + y,
        0.0 - x, 1.0 / x, -1.0 * y, y * -1.0, x / -1.0, x - 0.0, -x + y, 1.0 * x, 0.0 + y,
    ),
    "powers": lambda x, y: (x**2, x**-3, xp.abs(x) ** y, x**7, x**0, xp.abs(x) ** 0.5, 2.0**y),
    "roots": lambda x, y: (xp.sqrt(x), xp.cbrt(y), xp.abs(x) ** 1.5),
    "exponentials": lambda x, y: (
        xp.exp(x), xp.expm1(x), xp.log(y), xp.log1p(y), xlogy(x, y + 4.0), xlogy(0.0, y)
    ),
    "angles": lambda x, y: (
        xp.sin(x), xp.cos(y), xp.tan(x), xp.arcsin(x / 10), xp.arccos(y / 10), xp.arctan(x),
        xp.arctan2(x, y), xp.sinh(x), xp.cosh(y), xp.tanh(x), xp.arcsinh(y),
    ),
    "wholes": lambda x, y: (
        xp.floor(x), xp.ceil(y), xp.floor(x).astype(int), xp.sign(y), xp.abs(x),
        xp.floor(7 * y).astype(int) % 4, xp.mod(x, 0.7), xp.mod(y, -0.7),
    ),
    "order": lambda x, y: (
        x < y, x <= y, x > y, x >= y, x == y, x != y, xp.maximum(x, y), xp.minimum(x, y),
        xp.clip(x, -0.5, 0.5), xp.isfinite(x), xp.isnan(y),
    ),
    "logic": lambda x, y: (
        (x > 0) & (y > 0), (x > 0) | ~(y > 0), (x > 0) ^ (y > 0), 1.0 * (x > y),
        xp.where(x > y, True, y > 0),
        xp.where(x > y, False, y > 0), xp.where(~(x > y), x > 1, False),
        xp.logical_and(x > 0, np.array(True)),
    ),
    "choices": lambda x, y: (
        xp.where(x > y, xp.where(y > 0, x, 2.0), y), either(x > y, lambda: x * y, lambda: x - y),
        either(True, lambda: x, lambda: np.sqrt("no")),
    ),
    "constants": lambda x, y: (
        x * 0.0 + y, x + np.inf, y * np.nan, x - 1e-300, y + 1.7976931348623157e308, x * (2 - 1)
    ),
    "search": lambda x, y: tuple(
        xp.searchsorted(table, xp.stack([x, y, x * y]), side=side)
        for side in ("left", "right") for table in (TABLE, xp.stack([0.0 * y, x**2, x**2 + 1.0]))
    ),
    "interpolation": lambda x, y: xp.interp(xp.stack([x, y]), TABLE, TABLE**2),
    "by numpy": lambda x, y: (np.sqrt(xp.abs(x)) * np.array([1.0, 2.0]), np.float64(2.0) / y),
    "rows": _rows,
    "shapes": _shapes,
    "while": _collatz,
    "swap": lambda x, y: repeat_while(
        lambda s: s[0] < 3, lambda s: (s[0] + 1, s[2], s[1]), (xp.zeros((), int), x, y)
    ),
    "repeat": _repeated,
    "slopes": _slopes,
    "root": _root,
    "system": _system,
    "splines": lambda x, y: (
        SPLINE(x), SPLINE(xp.stack([y, x])), spline(SUMS, xp.abs(x)),
        polynomial(COEFFICIENTS, x, y, x),
        interpolate(GRID, AXES, (xp.clip(x, 0.0, 7.0), y)),
    ),
}  # fmt: skip
POINTS = [(0.3, 0.7), (-1.2, 2.5), (2.0, 2.0), (4.1, -3.3), (-0.5, -0.25), (1.0, 0.0), (0.0, -0.0),
          (np.inf, 1.0), (1.5, np.nan)]  # fmt: skip
_JSON = {np.inf: "Infinity"}
# a loop may not end, and what is not finite is in no place
NEED_FINITE = {"while", "system", "root", "rows", "wholes", "slopes", "splines", "search",
               "interpolation"}  # fmt: skip
TOLERANCE = {"system": 1e-11, "root": 1e-11, "slopes": 3e-6}  # of searches, and of differences


def _points(name):
    return POINTS[:-4] if name == "slopes" else POINTS[:-2] if name in NEED_FINITE else POINTS


def _written(function, tables, name="f"):
    recorder = Recorder()
    with within(jax=recorder):
        given = recorder.variable(), recorder.variable()
        leaves = tree.leaves(function(*given))
    arguments = [one.nodes.item() for one in given]
    results = [node for leaf in leaves for node in recorder.nodes(leaf).flat]
    return write_function(name, recorder.graph, arguments, results, tables)


@pytest.fixture(scope="module")
def computed(run_javascript, numbers):
    """What JavaScript makes of every function at every point, in one process."""
    tables, places = Tables(), {name: f"f{index}" for index, name in enumerate(FUNCTIONS)}
    script = "".join(_written(FUNCTIONS[name], tables, places[name]) for name in FUNCTIONS)
    # JSON has neither infinity nor NaN; any other word is NaN
    script += "const call = (name, given) => eval(name)(...given.map(Number)).map(Number);"
    calls = [
        ("call", (places[name], [_JSON.get(value, str(value)) for value in point]))
        for name in FUNCTIONS
        for point in _points(name)
    ]
    found = iter(run_javascript(tables.text() + script, calls))
    return {name: [numbers(next(found)) for _ in _points(name)] for name in FUNCTIONS}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_javascript_gives_what_numpy_gives(name, computed):
    for point, found in zip(_points(name), computed[name], strict=True):
        with within():
            results = FUNCTIONS[name](*map(np.float64, point))
        leaves = [np.ravel(leaf).astype(float) for leaf in tree.leaves(results)]
        tolerance = TOLERANCE.get(name, 1e-13)
        np.testing.assert_allclose(
            found,
            np.concatenate(leaves),
            rtol=tolerance,
            atol=1e-300 + tolerance * (name == "slopes"),
        )


def _endless(x, y):
    return with_slopes(lambda p: repeat_while(lambda t: t < p[0], lambda t: t + y, x), (x, y))


@pytest.mark.parametrize(
    ("function", "said"),
    [
        (lambda x, y: erf(x) + y, '"erf" is not written'),
        (lambda x, y: xp.linalg.eigvals(x + y), '"linalg" is not written'),
        (lambda x, y: xp.sort(xp.stack([x, y])), '"sort" is not written'),
        (lambda x, y: x.astype(complex) + y, "complex128 is not written"),
        (lambda x, y: xp.floor(x).astype(int) & 3, "in place of truth values"),
        (lambda x, y: xp.asarray(TABLE)[x] + y, "a place that is no whole number"),
        (lambda x, y: repeat(lambda c: (c * y, c), x, 1000), "1000 steps"),
        (_endless, "the derivative of a loop"),
        (lambda x, y: with_slopes(lambda p: xp.tan(p[0]), (x, y)), 'the derivative of "tan"'),
        (lambda x, y: np.add(x, y, out=np.zeros(())), "into an array"),
    ],
)  # fmt: skip
def test_what_cannot_be_written_is_refused_by_name(function, said):
    with pytest.raises(UnsupportedError, match=said):
        _written(function, Tables())


@pytest.mark.parametrize(
    "function",
    [lambda x, y: x if y > 0.0 else y, lambda x, y: float(x) + y, lambda x, y: np.asarray(x) + y,
     lambda x, y: math.sqrt(x) + y],
)  # fmt: skip
def test_what_is_not_known_is_not_looked_at(function):
    with pytest.raises(NotKnownError):
        _written(function, Tables())


def test_equal_work_is_done_once_and_idle_work_not_at_all():
    def function(x, y):
        idle = xp.tan(y)
        return xp.exp(x) * y + xp.exp(x) / y + 0.0 * xp.where(True, 1.0, idle)

    text = _written(function, Tables())
    assert text.count("Math.exp") == 1
    assert "Math.tan" not in text


def test_a_loop_does_not_repeat_what_does_not_change():
    def function(x, y):
        def step(state):
            t, same = state
            return t + xp.exp(x) * xp.cos(same) * xp.sin(t), same

        return repeat_while(lambda state: state[0] < 9.0, step, (y, x))

    before, inside = _written(function, Tables()).split("for(;;)")
    assert "Math.exp" in before
    assert "Math.cos" in before
    assert "Math.exp" not in inside
    assert "Math.cos" not in inside
    assert "Math.sin" in inside


def test_equal_tables_are_written_once():
    tables = Tables()
    for name in ("f", "g"):
        _written(lambda x, y: (xp.interp(x, TABLE, TABLE), SPLINE(y)), tables, name)
    assert tables.text().count("[0,.5,2,3,7]") == 1


def test_numbers_keep_every_bit():
    values = [0.1, 1 / 3, -2.5e-308, 5e-324, 1.7976931348623157e308, -0.0, 123456789.0, 1e22]
    assert [float(number(value)) for value in values] == values
    assert number(-0.0) == "-0"


def test_a_calculator_is_written_without_jax():
    code = (
        f"import sys; sys.modules['jax'] = None; sys.path.insert(0, {str(EXTENSIONS)!r})\n"
        "from calculator.kinds import KINDS\nfrom calculator.model import compile_all\n"
        "balloon = next(one for one in KINDS if one.name == 'balloon')\n"
        "assert 'function model_balloon' in compile_all(balloon)\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)
