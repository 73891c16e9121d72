"""What is kept of a span of designs, reduced by NumPy or on the devices that compute them."""

import math
import threading
from itertools import zip_longest
from typing import Any

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Array, by_jax, load_jax, xp
from lightflyer.compute.devices import OnDevices
from lightflyer.compute.evaluation import Evaluator
from lightflyer.core.progress import Counted
from lightflyer.parametric.reduction_plan import Designs, ReductionSpec, plan_reductions, samples_of
from lightflyer.parametric.reductions import Partial
from lightflyer.study.study import Study

Partials = dict[str, Partial]
"""What is kept of some designs, by the names in :mod:`lightflyer.parametric.reduction_plan`."""

CHUNK_ON_GPU = 2**22
"""Designs computed at once on all GPUs together. By quarters of that an H100 takes half as long
again: what is kept of a batch costs 10 ms whatever its size."""

_MORE = 16  # batches of an evaluator: less memory is needed where only partials come back


def merge(kept: list[ReductionSpec], partials: Partials, more: Partials) -> None:
    """Merge further partials into some."""
    for part in kept:
        partials[part.name] = part.reduction.merge(partials[part.name], more[part.name])


class Reducer:
    """Reduces designs by NumPy, from all their outputs."""

    def __init__(self, study: Study, evaluator: Any):
        self._study, self._evaluator = study, evaluator

    def __call__(self, start: int, stop: int) -> tuple[Partials, int]:
        """What is kept of the designs from ``start`` up to ``stop``."""
        outputs, failures = self._evaluator(start, stop)
        first = start // max(samples_of(self._study), 1)
        seen = Designs(self._study, first, outputs, np.arange(start, stop))
        return {part.name: part.partial(seen) for part in plan_reductions(self._study)}, failures


class DeviceReducer:
    """Reduces designs where they are computed: only what is kept comes back."""

    # Numbers of designs are made on the devices, each of which computes and reduces a part of them.
    # Can be pickled; it is compiled where it runs.

    counted: Counted | None = None
    """Counts the designs as they are computed, in this process."""

    def __init__(self, study: Study, device: str):
        self._study, self._device = study, device
        self._evaluator = Evaluator(study, device)
        self.batch = _MORE * self._evaluator.batch
        self._forget()

    def _forget(self) -> None:
        self._lock = threading.Lock()
        self._program: _Program | None = None

    def __getstate__(self) -> dict[str, Any]:
        # another process compiles and counts for itself
        own = ("_study", "_device", "_evaluator", "batch")
        return {name: vars(self)[name] for name in own}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        self._forget()

    def __call__(self, start: int, stop: int) -> tuple[Partials, int]:
        """What is kept of the designs from ``start`` up to ``stop``."""
        program = self._compile()
        firsts = range(start, stop, program.designs)
        spans = [(first, min(first + program.designs, stop)) for first in firsts]
        kept = plan_reductions(self._study)
        partials: Partials = {part.name: part.reduction.empty() for part in kept}
        failures, running = 0, program(*spans[0])
        for span, following in zip_longest(spans, spans[1:]):
            # the devices already compute the next while these are merged
            done, running = running, program(*following) if following else None
            found, failed = self._receive(kept, done, span)
            for each in found:
                merge(kept, partials, each)
            failures += failed
            if self.counted is not None:
                self.counted.add(span[1] - span[0])
        return partials, failures

    def _receive(
        self, kept: list[ReductionSpec], done: Any, span: tuple[int, int]
    ) -> tuple[list[Partials], int]:
        """What each device found; where one had no room for all, reduced by NumPy."""
        every, failures = tree.map_leaves(np.asarray, done)
        found: list[Partials] = [
            tree.map_leaves(lambda leaf, place=place: leaf[place], every)
            for place in range(len(failures))
        ]
        if all(part.reduction.is_whole(each[part.name]) for part in kept for each in found):
            return found, int(failures.sum())
        whole, failed = Reducer(self._study, self._evaluator)(*span)
        return [whole], failed

    def _compile(self) -> "_Program":
        with self._lock:  # or every thread would compile
            if self._program is None:
                self._program = _Program(self._study, self._evaluator, self._device, self.batch)
        return self._program


class _Program:
    """Reduces consecutive designs on devices."""

    def __init__(self, study: Study, evaluator: Evaluator, device: str, batch: int):
        samples, kept = max(samples_of(study), 1), plan_reductions(study)
        self._devices = OnDevices(device)
        self._length = samples * math.ceil(batch / (samples * self._devices.count))
        self.designs = self._length * self._devices.count

        def reduced(first: Array, stop: Array) -> Any:
            numbers = first[0] + xp.arange(self._length, dtype=first.dtype)
            inside = numbers < stop[0]
            given = evaluator.inputs(xp.minimum(numbers, study.size - 1))
            outputs, converged = load_jax().vmap(evaluator.of_one)(*given)
            known = {
                name: xp.where(inside & converged & xp.isfinite(column), column, np.nan)
                for name, column in outputs.items()
            }
            seen = Designs(study, first[0] // samples, known, numbers)
            found = {part.name: part.partial_on_device(seen, inside) for part in kept}
            failures = xp.count_nonzero(inside & ~converged)
            return tree.map_leaves(lambda leaf: xp.asarray(leaf)[None], (found, failures))

        self._run = load_jax().jit(self._devices.divide_work(reduced))

    def __call__(self, start: int, stop: int) -> Any:
        """Partials and failures, with the devices as leading axis; they may still be computed."""
        firsts = start + self._length * np.arange(self._devices.count)
        with by_jax():
            return self._run(*self._devices.place((firsts, np.full_like(firsts, stop))))
