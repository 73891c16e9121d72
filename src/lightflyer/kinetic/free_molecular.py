"""Force and heat of the disk without collisions, exact for Maxwell walls."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class FreeMolecularDisk:
    r"""Force and heat of a disk much smaller than the mean free path.

    .. math::
        \frac{F}{pA} = \frac{1-\beta}2\left[\alpha_b\left(\sqrt{T_b/T_c}-1\right)
            - \alpha_t\left(\sqrt{T_t/T_c}-1\right)\right], \qquad
        \frac{Q}{p\sqrt{2RT_c}A} = \frac{(1-\beta)\,\alpha}{\sqrt\pi}
            \left(\frac{T}{T_c}-1\right)

    for molecules that pass the disk, or leave a face either fully accommodated or specularly
    reflected. With rotation the heat is 3/2 of that. The linear force has half the perturbation of
    the temperature in place of that of its root.

    Attributes
    ----------
    tac : tuple of float
        Accommodation coefficients of the top and bottom face [1].
    temperature : tuple of float
        Their temperatures, as perturbations if ``linear``, else T_h/T_c.
    linear : bool
    rotation : bool
    open_fraction : float
        Share β of the molecules that pass the disk [1].
    """

    tac: tuple[float, float]
    temperature: tuple[float, float]
    linear: bool
    rotation: bool
    open_fraction: float = 0.0

    @property
    def force(self) -> float:
        """Upwards [p·A]."""
        top, bottom = (
            tac * (0.5 * value if self.linear else np.sqrt(value) - 1.0)
            for tac, value in zip(self.tac, self.temperature, strict=True)
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
