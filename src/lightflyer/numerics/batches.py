"""Evaluating a function that is compiled for one length at any number of points."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from lightflyer.array import tree


def in_batches(function: Callable[..., Any], arrays: Sequence[Any], size: int) -> Any:
    """Apply a function to arrays of any length, in batches of one length, shape (n, ...)."""
    # A compiled function is compiled anew for every length of its arguments. Here it only ever
    # meets one, which also keeps its temporary arrays small.
    count = max(len(array) for array in arrays if np.ndim(array))

    def run(start: int) -> Any:
        rows: Any = slice(start, start + size)
        if start + size > count:
            rows = np.minimum(np.arange(start, start + size), count - 1)
        return function(*(array[rows] if np.ndim(array) else array for array in arrays))

    running = run(0)
    result = tree.map_leaves(
        lambda part: np.empty((count, *part.shape[1:]) if np.ndim(part) else (), part.dtype),
        running,
    )
    for start in range(0, count, size):

        def store(whole: np.ndarray, part: np.ndarray, start: int = start) -> None:
            if part.ndim:
                whole[start : start + len(part)] = part[: len(whole) - start]
            else:
                whole[...] = part

        # JAX already works on the next while this one is copied
        done, running = running, run(start + size) if start + size < count else None
        tree.map_leaves(store, result, tree.map_leaves(np.asarray, done))
    return result
