"""Measured levitation points, read from a table with units in its header.

Such a file looks like this; further columns are optional::

    sample, pressure [mTorr], irradiance [W/m^2], irradiance_uncertainty [W/m^2]
    Ge 2 cm, 30, 1510, 40

"""

import difflib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.calibration.gauge import CENTRE, UNIFORM_SPREAD, Gauge, require_step
from lightflyer.core.checks import require_positive
from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import ConfigurationError, Doubt, ParameterError
from lightflyer.core.quantity import (
    AccommodationCoefficient,
    ArealDensity,
    Emittance,
    Fraction,
    Irradiance,
    Length,
    Pressure,
    Quantity,
    quantity_of,
)
from lightflyer.files.table import Table, read_table
from lightflyer.files.table_layout import Column
from lightflyer.files.table_rows import Rejected

_COPIES = 0.25  # share of equal points, beyond what coarse readings repeat
_SCALED = Quantity("Pa*m", likely=(0.01, 0.5), known="the paper's disks in air have 0.09")
_OPTIMUM = Quantity(
    "Pa", likely=(0.9, 18.0), known="disks of 10 cm to 5 mm in air; the diameter would tell"
)

LEAST_PROBABILITY = 0.01
"""Probability of chi-squared below which, or above one minus which, a warning says so."""


def _positive(kind: object) -> Quantity:
    return replace(quantity_of(kind) or Quantity(), open_below=True)


_PRESSURE = Column("pressure", Pressure, ("p", "chamber_pressure"), required=True)
_LIGHT = replace(
    _positive(Irradiance), likely=(20.0, 2e5), known="less lifts no film, more burns it"
)
_IRRADIANCE = Column("irradiance", _LIGHT, ("i", "intensity"), required=True)
_SAMPLE_COLUMNS = (
    Column("diameter", Length),
    Column("areal_density", ArealDensity),
    Column("emittance", Emittance),
    Column("absorptance", _positive(Fraction)),
    Column("tac_top", AccommodationCoefficient),
    Column("tac_bottom", AccommodationCoefficient),
)
_UNCERTAINTIES = (_PRESSURE.uncertainty(), _IRRADIANCE.uncertainty())
LEVITATION_COLUMNS = (
    Column("sample", aliases=("name",), text=True, blank=False),
    Column("launchpad", aliases=("pad",), text=True),
    _PRESSURE,
    _IRRADIANCE,
    *_UNCERTAINTIES,
    Column("floor_gap", Quantity("m", 0.0), ("gap",)),
    *_SAMPLE_COLUMNS,
    *(column.uncertainty() for column in _SAMPLE_COLUMNS),
    Column("figure", text=True),
)
"""Columns of a file of levitation points."""

NUMBERS: dict[str, Quantity] = {
    one.name: one.quantity for one in LEVITATION_COLUMNS if not one.text
}
"""Columns of numbers: unit and possible range by name."""

SAMPLE_PROPERTIES = tuple(column.name for column in _SAMPLE_COLUMNS)
"""Columns that describe a sample."""

COLUMNS = (*NUMBERS, *(column.name for column in LEVITATION_COLUMNS if column.text))
"""All columns that a file may have."""

FIGURES = ("2", "5", "S2", "S3")  # Figures of the paper in which points can be drawn


_LEAST_ALIKE = 0.8  # of a column's name and a known one, for a hint at a misspelling


@dataclass(frozen=True)
class Points(ShortRepr):
    """Points of pressure and irradiance at which samples lifted off."""

    source: str  #: Name of the file
    samples: list[str]  #: Sample of each point, with its launchpad where the file names one
    numbers: dict[str, np.ndarray]  #: shape (n,); columns with numbers, in SI units, by name
    texts: dict[str, list[str]] = field(default_factory=dict)  #: Further columns, by name
    lines: tuple[int, ...] = ()  #: Line of each point in the file; empty where there is no file
    rejected: tuple[Rejected, ...] = ()  #: Rows of the file that could not be read
    unused: tuple[str, ...] = ()  #: Columns of the file that are not known
    reading: tuple[str, ...] = ()  #: What must be known of how the file was read, one line each
    #: Step in which the light was raised [W/m²], whose middle the irradiances are; 0 where it was
    #: raised steadily
    step: float = 0.0
    notes: tuple[str, ...] = ()  #: What was done to the points, one line each

    def __post_init__(self) -> None:
        numbers = {name: np.asarray(column, float) for name, column in self.numbers.items()}
        object.__setattr__(self, "numbers", numbers)
        for name in (_PRESSURE.name, _IRRADIANCE.name):
            if name not in numbers:
                raise ParameterError(
                    f"points need the column {name}; they have {', '.join(numbers)}"
                )
        for name, column in numbers.items():
            if column.shape != (len(self.samples),):
                raise ParameterError(
                    f"{name} of shape {column.shape} does not fit {len(self.samples)} samples"
                )

    def __len__(self) -> int:
        """Number of points."""
        return len(self.samples)

    @property
    def pressure(self) -> np.ndarray:
        """Gas pressure [Pa], shape (n,)."""
        return self.numbers["pressure"]

    @property
    def irradiance(self) -> np.ndarray:
        """Irradiance at lift-off [W/m²], shape (n,)."""
        return self.numbers["irradiance"]

    @property
    def has_uncertainty(self) -> bool:
        """Whether uncertainties are stated."""
        return any(column.name in self.numbers for column in _UNCERTAINTIES)

    @property
    def properties(self) -> dict[str, np.ndarray]:
        """Columns that describe the samples, by name: arrays of shape (n,)."""
        measured = {column.name for column in (_PRESSURE, _IRRADIANCE)}
        return {
            name: column
            for name, column in self.numbers.items()
            if name not in measured and name != "floor_gap" and not name.endswith("_uncertainty")
        }

    @property
    def near_floor(self) -> np.ndarray:
        """Whether the floor is closer than the sample's diameter: bool array, shape (n,)."""
        gap, diameter = (self.numbers.get(name) for name in ("floor_gap", "diameter"))
        if gap is None or diameter is None:
            return np.zeros(len(self), bool)
        return np.asarray(gap < diameter)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a reader of results must know of the file, one line each."""
        rows = [f"rejected {row}" for row in self.rejected]
        read = {*self.numbers, *self.texts}
        known = [column.name for column in LEVITATION_COLUMNS if column.name not in read]
        for name in self.unused:
            plain = name.partition("[")[0].strip().casefold()
            near = difflib.get_close_matches(plain, known, n=1, cutoff=_LEAST_ALIKE)
            hint = f'; did you mean "{near[0]}"?' if near else ""
            rows.append(f"{self.source}: the column {name} is not used{hint}")
        rows += (*self.reading, *self.notes)
        for name in dict.fromkeys(self.samples):
            one = self.where(self.of(name))
            sizes = one.numbers.get("diameter", [None])
            found = doubts(one.pressure, one.irradiance, sizes[0])
            rows += (Doubt(f"{name}: {text}") for text in found)
        return tuple(rows)

    @property
    def table(self) -> Table:
        """The points as the table that they were read from."""
        return Table(
            source=self.source,
            lines=np.array(self.lines, int),
            numbers=self.numbers,
            texts=self.texts,
            rejected=list(self.rejected),
            unused=list(self.unused),
            notes=list(self.reading),
        )

    def of(self, sample: str) -> np.ndarray:
        """Which points belong to a sample: bool array, shape (n,)."""
        return np.array([name == sample for name in self.samples], bool)

    def where(self, chosen: np.ndarray) -> "Points":
        """Some of the points; ``chosen`` (n,)."""

        def some(values: list[str]) -> list[str]:
            return [value for value, kept in zip(values, chosen, strict=True) if kept]

        return replace(
            self,
            samples=some(self.samples),
            numbers={name: column[chosen] for name, column in self.numbers.items()},
            texts={name: some(column) for name, column in self.texts.items()},
            lines=tuple(np.array(self.lines, int)[chosen].tolist()) if self.lines else (),
        )

    def without_ground_effect(self) -> "Points":
        """The points whose sample is farther from the floor than its diameter."""
        near = self.near_floor
        if not near.any():
            return self
        left_out = {
            name: int(np.sum(near & self.of(name)))
            for name in dict.fromkeys(self.samples)
            if np.any(near & self.of(name))
        }
        said = tuple(
            f"{name}: {count} points in ground effect are left out of the fit, since the floor is "
            "nearer than the sample's diameter"
            for name, count in left_out.items()
        )
        if near.all():
            raise ParameterError(
                f"{self.source}: all points are in ground effect, nearer to the floor than the "
                "sample's diameter; keep them, or measure farther away"
            )
        return replace(self.where(~near), notes=(*self.notes, *said))

    def with_step(self, step: float) -> "Points":
        """Points whose light was raised in steps until the sample lifted off."""
        # The light that suffices lies between the last one without levitation and the first one
        # with it. The points returned have the middle of the two and, where uncertainties are
        # stated, also that of the step.
        require_step(step, self.irradiance, self.source)
        if step == 0.0:
            return self
        numbers = self.numbers | {"irradiance": self.irradiance - CENTRE * step}
        if self.has_uncertainty:
            stated = self.numbers.get("irradiance_uncertainty", np.zeros(len(self)))
            numbers["irradiance_uncertainty"] = np.hypot(stated, UNIFORM_SPREAD * step)
        return replace(self, numbers=numbers, step=step)


def doubts(pressure: np.ndarray, irradiance: np.ndarray, diameter: float | None) -> list[str]:
    """What in points of one sample is in doubt: copies, units; pressure and light (n,)."""
    least = int(np.argmin(irradiance))
    optimum = float(pressure[least])
    found = [("irradiance", _LIGHT.unlikely(irradiance))]
    name, usual, value = "pressure of least irradiance", _OPTIMUM, optimum
    if diameter is not None:
        name, usual, value = f"{name} times diameter", _SCALED, optimum * diameter
    # at an end of the pressures, light may be less beyond it
    may_be_lower, may_be_higher = optimum == pressure.min(), optimum == pressure.max()
    low, high = usual.likely
    if not (may_be_lower and value > high) and not (may_be_higher and value < low):
        found.append((name, usual.unlikely(value)))
    told = [Doubt(f"{name} = {why}") for name, why in found if why]
    return [*copies(pressure, irradiance), *told]


def copies(*columns: np.ndarray) -> list[Doubt]:
    """A line where many rows are pasted again; ``columns``: of all that is measured, (n,)."""
    count = len(columns[0])
    found = count - len(set(zip(*(one.tolist() for one in columns), strict=True)))
    text = (
        f"{found} of {count} rows are copies of others, to all digits: the intervals count them as "
        "measured again"
    )
    return [Doubt(text)] * (found >= _COPIES * count)


def log_uncertainty(
    numbers: Mapping[str, np.ndarray], slope: np.ndarray, source: str
) -> np.ndarray:
    """Uncertainty of log-irradiance, that of pressure included by the curve's slope; shape (n,)."""
    exact = np.zeros(slope.size)
    light = numbers.get("irradiance_uncertainty", exact) / numbers["irradiance"]
    pressure = numbers.get("pressure_uncertainty", exact) / numbers["pressure"]
    spread = np.hypot(light, slope * pressure)
    if np.any(spread == 0.0):
        point = int(np.argmin(spread)) + 1
        raise ParameterError(
            f"{source}: point {point} has no uncertainty, but others have; give one for each"
        )
    require_positive(uncertainty=spread)
    return spread


@reads_units
def read_points(
    path: str | Path,
    *,
    columns: str | None = None,
    strict: bool = False,
    gauge: Gauge | None = None,
) -> Points:
    """Read measured points, as every command does that takes them.

    Parameters
    ----------
    path : str or path
        Table with a header such as ``sample, pressure [Torr], irradiance [W/m^2]``. Without
        ``sample`` all points belong to one, which has the file's name.
    columns : str, optional
        The columns in the order of the file, in place of a header; see
        :func:`~lightflyer.files.table.read_table`.
    strict : bool
        Refuse rows that cannot be read and unknown columns. Otherwise
        :attr:`Points.warnings` names them.
    gauge : Gauge, optional
        What the gauge shows of a pressure; by default the pressure itself.

    Returns
    -------
    Points

    Raises
    ------
    ConfigurationError
        One line that names file, line and column.
    """
    table = read_table(path, LEVITATION_COLUMNS, layout=columns, strict=strict, closed=strict)
    for line, figure in zip(table.lines, table.texts.get("figure", ()), strict=False):
        if figure.upper() not in FIGURES:
            raise ConfigurationError(
                f'{table.source}:{line}: figure = "{figure}" is not one of {", ".join(FIGURES)}'
            )
    shown = table.numbers["pressure"]
    pressure, said = (gauge or Gauge()).correct(shown)
    numbers = table.numbers | {"pressure": pressure}
    if "pressure_uncertainty" in numbers:
        numbers["pressure_uncertainty"] = numbers["pressure_uncertainty"] * pressure / shown
    samples = table.texts.get("sample", [Path(path).stem] * len(table))
    pads = table.texts.get("launchpad", [""] * len(table))
    return Points(
        source=table.source,
        samples=[
            f"{sample} on {pad}" if pad else sample
            for sample, pad in zip(samples, pads, strict=True)
        ],
        numbers=numbers,
        texts=table.texts,
        lines=tuple(table.lines.tolist()),
        rejected=tuple(table.rejected),
        unused=tuple(table.unused),
        reading=tuple(table.notes),
        notes=tuple(said),
    )
