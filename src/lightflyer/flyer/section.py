"""``[flyer]`` of a flyer file: what all its alternatives share."""

from typing import Any, ClassVar

from lightflyer.core.quantity import RADIANS_PER_DEGREE, Azimuth, Mass, Tilt
from lightflyer.core.units import Measured
from lightflyer.environment.radiation import Attitude
from lightflyer.files.section import Alternative
from lightflyer.film.properties import FilmProperties, FilmSection
from lightflyer.flyer.base import AbstractFlyer

_FILM = "film"


class FlyerSection(Alternative):
    """``[flyer]``: payload and attitude; subclasses add shape and size.

    A field ``film`` of the flyer is what ``[film]`` says; any other film has a section of its own,
    such as ``[flyer.top]``, after the numbers.
    """

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

    def __init_subclass__(cls, of: type[AbstractFlyer] | None = None, **options: Any) -> None:
        if of is not None:
            cls.flyer_type = of
            if "needs_film" not in vars(cls):
                cls.needs_film = _FILM in of.film_names() or not of.film_names()
        super().__init_subclass__(of=of, **options)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a reader of any result must know beside what films say, one line each."""
        return ()

    def idle(self) -> dict[str, str]:
        level = self.tilt == Measured(0.0) and self.azimuth != self.tilt
        return {"azimuth": "without tilt"} if level else {}

    @classmethod
    def keys_of(cls, described: type) -> dict[str, tuple[Any, Any]]:
        films = {name: (FilmSection, ...) for name in cls.flyer_type.film_names() if name != _FILM}
        return super().keys_of(described) | films

    def build(self, film: FilmProperties | None, incidence: float) -> AbstractFlyer:
        """The flyer; ``film``: what ``[film]`` says, where :attr:`needs_film`."""
        films = {
            name: film if name == _FILM else getattr(self, name).build(incidence)
            for name in self.flyer_type.film_names()
        }
        return self.make(**films, attitude=self.attitude())

    def attitude(self) -> Attitude | None:
        """Attitude of the flyer, None for a level one."""
        level = isinstance(self.tilt.value, float) and self.tilt.value == 0.0
        if level:
            return None
        return Attitude(
            self.tilt.value * RADIANS_PER_DEGREE, self.azimuth.value * RADIANS_PER_DEGREE
        )
