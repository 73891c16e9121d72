"""What a reader of a mission must know: where a model or the data are beyond their range."""

from typing import Any

import numpy as np

from lightflyer.core.entry_point import entry_point
from lightflyer.design.diagnostics import diagnose
from lightflyer.environment.base import AbstractEnvironment, Place
from lightflyer.mission.path.moments import Course, within
from lightflyer.mission.path.motion import Craft
from lightflyer.mission.path.position import latitude_and_longitude
from lightflyer.mission.path.termination import TerminationReason

_places = entry_point(latitude_and_longitude)
_OWN = object()  # an environment of a user's own may move its sun as it likes
_AT_A_POLE = 0.5 * np.pi - 1e-3  # radians of latitude; a few kilometres around it


def diagnose_flight(craft: Craft, course: Course, values: dict[str, Any]) -> tuple[str, ...]:
    """Diagnostics of a flyer along its way; ``values``: of its moments; one line each."""
    setup = craft.setup
    place = Place(*_places(course.position), course.released + course.elapsed)
    state = setup.environment.state(within(craft, course).altitude, place)
    flyer, temperature, slope = setup.flyer, values["temperature"], values["slope_speed"]
    broadside = flyer.drag_diagnostics(state, values["axial_speed"], "broadside", temperature)
    edgewise = (
        flyer.drag_diagnostics(state, slope, "edgewise", temperature)
        if np.any(slope != 0.0)
        else ()
    )
    return (
        *diagnose(setup, state, temperature),
        *dict.fromkeys((*broadside, *edgewise)),
        *_light_diagnostics(setup.environment, values["irradiance"]),
        *_shading_diagnostics(values.get("light_share")),
    )


def _light_diagnostics(environment: AbstractEnvironment, irradiance: np.ndarray) -> tuple[str, ...]:
    if getattr(environment, "sky", _OWN) is None:
        return (
            "there is no day and night: the light is the same at all times, as irradiance and "
            "incidence of [environment], or an environment without a sky, have it",
        )
    if np.any(irradiance > 0.0):
        return ()
    return ("the mission never finds light: the sun is below the horizon throughout",)


def _shading_diagnostics(share: np.ndarray | None) -> tuple[str, ...]:
    if share is None or np.ptp(share) > 0.0 or share[0] not in (0.0, 1.0):
        return ()
    some = "all" if share[0] else "none"
    return (f"the shading never changes: the flyer lets in {some} of the light throughout",)


def termination_text(
    end: TerminationReason, environment: AbstractEnvironment, altitude: float, place: Place
) -> str:
    """Why a mission ended, in words."""
    if end is TerminationReason.STEP_LIMIT and abs(float(place.latitude)) > _AT_A_POLE:
        return f"{end.describe()} at a pole, where its wind has no direction"
    if end is not TerminationReason.NO_DATA:
        return end.describe()
    wind = getattr(environment, "wind", None)
    margins = {} if wind is None else wind.margins(altitude, place)
    if not margins:
        return TerminationReason.NO_DATA.describe()
    nearest = min(margins, key=lambda name: float(margins[name]))
    return f"met the end of its data: {nearest}"
