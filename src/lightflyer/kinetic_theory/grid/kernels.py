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

# a division by zero gives no number, which is noticed; as an exception it would end one of several
# threads unseen, with some of its results never written
kernel: Any = njit(cache=True, error_model="numpy")  # Compile a function, and keep it compiled

parallel_kernel: Any = njit(cache=True, parallel=True, error_model="numpy")
"""The same with the iterations of ``prange`` shared among cores."""
