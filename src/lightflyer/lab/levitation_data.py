"""Points at which samples lifted off, and their files."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from lightflyer.calibration.points import NUMBERS, SAMPLE_PROPERTIES
from lightflyer.foundation.errors import ConfigurationError
from lightflyer.foundation.layout import Column
from lightflyer.foundation.quantity import Quantity
from lightflyer.foundation.table import Table, read_table

COLUMNS = (
    Column("sample", aliases=("name",), text=True, blank=False),
    Column("launchpad", aliases=("pad",), text=True),
    Column("pressure", NUMBERS["pressure"], ("p", "chamber_pressure"), required=True),
    Column("irradiance", NUMBERS["irradiance"], ("i", "intensity"), required=True),
    Column("floor_gap", Quantity("m", 0.0), ("gap",)),
    *(Column(name, NUMBERS[name]) for name in SAMPLE_PROPERTIES),
)
"""Columns of a file of levitation points."""


@dataclass(frozen=True)
class LiftOffs:
    """Points at which one sample lifted off from one launchpad.

    Attributes
    ----------
    name : str
    pressure : array, shape (n,)
        [Pa].
    irradiance : array, shape (n,)
        [W/m²].
    place : str
        File and first line, for messages.
    floor_gap : float or None
        Distance between launchpad and floor [m].
    properties : dict of str to float
        Known properties of the sample in SI units, by names of
        :data:`lightflyer.calibration.points.SAMPLE_PROPERTIES`.
    """

    name: str
    pressure: np.ndarray
    irradiance: np.ndarray
    place: str = ""
    floor_gap: float | None = None
    properties: dict[str, float] = field(default_factory=dict)

    @property
    def in_ground_effect(self) -> bool:
        """Whether the gap to the floor is smaller than the disk's diameter."""
        gap, diameter = self.floor_gap, self.properties.get("diameter")
        return gap is not None and diameter is not None and gap < diameter


def read_lift_offs(path: str | Path, *, columns: str | None = None) -> tuple[list[LiftOffs], Table]:
    """Read levitation points.

    Parameters
    ----------
    path : str or path
        Table with ``pressure`` and ``irradiance``, units in the header; ``sample`` where there is
        more than one; optionally ``launchpad``, ``floor_gap`` and properties of the sample:
        :data:`lightflyer.calibration.points.SAMPLE_PROPERTIES`.
    columns : str, optional
        The columns in the order of the file, in place of a header; see
        :func:`~lightflyer.foundation.table.read_table`.

    Returns
    -------
    samples : list of LiftOffs
        One for every sample on every launchpad.
    table : Table
        Table that was read, with its rejected rows.

    Raises
    ------
    ConfigurationError
        One line that names file and line.
    """
    table = read_table(path, COLUMNS, layout=columns)
    samples = table.texts.get("sample", [Path(path).stem] * len(table))
    pads = table.texts.get("launchpad")
    names = (
        samples
        if pads is None
        else [f"{sample} on {pad}" for sample, pad in zip(samples, pads, strict=True)]
    )
    return [_sample(table, names, name) for name in dict.fromkeys(names)], table


def _sample(table: Table, names: Sequence[str], name: str) -> LiftOffs:
    rows = np.flatnonzero([one == name for one in names])
    lines = table.lines[rows]
    place = f"{table.source}:{lines[0]}"

    def only(column: str) -> float | None:
        if column not in table.numbers:
            return None
        values = np.unique(table.numbers[column][rows])
        if values.size > 1:
            raise ConfigurationError(f"{place}: {name} has more than one {column}")
        return float(values[0])

    return LiftOffs(
        name=name,
        pressure=table.numbers["pressure"][rows],
        irradiance=table.numbers["irradiance"][rows],
        place=place,
        floor_gap=only("floor_gap"),
        properties={
            column: value for column in SAMPLE_PROPERTIES if (value := only(column)) is not None
        },
    )
