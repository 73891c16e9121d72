import jax
import numpy as np
import pytest
import tmm

import lightflyer as lf
from lightflyer.core import constants
from lightflyer.film import (
    Film,
    Layer,
    absorptance,
    emittance,
    emittance_curve,
    material,
    planck,
    tabulated_material,
)
from lightflyer.film.optics.spectra import blackbody_fraction

from .conftest import flat

TEMPERATURES = np.array([200.0, 300.0, 441.0, 1000.0])


def nominal(policy="error"):
    """The paper's film: alumina, germanium, mylar, germanium."""
    stack = (("Al2O3", 50e-9), ("Ge", 20e-9), ("PET", 500e-9), ("Ge", 20e-9))
    return Film(tuple(Layer(material(name, extrapolation=policy), d) for name, d in stack))


@pytest.fixture(scope="module")
def curve():
    """Emittance of the nominal film's top."""
    return emittance_curve(nominal())


def test_the_nominal_film_radiates_little():
    """The paper measured 0.08 ± 0.02 by thermography."""
    assert emittance(nominal(), 441.0).value == pytest.approx(0.075, abs=0.002)
    assert nominal().areal_density == pytest.approx(1.058e-3, rel=1e-3)


def test_planck_weighted_integration_has_converged():
    plain = emittance(nominal(), TEMPERATURES).value
    finer = emittance(nominal(), TEMPERATURES, points_per_e_fold=16000).value
    np.testing.assert_allclose(plain, finer, rtol=1e-5)


def test_an_opaque_film_that_reflects_nothing_is_a_black_body():
    matched = Film((Layer(flat(1.0, 4e-3), 0.01),))
    assert emittance(matched, 1500.0, normal=True).value == pytest.approx(1.0, abs=1e-5)


def test_what_is_left_out_is_stated_and_bounded():
    mean = emittance(nominal(), 441.0)
    assert mean.covered == pytest.approx(0.7842, abs=1e-3)
    assert mean.upper - mean.lower == pytest.approx(1.0 - mean.covered, rel=1e-12)
    assert mean.lower < mean.value < mean.upper
    assert mean.left_out == pytest.approx(1.0 - mean.covered, abs=1e-12)
    assert mean.extrapolated == ()


@pytest.mark.parametrize("policy", ["hold", "lossless"])
def test_data_cover_the_same_share_under_every_policy(policy):
    for average, options in ((emittance, {"temperature": TEMPERATURES}), (absorptance, {})):
        strict, held = (average(nominal(one), **options) for one in ("error", policy))
        np.testing.assert_array_equal(held.covered, strict.covered)
        np.testing.assert_allclose(held.lower, strict.lower, rtol=2e-3)
        np.testing.assert_allclose(held.upper, strict.upper, rtol=2e-3)
        np.testing.assert_allclose(held.extrapolated_share, 1.0 - strict.covered, atol=1e-5)
        np.testing.assert_allclose(held.left_out, 0.0, atol=1e-5)
        assert np.all((held.lower < held.value) & (held.value < held.upper))
        assert f"Ge: {policy} beyond 0.4 µm to 15 µm" in held.extrapolated
        assert len(held.extrapolated) == 3


def test_one_layer_may_extrapolate_and_another_not():
    """PET ends at 19.9 µm, germanium at 15 µm: what lies beyond 19.9 µm is left out."""
    layers = (Layer(material("Ge", extrapolation="hold"), 2e-8), Layer(material("PET"), 5e-7))
    mean = emittance(Film(layers), 300.0)
    shares = [blackbody_fraction(end, 300.0) for end in (0.4e-6, 15e-6, 19.942e-6)]
    assert mean.covered == pytest.approx(shares[1] - shares[0], rel=1e-6)
    assert mean.extrapolated_share == pytest.approx(shares[2] - shares[1], rel=1e-6)
    assert mean.left_out == pytest.approx(1.0 - shares[2] + shares[0], rel=1e-6)


def smooth_material(rng):
    """Index known everywhere: an oscillator in the visible and one in the infrared."""
    wavelength = np.geomspace(0.1e-6, 3e-3, 3000)
    n, k = np.full(3000, rng.uniform(1.3, 4.0)), np.zeros(3000)
    for centre in (rng.uniform(0.2e-6, 1e-6), rng.uniform(5e-6, 40e-6)):
        ratio = wavelength / centre
        width = rng.uniform(0.05, 0.5)
        k += rng.uniform(0.02, 2.0) * width * ratio / ((ratio**2 - 1.0) ** 2 + (width * ratio) ** 2)
    return wavelength, n, k


def independent_mean(table, thickness, weight, wavelength, side):
    """Absorptance along the normal with tmm, over the whole spectrum."""
    n = [np.interp(wavelength, one[0], one[1] + 1j * one[2]) for one in table][::side]
    spectral = []
    for point, at in enumerate(wavelength):
        index = [1.0, *(one[point] for one in n), 1.0]
        data = tmm.coh_tmm("s", index, [np.inf, *thickness[::side], np.inf], 0.0, at)
        spectral.append(1.0 - data["R"] - data["T"])
    return weight @ spectral / weight.sum()


@pytest.mark.parametrize("policy", ["error", "hold", "lossless"])
def test_the_bounds_hold_the_truth_where_data_are_missing(rng, policy):
    """Materials known everywhere, of which the film gets a part; truth by tmm."""
    wavelength = np.geomspace(1e-6, 300e-6, 150)
    for _ in range(4):
        tables = [smooth_material(rng) for _ in range(2)]
        thickness = 10.0 ** rng.uniform(-7.5, -5.5, 2)
        layers = []
        for one, d in zip(tables, thickness, strict=True):
            cut = (one[0] > rng.uniform(0.3e-6, 6e-6)) & (one[0] < rng.uniform(8e-6, 30e-6))
            part = tabulated_material("part", *(column[cut] for column in one))
            layers.append(Layer(part.with_extrapolation(policy), d))
        temperature = rng.uniform(200.0, 600.0)
        weight = planck(wavelength, temperature) * wavelength
        for side, step in (("top", 1), ("bottom", -1)):
            mean = emittance(Film(tuple(layers)), temperature, side=side, normal=True)
            truth = independent_mean(tables, thickness, weight, wavelength, step)
            assert mean.lower - 1e-3 < truth < mean.upper + 1e-3


def test_a_body_too_cold_to_radiate_is_refused():
    with pytest.raises(lf.ParameterError, match="at 1 K radiates nothing between"):
        emittance(nominal(), [300.0, 1.0])


def test_the_curve_follows_the_emittance_everywhere():
    curve = emittance_curve(nominal(), "bottom")
    between = np.geomspace(100.0, 1500.0, 37)
    np.testing.assert_allclose(
        curve(between), emittance(nominal(), between, side="bottom").value, rtol=1e-5
    )
    # held beyond its ends
    ends = curve(np.array([50.0, 100.0, 1500.0, 2500.0]))
    assert ends[0] == ends[1]
    assert ends[2] == ends[3]


@pytest.mark.parametrize("excess", [1e-12, 1e-6, 0.3, 1.5, -0.4, -1e-9])
def test_growth_does_not_cancel(curve, excess):
    fine = np.linspace(0.0, excess, 2001)
    with lf.float64():

        def power(x):
            return curve(250.0 * (1.0 + x)) * (1.0 + x) ** 4

        slope = np.asarray(jax.jvp(power, (fine,), (np.ones_like(fine),))[1])
    grown = curve.growth(250.0, excess)
    assert grown == pytest.approx(np.trapezoid(slope, fine), rel=1e-5)


def flyer(top, bottom):
    return lf.Disk(lf.FilmProperties(1e-3, 0.5, top, bottom, 0.8, 0.9), radius=0.01)


AREA = np.pi * 0.01**2


def test_the_heat_balance_closes_with_a_curve(curve):
    irradiance, altitude = np.array([1e-3, 1.0, 1360.0, 1e5]), np.array([[30e3], [70e3], [140e3]])
    state = lf.Earth(radiation=lf.environment.Radiation(irradiance)).state(altitude)
    balance = lf.equilibrium(flyer(curve, curve), state, lf.Lu2023())
    (hot,) = balance.temperatures
    emitted = [curve(t) * t**4 for t in (hot, state.temperature)]
    expected = 2.0 * AREA * constants.STEFAN_BOLTZMANN * (emitted[0] - emitted[1])
    # a difference of two emissions, of which that of the gas's temperature is a few W/m²
    cancelled = 1e-12 * 500.0 * AREA + 1e-12 * balance.absorbed_power
    assert np.all(np.abs(balance.radiated_power - expected) < 1e-6 * np.abs(expected) + cancelled)
    total = balance.radiated_power + balance.gas_power
    np.testing.assert_allclose(total, balance.absorbed_power, rtol=1e-10)


def test_cooling_below_the_gas_has_a_root_too(curve):
    """The disk radiates upwards into nothing; the gas and 100 W/m² from below warm it."""
    radiation = lf.environment.Radiation(0.0, infrared_above=0.0, infrared_below=100.0)
    state = lf.environment.EnvironmentState(1.0, 220.0, 9.6, lf.gas.AIR, radiation)
    balance = lf.equilibrium(flyer(curve, 0.2), state, lf.Lu2023())
    (temperature,) = balance.temperatures
    assert 100.0 < temperature < 220.0
    emission = (curve(temperature) + 0.2) * constants.STEFAN_BOLTZMANN * temperature**4
    lost = AREA * (emission - 0.2 * 100.0)
    assert lost == pytest.approx(-float(balance.gas_power), rel=1e-9)
