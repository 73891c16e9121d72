r"""What is not known about the wind, as smooth random functions of time.

Each component is a sum of cosines with random frequencies and phases, which has the covariance
:math:`\sigma^2\exp(-t^2/2\tau^2)` over the ensemble [RahimiRecht2007]_.
"""

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from lightflyer.environment.base import Wind
from lightflyer.foundation.types import Numeric

_WAVES = 32
"""Cosines of each component: their sum is normal to 2 % of the kurtosis of one."""


class WindError(eqx.Module):
    """Difference of the wind from the environment's, along one flight.

    Attributes
    ----------
    amplitudes : array, shape (3,)
        Of one cosine of the components east, north and up [m/s].
    frequencies, phases : array, shape (3, waves)
        [rad/s], [rad].
    """

    amplitudes: Numeric
    frequencies: Numeric
    phases: Numeric

    def added(self, wind: Wind, elapsed: Numeric) -> Wind:
        """A wind with this error.

        Parameters
        ----------
        wind : Wind
        elapsed : array, shape ()
            Time since the release [s].

        Returns
        -------
        Wind
        """
        waves = jnp.cos(self.frequencies * elapsed + self.phases)
        east, north, up = self.amplitudes * jnp.sum(waves, axis=-1)
        return Wind(wind.east + east, wind.north + north, wind.up + up)


def draw_wind_errors(
    count: int, horizontal: float, vertical: float, correlation_time: float, seed: int
) -> WindError:
    """Random errors of the wind, one for each flight.

    Parameters
    ----------
    count : int
    horizontal, vertical : float
        Standard uncertainty of each horizontal component and of the vertical one [m/s].
    correlation_time : float
        [s]; infinite for an error that stays as it is.
    seed : int

    Returns
    -------
    WindError
        Every field with a leading axis of length ``count``.
    """
    generator = np.random.default_rng(seed)
    shape = (count, 3, _WAVES)
    spread = np.array([horizontal, horizontal, vertical]) * (2.0 / _WAVES) ** 0.5
    return WindError(
        amplitudes=np.broadcast_to(spread, (count, 3)),
        frequencies=generator.standard_normal(shape) / correlation_time,
        phases=generator.uniform(0.0, 2.0 * np.pi, shape),
    )
