"""What happens to a flyer from its release until it is in balance."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.core.constants import STANDARD_GRAVITY, TOTAL_SOLAR_IRRADIANCE
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.environment.base import Place
from lightflyer.mission.areas import distances_between
from lightflyer.mission.first_seconds import Beginning
from lightflyer.mission.path.moments import Course, Variable, within
from lightflyer.mission.path.motion import Craft, planet_of
from lightflyer.mission.path.position import latitude_and_longitude
from lightflyer.mission.report.dataset import ELAPSED

if TYPE_CHECKING:
    import xarray as xr

_places = entry_point(latitude_and_longitude)
_MATTERS, _RULES = (0.1, 10.0), (1.0, 300.0)
"""Heat of the air's motion that is warned of, and that is refused: its power over that of sunlight
[1], of which thin air transfers all, and the warmth of air that is stopped [K], as warm as dense
air makes a flyer."""

_LOOKS = 8  # in each interval of the integration

_ABOUT = {
    "speed": Variable("m s-1", "speed over ground at the release"),
    "balance": Variable("s", "time from the release to balance of all flights"),
    "distance": Variable("m", "distance over ground from the release to where it is in balance"),
    "highest": Variable("m", "highest altitude until it is in balance"),
    "acceleration": Variable("m s-2", "largest acceleration until it is in balance"),
    "pressure": Variable("Pa", "largest dynamic pressure until it is in balance"),
    "heating": Variable("W m-2", "largest power of the air's motion, whose heat is left out"),
    "warmth": Variable("K", "largest warmth of air that is stopped"),
}
PREFIX = "release_"


def since(until: float, course: Course, values: dict[str, Any]) -> tuple[Course, dict[str, Any]]:
    """Moments of a flight from some time on, at least the last."""
    rows = np.asarray(course.elapsed) >= min(until, np.max(course.elapsed))
    part = Course(course.elapsed[rows], course.altitude[rows], course.position[rows],
                  course.released)  # fmt: skip
    return part, {name: value[rows] for name, value in values.items()}


def add_departure(
    dataset: "xr.Dataset", craft: Craft, begun: Beginning, released: float
) -> list[str]:
    """Add what happens until a flyer is in balance, and its speeds there; returns warnings."""
    assert begun.way is not None
    assert begun.felt is not None
    edges = begun.way.times
    looks = np.linspace(0.0, edges.size - 1.0, _LOOKS * (edges.size - 1) + 1)
    times = np.interp(looks, np.arange(edges.size), edges)
    height, position = begun.way(times)
    felt = begun.felt(times)
    pressure = 0.5 * felt.density * felt.speed**2
    radius = float(planet_of(craft.setup.environment).radius)
    found = {
        "speed": np.linalg.norm(felt.ground[0]),
        "balance": begun.until,
        "distance": distances_between(position[-1], position[0], radius),
        "highest": height.max(),
        "acceleration": felt.acceleration.max(),
        "pressure": pressure.max(),
        "heating": (pressure * felt.speed).max(),
        "warmth": (0.5 * felt.speed**2 / felt.heat_capacity).max(),
    }
    for name, value in found.items():
        about = _ABOUT[name]
        attributes = {"units": about.unit, "long_name": about.long_name}
        dataset[PREFIX + name] = ((), float(value), attributes)
    early = dataset[ELAPSED].values <= times[-1]
    moving = begun.felt(dataset[ELAPSED].values[early]).ground
    for name, column in zip(("eastward", "northward", "vertical"), moving.T, strict=True):
        dataset[f"{name}_speed"].values[early] = column
    for name in ("axial_speed", "slope_speed", "drag_power"):  # known in balance alone
        dataset[name].values[early] = np.nan
    hot = (
        f"the air heats it with up to {found['heating']:.3g} W/m², by up to "
        f"{found['warmth']:.0f} K, which is left out"
    )
    heat = found["heating"] / TOTAL_SOLAR_IRRADIANCE, found["warmth"]
    if np.all(np.greater(heat, _RULES)):
        raise ParameterError(
            f"released at {height[0] / 1e3:g} km with {found['speed']:.3g} m/s a flyer is lost in "
            f"this model: {hot}; release it slower or higher"
        )
    course = within(craft, Course(times, height, position, released))
    state = craft.setup.environment.state(
        course.altitude, Place(*_places(position), released + times)
    )
    told = list(craft.setup.flyer.drag_diagnostics(replace(state, wind=None), felt.speed))
    if np.all(np.greater(heat, _MATTERS)):
        told.append(f"in the first seconds {hot}")
    return told


def summarise_departure(dataset: "xr.Dataset") -> dict[str, Any] | None:
    """The first seconds in numbers, with a unit at the end of each name; None without them."""
    if f"{PREFIX}speed" not in dataset:
        return None
    given = {name: float(dataset[PREFIX + name]) for name in _ABOUT}
    return {
        "speed_m_s": given["speed"],
        "in_balance_after_s": given["balance"],
        "moved_km": given["distance"] / 1e3,
        "highest_altitude_km": given["highest"] / 1e3,
        "largest_acceleration_g": given["acceleration"] / STANDARD_GRAVITY,
        "dynamic_pressure_pa": given["pressure"],
        "heating_w_m2": given["heating"],
        "warmth_k": given["warmth"],
    }


def departure_text(found: dict[str, Any]) -> str:
    """The first seconds in words."""
    return (
        f"with {found['speed_m_s']:.4g} m/s, highest {found['highest_altitude_km']:.2f} km; in "
        f"balance within {found['in_balance_after_s']:.3g} s and {found['moved_km']:.3g} km; at "
        f"most {found['largest_acceleration_g']:.3g} g and "
        f"{found['dynamic_pressure_pa']:.3g} Pa of dynamic pressure"
    )
