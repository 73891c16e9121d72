"""What a reader of a result must know: where the force model, or the film, is beyond its range."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from lightflyer.flight.balance import equilibrium
from lightflyer.flight.setup import Setup
from lightflyer.foundation.types import Numeric

UNSTATED_LIMIT = 500.0
"""Temperature above which a film without a stated highest temperature is worth a caution [K]:
polymer films shrink and melt near it."""


def cautions(setup: Setup, coordinate: Numeric, temperature: Numeric) -> tuple[str, ...]:
    """Cautions about a flyer at some places.

    Parameters
    ----------
    setup : Setup
        One flyer: every number a scalar.
    coordinate : array, shape (n,)
        Altitudes [m] or pressures [Pa], concrete.
    temperature : array, shape (n,)
        Of the flyer's hottest node there [K].

    Returns
    -------
    tuple of str
        One line each; empty where all is within range.
    """
    state = setup.environment.state(np.asarray(coordinate, float))
    return (
        *setup.model.caveats(setup.flyer, state, temperature),
        *_of_heat(setup.flyer.highest_temperature, temperature),
    )


def cautions_at(setup: Setup, coordinate: Numeric) -> tuple[str, ...]:
    """Cautions about a flyer at one place, or at some, in the available light.

    Parameters
    ----------
    setup : Setup
    coordinate : array, shape (...)
        Altitude [m] or pressure [Pa], concrete.

    Returns
    -------
    tuple of str
        See :func:`cautions`.
    """
    state = setup.environment.state(coordinate)
    found = equilibrium(setup.flyer, state, setup.model, throw=False)
    return cautions(setup, np.atleast_1d(coordinate), np.atleast_1d(found.temperature))


def _of_heat(highest: Numeric | None, temperature: Numeric) -> Iterator[str]:
    hottest = float(np.max(temperature, initial=0.0))
    if highest is None:
        if hottest > UNSTATED_LIMIT:
            yield (
                f"the flyer reaches {hottest:.0f} K: does its film bear that? state its "
                "highest_temperature"
            )
    elif hottest > float(highest):
        yield f"the flyer reaches {hottest:.0f} K, and its film bears {float(highest):.0f} K"


def cautions_of_force(table: dict[str, Any]) -> Iterator[str]:
    """Cautions about a flyer that the gas does not push up anywhere.

    Parameters
    ----------
    table : dict of str to array
        Outputs of a prediction by name.

    Yields
    ------
    str
    """
    strongest = float(np.nanmax(table["lift"]))
    if strongest < 0.0:
        yield (
            "the gas pushes the flyer down everywhere: for a thin film tac_bottom must exceed "
            "tac_top"
        )
    elif strongest == 0.0:
        yield (
            "the gas does not push the flyer: for a thin film tac_bottom must exceed tac_top, and "
            "here they are equal"
        )
