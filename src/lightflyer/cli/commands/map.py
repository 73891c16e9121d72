"""``lightflyer map``: figures of a sweep's results."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from lightflyer.cli.figure_files import AS_USUAL, ResultOptions
from lightflyer.cli.output import printer, show
from lightflyer.core.errors import ConfigurationError

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure


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
    names = [*fields, output]
    written = figures.write_folder(out, {}, lambda: _draw(dataset, sliced, names, pareto=pareto))
    finding, table = map_parts(sliced, fields, output)
    console.print(finding, soft_wrap=True)
    for name, (number, unit) in chosen.items():
        console.print(f"at {name} {amount(number, unit)}")
    show(console, [table])
    figures.tell(console, written)


def _draw(
    dataset: "xr.Dataset", sliced: "xr.Dataset", names: list[str], *, pareto: bool
) -> "dict[str, Figure]":
    from lightflyer.files import drawing as plot
    from lightflyer.parametric import figures as sweep_figures

    *fields, output = names
    figure = plot.new_figure()
    if len(fields) == 1:
        sweep_figures.draw_line(sliced, fields[0], output, figure.axes[0])
    else:
        sweep_figures.draw_map(sliced, fields[0], fields[1], output, figure.axes[0])
    figures = {f"{output}-map": figure}
    if pareto:
        fronts = sweep_figures.pareto_figure(dataset, output)
        if fronts is None:
            raise ConfigurationError(
                f"--pareto: the sweep has no altitude, levitation_irradiance or temperature to "
                f"compare {output} with"
            )
        figures[f"{output}-pareto"] = fronts
    return figures
