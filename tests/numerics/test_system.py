"""Coupled heat balances beside SciPy and nested bisection, derivatives, and how searches end."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import brentq, root

import lightflyer as lf
from lightflyer.array.namespace import by_numpy
from lightflyer.array.transformations import compiled
from lightflyer.numerics.rootfind import SolverStatus
from lightflyer.numerics.system import solve_linear, solve_system

COUNT = 200


class Nodes(NamedTuple):
    """Bodies that radiate, lose heat to a gas and conduct to each other; rows are bodies."""

    gas: np.ndarray
    radiation: np.ndarray
    conduction: np.ndarray
    power: np.ndarray


def growth(excess):
    """The fourth power of one plus the excess, less one."""
    return excess * (4.0 + excess * (6.0 + excess * (4.0 + excess)))


def losses(nodes, excess):
    """Heat lost by each body; body i conducts to body i + 1, the last of three to the first."""
    lost = [a * x + b * growth(x) for a, b, x in zip(*nodes[:2], excess, strict=True)]
    for link, conductance in enumerate(nodes.conduction):
        other = (link + 1) % len(excess)
        flow = conductance * (excess[link] - excess[other])
        lost[link] += flow
        lost[other] -= flow
    return lost


def residual(nodes):
    """Imbalance of each body over what it absorbs."""

    def imbalance(excess):
        lost = losses(nodes, excess)
        return tuple(a / power - 1.0 for a, power in zip(lost, nodes.power, strict=True))

    return imbalance


def hottest(nodes):
    """Excess if the body that radiates least had all the power and no gas."""
    ratio = np.sum(nodes.power, axis=0) / np.min(nodes.radiation, axis=0)
    return ratio / ((1.0 + ratio) ** 0.25 + 1.0) / ((1.0 + ratio) ** 0.5 + 1.0)


def designs(bodies, links, conductance, seed=1, count=COUNT):
    """Random bodies; gas from nothing to far more than radiation, powers 1e4 apart."""
    generator = np.random.default_rng(seed)

    def spread(rows, lowest, highest):
        return np.exp(generator.uniform(np.log(lowest), np.log(highest), (rows, count)))

    return Nodes(
        spread(bodies, 1e-9, 1e3),
        spread(bodies, 1e-2, 10.0),
        spread(links, *conductance),
        spread(bodies, 1e-2, 1e2),
    )


def guess_from_vacuum(nodes):
    return (hottest(nodes),) * len(nodes.power)


def guess_from_nothing(nodes):
    return tuple(np.zeros_like(nodes.power))


def guess_by_chance(nodes):
    # where guesses are 1e8 apart, differences no longer see what the smaller one does
    return tuple(10.0 ** np.random.default_rng(2).uniform(-3, 3, nodes.power.shape))


def solve(nodes, guess):
    rows = tuple(map(tuple, nodes))  # the first axis is the element
    return solve_system(lambda u, rows: residual(Nodes(*rows))(u), guess, (rows,), lower=-1.0)


by_xla = compiled(solve)


def find(nodes, guess=None):
    """By NumPy, where elements that have ended are left out, and by JAX: the same."""
    guess = tuple(guess_from_vacuum(nodes) if guess is None else guess)
    with by_numpy():
        excess, outcome = solve(nodes, guess)
    traced, ending = by_xla(nodes, guess)
    good = np.asarray(outcome.converged)
    assert np.mean(good == ending.converged) > 0.999
    both = good & ending.converged
    np.testing.assert_allclose(
        np.array(excess)[:, both], np.array(traced)[:, both], rtol=1e-6, atol=1e-14
    )
    return np.array(excess), outcome


def of_one(nodes, one):
    """One design out of many."""
    return Nodes(*(row[:, one] for row in nodes))


def increasing_root(function, highest):
    return brentq(function, 0.0, highest, xtol=1e-300, rtol=1e-15, maxiter=1000)


def chain_by_bisection(nodes):
    """Excesses of one chain of bodies around body 1: each outer body is found for its sake.

    What a link carries is taken from its smaller term, so that nothing cancels.
    """
    gas, radiation, links, power = nodes
    highest = 2.0 * hottest(nodes)

    def lost(body, excess):
        return gas[body] * excess + radiation[body] * growth(excess)

    def outer(body, link, middle):
        return increasing_root(lambda x: lost(body, x) + link * (x - middle) - power[body], highest)

    def into_middle(body, link, middle):
        excess = outer(body, link, middle)
        if link * highest < lost(body, highest):
            return link * (excess - middle)
        return power[body] - lost(body, excess)

    bodies = [body for body in range(len(power)) if body != 1]

    def imbalance(middle):
        given = sum(
            into_middle(body, link, middle) for body, link in zip(bodies, links, strict=True)
        )
        return lost(1, middle) - given - power[1]

    middle = increasing_root(imbalance, highest)
    found = [outer(body, link, middle) for body, link in zip(bodies, links, strict=True)]
    return [found[0], middle, *found[1:]]


@pytest.mark.parametrize("conductance", [(1e-6, 1.0), (1.0, 1e6)])
@pytest.mark.parametrize("bodies", [2, 3])
def test_chains_of_bodies_agree_with_nested_bisection(bodies, conductance):
    nodes = designs(bodies, bodies - 1, conductance)
    found, outcome = find(nodes)
    assert np.all(outcome.status == SolverStatus.CONVERGED)
    expected = [chain_by_bisection(of_one(nodes, one)) for one in range(COUNT)]
    np.testing.assert_allclose(found, np.transpose(expected), rtol=2e-10)


@pytest.mark.parametrize("first", [guess_from_vacuum, guess_from_nothing, guess_by_chance])
@pytest.mark.parametrize("bodies", [2, 3])
def test_every_design_converges_to_its_one_root_from_anywhere(bodies, first):
    nodes = designs(bodies, bodies if bodies == 3 else 1, (1e-6, 1e3), count=2000)
    found, outcome = find(nodes, first(nodes))
    assert np.all(outcome.converged)
    assert np.all(found > 0.0)
    np.testing.assert_allclose(found, find(nodes)[0], rtol=1e-9)
    np.testing.assert_allclose(np.sum(losses(nodes, found), 0), np.sum(nodes.power, 0), rtol=1e-9)
    # rounding of what a link carries is up to 1e-16 * 1e3 * 1e2 / 1e-2
    assert np.max(np.abs(residual(nodes)(found))) < 1e-8


def test_rings_of_three_bodies_agree_with_scipy():
    nodes = designs(3, 3, (1e-3, 1e3))
    found, _ = find(nodes)
    compared = 0
    for one in range(COUNT):
        case = of_one(nodes, one)
        peer = root(residual(case), np.full(3, 0.5 * hottest(case)), tol=1e-13)
        if np.max(np.abs(peer.fun)) < 1e-11 and np.all(peer.x > -1.0):
            compared += 1
            np.testing.assert_allclose(found[:, one], peer.x, rtol=1e-8)
    assert compared > 0.8 * COUNT


@pytest.mark.parametrize("bodies", [2, 3])
def test_strong_links_make_one_body_of_all(bodies):
    """Coefficients 1e12 apart: the bodies are as warm as one with the sum of everything."""
    nodes = designs(bodies, bodies - 1, (1.0, 1.0))
    nodes = nodes._replace(
        gas=np.maximum(nodes.gas, 1e-3), conduction=np.full_like(nodes.conduction, 1e9)
    )
    found, outcome = find(nodes)
    assert np.all(outcome.converged)
    gas, radiation, _, power = (np.sum(row, axis=0) for row in nodes)
    together = [
        increasing_root(lambda x, a=a, b=b, p=p: a * x + b * growth(x) - p, 2.0 * high)
        for a, b, p, high in zip(gas, radiation, power, hottest(nodes), strict=True)
    ]
    np.testing.assert_allclose(found, np.broadcast_to(together, found.shape), rtol=1e-5)
    unlinked = nodes._replace(conduction=0.0 * nodes.conduction)
    np.testing.assert_allclose(np.sum(losses(unlinked, found), axis=0), power, rtol=1e-11)


def test_without_links_each_body_is_by_itself():
    nodes = designs(2, 1, (1e-30, 1e-30))
    found, _ = find(nodes)
    for body in range(2):
        expected = [
            increasing_root(lambda x, a=a, b=b, p=p: a * x + b * growth(x) - p, 1e3)
            for a, b, p in zip(*(row[body] for row in (*nodes[:2], nodes.power)), strict=True)
        ]
        np.testing.assert_allclose(found[body], expected, rtol=1e-12)


def test_microkelvin_differences_are_those_of_the_linear_network():
    nodes = designs(3, 3, (1e-2, 1e2))
    nodes = nodes._replace(power=1e-12 * nodes.power)
    found, outcome = find(nodes)
    assert np.all(outcome.converged)
    matrix = np.zeros((COUNT, 3, 3))
    for body in range(3):
        following = (body + 1) % 3
        matrix[:, body, body] += nodes.gas[body] + 4.0 * nodes.radiation[body]
        for one, other in ((body, following), (following, body)):
            matrix[:, one, one] += nodes.conduction[body]
            matrix[:, one, other] -= nodes.conduction[body]
    expected = np.linalg.solve(matrix, nodes.power.T[..., None])[..., 0].T
    assert np.all(expected < 1e-7)
    # radiation's second order is 1.5 times the excess
    np.testing.assert_allclose(found, expected, rtol=2e-7)
    linear = find(nodes._replace(gas=nodes.gas + 4.0 * nodes.radiation, radiation=0.0 * nodes.gas),
                  tuple(expected * 2.0))[0]  # fmt: skip
    np.testing.assert_allclose(np.diff(linear, axis=0), np.diff(expected, axis=0), rtol=1e-10)


@pytest.mark.parametrize("first", [guess_from_vacuum, guess_by_chance])
def test_a_body_that_hardly_matters_to_the_residual_is_accurate(first):
    """Both bodies' imbalances over the power of all, of which one has a 1e-9th."""
    nodes = designs(2, 1, (1e-9, 1e-9), count=2000)
    nodes.power[1] *= 1e-9
    nodes.power[0] = 1.0

    def of_total(excess, rows):
        lost, power = losses(Nodes(*rows), excess), rows[-1]
        return tuple((a - b) for a, b in zip(lost, power, strict=True))

    rows = tuple(map(tuple, nodes))
    with by_numpy():
        found, outcome = solve_system(of_total, first(nodes), (rows,), lower=-1.0)
    assert np.all(outcome.converged)
    np.testing.assert_allclose(found, find(nodes)[0], rtol=1e-6)


def scalar_case():
    """One design of two bodies, of order one throughout, as a flat list of numbers."""
    return [0.3, 2.0, 0.5, 1.2, 0.7, 3.0, 1.0]


def excesses_of(numbers):
    numbers = jnp.asarray(numbers)
    nodes = Nodes(numbers[0:2], numbers[2:4], numbers[4:5], numbers[5:7])
    return jnp.stack(solve_system(residual(nodes), (1.0, 1.0), lower=-1.0)[0])


def central_differences(function, numbers, step):
    rows = []
    for index in range(len(numbers)):
        ends = [np.array(numbers), np.array(numbers)]
        ends[0][index] -= step
        ends[1][index] += step
        rows.append((np.asarray(function(ends[1])) - np.asarray(function(ends[0]))) / (2 * step))
    return np.moveaxis(np.array(rows), 0, -1)


def test_derivatives_are_those_of_finite_differences(compiled):
    numbers = scalar_case()
    with lf.float64():
        forward = compiled(jax.jacfwd(excesses_of))(jnp.array(numbers))
        reverse = compiled(jax.jacrev(excesses_of))(jnp.array(numbers))
        expected = central_differences(compiled(excesses_of), numbers, 1e-5)
    np.testing.assert_allclose(forward, expected, rtol=1e-8)
    np.testing.assert_allclose(reverse, forward, rtol=1e-13)


def test_second_derivatives_are_those_of_finite_differences(compiled):
    numbers = scalar_case()
    with lf.float64():
        first = compiled(jax.jacfwd(excesses_of))
        expected = central_differences(first, numbers, 1e-5)
        second = compiled(jax.hessian(excesses_of))(jnp.array(numbers))
    np.testing.assert_allclose(second, expected, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(second, np.swapaxes(second, 1, 2), rtol=1e-12)


def test_gradients_of_a_batch_stay_with_their_elements(compiled):
    nodes = designs(3, 2, (1e-3, 1e3), count=20)

    def summed(nodes):
        excess = solve_system(residual(nodes), (10.0,) * 3, lower=-1.0)[0]
        return sum(jnp.sum(entry) for entry in excess)

    with lf.float64():
        inputs = jax.tree.map(jnp.asarray, nodes)
        together = compiled(jax.grad(summed))(inputs)
        poisoned = jax.tree.map(lambda row: row.at[:, 7].set(jnp.nan), inputs)
        beside_nan = compiled(jax.grad(summed))(poisoned)
    for whole, damaged in zip(together, beside_nan, strict=True):
        assert np.all(np.isnan(damaged[:, 7]))
        keep = np.arange(20) != 7
        np.testing.assert_allclose(np.asarray(damaged)[:, keep], np.asarray(whole)[:, keep])


def test_vmap_and_shapes(compiled):
    """Bodies of shape (5,) and powers of shape (4, 1) give excesses of shape (4, 5)."""
    nodes = designs(2, 1, (1e-3, 1e3), count=5)
    powers = np.array([[1.0, 2.0, 5.0, 10.0], [3.0, 1.0, 1.0, 0.5]])

    def of_power(power):
        return solve_system(residual(nodes._replace(power=power)), (1.0, 1.0), lower=-1.0)

    with lf.float64():
        plain, outcome = of_power(jnp.asarray(powers)[:, :, None])
        mapped, statuses = compiled(jax.vmap(of_power, in_axes=1))(jnp.asarray(powers))
    assert plain[0].shape == mapped[0].shape == outcome.status.shape == (4, 5)
    np.testing.assert_allclose(mapped, plain, rtol=1e-13)
    np.testing.assert_array_equal(statuses.status, outcome.status)


def test_elements_do_not_see_their_neighbours():
    nodes = designs(2, 1, (1e-3, 1e6), count=60)
    together, _ = find(nodes)
    order = np.random.default_rng(3).permutation(60)
    shuffled, _ = find(jax.tree.map(lambda row: row[:, order], nodes))
    np.testing.assert_array_equal(shuffled, together[:, order])
    alone = [find(jax.tree.map(lambda row, one=one: row[:, one : one + 1], nodes))[0]
             for one in range(3)]  # fmt: skip
    np.testing.assert_allclose(np.hstack(alone), together[:, :3], rtol=1e-15)
    # a neighbour that keeps the loop busy, one that has no root and one that is not a number
    troubled = jax.tree.map(np.copy, nodes)
    troubled.power[:, 0] = np.nan
    troubled.power[0, 1] = -1e3
    guess = np.array(guess_from_vacuum(nodes))
    guess[:, 2] = 1e9
    beside, outcome = find(troubled, tuple(guess))
    np.testing.assert_array_equal(beside[:, 3:], together[:, 3:])
    np.testing.assert_array_equal(
        outcome.status[:2], [SolverStatus.NOT_FINITE, SolverStatus.STALLED]
    )
    assert np.all(outcome.converged[2:])


def status_of(equations, guess, **options):
    with by_numpy():
        found, outcome = solve_system(equations, guess, **options)
    return SolverStatus(int(outcome.status)), [float(entry) for entry in found]


def test_no_root_is_a_reason():
    """A loss that saturates below the power; unknowns that would have to leave their bounds."""
    status, _ = status_of(lambda u: (np.arctan(u[0]) - 2.0, u[1] - u[0]), (1.0, 1.0))
    assert status in (SolverStatus.STALLED, SolverStatus.SINGULAR)
    status, found = status_of(lambda u: (u[0] + 3.0, u[1] - u[0]), (1.0, 1.0), lower=-1.0)
    assert status is SolverStatus.STALLED
    assert min(found) >= -1.0


def test_dependent_equations_are_a_reason():
    status, found = status_of(lambda u: (u[0] + u[1], u[0] + u[1] - 1.0), (3.0, 2.0))
    assert status is SolverStatus.SINGULAR
    assert found == [3.0, 2.0]


def test_the_limit_of_steps_is_a_reason():
    equations = (lambda u: (u[0] ** 9 - 1.0, u[1] - u[0]), (1e2, 1.0))
    assert status_of(*equations, maximum_steps=3)[0] is SolverStatus.STEP_LIMIT
    assert status_of(*equations)[0] is SolverStatus.CONVERGED


@pytest.mark.parametrize("place", ["gas", "radiation", "conduction", "power", "guess"])
def test_what_is_not_a_number_is_flagged(place):
    nodes = designs(2, 1, (1e-3, 1e3), count=3)
    guess = np.array(guess_from_vacuum(nodes))
    (guess if place == "guess" else getattr(nodes, place))[0, 1] = np.nan
    found, outcome = find(nodes, tuple(guess))
    if place == "guess":  # no reason to fail: another point will do
        assert np.all(outcome.converged)
    else:
        expected = [SolverStatus.CONVERGED, SolverStatus.NOT_FINITE, SolverStatus.CONVERGED]
        np.testing.assert_array_equal(outcome.status, expected)
    assert np.all(np.isfinite(found[:, [0, 2]]))


@pytest.mark.parametrize(
    ("equations", "guess", "expected"),
    [
        (lambda u: (np.arctan(u[0] - u[1]), u[1] - 0.3), (9.0, 1.0), (0.3, 0.3)),
        (lambda u: (np.expm1(u[0]), u[1] - u[0]), (-20.0, 1.0), (0.0, 0.0)),
        (lambda u: (10.0 * (u[1] - u[0] ** 2), 1.0 - u[0]), (-1.2, 1.0), (1.0, 1.0)),
        (lambda u: (u[0] - 1e6, u[0] * u[1] - 2.0), (1.0, 1.0), (1e6, 2e-6)),
    ],
)
def test_where_newton_alone_goes_astray(equations, guess, expected):
    status, found = status_of(equations, guess)
    assert status is SolverStatus.CONVERGED
    assert found == pytest.approx(expected, rel=1e-11, abs=1e-11)


def test_as_many_equations_as_unknowns():
    with pytest.raises(ValueError, match="2 unknowns need as many"), lf.float64():
        solve_system(lambda u: (u[0] - 1.0,), (1.0, 1.0))


@pytest.mark.parametrize("size", range(1, 7))
def test_small_matrices_are_solved_as_lapack_does(size):
    generator = np.random.default_rng(size)
    matrix = generator.normal(size=(size, size, 500))
    matrix[0, 0, :100] = 0.0  # without pivoting there would be a division by zero
    vector = generator.normal(size=(size, 500))
    if size == 1:
        matrix = matrix + 3.0
    with lf.float64():
        found = np.array(solve_linear(jnp.asarray(matrix), jnp.asarray(vector)))
    square = np.moveaxis(matrix, -1, 0)
    expected = np.linalg.solve(square, vector.T[..., None])[..., 0].T
    error = np.max(np.abs(found - expected), axis=0) / np.max(np.abs(expected), axis=0)
    assert np.max(error / np.linalg.cond(square)) < 1e-15


def test_an_excess_far_below_rounding_of_its_temperature_is_no_singular_system():
    """As between two films of which one hardly warms: the search begins at 1e-12."""

    found, outcome = solve_system(
        lambda at: ((1.0 + at[0]) ** 4 - (1.0 + at[1]) ** 4 - 0.5, 1e9 * at[1] - 1e-3),
        (1e-12, 1e-12),
        lower=(-1.0, -1.0),
    )
    assert outcome.converged
    np.testing.assert_allclose(found[0], 1.5**0.25 - 1.0, rtol=1e-9)
