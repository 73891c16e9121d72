"""Limits of the transfer matrix; `tmm` is compared with in `test_samples` and tests/validation."""

import jax
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.film import Film, Layer, stack_optics

from .conftest import flat


def test_an_opaque_metal_reflects_as_its_surface():
    """Whatever lies below."""
    n, k = 1.26, 7.19
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
