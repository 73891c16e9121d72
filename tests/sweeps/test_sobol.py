"""Sobol indices beside their closed form, and elasticities beside exponents."""

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.config.sections import KineticSection
from lightflyer.search.problem import make_problem
from lightflyer.search.sobol import make_inquiry, sensitivity_indices
from lightflyer.sweeps.sections import OptimiseSection, SensitivitySection

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
    assert found.elasticity == pytest.approx(dict(zip(inputs, [2.0, 1.0], strict=True)), rel=1e-6)
    mass = 0.25e-4 * np.pi * 1e-3 * mean.prod()
    assert found.mean == pytest.approx(mass, rel=1e-3)
    assert found.spread == pytest.approx(mass * np.sqrt(whole), rel=1e-2)
    assert found.next == "flyer.diameter"
    np.testing.assert_allclose(found.low[0] / found.nominal, (1.05 / 2.0) ** 2, rtol=1e-9)
    np.testing.assert_allclose(found.high[1] / found.nominal, 1.475, rtol=1e-9)


def test_a_models_own_error_has_a_share_but_is_not_to_be_measured(flyer):
    configuration = flyer.model_copy(update={"force": KineticSection(model="kinetic")})
    inputs = {
        "force.force_error": {"distribution": "normal", "mean": 0, "standard_deviation": 1},
        "film.areal_density": {
            "distribution": "normal", "mean": "1 g/m^2", "standard_deviation": "0.01 g/m^2"
        },
    }  # fmt: skip
    section = {"outputs": "payload", "at": {"altitude": "78 km"}, "inputs": inputs}
    (found,) = sensitivity_indices(inquire(configuration, points=256, **section))
    assert found.first[0] > found.first[1]
    assert found.ranked
    assert found.next == "film.areal_density"
    assert np.isnan(found.elasticity["force.force_error"])
    (few,) = sensitivity_indices(inquire(configuration, points=2, **section))
    assert not few.ranked


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


@pytest.mark.parametrize("correlation", [0.9, -0.5])
def test_errors_that_are_correlated_count_as_one_input(correlation):
    """Small spreads: shares from slopes and the covariance, the spread as predict finds it."""
    film = FILM | {"tac_correlation": correlation, "absorptance": "0.75 ± 0.01"}
    flyer = lf.FlyerFile(
        flyer={"diameter": "2 cm"}, film=film, environment={"atmosphere": "lu2023"}
    )
    (found,) = sensitivity_indices(inquire(flyer, outputs="lift", at={"altitude": "72 km"}))
    pair = ("film.tac_top", "film.tac_bottom")
    assert set(found.groups) == {("film.absorptance",), pair}
    uncertainty = lf.propagate(flyer, lf.predict(flyer.build(), at=[72e3]), samples=0)
    assert found.spread == pytest.approx(uncertainty.first_order["at[0].lift_n"], rel=0.03)
    values = {"film.absorptance": 0.75, "film.tac_top": 0.8, "film.tac_bottom": 0.9}
    move = {
        name: 0.01 * slope * found.nominal / values[name]
        for name, slope in found.elasticity.items()
    }
    top, bottom, light = (move[name] for name in (*pair, "film.absorptance"))
    together = top**2 + bottom**2 + 2.0 * correlation * top * bottom
    row, other = found.groups.index(pair), found.groups.index(("film.absorptance",))
    assert found.first[row] == pytest.approx(together / (together + light**2), abs=0.02)
    assert found.total[other] == pytest.approx(light**2 / (together + light**2), abs=0.02)
    reach = (found.high[row] - found.low[row]) / 2.0
    assert reach == pytest.approx(1.96 * np.sqrt(together), rel=0.05)


def test_all_inputs_correlated_are_one_that_does_everything(flyer):
    film = flyer.film.model_copy(update={"tac_correlation": lf.Measured(0.5)})
    correlated = flyer.model_copy(update={"film": film})
    (found,) = sensitivity_indices(inquire(correlated, outputs="lift", at={"altitude": "72 km"}))
    assert found.names == ("film.tac_top and film.tac_bottom",)
    np.testing.assert_allclose([*found.first, *found.total], 1.0, atol=0.01)


def test_samples_of_sweeps_and_optima_have_the_files_correlation(flyer):
    film = flyer.film.model_copy(update={"tac_correlation": lf.Measured(-0.7)})
    correlated = flyer.model_copy(update={"film": film})
    over = {"film.tac_top": "0.8 ± 0.01", "film.tac_bottom": "0.9 ± 0.02", "altitude": "70 km"}
    for method in ("sobol", "latin-hypercube", "random"):
        drawn = lf.sweep(correlated, over, ["own_mass"], method=method, points=4096)
        top, bottom = drawn["film.tac_top"].values, drawn["film.tac_bottom"].values
        assert np.corrcoef(top, bottom)[0, 1] == pytest.approx(-0.7, abs=0.02)
        assert bottom.std() == pytest.approx(0.02, rel=0.03)
    section = OptimiseSection.model_validate(
        {
            "maximise": "payload",
            "over": {"altitude": {"from": "60 km", "to": "80 km"}},
            "uncertainty": {},
        }
    )
    samples = make_problem(correlated, section).samples
    assert np.corrcoef(*samples.values())[0, 1] == pytest.approx(-0.7, abs=0.02)


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
