"""The flat disk of the paper."""

import jax.numpy as jnp

from lightflyer.film.properties import FilmProperties
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.foundation.checks import require_positive, require_range
from lightflyer.foundation.types import Numeric


class Disk(AbstractFlyer):
    """A thin horizontal disk.

    Attributes
    ----------
    film : FilmProperties
    radius : array
        [m].
    payload : array
        Mass carried beside the film's [kg].

    Raises
    ------
    ParameterError
        If a concrete radius is not positive or a concrete payload is negative.

    Examples
    --------
    >>> film = FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> print(f"{Disk(film, radius=0.01).own_mass * 1e6:.4f} mg")
    0.3142 mg
    """

    film: FilmProperties
    radius: Numeric
    payload: Numeric = 0.0

    def __check_init__(self) -> None:
        require_positive(radius=self.radius)
        require_range("payload", self.payload, 0.0)

    @property
    def area(self) -> Numeric:
        """Area of one face [m²]."""
        return jnp.pi * self.radius**2

    @property
    def own_mass(self) -> Numeric:
        """Mass of the film [kg]."""
        return self.area * self.film.areal_density
