"""Spheres in light: efficiencies, heat sources, averages."""

import time

import numpy as np
import pytest

from lightflyer import ParameterError
from lightflyer.film import (
    Graded,
    am0,
    material,
    mie,
    planck,
    spectral_line,
    sphere_absorption,
    vacuum,
)

from .conftest import flat

# from studies/sphere_absorption/fifty_digits.py; the first is also in the tests of
# VictoriaMaia/Photophoretic-force, whose sign says which way it drives
TO_50_DIGITS = [
    (1.57 - 0.038j, 10.0, 0.95597090260347621467, -0.054413290391591071383),
    (1.41 - 0.008j, 1.9729, 0.064111582208902340029, -0.0050976129853067974986),
    (1.5 - 1.0j, 5.0, 1.2614500997566371035, 0.33946784888147189685),
    (3.0 - 2.0j, 0.01, 0.0074637065896481439741, 0.000044473588574238453009),
    (1.5 - 1e-9j, 8.0, 4.747234375948176744e-8, -7.7502471480205514778e-9),
]


@pytest.mark.parametrize(("index", "size", "absorption", "asymmetry"), TO_50_DIGITS)
def test_heat_sources_to_50_digits(index, size, absorption, asymmetry):
    found = mie(index, size)
    assert found.absorption == pytest.approx(absorption, rel=1e-12)
    assert found.source_asymmetry == pytest.approx(asymmetry, rel=1e-11)


def test_efficiencies_of_another_program():
    """Values of miepython 3.3.0, ``efficiencies_mx``: extinction, scattering, back, g."""
    known = {
        (1.57 - 0.038j, 10.0): (2.640153922407028, 1.6841830198080157, 0.8813446977171862),
        (1.41 - 0.008j, 1.9729): (1.1545026671972203, 1.0903910849883276, 0.6576375149808177),
        (1.5 - 1j, 50.0): (2.1542241104192748, 1.3025519685694544, 0.8503285909404321),
        (1.5 - 1e-6j, 300.0): (2.0611545324028206, 2.0600609373626835, 0.8273436355994687),
        (20.0 - 30j, 5.0): (2.192738725045991, 2.0939381922951537, 0.47652811578892623),
        (1.33 - 0.1j, 200.0): (2.0557296936046106, 1.0954622298701138, 0.9696375982936133),
    }
    for (index, size), values in known.items():
        found = mie(index, size)
        ours = found.extinction, found.scattering, found.asymmetry
        np.testing.assert_allclose(ours, values, rtol=1e-9)


def test_ten_thousand_random_spheres_are_finite(rng):
    k = np.where(rng.random(10_000) < 0.1, 0.0, 10 ** rng.uniform(-12, 2, 10_000))
    size = 10 ** rng.uniform(-4, np.log10(300.0), 10_000)
    found = mie(10 ** rng.uniform(-1.5, 2, 10_000) - 1j * k, size)
    assert all(np.all(np.isfinite(one)) for one in found)
    assert np.all(found.absorption >= 0.0)
    assert np.all(found.scattering > 0.0)
    # all sources lie within the sphere
    assert np.all(np.abs(found.source_asymmetry) <= 0.75 * found.absorption)
    assert np.all(np.abs(found.asymmetry) <= 1.0)


def test_a_curve_of_three_hundred_sizes_takes_less_than_two_seconds():
    begun = time.process_time()
    mie(1.57 - 0.038j, np.geomspace(0.1, 100.0, 300))
    assert time.process_time() - begun < 2.0  # a fortieth of that on one core


def test_both_signs_of_absorption_and_shapes():
    """scottprahl/miepython#7: of one sign, a sphere that absorbs was one that amplifies."""
    sizes = np.geomspace(0.1, 100.0, 6).reshape(2, 3)
    one, other = mie(1.5 - 0.1j, sizes), mie(1.5 + 0.1j, sizes)
    for name in one._fields:
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    assert mie(1.5 - 0.1j, sizes[1, 2]).absorption == pytest.approx(one.absorption[1, 2], rel=1e-13)
    np.testing.assert_allclose(one.pressure, one.extinction - one.asymmetry * one.scattering)


def test_an_opaque_sphere_that_reflects_nothing_is_heated_on_its_lit_side():
    """All stays where it falls: J₁ = 1/2, with what diffraction adds at the rim."""
    errors = [abs(mie(1.0 + 0.02j, size).source_asymmetry - 0.5) for size in (1e3, 8e3)]
    assert errors[1] < 0.01
    assert errors[1] < 0.5 * errors[0]


def ray_optics(n):
    """Absorption efficiency and J₁ per kx of a weakly absorbing, large sphere, by rays."""
    nodes, weights = np.polynomial.legendre.leggauss(300)
    incidence, weights = 0.25 * np.pi * (nodes + 1.0), 0.25 * np.pi * weights
    refraction = np.arcsin(np.sin(incidence) / n)
    absorption = asymmetry = 0.0
    for reflectance in (
        (np.sin(incidence - refraction) / np.sin(incidence + refraction)) ** 2,
        (np.tan(incidence - refraction) / np.tan(incidence + refraction)) ** 2,
    ):
        chord = 0.5 * weights * np.sin(incidence) * np.cos(incidence) * np.cos(refraction)
        chord *= 1.0 - reflectance
        for bounce in range(30):
            place = incidence + 0.5 * np.pi - refraction + bounce * (np.pi - 2.0 * refraction)
            absorption += 8.0 * np.sum(chord * reflectance**bounce)
            asymmetry += 6.0 * np.sum(
                chord * reflectance**bounce * np.sin(refraction) * np.cos(place)
            )
    return absorption, asymmetry


def test_large_weakly_absorbing_spheres_follow_rays_to_their_far_side():
    n, size, k = 1.5, np.linspace(970.0, 1030.0, 100), 1e-8
    found = mie(n - 1j * k, size)
    mean = np.mean(found.source_asymmetry / (k * size))
    assert mean < 0.0
    assert mean == pytest.approx(ray_optics(n)[1], rel=0.03)


def test_small_spheres_absorb_as_a_dipole():
    m, size = 1.95 - 0.79j, 1e-3
    dipole = 4.0 * size * abs(((m**2 - 1.0) / (m**2 + 2.0)).imag)
    assert mie(m, size).absorption == pytest.approx(dipole, rel=1e-5)


# --- averages ---


def test_means_over_sunlight_and_heat_by_another_integration():
    found = sphere_absorption(flat(1.8, 0.4), 0.7e-6)
    sun = am0()
    spectral = mie(1.8 + 0.4j, 2.0 * np.pi * 0.7e-6 / sun.wavelength)
    total = np.trapezoid(sun.irradiance, sun.wavelength)
    for ours, theirs in (
        (found.absorption_efficiency, spectral.absorption),
        (found.asymmetry, spectral.source_asymmetry),
        (found.pressure, spectral.pressure),
    ):
        mean = np.trapezoid(theirs * sun.irradiance, sun.wavelength) / total
        assert ours == pytest.approx(mean, rel=1e-9)
    wavelength = np.geomspace(3e-7, 3e-3, 5001)
    heat = mie(1.8 + 0.4j, 2.0 * np.pi * 0.7e-6 / wavelength)
    for temperature in (150.0, 300.0, 900.0):
        weight = planck(wavelength, temperature) * wavelength
        for ours, theirs in (
            (found.emittance, heat.absorption),
            (found.infrared_asymmetry, heat.source_asymmetry),
        ):
            mean = np.trapezoid(weight * theirs) / np.trapezoid(weight)
            assert ours(temperature) == pytest.approx(mean, rel=1e-3)


def test_a_line_is_one_wavelength():
    carbon = material("a-C")
    n, k = carbon.index(532e-9)
    found = sphere_absorption(carbon, "1 um", spectral_line("532 nm"))
    alone = mie(n + 1j * k, 2.0 * np.pi * 1e-6 / 532e-9)
    assert found.absorption_efficiency == pytest.approx(alone.absorption, rel=1e-6)
    assert found.asymmetry == pytest.approx(alone.source_asymmetry, rel=1e-6)


def test_many_radii_are_as_one():
    radii = np.array([[0.1e-6, 1e-6], [1e-6, 3e-6]])
    glass = material("SiO2", extrapolation="hold")
    found = sphere_absorption(glass, radii)
    alone = sphere_absorption(glass, 1e-6)
    assert found.asymmetry.shape == found.emittance(300.0).shape == (2, 2)
    assert found.asymmetry[1, 0] == pytest.approx(alone.asymmetry, rel=1e-12)
    assert found.infrared_asymmetry(300.0)[0, 1] == pytest.approx(
        alone.infrared_asymmetry(300.0), rel=1e-9
    )


def test_missing_data_and_what_stands_for_them_are_named():
    held = sphere_absorption(material("a-C", extrapolation="hold"), 0.5e-6)
    assert [line.count("hold beyond") for line in held.diagnostics] == [1, 1]
    assert "92 % of AM0" in held.diagnostics[0]
    assert "300 K" in held.diagnostics[1]
    assert sphere_absorption(flat(1.5, 0.1), 1e-6).diagnostics == ()


CARBON = material("a-C", extrapolation="hold")


@pytest.mark.parametrize(
    ("compute", "arguments", "word"),
    [
        (mie, (1.5, 0.0), "size = 0"),
        (mie, (1.5, -1.0), "size = -1"),
        (mie, (1.5, np.nan), "size = nan"),
        (mie, (1.5, 1e7), "size = 1e"),
        (mie, (-1.5, 1.0), "index"),
        (mie, (np.nan, 1.0), "index"),
        (sphere_absorption, (CARBON, -1e-6), "radius = -1e-06"),
        (sphere_absorption, (CARBON, "1 kg"), "kg"),
        (sphere_absorption, (CARBON, 1.0), "too large for the theory of Mie"),
        (sphere_absorption, (material("a-C"), 1e-6, spectral_line(10e-6)), "no power"),
        (sphere_absorption, (Graded((CARBON, vacuum()), [0.9], [0.1]), 1e-6), "uniform"),
    ],
)
def test_impossible_spheres_are_refused_in_a_line(compute, arguments, word):
    with pytest.raises(ParameterError, match=word) as error:
        compute(*arguments)
    assert "\n" not in str(error.value)
