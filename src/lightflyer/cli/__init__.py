"""The command line: parse, call, show; no physics.

A command is one module here, registered by name so that it is imported only when it runs:
``lightflyer --help`` must not wait for JAX.
"""

import sys
import warnings
from collections.abc import Sequence
from typing import Any

import cyclopts

import lightflyer
from lightflyer.cli.progress import Display, working
from lightflyer.foundation.errors import LightflyerError, ParameterWarning

EXIT_FAILURE = 2
EXIT_INTERRUPTED = 130

app = cyclopts.App(
    name="lightflyer",
    help="Design, test and fly photophoretic light-flyers: thin films that levitate in sunlight.",
    version=lightflyer.__version__,
)
app.command(
    "lightflyer.cli.init:init", name="init", help="Write a commented flyer file to start from."
)
app.command(
    "lightflyer.cli.predict:predict_command",
    name="predict",
    help="Predict where a flyer levitates, what it carries and how hot it gets.",
)
app.command(
    "lightflyer.cli.compare:compare_command",
    name="compare",
    help="Compare several flyers over altitude or pressure.",
)
app.command(
    "lightflyer.cli.film:film_command",
    name="film",
    help="Compute absorptance, emittance and areal density of a film from its layers.",
)
app.command(
    "lightflyer.cli.materials:materials_command",
    name="materials",
    help="List the materials for layers.",
)
app.command(
    "lightflyer.cli.calibrate:calibrate_command",
    name="calibrate",
    help="Fit force coefficients and film properties to measured levitation points.",
)
app.command(
    "lightflyer.cli.lab:app",
    name="lab",
    help="Reduce raw measurements to numbers with intervals, figures and records.",
)
app.command(
    "lightflyer.cli.sweep:sweep_command",
    name="sweep",
    help="Compute many designs of a study into a folder.",
)
app.command(
    "lightflyer.cli.map:map_command",
    name="map",
    help="Draw the results of a sweep: maps, best designs, Pareto fronts.",
)
app.command(
    "lightflyer.cli.optimise:optimise_command",
    name="optimise",
    help="Find the best design of a study, by gradients from many starts.",
)
app.command(
    "lightflyer.cli.sensitivity:sensitivity_command",
    name="sensitivity",
    help="Which uncertain property costs most: what to measure next.",
)
app.command(
    "lightflyer.cli.paper:paper_command",
    name="paper",
    help="Recompute the paper: its claims, figures and tables beside ours.",
)
app.command(
    "lightflyer.cli.kinetic:kinetic_command",
    name="kinetic",
    help="Solve the kinetic equation around a hot thin disk.",
)


class _Warnings:
    """Prints each warning once, however often the same flyer is built."""

    def __init__(self, display: Display) -> None:
        self._display = display
        self._shown: set[str] = set()

    def __call__(self, message: Warning | str, *_: Any, **__: Any) -> None:
        if str(message) not in self._shown:
            self._shown.add(str(message))
            self._display.note(f"lightflyer: warning: {message}")


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line; mistakes of the user's become one line each and exit code 2.

    Parameters
    ----------
    arguments : sequence of str, optional
        What follows the program's name; by default as the process was started.
    """
    given = sys.argv[1:] if arguments is None else list(arguments)
    try:
        with working(next(iter(given), app.name[0])) as display, warnings.catch_warnings():
            warnings.simplefilter("always", ParameterWarning)
            warnings.showwarning = _Warnings(display)
            app(given, exit_on_error=False)
    except cyclopts.CycloptsError:
        sys.exit(EXIT_FAILURE)  # cyclopts has said why
    except LightflyerError as error:
        for line in str(error).splitlines():
            print(f"lightflyer: error: {line}", file=sys.stderr)  # noqa: T201
        sys.exit(EXIT_FAILURE)
    except KeyboardInterrupt:
        sys.exit(EXIT_INTERRUPTED)
    except BrokenPipeError:
        sys.stderr.close()  # whoever read the output has gone; nothing is left to say
        sys.exit(0)
