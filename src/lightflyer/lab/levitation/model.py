"""Model curves for measured levitation points, and a calibration to them."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from lightflyer.calibration.calibration import Calibration
from lightflyer.calibration.fitting import calibrate
from lightflyer.calibration.inputs import INSTRUMENTS, target_of
from lightflyer.calibration.points import Points
from lightflyer.config.designs import as_design
from lightflyer.design.setup import Setup
from lightflyer.lab.estimate import Estimate
from lightflyer.lab.levitation.curve import LevitationCurve
from lightflyer.lab.levitation.data import LiftOffs
from lightflyer.statics.levitation import levitate

_BEYOND = 1.5  # factor by which a model's curve extends beyond the measured pressures
_PRESSURES = 200


def model_curve(points: LiftOffs, setup: Setup) -> tuple[np.ndarray, np.ndarray]:
    """Irradiance at which the model levitates, a little beyond the pressures of a sample."""
    low, high = points.pressure.min() / _BEYOND, points.pressure.max() * _BEYOND
    pressure = np.geomspace(low, high, _PRESSURES)
    design = as_design(setup)
    values: dict[str, float] = {}
    for name, value in points.properties.items():
        target = target_of(design, name, describes_flyer=True)
        values |= dict.fromkeys(target.fields, target.factor * value)
    sample = design.build(values)
    found = levitate(sample.flyer, sample.environment.state(pressure), sample.model, throw=False)
    return pressure, np.where(found.levitates, found.irradiance, np.nan)


def calibrate_curves(
    curves: Sequence[LevitationCurve],
    what: Any,
    *,
    keep_ground_effect: bool = False,
    pressure_accuracy: float | None = None,
    irradiance_accuracy: float | None = None,
) -> Calibration:
    """Fit the force coefficients to the points of all samples."""
    lots = []
    for curve in curves:
        lot, count = curve.points, len(curve.points.pressure)
        gap = None if keep_ground_effect else lot.floor_gap
        numbers = {"pressure": lot.pressure, "irradiance": lot.irradiance, **lot.uncertainties}
        numbers |= {name: np.full(count, value) for name, value in lot.properties.items()}
        numbers["floor_gap"] = np.full(count, np.inf if gap is None else gap)
        lots.append(Points(lot.place, [lot.name] * count, numbers).with_step(curve.step))
    shared = set.intersection(*(set(one.numbers) for one in lots))
    whole = Points(
        source=lots[0].source,
        samples=[name for one in lots for name in one.samples],
        numbers={
            name: np.concatenate([one.numbers[name] for one in lots])
            for name in lots[0].numbers
            if name in shared
        },
        step=max(curve.step for curve in curves),
    )
    return calibrate(
        what,
        points=whole.without_ground_effect(),
        pressure_accuracy=pressure_accuracy,
        irradiance_accuracy=irradiance_accuracy,
    )


def measured_coefficients(fit: Calibration) -> dict[str, Estimate]:
    """Fitted parameters with what goes into the flyer file that the fit started from."""
    found = {}
    meters = [fit.contributions[one] for one in INSTRUMENTS if one in fit.contributions]
    for row, name in enumerate(fit.names):
        value = float(fit.values[row])
        calibration = [value * float(shares[row]) for shares in meters]
        spread = math.hypot(fit.standard_uncertainties[row], *calibration)
        low, high = map(float, fit.total_intervals[row])
        found[name] = Estimate(value, (low, high), "", spread)
    return found
