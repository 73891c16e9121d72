"""The paper's claims, and conditions under which it is recomputed.

``data/lu2023.toml`` holds what the paper states, and what a figure needs beside it, marked as
assumed. Whether the recomputed numbers agree follows from the paper's value, ours and the
tolerance there.
"""

import math
import tomllib
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from importlib import resources
from typing import Any

import numpy as np

from lightflyer.core import constants
from lightflyer.core.entry_point import entry_point
from lightflyer.design.setup import Setup
from lightflyer.design.tables import LEVITATION, group_of, tabulate
from lightflyer.environment.atmosphere.earth import Lu2023Atmosphere
from lightflyer.environment.chamber import Chamber
from lightflyer.environment.radiation import Radiation
from lightflyer.film.properties import FilmProperties
from lightflyer.flyer.disk import Disk
from lightflyer.force.base import AbstractForceModel
from lightflyer.force.kinetic.model import Kinetic
from lightflyer.force.lu2023 import PRINTED, REPORTED, Lu2023, Reading
from lightflyer.gas.air import LU2023_AIR
from lightflyer.numerics.batches import in_batches
from lightflyer.numerics.rootfind import SolverStatus
from lightflyer.statics.balance import require_converged

REPORTED_MEAN = Reading(
    heat_weight=REPORTED.heat_weight,
    continuum_faces=REPORTED.continuum_faces,
    force_weight=REPORTED.force_weight,
    creep_weight=1.0,
)
"""The reported reading with the mean temperature in Eq. (20), to which larger disks point."""

POINTS = 1024  # Number of points that the model is compiled for

_KILOGRAMS_PER_GRAM = 1e-3

DECIDING = "reported"  # Column that decides the verdict on a claim

_ROUNDING = 1e-9  # of floating-point numbers, not of the paper's


@cache
def facts() -> dict[str, Any]:
    """Contents of ``data/lu2023.toml``: what the paper states."""
    text = (resources.files("lightflyer") / "data" / "lu2023.toml").read_text(encoding="utf-8")
    return tomllib.loads(text)


def film(coating: str, areal_density_g_m2: float | None = None) -> FilmProperties:
    """Film of the paper's model with a coating, ``"ge"`` or ``"cnt"``."""
    stated = facts()["film"][coating]
    emittance = stated["emittance"]
    grams = stated["areal_density_g_m2"] if areal_density_g_m2 is None else areal_density_g_m2
    return FilmProperties(
        areal_density=grams * _KILOGRAMS_PER_GRAM,
        absorptance=stated["absorptance"],
        emittance_top=emittance,
        emittance_bottom=emittance,
        tac_top=stated["tac_top"],
        tac_bottom=stated["tac_bottom"],
    )


@dataclass(frozen=True)
class Column:
    """A column of the report: one way to compute the paper's numbers."""

    key: str
    title: str
    description: str
    reading: Reading | None  # Of the paper's model; None for kinetic theory in its place

    @property
    def model(self) -> AbstractForceModel:
        """The force model, the paper's with its coefficients."""
        if self.reading is None:
            return Kinetic()
        fitted = facts()["coefficients"]
        return Lu2023(fitted["c_fm"], fitted["c_cont"], self.reading)


COLUMNS = (
    Column("printed", "printed", "the equations as printed, misprints corrected", PRINTED),
    Column(
        "reported",
        "reported",
        "conventions that give the paper's bands of altitude, one choice of many that do: mean "
        "speed at the gas temperature in (4), (5) once for each face, the mean temperature in (19)",
        REPORTED,
    ),
    Column(
        "reported-mean",
        "reported, T̄ in (20)",
        "as reported, with the mean temperature for that of the disk in (20)",
        REPORTED_MEAN,
    ),
)
"""Columns of the report that are readings of the paper."""

KINETIC = Column(
    "kinetic", "kinetic theory", "the force from the kinetic equation, nothing fitted", None
)
"""What the package predicts by default, in the paper's surroundings; no reading of the paper."""

Table = dict[str, np.ndarray]  # Outputs of :mod:`lightflyer.design.outputs` by name, in SI units

_tabulate = entry_point(tabulate)


def behaviour(
    model: AbstractForceModel,
    properties: FilmProperties,
    *,
    diameter: Any,
    pressure: Any,
    gas_temperature: Any,
    irradiance: Any = constants.SOLAR_CONSTANT_LU2023,
    incidence: Any = 0.0,
    names: tuple[str, ...] = (),
) -> Table:
    """Outputs of a disk at many points, with the paper's gas, gravity and rounded constant.

    ``names``: of those that are asked for, by default all.
    """

    def batch(
        diameter: np.ndarray,
        pressure: np.ndarray,
        gas_temperature: np.ndarray,
        irradiance: np.ndarray,
        incidence: np.ndarray,
    ) -> Table:
        # a chamber with a gas temperature of its own at every point is the atmosphere too
        chamber = Chamber(
            temperature=gas_temperature,
            gas=LU2023_AIR,
            gravity=constants.GRAVITY_LU2023,
            radiation=Radiation(
                irradiance,
                zenith_angle=incidence,
                stefan_boltzmann=constants.STEFAN_BOLTZMANN_LU2023,
            ),
        )
        disk = Disk(film=properties, radius=0.5 * diameter)
        return _tabulate(Setup(disk, chamber, model), pressure, irradiance, names)

    given = (diameter, pressure, gas_temperature, irradiance, incidence)
    arrays = np.broadcast_arrays(*(np.asarray(value, float) for value in given))
    table = in_batches(batch, [array.ravel() for array in arrays], POINTS)
    for group in {"", LEVITATION} & {group_of(name) for name in names or table}:
        converged = table.pop(group + "converged") > 0.5
        status = np.where(
            converged, int(SolverStatus.CONVERGED), int(SolverStatus.TOLERANCE_MISSED)
        )
        require_converged("the paper's model", status, table.pop(group + "residual"))
    return {name: values.reshape(arrays[0].shape) for name, values in table.items()}


def atmosphere(altitude: Any) -> tuple[np.ndarray, np.ndarray]:
    """Pressure [Pa] and temperature [K] of the paper's atmosphere at altitudes [m]."""
    air = Lu2023Atmosphere()
    return np.asarray(air.pressure(altitude)), np.asarray(air.temperature(altitude))


def over_altitude(
    column: Column,
    altitude: Any,
    diameter: Any,
    irradiance: Any,
    incidence_deg: float = 0.0,
    names: tuple[str, ...] = (),
) -> Table:
    """Outputs of the germanium-coated disk in the paper's atmosphere; ``incidence_deg`` [deg]."""
    pressure, temperature = atmosphere(altitude)
    return behaviour(
        column.model,
        film("ge"),
        diameter=diameter,
        pressure=pressure,
        gas_temperature=temperature,
        irradiance=irradiance,
        incidence=math.radians(incidence_deg),
        names=names,
    )


def in_chamber(
    column: Column,
    properties: FilmProperties,
    pressure: Any,
    diameter: Any,
    irradiance: Any = constants.SOLAR_CONSTANT_LU2023,
) -> Table:
    """Outputs of a coated disk in the chamber, under the assumed conditions."""
    return behaviour(
        column.model,
        properties,
        diameter=diameter,
        pressure=pressure,
        gas_temperature=facts()["chamber"]["temperature_k"],
        irradiance=irradiance,
    )


class Verdict(StrEnum):
    """Result of comparing a claim with our numbers."""

    REPRODUCED = "reproduced"
    DIFFERS = "differs"
    NOT_RECOMPUTABLE = "reported but not recomputable"


@dataclass(frozen=True)
class Quantity:
    """One number of a claim."""

    key: str
    name: str
    unit: str
    lowest: float  # The paper's value, or the range it gives
    highest: float  # The paper's value, or the range it gives
    tolerance: float  # Largest difference of a reproduced value
    tolerance_note: str = ""  # Reason for a tolerance other than one unit of the last printed digit

    @property
    def paper(self) -> str:
        """The paper's value as text."""
        if self.lowest == self.highest:
            return f"{self.lowest:g}"
        return f"{self.lowest:g}–{self.highest:g}"

    def difference(self, ours: float) -> float:
        """Ours minus the paper's value; zero inside a range."""
        return min(ours - self.lowest, 0.0) + max(ours - self.highest, 0.0)

    def agrees(self, ours: float) -> bool:
        """Whether our value is within tolerance; NaN is not."""
        return abs(self.difference(ours)) <= self.tolerance + _ROUNDING * abs(self.highest)


@dataclass(frozen=True)
class Claim:
    """A claim of the paper."""

    number: int
    text: str
    quantities: tuple[Quantity, ...]
    place: str = ""  # Where the paper makes it
    # What a recomputation needs and the text does not give; empty if nothing is missing
    missing: str = ""
    note: str = ""  # Explanation of a difference, or where the numbers come from

    def verdict(self, values: dict[str, float]) -> Verdict:
        """Verdict on one column's numbers; ``values``: ours, by the quantities' keys."""
        if self.missing:
            return Verdict.NOT_RECOMPUTABLE
        agree = all(quantity.agrees(values[quantity.key]) for quantity in self.quantities)
        return Verdict.REPRODUCED if agree else Verdict.DIFFERS

    def reproducers(self, columns: dict[str, dict[str, float]]) -> list[str]:
        return [
            name for name, values in columns.items() if self.verdict(values) is Verdict.REPRODUCED
        ]

    def overall(self, columns: dict[str, dict[str, float]]) -> Verdict:
        """Verdict by the column that gives the paper's bands of altitude."""
        # One column decides about all claims, so that no reading is picked claim by claim.
        return self.verdict(columns[DECIDING])

    def reason(self, columns: dict[str, dict[str, float]]) -> str:
        """What is missing, or which numbers of which columns are off, and the note."""
        if self.missing:
            return f"missing: {self.missing}. {self.note}".rstrip(" ")
        titles = {column.key: column.title for column in COLUMNS}
        off = {
            titles.get(key, key): [q.name for q in self.quantities if not q.agrees(values[q.key])]
            for key, values in columns.items()
        }
        outside = "; ".join(f"{name} ({', '.join(names)})" for name, names in off.items() if names)
        return f"outside the tolerance: {outside}. {self.note}" if outside else self.note


def claims() -> list[Claim]:
    """The paper's claims, in order."""
    return [
        Claim(
            number=stated["number"],
            text=stated["text"],
            quantities=tuple(map(_quantity, stated.get("quantity", []))),
            place=stated["place"],
            missing=stated.get("missing", ""),
            note=stated.get("note", ""),
        )
        for stated in facts()["claim"]
    ]


def _quantity(stated: dict[str, Any]) -> Quantity:
    lowest, highest = stated.get("range") or (stated["value"], stated["value"])
    return Quantity(
        key=stated["key"],
        name=stated["name"],
        unit=stated["unit"],
        lowest=lowest,
        highest=highest,
        tolerance=stated["tolerance"],
        tolerance_note=stated.get("tolerance_note", ""),
    )
