"""Compilation of kernels: once, and again after any file of the solver has changed.

numba keeps a compiled function until its own file changes, although functions of other files are
compiled into it.
"""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import wraps
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numba import config, njit

from lightflyer.core.cache import keeps_code

_FOLDER = Path(__file__).parents[1]  # the room of the solver


def forget_stale_kernels(folder: Path = _FOLDER) -> None:
    """Remove kernels compiled before the latest change of a source file in a folder or below."""
    changed = max((file.stat().st_mtime for file in folder.rglob("*.py")), default=0.0)
    for index in folder.rglob("__pycache__/*.nbi"):
        try:
            if index.stat().st_mtime < changed:
                index.unlink(missing_ok=True)
        except OSError:  # another user's, or just removed by another process
            continue


forget_stale_kernels()

_KEEPS = keeps_code()  # else Numba would write beside the package

# a division by zero gives no number, which is noticed
_OPTIONS: Any = {"cache": _KEEPS, "error_model": "numpy"}
# what Python would call takes a sixth of the time of compilation
_OF_KERNELS: Any = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
kernel: Any = njit(**_OPTIONS)  # Compile a function, and keep it compiled
inner_kernel: Any = njit(**_OPTIONS, **_OF_KERNELS)  # The same of one that kernels alone call

_PARTS_PER_THREAD = 8  # rows differ in work


def shared_kernel(function: Callable[..., None]) -> Callable[..., None]:
    """The same, for a function of rows that are independent, which threads share.

    It takes the first row, the one after the last, points of all rows, and more; callers leave the
    first two away. numba's own threads would add a quarter to the time of compilation.
    """
    compiled = njit(**_OPTIONS, nogil=True)(function)

    @wraps(function)
    def shared(points: np.ndarray, *arguments: Any) -> None:
        threads = config.NUMBA_NUM_THREADS  # type: ignore[attr-defined]
        parts = min(_PARTS_PER_THREAD * threads, len(points))
        ends = np.linspace(0, len(points), parts + 1).astype(int)
        with ThreadPoolExecutor(threads) as pool:
            for done in [
                pool.submit(compiled, start, end, points, *arguments)
                for start, end in pairwise(ends)
            ]:
                done.result()

    return shared
