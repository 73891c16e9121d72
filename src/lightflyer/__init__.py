"""Design, test and fly photophoretic light-flyers.

The public names are listed in ``__init__.pyi`` and loaded when first used, so that importing
the package, as the command line does, costs nothing.
"""

import signal
import sys

_STARTED = "".join(sys.orig_argv[-len(sys.argv) :][:1])
if hasattr(signal, "pthread_sigmask") and _STARTED.rpartition("/")[2] == "lightflyer":
    # Ctrl-C waits for ``__main__``, which answers it: an exception would come up in an import
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})

import lazy_loader  # noqa: E402

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
__version__ = "0.2.0"
