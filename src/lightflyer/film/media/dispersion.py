r"""Formulas of n and k with few parameters, to be fitted to measured spectra.

Cauchy's series gives the index of a clear medium. Otherwise the permittivity is a constant plus
terms, each of which obeys causality: its real part is the Kramers-Kronig transform of its
imaginary part,

.. math::
    \varepsilon_1(E) = \varepsilon_\infty
    + \frac2\pi\,\mathrm{P}\!\!\int_0^\infty\frac{\xi\,\varepsilon_2(\xi)}{\xi^2-E^2}\,d\xi .
"""

import abc
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from lightflyer.array.namespace import Numeric, xp
from lightflyer.array.records import field
from lightflyer.core.checks import is_traced, require_range
from lightflyer.core.constants import PLANCK, SPEED_OF_LIGHT
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import (
    Checked,
    Contradictions,
    EnergyGap,
    OscillatorStrength,
    Permittivity,
    PhotonEnergy,
    Quantity,
)
from lightflyer.film.media.medium import MICROMETRE, DataMedium, Extrapolation
from lightflyer.numerics.special import dawson, imaginary, real

_NODES = [0.5 * (1.0 + np.polynomial.legendre.leggauss(80)[0]),
          0.5 * np.polynomial.legendre.leggauss(80)[1]]  # fmt: skip
_NEAR_GAP = 1e-150  # relative: at the gap itself x² ln|x| is zero


class Term(Checked):
    """A term of a permittivity, which obeys causality by itself."""

    @abc.abstractmethod
    def permittivity(self, energy: Numeric) -> tuple[Numeric, Numeric]:
        """Real and imaginary part; ``energy``: photon energy [J]."""


class Lorentz(Term):
    """A damped oscillator; [Fujiwara2007]_ ch. 5.2.

    Attributes
    ----------
    strength : array
        [1].
    energy, broadening : array
        [J], or a text such as ``"0.09 eV"``.
    """

    strength: OscillatorStrength
    energy: PhotonEnergy
    broadening: PhotonEnergy

    @entry_point
    def permittivity(self, energy: Numeric) -> tuple[Numeric, Numeric]:
        # .. math:: \varepsilon = \frac{f E_0^2}{E_0^2-E^2-i\Gamma E}
        below = self.energy**2 - energy**2
        width = self.broadening * energy
        scale = self.strength * self.energy**2 / (below**2 + width**2)
        return scale * below, scale * width


class Drude(Term):
    """Free carriers; [Fujiwara2007]_ ch. 5.2.

    Attributes
    ----------
    plasma, broadening : array
        [J], or a text such as ``"8.9 eV"``.
    """

    plasma: PhotonEnergy
    broadening: PhotonEnergy

    @entry_point
    def permittivity(self, energy: Numeric) -> tuple[Numeric, Numeric]:
        # .. math:: \varepsilon = -\frac{E_p^2}{E^2+i\Gamma E}
        scale = self.plasma**2 / (energy**2 + self.broadening**2)
        return -scale, scale * self.broadening / energy


class TaucLorentz(Term):
    r"""Interband absorption of an amorphous semiconductor or insulator.

    .. math::
        \varepsilon_2 = \frac{A E_0 C (E-E_g)^2}{(E^2-E_0^2)^2+C^2E^2}\,\frac1E
        \quad(E>E_g),\qquad 0\quad(E\le E_g),

    and the closed Kramers-Kronig transform of it; [JellisonModine1996]_, with the erratum.

    Attributes
    ----------
    amplitude, energy, broadening, gap : array
        :math:`A`, :math:`E_0`, :math:`C`, :math:`E_g` [J], or a text such as ``"1.2 eV"``. The
        broadening is below twice the energy: the closed form needs it.
    """

    amplitude: PhotonEnergy
    energy: PhotonEnergy
    broadening: PhotonEnergy
    gap: EnergyGap

    @staticmethod
    def contradiction(energy: Numeric, broadening: Numeric) -> Contradictions:
        wrong = broadening >= 2.0 * energy
        yield wrong, "broadening of a Tauc-Lorentz term must be below twice its energy"

    @entry_point
    def permittivity(self, energy: Numeric) -> tuple[Numeric, Numeric]:
        # in units of the centre, where sums of logarithms lose no digits
        numbers = (energy, self.amplitude, self.broadening, self.gap)
        e, a, c, g = (one / self.energy for one in numbers)
        above = xp.maximum(e - g, 0.0)
        imaginary = c * above**2 / (((e**2 - 1.0) ** 2 + (c * e) ** 2) * e)
        alpha, gamma_squared = xp.sqrt(4.0 - c**2), 1.0 - 0.5 * c**2
        excess = e**2 - gamma_squared
        zeta = excess**2 + 0.25 * (alpha * c) ** 2
        log_part = (g**2 - 1.0) * e**2 + (g * c) ** 2 - (1.0 + 3.0 * g**2)
        angle_part = (e**2 - 1.0) * (1.0 + g**2) + (g * c) ** 2
        ratio = (1.0 + g**2 + alpha * g) / (1.0 + g**2 - alpha * g)
        angles = np.pi - xp.arctan((2.0 * g + alpha) / c) + xp.arctan((alpha - 2.0 * g) / c)
        turn = np.pi + 2.0 * xp.arctan(2.0 * (gamma_squared - g**2) / (alpha * c))
        # both logarithms of |E - gap| together: (E - gap)² ln|E - gap| has no pole at the gap
        apart = e - g
        safe = xp.where(xp.abs(apart) < _NEAR_GAP, 1.0, xp.abs(apart))
        sum_squared = (e + g) ** 2
        logs = (
            -(apart**2) / e * xp.log(safe)
            + sum_squared / e * xp.log(e + g)
            - g * xp.log((1.0 - g**2) ** 2 + (g * c) ** 2)
        )
        terms = (
            0.5 * c * log_part / alpha * xp.log(ratio)
            - angle_part * angles
            + 2.0 * g * excess / alpha * turn
            + c * logs
        )
        return a * terms / (np.pi * zeta), a * imaginary


class Gaussian(Term):
    r"""A Gaussian band, such as a polymer's in the infrared; [Meneses2006]_.

    .. math:: \varepsilon_2 = A\,[e^{-(E-E_0)^2/\sigma^2} - e^{-(E+E_0)^2/\sigma^2}],\qquad
        \varepsilon_1 = \frac{2A}{\sqrt\pi}\left[D\left(\frac{E+E_0}\sigma\right)
        - D\left(\frac{E-E_0}\sigma\right)\right]

    with Dawson's function D.

    Attributes
    ----------
    amplitude : array
        Imaginary part at the centre [1].
    energy, broadening : array
        Centre, and full width at half height [J], or a text such as ``"0.09 eV"``.
    """

    amplitude: OscillatorStrength
    energy: PhotonEnergy
    broadening: PhotonEnergy

    @entry_point
    def permittivity(self, energy: Numeric) -> tuple[Numeric, Numeric]:
        sigma = self.broadening / (2.0 * np.sqrt(np.log(2.0)))
        near, far = (energy - self.energy) / sigma, (energy + self.energy) / sigma
        real = 2.0 / np.sqrt(np.pi) * (dawson(far) - dawson(near))
        imaginary = xp.exp(-(near**2)) - xp.exp(-(far**2))
        return self.amplitude * real, self.amplitude * imaginary


class CodyLorentz(Term):
    r"""Interband absorption of an amorphous semiconductor with a constant dipole at its gap.

    .. math:: \varepsilon_2 = \frac{(E-E_g)^2}{(E-E_g)^2+E_p^2}\,
        \frac{A E_0\Gamma E}{(E^2-E_0^2)^2+\Gamma^2E^2}\quad(E>E_g)

    of [Ferlauto2002]_, without the tail below the gap. The other part is its Kramers-Kronig
    integral, in which the pole is subtracted, by Gauss-Legendre nodes beyond the gap.

    Attributes
    ----------
    amplitude, energy, broadening, gap, transition : array
        :math:`A`, :math:`E_0`, :math:`\Gamma`, :math:`E_g`, :math:`E_p` [J], or a text such as
        ``"1.2 eV"``.
    """

    amplitude: PhotonEnergy
    energy: PhotonEnergy
    broadening: PhotonEnergy
    gap: EnergyGap
    transition: PhotonEnergy

    @entry_point
    def permittivity(self, energy: Numeric) -> tuple[Numeric, Numeric]:
        here, square, real = self._absorbed(energy), energy**2, xp.zeros_like(energy)
        for at, part in zip(*_NODES, strict=True):
            e = self.gap + self.energy * at / (1.0 - at)
            apart = e**2 - square
            safe = xp.where(apart == 0.0, 1.0, apart)
            step = part * self.energy / (1.0 - at) ** 2
            excess = (e * self._absorbed(e) - energy * here) / safe
            real = real + step * xp.where(apart == 0.0, 0.0, excess)
        safe = xp.where(energy == self.gap, 1.0, xp.abs(self.gap - energy))
        pole = here * xp.log((self.gap + energy) / safe)
        return (2.0 * real + pole) / np.pi, here

    def _absorbed(self, e: Numeric) -> Numeric:
        above = xp.maximum(e - self.gap, 0.0) ** 2
        peak = self.amplitude * self.energy * self.broadening * e
        shape = above / (above + self.transition**2)
        return shape * peak / ((e**2 - self.energy**2) ** 2 + (self.broadening * e) ** 2)


class Cauchy(Checked):
    r"""Index of a clear medium, :math:`n = a + b/\lambda^2 + c/\lambda^4`, with k = 0.

    Attributes
    ----------
    a : array
        [1].
    b : array
        [m²].
    c : array
        [m⁴].
    """

    a: Annotated[Numeric, Quantity("", 0.0, open_below=True)]
    b: Annotated[Numeric, Quantity("m^2")] = 0.0
    c: Annotated[Numeric, Quantity("m^4")] = 0.0


class Formula(DataMedium):
    """A medium whose n and k follow from a formula with parameters.

    Raises
    ------
    ParameterError
        If there are both terms and ``cauchy``, or neither, or the range is not possible.

    Notes
    -----
    Differentiable in all parameters; in those of a Tauc-Lorentz term twice at most.

    Examples
    --------
    >>> glass = Formula("glass", cauchy=Cauchy(1.45, "0.0035 um^2"))
    >>> n, k = glass.index(0.5e-6)
    >>> print(f"{n:.3f} {k:.0f}")
    1.464 0
    """

    name: str = field(static=True)
    terms: tuple[Term, ...] = ()  #: Added to ``permittivity``; empty where there is a ``cauchy``
    permittivity: Permittivity = 1.0  #: At energies far above all terms [1]
    cauchy: Cauchy | None = None
    density: Numeric | None = None  #: Mass density [kg/m³]
    density_source: str = field(static=True, default="")
    #: Wavelengths at which the formula was fitted [m]; by default it is taken to hold at all
    shortest: float = field(static=True, default=0.0)
    longest: float = field(static=True, default=np.inf)  #: As ``shortest``
    #: Policy outside of them. ``hold`` goes on with the formula
    extrapolation: Extrapolation = field(static=True, default=Extrapolation.ERROR)
    #: Where the parameters come from
    origin: str = field(static=True, default="a formula with given parameters")

    def __check_init__(self) -> None:
        if bool(self.terms) is (self.cauchy is not None):
            raise ParameterError(f"{self.name}: give either terms or cauchy")
        require_range(f"shortest of {self.name}", self.shortest, 0.0)
        if not self.longest > self.shortest:
            raise ParameterError(
                f"{self.name}: its formula is for no wavelength: {self.describe_range()}"
            )
        require_range(f"permittivity of {self.name}", self.permittivity, 0.0)
        require_range(f"density of {self.name}", self.density, 0.0)

    @property
    def wavelength_range(self) -> tuple[float, float]:
        """Wavelengths at which the formula was fitted [m]."""
        return self.shortest, self.longest

    @property
    def source(self) -> str:
        return self.origin

    @property
    def diagnostics(self) -> tuple[str, ...]:
        """Warns of a formula without a range or without absorption."""
        found = []
        if self.wavelength_range == (0.0, np.inf):
            found.append(
                f"{self.name}: its formula states no range of wavelengths and is used at all"
            )
        if self.cauchy is not None:
            found.append(f"{self.name}: Cauchy's formula has no absorption, k = 0")
        return tuple(found)

    def describe_range(self, *, named: bool = True) -> str:
        text = super().describe_range(named=named)
        return text if self.longest < np.inf else text.partition(" to ")[0] + " and longer"

    def index(self, wavelength: ArrayLike) -> tuple[Numeric, Numeric]:
        wavelength = np.asarray(wavelength, float)
        self.require_covered(wavelength)
        energy = PLANCK * SPEED_OF_LIGHT / wavelength
        n, k = _index_of(self.terms, self.permittivity, self.cauchy, energy)
        if self.extrapolation is Extrapolation.LOSSLESS:
            k = k * self.covers(wavelength)
        if is_traced((n, k)):
            return n, k
        bad = ~((n > 0.0) & (k >= 0.0) & np.isfinite(n) & np.isfinite(k))
        if np.any(bad):
            where = wavelength[bad].flat[0] / MICROMETRE
            raise ParameterError(
                f"{self.name}: its formula gives n = {n[bad].flat[0]:.4g}, k = "
                f"{k[bad].flat[0]:.4g} at {where:.4g} µm, which no medium has"
            )
        return n, k


@entry_point
def _index_of(
    terms: tuple[Term, ...], constant: Numeric, cauchy: Cauchy | None, energy: Numeric
) -> tuple[Numeric, Numeric]:
    if cauchy is not None:
        inverse = (energy / (PLANCK * SPEED_OF_LIGHT)) ** 2
        n = cauchy.a + cauchy.b * inverse + cauchy.c * inverse**2
        return n, xp.zeros_like(n)
    permittivity = constant + 0j * energy
    for term in terms:
        first, second = term.permittivity(energy)
        permittivity = permittivity + (first + 1j * second)
    index = xp.sqrt(permittivity)
    return real(index), imaginary(index)
