"""Programs: NumPy gives what XLA gives, arrays have any shape, and what is kept is never stale."""

import gc
import tomllib
from dataclasses import replace
from functools import partial, wraps

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.cli.commands.init import templates
from lightflyer.config.flyer_file import flyer_file_type
from lightflyer.config.reader import read_design
from lightflyer.design.tables import tabulate_places
from lightflyer.program import entry_point as entry_points
from lightflyer.program import kept, tracing
from lightflyer.program.entry_point import bind, entry_point, run_by
from lightflyer.program.numpy_backend import require_supported, run
from lightflyer.program.operations import UnsupportedError
from lightflyer.program.program import Block, Operation, Program, length_of
from lightflyer.program.tracing import trace
from lightflyer.program.widening import serves_many

AGREEMENT = 1e-10
PLACES = 40  # random designs of each kind, each at a place of its own
SPREAD = 0.1  # of each number of a design
KINDS = [name for name, template in templates().items() if template.is_flyer]
OTHERS = {
    "earth by lu2023 in its air": (
        "earth",
        {"force": {"model": "lu2023"}, "environment": {"atmosphere": "lu2023"}},
    ),
    "earth by free molecules": ("earth", {"force": {"model": "free-molecular"}}),
    "earth by free molecules, linear": ("earth", {"force": {"model": "free-molecular-linear"}}),
    "mars by free molecules": ("mars", {"force": {"model": "free-molecular"}}),
    "sandwich by kinetic": ("sandwich", {"force": {"model": "kinetic"}}),
    "hollow by celenza2023": ("hollow", {"force": {"model": "celenza2023"}}),
}
"""Force models and surroundings that no template has: the template, and what is other."""


def traced(function, *shapes):
    kinds = [np.dtype(float)] * len(shapes)
    with lf.float64():
        return trace(lambda leaves: function(*leaves), shapes, kinds)[0]


def by_xla(function, *inputs):
    with lf.float64():
        return np.asarray(jax.jit(function)(*inputs))


@pytest.fixture(scope="module")
def flyers(tmp_path_factory):
    """The setup of each kind of flyer that ``lightflyer init`` writes."""
    folder, found = tmp_path_factory.mktemp("flyers"), {}
    for name in KINDS:
        path = folder / f"{name}.toml"
        path.write_text(templates()[name].read(), encoding="utf-8")
        found[name] = read_design(path).setup
    for name, (kind, other) in OTHERS.items():
        content = tomllib.loads(templates()[kind].read())
        found[name] = flyer_file_type()(**(content | other)).build()
    return found


@pytest.mark.slow
@pytest.mark.parametrize("kind", [*KINDS, *OTHERS])
def test_random_designs_of_every_kind_are_those_of_xla(flyers, kind, rng):
    setup = flyers[kind]
    coordinate = rng.uniform(*np.log(np.array(setup.searched) + 1.0), PLACES)
    coordinate = np.exp(coordinate) - 1.0
    light = rng.uniform(0.0, 3000.0, PLACES)

    has_tables = any(map(np.ndim, jax.tree.leaves(setup)))

    def varied(leaf):
        return leaf if has_tables else leaf * rng.uniform(1.0 - SPREAD, 1.0, PLACES)

    design = jax.tree.map(varied, setup)
    with run_by("numpy"):
        ours = tabulate_places(design, coordinate, light)
    with run_by("xla"):
        theirs = tabulate_places(design, coordinate, light)
    assert ours.keys() == theirs.keys()
    for name in ours:
        if name.endswith("residual"):
            continue  # rounding
        np.testing.assert_allclose(ours[name], theirs[name], rtol=AGREEMENT, err_msg=name)


FUNCTIONS = {
    "sums": lambda x: jnp.sum(x) + jnp.cumsum(x)[-1] * jnp.prod(1.0 + 1e-3 * x),
    "extremes": lambda x: jnp.stack([jnp.max(x), jnp.min(x), x[jnp.argmax(x)]]),
    "sorting": lambda x: jnp.sort(x)[::-1] + jnp.searchsorted(jnp.sort(x), x),
    "tables": lambda x: jnp.interp(x, jnp.linspace(-2.0, 2.0, 9), jnp.arange(9.0) ** 2),
    "matrices": lambda x: jnp.einsum("i,j->ij", x, x) @ x,
    "parts": lambda x: jnp.concatenate([x[1:], x[:1]]).at[2].add(5.0),
    "powers": lambda x: x**3 - 2.0 / (1.0 + x**2) + jnp.abs(x) ** 0.3,
    "choices": lambda x: jnp.where(x > 0.0, jnp.log1p(jnp.abs(x)), jnp.sinh(x)),
    "scans": lambda x: jax.lax.scan(lambda a, b: (a + b, a * b), 0.0, x)[1],
    "loops": lambda x: jax.lax.fori_loop(0, 20, lambda i, y: y + jnp.sin(y) / (i + 1), x),
    "branches": lambda x: jax.lax.cond(x[0] > 0.0, jnp.sin, jnp.cos, x),
    "rows": lambda x: jnp.stack([*jnp.stack([x, 2.0 * x])][::-1], axis=1),
    "slopes of tables": lambda x: jax.vmap(jax.grad(lambda x, at: x[at] ** 3), (0, 0))(
        x[:, None] + jnp.arange(3.0), jnp.searchsorted(jnp.sort(x), x)
    ),
    "slopes": jax.vmap(jax.grad(lambda x: jnp.exp(-(x**2)))),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_operations_are_those_of_xla_at_every_length(name, rng):
    function = FUNCTIONS[name]
    public = entry_point(function)
    for length in (3, 7, 4):
        x = rng.normal(size=length)
        with run_by("numpy"):
            np.testing.assert_allclose(public(x), by_xla(function, x), rtol=1e-13, atol=1e-14)


def test_loops_that_are_mapped_over_end_element_by_element(rng):
    """As many steps as each needs: Newton's for a square root, from far away."""

    def root(x):
        return jax.lax.while_loop(
            lambda y: jnp.abs(y * y - x) > 1e-3 * x, lambda y: 0.5 * (y + x / y), 1e3 * x
        )

    x = np.exp(rng.normal(size=1000, scale=5.0))
    program = traced(jax.vmap(root), ("n0",))
    np.testing.assert_allclose(run(program, [x])[0], by_xla(jax.vmap(root), x), rtol=1e-14)


def test_elements_that_have_ended_leave_a_loop_and_come_back(rng):
    def search(x):
        def advance(at):
            y, moving = at
            new = jnp.where(moving, 0.5 * (y + x / y), y)
            return new, moving & (jnp.abs(new - y) > 1e-12 * new)

        start = 1e3 * x, jnp.ones(x.shape, bool)
        return jax.lax.while_loop(lambda at: jnp.any(at[1]), advance, start)[0]

    x = np.exp(rng.normal(size=3000, scale=8.0))
    np.testing.assert_allclose(run(traced(search, ("n0",)), [x])[0], np.sqrt(x), rtol=1e-15)


def test_a_second_shape_is_not_traced_again():
    count = 0

    @entry_point
    def counted(x):
        nonlocal count
        count += 1
        return jnp.sin(x)

    for shape in ((3,), (5,), (900,)):
        assert counted(np.ones(shape)).shape == shape
    assert count == 1


def test_a_trace_for_single_numbers_serves_arrays_of_them():
    program = traced(lambda x, power, shift: (x + shift) ** power, ("n0",), (), ())
    assert serves_many(program, [False, True, True])
    x = np.linspace(1.0, 2.0, 5)
    np.testing.assert_allclose(run(program, [x, x, -x / 2.0])[0], (x / 2.0) ** x, rtol=1e-15)
    for mixing in (
        lambda x, part: x * jnp.stack([part, 2.0 * part])[1],
        lambda x, part: x + jnp.sum(part * jnp.arange(3.0)),
    ):
        assert not serves_many(traced(mixing, ("n0",), ()), [False, True])


def test_programs_unused_for_longest_make_room(monkeypatch):
    monkeypatch.setattr(entry_points, "_at_hand", entry_points._AtHand())
    monkeypatch.setattr(entry_points, "MOST_STEPS", 8)
    functions = [entry_point(lambda x, n=n: jnp.sin(x) + n * x) for n in range(2, 12)]

    def at_hand():
        traced = [found for one in functions for found in one.runner._traced.values()]
        assert sum(found.program.size for found in traced) <= 8
        return [bool(one.runner._traced) for one in functions]

    for n, function in enumerate(functions, 2):
        for _ in range(2):
            assert function(1.0) == pytest.approx(np.sin(1.0) + n)
    assert at_hand() == [False] * 8 + [True] * 2
    functions[8](1.0)  # used again, so that the other one makes room
    assert functions[0](1.0) == pytest.approx(np.sin(1.0) + 2)
    assert at_hand() == [True] + [False] * 7 + [True, False]
    del functions[8]  # a program whose function is gone is in nobody's way
    gc.collect()
    for function in functions:
        function(1.0)
    assert at_hand() == [False] * 7 + [True] * 2


def test_what_a_backend_lacks_is_named():
    body = Block((0,), (Operation("of_tomorrow", (0,), (1,), {}),), (1,))
    program = Program(body, {}, ((),), ((),), ("float64",))
    with pytest.raises(UnsupportedError, match="of_tomorrow"):
        require_supported(program)


def test_work_that_is_worth_a_compilation_is_compiled(monkeypatch):
    ways = []
    wave = entry_point(lambda x: jnp.sin(x))
    for name in ("_by_numpy", "_by_xla"):
        original = getattr(entry_points._Runner, name)

        def noted(self, *args, name=name, original=original):
            ways.append(name)
            return original(self, *args)

        monkeypatch.setattr(entry_points._Runner, name, noted)
    assert wave(0.5) == pytest.approx(np.sin(0.5), rel=1e-15)
    assert ways == ["_by_numpy"]
    monkeypatch.setattr(entry_points, "COMPILATION", 0.0)
    wave(np.ones(1000))
    assert ways[-1] == "_by_xla"
    with pytest.raises(lf.ParameterError, match="fortran"), run_by("fortran"):
        pass


def test_a_large_table_is_looked_up_without_a_compiler(rng, monkeypatch):
    """Its elements are no work, and places of any number serve one trace."""
    monkeypatch.setattr(entry_points._Runner, "_by_xla", None)  # XLA would fail
    columns = np.arange(4.0)  # as long as one of the numbers of places
    look_up = entry_point(lambda table, columns, at: jnp.sum(table[at.astype(int)] * columns, -1))
    table = rng.random((2_000_000, 4))
    traces = []
    monkeypatch.setattr(entry_points, "trace", lambda *given: traces.append(1) or trace(*given))
    for count in (5, 7, 9):
        places = rng.integers(0, len(table), count)
        expected = table[places] @ columns
        np.testing.assert_allclose(look_up(table, columns, places * 1.0), expected, rtol=1e-12)
    assert len(traces) <= 3  # for all lengths, for the commonest, and for that of the places


def test_a_program_is_data_and_a_flipped_bit_is_seen():
    program = traced(lambda x: jax.lax.fori_loop(0, 3, lambda _, y: y * x, x), ("n0",))
    content = program.to_bytes(b"salt")
    again = Program.from_bytes(content, b"salt")
    assert run(again, [np.array([2.0])])[0] == [16.0]
    for place in (0, 40, len(content) - 5):
        damaged = bytearray(content)
        damaged[place] ^= 1
        with pytest.raises(ValueError, match="damaged"):
            Program.from_bytes(bytes(damaged), b"salt")


def test_whole_numbers_of_numpy_are_written():
    program = traced(lambda x: jnp.roll(x, 1)[jnp.array([2, 0])], (3,))
    operation = program.body.operations[0]
    program = replace(
        program,
        body=program.body._replace(
            operations=(
                operation._replace(parameters={**operation.parameters, "extra": np.int64(3)}),
                *program.body.operations[1:],
            )
        ),
    )
    again = Program.from_bytes(program.to_bytes())
    assert again.body.operations[0].parameters["extra"] == 3


def test_what_cannot_be_written_in_python_is_bound_all_the_same():
    @entry_point
    def sorted_sum(x, y):
        return jnp.sort(jnp.stack([x, y, x * y])), x + y

    bound = bind(sorted_sum, 2.0, example=(0.5,))
    for found, expected in zip(bound(0.25), ([0.25, 0.5, 2.0], 2.25), strict=True):
        np.testing.assert_array_equal(found, expected)


def test_a_package_brings_programs_of_its_own(folder, monkeypatch):
    _answer()
    monkeypatch.setattr(kept, "_SHIPPED", folder)
    monkeypatch.setenv("LIGHTFLYER_CACHE", "off")
    monkeypatch.setattr(entry_points, "trace", None)  # a second trace would fail
    np.testing.assert_array_equal(_answer()["square"], [1.0, 9.0])


def test_lengths_are_arithmetic_and_nothing_else():
    assert length_of("max(n0, 2*n1 - 1)", {"n0": 3, "n1": 5}) == 9
    with pytest.raises((ValueError, KeyError)):
        length_of("__import__('os')", {})


def _square(x):
    return {"square": x**2, "pair": (x, 1.0)}


_square.__module__ = "lightflyer.here"  # as if it were the package's


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("LIGHTFLYER_CACHE", str(tmp_path))
    return tmp_path / "programs"


def _answer():
    return entry_point(_square)(np.array([1.0, 3.0]))


def test_a_later_process_reads_what_was_traced(folder, monkeypatch):
    first = _answer()
    (path,) = folder.glob("*.program")
    assert folder.stat().st_mode & 0o077 == 0
    monkeypatch.setattr(entry_points, "trace", None)  # a second trace would fail
    again = _answer()
    np.testing.assert_array_equal(again["square"], first["square"])
    assert again["pair"][1] == 1.0
    monkeypatch.undo()
    path.write_bytes(path.read_bytes()[:-3] + b"abc")  # and a damaged one is traced anew
    np.testing.assert_array_equal(_answer()["square"], [1.0, 9.0])


def test_what_others_can_write_is_not_read(folder, monkeypatch):
    _answer()
    folder.chmod(0o777)
    monkeypatch.setattr(kept.Program, "from_bytes", None)  # reading would fail
    np.testing.assert_array_equal(_answer()["square"], [1.0, 9.0])


def test_a_change_of_the_package_is_another_program(folder, monkeypatch):
    _answer()
    monkeypatch.setattr(kept, "sources", lambda: b"after an upgrade")
    _answer()
    assert len(list(folder.glob("*.program"))) == 2


class Elsewhere(eqx.Module):
    number: jax.Array


def _halved(x, gas=lf.gas.US1976_AIR):
    return 0.5 * x * gas.specific_gas_constant


_halved.__module__ = "lightflyer.here"


def test_a_default_is_part_of_what_is_kept(folder, monkeypatch):
    one = entry_point(_halved)(1.0)
    (path,) = folder.glob("*.program")
    monkeypatch.setattr(_halved, "__defaults__", (lf.gas.HELIUM,))
    assert entry_point(_halved)(1.0) > 2.0 * one
    assert {*folder.glob("*.program")} > {path}


def test_code_that_is_not_the_packages_is_never_kept(folder):
    entry_point(lambda x: x + 1.0)(1.0)

    def power(x, n=3):
        return x * power(x, n - 1) if n else x

    assert entry_point(power)(2.0) == 16.0

    def method(one):
        return one.number

    method.__module__ = method.__qualname__ = "lightflyer"
    entry_point(method)(Elsewhere(np.ones(2)))
    assert not folder.exists()


def test_what_a_function_carries_is_never_kept(folder):
    class Scale:
        def __init__(self, factor):
            self.factor = factor

        def scaled(self, x):
            return self.factor * x

    Scale.scaled.__qualname__, Scale.scaled.__module__ = "Scale.scaled", "lightflyer"
    for factor in (2.0, 3.0):
        method = Scale(factor).scaled
        assert entry_point(method)(1.0) == factor
        wrapper = wraps(method)(lambda x, method=method: method(x))
        inside = wraps(method)(partial(_call, method))
        assert entry_point(wrapper)(1.0) == entry_point(inside)(1.0) == factor
    assert not folder.exists()


def _call(function, x):
    return function(x)


def test_the_least_used_go_first(folder, monkeypatch):
    _answer()
    (old,) = folder.glob("*.program")
    monkeypatch.setattr(kept, "LARGEST", int(1.5 * old.stat().st_size))
    entry_point(_square)(np.ones((2, 3)))
    (left,) = folder.glob("*.program")
    assert left != old


@pytest.mark.slow
@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("size", [1, 2, 3, 8, 9, 100])
def test_tables_are_searched_as_numpy_does(rng, side, size):
    """JAX before 0.12 writes the search out by itself."""
    nodes = np.sort(rng.integers(0, 20, size).astype(float))
    values = np.concatenate([rng.uniform(-2.0, 22.0, 50), nodes, [np.nan, np.inf, -np.inf]])
    with lf.float64():
        found = tracing._search_sorted(jnp.asarray(nodes), jnp.asarray(values), side)
        total = tracing._horner(jnp.asarray(values[:50]), *map(jnp.asarray, nodes))
    np.testing.assert_array_equal(found, np.searchsorted(nodes, values, side))
    np.testing.assert_allclose(total, np.polynomial.polynomial.polyval(values[:50], nodes))
