"""The kinetic equation of a gas around a hot thin disk: force and heat with nothing fitted.

:func:`solve` is the whole of it. It needs numba, the extra ``kinetic``; nothing else in the
package does.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submod_attrs={"solver": ["Solution", "solve"]}
)
