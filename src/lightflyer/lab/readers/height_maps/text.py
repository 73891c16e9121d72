"""Matrices of heights in text files, Gwyddion's text export among them."""

import re
from pathlib import Path

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.units import parse, scale_and_offset
from lightflyer.lab.readers.height_maps.channel import Channel
from lightflyer.lab.readers.number_matrix import read_number_matrix

_GWYDDION_LINE = re.compile(r"^#\s*(Channel|Width|Height|Value units)\s*:\s*(.+?)\s*$")


def read_matrix(
    path: Path, size: float | None, unit: str | None
) -> tuple[Channel, tuple[str, ...]]:
    """Read a matrix of heights; returns ``channel``, ``notes``."""
    matrix = read_number_matrix(path, "heights")
    stated = {
        match[1]: match[2]
        for line in matrix.above
        if (match := _GWYDDION_LINE.match(line)) is not None
    }
    unit = unit or stated.get("Value units")
    if unit is None:
        raise ConfigurationError(f'{path}: its heights have no unit; state it by --unit "nm"')
    try:
        scale = scale_and_offset(unit, "m")[0]
        width = parse(stated["Width"], "m").value if size is None and "Width" in stated else size
        length = parse(stated["Height"], "m").value if "Height" in stated else None
    except ConfigurationError as error:
        raise ConfigurationError(f"{path}: {error}") from None
    if width is None:
        raise ConfigurationError(f'{path}: has no width; state it by --size "10 um"')
    rows, columns = matrix.values.shape
    if length is None or size is not None:
        length = width * rows / columns
    return Channel(stated.get("Channel", ""), unit, (rows, columns), width, length,
                   lambda: matrix.values * scale), matrix.notes  # fmt: skip
