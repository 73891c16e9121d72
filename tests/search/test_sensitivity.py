"""Sobol indices beside their closed form, and elasticities beside exponents."""

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.force.kinetic.model import KineticSection
from lightflyer.search.problem import as_problem
from lightflyer.search.sobol import make_sensitivity_study
from lightflyer.study.sections import SensitivitySection

from ..conftest import FILM as CERTAIN

FILM = CERTAIN | {"tac_top": "0.8 ± 0.01", "tac_bottom": "0.9 ± 0.01"}


def flyer_of(film):
    return lf.FlyerFile(
        flyer={"diameter": "2 cm"},
        film=film,
        environment={"atmosphere": "lu2023"},
        force={"model": "lu2023", "force_error": 0},
    )


@pytest.fixture(scope="module")
def uncertain():
    return flyer_of(FILM)


def test_indices_of_a_product_have_a_closed_form(uncertain):
    """The mass of a disk is proportional to d²ρ, whose moments are known."""
    inputs = {
        "flyer.diameter": {"distribution": "uniform", "from": "1 cm", "to": "3 cm"},
        "film.areal_density": {"distribution": "uniform", "from": "0.5 g/m^2", "to": "1.5 g/m^2"},
    }
    (found,) = lf.sensitivity(uncertain, outputs="own_mass", inputs=inputs, points=4096)
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


def test_a_place_outside_the_models_range_is_said(uncertain):
    kinetic = uncertain.model_copy(update={"force": KineticSection(model="kinetic")})
    for altitude, said in (("80 km", False), ("80 m", True)):
        (found,) = lf.sensitivity(kinetic, at={"altitude": altitude}, points=8)
        assert any("the kinetic table ends there" in text for text in found.warnings) is said


def test_a_models_own_error_has_a_share_but_is_not_to_be_measured(uncertain):
    kinetic = uncertain.model_copy(update={"force": KineticSection(model="kinetic")})
    inputs = {
        "force.force_error": {"distribution": "normal", "mean": 0, "standard_deviation": 1},
        "film.areal_density": {
            "distribution": "normal", "mean": "1 g/m^2", "standard_deviation": "0.01 g/m^2"
        },
    }  # fmt: skip
    section = {"outputs": "payload", "at": {"altitude": "78 km"}, "inputs": inputs}
    (found,) = lf.sensitivity(kinetic, points=256, **section)
    assert found.first[0] > found.first[1]
    assert found.ranked
    assert found.next == "film.areal_density"
    assert np.isnan(found.elasticity["force.force_error"])
    (few,) = lf.sensitivity(kinetic, points=2, **section)
    assert not few.ranked


def test_a_measured_force_leaves_what_is_not_of_the_force(uncertain):
    kinetic = uncertain.model_copy(update={"force": KineticSection(model="kinetic")})
    inputs = {
        "force.sharing_error": {"distribution": "normal", "mean": 0, "standard_deviation": 1},
        "film.areal_density": {
            "distribution": "normal", "mean": "2 g/m^2", "standard_deviation": "0.3 g/m^2"
        },
    }  # fmt: skip
    section = {"outputs": "payload", "at": {"altitude": "78 km"}, "inputs": inputs}
    (found,) = lf.sensitivity(kinetic, points=1024, **section)
    removed, left = found.with_known_force
    assert left == pytest.approx(np.pi * 1e-4 * 0.3e-3, rel=0.1)  # of the disk's own mass
    assert removed == pytest.approx(1.0 - (left / found.spread) ** 2)
    assert "a force measured on the same film would remove" in " ".join(str(found).split())
    del inputs["force.sharing_error"]
    (known,) = lf.sensitivity(kinetic, points=64, **section)
    assert known.with_known_force is None


def test_the_files_own_uncertainties_and_their_first_order_spread(uncertain):
    """Small spreads: variance is the sum of squared slopes times variances (predict's method)."""
    payload, temperature = lf.sensitivity(
        uncertain, outputs=["payload", "temperature"], at={"altitude": "72 km"}
    )
    assert payload.names == ("film.tac_top", "film.tac_bottom")
    uncertainty = lf.propagate(uncertain, prediction=lf.predict(uncertain, at=[72e3]), samples=0)
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
    flyer = flyer_of(FILM | {"tac_correlation": correlation, "absorptance": "0.75 ± 0.01"})
    (found,) = lf.sensitivity(flyer, outputs="lift", at={"altitude": "72 km"})
    pair = ("film.tac_top", "film.tac_bottom")
    assert set(found.groups) == {("film.absorptance",), pair}
    uncertainty = lf.propagate(flyer, prediction=lf.predict(flyer, at=[72e3]), samples=0)
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


@pytest.mark.parametrize(("correlation", "spread"), [(0.0, 0.02), (0.95, 0.02), (0.95, 0.04)])
def test_worth_of_a_measured_difference(correlation, spread):
    """Small spreads: q is linear in the inputs, so that an observation removes Cov²/Var."""
    film = FILM | {
        "tac_top": f"0.8 ± {spread}", "tac_bottom": f"0.9 ± {spread}",
        "tac_correlation": correlation, "areal_density": "1.0 ± 0.05 g/m^2",
    }  # fmt: skip
    (found,) = lf.sensitivity(flyer_of(film), outputs="payload", at={"altitude": "72 km"})
    (one,) = found.differences
    assert (one.top, one.bottom, one.accuracy) == ("film.tac_top", "film.tac_bottom", 0.01)
    variance = 2.0 * spread**2 * (1.0 - correlation)
    assert one.known == pytest.approx(np.sqrt(variance), rel=0.03)
    slope = {
        name: found.elasticity[name] * found.nominal / value
        for name, value in (("film.tac_top", 0.8), ("film.tac_bottom", 0.9))
    }
    top, bottom = slope.values()
    shared = spread**2 * (top + correlation * bottom - bottom - correlation * top)
    removed = shared**2 / (variance + 0.01**2) / found.spread**2
    assert one.removed == pytest.approx(removed, abs=0.02)
    assert found.summary()["measured_differences"][0]["standard_deviation_after"] == pytest.approx(
        found.spread * np.sqrt(1.0 - one.removed)
    )
    assert "measuring it to ± 0.01 would remove" in " ".join(str(found).split())


def test_no_difference_where_one_face_is_known(uncertain):
    (found,) = lf.sensitivity(
        uncertain, outputs="lift", at={"altitude": "72 km"}, points=64,
        inputs={"film.tac_top": "0.8 ± 0.01", "flyer.diameter": "2.0 ± 0.1 cm"},
    )  # fmt: skip
    assert found.differences == ()


def test_all_inputs_correlated_are_one_that_does_everything():
    correlated = flyer_of(FILM | {"tac_correlation": 0.5})
    (found,) = lf.sensitivity(correlated, outputs="lift", at={"altitude": "72 km"}, points=2048)
    assert found.names == ("film.tac_top and film.tac_bottom",)
    np.testing.assert_allclose([*found.first, *found.total], 1.0, atol=0.02)
    assert np.all(np.abs(found.first - 1.0) < 2.0 * found.first_interval)


def test_intervals_know_that_the_points_of_a_sequence_avoid_each_other(uncertain):
    """Four times the points make them much shorter than half."""
    few, many = (
        lf.sensitivity(uncertain, outputs="own_mass", points=points,
                       inputs={"flyer.diameter": "2.0 ± 0.1 cm",
                               "film.areal_density": "1.0 ± 0.1 g/m^2"})[0]
        for points in (256, 1024)
    )  # fmt: skip
    assert np.all(many.first_interval < 0.4 * few.first_interval)


def test_intervals_are_as_wide_as_indices_of_other_seeds_scatter(uncertain):
    """Student's 97.5 % quantile of 8 sequences is 2.365 standard errors."""
    inputs = {"flyer.diameter": "2.0 ± 0.3 cm", "film.areal_density": "1.0 ± 0.3 g/m^2"}
    found = [
        lf.sensitivity(uncertain, outputs="own_mass", points=64, inputs=inputs, seed=seed)[0]
        for seed in range(16)
    ]
    for name in ("first", "total"):
        scatter = np.std([getattr(one, name) for one in found], axis=0, ddof=1)
        stated = np.mean([getattr(one, f"{name}_interval") for one in found], axis=0) / 2.365
        assert np.all((stated > 0.7 * scatter) & (stated < 1.6 * scatter))


def test_samples_of_sweeps_and_optima_have_the_files_correlation():
    correlated = flyer_of(FILM | {"tac_correlation": -0.7})
    over = {"film.tac_top": "0.8 ± 0.01", "film.tac_bottom": "0.9 ± 0.02", "altitude": "70 km"}
    for method in ("sobol", "latin-hypercube", "random"):
        drawn = lf.sweep(correlated, over=over, outputs="own_mass", method=method, points=4096)
        top, bottom = drawn["film.tac_top"].values, drawn["film.tac_bottom"].values
        assert np.corrcoef(top, bottom)[0, 1] == pytest.approx(-0.7, abs=0.02)
        assert bottom.std() == pytest.approx(0.02, rel=0.03)
    asked = {"maximise": "payload", "over": {"altitude": {"from": "60 km", "to": "80 km"}}}
    samples = as_problem(correlated, None, None, uncertainty={}, **asked).samples
    assert np.corrcoef(*samples.values())[0, 1] == pytest.approx(-0.7, abs=0.02)


def test_outputs_that_some_samples_lack_are_refused(uncertain):
    asked = {"outputs": "levitation_irradiance", "at": {"altitude": "72 km"}, "points": 64}
    with pytest.raises(lf.ConfigurationError, match="% of the samples have none"):
        lf.sensitivity(uncertain, inputs={"film.tac_top": "0.88 ± 0.02"}, **asked)


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
def test_mistakes_are_said(uncertain, section, message):
    with pytest.raises(lf.ConfigurationError, match=message):
        lf.sensitivity(uncertain, **section)


def test_without_uncertainties_it_says_what_to_write(flyer):
    with pytest.raises(lf.ConfigurationError, match="no number is uncertain"):
        lf.sensitivity(flyer, at={"altitude": "70 km"})


def test_a_study_says_all_that_is_asked(flyer):
    section = SensitivitySection(at={"altitude": "70 km"}, inputs={"film.tac_top": "0.8 ± 0.01"})
    study = make_sensitivity_study(flyer.design(), section)
    with pytest.raises(lf.ParameterError, match="already states"):
        lf.sensitivity(study, points=12)
