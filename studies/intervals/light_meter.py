"""``lab thermography --light-meter``: gain, linearity and noise of a light meter, few repeats.

All readings share an error of gain, which cancels. Each has an error of linearity of its own, with
the standard uncertainty that follows from the limit of a meter of class B, and noise in every row.
"""

import numpy as np
from trial import Trial

from lightflyer import lab
from lightflyer.lab.thermography.data import standard_uncertainties

COMMAND = "lab thermography --light-meter"

REPEATS = (2, 3, 10)
DRAWS = 20_000
GAIN, LINEARITY, NOISE = 0.05, 0.02 / 3.0**0.5, 0.005  # over a reading
DARK = 0.01  # over the incident light


def trials(seed: int) -> list[Trial]:
    """Films of several absorptivities, each with its number of repeats."""
    rng = np.random.default_rng([seed, 11])
    found = []
    for count in REPEATS:
        reflectance, transmittance = rng.uniform(0.02, 0.4, 2)
        truth = {
            "reflectance": reflectance,
            "transmittance": transmittance,
            "absorptivity": 1.0 - reflectance - transmittance,
        }
        incident = 10.0 ** rng.uniform(-3.0, 3.0)
        light = incident * np.array([1.0, reflectance, transmittance, 0.0])
        shown = light * (1.0 + LINEARITY * rng.normal(size=4)) + DARK * incident
        shown = shown * (1.0 + GAIN * rng.normal())
        values = shown[:, None] * (1.0 + NOISE * rng.normal(size=(4, count)))
        spread = standard_uncertainties(lab.LIGHT, values.mean(axis=1))
        result = lab.reduce_readings(lab.Readings(lab.LIGHT, values, spread), draws=DRAWS)
        for way, estimates in (("first order", result.first_order),
                               ("Monte Carlo", result.monte_carlo)):  # fmt: skip
            found += [
                Trial(f"{name}, {way}, {count} repeats", truth[name], *one.interval)
                for name, one in result.name_properties(estimates).items()
            ]
    return found
