"""A disk in a chamber: its film, and floor, lid and side wall, each solid or a reservoir."""

from dataclasses import dataclass, fields

from lightflyer.array.records import ShortRepr
from lightflyer.core.checks import require_range
from lightflyer.core.errors import ParameterError
from lightflyer.kinetic_theory.walls import CERCIGNANI_LAMPIS, Accommodation, Wall

SURFACES = ("floor", "lid", "side")  # Surfaces of a chamber; ``side`` is the side wall
NEAREST = 0.1  # Smallest height of a disk above a floor, or below a lid [disk radii]
NEAREST_SIDE = 1.2  # Smallest radius of a side wall [disk radii]
TALLEST = 8.0  # Largest height of floor or lid, over the radius of the side wall


@dataclass(frozen=True)
class Surface(ShortRepr):
    """Floor, lid or side wall of a chamber."""

    distance: float  #: From the disk's centre [disk radii]
    #: Whether as many molecules leave as arrive. Otherwise it is the end of a reservoir: gas at
    #: rest enters at the pressure far away and T_c
    solid: bool = True
    #: T/T_c − 1; in the linear problem in the unit of the disk's perturbation. 0 at a reservoir
    temperature: float = 0.0
    #: Thermal accommodation coefficient: all molecules leave diffusely, at T_c plus this share of
    #: the way from the temperature of those that arrive to that of the wall
    tac: float = 1.0


@dataclass(frozen=True)
class Chamber(ShortRepr):
    """A cylinder around the disk, coaxial with it, with the disk at any height.

    Surfaces may be given as distances [disk radii]; they are then solid, at T_c, and accommodate
    completely.

    Attributes
    ----------
    floor, lid, side : Surface
        Below and above the disk, and the side wall.

    Examples
    --------
    >>> from lightflyer.kinetic_theory import Chamber, Surface
    >>> chamber = Chamber(floor=2.25, lid=Surface(4.0, solid=False), side=4.0)
    >>> chamber.floor.solid, chamber.is_closed
    (True, False)
    """

    floor: Surface
    lid: Surface
    side: Surface

    def __init__(
        self, floor: "Surface | float", lid: "Surface | float", side: "Surface | float"
    ) -> None:
        for name, given in zip(SURFACES, (floor, lid, side), strict=True):
            surface = given if isinstance(given, Surface) else Surface(float(given))
            object.__setattr__(self, name, surface)
        for name, least in zip(SURFACES, (NEAREST, NEAREST, NEAREST_SIDE), strict=True):
            surface = getattr(self, name)
            require_range(name, surface.distance, least)
            require_range(f"{name}_tac", surface.tac, 0.0, 1.0)
            require_range(f"{name}_temperature", surface.temperature, -1.0, open_below=True)
            if not surface.solid and surface.temperature != 0.0:
                raise ParameterError(
                    f"{name}_temperature = {surface.temperature:g}: a reservoir is at T_c"
                )
        for name in ("floor", "lid"):
            highest = TALLEST * self.side.distance
            require_range(name, getattr(self, name).distance, NEAREST, highest)

    @property
    def surfaces(self) -> dict[str, Surface]:
        """Surfaces by name."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @property
    def is_closed(self) -> bool:
        """Whether no gas enters or leaves."""
        return all(surface.solid for surface in self.surfaces.values())

    @property
    def ceilings(self) -> tuple[float, float]:
        """Height of lid and floor above and below the disk [disk radii]."""
        return self.lid.distance, self.floor.distance

    @property
    def furthest(self) -> float:
        """Largest distance of a surface [disk radii]."""
        return max(surface.distance for surface in self.surfaces.values())

    @property
    def title(self) -> str:
        """The chamber in words."""
        parts = []
        for name, surface in self.surfaces.items():
            kind = "" if surface.solid else " (reservoir)"
            warm = f" at {surface.temperature:+g}" if surface.temperature else ""
            parts.append(f"{name} {surface.distance:g}{kind}{warm}")
        return ", ".join(parts) + " radii away"


@dataclass(frozen=True)
class Film:
    """The disk; pairs are top, bottom, and temperatures perturbations."""

    tac: tuple[float, float]
    # Of each face; with ``local`` the mean of the first is that of the film
    temperature: tuple[float, float]
    wall: Wall = "maxwell"
    # Whether each spot of the film balances the heat that it absorbs and loses, with the same
    # temperature on both sides and no conduction along it
    local: bool = False
    # Heat that the film radiates per unit area and perturbation [p √(2RT_c)]
    radiation: float = 0.0
    velocity: float = 0.0  # Upwards [√(2RT_c)]
    # Heat that each spot of a ``local`` film absorbs [p √(2RT_c)]; its mean temperature follows
    absorbed: float | None = None
    # Faces of Cercignani and Lampis, in place of ``wall``
    scattering: tuple[Accommodation, Accommodation] | None = None

    @property
    def wall_name(self) -> str:
        """Walls, by the name that they are given."""
        return CERCIGNANI_LAMPIS if self.scattering else self.wall

    def diffuse_share(self, face: int) -> float:
        """Share of the molecules meeting a face that leave it diffusely [1]."""
        return self.tac[face] if self.wall == "maxwell" else 1.0
