"""``lightflyer optimise``: the best design of a study."""

from pathlib import Path
from typing import TYPE_CHECKING

from lightflyer.cli.figure_files import AS_USUAL, ResultOptions
from lightflyer.cli.options import Json
from lightflyer.cli.output import print_json, printer, say, show
from lightflyer.core.errors import ConfigurationError

if TYPE_CHECKING:
    from lightflyer.search.optimiser import Optimum

_JSON = "optimum.json"


def optimise_command(
    study_file: Path,
    /,
    *,
    out: Path | None = None,
    write: Path | None = None,
    json_output: Json = False,
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Find the best design within bounds and constraints.

    Parameters
    ----------
    study_file
        TOML file with flyer = "flyer.toml" and the sections [optimise] and [optimise.over].
    out
        Folder to write the result (JSON) and its figure into: the elasticities of the best
        design or, with several objectives, the front.
    write
        Flyer file to write with the best design in place of the study's; it must be new, or one
        that this command wrote.
    json_output
        Print one JSON object instead of tables.
    figures
        How figures are written.
    """
    out = figures.folder(out)
    from lightflyer.search import optimise, pareto, read_problem
    from lightflyer.search.text import design_parts

    problem = read_problem(study_file)
    if write is not None:
        from lightflyer.config.update import require_free

        require_free(write)
    console = printer()
    if len(problem.objectives) > 1:
        if write is not None:
            raise ConfigurationError("--write: several objectives have no single best design")
        front = pareto(problem)
        summary = front.summary()
        written = figures.write_folder(out, {_JSON: summary}, lambda: {"front": front.plot()})
        if not json_output:
            show(console, front.text_parts())
    else:
        optimum = optimise(problem)
        summary = optimum.summary()
        written = figures.write_folder(
            out, {_JSON: summary}, lambda: {"elasticities": optimum.plot()}
        )
        if not json_output:
            show(console, optimum.text_parts())
            show(console, design_parts(optimum))
        if write is not None:
            _write_flyer(write, study_file, optimum)
            written.append(write)
    if json_output:
        print_json(summary)
        return
    figures.tell(console, written)
    best = "--write FLYER_FILE, for a flyer file with the best design"
    say(console, f"next: {best if write is None else f'lightflyer predict {write}'}")


def _write_flyer(path: Path, study_file: Path, optimum: "Optimum") -> None:
    """The study's flyer file with the numbers of the best design."""
    from lightflyer.config.update import write_design

    problem = optimum.problem
    coordinate, quantities = problem.design.coordinate_name, problem.design.quantities
    found = {
        name: (value, quantities[name].unit)
        for name, value in (problem.fixed | optimum.design).items()
        if name != coordinate
    }
    write_design(path, problem.design.text, found, f"lightflyer optimise {study_file.name}")
