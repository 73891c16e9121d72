"""Guesses of what is not published, and intervals of what follows."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.stats import qmc

PERCENTILES = (2.5, 50.0, 97.5)
SEED = 1


@dataclass(frozen=True)
class Guess:
    """A range in which every value is equally likely, or its logarithm.

    Attributes
    ----------
    low, high : float
    logarithmic : bool
    """

    low: float
    high: float
    logarithmic: bool = False

    def at(self, share):
        """Value below which a share of all values is."""
        if self.logarithmic:
            return self.low * (self.high / self.low) ** share
        return self.low + (self.high - self.low) * share


def drawn(guesses, count):
    """Samples of all guesses, by name; their number is a power of two."""
    shares = qmc.Sobol(len(guesses), rng=np.random.default_rng(SEED)).random_base2(
        round(math.log2(count))
    )
    return {
        name: guess.at(share)
        for (name, guess), share in zip(guesses.items(), shares.T, strict=True)
    }


def central(guesses):
    """The middle of each range, by name, as one sample."""
    return {name: np.array([guess.at(0.5)]) for name, guess in guesses.items()}


def interval(values, digits=3):
    """Median with the ends of the 95 % interval."""
    low, middle, high = np.percentile(values, PERCENTILES)
    return {
        name: float(f"{value:.{digits}g}")
        for name, value in (("median", middle), ("low", low), ("high", high))
    }
