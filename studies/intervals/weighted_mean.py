"""Means of several samples, as ``lab tac`` prints them for several runs.

Samples vary more than the uncertainty of each, which is stated. Where they do not vary at all, the
interval is wider than it need be by intention (98 to 99 % instead of 95 %); that is not in the
table.
"""

import numpy as np
from trial import Trial

from lightflyer import lab

COMMAND = "mean of several samples"

SAMPLES = (2, 3, 5)
MEAN, BETWEEN = 0.8, 0.06


def trials(seed: int) -> list[Trial]:
    """Samples with uncertainties of different size."""
    rng = np.random.default_rng([seed, 12])
    found = []
    for count in SAMPLES:
        own = rng.uniform(0.01, 0.04, count)
        values = MEAN + rng.normal(0.0, BETWEEN, count) + rng.normal(0.0, own)
        mean = lab.weighted_mean(
            [lab.Estimate.normal(*one) for one in zip(values, own, strict=True)]
        )
        found.append(Trial(f"mean, {count} samples", MEAN, *mean.interval))
    return found
