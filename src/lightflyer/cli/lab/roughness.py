"""``lightflyer lab roughness``: roughness of surfaces without the particles on them."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from lightflyer.cli.figure_files import AS_USUAL, ResultOptions
from lightflyer.cli.lab.shared import Files, deliver
from lightflyer.cli.options import Json, Seed, Whole, only_with
from lightflyer.cli.output import print_json, printer
from lightflyer.cli.quantities import exact, optional_share
from lightflyer.core.errors import ParameterError
from lightflyer.files.result_text import warning_lines

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@only_with(flatten_order="flatten")
def roughness_command(
    files: Files,
    /,
    *,
    size: str | None = None,
    unit: str | None = None,
    channel: str | None = None,
    list_channels: Annotated[bool, Parameter(negative=())] = False,
    mask: str = "auto",
    threshold: float = 5.0,
    order: Whole = 2,
    flatten: Literal["none", "rows"] = "none",
    flatten_order: Whole = 0,
    height_accuracy: str | None = None,
    seed: Seed = 0,
    out: Path | None = None,
    json_output: Json = False,
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Level height maps, mask particles and holes, and find the roughness of the surface.

    Parameters
    ----------
    files
        Maps: Asylum's .ibw, Gwyddion's .gwy, Nanoscope's .spm, Nanosurf's .nid, JPK's .jpk,
        Digital Surf's .sur, WSxM's .stp, Agilent's .mi, or text files with a matrix of heights.
    size
        Width of a matrix, such as "10 um", where the file does not state it.
    unit
        Unit of a matrix's heights, such as "nm", where the file does not state it.
    channel
        Channel of a file with several, such as HeightRetrace.
    list_channels
        Print the channels of the files and their units, and stop.
    mask
        auto masks particles and holes such as lost pixels; none takes the map as it is; the name
        of a file masks what it shows: a picture (.png) of the map's pixels in which all but black
        is masked, or a matrix of 0 and 1. --out writes such pictures.
    threshold
        Least relief of a particle or hole, in robust standard deviations of the surface.
    order
        Order of the levelling polynomial: 1 is a plane, 2 adds curvature.
    flatten
        rows shifts each scan line to the median of its differences from the line before.
    flatten_order
        0 shifts scan lines, 1 also tilts them.
    height_accuracy
        Relative standard uncertainty of the microscope's heights (z calibration), common to all
        maps. Default: 2 %, assumed.
    seed
        Seed of the resampling for the intervals.
    out
        Folder to write the record (JSON, NetCDF) and the figure into.
    json_output
        Print one JSON object instead of tables.
    figures
        How figures are written.
    """
    out = figures.folder(out)
    if list_channels:
        _show_channels(files, json_output=json_output)
        return
    from lightflyer.lab.readers.height_map import read_height_map
    from lightflyer.lab.readers.masks import mask_as_png, read_mask
    from lightflyer.lab.record import require_distinct
    from lightflyer.lab.surface.particles import THRESHOLD
    from lightflyer.lab.surface.reduction import mean_parameters, roughness, summary, to_dataset
    from lightflyer.lab.surface.text import finding_parts, means_parts, roughness_parts

    options: dict[str, Any] = {
        "mask": mask if mask in ("auto", "none") else read_mask(Path(mask)),
        "threshold": threshold, "order": order, "flatten": flatten,
        "flatten_order": flatten_order, "seed": seed,
        "height_accuracy": optional_share("--height-accuracy", height_accuracy),
    }  # fmt: skip
    if mask != "auto" and threshold != THRESHOLD:
        raise ParameterError(f"--threshold is for --mask auto; with {mask} it does nothing")
    width = None if size is None else exact("--size", size, "m")
    maps = [read_height_map(file, size=width, unit=unit, channel=channel) for file in files]
    require_distinct([(one.source, one.height) for one in maps])
    results = [roughness(one, **options) for one in maps]
    document = summary(results)

    def draw() -> "dict[str, Figure]":
        from lightflyer.lab.surface.figures import roughness_figures, texture_figures

        return roughness_figures(results) | texture_figures(results)

    parts = [part for one in results for part in roughness_parts(one)]
    means = results[0].parameters if len(results) == 1 else mean_parameters(results)
    if len(results) > 1:
        parts += means_parts(means, len(results))
    deliver(
        "roughness", document, to_dataset(results), draw,
        [*finding_parts(means), *parts, *warning_lines(document["warnings"])],
        out=out, figures=figures, json_output=json_output,
        tables={f"mask-{number}.png": mask_as_png(one.mask) for number, one in enumerate(results)},
    )  # fmt: skip


def _show_channels(files: "Sequence[Path]", *, json_output: bool) -> None:
    from lightflyer.lab.readers.height_map import list_channels

    found = {str(file): list_channels(file) for file in files}
    if json_output:
        fields = ("name", "unit", "is_height")
        print_json(
            {
                name: [{field: getattr(one, field) for field in fields} for one in channels]
                for name, channels in found.items()
            }
        )
        return
    console = printer()
    for name, channels in found.items():
        console.print(f"{name}:", markup=False, soft_wrap=True)
        for one in channels:
            rows, columns = one.shape
            about = f"{columns} x {rows} pixels{'' if one.is_height else ', not a height'}"
            console.print(f"  {one.description}: {about}", markup=False, soft_wrap=True)
