"""``[flyer]`` of a flyer file: what all its alternatives share."""

import abc
from typing import ClassVar

from lightflyer.environment.radiation import Attitude
from lightflyer.film.properties import FilmProperties
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.foundation.quantity import RADIANS_PER_DEGREE, Azimuth, Mass, Tilt
from lightflyer.foundation.section import Alternative
from lightflyer.foundation.units import Measured


class FlyerSection(Alternative, abc.ABC):
    """``[flyer]``: payload and attitude; subclasses add shape and size."""

    choosing_keys: ClassVar[tuple[tuple[str, str], ...]] = (("shape", "disk"),)
    flyer_type: ClassVar[type[AbstractFlyer]]
    """Class of the flyer that the section builds."""

    needs_film: ClassVar[bool] = True
    """Whether the file needs a section ``[film]``; a flyer of several films holds its own."""

    needs_transmittance: ClassVar[bool] = True
    """Whether it matters what passes a film: where light or heat radiation then meets another."""

    default_model: ClassVar[str] = "kinetic"
    """Force model where the file has no ``[force]``."""

    payload: Mass = Measured(0.0)
    tilt: Tilt = Measured(0.0)
    azimuth: Azimuth = Measured(0.0)

    @abc.abstractmethod
    def build(self, film: FilmProperties | None, incidence: float) -> AbstractFlyer:
        """The flyer.

        Parameters
        ----------
        film : FilmProperties or None
            What ``[film]`` says, where :attr:`needs_film`.
        incidence : float
            Of the light [rad], for the optics of layers.

        Returns
        -------
        AbstractFlyer
        """

    def attitude(self) -> Attitude | None:
        """Attitude of the flyer, None for a level one."""
        level = isinstance(self.tilt.value, float) and self.tilt.value == 0.0
        if level:
            return None
        return Attitude(
            self.tilt.value * RADIANS_PER_DEGREE, self.azimuth.value * RADIANS_PER_DEGREE
        )
