"""Laws of mixtures against exact results, bounds, and another package."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.film import Rule, bruggeman
from lightflyer.film.media.compound import Shape, maxwell_garnett, parallel, series

PYELLI = [  # host, inclusion, fraction; Bruggeman's and Maxwell Garnett's index by pyElli 0.23.1
    (1.0, 4.2 + 2.1j, 0.30, 1.7281121650250268 + 0.30772343070963626j,
     1.4605186616116848 + 0.05698520429158228j),
    (1.5, 0.2 + 3.4j, 0.25, 1.6168748514875064 + 0.998396885111684j,
     2.909147710633735 + 0.19239284946355145j),
    (1.5, 0.2 + 3.4j, 0.60, 0.9122675141511151 + 1.721879808234824j,
     1.6715890569612415 + 6.048874237652395j),
    (1.0, 1.45, 0.50, 1.2181994117026138, 1.2106531700717829),
]  # fmt: skip


def parts(*index):
    index = np.array(index, complex)
    return index.real, index.imag


def permittivity(law, index, fraction, *factor):
    n, k = law(*parts(*index), np.asarray(fraction, float), *factor)
    return (n + 1j * k) ** 2


@pytest.mark.parametrize(("host", "inclusion", "fraction", "symmetric", "separate"), PYELLI)
def test_laws_agree_with_pyelli(host, inclusion, fraction, symmetric, separate):
    index, fractions = (host, inclusion), (1.0 - fraction, fraction)
    for law, expected in ((bruggeman, symmetric), (maxwell_garnett, separate)):
        found = np.sqrt(permittivity(law, index, fractions))
        assert found == pytest.approx(expected, rel=1e-12)


def test_columns_in_equal_parts_are_the_geometric_mean():
    """Exact in two dimensions for any symmetric arrangement (Dykhne, Keller), with losses too."""
    first, second = 0.3 + 3.0j, 2.0 + 0.01j
    found = permittivity(bruggeman, (first, second), (0.5, 0.5), 0.5)
    assert found == pytest.approx((first * second), rel=1e-13)


def test_lossless_mixtures_are_within_the_bounds():
    """Maxwell Garnett's law is the bound of Hashin and Shtrikman, within those of Wiener."""
    for fraction in (0.1, 0.5, 0.9):
        fractions, low, high = np.array([1.0 - fraction, fraction]), 1.0, 16.0
        lower = low + fraction / (1.0 / (high - low) + (1.0 - fraction) / (3.0 * low))
        upper = high + (1.0 - fraction) / (1.0 / (low - high) + fraction / (3.0 * high))
        host_low = permittivity(maxwell_garnett, (1.0, 4.0), fractions).real
        host_high = permittivity(maxwell_garnett, (4.0, 1.0), fractions[::-1]).real
        np.testing.assert_allclose((host_low, host_high), (lower, upper), rtol=1e-12)
        between = permittivity(bruggeman, (1.0, 4.0), fractions).real
        wiener = (permittivity(law, (1.0, 4.0), fractions).real for law in (series, parallel))
        least, most = wiener
        assert least < lower < between < upper < most
        assert least == pytest.approx(1.0 / ((1.0 - fraction) / low + fraction / high), rel=1e-12)
        assert most == pytest.approx((1.0 - fraction) * low + fraction * high, rel=1e-12)


@pytest.mark.parametrize("shape", Shape)
def test_few_inclusions_add_their_polarisability(shape):
    """To first order: sphere 3(ε-1)/(ε+2), needle (ε-1)/3 + 4(ε-1)/(3(ε+1)), and so on."""
    inclusion, few = 3.0 + 2.0j, 1e-6
    more = inclusion**2 - 1.0
    across = 2.0 * more / (more + 2.0)
    expected = {
        Shape.SPHERES: 3.0 * more / (more + 3.0),
        Shape.COLUMNS: across,
        Shape.NEEDLES: (more + 2.0 * across) / 3.0,
        Shape.MAT: (more + across) / 2.0,
    }[shape]
    found = permittivity(
        maxwell_garnett, (1.0, inclusion), (1.0 - few, few), np.array(shape.factors)
    )
    assert (found - 1.0) / few == pytest.approx(expected, rel=1e-4)


def test_many_needles_by_complex_arithmetic():
    """Sum over orientations as in the review of Markel (2016), in plain complex numbers."""
    share, more = 0.25, (3.0 + 2.0j) ** 2 - 1.0
    moment = [more / (1.0 + factor * more) for factor in (0.0, 0.5, 0.5)]
    back = np.mean([0.0, 0.5, 0.5] * np.array(moment))
    expected = 1.0 + share * np.mean(moment) / (1.0 - share * back)
    found = permittivity(
        maxwell_garnett, (1.0, 3.0 + 2.0j), (0.75, 0.25), np.array(Shape.NEEDLES.factors)
    )
    assert found == pytest.approx(expected, rel=1e-12)


def test_three_parts_solve_the_equation_between_their_directions(rng):
    """What is unique: a root whose direction lies between those of the parts."""
    n, k = rng.uniform(0.05, 5.0, (3, 4000)), 10.0 ** rng.uniform(-4.0, 1.5, (3, 4000))
    fraction = rng.dirichlet(np.ones(3), 4000).T
    found = (
        np.add(
            *(part * unit for part, unit in zip(bruggeman(n, k, fraction), (1, 1j), strict=True))
        )
        ** 2
    )
    each = (n + 1j * k) ** 2
    assert np.abs((fraction * (each - found) / (each + 2.0 * found)).sum(axis=0)).max() < 1e-12
    angle = np.angle(each)
    assert np.all(np.angle(found) > angle.min(axis=0) - 1e-9)
    assert np.all(np.angle(found) < angle.max(axis=0) + 1e-9)


@pytest.mark.parametrize("others", [(1.0,), (1.0, 1.45)])
def test_the_branch_cannot_jump(others):
    """From no silver to silver only, nearly without loss, where roots are near each other."""
    share = np.linspace(0.0, 1.0, 4001)
    fractions = np.stack([share, *[(1.0 - share) / len(others)] * len(others)])
    n, k = (part[:, None] * np.ones_like(share) for part in parts(0.05 + 4.0j, *others))
    n, k = bruggeman(n, k, fractions)
    assert np.all(k >= 0.0)
    assert np.abs(np.diff(n + 1j * k)).max() < 0.05
    np.testing.assert_allclose((n[-1], k[-1]), (0.05, 4.0), rtol=1e-9)


def mixed_by_all_laws(share):
    """Index by each law, of two and of three parts, over the share moved to the first part."""
    found = []
    for others in ((1.0,), (1.0, 1.45 + 0.1j)):
        n, k = parts(3.0 + 1.5j, *others)
        fraction = np.ones(n.size) / n.size + share * (np.eye(n.size)[0] - np.eye(n.size)[1])
        found += [value for rule in Rule for value in rule.law(n, k, fraction, 0.4)]
    return jnp.stack(found)


def bruggeman_of_three(share):
    n, k = parts(3.0 + 1.5j, 1.0, 1.45 + 0.1j)
    return jnp.stack(bruggeman(n, k, jnp.array([0.3 + share, 0.3 - share, 0.4])))


def test_laws_are_differentiable(compiled):
    """In reverse, and by all laws; the eigenvalue of three parts twice."""
    with lf.float64():
        low, high = (np.array(mixed_by_all_laws(0.1 + step)) for step in (-1e-4, 1e-4))
        first = compiled(jax.jacrev(mixed_by_all_laws))(0.1)
        np.testing.assert_allclose(first, (high - low) / 2e-4, rtol=1e-6)
        low, middle, high = (np.array(bruggeman_of_three(step)) for step in (-1e-3, 0.0, 1e-3))
        second = compiled(jax.jacfwd(jax.jacfwd(bruggeman_of_three)))(0.0)
        np.testing.assert_allclose(second, (high - 2.0 * middle + low) / 1e-6, rtol=1e-4)
