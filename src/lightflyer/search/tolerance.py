"""What is lost where a design is not made exactly: errors of thicknesses and of other numbers."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import ndtri
from scipy.stats import qmc

from lightflyer.array.records import ShortRepr
from lightflyer.search.bounds import Tolerance
from lightflyer.search.objectives import ObjectiveFunction
from lightflyer.search.problem import PROBABILITY

ASSUMED = Tolerance(0.05, relative=True)
"""Standard uncertainty of a layer's thickness where a study states none: evaporated and sputtered
layers are usually within a few per cent."""

LOW = 0.05  # Share of the made flyers that are worse than the low quantile
SAMPLES = 512  # Flyers that are made, to see what becomes of a design


@dataclass(frozen=True)
class Effect(ShortRepr):
    """What an error of one number does to the objective."""

    spread: float  #: Standard uncertainty of the number, in the unit of the design
    assumed: bool  #: Whether no study states it
    #: Change of the objective, in SI units, where the number is one standard uncertainty too small
    #: and too large
    less: float
    #: Change of the objective, in SI units, where the number is one standard uncertainty too small
    #: and too large
    more: float


@dataclass(frozen=True)
class AsMade(ShortRepr):
    """The objective over many flyers, each made with errors of its own."""

    effects: dict[str, Effect]  #: By the name of the number
    mean: float  #: In SI units
    low: float  #: Quantile beyond which :data:`LOW` of the flyers are worse
    samples: int

    @property
    def low_share(self) -> float:
        """Share of the flyers that are worse than :attr:`low`."""
        return LOW

    def summary(self) -> dict[str, Any]:
        """All of it as a JSON object, in SI units."""
        effects = {name: vars(effect) for name, effect in self.effects.items()}
        return {
            "effects": effects,
            "mean": self.mean,
            "low": self.low,
            "low_share": self.low_share,
            "samples": self.samples,
        }


def simulate_making(function: ObjectiveFunction, point: np.ndarray) -> AsMade | None:
    """What becomes of a design that is made with errors; ``point`` (k,)."""
    # The errors are normal and independent. Each flyer's films are computed with all errors at
    # once.
    problem = function.problem
    # those stated, and assumed ones of free thicknesses
    names = [bounds.field.name for bounds in problem.bounds]
    thicknesses = [name for name in names if name.endswith(".thickness")]
    assumed = dict.fromkeys(problem.design.needs_recompute(thicknesses), ASSUMED)
    tolerances = assumed | problem.tolerances
    if not tolerances or problem.objectives[0].name == PROBABILITY:
        return None
    given = {name: float(value) for name, value in function.all_values(point).items()}
    spreads = {name: float(one.spread(given[name])) for name, one in tolerances.items()}
    # the nominal design, each number one standard uncertainty off, and drawn ones
    count = len(spreads)
    steps = np.zeros((2 * count, count))
    steps[0::2], steps[1::2] = -np.eye(count), np.eye(count)
    drawn = ndtri(qmc.Sobol(count, rng=problem.seed).random(SAMPLES))
    errors = np.concatenate([np.zeros((1, count)), steps, drawn])
    table = {name: np.full(len(errors), value) for name, value in given.items()}
    for number, (name, spread) in enumerate(spreads.items()):
        table[name] = table[name] + spread * errors[:, number]
    values = problem.objectives[0].sign * function.without_errors().scores_of_designs(table)[:, 0]
    nominal, moved, drawn = values[0], values[1 : 1 + 2 * len(spreads)], values[-SAMPLES:]
    stated = problem.tolerances
    effects = {
        name: Effect(spread, name not in stated, *(float(one - nominal) for one in pair))
        for (name, spread), pair in zip(spreads.items(), moved.reshape(-1, 2), strict=True)
    }
    share = LOW if problem.objectives[0].sign > 0.0 else 1.0 - LOW
    low = float(np.quantile(drawn, share))
    return AsMade(effects, float(np.mean(drawn)), low, SAMPLES)
