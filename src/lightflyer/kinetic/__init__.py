"""The kinetic equation of a gas around a hot thin disk: force and heat with nothing fitted.

:func:`solve` is the whole of it. It needs numba, the extra ``kinetic``, and imports it when it
is called; nothing else in the package does.
"""

from lightflyer.kinetic.solver import Solution, solve

__all__ = ["Solution", "solve"]
