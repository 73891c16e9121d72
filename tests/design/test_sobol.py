"""Sobol indices beside their closed form, and elasticities beside exponents."""

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.design.sections import SensitivitySection
from lightflyer.design.sobol import make_inquiry, sensitivity_indices

FILM = {
    "areal_density": "1 g/m^2",
    "absorptance": 0.75,
    "emittance": 0.08,
    "tac_top": "0.8 ± 0.01",
    "tac_bottom": "0.9 ± 0.01",
}


@pytest.fixture(scope="module")
def flyer():
    return lf.FlyerFile(flyer={"diameter": "2 cm"}, film=FILM, environment={"atmosphere": "lu2023"})


def inquire(flyer, **section):
    return make_inquiry(flyer, SensitivitySection.model_validate(section))


def test_indices_of_a_product_have_a_closed_form(flyer):
    """The mass of a disk is proportional to d²ρ, whose moments are known."""
    inputs = {
        "flyer.diameter": {"distribution": "uniform", "from": "1 cm", "to": "3 cm"},
        "film.areal_density": {"distribution": "uniform", "from": "0.5 g/m^2", "to": "1.5 g/m^2"},
    }
    (found,) = sensitivity_indices(inquire(flyer, outputs="own_mass", inputs=inputs, points=4096))
    # moments of x² over [1, 3] and of y over [0.5, 1.5]
    first = np.array([(3.0**5 - 1.0) / 10.0 - ((3.0**3 - 1.0) / 6.0) ** 2, 1.0 / 12.0])
    mean = np.array([(3.0**3 - 1.0) / 6.0, 1.0])
    relative = first / mean**2
    whole = np.prod(1.0 + relative) - 1.0
    np.testing.assert_allclose(found.first, relative / whole, atol=0.01)
    np.testing.assert_allclose(found.total, relative * (1.0 + relative[::-1]) / whole, atol=0.01)
    np.testing.assert_allclose(found.elasticity, [2.0, 1.0], rtol=1e-6)
    mass = 0.25e-4 * np.pi * 1e-3 * mean.prod()
    assert found.mean == pytest.approx(mass, rel=1e-3)
    assert found.spread == pytest.approx(mass * np.sqrt(whole), rel=1e-2)
    assert found.next == "flyer.diameter"
    np.testing.assert_allclose(found.low[0] / found.nominal, (1.05 / 2.0) ** 2, rtol=1e-9)
    np.testing.assert_allclose(found.high[1] / found.nominal, 1.475, rtol=1e-9)


def test_the_files_own_uncertainties_and_their_first_order_spread(flyer):
    """Small spreads: variance is the sum of squared slopes times variances (predict's method)."""
    inquiry = inquire(flyer, outputs=["payload", "temperature"], at={"altitude": "72 km"})
    payload, temperature = sensitivity_indices(inquiry)
    assert payload.names == ("film.tac_top", "film.tac_bottom")
    uncertainty = lf.propagate(flyer, lf.predict(flyer.build(), at=[72e3]), samples=0)
    expected = uncertainty.first_order["at[0].temperature_k"]
    assert temperature.spread == pytest.approx(expected, rel=0.02)
    lift = uncertainty.first_order["at[0].lift_n"] / 9.8
    assert payload.spread == pytest.approx(lift, rel=0.02)
    assert payload.first.sum() == pytest.approx(1.0, abs=0.03)
    half = np.sqrt(1.0 - 0.75 * payload.first.max()) * payload.spread
    assert payload.spread_after_halving == pytest.approx(half)


def test_outputs_that_some_samples_lack_are_refused(flyer):
    inputs = {"film.tac_top": "0.88 ± 0.02"}
    inquiry = inquire(flyer, outputs="levitation_irradiance", at={"altitude": "72 km"},
                      inputs=inputs, points=64)  # fmt: skip
    with pytest.raises(lf.ConfigurationError, match="% of the samples have none"):
        sensitivity_indices(inquiry)


@pytest.mark.parametrize(
    ("section", "message"),
    [
        ({"outputs": "payload"}, '"payload" needs altitude'),
        ({"outputs": "paylaod", "at": {"altitude": "70 km"}}, 'did you mean "payload"'),
        ({"at": {"altitude": ["70 km", "71 km"]}}, "is not one value"),
        ({"at": {"altitud": "70 km"}}, 'did you mean "altitude"'),
        ({"at": {"altitude": "70 km"}, "inputs": {"film.tac_top": 0.8}}, "is not uncertain"),
    ],
)
def test_mistakes_are_said(flyer, section, message):
    with pytest.raises(lf.ConfigurationError, match=message):
        inquire(flyer, **section)


def test_without_uncertainties_it_says_what_to_write():
    flyer = lf.FlyerFile(
        flyer={"diameter": "2 cm"}, film=FILM | {"tac_top": 0.8, "tac_bottom": 0.9}
    )
    with pytest.raises(lf.ConfigurationError, match="nothing is uncertain"):
        inquire(flyer, at={"altitude": "70 km"})
