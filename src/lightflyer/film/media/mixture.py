"""Fine mixtures of media: porous, mixed, graded and nanotube layers."""

import numpy as np
from numpy.typing import ArrayLike

from lightflyer.array import tree
from lightflyer.array.namespace import Numeric, xp
from lightflyer.array.records import field
from lightflyer.core.checks import is_concrete, is_traced, require_positive, require_range
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.film.media.compound import Compound, Rule, Shape, indices, vector
from lightflyer.film.media.materials import vacuum
from lightflyer.film.media.medium import GIVEN, MICROMETRE, Medium

MOST_INCLUSIONS = 0.3
"""Volume fraction of inclusions to which Maxwell Garnett's law is commonly used [1]."""

COARSEST_GRAIN = 0.1
"""Size of grains over the wavelength in the mixture above which their scattering counts [1]."""

SHEETS = 20  # Sheets of a graded layer, unless it says otherwise

_ROUNDING = 1e-12
_FINE = 1e3  # wavelengths over the grain's size beyond which no medium's n makes it coarse
_TRIED = 2000  # wavelengths at which the size of grains is compared


class Mixture(Compound):
    """A mixture of media, much finer than the wavelength.

    Attributes
    ----------
    parts : tuple of Medium
        Two or more. The first is what the others leave: with the rule of Maxwell Garnett, the host
        of inclusions.
    fractions : array, shape (parts - 1,)
        Volume fractions of the parts behind the first [1].
    rule : Rule or str
        ``"bruggeman"`` for grains of which none is the host, ``"maxwell-garnett"`` for few
        inclusions in a host, ``"parallel"`` and ``"series"`` for Wiener's bounds.
    shape : Shape or str
        Of grains or inclusions: ``"spheres"``; ``"columns"`` along the normal; with the rule of
        Maxwell Garnett also ``"needles"`` in all directions, and a ``"mat"`` of needles in the
        film's plane.
    depolarisation : float or None
        Depolarisation factor along a field in the film's plane; by default that of the shape [1].
    grain : float or None
        Size of grains and gaps, with which results say where they are too coarse [m].
    measured_density : array or None
        Mass density [kg/m³]; by default that of the parts.

    Raises
    ------
    ParameterError
        If the rule is unknown, there are not as many fractions as parts but one, or a concrete
        fraction is not possible.

    Notes
    -----
    Grains must be small against the wavelength in the mixture, and large enough (nanometres) to
    have the n and k of the parts. Differentiable in fractions, depolarisation factor and the
    parameters of the parts.

    Examples
    --------
    >>> from lightflyer.film import material
    >>> germanium = porous(material("Ge"), 0.2)
    >>> print(f"{germanium.density:.0f} kg/m³")
    4258 kg/m³
    >>> n, k = germanium.index(0.6e-6)
    >>> print(f"{n:.3f} {k:.3f}")
    3.156 1.998
    """

    parts: tuple[Medium, ...]
    fractions: Numeric = field(converter=vector)
    rule: Rule = field(static=True, default=Rule.BRUGGEMAN, converter=Rule.of)
    shape: Shape = field(static=True, default=Shape.SPHERES, converter=Shape.of)
    depolarisation: Numeric | None = None
    grain: float | None = field(static=True, default=None)
    measured_density: Numeric | None = None

    def __check_init__(self) -> None:
        if len(self.parts) < 2 or np.shape(self.fractions) != (len(self.parts) - 1,):
            raise ParameterError(
                f"a mixture needs two or more parts, and a fraction of each but the first; "
                f"it has {len(self.parts)} and {np.size(self.fractions)}"
            )
        for part, fraction in zip(self.parts[1:], self.fractions, strict=True):
            require_range(f"fraction of {part.name}", fraction, 0.0, 1.0)
        if is_concrete(self.fractions) and np.sum(self.fractions) > 1.0 + _ROUNDING:
            raise ParameterError(
                f"fractions of {self.name} add up to {np.sum(self.fractions):g}, more than 1"
            )
        symmetric = self.rule is Rule.BRUGGEMAN
        if symmetric and self.depolarisation is None and len(self.shape.factors) > 1:
            raise ParameterError(
                f'the rule "{self.rule}" has no {self.shape}; "{Rule.MAXWELL_GARNETT}" has'
            )
        require_range("depolarisation", self.depolarisation, 0.0, 1.0, open_below=symmetric)
        if symmetric and is_concrete(self.depolarisation) and np.any(self.depolarisation == 1.0):
            raise ParameterError(
                f'depolarisation = 1 is no grain; the rule "{Rule.SERIES}" has such layers'
            )
        require_range(f"density of {self.name}", self.measured_density, 0.0)
        if self.grain is not None:
            require_positive(grain=self.grain)

    @property
    def name(self) -> str:
        """The parts' names."""
        return " + ".join(part.name for part in self.parts)

    @property
    def all_fractions(self) -> Numeric:
        """Volume fraction of each part, shape (parts,) [1]."""
        return _with_rest(self.fractions)

    @property
    def density(self) -> Numeric | None:
        """Mass density: the measured one, or the mean of the parts' [kg/m³]."""
        if self.measured_density is not None:
            return self.measured_density
        densities = [part.density for part in self.parts]
        if any(density is None for density in densities):
            return None
        shares = zip(self.all_fractions, densities, strict=True)
        return sum(fraction * density for fraction, density in shares)

    @property
    def density_source(self) -> str:
        """Where the density comes from, or which part has none."""
        if self.measured_density is not None:
            return GIVEN
        unknown = [part for part in self.parts if part.density is None]
        if unknown:
            note = f" ({unknown[0].density_source})" if unknown[0].density_source else ""
            return f"that of {unknown[0].name} is unknown{note}"
        return "volume fractions of " + "; ".join(part.density_source for part in self.parts)

    def index(self, wavelength: ArrayLike) -> tuple[Numeric, Numeric]:
        n, k = indices(self.parts, np.asarray(wavelength, float))
        factors: Numeric = self.depolarisation
        if factors is None:
            factors = self.shape.factors
            factors = factors[0] if len(factors) == 1 else np.array(factors)
        return self.rule.law(n, k, self.all_fractions, factors)

    @property
    def diagnostics(self) -> tuple[str, ...]:
        """Warnings of the parts, and where the rule does not hold."""
        found = [text for part in self.parts for text in part.diagnostics]
        if self.rule is Rule.MAXWELL_GARNETT and is_concrete(self.fractions):
            share = float(np.sum(self.fractions))
            if share > MOST_INCLUSIONS:
                found.append(
                    f"{self.name}: inclusions fill {share:.0%}; Maxwell Garnett's rule is for few, "
                    f"up to about {MOST_INCLUSIONS:.0%}"
                )
        if not self.shape.is_isotropic:
            found.append(
                f"{self.name}: {self.shape} have n and k of light along the film's normal; the "
                "layer is taken to have them in all directions"
            )
        if self.grain is None:
            found.append(
                f"{self.name}: no size of its grains is stated; they are taken as far smaller than "
                "the wavelength"
            )
        elif (longest := self._too_coarse()) > 0.0:
            found.append(
                f"{self.name}: its grains exceed {COARSEST_GRAIN:g} wavelengths (in the mixture) "
                f"below {longest / MICROMETRE:.3g} µm; scattering by them is left out"
            )
        return tuple(dict.fromkeys(found))

    def _too_coarse(self) -> float:
        """Longest wavelength at which the grains are too coarse, zero if there is none [m]."""
        shortest, longest = self.wavelength_range
        longest = min(longest, _FINE * self.grain)  # type: ignore[operator]
        shortest = shortest or longest / _FINE
        if shortest >= longest:
            return 0.0
        wavelength = np.geomspace(shortest, longest, _TRIED)
        n, _ = self.index(wavelength)
        if is_traced(n):
            return 0.0
        coarse = wavelength[self.grain * n > COARSEST_GRAIN * wavelength]
        return float(coarse[-1]) if coarse.size else 0.0


class Graded(Compound):
    """A mixture whose fractions change linearly with depth, as sheets of one composition each.

    Attributes
    ----------
    parts : tuple of Medium
        See :class:`Mixture`.
    top, bottom : array, shape (parts - 1,)
        Volume fractions of the parts behind the first at the layer's upper and lower end [1].
    rule, shape, depolarisation, grain, measured_density
        See :class:`Mixture`.
    count : int
        Sheets; each has the composition of its middle.

    Notes
    -----
    The error of reflectance and transmittance falls with the square of the number of sheets.
    Results give it, from twice as many: see
    :func:`~lightflyer.film.optics.diagnostics.sheet_error`.

    Examples
    --------
    >>> from lightflyer.film import Film, Layer, material
    >>> fading = Graded((material("Si"), material("SiO2")), 0.0, 1.0)
    >>> film = Film((Layer(fading, 200e-9),))
    >>> print(f"{film.optics(1e-6).reflectance[0]:.3f}")
    0.198
    """

    parts: tuple[Medium, ...]
    top: Numeric = field(converter=vector)
    bottom: Numeric = field(converter=vector)
    rule: Rule = field(static=True, default=Rule.BRUGGEMAN, converter=Rule.of)
    shape: Shape = field(static=True, default=Shape.SPHERES, converter=Shape.of)
    depolarisation: Numeric | None = None
    grain: float | None = field(static=True, default=None)
    measured_density: Numeric | None = None
    count: int = field(static=True, default=SHEETS)

    def __check_init__(self) -> None:
        if self.count < 1:
            raise ParameterError(f"count = {self.count} is not a number of sheets")
        self._at(0.0), self._at(1.0)  # raise

    def _at(self, depth: float) -> Mixture:
        """The mixture at a depth, as a share of the thickness."""
        fractions = _between(self.top, self.bottom, depth)
        return Mixture(
            self.parts, fractions, self.rule, self.shape, self.depolarisation, self.grain,
            self.measured_density,
        )  # fmt: skip

    @property
    def name(self) -> str:
        """The parts' names."""
        return f"graded {self._at(0.5).name}"

    @property
    def density(self) -> Numeric | None:
        """Mean mass density [kg/m³]."""
        return self._at(0.5).density

    @property
    def density_source(self) -> str:
        """Where the density comes from, or which part has none."""
        return self._at(0.5).density_source

    @property
    def sheets(self) -> tuple[Medium, ...]:
        return tuple(self._at((number + 0.5) / self.count) for number in range(self.count))

    def flip(self) -> "Graded":
        return tree.replace_at(lambda one: (one.top, one.bottom), self, (self.bottom, self.top))

    def index(self, wavelength: ArrayLike) -> tuple[Numeric, Numeric]:
        """Refractive index and extinction coefficient halfway down; see :meth:`Medium.index`."""
        return self._at(0.5).index(wavelength)

    @property
    def diagnostics(self) -> tuple[str, ...]:
        """Warnings of the mixtures at both ends."""
        return tuple(dict.fromkeys((*self._at(0.0).diagnostics, *self._at(1.0).diagnostics)))


def porous(
    medium: Medium,
    porosity: Numeric,
    *,
    rule: Rule | str = Rule.BRUGGEMAN,
    shape: Shape | str = Shape.SPHERES,
    grain: float | None = None,
) -> Mixture:
    """A medium with empty pores.

    Parameters
    ----------
    medium : Medium
    porosity : float
        Volume fraction of the pores [1].
    rule, shape, grain
        See :class:`Mixture`.

    Returns
    -------
    Mixture
    """
    return Mixture((medium, vacuum()), (porosity,), Rule.of(rule), Shape.of(shape), grain=grain)


@entry_point
def _with_rest(fractions: Numeric) -> Numeric:
    return xp.concatenate([(1.0 - fractions.sum())[None], fractions])


@entry_point
def _between(first: Numeric, last: Numeric, share: Numeric) -> Numeric:
    return first + share * (last - first)
