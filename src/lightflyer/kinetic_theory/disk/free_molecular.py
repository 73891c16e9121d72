"""Force and heat of the disk without collisions, exact for each wall."""

from dataclasses import dataclass

import numpy as np

from lightflyer.kinetic_theory.walls import Wall


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
