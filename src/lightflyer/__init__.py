"""Design, test and fly photophoretic light-flyers: thin films that levitate in sunlight.

A flyer, an environment and a force model make a prediction::

    import lightflyer as lf

    film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    disk = lf.Disk(film, radius="1 cm")
    print(lf.predict(disk, lf.Earth(), lf.Kinetic()))

==============  ================================================================
flyers          Disk, Sandwich, Plate, HollowBody, Balloon, Sphere
environments    Earth, Mars, Chamber
force models    Kinetic, Lu2023, FreeMolecular, Schafer2025, Celenza2023,
                ChannelPump, HollowPump, BalloonConvection,
                KineticSphere, Rohatschek1995
one point       lift, equilibrium, levitate, payload
one flyer       predict, levitation_band, propagate, calibrate, fly
many            sweep, optimise, pareto, sensitivity, compare
packages        film, environment, mission, lab, force, structure, ...
==============  ================================================================

``help(lf.predict)`` describes one of them. Names are loaded when first used.
"""

import operator
import signal
import sys
import warnings

_STARTED = "".join(sys.orig_argv[-len(sys.argv) :][:1])
if hasattr(signal, "pthread_sigmask") and _STARTED.rpartition("/")[2] == "lightflyer":
    # Ctrl-C waits for ``__main__``, which answers it: an exception would come up in an import
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})

from lightflyer.core import attach  # noqa: E402

_find, __dir__, _names = attach(__name__, __file__)
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
    if name == "__all__":
        if sys._getframe(1).f_globals.get("__name__") == "pydoc":
            raise AttributeError(name)  # or help() prints all that every class and function has
        return _names
    if name not in _names and not name.startswith("_"):
        import importlib.util

        if importlib.util.find_spec(f"{__name__}.{name}"):
            raise AttributeError(name)  # of ``from lightflyer import cli``: Python imports it
        for room in _names:
            if room.islower() and name in getattr(_find(room), "__all__", ()):
                raise AttributeError(f"lightflyer has no {name}; it is lightflyer.{room}.{name}")
    return _find(name)
