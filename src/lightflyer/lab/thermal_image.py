"""Temperatures of regions of a radiometric image from a FLIR camera."""

import re
from pathlib import Path
from typing import Any

import numpy as np

from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.extras import extra
from lightflyer.foundation.units import Measured
from lightflyer.lab.thermography_data import THERMAL

UNIFORM = 2.0
"""Scatter of a region's pixels above which it is not called uniform [K]; an assumption."""

_ALIKE = 0.1  # share of pixels at an end of the image's range that suggests saturation
_NAMES = tuple(name.removesuffix("_temperature") for name in THERMAL.readings)

_REGION = re.compile(r"^\s*(\w+)\s*=\s*(\d+)\s*:\s*(\d+)\s*,\s*(\d+)\s*:\s*(\d+)\s*$")


def read_thermal_image(path: str | Path) -> np.ndarray:
    """Read the temperatures of a radiometric JPEG from a FLIR camera.

    Parameters
    ----------
    path : str or path

    Returns
    -------
    array, shape (rows, columns)
        [K].

    Raises
    ------
    ConfigurationError
        If the file contains none, or one without a value in some pixel.
    MissingExtraError
        If flyr is not installed.
    """
    path = Path(path)
    if not path.is_file():
        raise ConfigurationError(f"{path}: cannot be read: no such file")
    flyr = extra("flyr", "reading radiometric images", "lab")
    try:
        kelvin: Any = flyr.unpack(str(path)).kelvin
    except Exception as error:  # the parser has no errors of its own
        said = " ".join(repr(error).split())
        raise ConfigurationError(f"{path}: is not a radiometric FLIR image: {said}") from None
    image = np.asarray(kelvin, float)
    lost = int(np.count_nonzero(~np.isfinite(image)))
    if lost:
        raise ConfigurationError(f"{path}: {lost} of {image.size} pixels have no temperature")
    return image


def parse_regions(text: str) -> dict[str, tuple[slice, slice]]:
    """Parse named rectangles of an image.

    Parameters
    ----------
    text : str
        First and last rows, then columns: ``"hotplate=10:40,20:60; upper=50:80,20:60"``.

    Returns
    -------
    dict of str to (slice, slice)

    Raises
    ------
    ConfigurationError
        If a part is not a rectangle, or an empty one, or has an unknown or repeated name.
    """
    found = {}
    for part in filter(str.strip, text.split(";")):
        match = _REGION.match(part)
        if match is None:
            raise ConfigurationError(
                f'--regions: "{part.strip()}" is not a region; write "hotplate=10:40,20:60"'
            )
        first, last, left, right = map(int, match.groups()[1:])
        if first >= last or left >= right:
            raise ConfigurationError(f'--regions: "{part.strip()}" is empty')
        if match[1] not in _NAMES or match[1] in found:
            said = "is named twice" if match[1] in found else f"is none of {', '.join(_NAMES)}"
            raise ConfigurationError(f'--regions: "{match[1]}" {said}')
        found[match[1]] = (slice(first, last), slice(left, right))
    return found


def region_temperatures(
    image: np.ndarray, regions: dict[str, tuple[slice, slice]], source: str
) -> dict[str, Measured]:
    """Mean temperature of each region with the scatter of its pixels.

    Parameters
    ----------
    image : array, shape (rows, columns)
        [K].
    regions : dict of str to (slice, slice)
    source : str
        Name of the image, for messages.

    Returns
    -------
    dict of str to Measured
        [K], by the name of the region with ``_temperature`` appended. The uncertainty is the
        standard deviation of the pixels and not that of their mean: neighbouring pixels deviate
        together, and the film need not see the mean of the hotplate.

    Raises
    ------
    ConfigurationError
        If a region extends beyond the image.
    """
    found = {}
    for name, (rows, columns) in regions.items():
        if rows.stop > image.shape[0] or columns.stop > image.shape[1]:
            shape = " x ".join(map(str, image.shape))
            raise ConfigurationError(
                f"{source}: region {name} extends beyond the image of {shape} pixels"
            )
        pixels = image[rows, columns]
        spread = float(pixels.std(ddof=1)) if pixels.size > 1 else 0.0
        found[f"{name}_temperature"] = Measured(float(pixels.mean()), spread)
    return found


def region_warnings(image: np.ndarray, regions: dict[str, tuple[slice, slice]]) -> tuple[str, ...]:
    """What is wrong with the regions of an image.

    Parameters
    ----------
    image : array, shape (rows, columns)
        [K].
    regions : dict of str to (slice, slice)

    Returns
    -------
    tuple of str
        One line for each region that is not uniform, or saturated.
    """
    said = []
    for name, place in regions.items():
        pixels = image[place]
        for end in (image.min(), image.max()):
            alike = float(np.mean(pixels == end))
            if alike > _ALIKE:
                said.append(
                    f"region {name}: {alike:.0%} of its pixels are at {end:.5g} K, the end of the "
                    "image's range; they may be saturated"
                )
        if pixels.std() > UNIFORM:
            said.append(
                f"region {name} is not uniform: its pixels scatter by {pixels.std():.2g} K; "
                "choose a smaller one"
            )
    return tuple(said)
