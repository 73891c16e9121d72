"""``lightflyer sweep``: compute the outputs of many designs into a folder."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import Parameter
from rich.console import Console

from lightflyer.cli.amounts import duration, in_words, with_prefix
from lightflyer.cli.options import Json, Whole
from lightflyer.cli.output import print_json, printer, say
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.files.result_text import table_of

if TYPE_CHECKING:
    import xarray as xr

    from lightflyer.parametric.explore import BestDesign
    from lightflyer.parametric.run import SweepReport
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
    from lightflyer.parametric.run import open_sweep, sweep_into
    from lightflyer.study.study import read_study

    for name, value in (("--workers", workers), ("--chunk", chunk)):
        if value is not None and value < 1:
            raise ParameterError(f"{name} must be at least 1")
    study = read_study(study_file)
    if not yes:
        _require_reasonable(study, out)
    report = sweep_into(
        study,
        out,
        scheduler=scheduler,
        workers=workers,
        chunk=CHUNK if chunk is None else chunk,
        device=device,
    )
    dataset = open_sweep(out)
    if json_output:
        name, best = _best(dataset)
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
    _show(printer(), study, report, dataset)
    console = printer()
    console.print(f"wrote {out}", soft_wrap=True)
    across = next(iter(study.dimensions[0].values), "FIELD") if study.dimensions else "FIELD"
    judged = _best(dataset)[0] or study.outputs[0]
    say(console, f"next: lightflyer map {out} --x {across} --value {judged}")


def _require_reasonable(study: "Study", out: Path) -> None:
    from lightflyer.parametric.run import LARGEST, estimate

    if study.size <= LARGEST:
        return
    found = estimate(study, out)
    size, free = (with_prefix(count, "B") for count in (found.size, found.free))
    raise ConfigurationError(
        f"the study has {in_words(found.designs)} designs: about {duration(found.seconds)} on this "
        f"machine and {size} on the disk, which has {free} free; start it with --yes"
    )


def _show(console: Console, study: "Study", report: "SweepReport", dataset: "xr.Dataset") -> None:
    from lightflyer.files.display_units import suitable

    rows, fields = [], study.fields
    for dimension in study.dimensions:
        for name, values in dimension.values.items():
            factor, unit = suitable(fields[name].quantity.unit, values)
            ends = (f"{end * factor:.6g}" for end in (values.min(), values.max()))
            rows.append((name, str(len(values)), *ends, unit))
    for name, value in study.fixed.items():
        factor, unit = suitable(fields[name].quantity.unit, value)
        rows.append((name, "1", f"{value * factor:.6g}", "", unit))
    console.print(table_of(("field", "values", "from", "to", "unit"), rows, left=(0, 4)))
    console.print(report_line(report), soft_wrap=True)
    if report.not_converged:
        console.print(f"{report.not_converged} designs have not converged and are NaN")
    name, best = _best(dataset)
    if name:
        shown = f"no design has a {name}" if best is None else f"largest {name}: {best}"
        console.print(shown, soft_wrap=True)
    for text in _warnings(study, best):
        console.print(f"warning: {text}", soft_wrap=True)


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
