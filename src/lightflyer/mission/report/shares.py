"""What a finite number of flights leaves open."""

import numpy as np

CONFIDENCE = 0.95  # Of the intervals of shares

_INTERVAL = (2.5, 50.0, 97.5)  # Percentiles of a 95 % interval and its median


def binomial_interval(counts: np.ndarray, trials: int) -> tuple[np.ndarray, np.ndarray]:
    """Interval of a share that was counted, by Clopper and Pearson; [ClopperPearson1934]_."""
    from scipy.special import betaincinv

    tail = 0.5 * (1.0 - CONFIDENCE)
    counts = np.asarray(counts)
    some, missed = np.maximum(counts, 1), np.maximum(trials - counts, 1)
    low = betaincinv(some, trials - some + 1, tail)
    high = betaincinv(trials - missed + 1, missed, 1.0 - tail)
    return np.where(counts > 0, low, 0.0), np.where(counts < trials, high, 1.0)


def interval_of(values: np.ndarray) -> dict[str, float]:
    """Median of flights, and what 95 % of them are between."""
    low, median, high = np.percentile(values, _INTERVAL)
    return {"low": float(low), "median": float(median), "high": float(high)}
