"""How a flyer lies during a mission: rules that give its attitude from the light."""

import abc
from typing import Any

import equinox as eqx
import jax.numpy as jnp

from lightflyer.core.quantity import Checked, Fraction, PolarAngle
from lightflyer.environment.radiation import Attitude, Radiation


class AbstractAttitudeRule(Checked):
    """Rule that gives the attitude of a flyer. Subclasses are final."""

    @abc.abstractmethod
    def attitude(self, radiation: Radiation, own: Attitude | None) -> Attitude | None:
        """Attitude in the light of the surroundings; ``own``: the flyer's; None means level."""

    @abc.abstractmethod
    def describe(self) -> str:
        """The rule in a few words."""


class Own(AbstractAttitudeRule):
    """The attitude that the flyer itself states, level where it states none."""

    def attitude(self, radiation: Radiation, own: Attitude | None) -> Attitude | None:
        del radiation
        return own

    def describe(self) -> str:
        return "the flyer's own, at all times"


class Level(AbstractAttitudeRule):
    """Level at all times."""

    def attitude(self, radiation: Radiation, own: Attitude | None) -> Attitude | None:
        del radiation, own
        return None

    def describe(self) -> str:
        return "level"


class FollowSun(AbstractAttitudeRule):
    r"""Tilted towards the azimuth of the sun by a share of its zenith angle, level at night.

    With half of the zenith angle the lift goes with :math:`(1+\cos z)/2` instead of
    :math:`\cos z`. The rule asks for something that turns the flyer: nothing passive does.

    Attributes
    ----------
    share : array
        Tilt over zenith angle [1].
    largest : array
        Tilt that is not exceeded [rad].

    Notes
    -----
    The tilt goes with the share of the sun's disk that the horizon does not hide. Not
    differentiable where the largest tilt is reached.
    """

    share: Fraction = 0.5
    largest: PolarAngle = 0.25 * jnp.pi

    def attitude(self, radiation: Radiation, own: Attitude | None) -> Attitude | None:
        del own
        lit = radiation.visible_part(1.0)
        tilt = jnp.minimum(self.share * radiation.zenith_angle, self.largest) * lit
        return _attitude(tilt, radiation.azimuth)

    def describe(self) -> str:
        degrees = float(self.largest) * 180.0 / jnp.pi
        return (
            f"tilted towards the sun by {float(self.share):g} of its zenith angle, at most "
            f"{degrees:g}°; level at night"
        )


def _attitude(tilt: Any, azimuth: Any) -> Attitude:
    """An attitude of traced numbers, which need no check."""
    return eqx.tree_at(
        lambda attitude: (attitude.tilt, attitude.azimuth), Attitude(), (tilt, azimuth)
    )
