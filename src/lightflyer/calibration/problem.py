"""Setting up a calibration: which numbers of a design are fitted to which points.

In the compiled function the design is a constant and the numbers are arguments, so all fits of one
design share it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, xp
from lightflyer.array.records import Module, field
from lightflyer.calibration.inputs import Fields, FitInputs, Target, fit_inputs, target_of
from lightflyer.calibration.points import Points
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import impossible_as_nan
from lightflyer.design.design import AbstractDesign
from lightflyer.statics.levitation import levitate
from lightflyer.uncertainty.inputs import Change

DEFAULT_FREE = ("c_fm", "c_cont")  # Parameters that are fitted by default

SMALLEST, LARGEST = 1e-6, 1e6
"""Range of a parameter without an end of its own; times its start if it has a unit."""

UNREACHABLE = 50.0  # Log-irradiance where no irradiance levitates the flyer

_INSIDE = 1e-6  # distance of the start from the upper bound, of the log-parameter


class LevitationModel(Module):
    """Irradiance to levitate of a design at points, as a function of the fitted parameters."""

    design: AbstractDesign = field(static=True)
    prepared: Any  # From :meth:`~lightflyer.design.design.AbstractDesign.precompute`
    # For each row of ``stated``, the numbers of the design that have its values, and the factor
    # from the values to the numbers
    targets: tuple[tuple[Fields, float], ...] = field(static=True)
    stated: np.ndarray  # shape (rows, n); values at each point before the fit
    # shape (rows, n); number of the parameter that replaces the value at each point, -1 for none
    index: np.ndarray
    # shape (k, rows, n); change of the values by one standard uncertainty of each input
    moves: np.ndarray
    # shape (k, 2); change of the log-pressure and of the log-irradiance read by one standard
    # uncertainty of each input
    gains: np.ndarray
    movers: tuple[int, ...] = field(static=True)  # Inputs that move ``prepared``
    # For each of them, the change of ``prepared``, in its standard uncertainty
    changes: tuple[Change, ...]

    def log_irradiance(self, log_parameters: Any, log_pressure: Any, shifts: Any = None) -> Array:
        """Log-irradiance to levitate as a light meter reads it; within a public function.

        ``log_parameters`` (..., p), ``log_pressure`` (..., n), ``shifts`` (..., k).
        """
        if shifts is None:
            shifts = xp.zeros(len(self.gains))
        index = xp.asarray(self.index).astype(int)
        fitted = xp.exp(log_parameters)[..., xp.maximum(index, 0)]  # (..., rows, n)
        stated = self.stated + xp.tensordot(shifts, xp.asarray(self.moves), 1)
        rows = xp.moveaxis(xp.where(index >= 0, fitted, stated), -2, 0)
        errors = shifts @ xp.asarray(self.gains)
        pressure_error, light_error = errors[..., :1], errors[..., 1:]
        numbers = {
            field: factor * row
            for (fields, factor), row in zip(self.targets, rows, strict=True)
            for field in fields
        }
        prepared = self.prepared
        for number, change in zip(self.movers, self.changes, strict=True):
            shift = shifts[..., number] if shifts.ndim == 1 else shifts[..., number, None]
            prepared = change.apply(prepared, shift)
        setup = self.design.build(numbers, prepared)
        state = setup.environment.state(xp.exp(log_pressure - pressure_error))
        found = levitate(setup.flyer, state, setup.model, throw=False)
        irradiance = xp.where(found.levitates, found.irradiance, 1.0)
        return xp.where(found.levitates, xp.log(irradiance) + light_error, UNREACHABLE)


_STEP = 1e-5  # of a logarithm, and of a standard uncertainty, over which slopes are taken


class Parameter(NamedTuple):
    """A number that is fitted, at all points or at those of one sample."""

    name: str  # Such as ``"c_fm"`` or ``"emittance[Ge 2 cm]"``
    target: Target  # Numbers of the design that it stands for
    chosen: np.ndarray  # shape (n,); points at which it applies
    start: float  # Value at which the fit starts

    @property
    def log_bounds(self) -> tuple[float, float]:
        """Range of the logarithm that is searched, also that of its prior."""
        quantity = self.target.quantity
        scale = self.start if quantity.unit else 1.0
        lower, upper = (
            max(quantity.lowest, SMALLEST * scale),
            min(quantity.highest, LARGEST * scale),
        )
        return float(np.log(lower)), float(np.log(upper))

    @property
    def ends(self) -> tuple[float, float]:
        """Smallest and largest possible value; infinite where there is no largest one."""
        return max(self.target.quantity.lowest, 0.0), self.target.quantity.highest


class Linearised(NamedTuple):
    """Log-irradiance of a model at points, and its derivatives."""

    value: np.ndarray  # shape (n,); log-irradiance to levitate
    jacobian: np.ndarray  # shape (n, p); its derivatives with respect to the log-parameters
    slope: np.ndarray  # shape (n,); its derivative with respect to log-pressure
    # shape (n, k); its derivatives with respect to the inputs, each per standard uncertainty
    by_inputs: np.ndarray


@dataclass(frozen=True, eq=False)
class Problem:
    """Points, model and parameters of a calibration."""

    points: Points
    model: LevitationModel
    parameters: tuple[Parameter, ...]
    inputs: FitInputs  # Uncertain numbers that are not fitted

    @property
    def names(self) -> list[str]:
        """Names of the parameters."""
        return [parameter.name for parameter in self.parameters]

    @property
    def bounds(self) -> np.ndarray:
        """Lower and upper bounds of the log-parameters, shape (2, p)."""
        return np.array([parameter.log_bounds for parameter in self.parameters]).T

    @property
    def start(self) -> np.ndarray:
        """Log-parameters from which the fit starts, shape (p,)."""
        start = np.log([parameter.start for parameter in self.parameters])
        lower, upper = self.bounds
        return np.clip(start, lower, upper - _INSIDE)

    def linearise(self, log_parameters: np.ndarray, shifts: np.ndarray | None = None) -> Linearised:
        """Log-irradiance of the model at the points, and its derivatives; ``shifts`` (k,)."""
        shifts = np.zeros(len(self.inputs.names)) if shifts is None else shifts
        # all cases at once: as it is, then with each of these numbers less and more
        count = log_parameters.size
        moved = count + shifts.size + 1
        steps = _STEP * np.concatenate([np.zeros((1, moved)), -np.eye(moved), np.eye(moved)])
        with impossible_as_nan():
            found, *around = self.model.log_irradiance(
                log_parameters + steps[:, :count],
                np.log(self.points.pressure) + steps[:, -1:],
                shifts + steps[:, count:-1],
            )
        known = [np.where(row < UNREACHABLE, row, np.nan) for row in (found, *around)]
        (below, above), here = np.split(np.array(known[1:]), 2), known[0]
        # where the levitation ends at the point, the slope of the side that has one
        slopes = np.where(np.isnan(below), above - here, here - below) / _STEP
        both = (above - below) / (2.0 * _STEP)
        slopes = np.where(np.isnan(both), np.where(np.isnan(slopes), 0.0, slopes), both).T
        value = np.array(found)
        changes = [np.array(part) for part in (slopes[:, :count], slopes[:, -1],
                                               slopes[:, count:-1])]  # fmt: skip
        lost = ~np.isfinite(value)
        for change in changes:
            lost |= ~np.isfinite(change.reshape(value.size, -1)).all(axis=1)
        for array, filling in ((value, UNREACHABLE), *((change, 0.0) for change in changes)):
            array[lost] = filling
        return Linearised(value, *changes)


def problem_of(
    points: Points,
    design: AbstractDesign,
    free: Sequence[str],
    instruments: Mapping[str, float] | None = None,
) -> Problem:
    """Set up a calibration; ``free``: names of the parameters."""
    if design.coordinate_name != "pressure":
        raise ParameterError(
            "calibration needs an environment over pressure, such as a chamber; the coordinate of "
            f"this environment is {design.coordinate_name}"
        )
    count = len(free)
    if not count:
        raise ParameterError("no parameters to fit")
    scatter = 0 if points.has_uncertainty else 1
    if len(points) < count + scatter:
        also = " and their scatter" if scatter else ""
        raise ParameterError(
            f"{points.source}: {len(points)} point{'s' * (len(points) != 1)} cannot determine "
            f"{count} parameters{also}"
        )
    columns = {name: target_of(design, name, describes_flyer=True) for name in points.properties}
    stated = {target.fields: points.properties[name] for name, target in columns.items()}
    found: list[Parameter] = []
    for text in free:
        name, _, sample = text.partition("[")
        name, sample = name.strip(), sample.removesuffix("]").strip()
        target = target_of(design, name)
        if design.needs_recompute(list(target.fields)):
            raise ParameterError(f"{name} changes the optics of layers: too costly to fit")
        chosen = points.of(sample) if sample else np.ones(len(points), bool)
        if not chosen.any():
            samples = ", ".join(dict.fromkeys(points.samples))
            raise ParameterError(
                f'{text}: {points.source} has no sample "{sample}"; choose from {samples}'
            )
        values = _row(target, points, stated)[chosen]
        if not np.all(values > 0.0):
            own = "not given" if target.value is None else f"{np.min(values):g}"
            raise ParameterError(
                f"{name} is {own} in the design; a fit needs a positive value to start from"
            )
        if np.ptp(values) > 0.0:
            raise ParameterError(
                f"{name} is one number in the fit, and {points.source} has several; fit it sample "
                f'by sample, such as "{name}[{points.samples[0]}]"'
            )
        found.append(Parameter(text, target, chosen, float(values[0])))
    parameters = tuple(found)
    targets = {target.fields: target for target in columns.values()}
    targets |= {parameter.target.fields: parameter.target for parameter in parameters}
    fields = [field for group in targets for field in group]
    both = design.conflict(fields)
    if both is not None:
        raise ParameterError(f"{both[0]} and {both[1]} cannot both be given")
    for one in fields:
        if fields.count(one) > 1:
            raise ParameterError(f"{one} is given twice, by itself and for both faces")
    index = {fields: _index(fields, points, parameters) for fields in targets}
    inputs = fit_inputs(points, design, columns, index, instruments or {})
    targets |= inputs.targets
    nowhere = np.full(len(points), -1.0)
    every = list(design.quantities)
    model = LevitationModel(
        design=design,
        prepared=design.precompute({}) if design.needs_recompute(every) else None,
        targets=tuple((target.fields, target.factor) for target in targets.values()),
        stated=np.stack([_row(target, points, stated) for target in targets.values()]),
        index=np.stack([index.get(fields, nowhere) for fields in targets]),
        moves=inputs.moves(list(targets), len(points)),
        gains=inputs.gains,
        movers=tuple(inputs.changes),
        changes=tuple(inputs.changes.values()),
    )
    return Problem(points, model, parameters, inputs)


def _row(target: Target, points: Points, stated: Mapping[Fields, np.ndarray]) -> np.ndarray:
    """Values of a target over the points: those of its column, or the design's own."""
    own = np.nan if target.value is None else target.value
    return np.asarray(stated.get(target.fields, np.full(len(points), own)), float)


def _index(fields: Fields, points: Points, parameters: Sequence[Parameter]) -> np.ndarray:
    """Number of the parameter that is the value of some fields at each point, -1 for none."""
    index = np.full(len(points), -1.0)
    for number, parameter in enumerate(parameters):
        if parameter.target.fields == fields:
            if np.any(index[parameter.chosen] >= 0.0):
                raise ParameterError(f"{parameter.name} is fitted twice")
            index[parameter.chosen] = number
    return index
