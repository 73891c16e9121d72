"""Thermal images whose numbers are temperatures up to a scale: matrices in text, and TIFF."""

import io
import re
import warnings
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

import numpy as np
from PIL import Image, UnidentifiedImageError

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.units import parse, scale_and_offset
from lightflyer.lab.readers.formats import require_sound_tiff
from lightflyer.lab.readers.number_matrix import read_number_matrix

_UNIT = re.compile(r"^\s*([-+]?[\d.]+(?:e[-+]?\d+)?)?\s*(\S.*?)\s*$", re.I)
_IN_HEADING = re.compile(
    r"°\s?[CF]|℃|℉|\bdeg ?[CF]\b|\[[KCF]\]|\([KCF]\)|\bKelvin\b|\bCelsius\b|\bFahrenheit\b", re.I
)
_UNITS = {"c": "°C", "f": "°F", "k": "K"}
_EMISSIVITY = re.compile(r"\bemissivity\b\W*?(\d[.,]\d+|1)\b", re.I)
_GDAL_METADATA, _GDAL_NO_DATA = 42112, 42113  # tags
_EIGHT_BITS = 8


class Scale(NamedTuple):
    """What numbers of an image mean."""

    step: float  # [K] for a number of one
    zero: float  # Temperature of the number zero [K]


def parse_scale(unit: str, zero: str | None = None) -> Scale:
    """Scale from options."""
    match = _UNIT.match(unit)
    try:
        if match is None:
            raise ConfigurationError(f'"{unit}" is not a unit')
        step, offset = scale_and_offset(match[2], "K")
        factor = float(match[1] or 1.0)
    except (ConfigurationError, ValueError) as error:
        raise ConfigurationError(
            f'--image-unit: {error}; write "K", "°C" or a step such as "0.01 K"'
        ) from None
    if not factor > 0.0:
        raise ConfigurationError(f'--image-unit: "{unit}" is not positive')
    if zero is not None:
        try:
            offset = parse(zero, "K").value
        except ConfigurationError as error:
            raise ConfigurationError(f"--image-zero: {error}") from None
    return Scale(factor * step, offset)


def read_matrix(
    path: Path, scale: Scale | None
) -> tuple[np.ndarray, float | None, tuple[str, ...]]:
    """Read a matrix of temperatures, as cameras' programs export it."""
    matrix = read_number_matrix(path, "temperatures")
    above = "\n".join(matrix.above)
    if scale is None:
        found = {_spell(text) for text in _IN_HEADING.findall(above)}
        if len(found) != 1:
            said = f"its heading names {' and '.join(sorted(found))}" if found else "it has no unit"
            raise ConfigurationError(f'{path}: {said}; state the unit by --image-unit "°C"')
        scale = parse_scale(found.pop())
    emissivity = _EMISSIVITY.search(above)
    stated = None if emissivity is None else float(emissivity[1].replace(",", "."))
    return matrix.values * scale.step + scale.zero, stated, matrix.notes


def _spell(text: str) -> str:
    letters = re.sub(r"deg|[^a-z℃℉]", "", text.lower()).replace("℃", "c").replace("℉", "f")
    return _UNITS[letters[0]]


def read_tiff(
    path: Path, content: bytes, scale: Scale | None
) -> tuple[np.ndarray, tuple[str, ...]]:
    """Read a radiometric TIFF; returns ``temperature`` (rows, columns) [K], ``notes``."""
    try:
        require_sound_tiff(content)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with Image.open(io.BytesIO(content), formats=["TIFF"]) as image:
                values, mode, count = np.asarray(image), image.mode, getattr(image, "n_frames", 1)
                tags = dict(image.tag_v2)  # type: ignore[attr-defined]
    except UnidentifiedImageError:
        raise ConfigurationError(f"{path}: cannot be read as TIFF: its kind is unknown") from None
    except Exception as error:  # Pillow raises many kinds
        said = " ".join(str(error).split())
        raise ConfigurationError(f"{path}: cannot be read as TIFF: {said}") from None
    if values.ndim != 2 or values.dtype.itemsize * 8 <= _EIGHT_BITS:
        raise ConfigurationError(
            f"{path}: is a picture ({mode}), not an image of temperatures with 16 bits or more"
        )
    scale = scale or _gdal_scale(path, tags)
    if scale is None:
        raise ConfigurationError(
            f"{path}: does not state what its numbers mean; state it by --image-unit, such as "
            '"°C", "0.01 K" or "0.04 K" (see the manual of the camera)'
        )
    kelvin = values * scale.step + scale.zero
    if isinstance(text := tags.get(_GDAL_NO_DATA), str):
        kelvin = np.where(values == _gdal_no_data(path, text), np.nan, kelvin)
    notes = (f"the first of {count} images in the file is read",) if count > 1 else ()
    return kelvin, notes


def _gdal_scale(path: Path, tags: dict[int, Any]) -> Scale | None:
    """Scale, offset and unit by GDAL's metadata."""
    text = tags.get(_GDAL_METADATA)
    if not isinstance(text, str) or "<!" in text:  # no declarations of entities
        return None
    try:
        items = {
            item.get("role", ""): (item.text or "").strip()
            for item in ElementTree.fromstring(text.strip("\0 ")).iter("Item")
        }
        if "unittype" not in items:
            return None
        step, zero = scale_and_offset(items["unittype"], "K")
        factor, offset = float(items.get("scale", "1")), float(items.get("offset", "0"))
    except (ElementTree.ParseError, ValueError, ConfigurationError) as error:
        raise ConfigurationError(f"{path}: its tag of GDAL cannot be read: {error}") from None
    return Scale(factor * step, offset * step + zero)


def _gdal_no_data(path: Path, text: str) -> float:
    try:
        return float(text.strip("\0 "))
    except ValueError:
        raise ConfigurationError(f"{path}: its tag of GDAL for no data is no number") from None
