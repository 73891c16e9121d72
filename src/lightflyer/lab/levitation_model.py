"""Model curves for measured levitation points, and a calibration to them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from lightflyer.calibration.calibration import Calibration, calibrate
from lightflyer.calibration.points import SAMPLE_PROPERTIES, Points
from lightflyer.flight.levitation import levitate
from lightflyer.flight.setup import Setup
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.disk import Disk
from lightflyer.force.lu2023 import Lu2023
from lightflyer.foundation.errors import ParameterError
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
        If properties of the sample are known and the flyer is not a disk.
    """
    low, high = points.pressure.min() / _BEYOND, points.pressure.max() * _BEYOND
    pressure = np.geomspace(low, high, _PRESSURES)
    flyer = _with_properties(setup.flyer, points.properties)
    found = levitate(flyer, setup.environment.state(pressure), setup.model, throw=False)
    return pressure, np.where(found.levitates, found.irradiance, np.nan)


def _with_properties(flyer: AbstractFlyer, known: Mapping[str, float]) -> AbstractFlyer:
    """The flyer with the known properties of a sample."""
    if not known:
        return flyer
    if not isinstance(flyer, Disk):
        raise ParameterError(
            f"columns such as {next(iter(known))} describe disks; the flyer is a {flyer.describe()}"
        )
    values = {**known}
    diameter = values.pop("diameter", None)
    radius = flyer.radius if diameter is None else 0.5 * diameter
    if "emittance" in values:
        values["emittance_top"] = values["emittance_bottom"] = values.pop("emittance")
    return replace(flyer, film=replace(flyer.film, **values), radius=radius)


def calibrate_curves(curves: Sequence[LevitationCurve], setup: Setup) -> tuple[Calibration, Setup]:
    """Fit the force coefficients to the points of all samples.

    Parameters
    ----------
    curves : sequence of LevitationCurve
    setup : Setup
        Flyer, chamber and model to start from.

    Returns
    -------
    calibration : Calibration
    setup : Setup
        With the fitted coefficients.

    Raises
    ------
    ParameterError
        If the model is not :class:`~lightflyer.force.lu2023.Lu2023`.
    """
    if not isinstance(setup.model, Lu2023):
        raise ParameterError("calibration needs the force model lu2023")
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
    return fit, replace(setup, model=model)
