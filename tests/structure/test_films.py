"""Films of layers: Stoney, Timoshenko, equilibrium, and Freund's roll of a disk."""

import numpy as np
import pytest
from scipy.optimize import minimize

import lightflyer as lf
from lightflyer.structure import (
    Lamina,
    Laminate,
    critical_curvature,
    curl_of_film,
    flat_load,
    free_curvature,
    free_strain,
    laminate_stiffness,
    layer_stresses,
)

ROOM = 293.15
MYLAR = {"modulus": 4.5e9, "poisson": 0.38, "expansion": 1.7e-5}
GERMANIUM = {"modulus": 8e10, "poisson": 0.22, "expansion": 6e-6}


def one(thickness=5e-7, **changed):
    return Laminate([Lamina(thickness, **{**MYLAR, **changed})])


def test_one_layer_is_a_plate():
    stiffness = laminate_stiffness(one())
    assert stiffness.plate == pytest.approx(4.5e9 * 5e-7**3 / 12 / (1 - 0.38**2), rel=1e-12)
    assert stiffness.poisson == pytest.approx(0.38, rel=1e-12)
    assert stiffness.membrane == pytest.approx(4.5e9 * 5e-7, rel=1e-12)
    assert free_curvature(one(stress=1e6), 400.0) == pytest.approx(0.0, abs=1e-9)


def test_cutting_a_layer_in_two_changes_nothing():
    whole = Laminate([Lamina(3e-8, **GERMANIUM, stress=2e8), *one().layers])
    cut = Laminate([Lamina(1e-8, **GERMANIUM, stress=2e8), Lamina(2e-8, **GERMANIUM, stress=2e8),
                    *one(2e-7).layers, *one(3e-7).layers])  # fmt: skip
    np.testing.assert_allclose(laminate_stiffness(cut), laminate_stiffness(whole), rtol=1e-12)
    assert free_curvature(cut, 400.0) == pytest.approx(float(free_curvature(whole, 400.0)))


def test_a_thin_coat_bends_by_stoneys_formula():
    thick, coat, stress = 1e-2, 1e-10, 3e8
    film = Laminate([Lamina(coat, **GERMANIUM, stress=stress), *one(thick).layers])
    stoney = 6 * stress * coat * (1 - 0.38) / (4.5e9 * thick**2)
    assert free_curvature(film, ROOM) == pytest.approx(stoney, rel=1e-6)


def test_two_strips_bend_by_timoshenkos_formula():
    # Timoshenko, J. Opt. Soc. Am. 11, 233 (1925), with biaxial moduli
    upper, lower = Lamina(3e-7, 7e10, 0.3, 2.3e-5), Lamina(5e-7, 1.6e11, 0.3, 4e-6)
    m, n = 3 / 5, 7 / 16
    strain = (2.3e-5 - 4e-6) * 80.0
    expected = (
        6 * strain * (1 + m) ** 2 / (8e-7 * (3 * (1 + m) ** 2 + (1 + m * n) * (m**2 + 1 / (m * n))))
    )
    # the upper strip expands more: its edge droops
    assert free_curvature(Laminate([upper, lower]), ROOM + 80.0) == pytest.approx(
        -expected, rel=1e-12
    )


def test_stresses_of_a_free_film_are_in_equilibrium():
    film = Laminate([Lamina(5e-8, **GERMANIUM, stress=2e8), *one().layers,
                     Lamina(2e-8, 2.8e11, 0.21, 5e-6, 1e9)])  # fmt: skip
    curvature = free_curvature(film, 420.0)
    sheets = Laminate([
        Lamina(layer.thickness / 40, layer.modulus, layer.poisson, layer.expansion, layer.stress)
        for layer in film.layers for _ in range(40)
    ])  # fmt: skip
    strain = free_strain(film, 420.0)
    found = layer_stresses(sheets, 420.0, (strain, strain), (curvature, curvature))
    stresses = np.array(found)
    thick = np.array([sheet.thickness for sheet in sheets.layers])
    height = np.cumsum(thick[::-1])[::-1] - thick / 2
    force, moment = stresses @ thick, stresses @ (thick * height)
    # stresses are the largest of each sheet, which is thin
    size = np.abs(stresses) @ thick
    assert abs(force) < 0.01 * size
    assert abs(moment) < 0.01 * size * 5e-7
    assert np.all(np.isfinite(flat_load(film, 420.0)))


def _ritz(curvature, radius, thickness=5e-7, modulus=4.5e9, poisson=0.38):
    """Curvatures of least energy of a round film: bending, and stretching by Gauss's curvature."""
    stiff = modulus * thickness**3 / 12 / (1 - poisson**2)
    moment = stiff * (1 + poisson) * curvature

    def energy(scaled):
        x, y = scaled * curvature
        bending = 0.5 * stiff * (x * x + y * y + 2 * poisson * x * y) - moment * (x + y)
        return (bending + modulus * thickness * radius**4 * (x * y) ** 2 / 384) / abs(
            moment * curvature
        )

    found = minimize(energy, [0.9, 0.3], method="BFGS", options={"gtol": 1e-12})
    return np.sort(np.abs(found.x * curvature))[::-1]


@pytest.mark.parametrize("curvature", [0.005, 0.01, 0.03, -0.3])
def test_a_wide_film_rolls_up_as_least_energy_has_it(curvature):
    stiffness = laminate_stiffness(one())
    found = curl_of_film(curvature, stiffness, 0.01)
    expected = _ritz(curvature, 0.01)
    np.testing.assert_allclose(np.abs([found.largest, found.smallest]), expected, rtol=2e-5)
    assert np.sign(found.largest) == np.sign(curvature)


def test_rolling_starts_where_freund_has_it():
    # Freund (2000): normalised curvature κR²/4t of 1/√(1+ν), at a mismatch of 2/(1+ν)^(3/2)
    stiffness, radius = laminate_stiffness(one()), 0.01
    unit = 4 * 5e-7 / radius**2
    assert critical_curvature(stiffness, radius) == pytest.approx(unit / 1.38**0.5, rel=1e-12)
    begins = 2 / 1.38**1.5 * unit
    assert not curl_of_film(0.999 * begins, stiffness, radius).rolls
    assert curl_of_film(1.001 * begins, stiffness, radius).rolls
    # far beyond, a cylinder of 1 + ν times the curvature of linear theory
    far = curl_of_film(1e4 * begins, stiffness, radius)
    assert far.largest == pytest.approx(1.38 * 1e4 * begins, rel=1e-6)
    small = curl_of_film(1e-4 * begins, stiffness, radius)
    assert small.largest == pytest.approx(1e-4 * begins, rel=1e-6)


def test_derivatives_are_those_of_finite_differences(require_derivatives):
    def curl(stress, radius):
        film = Laminate([Lamina(2e-8, **GERMANIUM, stress=stress), *one().layers])
        curvature, stiffness = free_curvature(film, 300.0), laminate_stiffness(film)
        return curl_of_film(curvature, stiffness, radius).largest

    def curls(x):
        return lf.xp.stack([curl(stress, x[3]) for stress in x[:3]])

    stresses = [-1.8e7, -2.16e7, 3e8]
    require_derivatives(curls, np.array([*stresses, 0.01]), rtol=1e-4, atol=1e-7)
