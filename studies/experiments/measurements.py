"""What is published of each experiment, and samples of its uncertainties."""

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.stats import norm, qmc

EXPERIMENTS = Path(__file__).parent / "experiments.toml"
SAMPLES = 65536  # a power of two
PERCENTILES = (2.5, 50.0, 97.5)
SEED = 1
_KINDS = {"printed", "derived", "assumed"}


@dataclass(frozen=True)
class Number:
    """A published or assumed number.

    Attributes
    ----------
    value : float
        The middle.
    uncertainty : float
        Standard deviation of a normal distribution; 0 where there are ends, or none is known.
    low, high : float
        Ends between which each value is equally likely; the middle twice where there are none.
    lowest, highest : float
        What is possible at least and at most; values beyond are taken for these.
    """

    value: float
    uncertainty: float
    low: float
    high: float
    lowest: float = -math.inf
    highest: float = math.inf

    def at(self, share):
        """Value below which a share of all values is.

        Parameters
        ----------
        share : array, shape (...)

        Returns
        -------
        array, shape (...)
        """
        if self.uncertainty:
            found = self.value + self.uncertainty * norm.ppf(share)
        else:
            found = self.low + (self.high - self.low) * np.asarray(share)
        return np.clip(found, self.lowest, self.highest)


def number(entry) -> Number:
    """A number of the file.

    Raises
    ------
    ValueError
        If it has no source, or not one value or two ends.
    """
    if entry.get("kind") not in _KINDS or not entry.get("source"):
        raise ValueError(f"{entry}: needs a source, and a kind of {', '.join(sorted(_KINDS))}")
    if ("value" in entry) == ("low" in entry and "high" in entry):
        raise ValueError(f"{entry}: needs value, or low and high")
    low = entry.get("low", entry.get("value"))
    high = entry.get("high", entry.get("value"))
    uncertainty = entry.get("uncertainty", 0.0)
    bounds = entry.get("lowest", -math.inf), entry.get("highest", math.inf)
    return Number(0.5 * (low + high), uncertainty, low, high, *bounds)


def read():
    """The file, as it is.

    Returns
    -------
    dict
    """
    return tomllib.loads(EXPERIMENTS.read_text("utf-8"))


def shares(names, count=SAMPLES):
    """Samples between 0 and 1, evenly spread over all names together.

    Parameters
    ----------
    names : sequence of str
    count : int
        A power of two.

    Returns
    -------
    dict of str to array, shape (count,)
    """
    sobol = qmc.Sobol(len(names), rng=np.random.default_rng(SEED))
    return dict(zip(names, sobol.random_base2(round(math.log2(count))).T, strict=True))


def middle(names):
    """One sample in the middle of all, as :func:`shares`."""
    return {name: np.array([0.5]) for name in names}


def interval(values, weights=None, digits=3):
    """Median with the ends of the 95 % interval; None for what is infinite.

    Parameters
    ----------
    values : array, shape (n,)
    weights : array, shape (n,), optional
        Of the samples; all alike by default.
    digits : int

    Returns
    -------
    dict of str to float or None
        ``median``, ``low``, ``high``.
    """
    order = np.argsort(values)
    weights = np.ones(order.size) if weights is None else weights
    below = np.cumsum(weights[order])
    places = np.searchsorted(below, np.array(PERCENTILES) / 100.0 * below[-1])
    low, median, high = np.asarray(values)[order[places]]
    found = {"median": median, "low": low, "high": high}
    return {
        name: float(f"{value:.{digits}g}") if math.isfinite(value) else None
        for name, value in found.items()
    }
