"""How a heated disk loses heat to the gas: the laws that a heater's power is reduced by."""

import abc
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from lightflyer.array.namespace import Numeric, xp
from lightflyer.core import constants
from lightflyer.core.entry_point import elementwise_entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.force.kinetic.collisions import HeatedGas, with_collisions
from lightflyer.force.kinetic.disk import viscosity_exponent
from lightflyer.force.kinetic.ratios import kinetic_fit
from lightflyer.force.laws.faces import free_molecular_conductance
from lightflyer.force.lu2023 import READINGS, Reading, heat_conductances
from lightflyer.gas.base import AbstractGas, knudsen_number

KINETIC = "kinetic"  # Name of the reading by the kinetic equation

_STEP = 1e-3  # relative step of the pressure for a derivative
_DISK_CONDUCTION = 16.0 / np.pi  # 8 r κ per area of one face: of an isothermal disk, both faces
_LEAST_SHARE = 1e-3  # of the gas's resistance, that walls leave of it


@dataclass(frozen=True)
class Limits:
    r"""Conductances of the gas in its two limits, a column per row of a run."""

    # shape (m,); free-molecular conductance at a coefficient of one [W/(m² K)]
    free_molecular: np.ndarray
    # shape (3, m); coefficients of the logarithm of the continuum conductance, in powers of
    # :math:`\alpha` within ``tac_range``
    log_continuum: np.ndarray
    slope: np.ndarray  # shape (m,); :math:`d\ln h_\mathrm{cont}/d\ln p` [1]
    # Coefficients for which the law knows the continuum conductance; beyond it is constant
    tac_range: tuple[float, float]

    def continuum(self, tac: float) -> np.ndarray:
        """Continuum conductance at a coefficient [W/(m² K)], shape (m,)."""
        return np.exp(self.log_continuum_at(tac)[0])

    def conductance(self, tac: float) -> np.ndarray:
        """Conductance of the gas at a coefficient: both limits in series [W/(m² K)]."""
        thin, dense = tac * self.free_molecular, self.continuum(tac)
        return thin * dense / (thin + dense)

    def log_continuum_at(self, tac: float) -> tuple[np.ndarray, np.ndarray]:
        """Its logarithm and the derivative of it by the coefficient, each of shape (m,)."""
        inside = min(max(tac, self.tac_range[0]), self.tac_range[1])
        constant, linear, square = self.log_continuum
        derivative = (linear + 2.0 * square * inside) * (inside == tac)
        return constant + (linear + square * inside) * inside, derivative


class AbstractHeatLaw(abc.ABC):
    """Heat loss of a disk to the gas, as free-molecular and continuum conductance in series."""

    name: str

    tac_range: ClassVar[tuple[float, float]] = (0.6, 1.0)
    """Coefficients between which the continuum conductance may vary with the coefficient; those
    of the kinetic table."""

    @abc.abstractmethod
    def at(self, tac: float, pressure: np.ndarray, *others: Any) -> Any:
        """Free-molecular conductance at a coefficient of one, and continuum conductance.

        Both of the area of one face, both faces counted [W/(m² K)], shape (m,); ``pressure`` [Pa];
        ``others``: as of :meth:`limits`.
        """

    def limits(self, pressure: np.ndarray, *others: Any) -> Limits:
        """Both limits for all coefficients.

        ``others``: temperatures of the gas and of the heater [K], diameter of the heater [m], gas.
        """
        low, high = self.tac_range
        nodes = np.array([low, 0.5 * (low + high), high])
        found = [self.at(float(node), pressure, *others) for node in nodes]
        logarithms = np.log([continuum for _, continuum in found])
        polynomial = np.linalg.solve(np.vander(nodes, increasing=True), logarithms)
        denser = np.log(self.at(float(nodes[1]), (1.0 + _STEP) * pressure, *others)[1])
        slope = (denser - logarithms[1]) / np.log1p(_STEP)
        return Limits(found[0][0], polynomial, slope, self.tac_range)


@dataclass(frozen=True)
class KineticLaw(AbstractHeatLaw):
    r"""Heat loss from the solved kinetic equation, as of :class:`lightflyer.Kinetic`."""

    # Right for a thin disk in gas at rest at any Knudsen number; natural convection is left out.
    # Below the table's smallest Knudsen number the conductance goes over into that of an isothermal
    # disk, :math:`8r\kappa`, with the gas's conductivity at the mean temperature.

    # Distance of the chamber's walls from the heater's centre [m]; open space if None
    wall_distance: float | None = None
    name: str = KINETIC

    def at(self, tac: float, pressure: np.ndarray, *others: Any) -> Any:
        *_, diameter, _ = others
        if self.wall_distance is not None and self.wall_distance <= 0.5 * diameter:
            raise ParameterError(
                f"a wall {self.wall_distance:g} m from the heater's centre is inside the heater, "
                f"whose radius is {0.5 * diameter:g} m"
            )
        near = 0.0 if self.wall_distance is None else 0.5 * diameter / self.wall_distance
        return _kinetic(tac, near, pressure, *others)


@elementwise_entry_point
def _kinetic(
    tac: Numeric, near: Numeric, pressure: Numeric, ambient: Numeric, heater: Numeric,
    diameter: Numeric, gas: AbstractGas,
) -> tuple[Any, Any]:  # fmt: skip
    fit = kinetic_fit(gas.molecules)
    knudsen = knudsen_number(pressure, ambient, 0.5 * diameter, gas)
    # of both faces, per area of one and per kelvin
    free_molecular = (
        free_molecular_conductance(
            2.0, 1.0, pressure, gas.mean_speed(ambient), gas.heat_capacity_ratio
        )
        / ambient
    )
    hotter = heater / ambient
    exponent = viscosity_exponent(gas, ambient, hotter)
    ratio = fit.heat_ratio(knudsen, hotter, tac, viscosity_exponent=exponent)
    heated = HeatedGas(gas, gas.molecules, ambient, hotter, exponent)
    _, of_heat = heated.factors(knudsen, tac)
    ratio = with_collisions(ratio, of_heat)
    resistance = 1.0 / ratio - 1.0
    _, by_walls = fit.wall_factors(knudsen, 1.0 / xp.maximum(near, 1e-9), tac)
    walls = xp.where(near > 0.0, by_walls, 1.0)
    between = xp.maximum(1.0 / (ratio * walls) - 1.0, _LEAST_SHARE * resistance)
    continuum = tac * free_molecular / between
    # below the table's end conduction by the gas's own conductivity is approached
    conducted = _DISK_CONDUCTION * gas.conductivity(0.5 * (heater + ambient)) / diameter
    share = xp.maximum(1.0 - knudsen / fit.knudsen_range[0], 0.0)
    open_space = tac * free_molecular / resistance
    return free_molecular, continuum * (conducted / open_space) ** share


@dataclass(frozen=True)
class Lu2023Law(AbstractHeatLaw):
    """Heat loss by the paper's interpolation, [Lu2023]_ Eqs. (3)-(10)."""

    reading: Reading  # Conventions of the heat loss
    name: str

    def at(self, tac: float, pressure: np.ndarray, *others: Any) -> Any:  # noqa: ARG002
        return _lu2023(self.reading, pressure, *others)


@elementwise_entry_point
def _lu2023(
    reading: Reading, pressure: Numeric, ambient: Numeric, heater: Numeric, diameter: Numeric,
    gas: AbstractGas,
) -> tuple[Any, Any]:  # fmt: skip
    free_molecular, continuum = heat_conductances(
        (heater - ambient) / ambient, radius=0.5 * diameter, tac_mean=1.0, pressure=pressure,
        temperature=ambient, gravity=constants.STANDARD_GRAVITY, gas=gas, reading=reading,
    )  # fmt: skip
    per_kelvin = nominal_area(diameter) * ambient
    return free_molecular / per_kelvin, continuum / per_kelvin


def nominal_area(diameter: Numeric) -> Numeric:
    """Area of one face of a heater [m²]."""
    return 0.25 * np.pi * diameter**2


KINETIC_LAW = KineticLaw()  # The kinetic equation in open space

HEAT_LAWS: dict[str, AbstractHeatLaw] = {
    KINETIC: KINETIC_LAW,
    **{name: Lu2023Law(reading, name) for name, reading in READINGS.items()},
}
"""Laws of heat loss by the names of their readings."""
