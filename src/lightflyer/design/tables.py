"""Outputs of a design in tables: at any number of coordinates at once."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from lightflyer.array.namespace import Numeric, xp
from lightflyer.core.entry_point import elementwise_entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.design.operating_point import OperatingPoint
from lightflyer.design.outputs import outputs_of
from lightflyer.design.setup import Setup
from lightflyer.numerics.rootfind import SolverStatus
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
    outputs = {name: xp.asarray(known[name].value(case), float) for name in names}
    return outputs, case.converged


def tabulate(
    setup: Setup, coordinate: Numeric, irradiance: Numeric, names: Sequence[str] = ()
) -> dict[str, Any]:
    """Outputs at each coordinate under its irradiance: those named, or all that are tabulated.

    Also, for each way in which some of them are solved, whether it has converged, and what is left.
    """
    case, known = OperatingPoint(setup, coordinate, irradiance), outputs_of(setup)
    values = {
        name: case.sinking.speed if name == NIGHT_SPEED else known[name].value(case)
        for name in names or predicted_names(setup)
    }
    solved = {"": "balance", LEVITATION: "levitation", NIGHT: "sinking"}
    for group, solution in solved.items():
        if solution in vars(case):
            found = getattr(case, solution)
            values[group + "converged"] = found.converged
            values[group + "residual"] = xp.abs(found.residual)
    shape = xp.broadcast_shapes(*(xp.shape(one) for one in (coordinate, *values.values())))
    return {name: xp.broadcast_to(value, shape) for name, value in values.items()}


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
    most: float = _SMALL_SHARE,
) -> dict[str, np.ndarray]:
    """Some outputs at coordinates (n,) under irradiances (n,), NaN where they are not solved."""
    # Raises where more than a few are not, and more than the share ``most``.
    table = tabulated(setup, coordinates, irradiance, tuple(names))
    groups = [group for group in ("", LEVITATION, NIGHT) if group + "converged" in table]
    solved = {group: table[group + "converged"] >= 0.5 for group in groups}
    if "" in solved and "lift_over_weight" in table:
        lost = solved[""] & np.isnan(table["lift_over_weight"])
        if lost.any():
            raise ParameterError(
                f"force() of {type(setup.model).__name__} gives NaN at {lost.sum()} of {lost.size} "
                "places, at temperatures that balance the heat"
            )
    for group, good in solved.items():
        if np.sum(~good) > max(_FEW, most * good.size):
            status = np.where(good, int(SolverStatus.CONVERGED), int(SolverStatus.TOLERANCE_MISSED))
            require_converged("prediction", status, table[group + "residual"])

    def known(name: str) -> np.ndarray:
        good = solved.get(group_of(name))
        return table[name] if good is None or good.all() else np.where(good, table[name], np.nan)

    return {name: known(name) for name in names}


def predicted_names(setup: Setup) -> tuple[str, ...]:
    """Names of the outputs that a prediction tabulates: all that depend on the place alone."""
    known = outputs_of(setup).items()
    return tuple(name for name, output in known if output.needs_coordinate and not output.over_band)
