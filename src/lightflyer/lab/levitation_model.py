"""Model curves for measured levitation points, and a calibration to them."""

from collections.abc import Sequence

import numpy as np

from lightflyer.calibration.calibration import Calibration, calibrate
from lightflyer.calibration.points import SAMPLE_PROPERTIES, Points
from lightflyer.calibration.targets import target_of
from lightflyer.flight.design import as_design
from lightflyer.flight.levitation import levitate
from lightflyer.flight.setup import Setup
from lightflyer.lab.levitation import LevitationCurve
from lightflyer.lab.levitation_data import LiftOffs

_BEYOND = 1.5  # factor by which a model's curve extends beyond the measured pressures
_PRESSURES = 200


def model_curve(points: LiftOffs, setup: Setup) -> tuple[np.ndarray, np.ndarray]:
    """Irradiance at which the model levitates, over the pressures of a sample and a little beyond.

    Parameters
    ----------
    points : LiftOffs
        Known properties of the sample replace those of the flyer.
    setup : Setup
        Flyer, chamber and model.

    Returns
    -------
    pressure, irradiance : array, shape (m,)
        [Pa], [W/m²]; NaN where the model levitates at no irradiance.

    Raises
    ------
    ParameterError
        If the flyer has no number for a property of the sample.
    """
    low, high = points.pressure.min() / _BEYOND, points.pressure.max() * _BEYOND
    pressure = np.geomspace(low, high, _PRESSURES)
    sample = _of_sample(setup, points)
    found = levitate(sample.flyer, sample.environment.state(pressure), sample.model, throw=False)
    return pressure, np.where(found.levitates, found.irradiance, np.nan)


def _of_sample(setup: Setup, points: LiftOffs) -> Setup:
    """The setup with the known properties of a sample."""
    design = as_design(setup)
    values: dict[str, float] = {}
    for name, value in points.properties.items():
        target = target_of(design, name, describes_flyer=True)
        values |= dict.fromkeys(target.fields, target.factor * value)
    return design.build(values)


def calibrate_curves(curves: Sequence[LevitationCurve], setup: Setup) -> Calibration:
    """Fit the force coefficients to the points of all samples.

    Parameters
    ----------
    curves : sequence of LevitationCurve
    setup : Setup
        Flyer, chamber and model to start from.

    Returns
    -------
    Calibration
        Its ``setup`` has the fitted coefficients.

    Raises
    ------
    ParameterError
        If the model has no coefficients to fit; see
        :func:`~lightflyer.calibration.calibration.calibrate`.
    """
    lots = [curve.points for curve in curves]
    sizes = [len(one.pressure) for one in lots]
    numbers = {
        "pressure": np.concatenate([one.pressure for one in lots]),
        "irradiance": np.concatenate([one.irradiance for one in lots]),
    }
    for name in SAMPLE_PROPERTIES:
        if all(name in one.properties for one in lots):
            numbers[name] = np.repeat([one.properties[name] for one in lots], sizes)
    names = [one.name for one, size in zip(lots, sizes, strict=True) for _ in range(size)]
    return calibrate(Points(lots[0].place, names, numbers), setup)
