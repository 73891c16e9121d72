"""Temperatures of regions of a radiometric image from a FLIR camera."""

import re
from pathlib import Path
from typing import Any

import numpy as np

from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.extras import extra
from lightflyer.foundation.units import Measured

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
        If the file contains none.
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
    return np.asarray(kelvin, float)


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
        If a part is not a rectangle, or an empty one.
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
        found[match[1]] = (slice(first, last), slice(left, right))
    return found


def region_temperatures(
    image: np.ndarray, regions: dict[str, tuple[slice, slice]], source: str
) -> dict[str, Measured]:
    """Mean temperature of each region with its standard error.

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
        [K], by the name of the region with ``_temperature`` appended.

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
        spread = float(pixels.std(ddof=1) / np.sqrt(pixels.size)) if pixels.size > 1 else 0.0
        found[f"{name}_temperature"] = Measured(float(pixels.mean()), spread)
    return found
