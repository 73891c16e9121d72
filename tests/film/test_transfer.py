"""Limits and identities of the transfer matrix; `tmm` is compared with in tests/validation."""

import jax
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.film import Film, Layer, stack_optics

from .conftest import flat


def test_lossless_layers_absorb_nothing(rng):
    n, d = rng.uniform(0.3, 5.0, 4), 10.0 ** rng.uniform(-9.0, -5.5, 4)
    optics = stack_optics(n, np.zeros(4), d, 6e-7, 0.7)
    assert np.abs(optics.layer_absorptance).max() < 1e-13


def test_nothing_reflects_where_there_is_nothing():
    optics = stack_optics(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 1)), np.ones(3), 0.3)
    np.testing.assert_array_equal(optics.reflectance, np.zeros((2, 3)))
    np.testing.assert_allclose(optics.transmittance, np.ones((2, 3)), rtol=1e-15)
    vacuum = stack_optics([1.0], [0.0], [1e-6], 5e-7, 1.2)
    np.testing.assert_allclose(vacuum.reflectance, 0.0, atol=1e-28)


@pytest.mark.parametrize(
    ("n", "k", "d"), [(1.7, 0.0, 0.83e-6), (1.46, 0.0, 1e-7), (4.3, 0.6, 272e-9)]
)
@pytest.mark.parametrize("incidence", [0.0, 0.6, 1.4])
def test_one_layer_is_an_etalon(n, k, d, incidence):
    """Airy's formula, with Fresnel's coefficients written out."""
    index, wavelength = n + 1j * k, np.linspace(0.4e-6, 2e-6, 50)
    inside = np.sqrt(1.0 - (np.sin(incidence) / index) ** 2)
    outside = np.cos(incidence)
    s = (outside - index * inside) / (outside + index * inside)
    p = (index * outside - inside) / (index * outside + inside)
    first = np.array([s, p])[:, None]
    phase = np.exp(2j * np.pi * index * d * inside / wavelength)
    below = 1.0 - first**2 * phase**2
    optics = stack_optics([[n]], [[k]], [[d]], wavelength, incidence)
    passed = np.abs((1.0 - first**2) * phase / below) ** 2
    np.testing.assert_allclose(optics.transmittance, passed, rtol=1e-12)
    reflected = np.abs(first * (1.0 - phase**2) / below) ** 2
    np.testing.assert_allclose(optics.reflectance, reflected, rtol=1e-9, atol=1e-13)
    assert k == 0.0 or np.all(optics.reflectance + optics.transmittance < 1.0)


@pytest.mark.parametrize(("n", "k"), [(1.26, 7.19), (3.5, 2.7)])
def test_an_opaque_metal_reflects_as_its_surface(n, k):
    """Whatever lies below."""
    surface = abs((1.0 - (n + 1j * k)) / (1.0 + (n + 1j * k))) ** 2
    for layers in (([n], [k], [1e-3]), ([n, 1.45, n], [k, 0.0, k], [1e-4, 1e-6, 1e-4])):
        optics = stack_optics(*layers, 6e-7)
        np.testing.assert_allclose(optics.reflectance, surface, rtol=1e-13)
        np.testing.assert_array_equal(optics.transmittance, 0.0)
        np.testing.assert_allclose(optics.absorptance, 1.0 - surface, rtol=1e-12)


def test_thick_and_opaque_layers_stay_finite_with_their_gradients():
    def absorbed(thickness):
        optics = stack_optics([1.3, 3.0, 1.3], [7.0, 0.5, 20.0], thickness, 5e-7, 1.5)
        return optics.layer_absorptance[1].sum() + optics.reflectance.sum()

    thickness = np.array([1e-2, 1e2, 1e4])
    with lf.float64():
        assert np.isfinite(absorbed(thickness))
        assert np.all(np.isfinite(jax.grad(absorbed)(thickness)))


def test_total_reflection_inside_a_layer():
    """A layer of n < sin(incidence) reflects all light when thick, and tunnels when thin."""
    thick = stack_optics([0.5], [0.0], [1e-4], 5e-7, 1.2)
    np.testing.assert_allclose(thick.reflectance, 1.0, rtol=1e-13)
    thin = stack_optics([0.5], [0.0], [1e-9], 5e-7, 1.2)
    assert np.all(thin.transmittance > 0.9)


def test_a_film_takes_light_from_either_side():
    film = Film((Layer(flat(2.0, 0.0, name="a"), 1e-7), Layer(flat(3.0, 1.0, name="b"), 5e-8)))
    wavelength, incidence = np.array([5e-7, 6e-7]), np.array([[0.0], [0.5], [1.0]])
    below = film.optics(wavelength, incidence, side="bottom")
    assert below.layer_absorptance.shape == (2, 2, 3, 2)
    direct = stack_optics([3.0, 2.0], [1.0, 0.0], [5e-8, 1e-7], 6e-7, 0.5)
    np.testing.assert_allclose(below.reflectance[:, 1, 1], direct.reflectance, rtol=1e-13)


def test_areal_density_adds_up():
    film = Film(
        (Layer(flat(2.0, 0.0, 2000.0, name="a"), 1e-7), Layer(flat(2.0, 0.0, name="b"), 5e-7))
    )
    assert film.areal_density == pytest.approx(7e-4, rel=1e-14)
    with pytest.raises(lf.ParameterError, match="density of b is unknown"):
        _ = Film((Layer(flat(2.0, 0.0, None, name="b"), 5e-7),)).areal_density


@pytest.mark.parametrize("thickness", [0.0, -1e-9, np.nan])
def test_a_thickness_must_be_positive(thickness):
    with pytest.raises(lf.ParameterError, match=r"thickness of a = .* is not positive"):
        Layer(flat(2.0, 0.0, name="a"), thickness)


def test_light_cannot_come_from_beyond_grazing():
    film = Film((Layer(flat(2.0, 0.0, name="a"), 1e-7),))
    with pytest.raises(lf.ParameterError, match="incidence"):
        film.optics(5e-7, np.pi / 2)
