"""The flat disk of the paper."""

from collections.abc import Callable, Mapping
from typing import Any, ClassVar, Literal

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import field
from lightflyer.core.quantity import Contradictions, Distance, Mass, Radius
from lightflyer.environment.base import EnvironmentState
from lightflyer.environment.radiation import Attitude
from lightflyer.files.section import DIAMETER, Spelling
from lightflyer.film.properties import FilmProperties
from lightflyer.flyer.base import AbstractThinFlyer, FlyerSection
from lightflyer.flyer.hanging import Hanging, hangs_wrongly
from lightflyer.flyer.shape import OF_FILMS, Bent, Shape, bent_film, shape_of_film


class Disk(AbstractThinFlyer):
    """A thin flat disk of one temperature.

    Attributes
    ----------
    film : FilmProperties
    radius : array
        Radius [m].
    payload : array
        Mass carried beside the film's [kg].
    attitude : Attitude or None
        How the disk lies; None stands for level.
    hanging_radius : array or None
        Of the circle from which the payload hangs [m]; None is the middle.
    hanging : {"circle", "three points"}
        Whether it hangs all around the circle, or at three points of it.

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

    nodes: ClassVar[tuple[str, ...]] = ("film",)
    lifted_by: ClassVar[str] = "gas that leaves its bottom face with more energy than its top"
    drag_law: ClassVar[str] = "of a thin disk by the kinetic equation, with inertia"

    contradiction: ClassVar[Callable[..., Contradictions]] = staticmethod(hangs_wrongly)

    film: FilmProperties
    radius: Radius
    payload: Mass = 0.0
    attitude: Attitude | None = None
    hanging_radius: Distance | None = None
    hanging: Hanging = field(static=True, default="circle")

    @property
    def faces(self) -> tuple[FilmProperties, FilmProperties]:
        return self.film, self.film

    @property
    def own_mass(self) -> Numeric:
        return self.area * self.film.areal_density

    def beam_areas(self, state: EnvironmentState) -> tuple[Array, ...]:
        light, film = state.radiation.on_faces(self.attitude), self.film
        absorbed = film.absorptance * light.beam_top + film.absorptance_below * light.beam_bottom
        return (self.area * absorbed,)

    def heat_gains(self, state: EnvironmentState) -> tuple[Array, ...]:
        light, film = state.radiation.on_faces(self.attitude), self.film
        diffuse = (
            film.absorptance * light.diffuse_top + film.absorptance_below * light.diffuse_bottom
        )
        top, bottom = film.emittances_at(state.temperature)
        above, below = state.radiation.infrared_excess(state.temperature, self.attitude)
        return (self.area * (diffuse + top * above + bottom * below),)

    def heat_losses(self, state: EnvironmentState, unknowns: tuple[Array, ...]) -> tuple[Any, ...]:
        # .. math::
        #     A\sigma(\varepsilon_t+\varepsilon_b)\,T_c^4\,\theta(4+6\theta+4\theta^2+\theta^3)
        #
        # which is the difference of fourth powers without its cancellation; where the emittance
        # depends on temperature, that of :math:`\varepsilon T^4`.
        (excess,) = unknowns
        return (self._black_power(state) * self.film.emission_growth(state.temperature, excess),)

    @property
    def known_shape(self) -> tuple[str, ...]:
        return () if self.film.laminate is None else OF_FILMS

    def shape(
        self,
        state: EnvironmentState,
        temperatures: tuple[Array, ...],
        lift: Array,
        pressure: Numeric = 0.0,  # noqa: ARG002
    ) -> Shape:
        if self.film.laminate is None:
            return super().shape(state, temperatures, lift)
        held = self.held(state)
        return shape_of_film(self.film.laminate, self.radius, temperatures[0], held, self._tacs)

    def bent(self, state: EnvironmentState, temperatures: tuple[Array, ...]) -> Bent:
        if self.film.laminate is None:
            return super().bent(state, temperatures)
        return bent_film(self.film.laminate, self.radius, temperatures[0], self.held(state))

    def highest_excess(self, state: EnvironmentState, power: Array) -> Array:
        """Excess in vacuum [1]."""
        bound = self.film.emission_bound(state.temperature, power / self._black_power(state))
        root = xp.sqrt(xp.sqrt(xp.maximum(1.0 + bound, 0.0)))
        # solves (1 + θ)⁴ = 1 + bound without cancellation
        return xp.abs(bound / ((root + 1.0) * (root**2 + 1.0)))

    def _black_power(self, state: EnvironmentState) -> Array:
        """Power that one black face would radiate at the gas temperature [W]."""
        return self.area * state.radiation.stefan_boltzmann * state.temperature**4


class DiskSection(FlyerSection, of=Disk):
    """``[flyer]``: a disk."""

    needs_transmittance: ClassVar[bool] = False
    spelled: ClassVar[Mapping[str, Spelling]] = {"radius": DIAMETER}

    shape: Literal["disk"] = "disk"
