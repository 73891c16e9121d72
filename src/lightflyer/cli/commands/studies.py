"""``lightflyer sweep``, ``map``, ``optimise``, ``sensitivity``: what the designs of a study do."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter

from lightflyer.cli.options import AS_USUAL, Json, ResultOptions, Whole
from lightflyer.cli.output import duration, in_words, print_json, printer, say, show, with_prefix
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.files.result_text import table_of, warning_lines

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from lightflyer.parametric.explore import BestDesign
    from lightflyer.parametric.run import SweepReport
    from lightflyer.search.optimiser import Optimum
    from lightflyer.study.study import Study

_LONG = 10.0  # Seconds of a sweep from which on something quicker is worth a word


def sweep_command(
    study_file: Path,
    /,
    *,
    out: Path,
    scheduler: str | None = None,
    workers: Whole | None = None,
    chunk: Whole | None = None,
    device: Literal["cpu", "gpu"] | None = None,
    yes: Annotated[bool, Parameter(negative=())] = False,
    json_output: Json = False,
) -> None:
    """Compute every design of a study; the same command continues an interrupted one.

    Parameters
    ----------
    study_file
        TOML file with flyer = "flyer.toml" and the sections [sweep] and [outputs].
    out
        Folder for the results, a Zarr group such as results.zarr.
    scheduler
        Address of a running Dask scheduler, such as tcp://127.0.0.1:8786; by default this
        machine computes.
    workers
        Threads on this machine; by default one for each processor and two more.
    chunk
        Largest number of designs computed and stored together; by default 262144.
    device
        Compute on the processors or on all GPUs; by default where JAX does.
    yes
        Start a very large study.
    json_output
        Print one JSON object instead of tables.
    """
    from lightflyer.compute.evaluation import CHUNK
    from lightflyer.files.display_units import suitable
    from lightflyer.parametric.run import LARGEST, estimate, open_sweep, sweep_into
    from lightflyer.study.study import read_study

    for name, value in (("--workers", workers), ("--chunk", chunk)):
        if value is not None and value < 1:
            raise ParameterError(f"{name} must be at least 1")
    study = read_study(study_file)
    if not yes and study.size > LARGEST:
        costs = estimate(study, out)
        size, free = (with_prefix(count, "B") for count in (costs.size, costs.free))
        raise ConfigurationError(
            f"the study has {in_words(costs.designs)} designs: about {duration(costs.seconds)} on "
            f"this machine and {size} on the disk, which has {free} free; start it with --yes"
        )
    report = sweep_into(
        study,
        out,
        scheduler=scheduler,
        workers=workers,
        chunk=CHUNK if chunk is None else chunk,
        device=device,
    )
    name, best = _best(open_sweep(out))
    if json_output:
        print_json(
            {
                "out": str(out),
                "designs": report.designs,
                "found": report.found,
                "computed": report.computed,
                "damaged_chunks": report.damaged,
                "not_converged": report.not_converged,
                "seconds": report.seconds,
                "best": None
                if best is None
                else {"output": name, "value": best.value, "unit": best.units},
                "warnings": list(_warnings(study, best)),
            }
        )
        return
    rows, fields = [], study.fields
    for dimension in study.dimensions:
        for field, values in dimension.values.items():
            factor, unit = suitable(fields[field].quantity.unit, values)
            ends = (f"{end * factor:.6g}" for end in (values.min(), values.max()))
            rows.append((field, str(len(values)), *ends, unit))
    for field, number in study.fixed.items():
        factor, unit = suitable(fields[field].quantity.unit, number)
        rows.append((field, "1", f"{number * factor:.6g}", "", unit))
    console = printer()
    console.print(table_of(("field", "values", "from", "to", "unit"), rows, left=(0, 4)))
    console.print(report_line(report), soft_wrap=True)
    if report.not_converged:
        console.print(f"{report.not_converged} designs have not converged and are NaN")
    if name:
        shown = f"no design has a {name}" if best is None else f"largest {name}: {best}"
        console.print(shown, soft_wrap=True)
    for text in _warnings(study, best):
        console.print(f"warning: {text}", soft_wrap=True)
    console.print(f"wrote {out}", soft_wrap=True)
    across = next(iter(study.dimensions[0].values), "FIELD") if study.dimensions else "FIELD"
    judged = name or study.outputs[0]
    say(console, f"next: lightflyer map {out} --x {across} --value {judged}")


def _warnings(study: "Study", best: "BestDesign | None") -> tuple[str, ...]:
    """What a reader of the best design must know; of the design itself where there is none."""
    from lightflyer.design.diagnostics import diagnose_design

    if best is None:
        return study.design.warnings
    there = {field: number for field, (number, _) in best.where.items()}
    return tuple(f"best design: {text}" for text in diagnose_design(study.design, there))


def report_line(report: "SweepReport") -> str:
    """What a sweep did, in a line."""
    from lightflyer.array.namespace import has_jax

    if not report.computed:
        return f"{report.designs:,} designs: all were already computed, and are intact"
    parts = [f"{report.designs:,} design{'s' * (report.designs != 1)}"]
    if report.found:
        parts.append(f"{report.found:,} were already computed")
    if report.damaged:
        chunks = "chunk" if report.damaged == 1 else "chunks"
        parts.append(f"{report.damaged} damaged {chunks} computed again")
    rate = in_words(report.computed / max(report.seconds, 1e-9))
    parts.append(f"{report.computed:,} computed in {report.seconds:.1f} s ({rate} a second)")
    line = ", ".join(parts)
    if report.seconds > _LONG and not has_jax():
        return f"{line}; JAX makes large sweeps quicker: pip install 'lightflyer[jax]'"
    return line


def _best(dataset: "xr.Dataset") -> "tuple[str, BestDesign | None]":
    """The output by which designs are judged, and the best one."""
    from lightflyer.parametric.explore import JUDGED, best_design

    names = [name for name in JUDGED if name in dataset]
    return (names[0], best_design(dataset, names[0])) if names else ("", None)


def map_command(
    results: Path,
    /,
    *,
    x: str,
    y: str | None = None,
    value: str,
    at: str | None = None,
    pareto: Annotated[bool, Parameter(negative=())] = False,
    out: Path = Path("map"),
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Draw an output of a sweep over one or two of its fields.

    Parameters
    ----------
    results
        Folder that "lightflyer sweep" wrote.
    x
        Field of the horizontal axis, such as diameter.
    y
        Field of the vertical axis, such as altitude; by default the value itself.
    value
        Output, such as relative_payload.
    at
        Values of the other fields, such as "emittance = 0.08, altitude = 70 km"; by default those
        of the best design.
    pareto
        Also draw Pareto fronts of the output against altitude, irradiance and temperature.
    out
        Folder to write the figures into.
    figures
        How figures are written.
    """
    figures.folder(out)
    from lightflyer.files.display_units import amount
    from lightflyer.parametric.explore import choose_slice, find_name
    from lightflyer.parametric.figures import map_parts
    from lightflyer.parametric.run import open_sweep

    dataset = open_sweep(results)
    output = find_name(dataset, value, among="outputs")
    fields = [find_name(dataset, name, among="fields") for name in (x, y) if name is not None]
    if len(set(fields)) < len(fields):
        raise ConfigurationError(f"--x and --y are both {fields[0]}")
    console = printer()
    if not dataset.attrs.get("complete", True):
        console.print("the sweep is not finished; missing designs are left blank", soft_wrap=True)
    asked = {}
    for part in (at or "").split(","):
        name, equals, text = (piece.strip() for piece in part.partition("="))
        if part.strip() and not (name and equals and text):
            raise ConfigurationError(
                f'--at "{part.strip()}": write name = value, as in "altitude = 70 km"'
            )
        if name in asked:
            raise ConfigurationError(f'--at "{name}" is given twice')
        if name:
            asked[name] = text
    sliced, chosen = choose_slice(dataset, output, fields, asked)

    def draw() -> "dict[str, Figure]":
        from lightflyer.files.drawing import new_figure
        from lightflyer.parametric.figures import draw_line, draw_map, pareto_figure

        figure = new_figure()
        if len(fields) == 1:
            draw_line(sliced, fields[0], output, figure.axes[0])
        else:
            draw_map(sliced, fields[0], fields[1], output, figure.axes[0])
        drawn = {f"{output}-map": figure}
        if pareto:
            fronts = pareto_figure(dataset, output)
            if fronts is None:
                raise ConfigurationError(
                    f"--pareto: the sweep has no altitude, levitation_irradiance or temperature to "
                    f"compare {output} with"
                )
            drawn[f"{output}-pareto"] = fronts
        return drawn

    written = figures.write_folder(out, {}, draw)
    finding, table = map_parts(sliced, fields, output)
    console.print(finding, soft_wrap=True)
    for name, (number, unit) in chosen.items():
        console.print(f"at {name} {amount(number, unit)}")
    show(console, [table])
    figures.tell(console, written)


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


def sensitivity_command(
    study_file: Path,
    /,
    *,
    out: Path | None = None,
    json_output: Json = False,
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Rank uncertain properties by their effect, and say what to measure next.

    Parameters
    ----------
    study_file
        TOML file with flyer = "flyer.toml" and the sections [sensitivity] and [sensitivity.at];
        uncertainties are those of [sensitivity.inputs], by default those of the flyer file.
    out
        Folder to write the result (JSON) and a tornado figure for each output into.
    json_output
        Print one JSON object instead of tables.
    figures
        How figures are written.
    """
    out = figures.folder(out)
    from lightflyer.search import read_sensitivity_study, sensitivity

    study = read_sensitivity_study(study_file)
    results = sensitivity(study)
    summary = {found.output: found.summary() for found in results}
    written = figures.write_folder(
        out,
        {"sensitivity.json": summary},
        lambda: {f"{found.output}-tornado": found.plot() for found in results},
    )
    if json_output:
        print_json(summary)
        return
    console = printer()
    for found in results:
        show(console, found.text_parts())
    for group in study.groups:
        if len(group) > 1:
            values = (v for pair, v in study.correlations.items() if set(pair) <= set(group))
            console.print(
                f"{' and '.join(group)} vary together (correlation "
                f"{', '.join(f'{value:g}' for value in values)}) and have one share; the last two "
                "columns are quantiles of the output",
                soft_wrap=True,
            )
    show(console, warning_lines(results[0].warnings))
    figures.tell(console, written)
