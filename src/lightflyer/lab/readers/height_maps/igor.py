"""Igor binary waves, as Asylum Research's microscopes write them."""

import io
import math
import struct
from typing import Any

import numpy as np

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.extras import extra
from lightflyer.lab.readers.formats import Source, reason
from lightflyer.lab.readers.height_maps.channel import Channel, metres

# offsets in an Igor wave of version 5: sizes of its parts, numbers of points, end of the headers
_SIZES, _DIMENSIONS, _HEADERS = (4, "14i"), (64 + 68, "4i"), 64 + 320


def read_channels(source: Source) -> list[Channel]:
    """Channels of an Igor wave."""
    path, content = source
    binarywave = extra("igor2.binarywave", "reading .ibw files", "lab")
    try:
        _require_sound_wave(content)
        wave = binarywave.load(io.BytesIO(content))["wave"]
        with np.errstate(invalid="ignore"):  # damaged numbers are found later
            data = np.asarray(wave["wData"], float)
        header = wave["wave_header"]
        scales = [float(scale) for scale in header["sfA"]]
        unit = _text(header["dataUnits"])
        side = _text(header["dimUnits"][0])
        labels = [] if data.ndim < 3 else wave["labels"][2]
    except Exception as error:  # the parser has no errors of its own
        why = f"cannot be read as an Igor wave: {reason(error)}"
        raise ConfigurationError(f"{path}: {why}") from None
    if data.ndim not in (2, 3) or not data.size:
        raise ConfigurationError(f"{path}: contains no map")
    pixel = metres(side) if side else 1.0
    if pixel is None:
        raise ConfigurationError(f'{path}: its sides have the unit "{side}", which is no length')
    layers = data[:, :, None] if data.ndim == 2 else data
    width, length = (
        abs(scale) * count * pixel
        for scale, count in zip(scales[:2], layers.shape[:2], strict=True)
    )
    names = [bytes(label).decode("utf-8", "replace") for label in labels if label]
    if len(names) != layers.shape[2]:
        names = [f"layer {number}" for number in range(layers.shape[2])]
    if data.ndim == 2:
        names = [""]
    elif unit == "m":
        unit = ""  # Asylum states metres for all layers, phases too
    scale = metres(unit) or 1.0
    shape = (layers.shape[1], layers.shape[0])
    maps = scale * np.moveaxis(layers, 2, 0).swapaxes(1, 2)
    return [
        Channel(name, unit, shape, width, length, one.copy)
        for name, one in zip(names, maps, strict=True)
    ]


def _text(field: Any) -> str:
    """Characters of a fixed-width field."""
    return b"".join(bytes(one) for one in np.ravel(field)).split(b"\0")[0].decode("latin-1").strip()


def _require_sound_wave(content: bytes) -> None:
    """Raise ValueError if the sizes in the header of an Igor wave do not fit the file."""
    # igor2 runs for very long on some damaged files.
    if len(content) < _HEADERS:
        raise ValueError("the file ends within its header")
    order = {b"\5\0": "<", b"\0\5": ">"}.get(content[:2])
    if order is None:
        raise ValueError("not a wave of version 5")
    sizes = struct.unpack_from(order + _SIZES[1], content, _SIZES[0])
    counts = struct.unpack_from(order + _DIMENSIONS[1], content, _DIMENSIONS[0])
    if min(sizes) < 0 or sum(sizes) > len(content):
        raise ValueError("a part is longer than the file")
    if min(counts) < 0 or math.prod(count for count in counts if count) > sizes[0]:
        raise ValueError("the map is larger than the file")
