"""Evaluating a function that is compiled for one length at any number of points."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any

import numpy as np

from lightflyer.array import tree


def in_batches(function: Callable[..., Any], arrays: Sequence[Any], size: int) -> Any:
    """Apply a function to arrays of any length, in batches of one length, shape (n, ...)."""
    # A compiled function is compiled anew for every length of its arguments. Here it only ever
    # meets one, which also keeps its temporary arrays small.
    count = max(len(array) for array in arrays if np.ndim(array))
    batches = _batches(arrays, count, size)
    running = function(*next(batches))
    result = tree.map_leaves(
        lambda part: np.empty((count, *part.shape[1:]) if np.ndim(part) else (), part.dtype),
        running,
    )
    for start in range(0, count, size):
        done, batch = running, next(batches, None)
        # JAX already works on the next while this one is copied
        running = None if batch is None else function(*batch)
        tree.map_leaves(partial(_store, start), result, tree.map_leaves(np.asarray, done))
    return result


def _batches(arrays: Sequence[Any], count: int, size: int) -> Iterator[list[Any]]:
    for start in range(0, count, size):
        rows: Any = slice(start, start + size)
        if start + size > count:
            rows = np.minimum(np.arange(start, start + size), count - 1)
        yield [array[rows] if np.ndim(array) else array for array in arrays]


def _store(start: int, whole: np.ndarray, part: np.ndarray) -> None:
    if part.ndim:
        whole[start : start + len(part)] = part[: len(whole) - start]
    else:
        whole[...] = part
