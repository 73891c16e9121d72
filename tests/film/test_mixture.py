"""Films of mixtures, graded layers and tables at several temperatures."""

import re

import jax
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import lightflyer as lf
from lightflyer.film import (
    Film,
    Graded,
    Layer,
    Mixture,
    TemperatureDependentMedium,
    absorptance,
    am0,
    at_temperature,
    bruggeman,
    emittance,
    light_shares,
    material,
    porous,
    vacuum,
)
from lightflyer.film.optics.diagnostics import film_warnings, sheet_error, sheet_warnings

from .conftest import flat

WAVELENGTH = np.array([0.5e-6, 1e-6])


def test_a_porous_material_is_one_with_as_much_vacuum():
    (n, k), porosity = material("Ge").index(0.6e-6), 0.3
    expected = bruggeman(np.array([n, 1.0]), np.array([k, 0.0]), [1.0 - porosity, porosity])
    found = porous(material("Ge"), porosity).index(0.6e-6)
    np.testing.assert_allclose(found, expected, rtol=1e-12)


def test_mass_follows_the_fractions():
    mixture = Mixture(
        (flat(2.0, name="a"), flat(2.0, density=3000.0, name="b"), vacuum()), (0.2, 0.3)
    )
    assert mixture.density == pytest.approx(0.5 * 1000.0 + 0.2 * 3000.0)
    graded = Graded((flat(2.0, name="a"), vacuum()), 0.2, 0.6)
    assert Film((Layer(graded, 1e-6),)).areal_density == pytest.approx(0.6e-3)
    assert mixture.with_density(700.0).density == 700.0
    unknown = Mixture((flat(2.0, name="a"), material("a-C")), 0.5)
    with pytest.raises(lf.ParameterError, match="that of a-C is unknown"):
        _ = Film((Layer(unknown, 1e-6),)).areal_density


def averages(porosity):
    """Emittance and mass of a film with a porous layer, whose porosity may be traced."""
    film = Film((Layer(porous(material("Ge"), porosity), 40e-9), Layer(material("PET"), 5e-7)))
    warm = emittance(film, 350.0, side="bottom", points_per_e_fold=20).value
    return warm, film.areal_density


def test_averages_are_differentiable_in_the_porosity(compiled):
    step = 1e-4
    with lf.float64():
        slope = compiled(jax.vmap(jax.jacfwd(averages)))(np.array([0.3]))
        ends = [np.array(averages(0.3 + sign * step)) for sign in (1.0, -1.0)]
    np.testing.assert_allclose(np.ravel(slope), (ends[0] - ends[1]) / (2.0 * step), rtol=1e-6)


def reflectance_of_a_profile(thickness, wavelength):
    """Reflectance of a layer whose permittivity falls linearly, by integration from its bottom."""
    number = 2.0 * np.pi / wavelength

    def change(depth, admittance):
        permittivity = 12.25 + (2.25 - 12.25) * depth / thickness
        return 1j * number * (admittance**2 - permittivity)  # of a field exp(-iωt)

    found = solve_ivp(change, (thickness, 0.0), [1.0 + 0j], rtol=1e-10, atol=1e-12)
    top = found.y[0, -1]
    return abs((1.0 - top) / (1.0 + top)) ** 2


def test_sheets_converge_to_the_continuous_profile_as_their_square():
    """The rule "parallel" makes the permittivity linear in depth; the truth is an integration."""
    thickness, expected = 300e-9, np.array(
        [reflectance_of_a_profile(300e-9, one) for one in WAVELENGTH]
    )  # fmt: skip
    errors = []
    for count in (10, 20):
        graded = Graded(
            (flat(3.5, name="a"), flat(1.5, name="b")), 0.0, 1.0, rule="parallel", count=count
        )
        found = Film((Layer(graded, thickness),)).optics(WAVELENGTH)
        errors.append(np.abs(found.reflectance[0] - expected))
    film = Film((Layer(graded, thickness),))
    assert errors[1].max() < sheet_error(film) < 0.02  # the largest is at the shortest wavelength
    (said,) = sheet_warnings(film)
    assert said.startswith("graded a + b is computed as 20 sheets; the film's reflectance and")
    assert np.all(errors[1] < 2e-3)
    np.testing.assert_allclose(errors[0] / errors[1], 4.0, rtol=0.1)


def test_a_graded_layer_stays_one_layer_and_turns_over():
    graded = Graded((flat(3.0, 0.5, name="a"), vacuum()), 0.1, 0.8, count=10)
    film = Film((Layer(graded, 200e-9), Layer(flat(1.5, name="b"), 100e-9)))
    optics = film.optics(WAVELENGTH, side="bottom")
    assert optics.layer_absorptance.shape == (2, 2, 2)
    total = optics.reflectance + optics.transmittance + optics.absorptance
    np.testing.assert_allclose(total, 1.0, rtol=1e-12)
    turned = Graded((flat(3.0, 0.5, name="a"), vacuum()), 0.8, 0.1, count=10)
    other = Film((Layer(flat(1.5, name="b"), 100e-9), Layer(turned, 200e-9))).optics(WAVELENGTH)
    np.testing.assert_allclose(optics.reflectance, other.reflectance, rtol=1e-12)


def test_constants_between_temperatures():
    media, tables = (flat(2.0, 0.1, name="cold"), flat(2.4, 0.3, name="warm")), (200.0, 400.0)
    middle = TemperatureDependentMedium(media, tables, 250.0)
    np.testing.assert_allclose(middle.index(WAVELENGTH), [[2.1] * 2, [0.15] * 2], rtol=1e-14)
    with lf.float64():
        slope = jax.grad(lambda at: TemperatureDependentMedium(media, tables, at).index(5e-7)[0])(
            250.0
        )
    assert slope == pytest.approx(0.4 / 200.0, rel=1e-12)
    with pytest.raises(lf.ParameterError, match="= 500 is not between 200 and 400"):
        TemperatureDependentMedium(media, tables, 500.0)
    pages = [material(f"main/Si/Franta-{kelvin}K") for kelvin in (400, 300)]
    film = Film((Layer(at_temperature(pages, 400.0), 1e-7),))
    np.testing.assert_array_equal(film.index(WAVELENGTH)[0][0], pages[0].index(WAVELENGTH)[0])
    assert at_temperature(pages, 350.0).diagnostics == (
        "main/Si/Franta-300K / main/Si/Franta-400K has n and k at 350 K, linear between tables at "
        "300, 400 K",
    )
    with pytest.raises(lf.ParameterError, match="PET states no temperature"):
        at_temperature([material("PET"), *pages], 300.0)


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ({}, "no size of its grains is stated"),
        ({"grain": 50e-9}, r"its grains exceed 0\.1 wavelengths .* below 1\.51 µm"),
        ({"rule": "maxwell-garnett"}, "inclusions fill 40%; Maxwell Garnett's rule is for few"),
        ({"shape": "columns"}, "columns have n and k of light along the film's normal"),
    ],
)
def test_results_say_where_a_mixture_is_beyond_its_rule(how, words):
    film = Film((Layer(Mixture((material("Ge"), vacuum()), 0.4, **how), 40e-9),))
    shares = {"top": light_shares(film).absorptance}
    warm = {"top": emittance(film, np.array([300.0]), points_per_e_fold=10)}
    said = film_warnings(film, am0(), np.array([300.0]), shares, shares, warm, (None,))
    assert any(re.search(words, text) for text in said)


@pytest.mark.parametrize(
    ("how", "message"),
    [
        ({"fractions": (0.5, 0.6)}, "it has 2 and 2"),
        ({"fractions": 1.2}, r"fraction of vacuum = 1\.2 is not between 0 and 1"),
        ({"rule": "looyenga"}, 'rule "looyenga" is unknown; choose from bruggeman'),
        ({"shape": "cubes"}, 'shape "cubes" is unknown; choose from spheres'),
        ({"shape": "needles"}, 'the rule "bruggeman" has no needles; "maxwell-garnett" has'),
        ({"depolarisation": 1.0}, 'the rule "series" has such layers'),
        ({"grain": 0.0}, "grain = 0 is not positive"),
    ],
)
def test_impossible_mixtures_get_one_line(how, message):
    with pytest.raises(lf.ParameterError, match=message) as caught:
        Mixture((material("Ge"), vacuum()), **{"fractions": 0.4} | how)
    assert "\n" not in str(caught.value)


def test_a_mixture_extrapolates_as_its_parts():
    mixture = porous(material("PET"), 0.2)
    assert mixture.usable_range == material("PET").wavelength_range
    with pytest.raises(lf.ParameterError, match=r"PET has no data at 0\.3 µm, only from 0\.4 µm"):
        mixture.index(0.3e-6)
    held = mixture.with_extrapolation("hold")
    assert held.index(0.3e-6) == held.index(0.4e-6)
    assert held.extrapolations(0.3e-6, 1e-6) == ("PET: hold beyond 0.4 µm to 19.942 µm",)


def test_the_nanotube_mat_absorbs_and_emits_as_measured():
    """300 nm on mylar: 0.75 ± 0.02 of white light, 0.48 ± 0.03 in the infrared [Lu2023]."""
    film = Film((Layer(material("PET"), 500e-9), Layer(material("CNT-mat"), 300e-9)))
    visible = absorptance(film, lf.film.cold_white_led()).value
    window = film.optics(1e-2 / np.linspace(667.0, 1300.0, 40)).polarisation_mean()
    infrared = 1.0 - window.reflectance.mean() - window.transmittance.mean()
    assert visible == pytest.approx(0.75, abs=0.02)
    assert infrared == pytest.approx(0.48, abs=0.03)
    assert any("is a model" in text for text in material("CNT-mat").diagnostics)
