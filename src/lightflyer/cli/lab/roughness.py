"""``lightflyer lab roughness``: roughness of surfaces without the particles on them."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from lightflyer.cli.lab._shared import (
    Files,
    Json,
    estimate_table,
    finish,
    print_json,
    quantity,
    write_record,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from lightflyer.lab.surface import Roughness

_NAMES = {
    "rms_height": "rms height Sq",
    "mean_absolute_height": "mean absolute height Sa",
    "skewness": "skewness Ssk",
    "kurtosis": "kurtosis Sku",
}


def roughness_command(
    files: Files,
    /,
    *,
    size: str | None = None,
    unit: str | None = None,
    channel: str | None = None,
    threshold: float = 4.5,
    order: int = 2,
    seed: int = 0,
    out: Path | None = None,
    json_output: Json = False,
) -> None:
    """Level height maps, mask their particles, and find the roughness of the surface.

    Parameters
    ----------
    files
        Maps: Asylum's .ibw, Gwyddion's .gwy, or text files with a matrix of heights.
    size
        Width of a matrix, such as "10 um", where the file does not state it.
    unit
        Unit of a matrix's heights, such as "nm", where the file does not state it.
    channel
        Channel of a file with several, such as HeightRetrace.
    threshold
        Least height of a particle, in robust standard deviations of the surface.
    order
        Order of the levelling polynomial: 1 is a plane, 2 adds curvature.
    seed
        Seed of the resampling for the intervals.
    out
        Folder to write the record (JSON, NetCDF) and the figure (PNG, SVG) into.
    json_output
        Print one JSON object instead of tables.
    """
    from lightflyer.lab.height_map import read_height_map
    from lightflyer.lab.surface import roughness, summary, to_dataset

    width = None if size is None else quantity("--size", size, "m").value
    maps = [read_height_map(file, size=width, unit=unit, channel=channel) for file in files]
    results = [roughness(one, threshold=threshold, order=order, seed=seed) for one in maps]
    document = summary(results)
    written, _ = write_record(
        out, "roughness", document, to_dataset(results), lambda: _figures(results), lambda: []
    )
    if json_output:
        print_json(document)
        return
    console = Console(highlight=False)
    for one in results:
        rows, columns = one.height.shape
        channel_said = f", {one.source.channel}" if one.source.channel else ""
        console.print(
            f"read {one.source.source}{channel_said}: {columns} x {rows} pixels, "
            f"{one.source.width * 1e6:.4g} x {one.source.length * 1e6:.4g} µm; "
            f"{one.particles} particles on {one.masked_fraction.value:.2%} masked",
            markup=False, soft_wrap=True,
        )  # fmt: skip
        table = [(_NAMES[name], estimate) for name, estimate in one.parameters.items()]
        everything = one.parameters_all["rms_height"]
        console.print(estimate_table([*table, ("Sq with particles", everything)]))
    finish(console, written, [], None)


def _figures(results: "Sequence[Roughness]") -> "dict[str, Figure]":
    from lightflyer.lab.figures.surface import roughness_figures

    return roughness_figures(results)
