"""Uncertainty from the thicknesses; truth by Monte Carlo with tmm."""

import numpy as np
import pytest
import tmm

import lightflyer as lf
from lightflyer.film import (
    Film,
    Layer,
    Spectrum,
    absorptance,
    tabulated_material,
    thickness_uncertainty,
)

INDEX = (2.0 + 0.3j, 3.5 + 0.05j, 1.6 + 0.01j)
LINES = np.array([0.5e-6, 0.7e-6, 1.0e-6])


def stack(thickness):
    ends = np.array([1e-7, 1e-5])
    return Film(
        tuple(
            Layer(tabulated_material(f"m{one}", ends, np.full(2, one.real), np.full(2, one.imag),
                                     density=2000.0), d)
            for one, d in zip(INDEX, thickness, strict=True)
        )
    )  # fmt: skip


def by_tmm(thickness):
    """Mean absorptance of three lines of equal power, along the normal."""
    found = [tmm.coh_tmm("s", [1.0, *INDEX, 1.0], [np.inf, *thickness, np.inf], 0.0, at)
             for at in LINES]  # fmt: skip
    return 1.0 - np.mean([one["R"] + one["T"] for one in found])


def three_lines(film):
    optics = film.optics(LINES).polarisation_mean()
    return 1.0 - np.mean(optics.reflectance + optics.transmittance)


def test_it_is_the_scatter_of_a_monte_carlo_with_tmm(rng):
    thickness, spread = np.array([50e-9, 80e-9, 300e-9]), np.array([3e-9, 4e-9, 12e-9])
    draws = [by_tmm(thickness + spread * rng.normal(size=3)) for _ in range(1500)]
    found = thickness_uncertainty(three_lines, stack(thickness), spread)
    expected = np.sqrt(np.mean((np.array(draws) - by_tmm(thickness)) ** 2))
    assert found == pytest.approx(expected, rel=0.08)


def test_an_extremum_has_an_uncertainty(rng):
    """At a quarter wave the first order is zero; reflectance still scatters."""
    wavelength, index, spread = 0.8e-6, 2.0, 10e-9
    quarter = wavelength / (4.0 * index)
    glass = tabulated_material("g", np.array([1e-7, 1e-5]), np.full(2, index), np.zeros(2))

    def reflectance(film):
        return film.optics(wavelength).polarisation_mean().reflectance

    found = thickness_uncertainty(reflectance, Film((Layer(glass, quarter),)), [spread])
    draws = [
        tmm.coh_tmm("s", [1, index, 1], [np.inf, quarter + spread * one, np.inf], 0, wavelength)
        for one in rng.normal(size=3000)
    ]
    peak = tmm.coh_tmm("s", [1, index, 1], [np.inf, quarter, np.inf], 0, wavelength)["R"]
    expected = np.sqrt(np.mean([(one["R"] - peak) ** 2 for one in draws]))
    assert found == pytest.approx(expected, rel=0.1)


def test_mass_and_structure():
    film = stack([1e-7, 1e-7, 1e-7])
    found = thickness_uncertainty(
        lambda one: {"mass": one.areal_density, "both": np.array([one.areal_density] * 2)},
        film, [3e-9, 0.0, 4e-9],
    )  # fmt: skip
    assert found["mass"] == pytest.approx(2000.0 * 5e-9, rel=1e-9)
    np.testing.assert_allclose(found["both"], 2000.0 * 5e-9, rtol=1e-9)
    line = Spectrum("line", LINES, np.ones(3))
    exact = thickness_uncertainty(lambda one: absorptance(one, line).value, film, [0.0] * 3)
    assert exact == 0.0


@pytest.mark.parametrize(
    ("spread", "says"),
    [
        ([1e-9], "1 uncertainties of thicknesses are given for 3 layers"),
        ([-1e-9, 0.0, 0.0], "is not zero or positive"),
        ([0.0, 2e-7, 0.0], "= 100 ± 200 nm: ± is one standard deviation and must be below"),
    ],
)
def test_bad_uncertainties(spread, says):
    with pytest.raises(lf.ParameterError, match=says):
        thickness_uncertainty(three_lines, stack([1e-7] * 3), spread)
