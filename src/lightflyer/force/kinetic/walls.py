r"""Walls of the kinetic disk: what it makes of another one than Maxwell's.

The table of the kinetic model is for Maxwell walls. Where all molecules leave a face at one
accommodated temperature, force and heat loss have other free-molecular values, which are exact, and
collisions take away another share of them,

.. math::
    \ln\frac{\hat F_a}{\hat F} = \frac{g_F}{1+\mathrm{Kn}/\mathrm{Kn}_0}, \qquad
    \ln\frac{\hat Q_a}{\hat Q} = \frac{(1-\bar\alpha)\,g_Q}{1+\mathrm{Kn}/\mathrm{Kn}_0},

with polynomials :math:`g` through a table of the solver's in :math:`\ln(T_h/T_c)`, the mean TAC
and the Knudsen number. Collisions change nothing as the gas gets thin, and no heat loss where both
walls are the same.

A pair of TACs leaves open how the faces share their difference among normal motion, tangential
motion and rotation. If the last two differ by :math:`(1-s)\,\Delta\alpha`, the force is

.. math:: F\,(1+s\,g_s),\qquad g_s = \frac{\sum_k (w_n-w_k)}{w_n+\sum_k w_k}

with the weights :math:`w` below; in thin gas :math:`g_s` is 2, or 1
of a monatomic gas. Unknown walls have :math:`s` from :math:`-a/(n-a)` to 1. At 1 tangential motion
and rotation accommodate wholly, and normal motion in :math:`\alpha_n = n\bar\alpha-n+1`: the
weights are those there, and :math:`1+g_s` is larger by
:math:`\sqrt{(1+\bar\alpha\theta)/(1+\alpha_n\theta)}`. At the other end
the faces differ in how many of the molecules they trap: these accommodate in all :math:`n` kinds of
energy, and those that bounce in :math:`a = 1/2` of their normal energy alone.

Faces of Cercignani and Lampis: what each kind of accommodation pushes.

Without collisions only the normal motion of the molecules that leave pushes. With them, what the
tangential motion and the rotation of molecules bring into the gas pushes too, and the normal motion
pushes less. For small differences the force is

.. math:: F = F_a\,(w_n\,\Delta\alpha_n + w_t\,\Delta\alpha_t + w_r\,\Delta\alpha_r)/\Delta\alpha_a

where :math:`F_a` is that of accommodated walls of the same mean TAC, and :math:`\alpha_t =
\sigma_t(2-\sigma_t)` the accommodation of tangential energy. The weights follow from the solver's
table over the Knudsen number and the three mean coefficients; in thin gas they are 1, 0 and 0.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, Literal, NamedTuple

import numpy as np

from lightflyer.array.memory import kept
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import field
from lightflyer.core.checks import is_concrete
from lightflyer.core.constants import NORMAL_HALF_WIDTH_95
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import Fraction, StandardErrors
from lightflyer.core.validity import Looks, Validity
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.disk import Disk
from lightflyer.force.base import AbstractForceModel
from lightflyer.force.fitted import fitted
from lightflyer.force.kinetic.ratios import heating_of, tacs_of
from lightflyer.force.laws.faces import accommodated_force, maxwell_force
from lightflyer.kinetic_theory.walls import normal_accommodation
from lightflyer.numerics.polynomials import hold_within, place_between, polynomial, polynomial_once

_KNUDSEN_0 = 0.25  # where thin gas gives way to dense, for what is fitted only
_NO_WALL = (
    "no wall has TAC, tangential_accommodation and rotational_accommodation as given; it is held "
    "within 0 and 1"
)


class Accommodations(NamedTuple):
    """Accommodation coefficients of a face, or means of both [1]."""

    normal: Numeric
    tangential: Numeric  # Of energy
    rotational: Numeric


class Stated(NamedTuple):
    """What is known of both faces beside their TACs [1]; None follows the TAC."""

    tangential: Numeric | None = None  # Of momentum
    rotational: Numeric | None = None

    def of(self, tac: Numeric) -> Accommodations:
        """Coefficients of a face of a TAC; that of the normal motion follows."""
        rotational = tac if self.rotational is None else self.rotational
        if self.tangential is None:
            return Accommodations(2.0 * tac - rotational, tac, rotational)
        along = self.tangential * (2.0 - self.tangential)
        return Accommodations(
            normal_accommodation(tac, self.tangential, rotational), along, rotational
        )

    def held(self, tac: Numeric) -> Accommodations:
        """The same, where the normal one is held within what a wall can do."""
        found = self.of(tac)
        return found._replace(normal=xp.clip(found.normal, 0.0, 1.0))


@dataclass(frozen=True)
class ScatteringFit:
    """Weights of the three kinds of accommodation, for one gas."""

    knudsen_range: tuple[float, float]
    ranges: tuple[tuple[float, float], ...]  # Of the mean coefficients in the table
    coefficients: tuple[Any, ...]  # Of each weight: Knudsen number, three mean coefficients

    def weights(self, knudsen: Numeric, means: Accommodations) -> tuple[Array, ...]:
        """:math:`w_n`, :math:`w_t` and :math:`w_r` [1]."""
        low, high = np.log(self.knudsen_range)
        position = place_between(xp.clip(xp.log(knudsen), low, high), low, high)
        inside = [xp.clip(m, *range_) for m, range_ in zip(means, self.ranges, strict=True)]
        dense = 1.0 / (1.0 + knudsen / _KNUDSEN_0)
        normal, *others = (dense * polynomial(c, position, *inside) for c in self.coefficients)
        return 1.0 + normal, *others

    def effective(
        self, knudsen: Numeric, faces: tuple[Accommodations, Accommodations]
    ) -> tuple[Array, Array]:
        """TACs of accommodated faces that push as these do, top and bottom [1]."""
        means = Accommodations(*(0.5 * (one + other) for one, other in zip(*faces, strict=True)))
        weights = self.weights(knudsen, means)
        # what is not weighed does not differ between the faces
        rest = (1.0 - sum(weights)) * means.normal
        top, bottom = (
            rest + sum(w * one for w, one in zip(weights, face, strict=True)) for face in faces
        )
        return xp.asarray(top), xp.asarray(bottom)


def scattering_ranges(stated: Stated, tacs: tuple[Numeric, Numeric]) -> Looks:
    """What a wall can accommodate."""
    for where, tac in zip(("on top", "below"), tacs, strict=True):
        normal = Validity(f"the accommodation of normal energy {where}", 0.0, 1.0, _NO_WALL)
        yield normal, stated.of(tac).normal


Wall = Literal["unknown", "maxwell", "accommodated", "cercignani-lampis"]
"""What becomes of molecules at a face; unknown is the middle of the next two."""

IN_WORDS = {
    "unknown": "walls: the mean of Maxwell's and of fully accommodated ones; bands contain both, "
    "and that normal motion, tangential motion and rotation accommodate each on its own",
    "maxwell": "walls: Maxwell's, a share TAC of the molecules leaves at the temperature of the "
    "face, the rest is reflected",
    "accommodated": "walls: accommodated, all molecules leave a face at one temperature",
    "cercignani-lampis": "walls: Cercignani-Lampis; of small differences, what each kind of "
    "accommodation pushes is solved",
}
"""Walls in words."""

BOUNCED = 0.5
"""Share of their normal energy that molecules accommodate which a face does not trap, at most."""

_SHARED_HEATED = 0.1
"""By how much weights of small differences make the force of hot faces too large that share their
accommodation unevenly [1 per ln(T_h/T_c), in dense gas]: the largest of non-linear solutions at Kn
0.1."""

_HELD = "the table of walls other than Maxwell's ends there, and what they change is held"


class Walls(NamedTuple):
    """A choice of walls."""

    wall: Wall = "maxwell"
    # Deviation from what is assumed, in standard errors [1]; None stands for zero
    error: Numeric | None = None
    # Accommodation of tangential momentum of both faces, for Cercignani–Lampis walls; without it
    # tangential energy is accommodated as well as the rest
    tangential: Numeric | None = None
    # That of rotational energy of both faces, likewise; without it as the TACs say
    rotational: Numeric | None = None
    # Deviation of how unknown walls share the difference of their TACs, in standard errors [1]
    sharing: Numeric | None = None

    @property
    def is_stated(self) -> bool:
        """Whether anything is known of the faces beside their TACs."""
        return self.tangential is not None or self.rotational is not None

    def stated(self, gas: str) -> Stated:
        """What is known of both faces beside their TACs, in a gas of the table."""
        return Stated(self.tangential, None if gas == "monatomic" else self.rotational)


class AbstractWalled(AbstractForceModel):
    """A kinetic model with a choice of walls, as :class:`lightflyer.Kinetic` explains them."""

    wall: Wall = field(static=True)
    wall_error: StandardErrors | None
    sharing_error: StandardErrors | None
    tangential_accommodation: Fraction | None
    rotational_accommodation: Fraction | None

    def __check_init__(self) -> None:
        super().__check_init__()
        require_walls(self.walls)

    @property
    def walls(self) -> Walls:
        """Those around which molecules leave its faces."""
        return Walls(
            self.wall,
            self.wall_error,
            self.tangential_accommodation,
            self.rotational_accommodation,
            self.sharing_error,
        )

    def assumptions(self, flyer: AbstractFlyer) -> tuple[str, ...]:
        return (IN_WORDS[self.wall],)


def require_walls(walls: Walls) -> None:
    """Raise where a choice of walls is given an accommodation that it does not have."""
    stated = {
        "tangential_accommodation": walls.tangential,
        "rotational_accommodation": walls.rotational,
    }
    for name, value in stated.items():
        if value is not None and walls.wall != "cercignani-lampis":
            raise ParameterError(
                f'{name} has no meaning with wall = "{walls.wall}"; it is for cercignani-lampis'
            )
    # a file's zero is an unknown number while a program is traced
    stated_error = is_concrete(walls.sharing) and np.any(np.asarray(walls.sharing))
    if stated_error and walls.wall != "unknown":
        raise ParameterError(
            f'sharing_error has no meaning with wall = "{walls.wall}"; it is for unknown ones'
        )


@dataclass(frozen=True)
class WallFit:
    r"""Ratios to free molecules at accommodated walls over those at Maxwell's, for one gas."""

    # Of the table; beyond it the polynomials stay what they are there. Heating is
    # :math:`\ln(T_h/T_c)`; the second range is that of Knudsen numbers of its terms
    knudsen_range: tuple[float, float]
    heated_range: tuple[float, float]
    tac_range: tuple[float, float]
    heating_range: tuple[float, float]
    force: Any  # Coefficients: heating, TAC, Knudsen number
    heat: Any

    @cached_property
    def _force(self) -> tuple[Any, Any]:
        return self.force[0], self.force[1:]

    @cached_property
    def _heat(self) -> tuple[Any, Any]:
        return self.heat[0], self.heat[1:]

    def _logarithm(self, coefficients: Any, knudsen: Numeric, ratio: Numeric, tac: Array) -> Array:
        position = _position(knudsen, self.knudsen_range, self.knudsen_range)
        heated = _position(knudsen, self.heated_range, self.knudsen_range)
        heating = hold_within(heating_of(ratio), *self.heating_range)
        cold, hot = coefficients
        found = polynomial_once(cold, tac, position)
        found = found + heating * polynomial(hot, heating, tac, heated)
        return xp.asarray(found * denseness(knudsen))

    def force_factor(self, knudsen: Numeric, ratio: Numeric, tac: Numeric) -> Array:
        r""":math:`\hat F_a/\hat F` [1]."""
        held = _held(tac, self.tac_range)
        return xp.exp(self._logarithm(self._force, knudsen, ratio, held))

    def heat_factor(self, knudsen: Numeric, ratio: Numeric, tac: Numeric) -> Array:
        r""":math:`\hat Q_a/\hat Q` [1]; as :meth:`force_factor`."""
        held = _held(tac, self.tac_range)
        return xp.exp((1.0 - held) * self._logarithm(self._heat, knudsen, ratio, held))


@kept
def _position(knudsen: Numeric, held: tuple[float, float], ends: tuple[float, float]) -> Array:
    """Where a Knudsen number, held in a range, is between two, from −1 to 1."""
    return place_between(xp.clip(xp.log(knudsen), *np.log(held)), *np.log(ends))


@kept
def _held(tac: Numeric, ends: tuple[float, float]) -> Array:
    return xp.clip(tac, *ends)


@kept
def denseness(knudsen: Any) -> Any:
    """Falls from 1 in dense gas to 0 in thin gas."""
    return 1.0 / (1.0 + knudsen / _KNUDSEN_0)


@lru_cache
def wall_fit(gas: str = "diatomic") -> WallFit:
    """Smooth functions through the table for a gas."""
    return fitted(WallFit, "walls", gas)


@lru_cache
def scattering_fit(gas: str = "diatomic") -> ScatteringFit:
    """Weights of the three kinds of accommodation, for a gas."""
    return fitted(ScatteringFit, "scattering", gas)


@lru_cache
def sharing_fit(gas: str) -> tuple[Any, Any]:
    """Coefficients of what :func:`sharing_factor` takes of the Knudsen number and the TAC."""
    return fitted(tuple, "sharing", gas)


def left_to_normal(tac: Any, kinds: int) -> Any:
    """Accommodation of normal energy where all else accommodates wholly [1]."""
    return xp.maximum(kinds * xp.asarray(tac) - (kinds - 1), 0.0)


def shared_tacs(kinds: int) -> tuple[float, float]:
    """Mean TACs between which normal motion alone is in the table of scattering [1]."""
    return 1.0 - 0.9 / kinds, 0.98


def kinds_of(gas: str) -> int:
    """Number of kinds of energy that a wall accommodates: normal, tangential, rotational."""
    return 2 if gas == "monatomic" else 3


@kept
def _shared(gas: str, knudsen: Numeric, tac: Numeric) -> tuple[Array, Array]:
    """Upper end of :func:`sharing_factor` at small differences, and the gain at the lower [1]."""
    kinds = kinds_of(gas)
    low, high = np.log(scattering_fit(gas).knudsen_range)
    position = place_between(xp.clip(xp.log(knudsen), low, high), low, high)
    tacs = shared_tacs(kinds)
    place = place_between(xp.clip(tac, *tacs), *tacs)
    upper, gain = (
        thin + denseness(knudsen) * polynomial(coefficients, position, place)
        for thin, coefficients in zip((kinds, kinds - 1), sharing_fit(gas), strict=True)
    )
    return upper, gain


def sharing_factor(
    gas: str, knudsen: Numeric, tac: Numeric, excess: Array, error: Numeric
) -> Array:
    """Force over that of walls that share the difference of their TACs evenly [1]."""
    # ``error``: in standard errors; the ends are those of a 95 % band, and nothing is beyond them
    kinds = kinds_of(gas)
    upper, gain = _shared(gas, knudsen, tac)
    heated = xp.sqrt((1.0 + tac * excess) / (1.0 + left_to_normal(tac, kinds) * excess))
    way = xp.clip(xp.asarray(error) / NORMAL_HALF_WIDTH_95, -1.0, 1.0)
    trapped = BOUNCED / (kinds - BOUNCED) * gain
    return xp.asarray(
        1.0 + (heated * upper - 1.0) * xp.maximum(way, 0.0) + trapped * xp.minimum(way, 0.0)
    )


def force(
    disk: Disk,
    state: EnvironmentState,
    excess: Array,
    resisting: tuple[str, Array, Array],
    walls: Walls,
) -> Array:
    """Force of gas in open space on a disk [N]."""
    # ``resisting``: gas of the table, Knudsen number, and the force over that of free molecules at
    # Maxwell walls.
    kind, knudsen, ratio = resisting
    film, pressure = disk.film, state.pressure
    maxwell = ratio * maxwell_force(disk.area, film.tac_difference, pressure, excess)
    if walls.wall == "maxwell":
        return maxwell
    top, bottom = effective_tacs(disk, walls, kind, knudsen)
    free = accommodated_force(disk.area, top, bottom, pressure, excess)
    mean, _ = tacs_of(film)
    other = ratio * wall_fit(kind).force_factor(knudsen, 1.0 + excess, mean)
    # Maxwell's collisions at this wall: direct simulation lies between the two
    same = ratio * free
    if walls.wall == "unknown":
        found = uncertain(
            0.5 * (maxwell + other * free),
            0.5 * _larger(maxwell - same, maxwell - other * free),
            walls.error,
        )
        if walls.sharing is None:
            return found
        return found * sharing_factor(kind, knudsen, mean, excess, walls.sharing)
    bound = same - other * free
    if walls.is_stated:
        heated = _SHARED_HEATED * denseness(knudsen) * heating_of(1.0 + excess)
        bound = _larger(bound, -heated * other * free)
    return uncertain(other * free, bound, walls.error)


def heat_ratio(
    disk: Disk, excess: Array, resisting: tuple[str, Array, Array], walls: Walls
) -> Array:
    """Heat loss over that of free molecules, which is that of any wall [1]; as :func:`force`."""
    kind, knudsen, ratio = resisting
    if walls.wall == "maxwell":
        return ratio
    fit, film = wall_fit(kind), disk.film
    # each face by its own TAC, as much as it loses: unlike faces need that
    top, bottom = (
        tac * fit.heat_factor(knudsen, 1.0 + excess, tac) for tac in (film.tac_top, film.tac_bottom)
    )
    other = ratio * (top + bottom) / (film.tac_top + film.tac_bottom)
    if walls.wall == "unknown":
        return uncertain(0.5 * (ratio + other), 0.5 * (ratio - other), walls.error)
    return uncertain(other, ratio - other, walls.error)


def _larger(one: Array, other: Array) -> Array:
    return xp.where(xp.abs(one) > xp.abs(other), one, other)


def uncertain(value: Array, bound: Array, error: Numeric | None) -> Array:
    """A value off by an error; ``bound``: its change by 1.96 standard errors."""
    return value if error is None else value + error / NORMAL_HALF_WIDTH_95 * bound


def effective_tacs(
    disk: Disk, walls: Walls, kind: str, knudsen: Numeric
) -> tuple[Numeric, Numeric]:
    """TACs with which accommodated walls push as these do, top and bottom [1]."""
    tacs = disk.film.tac_top, disk.film.tac_bottom
    if walls.wall != "cercignani-lampis":
        return tacs
    stated = walls.stated(kind)
    return scattering_fit(kind).effective(knudsen, (stated.held(tacs[0]), stated.held(tacs[1])))


def ranges(disk: Disk, walls: Walls, kind: str, knudsen: Numeric, covered: float) -> Looks:
    """Of the table of walls, and of what a wall can accommodate."""
    if walls.wall == "maxwell":
        return
    densest = wall_fit().knudsen_range[0]
    if densest > covered:
        yield Validity("the Knudsen number", densest, np.inf, _HELD), knudsen
    if walls.is_stated:
        stated = walls.stated(kind)
        yield from scattering_ranges(stated, (disk.film.tac_top, disk.film.tac_bottom))
