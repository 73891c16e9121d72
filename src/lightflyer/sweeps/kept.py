"""What a study keeps where not every design is kept, and how it is read from a chunk of designs."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lightflyer.sweeps.distributions import SAMPLE
from lightflyer.sweeps.explore import (
    COSTS,
    JUDGED,
    less_is_better,
    margin,
    median_of_samples,
    worst_for_nan,
)
from lightflyer.sweeps.reductions import AbstractReduction, Best, Front, Partial, Spread
from lightflyer.sweeps.study import Study


@dataclass(frozen=True)
class Designs:
    """Outputs and numbers of consecutive designs.

    Where the study has samples, a design is a place along all other dimensions, and all its samples
    are here.

    Attributes
    ----------
    study : Study
    first : int
        Number of the first design, samples not counted.
    outputs : dict of str to array, shape (n,)
        Samples counted.
    numbers : int array, shape (n,)
        Samples counted.
    """

    study: Study
    first: int
    outputs: Mapping[str, np.ndarray]
    numbers: np.ndarray

    def typical(self, name: str, sign: float) -> np.ndarray:
        """An output or varied number of each design; with samples, their median.

        Parameters
        ----------
        name : str
        sign : float
            -1 where less is better. A sample without a value is the worst.

        Returns
        -------
        array
        """
        values = self.outputs.get(name)
        if values is None:
            values = self._varied[name]
        return self.medians(values, sign)

    def medians(self, values: np.ndarray, sign: float) -> np.ndarray:
        """The median over the samples of each design, if there are any."""
        samples = samples_of(self.study)
        if not samples:
            return values
        return sign * median_of_samples(worst_for_nan(sign * values).reshape(-1, samples))

    @cached_property
    def _varied(self) -> dict[str, np.ndarray]:
        return self.study.values_at(self.numbers)

    @cached_property
    def flying(self) -> np.ndarray | bool:
        """Which designs fly, as far as the outputs tell."""
        import xarray as xr

        columns = {name: ("design", values) for name, values in self.outputs.items()}
        able = margin(xr.Dataset(columns))
        return True if able is None else self.medians(np.asarray(able, float), 1.0) >= 0.0


def samples_of(study: Study) -> int:
    """Number of samples of each design; zero without any."""
    last = study.dimensions[-1] if study.dimensions else None
    return last.size if last is not None and last.name == SAMPLE else 0


@dataclass(frozen=True)
class Kept:
    """One thing to keep of a study.

    Attributes
    ----------
    name : str
        Group of the result, such as ``"best/payload"``.
    reduction : AbstractReduction
    partial : callable
        From :class:`Designs` to the reduction's partial.
    """

    name: str
    reduction: AbstractReduction
    partial: Callable[[Designs], Partial]


def what_is_kept(study: Study) -> list[Kept]:
    """What a study asks for, or else what suits its outputs.

    Without being asked: the best designs by the output that judges them, see
    :data:`~lightflyer.sweeps.explore.JUDGED`, their front against altitude, irradiance and
    temperature, and the distribution of every output.

    Parameters
    ----------
    study : Study

    Returns
    -------
    list of Kept
    """
    asked = study.reduce
    judged = [name for name in JUDGED if name in study.outputs][:1] or [study.outputs[0]]
    best = list(dict.fromkeys(asked.best or judged))
    known = {*study.outputs, *study.fields} - set(study.fixed)
    fronts = asked.fronts
    if fronts is None:
        fronts = tuple((best[0], cost) for cost in COSTS if cost in known and cost != best[0])
    spreads = dict.fromkeys(asked.distributions or study.outputs)
    return [
        *(_best(name, asked.designs) for name in best),
        *(_front(gain, cost) for gain, cost in dict.fromkeys(fronts)),
        *(_spread(name) for name in spreads),
    ]


def _best(output: str, count: int) -> Kept:
    reduction = Best(output, count, less_is_better(output))
    sign = -1.0 if reduction.less_is_better else 1.0
    return Kept(
        f"best/{output}",
        reduction,
        lambda seen: reduction.of_chunk({output: seen.typical(output, sign)}, seen.first),
    )


def more_is_better_of_cost(name: str) -> bool:
    """Whether more is better of what an output is weighed against."""
    if name in COSTS:
        return COSTS[name] < 0.0
    return False


def _front(gain: str, cost: str) -> Kept:
    reduction = Front(gain, cost, less_is_better(gain), more_is_better_of_cost(cost))
    worth = -1.0 if reduction.less_gain_is_better else 1.0
    price = 1.0 if reduction.more_cost_is_better else -1.0

    def partial(seen: Designs) -> Partial:
        gains = np.where(seen.flying, seen.typical(gain, worth), np.nan)
        return reduction.of_chunk({gain: gains, cost: seen.typical(cost, price)}, seen.first)

    return Kept(f"fronts/{gain}_against_{cost}", reduction, partial)


def _spread(output: str) -> Kept:
    reduction = Spread(output)
    return Kept(
        f"distributions/{output}", reduction, lambda seen: reduction.of_chunk(seen.outputs, 0)
    )
