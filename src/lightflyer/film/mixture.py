"""Media of several materials: fine mixtures, graded layers, and constants between temperatures.

Their fractions and temperatures may be traced, so that films are differentiable in them.
"""

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from numpy.typing import ArrayLike

from lightflyer.film.effective_media import SPHERES, Rule
from lightflyer.film.materials import GIVEN, Material, vacuum
from lightflyer.film.medium import MICROMETRE, Extrapolation, Medium
from lightflyer.foundation.checks import is_concrete, require_positive, require_range
from lightflyer.foundation.errors import ParameterError
from lightflyer.foundation.precision import entry_point, is_traced
from lightflyer.foundation.types import Numeric

MOST_INCLUSIONS = 0.3
"""Volume fraction of inclusions to which Maxwell Garnett's law is commonly used [1]."""

COARSEST_GRAIN = 0.1
"""Size of grains over the wavelength in the mixture above which their scattering counts [1]."""

SHEETS = 20
"""Sheets of a graded layer, unless it says otherwise."""

_ROUNDING = 1e-12
_TRIED = 200  # wavelengths at which the size of grains is compared


class _Compound(Medium):
    """What media of several others share: ranges, policies and sources are those of the parts."""

    if TYPE_CHECKING:

        @property
        def parts(self) -> tuple[Medium, ...]: ...
    else:
        parts: eqx.AbstractVar[tuple[Medium, ...]]

    @property
    def wavelength_range(self) -> tuple[float, float]:
        """Wavelengths at which all parts have data [m]."""
        return _common(part.wavelength_range for part in self.parts)

    @property
    def usable_range(self) -> tuple[float, float]:
        """See :attr:`Medium.usable_range`."""
        return _common(part.usable_range for part in self.parts)

    @property
    def source(self) -> str:
        """Where n and k come from."""
        return "; ".join(dict.fromkeys(part.source for part in self.parts))

    def extrapolated(self, shortest: float, longest: float) -> tuple[str, ...]:
        """See :meth:`Medium.extrapolated`."""
        found = (text for part in self.parts for text in part.extrapolated(shortest, longest))
        return tuple(dict.fromkeys(found))

    def _changed(self, name: str, value: Any) -> Any:
        return eqx.tree_at(lambda one: getattr(one, name), self, value, is_leaf=_is_none)

    def with_extrapolation(self, policy: Extrapolation | str) -> Any:
        """See :meth:`Medium.with_extrapolation`; it is that of all parts."""
        return self._changed("parts", tuple(part.with_extrapolation(policy) for part in self.parts))

    def with_density(self, density: Numeric) -> Any:
        """The same medium with a measured density, not that of its parts [kg/m³]."""
        return self._changed("measured_density", density)


def _is_none(value: Any) -> bool:
    return value is None


def _common(ranges: Any) -> tuple[float, float]:
    ends = list(ranges)
    shortest = max(end[0] for end in ends)
    return shortest, max(shortest, min(end[1] for end in ends))


class Mixture(_Compound):
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
    depolarisation : array
        Depolarisation factor of grains or inclusions [1].
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
    fractions: Numeric = eqx.field(converter=lambda value: _vector(value))
    rule: Rule = eqx.field(static=True, default=Rule.BRUGGEMAN, converter=lambda name: _rule(name))
    depolarisation: Numeric = SPHERES
    grain: float | None = eqx.field(static=True, default=None)
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
        bruggeman = self.rule is Rule.BRUGGEMAN
        require_range("depolarisation", self.depolarisation, 0.0, 1.0, open_below=bruggeman)
        if bruggeman and is_concrete(self.depolarisation) and np.any(self.depolarisation >= 1.0):
            raise ParameterError(
                'depolarisation = 1 is no grain; the rule "series" has such layers'
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
        """See :meth:`Medium.index`."""
        n, k = _indices(self.parts, np.asarray(wavelength, float))
        return self.rule.law(n, k, self.all_fractions, self.depolarisation)

    @property
    def caveats(self) -> tuple[str, ...]:
        """See :attr:`Medium.caveats`: those of the parts, and where the rule does not hold."""
        found = [text for part in self.parts for text in part.caveats]
        if self.rule is Rule.MAXWELL_GARNETT and is_concrete(self.fractions):
            share = float(np.sum(self.fractions))
            if share > MOST_INCLUSIONS:
                found.append(
                    f"{self.name}: inclusions fill {share:.0%}; Maxwell Garnett's rule is for few, "
                    f"up to about {MOST_INCLUSIONS:.0%}"
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
        # beyond a thousand grains' size no medium's n makes them coarse
        shortest, longest = self.wavelength_range
        longest = min(longest, 1e3 * self.grain)  # type: ignore[operator]
        if not 0.0 < shortest < longest:
            shortest = 1e-3 * longest
        wavelength = np.geomspace(shortest, longest, _TRIED)
        n, _ = self.index(wavelength)
        if is_traced(n):
            return 0.0
        coarse = wavelength[self.grain * n > COARSEST_GRAIN * wavelength]
        return float(coarse[-1]) if coarse.size else 0.0


def porous(
    medium: Medium,
    porosity: Numeric,
    *,
    rule: Rule | str = Rule.BRUGGEMAN,
    depolarisation: Numeric = SPHERES,
    grain: float | None = None,
) -> Mixture:
    """A medium with empty pores.

    Parameters
    ----------
    medium : Medium
    porosity : float
        Volume fraction of the pores [1].
    rule, depolarisation, grain
        See :class:`Mixture`.

    Returns
    -------
    Mixture
    """
    return Mixture((medium, vacuum()), (porosity,), _rule(rule), depolarisation, grain)


class Graded(_Compound):
    """A mixture whose fractions change linearly with depth, as sheets of one composition each.

    Attributes
    ----------
    parts : tuple of Medium
        See :class:`Mixture`.
    top, bottom : array, shape (parts - 1,)
        Volume fractions of the parts behind the first at the layer's upper and lower end [1].
    rule, depolarisation, grain, measured_density
        See :class:`Mixture`.
    count : int
        Sheets; each has the composition of its middle.

    Notes
    -----
    The error of reflectance and transmittance falls with the square of the number of sheets. With
    the default of 20 it is below 1e-3 where the optical thickness of the layer is up to about a
    wavelength; the tests show the order, and doubling ``count`` shows the error of a film.

    Examples
    --------
    >>> from lightflyer.film import Film, Layer, material
    >>> fading = Graded((material("Si"), material("SiO2")), 0.0, 1.0)
    >>> film = Film((Layer(fading, 200e-9),))
    >>> print(f"{film.optics(1e-6).reflectance[0]:.3f}")
    0.198
    """

    parts: tuple[Medium, ...]
    top: Numeric = eqx.field(converter=lambda value: _vector(value))
    bottom: Numeric = eqx.field(converter=lambda value: _vector(value))
    rule: Rule = eqx.field(static=True, default=Rule.BRUGGEMAN, converter=lambda name: _rule(name))
    depolarisation: Numeric = SPHERES
    grain: float | None = eqx.field(static=True, default=None)
    measured_density: Numeric | None = None
    count: int = eqx.field(static=True, default=SHEETS)

    def __check_init__(self) -> None:
        if self.count < 1:
            raise ParameterError(f"count = {self.count} is no number of sheets")
        self._at(0.0), self._at(1.0)  # raise

    def _at(self, depth: float) -> Mixture:
        """The mixture at a depth, as a share of the thickness."""
        fractions = _between(self.top, self.bottom, depth)
        return Mixture(
            self.parts, fractions, self.rule, self.depolarisation, self.grain, self.measured_density
        )

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
        """See :attr:`Medium.sheets`."""
        return tuple(self._at((number + 0.5) / self.count) for number in range(self.count))

    def flipped(self) -> "Graded":
        """The medium upside down."""
        return eqx.tree_at(lambda one: (one.top, one.bottom), self, (self.bottom, self.top))

    def index(self, wavelength: ArrayLike) -> tuple[Numeric, Numeric]:
        """Refractive index and extinction coefficient halfway down; see :meth:`Medium.index`."""
        return self._at(0.5).index(wavelength)

    @property
    def caveats(self) -> tuple[str, ...]:
        """See :attr:`Medium.caveats`: those of the mixtures at both ends."""
        found = (*self._at(0.0).caveats, *self._at(1.0).caveats)
        sheets = f"{self.name} is computed as {self.count} sheets"
        return (*dict.fromkeys(found), sheets)


class Tempered(_Compound):
    """A medium whose n and k are measured at several temperatures, at one between them.

    Attributes
    ----------
    parts : tuple of Medium
        One per temperature.
    temperatures : tuple of float
        Of the parts, increasing [K].
    temperature : array
        Of the layer [K]; n and k are linear between the two nearest tables.
    measured_density : array or None
        Mass density [kg/m³]; by default that of the first part that has one.

    Raises
    ------
    ParameterError
        If temperatures do not increase, or a concrete ``temperature`` is outside them.

    Notes
    -----
    The layer's temperature is stated: it does not follow from a flyer's heat balance.
    Differentiable in the temperature, from one side at the tables' temperatures.
    """

    parts: tuple[Medium, ...]
    temperatures: tuple[float, ...] = eqx.field(static=True)
    temperature: Numeric
    measured_density: Numeric | None = None

    def __check_init__(self) -> None:
        steps = np.diff(self.temperatures)
        if len(self.parts) < 2 or len(self.parts) != len(self.temperatures) or np.any(steps <= 0.0):
            raise ParameterError(
                "media at two or more temperatures, which increase, are needed; given are "
                f"{len(self.parts)} at {', '.join(f'{one:g}' for one in self.temperatures)} K"
            )
        name = f"temperature of {self.name}"
        require_range(name, self.temperature, self.temperatures[0], self.temperatures[-1])

    @property
    def name(self) -> str:
        """The parts' names."""
        return " / ".join(dict.fromkeys(part.name for part in self.parts))

    @property
    def density(self) -> Numeric | None:
        """Mass density [kg/m³]."""
        if self.measured_density is not None:
            return self.measured_density
        return next((one.density for one in self.parts if one.density is not None), None)

    @property
    def density_source(self) -> str:
        """Where the density comes from, or why it is unknown."""
        if self.measured_density is not None:
            return GIVEN
        known = (one.density_source for one in self.parts if one.density is not None)
        return next(known, self.parts[0].density_source)

    def index(self, wavelength: ArrayLike) -> tuple[Numeric, Numeric]:
        """See :meth:`Medium.index`."""
        n, k = _indices(self.parts, np.asarray(wavelength, float))
        return _interpolated(n, k, np.array(self.temperatures), self.temperature)

    @property
    def caveats(self) -> tuple[str, ...]:
        """See :attr:`Medium.caveats`: the temperature, and those of the parts."""
        at = f"{float(self.temperature):g} K" if is_concrete(self.temperature) else "a temperature"
        tables = ", ".join(f"{one:g}" for one in self.temperatures)
        own = f"{self.name} has n and k at {at}, linear between tables at {tables} K"
        parts = [
            text for part in self.parts for text in part.caveats if " has n and k at " not in text
        ]
        return (own, *dict.fromkeys(parts))


def tempered(parts: Sequence[Material], temperature: Numeric) -> Tempered:
    """A medium at a temperature between those of its tables.

    Parameters
    ----------
    parts : sequence of Material
        That state their temperature, such as pages of refractiveindex.info, in any order.
    temperature : float
        [K].

    Returns
    -------
    Tempered

    Raises
    ------
    ParameterError
        If a part states no temperature.

    Examples
    --------
    >>> from lightflyer.film import material
    >>> warm = tempered([material(f"main/Si/Franta-{T}K") for T in (300, 400)], 350.0)
    >>> print(f"{warm.index(10e-6)[0]:.4f}")
    3.4280
    """
    for part in parts:
        if part.temperature is None:
            raise ParameterError(f"{part.name} states no temperature; use Tempered and give it")
    ordered = {float(part.temperature or 0.0): part for part in parts}
    known = tuple(sorted(ordered))
    return Tempered(tuple(ordered[one] for one in known), known, temperature)


def _timeless(part: Medium) -> Medium:
    """A medium that does not tell its temperature, which is told otherwise."""
    return dataclasses.replace(part, temperature=None) if isinstance(part, Material) else part


def _rule(name: Rule | str) -> Rule:
    try:
        return Rule(name)
    except ValueError:
        raise ParameterError(f'rule "{name}" is unknown; choose from {", ".join(Rule)}') from None


def _vector(value: Any) -> Numeric:
    """Fractions as a vector; JAX rebuilds modules around placeholders, which stay."""
    if isinstance(value, list | tuple) and is_traced(value):
        return _stacked(tuple(value))
    if is_traced(value):
        return value if np.ndim(value) else value[None]
    return np.atleast_1d(np.asarray(value, float))


@entry_point
def _stacked(values: tuple[Numeric, ...]) -> Numeric:
    return jnp.stack(values)


@entry_point
def _with_rest(fractions: Numeric) -> Numeric:
    return jnp.concatenate([(1.0 - fractions.sum())[None], fractions])


@entry_point
def _between(first: Numeric, last: Numeric, share: Numeric) -> Numeric:
    return first + share * (last - first)


@entry_point
def _interpolated(
    n: Numeric, k: Numeric, temperatures: Numeric, temperature: Numeric
) -> tuple[Numeric, Numeric]:
    steps = jnp.searchsorted(temperatures, temperature, side="right") - 1
    lower = jnp.clip(steps, 0, temperatures.size - 2)
    share = (temperature - temperatures[lower]) / (temperatures[lower + 1] - temperatures[lower])
    return (
        n[lower] + share * (n[lower + 1] - n[lower]),
        k[lower] + share * (k[lower + 1] - k[lower]),
    )


def _indices(parts: Sequence[Medium], wavelength: np.ndarray) -> tuple[Numeric, Numeric]:
    """Values of n and k of each part, shape (parts, ...)."""
    pairs = [part.index(wavelength) for part in parts]
    stack = _stacked if is_traced(pairs) else np.stack
    return stack(tuple(pair[0] for pair in pairs)), stack(tuple(pair[1] for pair in pairs))
