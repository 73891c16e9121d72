"""What every flyer must give to the heat balance and the force models."""

import abc

import equinox as eqx

from lightflyer.film.properties import FilmProperties
from lightflyer.foundation.types import Numeric


class AbstractFlyer(eqx.Module):
    """A body of one temperature with a top and a bottom face. Subclasses are final.

    Attributes
    ----------
    film : FilmProperties
    radius : array
        Radius, or that of the disk it behaves like: the length of continuum flow [m].
    payload : array
        Mass carried beside the flyer's own [kg].
    """

    film: eqx.AbstractVar[FilmProperties]
    radius: eqx.AbstractVar[Numeric]
    payload: eqx.AbstractVar[Numeric]

    @property
    @abc.abstractmethod
    def area(self) -> Numeric:
        """Area of one face [m²]."""

    @property
    @abc.abstractmethod
    def own_mass(self) -> Numeric:
        """Mass without payload [kg]."""

    @property
    def mass(self) -> Numeric:
        """Mass with payload [kg]."""
        return self.own_mass + self.payload
