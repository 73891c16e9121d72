"""A heated vane: the force that the kinetic equation predicts, and measured forces beside it."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np

from lightflyer.array.namespace import xp
from lightflyer.array.records import ShortRepr
from lightflyer.calibration.gauge import Gauge
from lightflyer.calibration.points import copies
from lightflyer.core.checks import require_positive, require_range
from lightflyer.core.constants import STANDARD_GRAVITY
from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import Fraction, Quantity
from lightflyer.core.units import Measured, parse
from lightflyer.core.validity import describe
from lightflyer.environment.base import EnvironmentState
from lightflyer.environment.radiation import Radiation
from lightflyer.files.result_text import Parts, table_of
from lightflyer.files.table import Table, read_table
from lightflyer.files.table_layout import Column
from lightflyer.film.properties import FilmProperties
from lightflyer.flyer.sandwich import Sandwich
from lightflyer.force.kinetic.model import Kinetic
from lightflyer.force.kinetic.walls import IN_WORDS
from lightflyer.gas.base import AbstractGas, knudsen_number
from lightflyer.gas.pure import ARGON
from lightflyer.lab.estimate import NORMAL_FACTOR, Estimate, central_interval
from lightflyer.lab.result import LabResult, Series, Shown, plain, variables

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ASSUMED_TAC, ROOM = Measured(0.9, 0.05), Measured(295.0)
SAMPLES = 1000  # of the uncertain numbers of a vane
BEYOND = 1.5  # factor by which a curve extends beyond the measured pressures

_UNITS = {"diameter": "m", "hot": "K", "cold": "K", "ambient": "K", "tac_hot": "", "tac_cold": ""}
_SEED = 1
_LEAST_TAC = 0.01
_APART = 10.0  # measured over predicted force that looks like a wrong unit
_STEP = 1e-3  # of a pressure, relative, for a slope
_SMALL = 1e-6  # [m]; gap of the sandwich that stands for a vane, whose faces are its outer ones

_PRESSURE = Column("pressure", Quantity("Pa", 0.0, open_below=True), ("p",), required=True)
_FORCE = Column(
    "force", Quantity("N", 0.0, open_below=True, likely=(1e-10, 1e-2),
                      known="vanes of centimetres feel micronewtons"), ("f",), required=True,
    suggested_unit="uN",
)  # fmt: skip
COLUMNS = (_PRESSURE, _FORCE, _PRESSURE.uncertainty(), _FORCE.uncertainty())
"""Columns of a file of forces towards the cold face, with standard uncertainties."""

# ambient, hot, cold, model, diameter, TACs of the cold and hot face, how walls share them
_NOMINAL = np.zeros((1, 8))
MICRONEWTON = 1e-6
ASSUMES = (
    "assumes a thin vane in open space: neither thickness nor walls of the chamber are part of an "
    "interval"
)
_HEADINGS = (
    "pressure\n[Pa]",
    "Kn",
    "measured\n[µN]",
    "predicted\n[µN]",
    "measured over\npredicted",
)

_DECADES = 2.5  # below the largest force that the axis shows, at most


@dataclass(frozen=True)
class Vane(ShortRepr):
    """A thin circular vane in open gas, its faces at two temperatures.

    Parameters
    ----------
    diameter : Measured, float or str
        [m], or with its unit and ±, such as ``"12.0 ± 0.1 cm"``; likewise the next.
    hot, cold : Measured, float or str
        Temperature of each face [K].
    gas : AbstractGas
        Monatomic or diatomic.
    ambient : Measured, float or str
        Temperature of the gas far away [K].
    tac_hot, tac_cold : Measured, float or str
        Accommodation coefficient of each face.
    alike : bool
        Whether one error concerns both coefficients, as of faces of one surface.
    wall : {"unknown", "maxwell", "accommodated"}
        How molecules leave the faces, as of :class:`~lightflyer.Kinetic`; unknown walls widen the
        band.

    Raises
    ------
    ConfigurationError
        If a text is no quantity of its kind.
    ParameterError
        If a number is impossible, or the gas is polyatomic.
    """

    diameter: Measured
    hot: Measured
    cold: Measured
    gas: AbstractGas = ARGON
    ambient: Measured = ROOM
    tac_hot: Measured = ASSUMED_TAC
    tac_cold: Measured = ASSUMED_TAC
    alike: bool = True
    wall: Literal["unknown", "maxwell", "accommodated"] = "unknown"

    def __post_init__(self) -> None:
        for name, unit in _UNITS.items():
            given = getattr(self, name)
            if not isinstance(given, Measured):
                given = parse(str(given), unit) if isinstance(given, str) else Measured(given)
                object.__setattr__(self, name, given)
        require_positive(diameter=self.diameter.value, cold=self.cold.value)
        if self.hot.value <= self.cold.value:
            raise ParameterError(
                f"the hot face has {self.hot.value:g} K, and the cold one {self.cold.value:g} K"
            )
        for name in ("tac_hot", "tac_cold"):
            shown = "tac" if self.alike else name
            require_range(shown, getattr(self, name).value, _LEAST_TAC, 1.0)
        Kinetic().model_of(self._body(_NOMINAL)).require_gas(self.gas)

    def knudsen(self, pressure: np.ndarray) -> np.ndarray:
        """Mean free path of the gas far away over the diameter [1], shape (n,)."""
        radius = 0.5 * self.diameter.value
        return np.asarray(knudsen_number(pressure, self.ambient.value, radius, self.gas))

    def force(self, pressure: np.ndarray) -> np.ndarray:
        """Force towards the cold face [N], shape (n,)."""
        return self._forces(pressure, _NOMINAL)[0]

    def forces(self, pressure: np.ndarray, samples: int = SAMPLES) -> np.ndarray:
        """The same with uncertain numbers drawn, shape (samples, n); draws are always the same."""
        draws = np.random.default_rng(_SEED).standard_normal((samples, len(_NOMINAL[0])))
        return self._forces(pressure, draws)

    def warnings(self, pressure: np.ndarray) -> tuple[str, ...]:
        """Where pressures are outside the model's range, one line each."""
        state = self._state(pressure, np.array([self.ambient.value]))
        ranges = Kinetic().ranges(self._body(_NOMINAL), state, self.hot.value)
        return describe(ranges, pressure)

    def _forces(self, pressure: np.ndarray, draws: np.ndarray) -> np.ndarray:
        ambient, hot, cold = (
            _drawn(number, draws[:, column])
            for column, number in enumerate((self.ambient, self.hot, self.cold))
        )
        excess = tuple(xp.asarray((face / ambient - 1.0)[:, None]) for face in (cold, hot))
        sharing = draws[:, 7, None] if self.wall == "unknown" else None
        model = Kinetic(force_error=draws[:, 3, None], wall=self.wall, sharing_error=sharing)
        found = model.force(self._body(draws), self._state(pressure, ambient), excess)
        return np.broadcast_to(np.asarray(found), (len(draws), len(pressure)))

    def _state(self, pressure: np.ndarray, ambient: np.ndarray) -> EnvironmentState:
        light = Radiation(0.0)
        return EnvironmentState(pressure, ambient[:, None], STANDARD_GRAVITY, self.gas, light)

    def _body(self, draws: np.ndarray) -> Sandwich:
        radius, cold, hot = (
            np.clip(_drawn(number, draws[:, column]), low, high)[:, None]
            for column, number, low, high in (
                (4, self.diameter, _SMALL, np.inf),
                (5, self.tac_cold, _LEAST_TAC, 1.0),
                (5 if self.alike else 6, self.tac_hot, _LEAST_TAC, 1.0),
            )
        )
        top, bottom = (FilmProperties(1.0, 0.5, 0.5, 0.5, tac, tac) for tac in (cold, hot))
        return Sandwich(top, bottom, 0.5 * radius, _SMALL, 0.0, _SMALL, 0.0, 1.0)


def _drawn(number: Measured, draws: np.ndarray) -> np.ndarray:
    return np.asarray(number.value + (number.uncertainty or 0.0) * draws)


@dataclass(frozen=True, repr=False)
class VaneForces(LabResult):
    """Forces on a vane beside those predicted."""

    vane: Vane
    #: shape (m,); of the predicted curve [Pa]
    pressure: Annotated[np.ndarray, Shown(key="curve.pressure_pa")]
    force: Annotated[np.ndarray, Shown(key="curve.force_n")]  #: shape (m,); [N]
    #: shape (2, m); ends of its 95 % interval [N]
    band: Annotated[np.ndarray, Shown(key="curve.force_n_interval_95")]
    points: Table | None  #: Measured points; None where there are none
    predicted: np.ndarray  #: shape (n,); at the points [N]
    ratio: Estimate | None  #: Measured over predicted force, mean over the points
    warnings: tuple[str, ...]

    _drawing = "force:plot_forces"

    @property
    def largest(self) -> tuple[float, float]:
        """Pressure [Pa] and size [N] of the largest force of the curve."""
        place = np.argmax(self.force)
        return float(self.pressure[place]), float(self.force[place])

    def parts(self) -> Parts:
        """Largest force, points beside the curve, and their ratio."""
        if self.points is not None:
            count = len(self.points.numbers["force"])
            yield f"measured over predicted, {count} points: {self.ratio} (95 %)"
        at, most = self.largest
        low, high = self.band[:, np.argmax(self.force)] / MICRONEWTON
        (knudsen,) = self.vane.knudsen(np.array([at]))
        yield (
            f"largest force predicted: {most / MICRONEWTON:.3g} µN ({low:.3g} to {high:.3g}) at "
            f"{at:.3g} Pa, Kn {knudsen:.2g}"
        )
        if self.points is not None:
            pressure, measured = (self.points.numbers[name] for name in ("pressure", "force"))
            rows = zip(
                pressure, self.vane.knudsen(pressure), measured / MICRONEWTON,
                self.predicted / MICRONEWTON, measured / self.predicted, strict=True,
            )  # fmt: skip
            yield table_of(_HEADINGS, ([f"{number:.3g}" for number in row] for row in rows))
        yield IN_WORDS[self.vane.wall]
        yield ASSUMES

    @property
    def variables(self) -> dict[str, Any]:
        """Curve and points as variables of a dataset, in SI units."""
        found = variables("place", [
            Series("pressure", self.pressure, "Pa", "gas pressure"),
            Series("force", self.force, "N", "force predicted"),
        ]) | variables(("end", "place"), [
            Series("force_interval", self.band, "N", "its 95 % interval")
        ])  # fmt: skip
        if self.points is not None:
            numbers = self.points.numbers
            found |= variables("point", [
                Series("measured_pressure", numbers["pressure"], "Pa", "gas pressure"),
                Series("measured_force", numbers["force"], "N", "force measured"),
                Series("predicted_force", self.predicted, "N", "force predicted"),
            ])  # fmt: skip
        return found

    def to_json(self) -> dict[str, Any]:
        """Curve, points and ratio as a JSON object, in SI units."""
        at, most = self.largest
        (knudsen,) = self.vane.knudsen(np.array([at]))
        found: dict[str, Any] = {
            "largest": {"pressure_pa": at, "force_n": most, "knudsen": float(knudsen)}
        }
        if self.points is not None:
            numbers = self.points.numbers
            found |= {
                "points": {"pressure_pa": numbers["pressure"], "measured_n": numbers["force"],
                           "predicted_n": self.predicted},
                "measured_over_predicted": self.ratio,
            }  # fmt: skip
        document: dict[str, Any] = plain(found)
        return document | self.summary()


@reads_units
def read_forces(path: str | Path, gauge: Gauge | None = None) -> Table:
    """Read forces over pressure; see :data:`COLUMNS`.

    Parameters
    ----------
    path : str or path
        Table with ``pressure`` and ``force``, units in the header.
    gauge : Gauge, optional
        What the gauge shows of a pressure; by default the pressure itself.

    Returns
    -------
    Table

    Raises
    ------
    ConfigurationError
        One line that names file and line.
    """
    table = read_table(path, COLUMNS)
    pressure, notes = (gauge or Gauge()).correct(table.numbers["pressure"])
    notes = [*table.notes, *notes, *copies(*table.numbers.values())]
    return replace(table, numbers={**table.numbers, "pressure": pressure}, notes=notes)


@reads_units
def compare_forces(
    vane: Vane,
    points: Table | str | Path | None = None,
    *,
    pressures: tuple[float, float] | None = None,
    pressure_accuracy: Fraction = 0.05,
    force_accuracy: Fraction = 0.05,
) -> VaneForces:
    """Predict the force on a vane over pressure, and lay measured forces over it.

    Parameters
    ----------
    vane : Vane
    points : Table or path, optional
        Columns of :data:`COLUMNS`, with units in the header of a file.
    pressures : (float, float), optional
        Ends of the curve [Pa]; by default a little beyond the points.
    pressure_accuracy, force_accuracy : float
        Relative standard uncertainty of gauge and balance, common to all points.

    Returns
    -------
    VaneForces

    Raises
    ------
    ConfigurationError
        If the file cannot be read; one line with file and line.
    ParameterError
        If there are neither points nor pressures.

    Notes
    -----
    The force is that of a sandwich without holes by :class:`~lightflyer.Kinetic`: a thin vane in
    open space. Samples vary diameter, temperatures, TACs, the model's own error and, at unknown
    walls, how normal motion, tangential motion and rotation share the TACs.
    """
    table = read_forces(points) if isinstance(points, str | Path) else points
    if pressures is None:
        if table is None:
            raise ParameterError("give points, or the pressures of a curve")
        here = table.numbers["pressure"]
        pressures = float(here.min()) / BEYOND, float(here.max()) * BEYOND
    grid = np.geomspace(*pressures, 200)
    predicted, ratio, said = np.zeros(0), None, [*vane.warnings(grid)]
    if table is not None:
        at, measured = table.numbers["pressure"], table.numbers["force"]
        predicted = vane.force(at)
        slope = np.log(vane.force(at * (1.0 + _STEP)) / predicted) / np.log1p(_STEP)
        up, right = (
            table.numbers.get(f"{name}_uncertainty", np.zeros(at.size)) / table.numbers[name]
            for name in ("force", "pressure")
        )
        spread = np.hypot(up, slope * right)
        weight = 1.0 / spread**2 if np.all(spread > 0.0) else np.ones(at.size)
        weight /= weight.sum()
        logs = np.log(measured / predicted)
        mean, kept = weight @ logs, weight @ weight
        scatter = weight @ (logs - mean) ** 2 * kept / (1.0 - kept) if at.size > 1 else 0.0
        # with all that points, instruments and vane allow
        noise = np.random.default_rng(_SEED + 1).standard_normal((3, SAMPLES))
        draws = mean - np.log(vane.forces(at) / predicted) @ weight
        draws += np.sqrt(max(scatter, weight**2 @ spread**2)) * noise[0]
        draws += force_accuracy * noise[1] - (weight @ slope) * pressure_accuracy * noise[2]
        ratio = Estimate.of_draws(float(np.exp(mean)), np.exp(draws))
        if "force_uncertainty" not in table.numbers:
            said.append("no ± of the forces is stated: their scatter stands for it")
        apart = float(np.median(measured / predicted))
        if not 1.0 / _APART < apart < _APART:
            said.append(
                f"the forces are {apart:.2g} times those predicted: check their unit, that of the "
                "pressures, and the vane"
            )
    return VaneForces(
        vane, grid, vane.force(grid), central_interval(vane.forces(grid), axis=0), table,
        predicted, ratio, tuple(said),
    )  # fmt: skip


def plot_forces(found: VaneForces, ax: "Axes") -> None:
    """Draw curve, band and points."""
    from lightflyer.files.drawing import BAND, label_axes, legend_below
    from lightflyer.files.palette import BLUE

    low, high = found.band / MICRONEWTON
    ax.fill_between(found.pressure, low, high, color=BLUE, alpha=0.2, lw=0, label=BAND)
    ax.plot(found.pressure, found.force / MICRONEWTON, color=BLUE, lw=1.5, label="predicted")
    shown = found.force
    if found.points is not None:
        numbers = found.points.numbers
        up, right = (
            NORMAL_FACTOR * numbers.get(f"{name}_uncertainty", np.zeros(found.predicted.size))
            for name in ("force", "pressure")
        )
        ax.errorbar(numbers["pressure"], numbers["force"] / MICRONEWTON, up / MICRONEWTON, right,
                    fmt="o", color="black", mfc="none", ms=5, lw=0.7, label="measured")  # fmt: skip
        shown = np.concatenate([shown, numbers["force"]])
    label_axes(ax, "pressure [Pa]", "force [µN]", log="xy")
    most = shown.max() / MICRONEWTON
    ax.set_ylim(max(0.5 * shown.min() / MICRONEWTON, most / 10**_DECADES), 2.0 * most)
    legend_below(ax)
