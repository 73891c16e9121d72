r"""Films of several layers as plates: what stretches, bends and curls them.

Layers are isotropic and elastic. What is equal in all directions of the plane then separates
exactly from what differs between two of them: the first meets the moduli :math:`E/(1-\nu)` of the
layers, the second :math:`E/(1+\nu)`. Stoney's formula and Timoshenko's of two strips are limits.
"""

from collections.abc import Callable
from functools import reduce
from typing import NamedTuple

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module, field, short_repr
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import Checked, Expansion, Modulus, PoissonRatio, Stress, Thickness

_ALIKE, _APART = -1.2, -1.77  # powers of the solid share, of stresses alike and apart


@entry_point
def perforated_share(open_fraction: Numeric) -> Array:
    r"""Stiffness of a film with round holes over that of a whole one [1]."""
    # .. math:: \frac{1-\beta}{1+2\beta}
    #
    # The bound of isotropic films by Hashin and Shtrikman, which holes in a triangular pattern
    # nearly reach; it does not depend on Poisson's ratio. Source: [Hashin1965]_
    return (1.0 - xp.asarray(open_fraction)) / (1.0 + 2.0 * open_fraction)


@entry_point
def tension_at_holes(first: Numeric, second: Numeric, open_fraction: Numeric) -> Array:
    r"""Largest tension in a film [Pa], whose whole parts would have two principal stresses [Pa]."""
    # .. math:: \sigma = \frac{1-\beta}{1+2\beta}\left(\frac{\sigma_1+\sigma_2}{(1-\beta)^{1.2}}
    #     + \frac{2|\sigma_1-\sigma_2|}{(1-\beta)^{1.77}}\right)
    #
    # At a lone hole Kirsch's 3σ₁ - σ₂. The powers are fitted to finite elements of holes in a
    # triangular pattern (studies/structure): 4 % too much to 1.5 % too little up to β = 0.6.
    # Corners of slots have more.
    share, larger = xp.asarray(open_fraction), xp.maximum(first, second)
    solid = 1.0 - share
    alike, apart = first + second, 2.0 * xp.abs(first - second)
    peak = alike * solid**_ALIKE + apart * solid**_APART
    return xp.where(share > 0.0, perforated_share(share) * peak, larger)


ROOM_TEMPERATURE = 293.15  # at which stresses of layers are stated [K]


class Lamina(Checked):
    """A layer of a film as a structure.

    Attributes
    ----------
    thickness : array
        [m].
    modulus : array
        Young's modulus [Pa].
    poisson : array
        Poisson's ratio [1].
    expansion : array
        Linear thermal expansion [1/K].
    stress : array
        Stress in the plane at 293.15 K while the film is held flat at the length of its unstressed
        layers [Pa]; tension is positive.
    strength : array or None
        Tension at which the layer breaks or yields [Pa]; None where it is not known.

    Raises
    ------
    ParameterError
        If a concrete number is impossible.
    """

    thickness: Thickness
    modulus: Modulus
    poisson: PoissonRatio
    expansion: Expansion = 0.0
    stress: Stress = 0.0
    strength: Modulus | None = None


class Laminate(Module):
    """A film as a structure: its layers, top to bottom."""

    layers: tuple[Lamina, ...] = field(converter=tuple)

    @property
    def heights(self) -> list[Array]:
        """Height of the middle of each layer over the bottom face [m]."""
        found, below = [], xp.zeros(())
        for layer in reversed(self.layers):
            found.append(below + 0.5 * layer.thickness)
            below = below + layer.thickness
        return found[::-1]


class Stiffness(NamedTuple):
    """Resistance of a film to strain and curvature that are alike, or opposite, in the plane."""

    stretching: Numeric  #: Tension over a strain alike in all directions [N/m]
    bending: Numeric  #: Moment over a curvature alike in all directions [N m]
    shearing: Numeric  #: Tension over strains opposite in two directions [N/m]
    twisting: Numeric  #: Moment over curvatures opposite in two directions [N m]
    neutral: Numeric  #: Height over the bottom face at which bending strains nothing [m]

    def __repr__(self) -> str:
        return short_repr(self)

    @property
    def plate(self) -> Numeric:
        r"""Bending stiffness :math:`D` of plate theory [N m]."""
        return 0.5 * (self.bending + self.twisting)

    @property
    def poisson(self) -> Numeric:
        """Poisson's ratio of the plate in bending [1]."""
        return (self.bending - self.twisting) / (self.bending + self.twisting)

    @property
    def membrane(self) -> Numeric:
        r"""Tension over strain in one direction, :math:`Et` of one layer [N/m]."""
        return 2.0 / (1.0 / self.stretching + 1.0 / self.shearing)


@entry_point
def laminate_stiffness(film: Laminate) -> Stiffness:
    """Stiffness of a film of layers."""
    alike, bending, neutral = _moments(film, _biaxial)
    opposite, twisting, _ = _moments(film, _shear)
    return Stiffness(alike, bending, opposite, twisting, neutral)


@entry_point
def flat_load(film: Laminate, temperature: Numeric) -> tuple[Array, Array]:
    """Tension [N/m] and moment [N] that hold a film flat at its length at 293.15 K.

    The moment, about the neutral height, is positive where the top is in tension.
    """
    neutral = laminate_stiffness(film).neutral
    tension = moment = xp.zeros(())
    for layer, height in zip(film.layers, film.heights, strict=True):
        force = _held_stress(layer, temperature) * layer.thickness
        tension, moment = tension + force, moment + force * (height - neutral)
    return tension, moment


@entry_point
def free_curvature(film: Laminate, temperature: Numeric) -> Array:
    """Curvature of a small free film, alike in all directions [1/m]; its edge rises if positive."""
    # An exact result of linear theory. Source: [FreundSuresh2003]_ ch. 2.
    _, moment = flat_load(film, temperature)
    return moment / laminate_stiffness(film).bending


@entry_point
def free_strain(film: Laminate, temperature: Numeric) -> Array:
    """Strain of a free film at its neutral height, from its length at 293.15 K [1]."""
    return -flat_load(film, temperature)[0] / laminate_stiffness(film).stretching


@entry_point
def layer_stresses(
    film: Laminate,
    temperature: Numeric,
    strains: tuple[Numeric, Numeric],
    curvatures: tuple[Numeric, Numeric],
    open_fraction: Numeric = 0.0,
) -> tuple[Array, ...]:
    """Largest tension in each layer, by principal strains [1] and curvatures of the film [Pa].

    With an ``open_fraction`` the film has holes, and the tension is that at their edges.
    """
    # The strains are those at the neutral height, [1/m] of the curvatures in the same order.
    neutral = laminate_stiffness(film).neutral
    found = []
    for layer, height in zip(film.layers, film.heights, strict=True):
        held = _held_stress(layer, temperature)
        in_plane = layer.modulus / (1.0 - layer.poisson**2)
        ends = []
        for side in (-0.5, 0.5):
            # an edge that rises shortens what is above the neutral height
            arm = height + side * layer.thickness - neutral
            one, other = (
                strain - curvature * arm
                for strain, curvature in zip(strains, curvatures, strict=True)
            )
            stresses = (
                held + in_plane * (one + layer.poisson * other),
                held + in_plane * (other + layer.poisson * one),
            )
            ends.append(tension_at_holes(*stresses, open_fraction))
        found.append(reduce(xp.maximum, ends))
    return tuple(found)


@entry_point
def bending_stresses(film: Laminate) -> tuple[Array, ...]:
    """Stress at the further face of each layer over a curvature in one direction [Pa m]."""
    neutral = laminate_stiffness(film).neutral
    return tuple(
        layer.modulus
        / (1.0 - layer.poisson**2)
        * (xp.abs(height - neutral) + 0.5 * layer.thickness)
        for layer, height in zip(film.layers, film.heights, strict=True)
    )


def _biaxial(layer: Lamina) -> Numeric:
    return layer.modulus / (1.0 - layer.poisson)


def _shear(layer: Lamina) -> Numeric:
    return layer.modulus / (1.0 + layer.poisson)


def _held_stress(layer: Lamina, temperature: Numeric) -> Numeric:
    warmer = temperature - ROOM_TEMPERATURE
    return layer.stress - _biaxial(layer) * layer.expansion * warmer


def _moments(film: Laminate, modulus: Callable[[Lamina], Numeric]) -> tuple[Array, Array, Array]:
    """Zeroth and second moment of a modulus over the height, and its centre [m]."""
    heights = film.heights
    rigid = [modulus(layer) * layer.thickness for layer in film.layers]
    whole = sum(rigid)
    centre = sum(one * height for one, height in zip(rigid, heights, strict=True)) / whole
    second = sum(
        one * ((height - centre) ** 2 + layer.thickness**2 / 12.0)
        for one, height, layer in zip(rigid, heights, film.layers, strict=True)
    )
    return whole, second, centre


_EDGE_FREE = 192.0  # of a round film with a free edge: its energy of stretching is E t K² πR⁶/384


class Curl(NamedTuple):
    """Principal curvatures of a free film [1/m]; positive where its edge rises."""

    largest: Numeric  #: Of the direction in which it curls most
    smallest: Numeric

    def __repr__(self) -> str:
        return short_repr(self)

    @property
    def rolls(self) -> Array:
        """Whether it rolls up in one direction."""
        return xp.asarray(self.largest != self.smallest)


@entry_point
def critical_curvature(stiffness: Stiffness, radius: Numeric) -> Array:
    r"""Curvature of the dish beyond which a free round film rolls up in one direction [1/m]."""
    # .. math:: \kappa_c = \sqrt{\frac{192\,D(1-\nu)}{E t R^4}}
    #
    # which is 4t/(R²√(1+ν)) of one layer. Source: [Freund2000]_.
    return xp.sqrt(_EDGE_FREE * stiffness.twisting / stiffness.membrane) / radius**2


@entry_point
def curl_of_film(curvature: Numeric, stiffness: Stiffness, radius: Numeric) -> Curl:
    r"""Curl of a round film whose small pieces have a curvature.

    Parameters
    ----------
    curvature : array, shape (...)
        That of linear theory, of a piece too small to stretch [1/m].
    stiffness : Stiffness
    radius : array, shape (...)
        Of the film [m].

    Returns
    -------
    Curl

    Notes
    -----
    A dish has to stretch. Up to the critical curvature :math:`\kappa_c` it grows as

    .. math:: \kappa\left(1 + \frac{D_t}{D_b}\,\frac{\kappa^2}{\kappa_c^2}\right) = \kappa_0

    with the stiffness against alike and opposite curvatures; beyond, the product of both
    stays :math:`\kappa_c^2` and their sum is :math:`2D_b\kappa_0/(D_b + D_t)`: a roll. Curvature is
    the same everywhere in the film, which is Ritz's method with one term: within about 10 % of
    finite elements [Freund2000]_. Not differentiable where the film begins to roll.

    References
    ----------
    [Freund2000]_, [FreundSuresh2003]_ ch. 2.6
    """
    critical = critical_curvature(stiffness, radius)
    wanted = xp.abs(curvature) / critical
    ratio = stiffness.twisting / stiffness.bending
    # the one real root of ratio·x³ + x = wanted
    slope = 1.5 * xp.sqrt(3.0 * ratio)
    dish = 2.0 / xp.sqrt(3.0 * ratio) * xp.sinh(xp.arcsinh(slope * wanted) / 3.0)
    mean = wanted / (1.0 + ratio)
    rolled = mean > 1.0
    spread = xp.sqrt(xp.where(rolled, mean**2 - 1.0, 1.0))
    largest = xp.where(rolled, mean + spread, dish)
    smallest = xp.where(rolled, 1.0 / (mean + spread), dish)
    sign = xp.sign(curvature) * critical
    return Curl(sign * largest, sign * smallest)


@entry_point
def projected_share(curl: Curl, radius: Numeric) -> Array:
    r"""Area of a curled film seen from above over that of the flat one, at least [1]."""
    # .. math:: \langle\cos\vartheta\rangle \ge 1 - \tfrac12\langle\vartheta^2\rangle,
    #     \qquad \langle\vartheta^2\rangle = \tfrac14(\kappa_1^2+\kappa_2^2)R^2
    #
    # by the angle ϑ to the horizontal; the first term of its series is a bound.
    square = 0.25 * (curl.largest**2 + curl.smallest**2) * xp.asarray(radius) ** 2
    return xp.maximum(1.0 - 0.5 * square, 0.0)


@entry_point
def tac_within(tac: Numeric, projected: Numeric) -> Array:
    r"""Thermal accommodation coefficient of a hollow face, over its opening [1].

    ``tac``: of the flat face; ``projected``: area of the opening over that of the face.
    """
    # .. math:: \alpha' = \frac{\alpha}{1-(1-\alpha)(1-\varphi)}
    #
    # Free molecules meet the face again unless they leave by the opening; exact for a spherical cap
    # with diffuse reflection, of which every part sees the opening under φ.
    return tac / (1.0 - (1.0 - xp.asarray(tac)) * (1.0 - projected))
