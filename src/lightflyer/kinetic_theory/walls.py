"""What becomes of a molecule that meets a face: walls, and force and heat without collisions."""

from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, get_args

import numpy as np

from lightflyer.core.checks import require_range
from lightflyer.core.errors import ParameterError

Wall = Literal["maxwell", "accommodated"]
"""A share α of the molecules leaves at the temperature of the face and the rest is reflected, or
all leave diffusely at one temperature between those of face and arriving gas."""

CERCIGNANI_LAMPIS = "cercignani-lampis"

WALLS: dict[str, str] = {
    "maxwell": "Maxwell walls",
    "accommodated": "accommodated walls",
    CERCIGNANI_LAMPIS: "Cercignani-Lampis walls",
}
"""Walls in words."""


def require_wall(wall: str) -> Wall:
    """Raise unless a wall is known to every part of the solver, chambers' linear one included."""
    for known in get_args(Wall):
        if wall == known:
            return known
    raise ParameterError(f'wall = "{wall}" is not {", ".join(WALLS)}')


class Accommodation(NamedTuple):
    """A face of Cercignani and Lampis."""

    normal: float  # Accommodation coefficient of the energy of normal motion [1]
    tangential: float  # That of tangential momentum [1]
    rotational: float  # That of rotational energy [1]

    @property
    def of_energy(self) -> tuple[float, float, float]:
        """Those of the energies of normal motion, tangential motion and rotation [1]."""
        return self.normal, self.tangential * (2.0 - self.tangential), self.rotational


def normal_accommodation(tac: Any, tangential: Any, rotational: Any = None) -> Any:
    r"""Accommodation of the energy of normal motion at a wall of Cercignani and Lampis [1]."""
    # .. math:: \alpha_n = 2\alpha - \sigma_t(2-\sigma_t) + (\alpha - \alpha_r)
    #
    # The wall turns a Maxwellian of the gas's temperature :math:`T_c` that arrives into one with
    # :math:`T_c + \alpha_n\theta T_c` for the normal and :math:`T_c + \sigma_t(2-\sigma_t)\theta
    # T_c` for the tangential velocity. Normal and tangential motion and the rotation of diatomic
    # molecules carry as much energy to it each; rotation is taken to accommodate as the whole does
    # where it is not given.
    #
    # Source: [CercignaniLampis1971]_, [Lord1991]_ with rotation.
    normal = 2.0 * tac - tangential * (2.0 - tangential)
    return normal if rotational is None else normal + tac - rotational


def walls_of(
    wall: str,
    tacs: tuple[float, float],
    tangential: float | tuple[float, float] | None,
    rotational: float | tuple[float, float] | None,
    *,
    rotates: bool,
) -> tuple[Wall, tuple[Accommodation, Accommodation] | None]:
    """Walls, and both faces where they are of Cercignani and Lampis."""
    if wall != CERCIGNANI_LAMPIS:
        known = require_wall(wall)
        if tangential is not None or rotational is not None:
            raise ParameterError(
                "tangential_accommodation and rotational_accommodation belong to "
                f'wall = "{CERCIGNANI_LAMPIS}"'
            )
        return known, None
    by_face = []
    pairs = (
        (None, None) if value is None else np.broadcast_to(value, 2)
        for value in (tangential, rotational)
    )
    for face, tac, along, turning in zip(("top", "bottom"), tacs, *pairs, strict=True):
        for name, value in (("tangential", along), ("rotational", turning)):
            if value is not None:
                require_range(f"{name}_accommodation", float(value), 0.0, 1.0)
        if turning is not None and not rotates:
            raise ParameterError('rotational_accommodation belongs to gas = "diatomic"')
        # what is not given accommodates as the TAC says
        momentum = 1.0 - np.sqrt(1.0 - tac) if along is None else along
        rotation = tac if turning is None else turning
        normal = normal_accommodation(tac, momentum, rotation if rotates else None)
        if not -1e-9 <= normal <= 1.0 + 1e-9:
            raise ParameterError(
                f"no wall has tac_{face} = {tac:g} with tangential_accommodation = {momentum:.4g}"
                + (f" and rotational_accommodation = {rotation:.4g}" if rotates else "")
                + f": that of normal energy would be {normal:.3g}"
            )
        by_face.append(
            Accommodation(float(np.clip(normal, 0.0, 1.0)), float(momentum), float(rotation))
        )
    return "accommodated", (by_face[0], by_face[1])


@dataclass(frozen=True)
class FreeMolecularDisk:
    r"""Force and heat of a disk much smaller than the mean free path."""

    # .. math::
    #     \frac{F}{pA} = \frac{1-\beta}2\left[\alpha_b\left(\sqrt{T_b/T_c}-1\right)
    #         - \alpha_t\left(\sqrt{T_t/T_c}-1\right)\right], \qquad
    #     \frac{Q}{p\sqrt{2RT_c}A} = \frac{(1-\beta)\,\alpha}{\sqrt\pi}
    #         \left(\frac{T}{T_c}-1\right)
    #
    # for molecules that pass the disk, or leave a face either fully accommodated or specularly
    # reflected (Maxwell). Where all leave at the temperature :math:`T_c + \alpha(T - T_c)`, the
    # heat is the same and :math:`\alpha(\sqrt{T/T_c}-1)` becomes :math:`\sqrt{1+\alpha(T/T_c-1)} -
    # 1`; at walls of Cercignani and Lampis :math:`\alpha` is there that of the normal motion. With
    # rotation the heat is 3/2 of that. The linear force has half the perturbation of the
    # temperature in place of that of its root, for all walls.

    tac: tuple[float, float]  # Accommodation coefficients of the top and bottom face [1]
    # Their temperatures, as perturbations if ``linear``, else T_h/T_c
    temperature: tuple[float, float]
    linear: bool
    rotation: bool
    open_fraction: float = 0.0  # Share β of the molecules that pass the disk [1]
    wall: Wall = "maxwell"
    # Accommodation of normal energy, where it is not that of all energy [1]
    normal: tuple[float, float] | None = None

    def _recoil(self, tac: float, temperature: float) -> float:
        """Momentum that leaves a face, over that at the gas's temperature, less 1."""
        if self.linear:
            return tac * 0.5 * temperature
        if self.wall == "accommodated":
            return float(np.sqrt(1.0 + tac * (temperature - 1.0)) - 1.0)
        return tac * float(np.sqrt(temperature) - 1.0)

    @property
    def force(self) -> float:
        """Upwards [p·A]."""
        top, bottom = (
            self._recoil(tac, value)
            for tac, value in zip(self.normal or self.tac, self.temperature, strict=True)
        )
        return 0.5 * (1.0 - self.open_fraction) * (bottom - top)

    @property
    def heat(self) -> tuple[float, float]:
        """Out of the top and the bottom face [p √(2RT_c) A]."""
        carried = (1.0 - self.open_fraction) * (1.5 if self.rotation else 1.0) / np.sqrt(np.pi)
        top, bottom = (
            carried * tac * (value if self.linear else value - 1.0)
            for tac, value in zip(self.tac, self.temperature, strict=True)
        )
        return top, bottom
