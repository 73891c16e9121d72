"""What a reader of a result must know: where the force model, or the film, is beyond its range."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from typing import Any

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import Numeric
from lightflyer.budget.payload import light_on_cells
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import RADIANS_PER_DEGREE, numbers_in
from lightflyer.core.text import rounded
from lightflyer.design.design import AbstractDesign
from lightflyer.design.setup import Setup
from lightflyer.environment.base import AbstractEnvironment, EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.statics.balance import equilibrium
from lightflyer.statics.bands import levitation_band

UNSTATED_LIMIT = 500.0
"""Temperature above which a film without a stated highest temperature is worth a diagnostic [K]:
polymer films shrink and melt near it."""

TOO_HOT = "the flyer reaches"  # How a diagnostic of heat begins

_FLAT = 0.2  # height of the edge over the radius, from which 5 % of the lift are lost to tilt
_FAILING = ("deflection", "stress_over_strength", "gap_closed", "load_over_buckling")
_BUCKLED = {True: "a membrane wrinkles between its holds", False: "its shell buckles"}
_GAP = 0.5  # share of a gap, from which the force of a flat one means little

_LOOKS = 31  # places within a band that are looked at
_ROUNDING = 1e-5  # relative, within which a search meets a limit


def diagnose_at(setup: Setup, coordinate: Numeric, temperature: Numeric) -> tuple[str, ...]:
    """Diagnostics of a flyer at some places; ``coordinate`` (n,); ``temperature`` (n,)."""
    state = _state(setup.environment, np.asarray(coordinate, float))
    return diagnose(setup, state, np.asarray(temperature, float))


@entry_point
def _state(environment: AbstractEnvironment, coordinate: Numeric) -> EnvironmentState:
    return environment.state(coordinate)


def diagnose(setup: Setup, state: EnvironmentState, temperature: Numeric) -> tuple[str, ...]:
    """Diagnostics of a flyer in some surroundings; ``temperature`` (n,)."""
    flyer, name = setup.flyer, type(setup.model).__name__
    # numbers that are possible, but most likely of a wrong unit
    parts = {"flyer.": flyer, "environment.": setup.environment, "force.": setup.model}
    numbers = chain.from_iterable(numbers_in(part, name) for name, part in parts.items())
    found = [
        f"{key} = {doubt}"
        for key, quantity, value in numbers
        if value is not None and (doubt := quantity.unlikely(value))
    ]
    if state.radiation.visible is not None and not np.any(state.radiation.visible):
        below = np.min(state.radiation.zenith_angle) / RADIANS_PER_DEGREE - 90.0
        found.append(
            f"the sun is {below:.0f}° below the horizontal, hidden by the planet: it is night"
        )
    if state.wall_distance is not None and not setup.model.feels_walls:
        found.append(f"the walls around the flyer have no effect: {name} is for open space")
    ends = (state.floor_distance, state.lid_distance)
    if any(end is not None for end in ends) and not setup.model.feels_floor:
        but = "" if state.floor_excess is None else " but on the gas temperature"
        found.append(f"floor and lid have no effect{but}: {name} knows none")
    temperatures = np.stack(np.broadcast_arrays(state.temperature, temperature))
    found += setup.model.diagnostics(flyer, state, temperature)
    found += flyer.diagnostics(state, temperature)
    found += state.gas.diagnostics(temperatures, state.pressure)
    if setup.budget is not None and setup.budget.cells is not None:
        needs = setup.budget.needs(light_on_cells(state.radiation, flyer.attitude))
        share = float(np.max(needs.cell_area, initial=0.0)) / float(flyer.area)
        if share == np.inf:
            found.append("the payload's solar cells have no light somewhere, and nothing is stored")
        elif share > 1.0:
            found.append(f"the payload's solar cells need {share:.3g} times the area of the flyer")
    # numbers of a flyer as a structure that are given and decide nothing
    names = ("hanging_radius", "wall_shear_modulus")
    given = [name for name in names if getattr(flyer, name, None) is not None]
    if not flyer.known_shape:
        found += (f"{name} has no effect: no layer states mechanical numbers" for name in given)
    elif "hanging_radius" in given and not np.any(flyer.payload):
        found.append("hanging_radius has no effect without a payload")
    highest, own = flyer.highest_temperature, "its film" if flyer.film_names() else "it"
    hottest = float(np.max(temperature, initial=0.0))
    if highest is None and hottest > UNSTATED_LIMIT:
        advice = f"if {own} withstands that, state highest_temperature"
        found.append(f"{TOO_HOT} {hottest:.0f} K: {advice}")
    elif highest is not None and hottest > float(highest) * (1.0 + _ROUNDING):
        found.append(f"{TOO_HOT} {hottest:.0f} K, and {own} withstands {float(highest):.0f} K")
    return tuple(found)


def diagnose_design(design: AbstractDesign, values: Mapping[str, float]) -> tuple[str, ...]:
    """Diagnostics of a design with some numbers replaced; those of the design itself first."""
    (found,) = diagnose_designs(design, [values])
    return found


def diagnose_designs(
    design: AbstractDesign, several: Sequence[Mapping[str, float]]
) -> list[tuple[str, ...]]:
    """The same with several values of the same numbers; their bands are found at once."""
    setups = [design.build(values) for values in several]

    def joined(first: Numeric, *rest: Numeric) -> Numeric:
        return np.array([first, *rest]) if any(np.any(one != first) for one in rest) else first

    # as one, with arrays where they differ; a table that they share stays whole
    whole, name = tree.map_leaves(joined, *setups), design.coordinate_name
    if name in several[0]:
        places = np.array([[values[name] for values in several]])
    else:
        searched = setups[0].searched
        count = len(setups)
        band = levitation_band(whole.flyer, whole.environment, whole.model, searched, throw=False)
        lower, upper = (np.broadcast_to(end, count) for end in (band.lower, band.upper))
        places = np.linspace(lower, upper, _LOOKS)
    flies = ~np.isnan(places[0])
    state = whole.environment.state(np.where(flies, places, setups[0].searched[0]))
    found = equilibrium(whole.flyer, state, whole.model, throw=False).temperature
    return [
        (*design.warnings_for(values), *(diagnose_at(setup, *columns) if there else ()))
        for values, setup, there, *columns in zip(
            several, setups, flies, places.T, np.broadcast_to(found, places.shape).T, strict=True
        )
    ]


def shape_failures(setup: Setup, table: Mapping[str, Any]) -> dict[str, str]:
    """Outputs by which a flyer does not hold its shape where it flies, with words for each."""
    flies = table["lift_over_weight"] >= 1.0
    known = [name for name in _FAILING if name in setup.flyer.known_shape]
    largest = {name: float(np.max(table[name], where=flies, initial=0.0)) for name in known}
    rise = largest.get("deflection", 0.0) / float(getattr(setup.flyer, "radius", np.inf))
    tension, closed, pressed = (largest.get(name, 0.0) for name in _FAILING[1:])
    thin = "deflection" in known
    told = {
        "deflection": (
            rise > _FLAT,
            f"the flyer does not stay flat: its edge is off by {100.0 * rise:.0f} % of its radius",
        ),
        "stress_over_strength": (
            tension > 1.0,
            f"a layer tears: its tension is {rounded(tension)} times its strength",
        ),
        "gap_closed": (
            closed > _GAP,
            f"the gap does not stay: membranes close {100.0 * closed:.0f} % of it",
        ),
        "load_over_buckling": (
            pressed > 1.0,
            f"{_BUCKLED[thin]}: the pressure on it is {rounded(pressed)} times what it withstands",
        ),
    }
    return {name: words for name, (fails, words) in told.items() if fails}


def diagnose_force(flyer: AbstractFlyer, table: dict[str, Any]) -> Iterator[str]:
    """Diagnostics of a flyer that the gas does not push up where it pushes hardest."""
    if flyer.floats:
        return
    lift = np.nan_to_num(table["lift"])
    strongest = float(lift[np.argmax(np.abs(lift))])
    tilt = 0.0 if flyer.attitude is None else float(np.max(flyer.attitude.tilt))
    if strongest < 0.0 and tilt > 0.5 * np.pi:
        yield (
            f"the gas pushes the flyer down: tilted by {tilt / RADIANS_PER_DEGREE:.4g}° it is "
            "upside down, and from 90° on the push up becomes a push down"
        )
    elif strongest < 0.0:
        yield (
            "the gas pushes the flyer down: for a thin film in the light tac_bottom must exceed "
            "tac_top"
        )
    elif strongest == 0.0:
        yield (
            "the gas does not push the flyer: for a thin film tac_bottom must exceed tac_top, and "
            "here they are equal"
        )
