r"""Heat balance: the temperature at which a flyer loses what it absorbs.

One residual serves the whole package:

.. math::
    L(\theta) \equiv Q_c(\theta)
      + A\sigma(\varepsilon_t+\varepsilon_b)\,(T_h^4-T_c^4) = P, \qquad
    \theta = \frac{T_h-T_c}{T_c}

with the absorbed power :math:`P` net of what black surroundings at the gas temperature would
exchange. Both sides vanish together and the loss is close to a power law, so Newton's method is
applied in logarithms of both: it needs about four steps from 1e-4 Pa to 1e5 Pa. The root lies
between gas temperature and radiative equilibrium, which is a rigorous bracket for every force
model whose heat loss increases with the excess.
"""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jax import Array

from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel
from lightflyer.foundation.errors import ConvergenceError
from lightflyer.foundation.precision import elementwise_entry_point, is_traced
from lightflyer.foundation.rootfind import RootStatus, bracketed_power_newton, implicit_root
from lightflyer.foundation.types import Numeric

SMALLEST_SHARE = 1e-26
"""Lower end of a bracket, over its upper end: far below any flyer's excess."""

ENERGY_TOLERANCE = 1e-10
"""Largest imbalance of a converged equilibrium, over the absorbed power."""


class Equilibrium(eqx.Module):
    r"""A flyer's thermal equilibrium. Fields have the broadcast shape of the inputs.

    Attributes
    ----------
    temperature : array
        Temperature of the flyer [K].
    excess : array
        :math:`\theta = (T_h-T_c)/T_c` [1].
    absorbed_power : array
        Light absorbed, plus thermal radiation absorbed beyond that of black surroundings at
        the gas temperature [W].
    gas_power, radiated_power : array
        Net loss to the gas and by radiation [W].
    residual : array
        Absorbed minus lost power, over the absorbed power [1].
    converged : bool array
        Whether the root-find ended and the residual is below :data:`ENERGY_TOLERANCE`.
    """

    temperature: Numeric
    excess: Numeric
    absorbed_power: Numeric
    gas_power: Numeric
    radiated_power: Numeric
    residual: Numeric
    converged: Numeric


def equilibrium(
    flyer: AbstractFlyer,
    state: EnvironmentState,
    model: AbstractForceModel,
    *,
    throw: bool = True,
) -> Equilibrium:
    """Temperature and heat flows of a flyer in the given surroundings.

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
    result = _equilibrium(flyer, state, model)
    if throw:
        require_converged("heat balance", result.converged, result.residual)
    return result


def absorbed_power(flyer: AbstractFlyer, state: EnvironmentState) -> Array:
    """Light and excess heat radiation absorbed by a flyer [W].

    Parameters
    ----------
    flyer : AbstractFlyer
    state : EnvironmentState

    Returns
    -------
    array, broadcast shape
    """
    light = state.radiation.irradiance * beam_area(flyer, state)
    return light + infrared_power(flyer, state)


def beam_area(flyer: AbstractFlyer, state: EnvironmentState) -> Array:
    """Absorbed light per irradiance of the beam [m²]."""
    film = flyer.film
    return flyer.area * state.radiation.beam_power(film.absorptance, film.absorptance_below)


def infrared_power(flyer: AbstractFlyer, state: EnvironmentState) -> Array:
    """Heat radiation absorbed beyond that of black surroundings at the gas temperature [W]."""
    top, bottom = flyer.film.emittances_at(state.temperature)
    return flyer.area * state.radiation.infrared_excess(state.temperature, top, bottom)


def radiated_power(flyer: AbstractFlyer, state: EnvironmentState, excess: Numeric) -> Array:
    r"""Net radiation of both faces to black surroundings at the gas temperature [W].

    .. math:: A\sigma(\varepsilon_t+\varepsilon_b)\,T_c^4\,\theta(4+6\theta+4\theta^2+\theta^3)

    which is the difference of fourth powers without its cancellation; where the emittance
    depends on temperature, that of :math:`\varepsilon T^4`.
    """
    growth = flyer.film.emission_growth(state.temperature, excess)
    return _blackbody_power(flyer, state) * growth


def _blackbody_power(flyer: AbstractFlyer, state: EnvironmentState) -> Array:
    """What one black face would radiate at the gas temperature [W]."""
    return flyer.area * state.radiation.stefan_boltzmann * state.temperature**4


def total_loss(
    flyer: AbstractFlyer, state: EnvironmentState, model: AbstractForceModel, excess: Numeric
) -> Array:
    """Heat lost to gas and by radiation at a relative temperature excess [W]."""
    gas = model.heat_loss(flyer, state, excess)
    return gas + radiated_power(flyer, state, excess)


def _radiative_excess(power_ratio: Array) -> Array:
    """Excess in vacuum: solves (1 + θ)⁴ = 1 + ``power_ratio`` without cancellation."""
    root = jnp.sqrt(jnp.sqrt(jnp.maximum(1.0 + power_ratio, 0.0)))
    return power_ratio / ((root + 1.0) * (root**2 + 1.0))


def _solve_excess(
    flyer: AbstractFlyer, state: EnvironmentState, model: AbstractForceModel, power: Array
) -> tuple[Array, RootStatus]:
    """Relative temperature excess at which the flyer loses ``power`` [W]."""

    def loss(excess: Array) -> Array:
        return total_loss(flyer, state, model, excess)

    def search() -> tuple[Array, RootStatus]:
        dark = power == 0.0
        # without light there is nothing to solve; a stand-in keeps the search finite
        black = _blackbody_power(flyer, state)
        target = jnp.where(dark, black, power)
        sign = jnp.sign(target)
        bound = flyer.film.emission_bound(state.temperature, target / black)
        vacuum = jnp.abs(_radiative_excess(bound))
        # the secant from zero through the vacuum temperature: close where gas dominates too
        secant = vacuum * jnp.abs(target / loss(sign * vacuum))
        size, status = bracketed_power_newton(
            lambda size: sign * loss(sign * size),
            target=jnp.abs(target),
            lower=vacuum * SMALLEST_SHARE,
            upper=vacuum,
            guess=secant,
        )
        return jnp.where(dark, 0.0, sign * size), status

    shape = jnp.shape(jnp.asarray(power) + loss(jnp.zeros(())))
    return implicit_root(lambda excess: loss(excess) - power, search, shape)


@elementwise_entry_point
def _equilibrium(
    flyer: AbstractFlyer, state: EnvironmentState, model: AbstractForceModel
) -> Equilibrium:
    power = absorbed_power(flyer, state)
    excess, status = _solve_excess(flyer, state, model, power)
    gas = model.heat_loss(flyer, state, excess)
    radiated = radiated_power(flyer, state, excess)
    residual = (power - gas - radiated) / jnp.where(power == 0.0, 1.0, jnp.abs(power))
    return Equilibrium(
        temperature=state.temperature * (1.0 + excess),
        excess=excess,
        absorbed_power=power,
        gas_power=gas,
        radiated_power=radiated,
        residual=residual,
        converged=status.converged & (jnp.abs(residual) <= ENERGY_TOLERANCE),
    )


def require_converged(what: str, converged: Numeric, residual: Numeric) -> None:
    """Raise unless every concrete element converged.

    Parameters
    ----------
    what : str
        What was being solved, for the message.
    converged : bool array
    residual : array
        Scaled residual of each element.

    Raises
    ------
    ConvergenceError
        With the number of elements and the largest residual.
    """
    if is_traced(converged) or np.all(converged):
        return
    failed = ~np.asarray(converged)
    residuals = np.abs(np.broadcast_to(residual, failed.shape)[failed])
    worst = np.nanmax(residuals) if np.any(np.isfinite(residuals)) else np.nan
    raise ConvergenceError(
        f"{what}: {failed.sum()} of {failed.size} not converged, largest relative residual "
        f"{worst:.2g}; check that inputs are finite and that the force model's heat loss "
        "increases with temperature, or pass throw=False and read `converged`"
    )
