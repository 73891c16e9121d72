"""Formulas of n and k: causality by numerical integration, published parameters, flyer files."""

import numpy as np
import pytest
from scipy.integrate import quad

import lightflyer as lf
from lightflyer import film
from lightflyer.film.media.dispersion import (
    Cauchy,
    CodyLorentz,
    Drude,
    Formula,
    Gaussian,
    Lorentz,
    TaucLorentz,
)

EV = 1.602176634e-19


def kramers_kronig(imaginary, energy, lowest):
    """Real part from an imaginary part, by quadrature in electronvolts."""
    top = 60.0

    def kernel(x):
        return x * imaginary(x) / (x + energy)

    total = quad(lambda x: x * imaginary(x) / (x * x - energy * energy), top, np.inf)[0]
    if energy > lowest:
        total += quad(kernel, lowest, 2 * energy, weight="cauchy", wvar=energy, limit=400)[0]
        lowest = 2 * energy
    rest = quad(lambda x: x * imaginary(x) / (x * x - energy * energy), lowest, top, limit=800)
    return 2.0 / np.pi * (total + rest[0])


def lorentz(x, strength, centre, broadening):
    below = (centre**2 - x**2) ** 2 + (broadening * x) ** 2
    return strength * centre**2 * broadening * x / below


def tauc_lorentz(x, amplitude, centre, broadening, gap):
    """Equation of Jellison and Modine, which the closed form is not made of."""
    if x <= gap:
        return 0.0
    return lorentz(x, amplitude / centre, centre, broadening) * ((x - gap) / x) ** 2


def cody_lorentz(x, amplitude, centre, broadening, gap, transition):
    """Equations of Ferlauto and others, without the tail."""
    above = max(x - gap, 0.0) ** 2
    return above / (above + transition**2) * lorentz(x, amplitude / centre, centre, broadening)


def gaussian(x, strength, centre, width):
    sigma = width / (2.0 * np.sqrt(np.log(2.0)))
    both = ((x - centre) / sigma) ** 2, ((x + centre) / sigma) ** 2
    return strength * (np.exp(-both[0]) - np.exp(-both[1]))


ENERGIES = (0.3, 1.05, 1.7, 2.2, 3.1, 3.4, 6.0)
BAND = (0.8, 0.12, 0.03)  # of a polymer


@pytest.mark.parametrize(
    ("term", "law", "numbers", "scales", "gap", "energies", "rtol"),
    [
        (TaucLorentz, tauc_lorentz, (122.0, 3.45, 2.54, 1.2), EV, 1.2, (*ENERGIES, 1.176), 1e-9),
        (TaucLorentz, tauc_lorentz, (80.0, 2.6, 3.2, 0.5), EV, 0.5, (*ENERGIES, 0.49), 1e-9),
        (CodyLorentz, cody_lorentz, (80.0, 3.5, 2.3, 1.1, 0.9), EV, 1.1, ENERGIES, 1e-7),
        (Lorentz, lorentz, (1.7, 2.0, 0.4), (1.0, EV, EV), 0.0, (0.5, 1.9, 4.0), 1e-6),
        (Gaussian, gaussian, BAND, (1.0, EV, EV), 0.0, (0.02, 0.11, 0.13, 0.5), 1e-6),
    ],
)
def test_real_parts_are_transforms_of_imaginary_parts(
    term, law, numbers, scales, gap, energies, rtol
):
    made = term(*np.multiply(numbers, scales))
    for energy in energies:
        found = made.permittivity(energy * EV)
        assert found[1] == pytest.approx(law(energy, *numbers), rel=1e-12, abs=1e-300)
        expected = kramers_kronig(lambda x: law(x, *numbers), energy, gap)
        assert found[0] == pytest.approx(expected, rel=rtol)


def test_free_carriers_are_a_lorentz_oscillator_without_a_restoring_force():
    carriers = Drude(9.0 * EV, 0.07 * EV).permittivity(0.1 * EV)
    soft = Lorentz((9.0 / 1e-5) ** 2, 1e-5 * EV, 0.07 * EV).permittivity(0.1 * EV)
    np.testing.assert_allclose(carriers, soft, rtol=1e-6)


def test_published_parameters_give_the_published_constants_of_amorphous_silicon():
    """Jellison and Modine fitted the data of Pierce and Spicer, which the library carries."""
    term = TaucLorentz("122 eV", "3.45 eV", "2.54 eV", "1.20 eV")
    model = Formula("a-Si", (term,), 1.15)
    wavelength = np.array([0.25, 0.3, 0.4, 0.5, 0.6]) * 1e-6
    measured = film.material("main/Si/Pierce").index(wavelength)
    np.testing.assert_allclose(model.index(wavelength)[0], measured[0], rtol=0.04)
    np.testing.assert_allclose(model.index(wavelength)[1], measured[1], rtol=0.08)


def test_cauchy_of_units_in_texts():
    glass = Formula("glass", cauchy=Cauchy(1.5, "0.004 um^2", "0.0001 um^4"))
    n, k = glass.index(0.5e-6)
    assert n == pytest.approx(1.5 + 0.016 + 0.0016, rel=1e-12)
    assert k == 0.0
    assert any("k = 0" in text for text in glass.diagnostics)


def test_formula_keeps_to_its_range_and_says_what_it_does_beyond():
    fitted = Formula("x", (Drude("9 eV", "0.1 eV"),), 4.0, shortest=1e-6, longest=2e-6)
    with pytest.raises(lf.ParameterError, match="no data at 3 µm"):
        fitted.index(3e-6)
    held = fitted.with_extrapolation("hold")
    assert held.extrapolations(1e-6, 3e-6) == ("x: hold beyond 1 µm to 2 µm",)
    assert fitted.with_extrapolation("lossless").index(3e-6)[1] == 0.0
    unlimited = Formula("x", (Lorentz(1.0, "2 eV", "1 eV"),))
    assert "states no range" in unlimited.diagnostics[0]


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: TaucLorentz("10 eV", "1 eV", "3 eV", "1 eV"), "below twice its energy"),
        (lambda: Formula("x"), "either terms or cauchy"),
        (lambda: Formula("x", cauchy=Cauchy(1.5), shortest=2.0, longest=1.0), "no wavelength"),
        (lambda: Formula("x", cauchy=Cauchy(1.0, "-1 um^2")).index(0.3e-6), "which no medium has"),
        (lambda: Lorentz(1.0, "2 nm", "1 eV"), "wrong kind"),
    ],
)
def test_impossible_formulas_are_refused(make, said):
    with pytest.raises(lf.LightflyerError, match=said):
        make()
