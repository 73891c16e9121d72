r"""Heat balance: the temperatures at which a flyer loses what it absorbs.

For every node :math:`i` of a flyer

.. math::
    L_i(\theta) \equiv Q_i(\theta) + R_i(\theta) = B_i I + G_i, \qquad
    \theta_i = \frac{T_i-T_c}{T_c}

with the heat :math:`Q_i` that the gas takes, the radiation and conduction :math:`R_i` net of what
black surroundings at the gas temperature would exchange, the light :math:`B_i I` and the other
gains :math:`G_i`. Both sides vanish together.

With one unknown the loss is close to a power law, so Newton's method is applied in logarithms of
both sides: it needs about four steps from 1e-4 Pa to 1e5 Pa. The root lies between gas temperature
and radiative equilibrium, which is a rigorous bracket for every force model whose heat loss
increases with the excess. With several unknowns the same search finds the temperature that the
flyer would have if all its nodes were equally warm; Newton's method for systems goes on from there.
"""

import math
from collections.abc import Iterator
from functools import reduce
from typing import Any

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module, field
from lightflyer.core.checks import is_concrete, is_traced
from lightflyer.core.entry_point import elementwise_entry_point
from lightflyer.core.errors import ConvergenceError
from lightflyer.environment.base import EnvironmentState
from lightflyer.files.display_units import number_text
from lightflyer.files.result_text import Parts, PrintedResult, rows_of
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel
from lightflyer.numerics.rootfind import (
    RELATIVE_TOLERANCE,
    SMALLEST_SHARE,
    RootOutcome,
    SolverStatus,
    describe_status,
    find_power_root,
    implicit_root,
)
from lightflyer.numerics.system import solve_system
from lightflyer.statics.equations import FlightEquations, total

_ROUGH = 1e-2  # Tolerance of a temperature from which a search for several unknowns begins
ENERGY_TOLERANCE = 1e-10  # Largest imbalance of a converged equilibrium, over the absorbed power


class Equilibrium(PrintedResult, Module):
    r"""A flyer's thermal equilibrium. Fields have the broadcast shape of the inputs."""

    nodes: tuple[str, ...] = field(static=True)  #: Names of the temperatures
    temperatures: tuple[Numeric, ...]  #: Temperature of each node [K]
    #: :math:`\theta_i = (T_i-T_c)/T_c` of each node [1], then the flyer's flows
    unknowns: tuple[Numeric, ...]
    #: Light absorbed, plus thermal radiation absorbed beyond that of black surroundings at the gas
    #: temperature [W]
    absorbed_power: Numeric
    gas_power: Numeric  #: Net loss to the gas, of all nodes [W]
    radiated_power: Numeric  #: Net loss by radiation, of all nodes [W]
    residual: Numeric  #: Largest imbalance of a node, over the absorbed power [1]
    status: Numeric  #: Why the search ended, a :class:`~lightflyer.numerics.rootfind.SolverStatus`

    def text_parts(self) -> Parts:
        parts = zip(self.nodes, self.temperatures, strict=True)
        yield rows_of(
            {f"temperature of {node}": number_text(one, "K") for node, one in parts}
            | {
                "absorbed power": number_text(self.absorbed_power, "W"),
                "heat to the gas": number_text(self.gas_power, "W"),
                "radiated power": number_text(self.radiated_power, "W"),
            }
        )
        yield from status_lines(self.status)

    @property
    def temperature(self) -> Numeric:
        """Temperature of the hottest node [K]."""
        return _largest(self.temperatures)

    @property
    def excess(self) -> Numeric:
        """Relative temperature excess of the hottest node [1]."""
        return _largest(self.unknowns[: len(self.nodes)])

    @property
    def converged(self) -> Numeric:
        """True where the search ended at a root and every node's imbalance is within tolerance."""
        return self.status == SolverStatus.CONVERGED

    def temperature_of(self, node: str) -> Numeric:
        """Temperature of a node by its name [K]."""
        return self.temperatures[self.nodes.index(node)]


def _largest(values: tuple[Numeric, ...]) -> Numeric:
    return reduce(xp.maximum, values)


def equilibrium(
    flyer: AbstractFlyer,
    state: EnvironmentState,
    model: AbstractForceModel,
    *,
    throw: bool = True,
) -> Equilibrium:
    """Temperatures and heat flows of a flyer in the given surroundings.

    Parameters
    ----------
    flyer : AbstractFlyer
    state : EnvironmentState
    model : AbstractForceModel
    throw : bool
        Raise where an element has not converged. Under JAX's transformations nothing can be
        raised: read ``converged``.

    Returns
    -------
    Equilibrium

    Raises
    ------
    ConvergenceError
        If an element has not converged and ``throw`` is true.
    ParameterError
        If the model is not for the flyer or the gas.

    Notes
    -----
    Differentiable in every number of flyer, state and model.

    References
    ----------
    [Lu2023]_ Eq. (17), with separate faces.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> state = lf.lu2023_earth().state(72e3)
    >>> result = lf.equilibrium(lf.Disk(film, radius=0.01), state, lf.Lu2023())
    >>> print(f"{result.temperature:.4f} K")
    382.9028 K
    """
    result = solve_equilibrium(FlightEquations(flyer, state, model))
    if throw:
        require_converged("heat balance", result.status, result.residual)
    return result


def uniform_excess(
    equations: FlightEquations, power: Array, tolerance: float = RELATIVE_TOLERANCE
) -> tuple[Array, RootOutcome]:
    """Excess at which the flyer loses a power if all its nodes are equally warm."""

    def loss(excess: Array) -> Array:
        return total(equations.losses(equations.unknowns_at(excess)))

    flyer, state = equations.flyer, equations.state
    dark = power == 0.0
    # without light there is nothing to solve; a stand-in keeps the search finite: the power that
    # the flyer's outline, if black, would radiate at the gas temperature
    stand_in = flyer.area * state.radiation.stefan_boltzmann * state.temperature**4
    target = xp.where(dark, stand_in, power)
    sign = xp.sign(target)
    highest = flyer.highest_excess(state, target)
    # the secant from zero through the highest: close where gas dominates too
    most = xp.abs(loss(sign * highest))
    secant = highest * xp.abs(target) / most
    size, outcome = find_power_root(
        lambda size: sign * loss(sign * size),
        target=xp.abs(target),
        lower=highest * SMALLEST_SHARE,
        upper=highest,
        guess=secant,
        tolerance=tolerance,
        known=(highest, most),
    )
    return xp.where(dark, 0.0, sign * size), outcome


def imbalances(
    found: tuple[tuple[Array, ...], ...], powers: tuple[Array, ...], size: Array
) -> tuple[Array, ...]:
    """What vanishes where each node loses what it absorbs: heat over a power, then flows [1].

    ``found``: of :meth:`FlightEquations.balance`; ``size``: of :func:`largest_power` [W].
    """
    gas, own, flows = found
    parts = zip(gas, own, powers, strict=True)
    return *((taken + given - power) / size for taken, given, power in parts), *flows


def largest_power(powers: tuple[Array, ...]) -> Array:
    """What imbalances are measured by [W]."""
    size = total(tuple(xp.abs(power) for power in powers))
    return xp.where(size == 0.0, 1.0, size)


def solve_balance(
    equations: FlightEquations,
    powers: tuple[Array, ...],
    guess: tuple[Array, ...] | None = None,
    tolerance: float | Array = RELATIVE_TOLERANCE,
) -> tuple[tuple[Array, ...], RootOutcome]:
    """Unknowns at which each node loses what it absorbs; ``powers``: that [W]."""

    def residual(
        unknowns: tuple[Array, ...], equations: FlightEquations, powers: Any, size: Array
    ) -> tuple[Array, ...]:
        return imbalances(equations.balance(unknowns), powers, size)

    def equally_warm(tolerance: float = RELATIVE_TOLERANCE) -> tuple[Array, RootOutcome]:
        return uniform_excess(equations, total(powers), tolerance)

    given = equations, powers, largest_power(powers)
    if equations.has_one_unknown:
        excess, outcome = implicit_root(lambda one: residual((one,), *given)[0], equally_warm)
        return (excess,), outcome
    flyer = equations.flyer
    # no temperature falls to absolute zero; flows have no such bound
    lower = (-1.0,) * len(flyer.nodes) + (-math.inf,) * len(flyer.flows)
    return solve_system(
        residual,
        guess or (lambda: flyer.first_guess(equations.state, equally_warm(_ROUGH)[0])),
        given,
        lower=lower,
        tolerance=tolerance,
    )


@elementwise_entry_point
def solve_equilibrium(equations: FlightEquations) -> Equilibrium:
    """Temperatures and heat flows, converged or not."""
    equations = equations.begin()
    flyer, state = equations.flyer, equations.state
    powers = equations.powers(state.radiation.irradiance)
    unknowns, outcome = solve_balance(equations, powers)
    gas, own, _ = found = equations.balance(unknowns)
    missed = imbalances(found, powers, largest_power(powers))
    worst = reduce(lambda a, b: xp.where(xp.abs(b) > xp.abs(a), b, a), missed)
    return Equilibrium(
        nodes=flyer.nodes,
        temperatures=tuple(
            state.temperature * (1.0 + excess) for excess in unknowns[: len(flyer.nodes)]
        ),
        unknowns=unknowns,
        absorbed_power=total(powers),
        gas_power=total(gas),
        radiated_power=total(own),
        residual=worst,
        status=status_within(outcome.status, worst, ENERGY_TOLERANCE),
    )


def status_within(status: Array, residual: Array, tolerance: float) -> Array:
    """A status, corrected where the residual does not bear it out."""
    kept = xp.where(xp.abs(residual) <= tolerance, status, int(SolverStatus.TOLERANCE_MISSED))
    kept = xp.where(status == int(SolverStatus.CONVERGED), kept, status)
    return xp.where(xp.isnan(residual), int(SolverStatus.NOT_FINITE), kept)


def status_lines(status: Numeric) -> Iterator[str]:
    """A warning where concrete searches have not converged."""
    if is_concrete(status) and np.any(np.asarray(status) != int(SolverStatus.CONVERGED)):
        yield f"warning: not converged: {describe_status(status)}"


def require_converged(what: str, status: Numeric, residual: Numeric) -> None:
    """Raise unless every concrete element converged; ``status``: why each search ended."""
    if is_traced(status):
        return
    failed = np.asarray(status) != int(SolverStatus.CONVERGED)
    if not np.any(failed):
        return
    residuals = np.abs(np.broadcast_to(residual, failed.shape)[failed])
    worst = np.nanmax(residuals) if np.any(np.isfinite(residuals)) else math.nan
    why = describe_status(np.asarray(status)[failed])
    raise ConvergenceError(
        f"{what}: {failed.sum()} of {failed.size} not converged ({why}), largest relative residual "
        f"{worst:.2g}; check that inputs are finite, and that heat_loss() and force() of the model "
        "give numbers, the first of which increase with temperature; or pass throw=False and read "
        "`converged`"
    )
