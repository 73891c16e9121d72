"""Outputs of a design in tables: at any number of coordinates at once."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from lightflyer.core.types import Numeric
from lightflyer.design.operating_point import OperatingPoint, sinks_at_night
from lightflyer.design.outputs import outputs_of
from lightflyer.design.setup import Setup
from lightflyer.numerics.rootfind import SolverStatus
from lightflyer.program.entry_point import elementwise_entry_point, only
from lightflyer.pytree.lazy_jax import jnp
from lightflyer.statics.balance import require_converged

LEVITATION, NIGHT = "levitation_", "night_"
"""How the names of those outputs begin that are solved apart from the balance in the light."""

NIGHT_SPEED = "night_speed"  # Steady speed of sinking in the dark, of tables alone [m/s]

_FEW = 10  # places without a solution that leave a result of use, at most,
_SMALL_SHARE = 0.03  # or this share of them


def evaluate(
    setup: Setup, names: Sequence[str], coordinate: Numeric | None = None
) -> tuple[dict[str, Any], Any]:
    """Outputs of one design; to be mapped, compiled and differentiated in double precision."""
    case, known = OperatingPoint(setup, coordinate), outputs_of(setup)
    outputs = {name: jnp.asarray(known[name].value(case), float) for name in names}
    return outputs, case.converged


def tabulate(setup: Setup, coordinate: Numeric, irradiance: Numeric) -> dict[str, Any]:
    """Everything a prediction tabulates, at each coordinate under its irradiance."""
    case, known = OperatingPoint(setup, coordinate, irradiance), outputs_of(setup)
    values = {name: known[name].value(case) for name in predicted_names(setup)}
    solved: dict[str, Any] = {"": case.balance, LEVITATION: case.levitation}
    if sinks_at_night(setup):
        solved[NIGHT] = case.sinking
        values[NIGHT_SPEED] = case.sinking.speed
    for group, found in solved.items():
        values[group + "converged"] = found.converged
        values[group + "residual"] = jnp.abs(found.residual)
    return {name: value + jnp.zeros_like(coordinate) for name, value in values.items()}


tabulate_places = elementwise_entry_point(tabulate)  # The same as an entry point


def group_of(name: str) -> str:
    """What an output of a table is solved with: how its name begins."""
    return next((group for group in (LEVITATION, NIGHT) if name.startswith(group)), "")


def table_of(
    setup: Setup,
    coordinates: np.ndarray,
    irradiance: np.ndarray,
    names: Sequence[str],
    tabulated: Callable[..., dict[str, Any]] = tabulate_places,
) -> dict[str, np.ndarray]:
    """Some outputs at coordinates (n,) under irradiances (n,), NaN where they are not solved."""
    # Raises where more than a few are not. All outputs of a group are computed, not those named
    # alone: few programs then serve all questions.
    groups = {group_of(name) for name in names}
    at_night = (NIGHT_SPEED,) if sinks_at_night(setup) else ()
    known = (*predicted_names(setup), *at_night)
    asked = [name for name in known if group_of(name) in groups]
    asked += [group + ending for group in sorted(groups) for ending in ("converged", "residual")]
    table = only(tabulated, asked)(setup, coordinates, irradiance)
    solved = {group: table[group + "converged"] >= 0.5 for group in groups}
    for group, good in solved.items():
        if np.sum(~good) > max(_FEW, _SMALL_SHARE * good.size):
            status = np.where(good, int(SolverStatus.CONVERGED), int(SolverStatus.TOLERANCE_MISSED))
            require_converged("prediction", status, table[group + "residual"])
    return {
        name: table[name]
        if solved[group_of(name)].all()
        else np.where(solved[group_of(name)], table[name], np.nan)
        for name in names
    }


def predicted_names(setup: Setup) -> tuple[str, ...]:
    """Names of the outputs that a prediction tabulates: all that depend on the place alone."""
    known = outputs_of(setup).items()
    return tuple(name for name, output in known if output.needs_coordinate and not output.over_band)
