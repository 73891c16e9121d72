import json
import sys
from importlib import resources

import jax.numpy as jnp
import numpy as np
import numpyro
import numpyro.infer.util
import pytest

import lightflyer as lf
from lightflyer.calibration import Points, posterior
from lightflyer.calibration.bayes import CHAINS, SCATTER, Posterior, probabilistic_model

pytestmark = pytest.mark.slow

PRESSURE = np.tile(np.geomspace(1.5, 25.0, 7), 2)
DIAMETER = np.repeat([0.02, 0.03], 7)
SCATTER_MADE = 0.04
DRAWS = 1400  # scatter mixes slowest: about one draw in ten is independent
FEW = 400  # enough for the chains to agree


@pytest.fixture(scope="module")
def file():
    """The paper's disk, which the command takes where no flyer file is named."""
    template = resources.files("lightflyer") / "data" / "flyer-chamber.toml"
    with resources.as_file(template) as path:
        return lf.read_flyer_file(path)


def log_light(file, c_fm, c_cont):
    """Log-irradiance to levitate of the samples."""
    setup = file.build()
    disk = lf.Disk(setup.flyer.film, 0.5 * DIAMETER)
    state = setup.environment.state(PRESSURE)
    return np.log(lf.levitate(disk, state, lf.Lu2023(c_fm, c_cont)).irradiance)


def fit_of(file, *, stated):
    """Calibration of synthetic points, with their uncertainty stated or left to be estimated."""
    light = np.exp(log_light(file, 0.4, 3.0))
    light = light * np.exp(SCATTER_MADE * np.random.default_rng(7).standard_normal(light.size))
    numbers = {"pressure": PRESSURE, "irradiance": light, "diameter": DIAMETER}
    if stated:
        numbers["irradiance_uncertainty"] = SCATTER_MADE * light
    return lf.calibrate(file, points=Points("synthetic.csv", ["synthetic"] * light.size, numbers))


@pytest.fixture(scope="module")
def estimated(file):
    """Fit and posterior where the scatter is estimated."""
    fit = fit_of(file, stated=False)
    return fit, posterior(fit, samples=DRAWS, seed=1)


@pytest.fixture(scope="module")
def stated(file):
    """Fit where uncertainties are stated."""
    return fit_of(file, stated=True)


def quantile_error(draws):
    """Standard error of the 2.5 % quantile of independent normal draws, in deviations."""
    density = 0.0584  # of the normal distribution at its 2.5 % quantile
    return np.sqrt(0.025 * 0.975 / draws) / density


def assert_agrees(fit, drawn):
    """Posterior and profile agree to 4 standard errors of sampling, at least.

    Under priors flat in logarithms the two differ only as the model is not linear within the
    interval, by some 0.02 standard uncertainties here. Quantiles count as if from half as many
    independent draws as the mean, since extremes follow one another longer.
    """
    count = len(fit.names)
    # the posterior's scatter is one for all points; intervals allow for an uneven one
    jacobian = fit.problem.linearise(np.log(fit.values)).jacobian
    even = fit.scatter * np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian))) * fit.values
    wider = (fit.standard_uncertainties / even)[:, None]
    best = fit.values[:, None]
    intervals = best * (fit.intervals / best) ** (1.0 / wider)
    error = quantile_error(0.5 * drawn.effective_draws[:count, None])
    apart = (drawn.intervals[:count] - intervals) / even[:, None]
    assert np.all(np.abs(apart) < 4.0 * error), apart
    assert np.all(error < 0.2)  # the check would catch an interval a third too long


def test_intervals_are_those_of_the_profile(estimated):
    fit, drawn = estimated
    assert drawn.names == ["c_fm", "c_cont", SCATTER]
    assert drawn.draws.shape == (CHAINS, DRAWS // CHAINS, 3)
    assert drawn.draws.dtype == np.float64
    assert_agrees(fit, drawn)


def test_scatter_holds_the_estimate(estimated):
    fit, drawn = estimated
    low, high = drawn.intervals[drawn.names.index(SCATTER)]
    assert low < fit.scatter < high
    # chi-squared with 12 degrees of freedom: half its 95 % interval is about 0.5 of the scatter
    assert 0.5 * (high - low) == pytest.approx(0.5 * fit.scatter, rel=0.3)


def test_likelihood_of_stated_uncertainties_is_that_of_the_fit(file, stated):
    """Away from the fit the log-density falls by half of what the cost grows."""
    moved = np.log(stated.values) + np.array([0.02, -0.05])
    with lf.float64():
        model = probabilistic_model(stated)
        here, away = (
            float(numpyro.infer.util.log_density(model, (), {}, {"parameters": jnp.asarray(x)})[0])
            for x in (np.log(stated.values), moved)
        )
    residuals = np.log(stated.points.irradiance) - log_light(file, *np.exp(moved))
    growth = np.sum(residuals**2 - stated.residuals**2) / SCATTER_MADE**2
    assert here - away == pytest.approx(0.5 * growth, rel=1e-6)


def test_command_draws_the_same_with_the_same_seed(estimated, prints, tmp_path):
    fit, drawn = estimated
    columns = (PRESSURE, fit.points.irradiance, DIAMETER)
    rows = [
        "synthetic," + ",".join(map(repr, map(float, row))) for row in zip(*columns, strict=True)
    ]
    header = "sample,pressure [Pa],irradiance [W/m^2],diameter [m]"
    points, out = tmp_path / "points.csv", tmp_path / "fit"
    points.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")
    arguments = ["--posterior", "--samples", FEW, "--seed", "1", "--out", out, "--json"]
    printed = json.loads(prints("calibrate", points, *arguments))
    written = json.loads((out / "calibration.json").read_text(encoding="utf-8"))
    assert printed == written
    assert printed["posterior"]["draws"] == FEW
    lines = (out / "posterior.csv").read_text(encoding="utf-8").splitlines()
    assert lines[0] == "chain,c_fm,c_cont,scatter"
    table = np.loadtxt(lines[1:], delimiter=",")
    first = drawn.draws[:, : FEW // CHAINS]
    np.testing.assert_allclose(table[:, 1:], first.reshape(-1, 3), rtol=1e-7)


def test_summary_and_draws(estimated):
    _, drawn = estimated
    summary = drawn.summary()
    assert summary["draws"] == DRAWS == drawn.of("c_fm").size
    assert summary["parameters"]["c_fm"]["mean"] == pytest.approx(drawn.of("c_fm").mean())
    assert np.all(drawn.r_hat < 1.05)


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
