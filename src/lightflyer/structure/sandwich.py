"""Two films that ligaments hold apart, as one plate."""

import math
from typing import Literal

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import field
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import Checked, Contradictions, Length, Modulus, Thickness
from lightflyer.structure.laminate import Stiffness

_CLAMPED_BUCKLING = 3.831705970207512**2
_CELL = {"hexagonal": 0.5 * math.sqrt(3.0), "square": 1.0}  # area over the square of the spacing


class Ligaments(Checked):
    """Hollow posts in a regular pattern that hold two films apart.

    Attributes
    ----------
    spacing : array
        Between the middles of neighbours [m].
    radius : array
        Of a post [m].
    wall : array
        Thickness of its wall [m].
    pattern : {"hexagonal", "square"}
    modulus : array
        Young's modulus of the wall [Pa].

    Raises
    ------
    ParameterError
        If a concrete number is impossible, posts touch each other, or walls are too thick.

    References
    ----------
    [Kim2023]_
    """

    spacing: Length
    radius: Length
    wall: Thickness
    pattern: Literal["hexagonal", "square"] = field(static=True, default="hexagonal")
    modulus: Modulus = 1.4e11  # alumina, as in data/mechanics.toml

    @staticmethod
    def contradiction(spacing: Numeric, radius: Numeric, wall: Numeric) -> Contradictions:
        """How sizes contradict each other."""
        touch = 2.0 * radius >= spacing
        yield touch, "ligaments touch each other: their spacing must exceed their diameter"
        filled = wall > radius
        yield (
            filled,
            "ligaments have no room for their walls: diameter must be twice the wall or more",
        )

    @property
    def number_density(self) -> Numeric:
        """Posts per area [1/m²]."""
        return 1.0 / (_CELL[self.pattern] * self.spacing**2)

    @property
    def fraction(self) -> Numeric:
        """Share of the area that the walls' section takes [1]."""
        return 2.0 * math.pi * self.radius * self.wall * self.number_density

    @property
    def covered(self) -> Numeric:
        """Share of the area that the posts take with what is within them [1]."""
        return math.pi * self.radius**2 * self.number_density

    @property
    def cell_radius(self) -> Numeric:
        """Radius of a circle of a post's share of the area [m]."""
        return xp.sqrt(1.0 / (math.pi * self.number_density))

    @property
    def free_radius(self) -> Numeric:
        """Radius of the widest circle that fits between posts [m]."""
        far = {"hexagonal": 1.0 / math.sqrt(3.0), "square": math.sqrt(0.5)}[self.pattern]
        return far * self.spacing - self.radius


@entry_point
def sandwich_stiffness(top: Stiffness, bottom: Stiffness, distance: Numeric) -> Stiffness:
    """Stiffness of two films whose distance stays [m]; neutral: over the lower film's own."""

    def bending(over: Numeric, under: Numeric, own: Numeric) -> Numeric:
        return own + over * under / (over + under) * distance**2

    return Stiffness(
        top.stretching + bottom.stretching,
        bending(top.stretching, bottom.stretching, top.bending + bottom.bending),
        top.shearing + bottom.shearing,
        bending(top.shearing, bottom.shearing, top.twisting + bottom.twisting),
        distance * top.stretching / (top.stretching + bottom.stretching),
    )


@entry_point
def root_stiffness(ligaments: Ligaments, film: Stiffness) -> Array:
    r"""Moment over angle at which a film holds the end of a post [N m]."""
    # .. math:: k = \frac{4\pi D}{\ln(1/\rho) - (1-\rho^2)(3-\rho^2)/4}, \qquad \rho = a/b
    #
    # of a rigid boss in a round plate whose deflection and sum of curvatures vanish at the cell's
    # radius b, as they do halfway to posts that turn alike: 2 % from finite elements of a square
    # cell (studies/structure).
    share = ligaments.radius / ligaments.cell_radius
    open_ring = -xp.log(share) - 0.25 * (1.0 - share**2) * (3.0 - share**2)
    return 4.0 * math.pi * film.plate / open_ring


@entry_point
def ligament_shear_stiffness(
    ligaments: Ligaments, height: Numeric, top: Stiffness, bottom: Stiffness
) -> Array:
    r"""Shear force over shear angle, per width, of two films on posts [N/m]."""
    # A post is a beam; the films that hold its ends give way:
    #
    # .. math:: \frac nS = \frac{h}{12EI} + \frac14\left(\frac1{k_t} + \frac1{k_b}\right),
    #     \qquad I = \pi r^3 t
    inertia = math.pi * ligaments.radius**3 * ligaments.wall
    posts = height / (12.0 * ligaments.modulus * inertia)
    roots = 0.25 / root_stiffness(ligaments, top) + 0.25 / root_stiffness(ligaments, bottom)
    return ligaments.number_density / (posts + roots)


@entry_point
def root_moment(ligaments: Ligaments) -> Array:
    r"""Moment per width in a film at the end of a post, over the shear force per width [m]."""
    # Of the shear force Q the film at either end of a post bends by M = Q/(2n), which at the
    # post's edge, in the solution of :func:`root_stiffness`, is
    #
    # .. math:: M_r = \frac{(1-\rho^2)M}{2\pi a}
    share = ligaments.radius / ligaments.cell_radius
    around = 4.0 * math.pi * ligaments.radius * ligaments.number_density
    return (1.0 - share**2) / around


@entry_point
def dimpling_load(radius: Numeric, film: Stiffness) -> Array:
    """Compression alike in all directions at which a film buckles within a held circle [N/m]."""
    # The first zero of the Bessel function J₁, squared, D/b² [TimoshenkoWoinowskyKrieger1959].
    return _CLAMPED_BUCKLING * film.plate / radius**2
