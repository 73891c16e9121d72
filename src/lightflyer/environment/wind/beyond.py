"""Wind from data where they reach, and from another wind above, below and beside them."""

from functools import reduce
from typing import Any

from lightflyer.array import tree
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import Altitude, require_record
from lightflyer.environment.atmosphere.base import AbstractAtmosphere
from lightflyer.environment.base import Place, Wind
from lightflyer.environment.wind.base import AbstractWind, Air
from lightflyer.environment.wind.gridded import TWO_KILOMETRES, GriddedWind


class WindBeyondData(AbstractWind):
    """Wind from data, which another one takes over from smoothly where they end.

    Within the last two kilometres, degree or hour of the data the other wind gains weight, up to
    all of it at their end. So does the temperature of the atmosphere. Above and below, the pressure
    keeps its ratio to the atmosphere's, as it has to in hydrostatic balance.

    Parameters
    ----------
    data : GriddedWind
    beyond : AbstractWind
        Such as a :class:`GradientWind`. It need not reach where the data do.

    Notes
    -----
    Once continuously differentiable where both winds are.
    """

    data: GriddedWind
    beyond: AbstractWind

    def __init__(self, data: GriddedWind, beyond: AbstractWind):
        require_record("data", (GriddedWind,), data)
        require_record("beyond", (AbstractWind,), beyond)
        self.data, self.beyond = data, beyond

    def velocity(self, altitude: Altitude, place: Place) -> Wind:
        return self._require_margins(altitude, place, _velocity(self, altitude, place))

    def air(self, altitude: Altitude, place: Place, atmosphere: AbstractAtmosphere) -> Air | None:
        if not self.data.has_air:
            return None
        return _air(self, altitude, place, atmosphere)

    def margins(self, altitude: Altitude, place: Place) -> dict[str, Numeric]:
        within = _within(self.data, altitude, place) - 1.0
        found = self.beyond.margins(altitude, place)
        return {name: xp.maximum(margin, within) for name, margin in found.items()}

    def share_of_data(self, altitude: Altitude, place: Place) -> Any:
        """Weight of the data in the wind [1]: one inside, zero where they end."""
        return _weight(self.data, altitude, place)

    @property
    def has_tides(self) -> bool:
        return self.data.has_tides and self.beyond.has_tides

    def describe(self) -> tuple[str, ...]:
        beyond = (text.removeprefix("wind: ") for text in self.beyond.describe())
        return (*self.data.describe(), *(f"wind beyond the data: {text}" for text in beyond))


@entry_point
def _within(data: AbstractWind, altitude: Altitude, place: Place) -> Numeric:
    """How far the nearest end of the data is, in the units of margins."""
    return reduce(xp.minimum, data.margins(altitude, place).values())


@entry_point
def _weight(data: AbstractWind, altitude: Altitude, place: Place) -> Numeric:
    return _smooth(_within(data, altitude, place))


def _smooth(within: Numeric) -> Numeric:
    share = xp.clip(within, 0.0, 1.0)
    return share**2 * (3.0 - 2.0 * share)


def _inner(lowest: float, highest: float, altitude: Altitude) -> Array:
    """The altitude, which stays within the data and slows down in their last two kilometres [m]."""

    def slowed(distance: Numeric) -> Array:
        inside = xp.clip(distance / TWO_KILOMETRES, 0.0, 1.0)
        return xp.maximum(distance, 0.5 * TWO_KILOMETRES * (1.0 + inside**2))

    return lowest + slowed(highest - slowed(highest - altitude) - lowest)


@entry_point
def _air(
    wind: WindBeyondData, altitude: Altitude, place: Place, atmosphere: AbstractAtmosphere
) -> Air:
    margins = wind.data.margins(altitude, place).items()
    sides = [margin for name, margin in margins if not name.startswith("altitude")]
    beside = _smooth(reduce(xp.minimum, sides, xp.asarray(1.0)))
    inner = _inner(*wind.data.reach.ends[1], altitude)
    data = wind.data.air(inner, place, atmosphere)
    assert data is not None
    known = beside > 0.0  # elsewhere NaN
    warmer = xp.where(known, data.temperature - atmosphere.temperature(inner, place), 0.0)
    ratio = xp.where(known, data.pressure / atmosphere.pressure(inner, place), 1.0)
    return Air(
        atmosphere.temperature(altitude, place) + _weight(wind.data, altitude, place) * warmer,
        atmosphere.pressure(altitude, place) * ratio**beside,
    )


@entry_point
def _velocity(wind: WindBeyondData, altitude: Altitude, place: Place) -> Wind:
    weight = _weight(wind.data, altitude, place)
    inner = wind.data.velocity(altitude, place)
    outer = wind.beyond.velocity(altitude, place)
    parts = (
        weight * xp.where(weight > 0.0, here, 0.0)  # NaN where a wind does not reach
        + (1.0 - weight) * xp.where(weight < 1.0, there, 0.0)
        for here, there in zip(inner, outer, strict=True)
    )
    return Wind(*parts)


def with_end_of_data(whole: Any) -> WindBeyondData | None:
    """The wind of an object, such as an environment, that another one takes over from."""
    leaves = tree.leaves(whole, is_leaf=lambda leaf: isinstance(leaf, WindBeyondData))
    return next((leaf for leaf in leaves if isinstance(leaf, WindBeyondData)), None)
