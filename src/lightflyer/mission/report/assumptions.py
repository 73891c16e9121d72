"""What a mission rests on, and where a model or the data are beyond their range, in words."""

from dataclasses import fields
from typing import Any

import numpy as np

from lightflyer.array.records import Module
from lightflyer.design.diagnostics import diagnose
from lightflyer.design.setup import Setup
from lightflyer.environment.base import AbstractEnvironment, Place
from lightflyer.force.lu2023 import READINGS, Reading
from lightflyer.mission.areas import geographic
from lightflyer.mission.fleet import Ensemble, tides_of
from lightflyer.mission.path.air import describe_waves
from lightflyer.mission.path.attitude import AbstractAttitudeRule
from lightflyer.mission.path.dynamics import Inertia
from lightflyer.mission.path.integration import TerminationReason
from lightflyer.mission.path.motion import Course, Vehicle, planet_of, within

_SECONDS_AN_HOUR = 3600.0
_OTHER_SKY = object()  # an environment of a user's own may move its sun as it likes
_AT_A_POLE = 0.5 * np.pi - 1e-3  # radians of latitude; a few kilometres around it


def describe_object(part: Any) -> str:
    """Class of an object and its numbers, such as a force model's; tables are left out."""
    texts = []
    for field in fields(part):
        value = getattr(part, field.name)
        if isinstance(value, Reading):  # of the paper, by its name or its numbers
            names = (name for name, known in READINGS.items() if known == value)
            texts.append(f"{field.name}={next(names, str(value))}")
        elif isinstance(value, Module):
            texts.append(f"{field.name}={describe_object(value)}")
        elif isinstance(value, str | bool | int) or np.ndim(value) == 0:
            texts.append(f"{field.name}={value}")
    return f"{type(part).__name__}({', '.join(texts)})"


def assumptions_of(
    setup: Setup,
    rule: AbstractAttitudeRule,
    ensemble: Ensemble | None,
    inertia: Inertia | None,
) -> tuple[str, ...]:
    """What is assumed, in short texts with units."""
    environment = setup.environment
    wind, sky = (getattr(environment, name, None) for name in ("wind", "sky"))
    motion = (
        "heat and forces balance at each moment; inertia counts after a release at speed or in "
        "thin air, until they do"
        if inertia is None
        else f"with inertia, specific heat {float(inertia.specific_heat):g} J/(kg K); "
        "temperatures, powers and speeds over time are those in balance at each place"
    )
    light = (
        ("light: the same at all times", *environment.assumptions())
        if sky is None
        else (*sky.assumptions(), *environment.assumptions_of_air())
    )
    texts = [
        f"force model: {type(setup.model).__name__}",
        *setup.model.assumptions(setup.flyer),
        *light,
        *(["wind: none"] if wind is None else wind.describe()),
        f"attitude: {rule.describe()}",
        f"motion: {motion}",
        "absorptance: the same at every incidence, for a film of layers as at the release",
        "force and heat balance: those of a flyer at rest in the gas",
        f"drag: {setup.flyer.drag_law}",
    ]
    if ensemble is None:
        return tuple(texts)
    texts.append(
        f"ensemble: {ensemble.members} members, seed {ensemble.seed}, every ± of the design"
    )
    winds = (float(ensemble.wind), float(ensemble.vertical_wind))
    if any(winds):
        hours = float(ensemble.wind_correlation_time) / _SECONDS_AN_HOUR
        texts.append(
            f"error of the wind: ± {winds[0]:g} m/s east and north, ± {winds[1]:g} m/s up, the "
            f"same at all altitudes{', and for all members' if ensemble.together else ''}, "
            f"correlated over {hours:g} h"
        )
    scale = ensemble.waves_over(environment)
    if scale:
        texts.append(describe_waves(scale, tides_of(environment), together=ensemble.together))
    elif ensemble.waves is None:
        texts.append(f"waves: none; those of {planet_of(environment).name} are not known")
    else:
        texts.append("waves: none; the air is still but for its wind")
    if float(ensemble.drag):
        texts.append(f"drag: ± {100.0 * float(ensemble.drag):g} %, the same throughout a flight")
    spread = [float(part) for part in (ensemble.altitude, ensemble.distance, ensemble.time)]
    if any(spread) or float(ensemble.velocity):
        texts.append(
            f"release: ± {spread[0]:g} m in altitude, ± {spread[1]:g} m north and east, "
            f"± {spread[2]:g} s, ± {float(ensemble.velocity):g} m/s in each direction"
        )
    return tuple(texts)


def diagnose_flight(vehicle: Vehicle, course: Course, values: dict[str, Any]) -> tuple[str, ...]:
    """Diagnostics of a flyer along its way; ``values``: of its moments; one line each."""
    setup, environment = vehicle.setup, vehicle.setup.environment
    place = Place(*geographic(course.position), course.released + course.elapsed)
    state = environment.state(within(vehicle, course).altitude, place)
    flyer, temperature, slope = setup.flyer, values["temperature"], values["slope_speed"]
    drags = [*flyer.drag_diagnostics(state, values["axial_speed"], "broadside", temperature)]
    if np.any(slope != 0.0):
        drags += flyer.drag_diagnostics(state, slope, "edgewise", temperature)
    found = [*diagnose(setup, state, temperature), *dict.fromkeys(drags)]
    if getattr(environment, "sky", _OTHER_SKY) is None:
        found.append(
            "there is no day and night: the light is the same at all times, as irradiance and "
            "incidence of [environment], or an environment without a sky, have it"
        )
    elif not np.any(values["irradiance"] > 0.0):
        found.append("the mission never finds light: the sun is below the horizon throughout")
    share = values.get("light_share")
    if share is not None and np.ptp(share) == 0.0 and share[0] in (0.0, 1.0):
        some = "all" if share[0] else "none"
        found.append(f"the shading never changes: the flyer lets in {some} of the light throughout")
    return tuple(found)


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
