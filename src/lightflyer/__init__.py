"""Design, test and fly photophoretic light-flyers.

The public names are listed in ``__init__.pyi`` and loaded when first used, so that importing
the package, as the command line does, costs nothing.
"""

import operator
import signal
import sys
import warnings

_STARTED = "".join(sys.orig_argv[-len(sys.argv) :][:1])
if hasattr(signal, "pthread_sigmask") and _STARTED.rpartition("/")[2] == "lightflyer":
    # Ctrl-C waits for ``__main__``, which answers it: an exception would come up in an import
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})

import lazy_loader  # noqa: E402

_find, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__version__ = "0.2.0"

RENAMED = {
    "flight": "statics",
    "sweeps": "parametric",
    "kinetic": "kinetic_theory",
    "drift": "mission.steady_drift",
    "spread": "mission.disperse_ensemble",
    "swarm": "mission.tethered_swarm",
}
"""Names of the last release, and what they are called now; they go with the next but one."""


def __getattr__(name):  # type: ignore[no-untyped-def]
    if name in RENAMED:
        new = RENAMED[name]
        text = f"lightflyer.{name} is now lightflyer.{new}; the old name goes with the next release"
        warnings.warn(text, FutureWarning, stacklevel=2)
        return operator.attrgetter(new)(sys.modules[__name__])
    return _find(name)
