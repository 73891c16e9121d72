"""Least squares for a heater's conductance: laws of heat loss, model, first guess, minimisation."""

import abc
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from lightflyer.array.namespace import Numeric, xp
from lightflyer.core import constants
from lightflyer.core.entry_point import elementwise_entry_point
from lightflyer.core.errors import ConfigurationError, ConvergenceError, ParameterError
from lightflyer.force.kinetic.collisions import HeatedGas, with_collisions
from lightflyer.force.kinetic.disk import viscosity_exponent
from lightflyer.force.kinetic.ratios import kinetic_fit
from lightflyer.force.laws.faces import free_molecular_conductance
from lightflyer.force.lu2023 import READINGS, Reading, heat_conductances
from lightflyer.gas.base import AbstractGas, knudsen_number
from lightflyer.lab.tac.data import CommonErrors

KINETIC = "kinetic"  # Name of the reading by the kinetic equation

_STEP = 1e-3  # relative step of the pressure for a derivative
_DISK_CONDUCTION = 16.0 / np.pi  # 8 r κ per area of one face: of an isothermal disk, both faces
_LEAST_SHARE = 1e-3  # of the gas's resistance, that walls leave of it

PARAMETERS = ("tac", "area_ratio", "offset")  # Fitted parameters: α, δ and C

TAC_BOUNDS = (1e-6, 20.0)
"""Bounds of the fit; wider than possible, so that what is impossible shows."""

_STARTS = np.geomspace(0.02, 3.0, 60)  # coefficients tried for a first guess
_RANK_TOLERANCE = 1e-7  # of the scaled Jacobian's singular values
_GROUPS = 5_000  # of rows of neighbouring pressure that replace a very long run in its profile


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


@dataclass(frozen=True)
class HeaterProblem:
    """Conductances of a run, measured and modelled."""

    # The unknowns are the three of :data:`PARAMETERS` and, where ``errors`` has any, as many
    # errors that all rows have in common, each in standard errors about zero.

    source: str  # Name of the file, for messages
    # Measured power per nominal area and temperature difference [W/(m² K)], shape (m,)
    conductance: np.ndarray
    pressure: np.ndarray  # [Pa], shape (m,)
    limits: Limits  # Limits of the gas
    radiation: np.ndarray  # Radiation counted apart from the offset [W/(m² K)], shape (m,)
    weight: np.ndarray  # Factor of the residuals [m² K/W], shape (m,)
    errors: CommonErrors

    def with_common_errors(self, common: Sequence[float]) -> "HeaterProblem":
        """The problem of the three parameters alone, at given errors of all rows."""
        given = np.array(common, float)
        shift = float(given @ self.errors.log_pressure)
        rising = np.exp(shift) + float(given @ self.errors.zero) / self.pressure
        logarithms = self.limits.log_continuum.copy()
        logarithms[0] += self.limits.slope * shift + given @ self.errors.log_continuum
        amplitude = np.exp(given @ self.errors.log_conductance)
        limits = replace(
            self.limits,
            free_molecular=self.limits.free_molecular * rising,
            log_continuum=logarithms,
        )
        return replace(
            self, conductance=self.conductance / amplitude, limits=limits,
            weight=self.weight * amplitude, errors=CommonErrors.none(len(self.conductance)),
        )  # fmt: skip

    def without_common_errors(self) -> "HeaterProblem":
        return self.with_common_errors([0.0] * len(self.errors.names))

    def _gas(self, tac: float, common: np.ndarray) -> tuple[np.ndarray, ...]:
        """Both limits at a coefficient, derivative of the dense one, and the thin one's factor."""
        shift = float(common @ self.errors.log_pressure)
        factor = np.exp(shift)
        at_one = tac * self.limits.free_molecular
        thin = at_one * (factor + float(common @ self.errors.zero) / self.pressure)
        logarithm, per_tac = self.limits.log_continuum_at(tac)
        shifted = self.limits.slope * shift + common @ self.errors.log_continuum
        return thin, np.exp(logarithm + shifted), per_tac, at_one * factor

    def model(self, tac: float, area_ratio: float, offset: float, *common: float) -> np.ndarray:
        """Conductance per nominal area [W/(m² K)], shape (m,)."""
        given = np.array(common or np.zeros(len(self.errors.names)))
        thin, dense, *_ = self._gas(tac, given)
        amplitude = np.exp(given @ self.errors.log_conductance)
        gas = thin * dense / (thin + dense)
        return np.asarray(area_ratio * amplitude * (gas + self.radiation + offset))

    def residuals(self, *unknowns: float) -> np.ndarray:
        """Weighted residuals of the rows [1], shape (m,)."""
        return (self.model(*unknowns) - self.conductance) * self.weight

    def jacobian(self, tac: float, area_ratio: float, offset: float, *common: float) -> np.ndarray:
        """Derivatives of the residuals by the unknowns, shape (3 + k, m)."""
        given, errors = np.array(common), self.errors
        thin, dense, per_tac, scaled = self._gas(tac, given)
        amplitude = area_ratio * np.exp(given @ errors.log_conductance)
        share = dense / (thin + dense)  # of the resistance, that is of thin gas
        by_thin, by_log_dense = share**2, (1.0 - share) ** 2 * dense
        inside = thin * dense / (thin + dense) + self.radiation + offset
        by_tac = by_thin * thin / tac + by_log_dense * per_tac
        by_pressure = by_thin * scaled + by_log_dense * self.limits.slope
        by_zero = by_thin * tac * self.limits.free_molecular / self.pressure
        columns = [amplitude * by_tac, amplitude / area_ratio * inside, amplitude]
        for number in range(len(errors.names)):
            of_gas = (
                errors.log_pressure[number] * by_pressure
                + errors.zero[number] * by_zero
                + errors.log_continuum[number] * by_log_dense
            )
            columns.append(amplitude * (of_gas + errors.log_conductance[number] * inside))
        return np.stack(columns) * self.weight

    def group(self) -> "HeaterProblem":
        """Rows of neighbouring pressure averaged, each group weighted by its size."""
        # A profile of very many rows would take long. Within a group the model hardly changes, and
        # the scatter within it does not depend on the parameters.
        if len(self.conductance) <= 2 * _GROUPS:
            return self
        groups = np.array_split(np.argsort(self.pressure, kind="stable"), _GROUPS)
        sizes = np.array([len(rows) for rows in groups])
        first = np.concatenate([[0], np.cumsum(sizes)[:-1]])
        order = np.concatenate(groups)
        means = self._each(lambda one: np.add.reduceat(one[..., order], first, axis=-1) / sizes)
        return replace(means, weight=means.weight * np.sqrt(sizes))

    def rows(self, kept: np.ndarray) -> "HeaterProblem":
        """The same problem with some of its rows; ``kept`` is boolean, shape (m,)."""
        return self._each(lambda one: one[..., kept])

    def _each(self, change: Callable[[np.ndarray], np.ndarray]) -> "HeaterProblem":
        """The problem with changed arrays, of shape (m,) or (k, m)."""
        limits, errors = self.limits, self.errors
        return replace(
            self, conductance=change(self.conductance), pressure=change(self.pressure),
            radiation=change(self.radiation), weight=change(self.weight),
            limits=replace(
                limits, free_molecular=change(limits.free_molecular), slope=change(limits.slope),
                log_continuum=change(limits.log_continuum),
            ),
            errors=replace(
                errors, log_continuum=change(errors.log_continuum),
                log_conductance=change(errors.log_conductance),
            ),
        )  # fmt: skip


@dataclass(frozen=True)
class JointProblem:
    """Runs on one bench, each with parameters of its own, with the errors that all have in common.

    The unknowns are the parameters of each run in turn, and then the errors.
    """

    runs: tuple[HeaterProblem, ...]

    @property
    def source(self) -> str:
        """Names of the files, for messages."""
        return ", ".join(dict.fromkeys(run.source for run in self.runs))

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the parameters, those of several runs with the run's number."""
        if len(self.runs) == 1:
            return PARAMETERS
        return tuple(f"{name}_{run}" for run in range(len(self.runs)) for name in PARAMETERS)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the unknowns."""
        return (*self.parameters, *self.runs[0].errors.names)

    def _parts(self, unknowns: Sequence[float]) -> list[tuple[HeaterProblem, Sequence[float]]]:
        last, width = len(self.parameters), len(PARAMETERS)
        return [
            (run, [*unknowns[number * width : (number + 1) * width], *unknowns[last:]])
            for number, run in enumerate(self.runs)
        ]

    def residuals(self, *unknowns: float) -> np.ndarray:
        """Weighted residuals of all rows, and of the common errors once [1]."""
        rows = [run.residuals(*part) for run, part in self._parts(unknowns)]
        return np.concatenate([*rows, unknowns[len(self.parameters) :]])

    def jacobian(self, *unknowns: float) -> np.ndarray:
        """Derivatives of the residuals by the unknowns, shape (3 n + k, m + k)."""
        last, width = len(self.parameters), len(PARAMETERS)
        blocks = []
        for number, (run, part) in enumerate(self._parts(unknowns)):
            of_run = run.jacobian(*part)
            block = np.zeros((len(unknowns), of_run.shape[1]))
            block[number * width : (number + 1) * width] = of_run[:width]
            block[last:] = of_run[width:]
            blocks.append(block)
        return np.concatenate([*blocks, np.eye(len(unknowns))[:, last:]], axis=1)


def first_guess(problem: HeaterProblem) -> tuple[float, float, float]:
    """Best of many coefficients; area ratio and offset by linear least squares for each."""
    weight = problem.weight
    best, least = (1.0, 1.0, 0.0), np.inf
    for tac in _STARTS:
        gas = problem.limits.conductance(float(tac)) + problem.radiation
        design = np.stack([gas * weight, weight], axis=1)
        (ratio, product), *_ = np.linalg.lstsq(design, problem.conductance * weight)
        cost = float(np.sum((design @ (ratio, product) - problem.conductance * weight) ** 2))
        if cost < least and ratio > 0.0:
            best, least = (float(tac), float(ratio), float(product / ratio)), cost
    return best


def require_distinct(problem: HeaterProblem, values: Sequence[float]) -> None:
    """Raise unless the pressures determine all three parameters."""
    jacobian = problem.without_common_errors().jacobian(*values)
    scaled = jacobian / np.maximum(np.linalg.norm(jacobian, axis=1, keepdims=True), 1e-300)
    singular = np.sqrt(np.maximum(np.linalg.eigvalsh(scaled @ scaled.T), 0.0))
    if singular[0] < _RANK_TOLERANCE * singular[-1]:
        raise ConfigurationError(
            f"{problem.source}: its pressures do not determine accommodation coefficient, area "
            "ratio and offset separately; they must reach from free-molecular gas to the plateau"
        )


def minimise(
    problem: HeaterProblem | JointProblem, start: Sequence[float], *, scale: bool = True
) -> Any:
    """Minimise the sum of squares by lmfit; its result."""
    import lmfit  # takes a while

    joint = JointProblem((problem,)) if isinstance(problem, HeaterProblem) else problem
    parameters, last = lmfit.Parameters(), len(joint.parameters)
    bounds = (TAC_BOUNDS, (0.0, np.inf), (-np.inf, np.inf))
    for number, (name, value) in enumerate(zip(joint.names, start, strict=True)):
        low, high = bounds[number % len(PARAMETERS)] if number < last else bounds[-1]
        parameters.add(name, value=value, min=low, max=high)
    result = lmfit.minimize(
        lambda given: joint.residuals(*(float(given[name]) for name in joint.names)),
        parameters, scale_covar=scale, col_deriv=1, ftol=1e-14, xtol=1e-12, gtol=1e-14,
        Dfun=lambda given: joint.jacobian(*(float(given[name]) for name in joint.names)),
    )  # fmt: skip
    if result.covar is None or not np.all(np.isfinite(result.covar)):
        raise ConvergenceError(f"{joint.source}: the fit failed: {result.message}")
    return result
