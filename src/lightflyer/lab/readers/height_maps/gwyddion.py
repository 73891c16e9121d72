"""Gwyddion's own format."""

import io
from typing import Any

import numpy as np

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.extras import extra
from lightflyer.lab.readers.formats import Source, reason
from lightflyer.lab.readers.height_maps.channel import Channel

_ITEM_SIZES = {"b": 1, "c": 1, "i": 4, "q": 8, "d": 8}  # of Gwyddion's types


def read_channels(source: Source) -> list[Channel]:
    """Channels of a Gwyddion file."""
    path, content = source
    gwyfile = extra("gwyfile", "reading .gwy files", "lab")
    util = extra("gwyfile.util", "reading .gwy files", "lab")
    if content[:4] != b"GWYP":
        raise ConfigurationError(f"{path}: is not a Gwyddion file")
    try:
        _require_sound(content, 4)
        fields = util.get_datafields(gwyfile.load(io.BytesIO(content)))
        sides = {_unit(one, "si_unit_xy") for one in fields.values()}
        channels = [_channel(str(name), one) for name, one in fields.items()]
    except Exception as error:  # the parser has no errors of its own
        raise ConfigurationError(f"{path}: cannot be read as Gwyddion: {reason(error)}") from None
    if not channels:
        raise ConfigurationError(f"{path}: contains no map")
    if wrong := sorted(sides - {"m"}):
        raise ConfigurationError(f'{path}: its sides have the unit "{wrong[0]}", not m')
    return channels


def _unit(field: Any, which: str) -> str:
    return str(getattr(getattr(field, which, None), "unitstr", "m"))


def _channel(name: str, field: Any) -> Channel:
    height = np.asarray(field.data, float)
    rows, columns = height.shape
    # Gwyddion's heights without a unit are no lengths
    unit = _unit(field, "si_unit_z") or "1"
    return Channel(name, unit, (rows, columns), float(field.xreal), float(field.yreal),
                   lambda: height)  # fmt: skip


def _require_sound(content: bytes, start: int) -> int:
    """End of an object of a Gwyddion file; ValueError if its parts do not fit its size."""
    # gwyfile does not return from some damaged files.
    start = content.index(b"\0", start) + 1
    end = start + 4 + int.from_bytes(content[start : start + 4], "little")
    start += 4
    if end > len(content):
        raise ValueError("an object is longer than the file")
    while start < end:
        start = content.index(b"\0", start, end) + 1
        kind = content[start : start + 1].decode("ascii")
        start += 1
        count = 1
        if kind.isupper():
            count = int.from_bytes(content[start : start + 4], "little")
            start += 4
        if kind.lower() in _ITEM_SIZES:
            start += count * _ITEM_SIZES[kind.lower()]
        elif kind.lower() in ("s", "o") and count <= end - start:
            for _ in range(count):
                text = kind.lower() == "s"
                start = (
                    content.index(b"\0", start, end) + 1 if text else _require_sound(content, start)
                )
        else:
            raise ValueError(f"a component of the unknown type {kind!r}")
    if start != end:
        raise ValueError("a component is longer than its object")
    return end
