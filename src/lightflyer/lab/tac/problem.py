"""Least squares for a heater's conductance: laws of heat loss, model, first guess, minimisation."""

import abc
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
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

KINETIC = "kinetic"  # Name of the reading by the kinetic equation

_STEP = 1e-3  # relative step of the pressure for a derivative
_DISK_CONDUCTION = 16.0 / np.pi  # 8 r κ per area of one face: of an isothermal disk, both faces
_LEAST_SHARE = 1e-3  # of the gas's resistance, that walls leave of it

PARAMETERS = ("tac", "area_ratio", "offset")  # Fitted parameters: α, δ and C

TAC_BOUNDS = (1e-6, 20.0)
"""Bounds of the fit; wider than possible, so that what is impossible shows."""

_STARTS = np.geomspace(0.02, 3.0, 60)  # coefficients tried for a first guess
_ALONG = 1e-30  # step along the imaginary axis, of a derivative
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

    def log_continuum_at(self, tac: Any) -> Any:
        """Logarithm of the continuum conductance at a coefficient, shape (m,)."""
        inside = np.clip(np.real(tac), *self.tac_range)
        held = np.where(inside == np.real(tac), tac, inside)
        constant, linear, square = self.log_continuum
        return constant + (linear + square * held) * held

    def continuum(self, tac: float) -> np.ndarray:
        """Continuum conductance at a coefficient [W/(m² K)], shape (m,)."""
        return np.asarray(np.exp(self.log_continuum_at(tac)))

    def conductance(self, tac: float) -> np.ndarray:
        """Conductance of the gas at a coefficient: both limits in series [W/(m² K)]."""
        thin, dense = tac * self.free_molecular, self.continuum(tac)
        return thin * dense / (thin + dense)


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
    """Conductances of a run, or of several on one bench, measured and modelled."""

    # The unknowns are the three of :data:`PARAMETERS` of each run in turn, and then the errors that
    # all rows have in common, each in standard errors about zero.

    source: str  # Names of the files, for messages
    # Measured power per nominal area and temperature difference [W/(m² K)], shape (m,)
    conductance: np.ndarray
    pressure: np.ndarray  # [Pa], shape (m,)
    limits: Limits  # Limits of the gas
    radiation: np.ndarray  # Radiation counted apart from the offset [W/(m² K)], shape (m,)
    weight: np.ndarray  # Factor of the residuals [m² K/W], shape (m,)
    # What one standard error of each that rows have in common changes, shape (4, m): logarithm of
    # the pressure, zero of the gauge over the pressure, logarithms of the continuum conductance and
    # of the measured one [1]
    errors: dict[str, np.ndarray]
    sizes: tuple[int, ...] = ()  # Rows of each of several runs

    @classmethod
    def joined(cls, problems: "Sequence[HeaterProblem]") -> "HeaterProblem":
        """Runs with the errors that they have in common."""
        names = dict.fromkeys(name for one in problems for name in one.errors)
        nothing = [np.zeros((4, one.conductance.size)) for one in problems]
        each = [
            replace(one, errors={name: one.errors.get(name, none) for name in names})
            for one, none in zip(problems, nothing, strict=True)
        ]
        return replace(
            each[0]._each(lambda *all_runs: np.concatenate(all_runs, axis=-1), *each[1:]),
            source=", ".join(dict.fromkeys(one.source for one in problems)),
            sizes=tuple(one.conductance.size for one in problems) if len(problems) > 1 else (),
        )  # fmt: skip

    @property
    def names(self) -> list[str]:
        """Names of the unknowns, of the parameters of several runs with the run's number."""
        numbered = [f"{name}_{run}" for run in range(len(self.sizes)) for name in PARAMETERS]
        return [*(numbered or PARAMETERS), *self.errors]

    @property
    def runs(self) -> int:
        """How many there are."""
        return len(self.sizes) or 1

    @cached_property
    def _effects(self) -> np.ndarray:
        """What one standard error of each changes, shape (k, 4, m)."""
        return np.reshape([*self.errors.values()], (len(self.errors), 4, self.conductance.size))

    @cached_property
    def _run(self) -> np.ndarray:
        """Number of each row's run, shape (m,)."""
        return np.repeat(np.arange(self.runs), self.sizes or self.conductance.size)

    def held(self, common: Mapping[str, float]) -> "HeaterProblem":
        """The problem of the parameters alone, at given errors of all rows, by default none."""
        given = np.array([common.get(name, 0.0) for name in self.errors])
        shift, zero, dense, amplitude = np.tensordot(given, self._effects, 1)
        logarithms = self.limits.log_continuum.copy()
        logarithms[0] += self.limits.slope * shift + dense
        thin = self.limits.free_molecular * (np.exp(shift) + zero)
        return replace(
            self, conductance=self.conductance / np.exp(amplitude),
            weight=self.weight * np.exp(amplitude), errors={},
            limits=replace(self.limits, free_molecular=thin, log_continuum=logarithms),
        )  # fmt: skip

    def _of_rows(self, unknowns: Sequence[float] | np.ndarray) -> np.ndarray:
        """Parameters of each row, and what the errors change of it, shape (7, m)."""
        last = len(PARAMETERS) * self.runs
        own = np.reshape(unknowns[:last], (self.runs, -1))[self._run].T
        return np.concatenate([own, np.tensordot(unknowns[last:], self._effects, 1)])

    def _conductance(self, of_rows: np.ndarray) -> np.ndarray:
        tac, area_ratio, offset, shift, zero, dense, amplitude = of_rows
        thin = tac * self.limits.free_molecular * (np.exp(shift) + zero)
        dense = np.exp(self.limits.log_continuum_at(tac) + self.limits.slope * shift + dense)
        gas = thin * dense / (thin + dense)
        return np.asarray(area_ratio * np.exp(amplitude) * (gas + self.radiation + offset))

    def model(self, unknowns: Sequence[float] | np.ndarray) -> np.ndarray:
        """Conductance per nominal area [W/(m² K)], shape (m,)."""
        return self._conductance(self._of_rows(unknowns))

    def residuals(self, unknowns: Sequence[float] | np.ndarray) -> np.ndarray:
        """Weighted residuals of the rows, and the common errors [1], shape (m + k,)."""
        rows = (self.model(unknowns) - self.conductance) * self.weight
        return np.concatenate([rows, unknowns[len(PARAMETERS) * self.runs :]])

    def jacobian(self, unknowns: Sequence[float] | np.ndarray) -> np.ndarray:
        """Derivatives of the residuals by the unknowns, shape (n, m + k)."""
        of_rows, width = self._of_rows(unknowns), len(PARAMETERS)
        moved = len(of_rows) if self.errors else width
        steps = of_rows[:, None] + 1j * _ALONG * np.eye(len(of_rows), moved)[:, :, None]
        slopes = self._conductance(steps).imag / _ALONG * self.weight
        found = [slopes[:width] * (self._run == run) for run in range(self.runs)]
        if self.errors:
            found.append(np.sum(self._effects * slopes[width:], axis=1))
        of_errors = np.eye(len(unknowns))[:, width * self.runs :]
        return np.hstack([np.concatenate(found), of_errors])

    def group(self) -> "HeaterProblem":
        """Rows of a run of neighbouring pressure averaged, each group weighted by its size."""
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
        """The same problem of a run with some of its rows; ``kept`` is boolean, shape (m,)."""
        return self._each(lambda one: one[..., kept])

    def _each(self, change: Callable[..., np.ndarray], *others: "HeaterProblem") -> "HeaterProblem":
        """The problem with changed arrays, of shape (m,) or (k, m); also from those of others."""
        every = (self, *others)
        own, of_gas = (
            {name: change(*(getattr(one, name) for one in group)) for name in names}
            for group, names in (
                (every, ("conductance", "pressure", "radiation", "weight")),
                ([one.limits for one in every], ("free_molecular", "slope", "log_continuum")),
            )
        )
        errors = {name: change(*(one.errors[name] for one in every)) for name in self.errors}
        return replace(self, **own, limits=replace(self.limits, **of_gas), errors=errors)  # type: ignore[arg-type]


def first_guess(problem: HeaterProblem) -> list[float]:
    """Best of many coefficients; area ratio and offset by linear least squares for each."""
    weight = problem.weight
    best, least = [1.0, 1.0, 0.0], np.inf
    for tac in _STARTS:
        gas = problem.limits.conductance(float(tac)) + problem.radiation
        design = np.stack([gas * weight, weight], axis=1)
        (ratio, product), *_ = np.linalg.lstsq(design, problem.conductance * weight)
        cost = float(np.sum((design @ (ratio, product) - problem.conductance * weight) ** 2))
        if cost < least and ratio > 0.0:
            best, least = [float(tac), float(ratio), float(product / ratio)], cost
    return best


def require_distinct(problem: HeaterProblem, values: Sequence[float]) -> None:
    """Raise unless the pressures determine all three parameters."""
    jacobian = problem.jacobian(values)
    scaled = jacobian / np.maximum(np.linalg.norm(jacobian, axis=1, keepdims=True), 1e-300)
    singular = np.sqrt(np.maximum(np.linalg.eigvalsh(scaled @ scaled.T), 0.0))
    if singular[0] < _RANK_TOLERANCE * singular[-1]:
        raise ConfigurationError(
            f"{problem.source}: its pressures do not determine accommodation coefficient, area "
            "ratio and offset separately; they must reach from free-molecular gas to the plateau"
        )


def minimise(
    problem: HeaterProblem, start: Sequence[float], *, scale: bool = True
) -> tuple[list[float], Any]:
    """Minimise the sum of squares by lmfit; the unknowns and its result."""
    import lmfit  # takes a while

    bounds = [TAC_BOUNDS, (0.0, np.inf), (-np.inf, np.inf)] * problem.runs
    bounds += [(-np.inf, np.inf)] * len(problem.errors)
    parameters = lmfit.Parameters()
    for name, value, (low, high) in zip(problem.names, start, bounds, strict=True):
        parameters.add(name, value=value, min=low, max=high)

    def values(given: Any) -> list[float]:
        return [float(one) for one in given.valuesdict().values()]

    result = lmfit.minimize(
        lambda given: problem.residuals(values(given)), parameters, scale_covar=scale, col_deriv=1,
        ftol=1e-14, xtol=1e-12, gtol=1e-14, Dfun=lambda given: problem.jacobian(values(given)),
    )  # fmt: skip
    if result.covar is None or not np.all(np.isfinite(result.covar)):
        raise ConvergenceError(
            f"{problem.source}: the fit finds no end: these rows are not those of a heater in a "
            "gas; check the units of pressure and power, gas, temperatures and diameter"
        )
    return values(result.params), result
