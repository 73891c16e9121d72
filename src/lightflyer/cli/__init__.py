"""The command line: parse, call, show; no physics.

A command is one module here, registered by name so that it is imported only when it runs:
``lightflyer --help`` must not wait for JAX.
"""

import os
import re
import sys
import warnings
from collections.abc import Iterator, Sequence
from errno import ENOENT
from pathlib import Path
from typing import Any

import cyclopts

import lightflyer
from lightflyer.cli.output import printer, say
from lightflyer.cli.progress import abandon, print_error, show_progress
from lightflyer.cli.report import note_warning, write_report
from lightflyer.core.errors import ConfigurationError, LightflyerError, ParameterWarning
from lightflyer.files.result_text import listed

EXIT_FAILURE = 2
EXIT_INTERRUPTED = 130

_READS = {
    *("predict", "fly", "spread", "drift", "stability", "swarm", "film", "compare", "sweep"),
    *("optimise", "sensitivity"),
    "calibrate",
}  # fmt: skip
"""Commands whose first word is a file, beside those of the lab bench."""

_FOR_SCRIPTS = "; or pass throw=False"  # advice that no command can follow

_NO_ROOM = ("failed to map segment", "annot allocate memory")  # as loaders of libraries say

_NEGATIVE, _OPTION = re.compile(r"-[\d.,]"), re.compile(r"--[a-z-]+")

app = cyclopts.App(
    name="lightflyer",
    help="Design, test and fly photophoretic light-flyers: thin films that levitate in sunlight.",
    version=lightflyer.__version__,
)
app.register_install_completion_command(
    help="Install completion of commands and options for this shell: bash, zsh, fish or PowerShell."
)
_COMMANDS = {
    "init": "Write a commented flyer file to start from.",
    "predict": "Predict where a flyer levitates, what it carries and how hot it gets.",
    "explore": "Open a page to change a flyer's numbers and see what follows.",
    "fly": "Fly a mission: where a flyer goes, whether it survives the night, what ends it.",
    "spread": "Fly a swarm for days: what share is still aloft, and near a place.",
    "drift": "How fast a tilted flyer drifts sideways, over altitude and tilt.",
    "stability": "Whether a flyer keeps level with its payload hanging below it.",
    "swarm": "How many flyers on tethers carry one payload together.",
    "compare": "Compare several flyers over altitude or pressure.",
    "film": "Compute absorptance, emittance and areal density of a film from its layers.",
    "materials": "List the materials for layers.",
    "calibrate": "Fit force coefficients and film properties to measured levitation points.",
    "lab": "Reduce raw measurements to numbers with intervals, figures and records.",
    "sweep": "Compute many designs of a study into a folder.",
    "map": "Draw the results of a sweep: maps, best designs, Pareto fronts.",
    "optimise": "Find the best design of a study, by gradients from many starts.",
    "sensitivity": "Which uncertain property costs most: what to measure next.",
    "paper": "Recompute the paper: its claims, figures and tables beside ours.",
    "kinetic": "Solve the kinetic equation around a hot thin disk.",
    "doctor": "Say what is installed: extras, devices, libraries, plug-ins, caches.",
}
_MODULES = {  # of commands.NAME:NAME_command, where it has another name
    "compare": "predict",
    **dict.fromkeys(("fly", "spread", "drift", "stability", "swarm"), "missions"),
    **dict.fromkeys(("sweep", "map", "optimise", "sensitivity"), "studies"),
}
_ELSEWHERE = {"init": "commands.init:init", "lab": "lab:app"}
for _name, _help in _COMMANDS.items():
    _where = f"commands.{_MODULES.get(_name, _name)}:{_name}_command"
    app.command(f"lightflyer.cli.{_ELSEWHERE.get(_name, _where)}", name=_name, help=_help)


def _add_plugins(asked: str) -> None:
    """Add the commands of plug-ins; only the one that is asked for is imported."""
    # importlib.metadata takes ten times as long, which a list of commands need not wait for
    files = (file for folder in sys.path for file in Path(folder).glob("*-info/entry_points.txt"))
    if not any(b"[lightflyer]" in file.read_bytes() for file in files):
        return
    from lightflyer.core.extras import load_plugin, plugins

    for entry in plugins():
        if not entry.attr or entry.name in app:
            continue
        if entry.name != asked:
            about = entry.dist and entry.dist.metadata["Summary"]
            # a stand-in, which is listed and never called: Cyclopts would import what is named
            app.command(_listed, name=entry.name, help=about or f"Plug-in {entry.value}")
        elif (command := load_plugin(entry)) is not None:
            app.command(command, name=entry.name)


def _listed() -> None:
    pass


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line; mistakes of the user's become one line each and exit code 2."""
    given = _with_negatives(sys.argv[1:] if arguments is None else list(arguments))
    shown: set[str] = set()
    try:
        with show_progress(next(iter(given), app.name[0])) as display, warnings.catch_warnings():
            warnings.simplefilter("always", ParameterWarning)

            def show(message: Warning | str, *_: Any, **__: Any) -> None:
                """Print each warning once, however often the same flyer is built."""
                if str(message) not in shown:
                    shown.add(str(message))
                    display.note(f"lightflyer: warning: {message}")
                    note_warning(str(message))

            warnings.showwarning = show
            asked = next(iter(given), "-")
            if asked.startswith("-") or asked not in app:
                _add_plugins(asked)
            _require_files(given)
            with write_report(given):
                app(given, exit_on_error=False, print_error=False, result_action="return_value")
            _tell_next(given)
            sys.stdout.flush()  # a full device says so here, not while Python ends
        sys.exit(0)
    except cyclopts.CycloptsError as error:
        help_of = f"lightflyer {_help_of(given)} --help".replace("  ", " ")
        _fail(f"{_one_line(error, given)}; see {help_of}")
    except LightflyerError as error:
        _fail(str(error).partition(_FOR_SCRIPTS)[0])
    except MemoryError:
        _fail("this needs more memory than there is; ask for fewer samples or points")
    except ImportError as error:
        if not any(sign in str(error) for sign in _NO_ROOM):
            raise
        _fail("libraries find no room in memory; raise the limit of it (ulimit -v), or free some")
    except KeyboardInterrupt:
        sys.exit(EXIT_INTERRUPTED)
    except BrokenPipeError:
        sys.stderr.close()  # whoever read the output has gone; nothing is left to say
        sys.exit(0)
    except OSError as error:
        where = "the output" if error.filename is None else error.filename
        abandon(sys.stdout)
        _fail(f"{where}: {error.strerror or error}")


_MISSION = "lightflyer init mission.toml --kind mission"
_NEXT = {
    "calibrate": "--update FLYER_FILE writes what was fitted into a flyer file",
    "compare": "lightflyer predict FILE, for all of one of them",
    "doctor": "lightflyer init flyer.toml",
    "drift": _MISSION,
    "film": "lightflyer predict {}, where it describes a flyer",
    "fly": "lightflyer spread {}, for thousands of them",
    "kinetic": 'model = "kinetic" in a flyer file; lightflyer init flyer.toml writes one',
    "map": "lightflyer init best.toml --kind optimise, to find the best by its slopes",
    "materials": "lightflyer init layers.toml --kind layers, to make a film of them",
    "sensitivity": "lightflyer lab --help, to measure what comes first",
    "spread": "lightflyer fly {}, to follow one of them",
    "stability": _MISSION,
    "swarm": _MISSION,
    "lab": "lightflyer lab summary FOLDER, for the numbers of all records",
}
"""What to do after a command that does not say so itself; braces are the file that it was given."""


def _tell_next(given: Sequence[str]) -> None:
    """End with what to do next, where a person reads."""
    if {*given} & {"--json", "--report", "--help", "-h", "--version"} or [*given[:2]] in (
        ["lab"],
        ["lab", "example"],
        ["lab", "summary"],
    ):
        return
    following = _NEXT.get("".join(given[:1]))
    if following is not None:
        file = next((word for word in given[1:] if not word.startswith("-")), "FILE")
        say(printer(), f"next: {following.format(file)}")


def _require_files(given: Sequence[str]) -> None:
    """Raise where the first file is missing, before what takes seconds to load."""
    lab = given[:1] == ["lab"] and given[1:2] != ["summary"]
    name = "".join(given[2:3] if lab else given[1:2])
    files = name, name.partition("#")[0]  # a sheet is named after its workbook
    if (
        (lab or {*given[:1]} & _READS)
        and Path(name).suffix
        and not (name[0] == "-" or any(Path(file).exists() for file in files))
    ):
        raise ConfigurationError(f"{name}: cannot be read: {os.strerror(ENOENT)}")


def _with_negatives(given: Sequence[str]) -> list[str]:
    """Arguments with values such as "-3 mm" joined to their options, or they would seem options."""
    joined: list[str] = []
    for word in map(str, given):
        if joined and _NEGATIVE.match(word) and _OPTION.fullmatch(joined[-1]):
            joined[-1] += f"={word}"
        else:
            joined.append(word)
    return joined


def _fail(text: str) -> None:
    """End with a line for each mistake."""
    for line in text.splitlines():
        print_error(f"lightflyer: error: {line}")
    sys.exit(EXIT_FAILURE)


def _one_line(error: cyclopts.CycloptsError, given: Sequence[str]) -> str:
    """What is wrong with the options, in one line without the full stop."""
    if isinstance(error, cyclopts.MissingArgumentError) and error.argument is not None:
        missing = listed(_missing(error.argument.name, given))
        without_value = {*error.argument.names} & {*given}
        return (
            missing.replace(" (", " needs a value (", 1)
            if without_value
            else (f"{_help_of(given)} needs {missing}")
        )
    if isinstance(error, cyclopts.UnusedCliTokensError):
        return f"unexpected argument {' '.join(error.unused_tokens or [])}"
    text = " ".join(str(error).split())
    for kind, words in _KINDS.items():
        text = text.replace(f" into {kind}", f" into {words}")
    return text if text.endswith("...") else text.removesuffix(".")


def _missing(first: str, given: Sequence[str]) -> Iterator[str]:
    """What a command needs and was not given, each with what it is; ``first``: one of them."""
    where: Any = app
    for word in _help_of(given).split():
        where = where[word]
    there = {word.partition("=")[0] for word in given}
    for one in where.assemble_argument_collection(parse_docstring=True):
        option = one.name.startswith("--") and one.required and not {*one.names} & there
        if one.name == first or option:
            about = " ".join((one.parameter.help or "").split()).split(". ")[0].removesuffix(".")
            yield f"{one.name} ({about[:1].lower() + about[1:] if about[1:2].islower() else about})"


_KINDS = {"int": "a whole number", "float": "a number"}


def _help_of(given: Sequence[str]) -> str:
    """The command, as far as it exists, whose help says more."""
    known = []
    where: Any = app
    for word in given:
        if word.startswith("-") or word not in where:
            break
        known.append(word)
        where = where[word]
    return " ".join(known)
