"""The optical, surface and mass properties of a film, however they were obtained."""

import warnings

import equinox as eqx
import numpy as np

from lightflyer._checks import require_positive, require_range
from lightflyer._types import Numeric
from lightflyer.errors import ParameterWarning
from lightflyer.precision import is_traced

HIGHEST_TAC = 1.3
"""Largest TAC accepted. None can exceed one, but measured values do by their systematic error."""


class FilmProperties(eqx.Module):
    """Properties of a thin film, one value or an array of them each.

    Attributes
    ----------
    areal_density : array
        Mass per area [kg/m²].
    absorptance : array
        Absorptance of the top face for the incoming light [1].
    emittance_top, emittance_bottom : array
        Hemispherical thermal emittance of each face [1].
    tac_top, tac_bottom : array
        Thermal accommodation coefficient of each face [1]. A flyer is pushed up where the
        bottom's is the larger.
    absorptance_bottom : array or None
        Absorptance of the bottom face, for light reflected from below [1]; by default that of
        the top.

    Raises
    ------
    ParameterError
        If a concrete value is impossible.

    Warns
    -----
    ParameterWarning
        If a TAC exceeds one.
    """

    areal_density: Numeric
    absorptance: Numeric
    emittance_top: Numeric
    emittance_bottom: Numeric
    tac_top: Numeric
    tac_bottom: Numeric
    absorptance_bottom: Numeric = None

    def __check_init__(self) -> None:
        require_positive(areal_density=self.areal_density)
        require_range("absorptance", self.absorptance, 0.0, 1.0)
        require_range("absorptance_bottom", self.absorptance_bottom, 0.0, 1.0)
        for name in ("emittance_top", "emittance_bottom"):
            require_range(name, getattr(self, name), 0.0, 1.0, open_below=True)
        for name in ("tac_top", "tac_bottom"):
            tac = getattr(self, name)
            require_range(name, tac, 0.0, HIGHEST_TAC, open_below=True)
            if _exceeds_one(tac):
                warnings.warn(
                    f"{name} = {np.max(tac):g} exceeds 1, which no surface can: taken as a "
                    "measured value with a systematic error; only differences of TAC count",
                    ParameterWarning,
                    stacklevel=2,
                )

    @property
    def tac_mean(self) -> Numeric:
        r"""Mean TAC of the faces, :math:`\bar\alpha` [1]."""
        return 0.5 * (self.tac_top + self.tac_bottom)

    @property
    def tac_difference(self) -> Numeric:
        r"""Bottom minus top, :math:`\Delta\alpha` [1]; positive pushes up."""
        return self.tac_bottom - self.tac_top

    @property
    def emittance_sum(self) -> Numeric:
        """Emittance of both faces together [1]."""
        return self.emittance_top + self.emittance_bottom

    @property
    def absorptance_below(self) -> Numeric:
        """Absorptance of the bottom face, or the top's where none is given [1]."""
        return self.absorptance if self.absorptance_bottom is None else self.absorptance_bottom


def _exceeds_one(tac: Numeric) -> bool:
    if is_traced(tac):
        return False
    array = np.asarray(tac)
    return bool(np.issubdtype(array.dtype, np.number) and np.any(array > 1.0))
