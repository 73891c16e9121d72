"""Compilation of the loops over molecules, kept until a file here changes."""

from pathlib import Path
from typing import Any

from numba import njit

from lightflyer.kinetic_theory.grid.kernels import forget_stale_kernels

forget_stale_kernels(Path(__file__).parent)

# sums may be reordered; infinities and what is not a number stay what they are
_FAST = {"reassoc", "nsz", "arcp", "contract", "afn"}

kernel: Any = njit(cache=True, fastmath=_FAST, error_model="numpy")
"""Compile a function, and keep it compiled."""
