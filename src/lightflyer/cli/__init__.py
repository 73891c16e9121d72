"""The command line: parse, call, show; no physics.

A command is one module here, registered by name so that it is imported only when it runs:
``lightflyer --help`` must not wait for JAX.
"""

import sys
import warnings
from typing import Any

import cyclopts

import lightflyer
from lightflyer.errors import LightflyerError

EXIT_FAILURE = 2

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
    "lightflyer.cli.calibrate:calibrate_command",
    name="calibrate",
    help="Fit force coefficients and film properties to measured levitation points.",
)
app.command(
    "lightflyer.cli.paper:paper_command",
    name="paper",
    help="Recompute the paper: its claims, figures and tables beside ours.",
)


def _warn(message: Warning | str, *_: Any, **__: Any) -> None:
    print(f"lightflyer: warning: {message}", file=sys.stderr)  # noqa: T201


def main() -> None:
    """Run the command line; mistakes of the user's become one line each and exit code 2."""
    warnings.showwarning = _warn
    try:
        app(exit_on_error=False)
    except cyclopts.CycloptsError:
        sys.exit(EXIT_FAILURE)  # cyclopts has said why
    except LightflyerError as error:
        for line in str(error).splitlines():
            print(f"lightflyer: error: {line}", file=sys.stderr)  # noqa: T201
        sys.exit(EXIT_FAILURE)
    except KeyboardInterrupt:
        sys.exit(130)
    except BrokenPipeError:
        sys.stderr.close()  # whoever read the output has gone; nothing is left to say
        sys.exit(0)
