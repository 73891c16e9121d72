"""Points at which samples lifted off, and their files."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.calibration.gauge import Gauge, end_text, rows_at_the_end
from lightflyer.calibration.points import LEVITATION_COLUMNS, SAMPLE_PROPERTIES, read_points
from lightflyer.core.arguments import reads_units
from lightflyer.core.errors import ConfigurationError
from lightflyer.files.table import Table

COLUMNS = LEVITATION_COLUMNS
"""Columns of a file of levitation points, the same as for a calibration."""


@dataclass(frozen=True)
class LiftOffs(ShortRepr):
    """Points at which one sample lifted off from one launchpad."""

    name: str
    pressure: np.ndarray  #: shape (n,); [Pa]
    irradiance: np.ndarray  #: shape (n,); [W/m²]
    place: str = ""  #: File and first line, for messages
    floor_gap: float | None = None  #: Distance between launchpad and floor [m]
    #: Known properties of the sample in SI units, by names of
    #: :data:`lightflyer.calibration.points.SAMPLE_PROPERTIES`
    properties: dict[str, float] = field(default_factory=dict)
    #: shape (n,); stated standard uncertainties, by the names of their columns
    uncertainties: dict[str, np.ndarray] = field(default_factory=dict)
    notes: tuple[str, ...] = ()  #: What was done to the points, one line each

    @property
    def in_ground_effect(self) -> bool:
        """Whether the gap to the floor is smaller than the disk's diameter."""
        gap, diameter = self.floor_gap, self.properties.get("diameter")
        return gap is not None and diameter is not None and gap < diameter


@reads_units
def read_lift_offs(
    path: str | Path, *, columns: str | None = None, gauge: Gauge | None = None
) -> tuple[list[LiftOffs], Table]:
    """Read levitation points, by :func:`~lightflyer.calibration.points.read_points`.

    Parameters
    ----------
    path : str or path
        Table with ``pressure`` and ``irradiance``, units in the header; ``sample`` where there is
        more than one; optionally ``launchpad``, ``floor_gap`` and properties of the sample:
        :data:`lightflyer.calibration.points.SAMPLE_PROPERTIES`.
    columns : str, optional
        The columns in the order of the file, in place of a header; see
        :func:`~lightflyer.files.table.read_table`.
    gauge : Gauge, optional
        What the gauge shows of a pressure; by default the pressure itself.

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
    points = read_points(path, columns=columns, gauge=gauge)
    lots = []
    for name in dict.fromkeys(points.samples):
        here = points.where(points.of(name))
        ends = rows_at_the_end(here.pressure, here.irradiance)
        said = [
            f"{np.sum(here.pressure[ends] == one)} points of {name} are left out: {end_text(one)}"
            for one in np.unique(here.pressure[ends])
        ]
        here = here.where(~ends)
        place = f"{here.source}:{here.lines[0]}"
        properties = {}
        for column in ("floor_gap", *SAMPLE_PROPERTIES):
            if column not in here.numbers:
                continue
            values = np.unique(here.numbers[column])
            if values.size > 1:
                raise ConfigurationError(f"{place}: {name} has more than one {column}")
            properties[column] = float(values[0])
        floor_gap = properties.pop("floor_gap", None)
        numbers = here.numbers.items()
        uncertainties = {name: one for name, one in numbers if name.endswith("_uncertainty")}
        lots.append(LiftOffs(
            name, here.pressure, here.irradiance, place, floor_gap, properties, uncertainties,
            (*here.notes, *said),
        ))  # fmt: skip
    return lots, points.table
