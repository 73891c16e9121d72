"""What a reader of a mission must know: where a model or the data are beyond their range."""

from typing import Any

import numpy as np

from lightflyer.environment.base import AbstractEnvironment, Place
from lightflyer.flight.cautions import cautions_in
from lightflyer.mission.ending import MissionEnd
from lightflyer.mission.motion import Craft


def cautions_along(craft: Craft, place: Place, values: dict[str, Any]) -> tuple[str, ...]:
    """Cautions about a flyer along its way.

    Parameters
    ----------
    craft : Craft
    place : Place
        Where and when the flyer is, fields of shape (times,).
    values : dict of str to array, shape (times,)
        ``altitude``, and the results of :func:`lightflyer.mission.moments.moments`.

    Returns
    -------
    tuple of str
        One line each.
    """
    setup = craft.setup
    state = setup.environment.state(values["altitude"], place)
    speed = np.where(
        np.abs(values["axial_speed"]) > np.abs(values["slope_speed"]),
        values["axial_speed"],
        values["slope_speed"],
    )
    return (
        *cautions_in(setup, state, values["temperature"]),
        *setup.flyer.drag_caveats(state, speed),
        *_of_light(values["irradiance"]),
    )


def _of_light(irradiance: np.ndarray) -> tuple[str, ...]:
    if np.any(irradiance > 0.0):
        return ()
    return ("the mission never finds light: the sun is below the horizon throughout",)


def why_no_data(environment: AbstractEnvironment, altitude: float, place: Place) -> str:
    """What ends where a mission could not go on, in words.

    Parameters
    ----------
    environment : AbstractEnvironment
    altitude : float
        [m].
    place : Place

    Returns
    -------
    str
    """
    wind = getattr(environment, "wind", None)
    margins = {} if wind is None else wind.margins(altitude, place)
    if not margins:
        return MissionEnd.NO_DATA.describe()
    nearest = min(margins, key=lambda name: float(margins[name]))
    return f"met the end of its data: {nearest}"
