r"""Posterior of a calibration's parameters, drawn by NUTS with numpyro (an extra).

The likelihood is that of :func:`lightflyer.calibrate`: log-irradiance scatters normally about the
model,

.. math:: \ln I_i^\mathrm{measured} \sim N(\ln I_i^\mathrm{model}, \sigma_i^2),

with the points' own uncertainties, or one unknown scatter :math:`\sigma` for all. Everything else
is taken exactly as given: the draws do not contain the ± of the flyer file, of columns, or of
instruments. Priors are flat
in the logarithm: of parameters from 1e-6 to the largest possible value, or to 1e6 where there is
none (times the start for parameters with a unit), and of the scatter from 1e-4 to 10.
"""

from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.array.namespace import by_jax, load_jax, xp
from lightflyer.calibration.calibration import Calibration
from lightflyer.core.errors import ConvergenceError, MissingExtraError, ParameterError
from lightflyer.core.progress import report
from lightflyer.core.text import rounded
from lightflyer.files.result_text import Parts, PrintedResult, table_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCATTER = "scatter"  # Name of the scatter of log-irradiance among the draws, where it is estimated
CHAINS = 4  # Number of chains; their agreement shows that they converged
HIGHEST_R_HAT = 1.05  # R-hat above which the chains disagree and :func:`posterior` raises
HIGHEST_DIVERGENT = 0.01  # Share of divergent draws above which :func:`posterior` raises

_HEADINGS = ("posterior\nat given inputs", "mean", "standard\ndeviation", "95 % interval",
             "R-hat", "effective")  # fmt: skip
_FEWEST = 100  # draws, below which R-hat says nothing
_SCATTER_RANGE = (1e-4, 10.0)  # of log-irradiance
_INSIDE = 1e-3  # distance of a chain's start from a bound, of the log-parameter
_TAILS = (0.025, 0.975)  # of a 95 % interval


@dataclass(frozen=True, repr=False)
class Posterior(PrintedResult):
    """Draws from the posterior of a calibration."""

    names: list[str]  #: Names of the parameters; last :data:`SCATTER`, where it is estimated
    #: shape (chains, draws, p); parameters in SI units; scatter of log-irradiance [1]
    draws: np.ndarray
    r_hat: np.ndarray  #: shape (p,); split R-hat, 1 where chains agree
    #: shape (p,); number of independent draws whose means would be as accurate
    effective_draws: np.ndarray
    divergences: int  #: Draws where the integration failed

    @property
    def mean(self) -> np.ndarray:
        """Mean of the draws, shape (p,)."""
        return self.draws.mean(axis=(0, 1))

    @property
    def standard_deviations(self) -> np.ndarray:
        """Standard deviations of the draws, shape (p,)."""
        return self.draws.std(axis=(0, 1), ddof=1)

    @property
    def intervals(self) -> np.ndarray:
        """95 % intervals with 2.5 % of the draws on either side, shape (p, 2)."""
        return np.quantile(self.draws, _TAILS, axis=(0, 1)).T

    def of(self, name: str) -> np.ndarray:
        """Draws of one parameter, one chain after another, shape (chains · draws,)."""
        return self.draws[..., self.names.index(name)].ravel()

    def plot(self) -> "Figure":
        """Draw histograms of the parameters, chain by chain."""
        from lightflyer.calibration.figures import posterior_figure

        return posterior_figure(self)

    def require_converged(self) -> None:
        """Raise :class:`ConvergenceError` if chains disagree or too many draws diverged."""
        worst = int(np.argmax(self.r_hat))
        # written so that a NaN fails too
        if not np.all(self.r_hat <= HIGHEST_R_HAT):
            raise ConvergenceError(
                f"posterior: chains disagree about {self.names[worst]} "
                f"(R-hat {self.r_hat[worst]:.3f}); draw more samples, or fit fewer parameters"
            )
        count = self.draws.shape[0] * self.draws.shape[1]
        if self.divergences > HIGHEST_DIVERGENT * count:
            raise ConvergenceError(
                f"posterior: {self.divergences} of {count} draws diverged; fit fewer parameters"
            )

    def text_parts(self) -> Parts:
        rows = (
            (
                name,
                f"{found['mean']:.4g}",
                rounded(found["standard_deviation"]),
                "{:.4g} to {:.4g}".format(*found["interval_95"]),
                f"{found['r_hat']:.3f}",
                f"{found['effective_draws']:.0f}",
            )
            for name, found in self.summary()["parameters"].items()
        )
        yield table_of(_HEADINGS, rows)
        chains, draws = self.draws.shape[:2]
        yield f"{chains * draws} draws in {chains} chains, {self.divergences} divergent"

    def summary(self) -> dict[str, Any]:
        """The posterior as a JSON object, without its draws."""
        columns = (
            self.mean,
            self.standard_deviations,
            self.intervals,
            self.r_hat,
            self.effective_draws,
        )
        return {
            "parameters": {
                name: {
                    "mean": float(mean),
                    "standard_deviation": float(spread),
                    "interval_95": [float(end) for end in interval],
                    "r_hat": float(r_hat),
                    "effective_draws": float(effective),
                }
                for name, mean, spread, interval, r_hat, effective in zip(
                    self.names, *columns, strict=True
                )
            },
            "interval_95": "at the inputs as given, without their ±",
            "chains": self.draws.shape[0],
            "draws": self.draws.shape[0] * self.draws.shape[1],
            "divergences": self.divergences,
        }


def posterior(
    calibration: Calibration,
    *,
    samples: int = 2000,
    warmup: int = 300,
    seed: int = 0,
) -> Posterior:
    """Draw from the posterior of a calibration's parameters, by NUTS.

    Parameters
    ----------
    calibration : Calibration
        From :func:`lightflyer.calibrate`; the chains start at its values.
    samples : int
        Draws to keep in all :data:`CHAINS` chains together; rounded up to a multiple of them.
    warmup : int
        Draws of each chain that adapt the sampler and are discarded.
    seed : int
        Seed of the draws; the same seed gives the same draws on the same machine.

    Returns
    -------
    Posterior

    Raises
    ------
    MissingExtraError
        If numpyro is not installed.
    ParameterError
        If fewer than 100 samples or warm-up draws are asked for, or the seed is negative.
    ConvergenceError
        If the chains disagree or too many draws diverge.

    Notes
    -----
    The draws are at the inputs as given: unlike the calibration's total intervals they do not
    contain the inputs' uncertainties. Priors are flat in the logarithm of each parameter and of
    the scatter. Where uncertainties are
    stated, the likelihood has those of ``calibration.uncertainty``.
    """
    numpyro = _numpyro()
    for name, number in (("samples", samples), ("warmup", warmup)):
        if number < _FEWEST:
            raise ParameterError(f"{name} must be at least {_FEWEST}, got {number}")
    if seed < 0:
        raise ParameterError(f"seed must not be negative, got {seed}")
    names = [*calibration.names, *([SCATTER] if calibration.estimated_scatter else [])]
    with by_jax():
        low, high = _prior_ends(calibration)
        least, most = np.log(_SCATTER_RANGE)
        start = {"parameters": np.clip(np.log(calibration.values), low + _INSIDE, high - _INSIDE)}
        if calibration.estimated_scatter:
            scatter = np.log(calibration.uncertainty[:1])
            start[SCATTER] = np.clip(scatter, least + _INSIDE, most - _INSIDE)
        mcmc = numpyro.infer.MCMC(
            numpyro.infer.NUTS(
                probabilistic_model(calibration),
                dense_mass=True,  # coefficients are correlated
                forward_mode_differentiation=True,  # few parameters
                init_strategy=numpyro.infer.init_to_value(values=start),
            ),
            num_warmup=warmup,
            num_samples=-(-samples // CHAINS),
            num_chains=CHAINS,
            chain_method="vectorized",
            progress_bar=False,
        )
        report(f"drawing {samples:,} samples from the posterior")
        mcmc.run(load_jax().random.PRNGKey(seed), extra_fields=("diverging",))
        found = {k: np.asarray(v) for k, v in mcmc.get_samples(group_by_chain=True).items()}
        divergences = int(np.sum(mcmc.get_extra_fields()["diverging"]))
        draws = np.exp(
            np.concatenate([found[k] for k in ("parameters", SCATTER) if k in found], -1)
        )
        result = Posterior(
            names=names,
            draws=draws,
            r_hat=np.asarray(numpyro.diagnostics.split_gelman_rubin(draws)),
            effective_draws=np.asarray(numpyro.diagnostics.effective_sample_size(draws)),
            divergences=divergences,
        )
    result.require_converged()
    return result


def _numpyro() -> ModuleType:
    try:
        import numpyro.diagnostics
        import numpyro.infer
    except ImportError as error:
        raise MissingExtraError(
            "the posterior needs numpyro: pip install 'lightflyer[posterior]'"
        ) from error
    return numpyro


def _prior_ends(calibration: Calibration) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper ends of the priors of the log-parameters, shape (p,) each."""
    ranges = [parameter.log_bounds for parameter in calibration.problem.parameters]
    lower, upper = np.array(ranges).T
    return lower, upper


def probabilistic_model(calibration: Calibration) -> Callable[[], None]:
    """Priors and likelihood, as numpyro takes them."""
    numpyro = _numpyro()
    distributions = numpyro.distributions
    measured = np.log(calibration.points.irradiance)
    log_pressure = np.log(calibration.points.pressure)
    ends = _prior_ends(calibration)
    least, most = np.log(_SCATTER_RANGE)

    def model() -> None:
        parameters = numpyro.sample("parameters", distributions.Uniform(*ends).to_event(1))
        spread: Any = calibration.uncertainty
        if calibration.estimated_scatter:
            prior = distributions.Uniform(least, most).expand([1]).to_event(1)
            spread = xp.exp(numpyro.sample(SCATTER, prior))
        predicted = calibration.problem.model.log_irradiance(parameters, log_pressure)
        numpyro.sample("measured", distributions.Normal(predicted, spread), obs=measured)

    return model
