"""Compilation of kernels: once, and again after any file of the solver has changed.

numba keeps a compiled function until its own file changes, although functions of other files are
compiled into it.
"""

from pathlib import Path
from typing import Any

from numba import njit

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

kernel: Any = njit(cache=True)  # Compile a function, and keep it compiled

parallel_kernel: Any = njit(cache=True, parallel=True)
"""The same with the iterations of ``prange`` shared among cores."""
