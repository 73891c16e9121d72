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


def describe_object(part: Any) -> str:
    """Class of an object and its numbers, such as a force model's; tables are left out."""
    told = []
    for field in fields(part):
        value = getattr(part, field.name)
        if isinstance(value, Reading):
            told.append(f"{field.name}={_reading(value)}")
        elif isinstance(value, Module):
            told.append(f"{field.name}={describe_object(value)}")
        elif isinstance(value, str | bool | int) or np.ndim(value) == 0:
            told.append(f"{field.name}={value}")
    return f"{type(part).__name__}({', '.join(told)})"


def _reading(value: Reading) -> str:
    """Name of a reading of the paper, or its numbers."""
    names = (name for name, known in READINGS.items() if known == value)
    return next(names, str(value))


def assumptions_of(
    setup: Setup,
    rule: AbstractAttitudeRule,
    ensemble: Ensemble | None,
    inertia: Inertia | None,
) -> tuple[str, ...]:
    """What is assumed, in short texts with units."""
    environment = setup.environment
    wind = getattr(environment, "wind", None)
    told = [f"force model: {type(setup.model).__name__}", *setup.model.assumptions(setup.flyer)]
    told += _light_assumptions(environment)
    told += ["wind: none"] if wind is None else list(wind.describe())
    told.append(f"attitude: {rule.describe()}")
    if inertia is None:
        told.append(
            "motion: in balance of heat and forces at each moment, after a release with a velocity "
            "or in thin air with inertia until it is"
        )
    else:
        told.append(
            f"motion: with inertia, specific heat {float(inertia.specific_heat):g} J/(kg K)"
        )
    told.append("absorptance: the same at every incidence, for a film of layers as at the release")
    told.append("force and heat balance: those of a flyer at rest in the gas")
    told.append(f"drag: {setup.flyer.drag_law}")
    return (*told, *_ensemble_assumptions(ensemble, environment))


def _light_assumptions(environment: AbstractEnvironment) -> tuple[str, ...]:
    sky = getattr(environment, "sky", None)
    if sky is not None:
        return (*sky.assumptions(), *environment.assumptions_of_air())
    return ("light: the same at all times", *environment.assumptions())


def _ensemble_assumptions(
    ensemble: Ensemble | None, environment: AbstractEnvironment
) -> tuple[str, ...]:
    if ensemble is None:
        return ()
    told = [f"ensemble: {ensemble.members} members, seed {ensemble.seed}, every ± of the design"]
    winds = (float(ensemble.wind), float(ensemble.vertical_wind))
    if any(winds):
        hours = float(ensemble.wind_correlation_time) / _SECONDS_AN_HOUR
        told.append(
            f"error of the wind: ± {winds[0]:g} m/s east and north, ± {winds[1]:g} m/s up, the "
            f"same at all altitudes{', and for all members' if ensemble.together else ''}, "
            f"correlated over {hours:g} h"
        )
    scale = ensemble.waves_over(environment)
    if scale:
        told.append(describe_waves(scale, tides_of(environment), together=ensemble.together))
    elif ensemble.waves is None:
        told.append(f"waves: none; those of {planet_of(environment).name} are not known")
    else:
        told.append("waves: none; the air is still but for its wind")
    if float(ensemble.drag):
        told.append(f"drag: ± {100.0 * float(ensemble.drag):g} %, the same throughout a flight")
    spread = [float(part) for part in (ensemble.altitude, ensemble.distance, ensemble.time)]
    if any(spread) or float(ensemble.velocity):
        told.append(
            f"release: ± {spread[0]:g} m in altitude, ± {spread[1]:g} m north and east, "
            f"± {spread[2]:g} s, ± {float(ensemble.velocity):g} m/s in each direction"
        )
    return tuple(told)


_OWN = object()  # an environment of a user's own may move its sun as it likes
_AT_A_POLE = 0.5 * np.pi - 1e-3  # radians of latitude; a few kilometres around it


def diagnose_flight(vehicle: Vehicle, course: Course, values: dict[str, Any]) -> tuple[str, ...]:
    """Diagnostics of a flyer along its way; ``values``: of its moments; one line each."""
    setup = vehicle.setup
    place = Place(*geographic(course.position), course.released + course.elapsed)
    state = setup.environment.state(within(vehicle, course).altitude, place)
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
