"""The model's curves beside measured levitation points, and a calibration to them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from lightflyer.calibration.calibration import Calibration, calibrate
from lightflyer.calibration.points import SAMPLE_PROPERTIES, Points
from lightflyer.config.sections import Setup
from lightflyer.flight.levitation import levitate
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.disk import Disk
from lightflyer.force.lu2023 import Lu2023
from lightflyer.foundation.errors import ParameterError
from lightflyer.lab.levitation import LevitationCurve, LiftOffs

_BEYOND = 1.5  # factor that a model's curve goes beyond the pressures measured
_PRESSURES = 200


def model_curve(points: LiftOffs, setup: Setup) -> tuple[np.ndarray, np.ndarray]:
    """Irradiance that the model needs, over the pressures of a sample and a little beyond.

    Parameters
    ----------
    points : LiftOffs
        With what is known of the sample.
    setup : Setup
        Of a chamber: all that is not known of it.

    Returns
    -------
    pressure, irradiance : array, shape (m,)
        [Pa], [W/m²]; NaN where the model never levitates.
    """
    low, high = points.pressure.min() / _BEYOND, points.pressure.max() * _BEYOND
    pressure = np.geomspace(low, high, _PRESSURES)
    flyer = _disk(points.properties, setup.flyer)
    found = levitate(flyer, setup.environment.state(pressure), setup.model, throw=False)
    return pressure, np.where(found.levitates, found.irradiance, np.nan)


def _disk(known: Mapping[str, float], flyer: AbstractFlyer) -> Disk:
    """The flyer of a setup, less what is known of a sample."""
    values = {**known}
    diameter = values.pop("diameter", 2.0 * float(flyer.radius))
    if "emittance" in values:
        values["emittance_top"] = values["emittance_bottom"] = values.pop("emittance")
    return Disk(replace(flyer.film, **values), 0.5 * diameter, flyer.payload)


def calibrated(curves: Sequence[LevitationCurve], setup: Setup) -> tuple[Calibration, Setup]:
    """Force coefficients fitted to all points, and the setup that has them.

    Parameters
    ----------
    curves : sequence of LevitationCurve
    setup : Setup
        Flyer, chamber and model that the fit starts from.

    Returns
    -------
    calibration : Calibration
    setup : Setup
    """
    if not isinstance(setup.model, Lu2023):
        raise ParameterError("calibration takes the lu2023 force model")
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
    fit = calibrate(Points(lots[0].place, names, numbers), setup)
    found = dict(zip(fit.names, fit.values, strict=True))
    model = Lu2023(float(found["c_fm"]), float(found["c_cont"]), setup.model.reading)
    return fit, setup._replace(model=model)
