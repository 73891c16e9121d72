"""The optical, surface and mass properties of a film, however they were obtained."""

import warnings

import equinox as eqx
import jax.numpy as jnp
import numpy as np

from lightflyer.film.emittance import EmittanceCurve, emittance_at, emittance_bounds
from lightflyer.foundation.checks import require_positive, require_range
from lightflyer.foundation.errors import ParameterWarning
from lightflyer.foundation.precision import is_traced
from lightflyer.foundation.types import Numeric

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
    emittance_top, emittance_bottom : array or EmittanceCurve
        Hemispherical thermal emittance of each face [1]; a curve makes it a function of the
        film's own temperature.
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
        """Emittance of both faces together, where neither is a curve [1]."""
        return self.emittance_top + self.emittance_bottom

    def emittances_at(self, temperature: Numeric) -> tuple[Numeric, Numeric]:
        """Emittance of the top and the bottom face at a temperature [1].

        Parameters
        ----------
        temperature : array, shape (...)
            [K].

        Returns
        -------
        top, bottom : array
        """
        return (
            emittance_at(self.emittance_top, temperature),
            emittance_at(self.emittance_bottom, temperature),
        )

    def emission_growth(self, temperature: Numeric, excess: Numeric) -> Numeric:
        r"""Growth of both faces' emission with temperature, over that of one black face.

        .. math:: \sum_\mathrm{faces}\left[\varepsilon(T_h)(1+\theta)^4-\varepsilon(T)\right],
            \qquad T_h=T(1+\theta)

        Parameters
        ----------
        temperature : array, shape (...)
            :math:`T` [K].
        excess : array, shape (...)
            :math:`\theta` [1].

        Returns
        -------
        array, broadcast shape
            [1].
        """
        growth = excess * (4.0 + excess * (6.0 + excess * (4.0 + excess)))
        faces = (self.emittance_top, self.emittance_bottom)
        if not any(isinstance(face, EmittanceCurve) for face in faces):
            return self.emittance_sum * growth
        return sum(
            face.growth(temperature, excess) if isinstance(face, EmittanceCurve) else face * growth
            for face in faces
        )

    def emission_bound(self, temperature: Numeric, power: Numeric) -> Numeric:
        r"""Bound of :math:`(1+\theta)^4-1` in radiative equilibrium.

        Parameters
        ----------
        temperature : array, shape (...)
            Of the surroundings [K].
        power : array, shape (...)
            Absorbed power over the emission of one black face at that temperature [1].

        Returns
        -------
        array, broadcast shape
            [1]; exact where the emittances are constant, else at or beyond it.
        """
        faces = (self.emittance_top, self.emittance_bottom)
        if not any(isinstance(face, EmittanceCurve) for face in faces):
            return power / self.emittance_sum
        cold = sum(self.emittances_at(temperature))
        bounds = [emittance_bounds(face) for face in faces]
        lowest, highest = (sum(pair) for pair in zip(*bounds, strict=True))
        return (power + cold) / jnp.where(power > 0.0, lowest, highest) - 1.0

    @property
    def absorptance_below(self) -> Numeric:
        """Absorptance of the bottom face, or the top's where none is given [1]."""
        return self.absorptance if self.absorptance_bottom is None else self.absorptance_bottom


def _exceeds_one(tac: Numeric) -> bool:
    if is_traced(tac):
        return False
    array = np.asarray(tac)
    return bool(np.issubdtype(array.dtype, np.number) and np.any(array > 1.0))
