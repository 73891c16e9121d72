"""What a flyer is like at each moment of its way: temperatures, forces, light and wind."""

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from lightflyer.array.namespace import Numeric, xp
from lightflyer.array.records import Module
from lightflyer.core.entry_point import entry_point
from lightflyer.environment.base import Place
from lightflyer.mission.path.motion import Craft, steady_speeds, velocity
from lightflyer.mission.path.position import latitude_and_longitude


class Variable(NamedTuple):
    """Unit and description of a result over time."""

    unit: str  # As datasets write it
    long_name: str


VARIABLES = {
    "pressure": Variable("Pa", "gas pressure"),
    "gas_temperature": Variable("K", "gas temperature"),
    "temperature": Variable("K", "temperature of the flyer's hottest part"),
    "lift_over_weight": Variable("1", "lift of the flyer at rest over its weight"),
    "lift": Variable("N", "upward force of the gas on the flyer at rest, with buoyancy"),
    "weight": Variable("N", "weight with payload"),
    "irradiance": Variable("W m-2", "irradiance of the light on a surface that faces it"),
    "light_share": Variable("1", "share of the light that the flyer lets in"),
    "sun_elevation": Variable(
        "degree", "geometric elevation of the sun, or of what lights the flyer"
    ),
    "tilt": Variable("degree", "tilt of the top face's normal"),
    "absorbed_power": Variable(
        "W", "light absorbed, and heat radiation beyond that of surroundings as warm as the gas"
    ),
    "gas_power": Variable("W", "heat taken by the gas"),
    "radiated_power": Variable("W", "heat radiated, net of surroundings as warm as the gas"),
    "axial_speed": Variable("m s-1", "speed through the air along the normal of the top face"),
    "slope_speed": Variable("m s-1", "speed through the air down the slope of the top face"),
    "drag_power": Variable("W", "power that drag takes"),
    "vertical_speed": Variable("m s-1", "vertical speed over ground, upwards"),
    "eastward_speed": Variable("m s-1", "eastward speed over ground"),
    "northward_speed": Variable("m s-1", "northward speed over ground"),
    "wind_east": Variable("m s-1", "eastward wind"),
    "wind_north": Variable("m s-1", "northward wind"),
    "wind_up": Variable("m s-1", "upward wind"),
}
"""Results over time beside altitude and place; SI units, angles in degrees."""

NODE = "temperature_{}"  # Name of the temperature of one part of a flyer of several

_DEGREES = 180.0 / np.pi


class Course(Module):
    """Where a flyer is over time."""

    elapsed: Numeric  # shape (times,); since the release [s]
    altitude: Numeric  # shape (times,); [m]
    position: Numeric  # shape (times, 3); unit vector in the planet's frame
    released: Numeric  # Time of the release [s]


def node_variables(nodes: tuple[str, ...]) -> dict[str, Variable]:
    """Temperatures of the parts of a flyer of several; empty for a flyer of one temperature."""
    if len(nodes) == 1:
        return {}
    return {
        NODE.format(node): Variable("K", f"temperature of the {node.replace('_', ' ')}")
        for node in nodes
    }


def moments(craft: Craft, course: Course) -> dict[str, Any]:
    """Results over time of a flyer in balance at each moment [1], shape (times,)."""
    found: dict[str, Any] = _moments(craft, within(craft, course))
    return found


def within(craft: Craft, course: Course) -> Course:
    """A course whose end lies within the environment, which it may miss by rounding."""
    where = craft.setup.environment.coordinate
    altitude = np.clip(np.asarray(course.altitude), where.lowest, where.highest)
    return replace(course, altitude=altitude)


@entry_point
def _moments(craft: Craft, course: Course) -> dict[str, Any]:
    elapsed = course.elapsed
    place = Place(*latitude_and_longitude(course.position), course.released + elapsed)
    around = craft.surroundings(course.altitude, place, elapsed)
    heat = craft.heat(around)
    forces = craft.forces(around, heat.unknowns)
    axial, slope = steady_speeds(around, forces, heat.unknowns)
    moving = velocity(around, axial, slope)
    flyer, state = around.flyer, around.state
    tilt = 0.0 if flyer.attitude is None else flyer.attitude.tilt
    found = {
        "pressure": state.pressure,
        "gas_temperature": state.temperature,
        "temperature": heat.temperature,
        "lift_over_weight": forces.lift / forces.weight,
        "lift": forces.lift,
        "weight": forces.weight,
        "irradiance": state.radiation.visible_part(state.radiation.irradiance),
        "sun_elevation": 90.0 - state.radiation.zenith_angle * _DEGREES,
        "tilt": tilt * _DEGREES,
        "absorbed_power": heat.absorbed_power,
        "gas_power": heat.gas_power,
        "radiated_power": heat.radiated_power,
        "axial_speed": axial,
        "slope_speed": slope,
        # drag balances these forces
        "drag_power": forces.axial * axial + forces.slope * slope,
        "vertical_speed": moving.up,
        "eastward_speed": moving.east,
        "northward_speed": moving.north,
        "wind_east": around.wind.east,
        "wind_north": around.wind.north,
        "wind_up": around.wind.up,
        "residual": xp.abs(heat.residual),
    }
    if around.share is not None:
        found["light_share"] = around.share
    if len(heat.nodes) > 1:
        for node, temperature in zip(heat.nodes, heat.temperatures, strict=True):
            found[NODE.format(node)] = temperature
    return {
        name: xp.broadcast_to(xp.asarray(value, float), xp.shape(elapsed))
        for name, value in found.items()
    }
