"""Damage to files as disks, cables, editors and spreadsheets do it; from a seed."""

from collections.abc import Callable

import numpy as np

Damage = Callable[[np.random.Generator, bytes], bytes]
"""A kind of damage."""

_UNITS = ((b"mTorr", b"Torr"), (b"Pa", b"hPa"), ("°C".encode(), b"K"), (b"mW", b"W"),
          (b"mm", b"cm"), (b"%", b""), (b"kW", b"W"), (b"cm-1", b"nm"), (b"nm", b"um"))  # fmt: skip
_CELLS = (b"nan", b"inf", b"-inf", b"", b"OVLD", b"0", b"-1", b"1e308", b"1e-320", b"1e9", b"--",
          b"#DIV/0!", b"1,2,3", b"0x1F", b"1_000")  # fmt: skip


def damaged(content: bytes, rng: np.random.Generator) -> tuple[bytes, list[str]]:
    """Content with one to three damages.

    Parameters
    ----------
    content : bytes
    rng : numpy.random.Generator

    Returns
    -------
    content : bytes
    kinds : list of str
        Names of the damages.
    """
    kinds = []
    for _ in range(int(rng.integers(1, 4))):
        one = KINDS[int(rng.integers(len(KINDS)))]
        content = one(rng, content)
        kinds.append(one.__name__)
    return content, kinds


def _cut(rng: np.random.Generator, content: bytes, longest: int) -> tuple[int, int]:
    start = int(rng.integers(0, max(len(content), 1)))
    return start, min(start + int(rng.integers(1, longest)), len(content))


def dropped_bytes(rng: np.random.Generator, content: bytes) -> bytes:
    """A few bytes are missing."""
    start, end = _cut(rng, content, 12)
    return content[:start] + content[end:]


def changed_bytes(rng: np.random.Generator, content: bytes) -> bytes:
    """Some bytes are others."""
    out = bytearray(content)
    for _ in range(int(rng.integers(1, 5))):
        if out:
            out[int(rng.integers(len(out)))] = int(rng.integers(256))
    return bytes(out)


def changed_digits(rng: np.random.Generator, content: bytes) -> bytes:
    """Some digits are others."""
    out = bytearray(content)
    places = [place for place, one in enumerate(content) if 48 <= one < 58]
    for _ in range(int(rng.integers(1, 6)) if places else 0):
        out[places[int(rng.integers(len(places)))]] = int(rng.integers(48, 58))
    return bytes(out)


def lost_marks(rng: np.random.Generator, content: bytes) -> bytes:
    """A separator, decimal mark, sign or line end is missing, so that numbers join."""
    places = [place for place, one in enumerate(content) if one in b",;.\t -\n"]
    for place in sorted(rng.choice(places, min(len(places), 2), replace=False))[::-1]:
        content = content[:place] + content[place + 1 :]
    return content


def changed_marks(rng: np.random.Generator, content: bytes) -> bytes:
    """A separator, decimal mark or sign is another."""
    out = bytearray(content)
    places = [place for place, one in enumerate(content) if one in b",;.\t -"]
    for _ in range(int(rng.integers(1, 4)) if places else 0):
        out[places[int(rng.integers(len(places)))]] = b",;.\t -"[int(rng.integers(6))]
    return bytes(out)


def all_marks(rng: np.random.Generator, content: bytes) -> bytes:
    """All marks of one kind are another."""
    pairs = ((b".", b","), (b",", b"."), (b";", b","), (b",", b";"), (b"\n", b"\r"), (b"-", b""))
    return content.replace(*pairs[int(rng.integers(len(pairs)))])


def repeated_fragment(rng: np.random.Generator, content: bytes) -> bytes:
    """A piece stands twice."""
    start, end = _cut(rng, content, 300)
    return content[:end] + content[start:]


def swapped_lines(rng: np.random.Generator, content: bytes) -> bytes:
    """Two lines have changed places."""
    lines = content.split(b"\n")
    one, two = rng.integers(0, len(lines), 2)
    lines[one], lines[two] = lines[two], lines[one]
    return b"\n".join(lines)


def lines_dropped_or_doubled(rng: np.random.Generator, content: bytes) -> bytes:
    """Lines are missing or stand twice."""
    lines = content.split(b"\n")
    counts = rng.choice([0, 1, 1, 1, 1, 1, 1, 2], len(lines))
    return b"\n".join(line for line, count in zip(lines, counts, strict=True) for _ in range(count))


def swapped_columns(rng: np.random.Generator, content: bytes) -> bytes:
    """Columns have changed places, below or with the header."""
    lines = content.split(b"\n")
    mark = next((one for one in (b"\t", b";", b",") if any(one in line for line in lines)), b" ")
    first = int(rng.integers(0, 5))
    one, two = rng.integers(0, 4, 2)
    for number, line in enumerate(lines[first:], first):
        cells = line.split(mark)
        if max(one, two) < len(cells) and not line.startswith(b"#"):
            cells[one], cells[two] = cells[two], cells[one]
            lines[number] = mark.join(cells)
    return b"\n".join(lines)


def strange_cells(rng: np.random.Generator, content: bytes) -> bytes:
    """Cells are empty, not finite, not numbers, or far out."""
    lines = content.split(b"\n")
    mark = next((one for one in (b"\t", b";", b",") if any(one in line for line in lines)), b" ")
    for _ in range(int(rng.integers(1, 5))):
        number = int(rng.integers(len(lines)))
        cells = lines[number].split(mark)
        cells[int(rng.integers(len(cells)))] = _CELLS[int(rng.integers(len(_CELLS)))]
        lines[number] = mark.join(cells)
    return b"\n".join(lines)


def other_units(rng: np.random.Generator, content: bytes) -> bytes:
    """The header names another unit."""
    return content.replace(*_UNITS[int(rng.integers(len(_UNITS)))], 1)


def truncated(rng: np.random.Generator, content: bytes) -> bytes:
    """The end is missing."""
    return content[: int(rng.integers(0, len(content) + 1))]


def zeroed(rng: np.random.Generator, content: bytes) -> bytes:
    """A block is zero bytes."""
    start, end = _cut(rng, content, 600)
    return content[:start] + bytes(end - start) + content[end:]


def garbage(rng: np.random.Generator, content: bytes) -> bytes:
    """Random bytes stand somewhere."""
    start, end = _cut(rng, content, 100)
    return content[:start] + rng.bytes(int(rng.integers(1, 40))) + content[end:]


def other_encoding(rng: np.random.Generator, content: bytes) -> bytes:
    """The text is encoded otherwise."""
    text = content.decode("utf-8", "replace")
    return text.encode(("utf-16", "latin-1", "utf-8-sig", "cp037")[int(rng.integers(4))], "replace")


KINDS: tuple[Damage, ...] = (
    dropped_bytes, changed_bytes, changed_digits, lost_marks, lost_marks, changed_marks, all_marks,
    repeated_fragment, repeated_fragment, swapped_lines, lines_dropped_or_doubled, swapped_columns,
    strange_cells, other_units, truncated, zeroed, garbage, other_encoding,
)  # fmt: skip
"""Kinds of damage; those that were seen to give impossible numbers stand twice."""
