"""What a reader of a roughness must know about its map."""

import numpy as np

from lightflyer.lab.readers.height_map import HeightMap

LARGEST_MASKED = 0.05  # Masked fraction of a map above which a warning is issued

_MOST_LOST = 0.1  # power lost in levelling, over that left
_SKEWED = 1.0
_MOST_CLIPPED = 0.01  # of the pixels at the very highest or lowest value
_SHIFTED = 3.0  # scatter of the steps between rows, over that between columns
_OBLONG = 1.5  # longer side of a pixel over the shorter one
_STEEPEST = 10.0  # slope from pixel to pixel
_ATOMS = 5e-10  # between the lowest and the highest [m]
_PERCENT = 100.0


def warnings_of(
    source: HeightMap,
    raw: np.ndarray,
    masked: np.ndarray,
    skewness: float,
    lost: float,
    patches: float,
    *,
    flattened: bool,
) -> tuple[str, ...]:
    """Warnings of one map; ``raw`` (rows, columns); ``masked`` (rows, columns)."""
    said = list(source.notes)
    if missing := int(source.missing.sum()):
        said.append(
            f"{missing} pixels ({_PERCENT * missing / source.height.size:.2g} %) have no height; "
            "they are left out like holes"
        )
    if max(source.pixel_aspect, 1.0 / source.pixel_aspect) > _OBLONG:
        said.append(
            f"pixels are {source.pixel_aspect:.3g} times as wide as long: particles are searched "
            "for in circles of pixels, which are ellipses on the surface"
        )
    steps = np.diff(source.height, axis=1) * source.height.shape[1] / source.width
    slope = float(np.sqrt(np.nanmean(steps**2)))
    spread = float(np.nanmax(source.height) - np.nanmin(source.height))
    if slope > _STEEPEST or spread < _ATOMS:
        said.append(
            f"its heights lie within {1e9 * spread:.3g} nm, with a slope of {slope:.2g} from pixel "
            "to pixel, which no film has; check --size and --unit"
        )
    share = float(masked.mean())
    known = source.height[np.isfinite(source.height)]
    clipped = float(max((known == known.max()).mean(), (known == known.min()).mean()))
    if clipped > _MOST_CLIPPED:
        said.append(
            f"{_PERCENT * clipped:.1f} % of the heights are exactly the highest or the lowest: "
            "the range of the scanner or of the file may cut the surface off; measure with a "
            "larger range"
        )
    if share > LARGEST_MASKED:
        said.append(
            f"{_PERCENT * share:.1f} % of the map is masked; look at the figure, raise the "
            "threshold, use --mask none, or measure a cleaner place"
        )
    if abs(skewness) > _SKEWED:
        said.append(
            f"the surface is skewed (Ssk = {skewness:.2g}): particles no higher than its own peaks "
            "count as surface; look at the figure"
        )
    if lost > _MOST_LOST:
        said.append(
            f"levelling took about {_PERCENT * lost / (1.0 + lost):.0f} % of the surface's power, "
            f"and the map has only about {patches:.0f} independent patches: Sq is that of the "
            "levelled map, the interval that of the surface; a wider map narrows it"
        )
    # whether neighbouring rows differ by a common step far more than neighbouring columns
    across, along = (
        float(np.std(np.diff(np.median(np.diff(raw, axis=axis), axis=1 - axis)))) for axis in (0, 1)
    )
    if not flattened and across > _SHIFTED * along > 0.0:
        said.append("scan lines are shifted against each other; compare with --flatten rows")
    return tuple(said)
