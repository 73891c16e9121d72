r"""Faces of Cercignani and Lampis: what each kind of accommodation pushes.

Without collisions only the normal motion of the molecules that leave pushes. With them, what the
tangential motion and the rotation of molecules bring into the gas pushes too, and the normal motion
pushes less. For small differences the force is

.. math:: F = F_a\,(w_n\,\Delta\alpha_n + w_t\,\Delta\alpha_t + w_r\,\Delta\alpha_r)/\Delta\alpha_a

where :math:`F_a` is that of accommodated walls of the same mean TAC, and :math:`\alpha_t =
\sigma_t(2-\sigma_t)` the accommodation of tangential energy. The weights follow from the solver's
table over the Knudsen number and the three mean coefficients; in thin gas they are 1, 0 and 0.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.validity import Looks, Validity
from lightflyer.kinetic_theory.walls import normal_accommodation
from lightflyer.numerics.horner import polynomial
from lightflyer.numerics.polynomials import place_between

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
        dense = _denseness(knudsen)
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


def _denseness(knudsen: Any) -> Any:
    return 1.0 / (1.0 + knudsen / _KNUDSEN_0)


def ranges(stated: Stated, tacs: tuple[Numeric, Numeric]) -> Looks:
    """What a wall can accommodate."""
    for where, tac in zip(("on top", "below"), tacs, strict=True):
        normal = Validity(f"the accommodation of normal energy {where}", 0.0, 1.0, _NO_WALL)
        yield normal, stated.of(tac).normal
