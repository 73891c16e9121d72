"""What a study keeps where not every design is kept, and how it is read from a chunk of designs."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from lightflyer.parametric.explore import (
    COSTS,
    JUDGED,
    less_is_better,
    margin,
    median_of_samples,
    worst_for_nan,
)
from lightflyer.parametric.reductions import (
    AbstractReduction,
    Best,
    Columns,
    Front,
    Partial,
    Spread,
)
from lightflyer.study.distributions import SAMPLE
from lightflyer.study.study import Study


@dataclass(frozen=True)
class Designs:
    """Outputs and numbers of consecutive designs, in arrays of NumPy or of JAX."""

    # Where the study has samples, a design is a place along all other dimensions, and all its
    # samples are here.

    study: Study
    first: Any  # Number of the first design, samples not counted
    outputs: Mapping[str, Any]  # shape (n,); samples counted
    numbers: Any  # shape (n,); samples counted

    def typical(self, name: str, sign: float) -> Any:
        """An output or varied number of each design; with samples, their median."""
        values = self.outputs.get(name)
        if values is None:
            values = self._varied[name]
        return self.medians(values, sign)

    def medians(self, values: Any, sign: float) -> Any:
        """The median over the samples of each design, if there are any."""
        samples = samples_of(self.study)
        if not samples:
            return values
        return sign * median_of_samples(worst_for_nan(sign * values).reshape(-1, samples))

    @cached_property
    def _varied(self) -> dict[str, Any]:
        return self.study.values_at(self.numbers)

    @cached_property
    def flying(self) -> Any:
        """Which designs fly, as far as the outputs tell."""
        able = margin(self.outputs, self.where)
        return True if able is None else self.medians(able, 1.0) >= 0.0

    @property
    def where(self) -> Callable[..., Any]:
        """As :func:`numpy.where`, for the kind of the arrays."""
        chosen: Callable[..., Any] = self.numbers.__array_namespace__().where
        return chosen


def samples_of(study: Study) -> int:
    """Number of samples of each design; zero without any."""
    last = study.dimensions[-1] if study.dimensions else None
    return last.size if last is not None and last.name == SAMPLE else 0


@dataclass(frozen=True)
class ReductionSpec:
    """One thing to keep of a study."""

    name: str  # Group of the result, such as ``"best/payload"``
    reduction: AbstractReduction
    # What the reduction looks at, by name, from :class:`Designs`
    columns: Callable[[Designs], Columns]

    def partial(self, seen: Designs) -> Partial:
        """What is kept of some designs, in arrays of NumPy."""
        return self.reduction.of_chunk(self.columns(seen), seen.first)

    def partial_on_device(self, seen: Designs, inside: Any) -> Partial:
        """What is kept of those of some designs that are inside, in arrays of JAX."""
        return self.reduction.on_device(self.columns(seen), seen.first, inside)


def plan_reductions(study: Study) -> list[ReductionSpec]:
    """What a study asks for, or else what suits its outputs."""
    # Without being asked: the best designs by the output that judges them, see
    # :data:`~lightflyer.parametric.explore.JUDGED`, their front against altitude, irradiance and
    # temperature, and the distribution of every output.
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


def _best(output: str, count: int) -> ReductionSpec:
    reduction = Best(output, count, less_is_better(output))
    sign = -1.0 if reduction.less_is_better else 1.0
    return ReductionSpec(
        f"best/{output}", reduction, lambda seen: {output: seen.typical(output, sign)}
    )


def more_is_better_of_cost(name: str) -> bool:
    """Whether more is better of what an output is weighed against."""
    if name in COSTS:
        return COSTS[name] < 0.0
    return False


def _front(gain: str, cost: str) -> ReductionSpec:
    reduction = Front(gain, cost, less_is_better(gain), more_is_better_of_cost(cost))
    worth = -1.0 if reduction.less_gain_is_better else 1.0
    price = 1.0 if reduction.more_cost_is_better else -1.0

    def columns(seen: Designs) -> Columns:
        gains = seen.where(seen.flying, seen.typical(gain, worth), math.nan)
        return {gain: gains, cost: seen.typical(cost, price)}

    return ReductionSpec(f"fronts/{gain}_against_{cost}", reduction, columns)


def _spread(output: str) -> ReductionSpec:
    reduction = Spread(output)
    return ReductionSpec(f"distributions/{output}", reduction, lambda seen: seen.outputs)
