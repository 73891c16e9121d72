"""``lab tac --top --bottom``: pairs of runs of :mod:`tac` on one bench, by the kinetic law.

A sample that is mounted anew has another coefficient; where each face is mounted once, that is no
part of the truth, because the command says that one run does not show it.
"""

from dataclasses import dataclass

import numpy as np
from tac import USUAL, Condition, errors_of, run_of
from trial import Trial

from lightflyer.core.units import Measured
from lightflyer.lab.tac.difference import fit_tac_difference

COMMAND = "lab tac --top --bottom"


@dataclass(frozen=True)
class Pair:
    """Runs of two faces."""

    condition: Condition
    runs: int = 1  # of each face
    mounting: float = 0.0  # standard deviation of the coefficient, from mounting to mounting
    other: float | None = None  # standard uncertainty of the heater's other face


PAIRS = {
    "one run each": Pair(Condition(*USUAL, noise=0.005)),
    "two mountings each": Pair(Condition(*USUAL, noise=0.005), 2, 0.02),
    "other face of the heater": Pair(Condition(*USUAL, noise=0.005), other=0.03),
}


def trials(seed):
    """Coefficients of both faces and their difference, for each pair."""
    found = []
    for number, (name, pair) in enumerate(PAIRS.items()):
        rng = np.random.default_rng([seed, number, 34])
        off, condition = errors_of(rng, pair.condition), pair.condition
        truth = {"tac_top": rng.uniform(0.65, 0.95), "tac_bottom": rng.uniform(0.65, 0.95)}
        heater, other = rng.uniform(0.75, 0.9), None
        sides = []
        for mean in truth.values():
            mounted = mean + pair.mounting * rng.normal(size=pair.runs)
            seen = mounted if pair.other is None else 0.5 * (mounted + heater)
            sides.append([run_of(rng, condition, off, tac)[0] for tac in seen])
        if pair.other is not None:
            other = Measured(heater + pair.other * rng.normal(), pair.other)
        fit = fit_tac_difference(*sides, accuracy=condition.accuracy(), other_face=other)
        truth["difference"] = truth["tac_top"] - truth["tac_bottom"]
        found += [
            Trial(f"{one}, {name}", true, *getattr(fit, one).interval)
            for one, true in truth.items()
        ]
    return found
