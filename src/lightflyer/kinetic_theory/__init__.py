"""The kinetic equation of a gas around a hot thin disk: force and heat with nothing fitted.

Solving needs numba, the extra ``kinetic``, which is imported when :func:`solve` is called.
"""

from lightflyer.core import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
