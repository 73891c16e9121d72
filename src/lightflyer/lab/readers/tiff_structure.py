"""Whether the directories of a TIFF file fit it: tifffile hangs on some damaged ones."""

import struct

_ORDERS = {b"II*\0": "<", b"MM\0*": ">"}
_ENTRY = "HHII"  # code, type, count, value or its place
_SIZES = {1: 1, 2: 1, 3: 2, 4: 4, 5: 8, 6: 1, 7: 1, 8: 2, 9: 4, 10: 8, 11: 4, 12: 8, 13: 4}
"""Bytes of a value of each type, by TIFF 6.0."""

_MOST_PAGES = 1000
_PIXELS = (256, 257)  # codes of width and length


def require_sound_tiff(content: bytes) -> None:
    """Check the directories of a classic TIFF file."""
    order = _ORDERS.get(content[:4])
    if order is None or len(content) < 8:
        raise ValueError("not a TIFF file")
    seen: set[int] = set()
    place = struct.unpack_from(order + "I", content, 4)[0]
    while place:
        if place in seen or len(seen) >= _MOST_PAGES:
            raise ValueError("its directories go round in a circle")
        seen.add(place)
        if place + 2 > len(content):
            raise ValueError("a directory lies beyond the end of the file")
        count = struct.unpack_from(order + "H", content, place)[0]
        size = struct.calcsize(order + _ENTRY)
        end = place + 2 + count * size
        if end + 4 > len(content):
            raise ValueError("a directory is longer than the file")
        pixels = 1
        for start in range(place + 2, end, size):
            code, kind, values, where = struct.unpack_from(order + _ENTRY, content, start)
            if kind not in _SIZES:
                raise ValueError(f"entry {code} has the unknown type {kind}")
            held = values * _SIZES[kind]
            if held > 4 and where + held > len(content):
                raise ValueError(f"entry {code} lies beyond the end of the file")
            if code in _PIXELS and kind in (3, 4):
                short = struct.unpack_from(order + "H", content, start + 8)[0]
                pixels *= short if kind == 3 else where
        if pixels > 64 * len(content):  # compressed images hold more pixels than bytes
            raise ValueError("an image is larger than the file")
        place = int(struct.unpack_from(order + "I", content, end)[0])
