import json
import sys
from dataclasses import dataclass, replace
from importlib import resources

import jax
import numpy as np
import numpyro
import numpyro.infer.util
import pytest
from scipy import special, stats

import lightflyer as lf
from lightflyer.calibration import Points, posterior
from lightflyer.calibration.bayes import CHAINS, SCATTER, Posterior, probabilistic_model

SCATTER_MADE = 0.04
DRAWS = 1000  # scatter mixes slowest: about one draw in ten is independent
FREEDOM = 12  # 14 points, 2 parameters


def fit_of(*, stated):
    """Calibration of synthetic points, with their uncertainty stated or left to be estimated."""
    template = resources.files("lightflyer") / "data" / "flyer-chamber.toml"
    with resources.as_file(template) as path:
        setup = lf.read_flyer_file(path).build()
    pressure, diameter = np.tile(np.geomspace(1.5, 25.0, 7), 2), np.repeat([0.02, 0.03], 7)
    state = setup.environment.state(pressure)
    disk = lf.Disk(setup.flyer.film, 0.5 * diameter)
    light = lf.levitate(disk, state, lf.Lu2023(0.4, 3.0)).irradiance
    light = light * np.exp(SCATTER_MADE * np.random.default_rng(7).standard_normal(light.size))
    numbers = {"pressure": pressure, "irradiance": light, "diameter": diameter}
    if stated:
        numbers["irradiance_uncertainty"] = SCATTER_MADE * light
    return lf.calibrate(setup, points=Points("synthetic.csv", ["synthetic"] * light.size, numbers))


@dataclass(frozen=True)
class Linear:
    """A model that is linear in its log-parameters, whose posterior is known."""

    best: np.ndarray
    value: np.ndarray
    jacobian: np.ndarray

    def log_irradiance(self, parameters, log_pressure):
        return self.value + self.jacobian @ (parameters - self.best)


@pytest.fixture(scope="module")
def estimated():
    """Fit and posterior where the scatter is estimated."""
    fit = fit_of(stated=False)
    best = np.log(fit.values)
    here = fit.problem.linearise(best)
    model = Linear(best, here.value, here.jacobian)
    fit = replace(fit, problem=replace(fit.problem, model=model))
    return fit, posterior(fit, samples=DRAWS, seed=1)


@pytest.fixture(scope="module")
def stated():
    """Fit where uncertainties are stated."""
    return fit_of(stated=True)


@pytest.mark.slow
def test_draws_are_those_of_the_closed_form(estimated):
    """Under flat priors: Student's distribution of the parameters, inverse chi of the scatter.

    To 4 standard errors of sampling; quantiles count as if from half as many independent draws
    as the mean, since extremes follow one another longer.
    """
    fit, drawn = estimated
    assert drawn.names == ["c_fm", "c_cont", SCATTER]
    assert drawn.draws.shape == (CHAINS, DRAWS // CHAINS, 3)
    assert drawn.draws.dtype == np.float64
    assert np.all(drawn.r_hat < 1.05)
    jacobian = fit.problem.model.jacobian
    spread = fit.scatter * np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))
    error = np.sqrt(0.025 * 0.975 / (0.5 * drawn.effective_draws)) / stats.norm.pdf(1.96)
    assert np.all(error[:2] < 0.2)  # the check would catch an interval a third too long
    half = stats.t.ppf(0.975, FREEDOM) * spread[:, None] * [-1.0, 1.0]
    apart = np.log(drawn.intervals[:2]) - np.log(fit.values)[:, None] - half
    assert np.all(np.abs(apart) < 4.0 * error[:2, None] * spread[:, None]), apart
    scatter = np.log(drawn.of(SCATTER) / fit.scatter)
    mean = 0.5 * (np.log(0.5 * FREEDOM) - special.digamma(0.5 * FREEDOM))
    assert scatter.mean() == pytest.approx(
        mean, abs=4.0 * scatter.std() / np.sqrt(drawn.effective_draws[2])
    )
    ends = fit.scatter * np.sqrt(FREEDOM / stats.chi2.ppf([0.975, 0.025], FREEDOM))
    assert drawn.intervals[2] == pytest.approx(ends, rel=0.2)


def test_likelihood_of_stated_uncertainties_is_that_of_the_fit(stated):
    """Away from the fit the log-density falls by half of what the cost grows."""
    best = np.log(stated.values)
    moved = best + np.array([0.02, -0.05])
    with lf.float64():
        model = probabilistic_model(stated)

        def density(parameters):
            return numpyro.infer.util.log_density(model, (), {}, {"parameters": parameters})[0]

        here, away, slope = density(best), density(moved), jax.jacfwd(density)(moved)
    found = stated.problem.linearise(moved)
    residuals = np.log(stated.points.irradiance) - found.value
    growth = np.sum(residuals**2 - stated.residuals**2) / SCATTER_MADE**2
    assert here - away == pytest.approx(0.5 * growth, rel=1e-6)
    assert slope == pytest.approx(residuals @ found.jacobian / SCATTER_MADE**2, rel=1e-6)


@pytest.mark.slow
def test_command_writes_the_draws(estimated, prints, tmp_path, monkeypatch):
    _, drawn = estimated
    asked = {}

    def known(fit, **arguments):
        asked.update(arguments, names=fit.names)
        return drawn

    monkeypatch.setattr("lightflyer.calibration.bayes.posterior", known)
    points, out = resources.files("lightflyer") / "data" / "points.csv", tmp_path / "fit"
    arguments = ["--posterior", "--samples", DRAWS, "--seed", "1", "--json"]
    arguments += ["--out", out, "--format", "svg"]
    printed = json.loads(prints("calibrate", points, *arguments))
    assert asked == {"samples": DRAWS, "seed": 1, "names": ["c_fm", "c_cont"]}
    assert printed == json.loads((out / "calibration.json").read_text(encoding="utf-8"))
    assert printed["posterior"] == drawn.summary()
    lines = (out / "posterior.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0] == "chain,c_fm,c_cont,scatter"
    chain, *table = np.loadtxt(lines[1:], delimiter=",").T
    np.testing.assert_array_equal(chain, np.repeat(np.arange(1, CHAINS + 1), DRAWS // CHAINS))
    np.testing.assert_allclose(np.transpose(table), drawn.draws.reshape(-1, 3), rtol=1e-7)


@pytest.mark.slow
def test_summary_and_draws(estimated):
    _, drawn = estimated
    summary = drawn.summary()
    assert summary["draws"] == DRAWS == drawn.of("c_fm").size
    assert summary["parameters"]["c_fm"]["mean"] == pytest.approx(drawn.of("c_fm").mean())


def test_missing_numpyro_names_the_extra(monkeypatch, stated):
    for name in [name for name in sys.modules if name.partition(".")[0] == "numpyro"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "numpyro", None)
    with pytest.raises(lf.MissingExtraError, match=r"lightflyer\[posterior\]"):
        posterior(stated)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [({"samples": 9}, "samples"), ({"warmup": 9}, "warmup"), ({"seed": -1}, "seed")],
)
def test_clear_errors(stated, arguments, says):
    with pytest.raises(lf.ParameterError, match=says):
        posterior(stated, **arguments)


@pytest.mark.parametrize(
    ("r_hat", "divergences", "says"),
    [(1.2, 0, "disagree about c_fm"), (np.nan, 0, "disagree"), (1.0, 3, "3 of 200 draws diverged")],
)
def test_not_converged(r_hat, divergences, says):
    draws = np.ones((2, 100, 1))
    drawn = Posterior(["c_fm"], draws, np.array([r_hat]), np.array([9.0]), divergences)
    with pytest.raises(lf.ConvergenceError, match=says):
        drawn.require_converged()
