"""Thermal images: FLIR's, matrices in text, TIFF; and the regions of an image."""

import dataclasses
import io
import re
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple
from xml.etree import ElementTree

import numpy as np
from PIL import Image, UnidentifiedImageError

from lightflyer.array.records import ShortRepr
from lightflyer.core.checks import require_range
from lightflyer.core.constants import ZERO_CELSIUS
from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Temperature
from lightflyer.core.text import read_content
from lightflyer.core.units import Measured, parse, scale_and_offset
from lightflyer.lab.readers.formats import (
    WORDS,
    Format,
    Source,
    find_format,
    has_suffix,
    read_number_matrix,
    read_source,
    require_sound_tiff,
)
from lightflyer.lab.thermography import flir
from lightflyer.lab.thermography.data import THERMAL

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_UNIT = re.compile(r"^\s*([-+]?[\d.]+(?:e[-+]?\d+)?)?\s*(\S.*?)\s*$", re.I)
_IN_HEADING = re.compile(
    r"°\s?[CF]|℃|℉|\bdeg ?[CF]\b|\[[KCF]\]|\([KCF]\)|\bKelvin\b|\bCelsius\b|\bFahrenheit\b", re.I
)
_UNITS = {"c": "°C", "f": "°F", "k": "K"}
_EMISSIVITY = re.compile(r"\bemissivity\b\W*?(\d[.,]\d+|1)\b", re.I)
_GDAL_METADATA, _GDAL_NO_DATA = 42112, 42113  # tags
_EIGHT_BITS = 8
UNIFORM = 2.0
"""Scatter of a region's pixels above which it is not called uniform [K]; an assumption."""
_NOT_TAKEN = {
    "scale": "states its scale itself; leave --image-unit out",
    **dict.fromkeys(
        ("emissivity", "reflected_temperature"),
        "holds temperatures and no signal, for which another emissivity or reflected temperature "
        "could be set; set it in the camera's program",
    ),
}
_AGREE = 0.5  # [K] by which reflected temperature and surroundings may differ
_ALIKE = 0.1  # share of pixels at an end of the image's range that suggests saturation
_NAMES = tuple(name.removesuffix("_temperature") for name in THERMAL.readings)
_REGION = re.compile(r"^\s*(\w+)\s*=\s*(\d+)\s*:\s*(\d+)\s*,\s*(\d+)\s*:\s*(\d+)\s*$")


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


def _read_matrix(source: Source, scale: Scale | None = None) -> "ThermalImage":
    path = source.path
    matrix = read_number_matrix(path, "temperatures")
    above = "\n".join(matrix.above)
    if scale is None:
        found = set()
        for text in _IN_HEADING.findall(above):
            letters = re.sub(r"deg|[^a-z℃℉]", "", text.lower()).replace("℃", "c").replace("℉", "f")
            found.add(_UNITS[letters[0]])
        if len(found) != 1:
            said = f"its heading names {' and '.join(sorted(found))}" if found else "it has no unit"
            raise ConfigurationError(f'{path}: {said}; state the unit by --image-unit "°C"')
        scale = parse_scale(found.pop())
    emissivity = _EMISSIVITY.search(above)
    stated = None if emissivity is None else float(emissivity[1].replace(",", "."))
    kelvin = matrix.values * scale.step + scale.zero
    return ThermalImage(str(path), kelvin, stated, notes=matrix.notes)


def _read_tiff(source: Source, scale: Scale | None = None) -> "ThermalImage":
    path, content = source
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
        try:
            kelvin = np.where(values == float(text.strip("\0 ")), np.nan, kelvin)
        except ValueError:
            raise ConfigurationError(
                f"{path}: its GDAL tag for missing data is not a number"
            ) from None
    notes = (f"the first of {count} images in the file is read",) if count > 1 else ()
    return ThermalImage(str(path), kelvin, notes=notes)


def _gdal_scale(path: Path, tags: dict[int, Any]) -> Scale | None:
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
        raise ConfigurationError(f"{path}: its GDAL tag cannot be read: {error}") from None
    return Scale(factor * step, offset * step + zero)


@dataclass(frozen=True)
class ThermalImage(ShortRepr):
    """Temperatures of the pixels of an image."""

    source: str  #: Name of the file
    #: shape (rows, columns); [K], for the emissivity and the reflected temperature; NaN where the
    #: file has none
    temperature: np.ndarray
    #: For which the temperatures hold, None where the file does not state it [1]
    emissivity: float | None = None
    #: The same of the radiation that the object reflects [K]
    reflected_temperature: float | None = None
    notes: tuple[str, ...] = ()  #: What a reader of the image must know of its file

    def plot(self) -> "Figure":
        """Draw the temperatures."""
        from lightflyer.lab.thermography.figures import plot_image

        return plot_image(self)

    def summary(self) -> dict[str, Any]:
        """What the file states, as a JSON object."""
        return {
            "file": self.source,
            "pixels": list(self.temperature.shape),
            "emissivity": self.emissivity,
            "reflected_temperature_K": self.reflected_temperature,
        }

    @property
    def description(self) -> str:
        """What was read, in one line."""
        rows, columns = self.temperature.shape
        said = f"read {self.source}: {columns} x {rows} pixels"
        if self.emissivity is not None:
            said += f", for an emissivity of {self.emissivity:.4g}"
        if self.reflected_temperature is not None:
            said += f", reflected temperature {self.reflected_temperature - ZERO_CELSIUS:.4g} °C"
        return said


@reads_units
def read_thermal_image(
    path: str | Path,
    *,
    scale: Scale | None = None,
    emissivity: float | None = None,
    reflected_temperature: Temperature | None = None,
) -> ThermalImage:
    """Read a thermal image.

    Parameters
    ----------
    path : str or path
        Radiometric JPEG or ``.fff`` of a FLIR camera, radiometric TIFF, or a text file with a
        matrix of temperatures.
    scale : Scale, optional
        What the numbers of a TIFF or a text file mean, where the file does not state it; see
        :func:`~lightflyer.lab.thermography.thermal_image.parse_scale`.
    emissivity : float, optional
        In place of the one that a FLIR camera was set to [1].
    reflected_temperature : float, optional
        The same of the radiation that the object reflects [K].

    Returns
    -------
    ThermalImage

    Raises
    ------
    ConfigurationError
        One line that names the file.
    """
    source = read_source(Path(path))
    kind = find_format(source, THERMAL_IMAGE_FORMATS)
    other = WORDS["not_read"]["thermal_images"].get(source.suffix)
    if kind is None and other is not None:
        source.refuse(f"is {other}")
    kind = kind or _MATRIX
    options = {
        "scale": scale, "emissivity": emissivity, "reflected_temperature": reflected_temperature
    }  # fmt: skip
    given = {name: value for name, value in options.items() if value is not None}
    for name in given:
        if name not in kind.options:
            source.refuse(_NOT_TAKEN[name])
    image: ThermalImage = kind.read(source, **given)
    known = image.temperature[np.isfinite(image.temperature)]
    if not known.size:
        raise ConfigurationError(f"{image.source}: no pixel has a temperature")
    scene = THERMAL.quantities[0]
    middle = float(np.median(known))
    if not scene.lowest <= middle <= scene.highest:
        raise ConfigurationError(
            f"{image.source}: half of its pixels are above {middle:.4g} K, which is not between "
            f"{scene.lowest:g} K and {scene.highest:g} K: the unit or the scale is wrong"
        )
    return image


def is_thermal_image(path: Path) -> bool:
    """Whether a file is an image, whatever the options; a matrix in a text file may be a table."""
    source = Source(path, read_content(path) if path.is_file() else b"")  # a sheet of a workbook
    return find_format(source, THERMAL_IMAGE_FORMATS) is not None


def _read_flir(
    source: Source, emissivity: float | None = None, reflected_temperature: float | None = None
) -> ThermalImage:
    counts, camera = flir.read_flir(*source)
    require_range("emissivity", emissivity, 0.0, 1.0, open_below=True)
    stated = {"emissivity": emissivity, "reflected_temperature": reflected_temperature}
    stated = {name: value for name, value in stated.items() if value is not None}
    notes: tuple[str, ...] = ()
    if stated:
        notes = (
            f"the camera was set to an emissivity of {camera.emissivity:.4g} and a reflected "
            f"temperature of {camera.reflected_temperature - ZERO_CELSIUS:.4g} °C, which are "
            "replaced as stated",
        )
        camera = dataclasses.replace(camera, **stated)  # type: ignore[arg-type]
        if wrong := camera.problem():
            source.refuse(wrong)
    kelvin = flir.temperatures(counts, camera)
    return ThermalImage(
        str(source.path), kelvin, camera.emissivity, camera.reflected_temperature, notes
    )


THERMAL_IMAGE_FORMATS = [
    Format(
        "FLIR",
        has_suffix(".jpg", ".jpeg", ".fff"),
        _read_flir,
        ("emissivity", "reflected_temperature"),
    ),
    Format("TIFF", has_suffix(".tif", ".tiff"), _read_tiff, ("scale",)),
]
"""All formats but matrices in text files. A plug-in adds its own."""

_MATRIX = Format("text", lambda _: True, _read_matrix, ("scale",))


def setting_warnings(image: ThermalImage, ambient: float) -> tuple[str, ...]:
    """What the camera's setting of emissivity does to readings that are compared."""
    one, reflected = image.emissivity, image.reflected_temperature
    said = f"temperatures of {image.source} are for an emissivity of {one or 1.0:.3g}"
    cancels = "; it cancels only if the reflected temperature was that of the surroundings"
    if one is None:
        text = f"{image.source} does not state the emissivity that the camera was set to{cancels}"
    elif one < 1.0 and reflected is None:
        text = said + cancels
    elif one < 1.0 and reflected is not None and abs(reflected - ambient) > _AGREE:
        text = (
            f"{said} and a reflected temperature of {reflected - ZERO_CELSIUS:.4g} °C; they cancel "
            f"only if that is the temperature of the surroundings, {ambient - ZERO_CELSIUS:.4g} "
            "°C; take apparent temperatures by --image-emissivity 1"
        )
    else:
        return image.notes
    return (*image.notes, text)


def parse_regions(text: str) -> dict[str, tuple[slice, slice]]:
    """Parse named rectangles of an image."""
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
    """Mean temperature of each region with the scatter of its pixels [K]."""
    found = {}
    for name, (rows, columns) in regions.items():
        if rows.stop > image.shape[0] or columns.stop > image.shape[1]:
            shape = " x ".join(map(str, image.shape))
            raise ConfigurationError(
                f"{source}: region {name} extends beyond the image of {shape} pixels"
            )
        pixels = image[rows, columns]
        if lost := int(np.count_nonzero(~np.isfinite(pixels))):
            raise ConfigurationError(
                f"{source}: {lost} of {pixels.size} pixels of region {name} have no temperature"
            )
        spread = float(pixels.std(ddof=1)) if pixels.size > 1 else 0.0
        found[f"{name}_temperature"] = Measured(float(pixels.mean()), spread)
    return found


def region_warnings(image: np.ndarray, regions: dict[str, tuple[slice, slice]]) -> tuple[str, ...]:
    """What is wrong with the regions of an image; ``image`` (rows, columns)."""
    said = []
    for name, place in regions.items():
        pixels = image[place]
        for end in (np.nanmin(image), np.nanmax(image)):
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
