"""Levitation: the irradiance that it takes."""

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module
from lightflyer.core.entry_point import elementwise_entry_point
from lightflyer.environment.base import EnvironmentState
from lightflyer.files.display_units import number_text
from lightflyer.files.result_text import Parts, PrintedResult, rows_of
from lightflyer.flyer.base import HIGHEST_TEMPERATURE, AbstractFlyer
from lightflyer.force.base import AbstractForceModel
from lightflyer.numerics.rootfind import SolverStatus, reach
from lightflyer.statics.balance import (
    require_converged,
    status_lines,
    status_within,
)
from lightflyer.statics.equations import FlightEquations, total
from lightflyer.statics.minimum_irradiance import LOAD_TOLERANCE, LiftOff, find_by_irradiance

HIGHEST_IRRADIANCE = 1e7
"""Irradiance above which nothing levitates [W/m²]: two black faces at the highest temperature of
the search emit a little less, so a flyer that needs more hardly absorbs its light or has melted."""


class Levitation(PrintedResult, Module):
    """Light and temperature at which a flyer just levitates.

    Fields have the broadcast shape of the inputs.
    """

    #: Smallest irradiance of the beam that carries the flyer's weight [W/m²]; infinite where none
    #: up to :data:`HIGHEST_IRRADIANCE` does, zero where thermal radiation alone suffices
    irradiance: Numeric
    #: Temperature of the hottest node at that irradiance [K]; NaN where none suffices
    temperature: Numeric
    levitates: Numeric  #: Whether any irradiance suffices
    residual: Numeric  #: Force over weight, minus one [1]
    #: Why the search ended, a :class:`~lightflyer.numerics.rootfind.SolverStatus`. That no
    #: irradiance suffices is an answer: converged
    status: Numeric

    def text_parts(self) -> Parts:
        yield rows_of(
            {
                "irradiance to levitate": number_text(self.irradiance, "W/m²"),
                "temperature then": number_text(self.temperature, "K"),
            }
        )
        yield from status_lines(self.status)

    @property
    def converged(self) -> Numeric:
        """True where the root-find met its tolerance, or found that there is no root."""
        return self.status == SolverStatus.CONVERGED


def levitate(
    flyer: AbstractFlyer,
    state: EnvironmentState,
    model: AbstractForceModel,
    *,
    throw: bool = True,
) -> Levitation:
    """Smallest irradiance at which a flyer carries its weight, and its temperature then.

    The irradiance of ``state`` has no effect; its direction and thermal surroundings do.

    Parameters
    ----------
    flyer : AbstractFlyer
    state : EnvironmentState
    model : AbstractForceModel
    throw : bool
        Raise where an element has not converged (not under JAX's transformations). A flyer
        that no irradiance lifts is an answer, not an error.

    Returns
    -------
    Levitation

    Raises
    ------
    ConvergenceError
        If an element has not converged and ``throw`` is true.
    ParameterError
        If the model is not for the flyer or the gas.

    Notes
    -----
    Differentiable in every number of flyer, state and model where the flyer levitates.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> state = lf.lu2023_earth().state(72e3)
    >>> result = lf.levitate(lf.Disk(film, radius=0.01), state, lf.Lu2023())
    >>> print(f"{result.irradiance:.3f} W/m², {result.temperature:.4f} K")
    811.018 W/m², 323.6874 K
    """
    result = _levitate(FlightEquations(flyer, state, model))
    if throw:
        require_converged("levitation", result.status, result.residual)
    return result


@elementwise_entry_point
def _levitate(equations: FlightEquations) -> Levitation:
    equations = equations.begin(with_force=True)
    if equations.has_one_unknown and not equations.lifts_unheated:
        # one node: the temperature that carries the load, then the irradiance that holds it
        def force(excess: Array) -> Array:
            return equations.upward_force((excess,))

        state, load = equations.state, equations.weight
        hottest = HIGHEST_TEMPERATURE / state.temperature - 1.0
        strongest = force(hottest)
        excess, reaches, outcome = reach(force, hottest, strongest, load)
        irradiance, collects = equations.irradiance_for(total(equations.losses((excess,))))
        found = LiftOff(
            levitates=reaches & collects,
            irradiance=irradiance,
            temperature=state.temperature * (1.0 + excess),
            residual=force(excess) / load - 1.0,
            status=outcome.status,
            strongest=strongest,
        )
    else:
        found = find_by_irradiance(equations)
    # the answer, without what belongs to stand-ins
    levitates = found.levitates & (found.irradiance <= HIGHEST_IRRADIANCE)
    residual = xp.where(levitates, found.residual, 0.0)
    status = status_within(found.status, residual, LOAD_TOLERANCE)
    status = xp.where(levitates, status, int(SolverStatus.CONVERGED))
    unknown = xp.isnan(found.strongest) | (found.levitates & xp.isnan(found.irradiance))
    return Levitation(
        irradiance=xp.where(levitates, xp.maximum(found.irradiance, 0.0), np.inf),
        temperature=xp.where(levitates, found.temperature, np.nan),
        levitates=levitates,
        residual=residual,
        status=xp.where(unknown, int(SolverStatus.NOT_FINITE), status),
    )
