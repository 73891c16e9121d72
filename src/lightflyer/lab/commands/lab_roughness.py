"""Roughness of surfaces from height maps, without the particles on them."""

from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from lightflyer.core.errors import ParameterError
from lightflyer.lab.options import Metres, Share, measurement

if TYPE_CHECKING:
    from lightflyer.lab.result import Listing, Outcome


@measurement(flatten_order="flatten")
def roughness(
    files: list[Path],
    /,
    *,
    size: Metres = None,
    unit: str | None = None,
    channel: str | None = None,
    list_channels: bool = False,
    mask: str = "auto",
    threshold: float = 5.0,
    order: int = 2,
    flatten: Literal["none", "rows"] = "none",
    flatten_order: int = 0,
    height_accuracy: Share = None,
    seed: int = 0,
) -> "Outcome | Listing":
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
    """
    from lightflyer.lab.readers.height_map import list_channels as channels_of
    from lightflyer.lab.readers.height_map import mask_as_png, read_height_map, read_mask
    from lightflyer.lab.result import Outcome, estimate_table, figures_by, require_distinct
    from lightflyer.lab.surface.heights import THRESHOLD
    from lightflyer.lab.surface.reduction import NAMES, mean_parameters, summary, to_dataset
    from lightflyer.lab.surface.reduction import roughness as roughness_of

    if list_channels:
        from lightflyer.lab.result import Listing

        lines, listing, fields = [], {}, ("name", "unit", "is_height")
        for file in files:
            channels = channels_of(file)
            listing[str(file)] = [{key: getattr(one, key) for key in fields} for one in channels]
            lines.append(f"{file}:")
            for one in channels:
                rows, columns = one.shape
                about = f"{columns} x {rows} pixels{'' if one.is_height else ', not a height'}"
                lines.append(f"  {one.description}: {about}")
        return Listing(listing, lines)
    where: Any = mask if mask in ("auto", "none") else read_mask(Path(mask))
    if mask != "auto" and threshold != THRESHOLD:
        raise ParameterError(f"--threshold is for --mask auto; with {mask} it does nothing")
    maps = [read_height_map(file, size=size, unit=unit, channel=channel) for file in files]
    require_distinct([(one.source, one.height) for one in maps])
    results = [
        roughness_of(
            one, mask=where, threshold=threshold, order=order, flatten=flatten,
            flatten_order=flatten_order, height_accuracy=height_accuracy, seed=seed,
        )
        for one in maps
    ]  # fmt: skip
    document = summary(results)
    parts = [part for one in results for part in one.parts()]
    means = results[0].parameters if len(results) == 1 else mean_parameters(results)
    named = {text: means[name] for name, text in NAMES.items()}
    if len(results) > 1:
        parts += [f"mean of {len(results)} maps", estimate_table(named)]

    return Outcome(
        document,
        to_dataset(results),
        [*(f"{name} {one}" for name, one in [*named.items()][:1]), *parts],
        read=[{"file": one.source, "channel": one.channel} for one in maps],
        warnings=document["warnings"],
        figures=figures_by("surface.figures:surface_figures", results),
        tables={f"mask-{number}.png": mask_as_png(one.mask) for number, one in enumerate(results)},
    )
