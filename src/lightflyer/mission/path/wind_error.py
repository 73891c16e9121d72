r"""What is not known about the wind, as smooth random functions of time.

The horizontal error is a vector in the planet's frame, seen along the ground, so that poles are
nothing special. Each component is a sum of waves whose frequencies are normal around zero with the
width :math:`1/\tau`, and whose amplitudes are normal too. Over an ensemble it is normal with the
covariance :math:`\sigma^2\exp(-t^2/2\tau^2)` [RahimiRecht2007]_.
"""

import numpy as np

from lightflyer.array.namespace import Numeric, xp
from lightflyer.array.records import Module
from lightflyer.environment.base import Place, Wind
from lightflyer.mission.path.position import directions

_WAVES = 6  # Frequencies of one flight


class WindError(Module):
    """Difference of the wind from the environment's, along flights."""

    frequencies: Numeric  # shape (..., waves); [rad/s]
    # shape (..., 4, waves); amplitudes of the components along the axes of the planet's frame, and
    # up [m/s]
    cosines: Numeric
    sines: Numeric

    def add_to_wind(self, wind: Wind, place: Place, elapsed: Numeric) -> Wind:
        """A wind with this error; ``elapsed``: time since the release."""
        phases = self.frequencies * xp.asarray(elapsed)[..., None]
        cosine, sine = xp.cos(phases)[..., None, :], xp.sin(phases)[..., None, :]
        *along, up = xp.moveaxis(xp.sum(self.cosines * cosine + self.sines * sine, axis=-1), -1, 0)
        east, north = (
            sum(one * other for one, other in zip(along, xp.moveaxis(to, -1, 0), strict=True))
            for to in directions(place.latitude, place.longitude)
        )
        return Wind(wind.east + east, wind.north + north, wind.up + up)


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
