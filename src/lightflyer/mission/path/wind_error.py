r"""What is not known about the wind, as smooth random functions of time.

The horizontal error is a vector in the planet's frame, seen along the ground, so that poles are
nothing special. Each component is a sum of waves whose frequencies are normal around zero with the
width :math:`1/\tau`, and whose amplitudes are normal too. Over an ensemble it is normal with the
covariance :math:`\sigma^2\exp(-t^2/2\tau^2)` [RahimiRecht2007]_.
"""

import numpy as np

from lightflyer.core.types import Numeric
from lightflyer.environment.base import Place, Wind
from lightflyer.mission.path.position import directions
from lightflyer.pytree.lazy_jax import jnp
from lightflyer.pytree.module import Module

_WAVES = 6  # Frequencies of one flight


class WindError(Module):
    """Difference of the wind from the environment's, along one flight."""

    frequencies: Numeric  # shape (waves,); [rad/s]
    # shape (4, waves); amplitudes of the components along the axes of the planet's frame, and up
    # [m/s]
    cosines: Numeric
    sines: Numeric

    def add_to_wind(self, wind: Wind, place: Place, elapsed: Numeric) -> Wind:
        """A wind with this error; ``elapsed``: time since the release."""
        phases = self.frequencies * elapsed
        waves = self.cosines * jnp.cos(phases) + self.sines * jnp.sin(phases)
        *along, up = jnp.sum(waves, axis=-1)
        to_east, to_north = directions(place.latitude, place.longitude)
        error = jnp.stack(along)
        return Wind(
            wind.east + jnp.dot(error, to_east),
            wind.north + jnp.dot(error, to_north),
            wind.up + up,
        )


def draw_wind_errors(
    count: int, horizontal: float, vertical: float, correlation_time: float, seed: int
) -> WindError:
    """Random errors of the wind, one for each flight."""
    generator = np.random.default_rng(seed)
    spread = np.array([horizontal] * 3 + [vertical])[:, None] / _WAVES**0.5
    return WindError(
        generator.standard_normal((count, _WAVES)) / correlation_time,
        spread * generator.standard_normal((count, 4, _WAVES)),
        spread * generator.standard_normal((count, 4, _WAVES)),
    )
