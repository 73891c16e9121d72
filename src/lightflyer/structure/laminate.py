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
from lightflyer.core.quantity import (
    Checked,
    Expansion,
    Modulus,
    PoissonRatio,
    Stress,
    Thickness,
)
from lightflyer.structure.holes import tension_at_holes

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
