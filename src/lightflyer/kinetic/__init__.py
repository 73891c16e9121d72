"""The kinetic equation of a gas around a hot thin disk: force and heat with nothing fitted.

:func:`solve` is the whole of it. It needs numba, the extra ``kinetic``, and imports it when it
is called; nothing else in the package does.

numba keeps what it compiled beside the source, by the date of each file alone: who changes
``directions.py`` or ``rays.py`` deletes ``__pycache__``, for the kernels that call them are else
not compiled again.
"""

from lightflyer.kinetic.solver import Solution, solve

__all__ = ["Solution", "solve"]
