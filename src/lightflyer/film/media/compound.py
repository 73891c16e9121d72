r"""Media of several others: what they share, and laws by which fine mixtures act as one.

A mixture of parts with permittivities :math:`\varepsilon_i=(n_i+ik_i)^2` and volume fractions
:math:`f_i`, much finer than the wavelength, acts as a medium of one permittivity
:math:`\varepsilon`. Which one depends on the arrangement of the parts.
"""

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from lightflyer.array import tree
from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import AbstractVar, field
from lightflyer.array.transformations import stop_gradient
from lightflyer.core.checks import Choice, is_concrete, is_traced, require_range
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.film.media.materials import Material
from lightflyer.film.media.medium import GIVEN, Extrapolation, Medium, common_range
from lightflyer.numerics.special import imaginary, real

SPHERES = 1.0 / 3.0  # Depolarisation factor of spheres

_POLISHING = 2  # Newton steps, after which first and second derivatives are exact too

Law: TypeAlias = Callable[[Numeric, Numeric, Numeric, Numeric], tuple[Numeric, Numeric]]


@entry_point
def bruggeman(
    n: Numeric, k: Numeric, fraction: Numeric, depolarisation: Numeric = SPHERES
) -> tuple[Numeric, Numeric]:
    r"""Mixture of grains of which none is the host of others.

    .. math:: \sum_i f_i\frac{\varepsilon_i-\varepsilon}{\varepsilon+L(\varepsilon_i-\varepsilon)}=0

    Parameters
    ----------
    n, k : array, shape (parts, ...)
        Real and imaginary part of each part's refractive index [1].
    fraction : array, shape (parts, ...) or (parts,)
        Volume fractions, whose sum is one [1].
    depolarisation : float
        Depolarisation factor L of the grains along the field, above 0 and below 1 [1].

    Returns
    -------
    n, k : array, shape (...)
        Of the mixture.

    Notes
    -----
    The equation has one root in each half-plane through the origin that holds all
    :math:`\varepsilon_i`: where a root lay on the border, :math:`\sum_i f_i/(1-L+L\varepsilon_i
    /\varepsilon)=1` would have terms whose imaginary parts have one sign. The root is therefore
    unique between the directions of the :math:`\varepsilon_i`, and cannot jump while parameters
    vary. For two parts it is the quadratic's, in closed form; for more it is an eigenvalue,
    polished by Newton's method. Differentiable in all arguments.

    References
    ----------
    [Bruggeman1935]_; with depolarisation factors [Markel2016]_.

    Examples
    --------
    >>> n, k = bruggeman([1.0, 1.5], [0.0, 0.0], [0.5, 0.5])
    >>> print(f"{n:.4f} {k:.1f}")
    1.2418 0.0
    """
    index, fraction = xp.asarray(n) + 1j * xp.asarray(k), _align(fraction, xp.ndim(n))
    solve = _bruggeman_of_two if index.shape[0] == 2 else _bruggeman_of_many
    return _index(solve(index, fraction, depolarisation))


def _bruggeman_of_two(index: Array, fraction: Array, depolarisation: Numeric) -> Array:
    """Permittivity over the geometric mean of both: a quadratic's root with real part > 0."""
    # The product of the roots is real and negative, so exactly one has a positive real part, and it
    # is the one with the principal square root.
    scale, other = index[0] * index[1], 1.0 - depolarisation
    middle = (index * index * (fraction - depolarisation)).sum(axis=0) / scale
    inside = middle * middle + 4.0 * depolarisation * other
    return scale * (middle + xp.sqrt(inside)) * (0.5 / other)


def _bruggeman_of_many(index: Array, fraction: Array, depolarisation: Numeric) -> Array:
    """The root as an eigenvalue of a diagonal matrix changed by one of rank one."""
    permittivity, other = index * index, 1.0 - depolarisation
    pole, residue = permittivity * (-depolarisation / other), permittivity * (fraction / other)
    constant, poles, residues = stop_gradient((permittivity, pole, residue))
    poles, residues = xp.moveaxis(poles, 0, -1), xp.moveaxis(residues, 0, -1)
    roots = xp.linalg.eigvals(poles[..., None] * xp.eye(poles.shape[-1]) + residues[..., None])
    # the one in the half-plane of the permittivities
    angle = xp.arctan2(imaginary(constant), real(constant))
    middle = 0.5 * (angle.min(axis=0) + angle.max(axis=0))[..., None]
    towards = (real(roots) * xp.cos(middle) + imaginary(roots) * xp.sin(middle)) / xp.abs(roots)
    chosen = xp.argmax(towards, axis=-1)[..., None]
    value = xp.take_along_axis(roots, chosen, axis=-1)[..., 0]
    for _ in range(_POLISHING):
        terms = residue / (value - pole)
        value = value + (terms.sum(axis=0) - 1.0) / (terms / (value - pole)).sum(axis=0)
    return value


@entry_point
def maxwell_garnett(
    n: Numeric, k: Numeric, fraction: Numeric, depolarisation: Numeric = SPHERES
) -> tuple[Numeric, Numeric]:
    """Separate inclusions in a host; ``n``, ``k`` (parts, ...); ``fraction`` (parts, ...)."""
    # .. math::
    #     \frac{\varepsilon}{\varepsilon_0}
    #     = 1+\frac{\sum_{i>0} f_i\langle a_{ij}\rangle_j}
    #     {1-\sum_{i>0} f_i\langle L_ja_{ij}\rangle_j},\qquad
    #     a_{ij}=\frac{\varepsilon_i-\varepsilon_0}
    #     {\varepsilon_0+L_j(\varepsilon_i-\varepsilon_0)}
    #
    # For inclusions that are few. Differentiable in all arguments.
    #
    # Source: [MaxwellGarnett1904]_; for several parts and ellipsoids in several orientations
    # [Markel2016]_.
    permittivity, fraction = _permittivity(n, k), _align(fraction, xp.ndim(n))
    host = permittivity[0]
    rest = permittivity[1:] - host
    factors = xp.atleast_1d(depolarisation)
    moment = above = 0.0
    for factor in factors:
        one = (rest / (host + rest * factor) * fraction[1:]).sum(axis=0) / factors.size
        moment, above = moment + one, above + one * factor
    return _index(host * (1.0 + moment / (1.0 - above)))


@entry_point
def parallel(
    n: Numeric, k: Numeric, fraction: Numeric, depolarisation: Numeric = 0.0
) -> tuple[Numeric, Numeric]:
    """Parts side by side along the field: the mean of the permittivities; [Markel2016]_."""
    # Wiener's bound, which no arrangement of lossless parts exceeds.
    #
    # .. math:: \varepsilon=\sum_i f_i\varepsilon_i
    del depolarisation
    return _index((_permittivity(n, k) * _align(fraction, xp.ndim(n))).sum(axis=0))


@entry_point
def series(
    n: Numeric, k: Numeric, fraction: Numeric, depolarisation: Numeric = 1.0
) -> tuple[Numeric, Numeric]:
    """Parts one behind the other along the field: the harmonic mean of the permittivities."""
    # Wiener's bound, below which no arrangement of lossless parts is.
    #
    # .. math:: \frac1\varepsilon=\sum_i\frac{f_i}{\varepsilon_i}
    #
    # Source: [Markel2016]_.
    del depolarisation
    return _index(1.0 / (_align(fraction, xp.ndim(n)) / _permittivity(n, k)).sum(axis=0))


class Rule(Choice):
    """Law of a mixture by its name in a flyer file."""

    BRUGGEMAN = "bruggeman"
    MAXWELL_GARNETT = "maxwell-garnett"
    PARALLEL = "parallel"
    SERIES = "series"

    @property
    def law(self) -> Law:
        """Its function."""
        return _LAWS[self]


class Shape(Choice):
    """Shape and orientation of grains, by its name in a flyer file."""

    SPHERES = "spheres"
    COLUMNS = "columns"
    """Along the film's normal."""
    NEEDLES = "needles"
    """Long, in all directions."""
    MAT = "mat"
    """Long, in all directions within the plane of the film."""

    @property
    def factors(self) -> tuple[float, ...]:
        """Depolarisation factors along a field in the film's plane, of equal frequency [1]."""
        return _FACTORS[self]

    @property
    def is_isotropic(self) -> bool:
        """Whether a mixture of such grains is the same in all directions."""
        return self in (Shape.SPHERES, Shape.NEEDLES)


_FACTORS: dict[Shape, tuple[float, ...]] = {
    Shape.SPHERES: (SPHERES,),
    Shape.COLUMNS: (0.5,),
    Shape.NEEDLES: (0.0, 0.5, 0.5),
    Shape.MAT: (0.0, 0.5),
}

_LAWS: dict[Rule, Law] = {
    Rule.BRUGGEMAN: bruggeman,
    Rule.MAXWELL_GARNETT: maxwell_garnett,
    Rule.PARALLEL: parallel,
    Rule.SERIES: series,
}


def _permittivity(n: Numeric, k: Numeric) -> Array:
    index = xp.asarray(n) + 1j * xp.asarray(k)
    return index * index


def _align(fraction: Numeric, axes: int) -> Array:
    """Fractions with the axes of the indices behind the first."""
    fraction = xp.asarray(fraction)
    return fraction.reshape(fraction.shape + (1,) * (axes - fraction.ndim))


def _index(permittivity: Array) -> tuple[Array, Array]:
    """Index from a permittivity in the upper half-plane."""
    index = xp.sqrt(permittivity)
    n, k = real(index), imaginary(index)
    return n, xp.where(k < 0.0, 0.0, k)  # rounding of lossless parts


class Compound(Medium):
    """A medium of several others, whose ranges, policies and sources it has."""

    # A subclass has the fields ``parts`` and ``measured_density``.

    if TYPE_CHECKING:

        @property
        def parts(self) -> tuple[Medium, ...]: ...

    else:
        parts: AbstractVar[tuple[Medium, ...]]

    @property
    def wavelength_range(self) -> tuple[float, float]:
        """Wavelengths at which all parts have data [m]."""
        return common_range(part.wavelength_range for part in self.parts)

    @property
    def usable_range(self) -> tuple[float, float]:
        return common_range(part.usable_range for part in self.parts)

    @property
    def source(self) -> str:
        return "; ".join(dict.fromkeys(part.source for part in self.parts))

    def extrapolations(self, shortest: float, longest: float) -> tuple[str, ...]:
        found = (text for part in self.parts for text in part.extrapolations(shortest, longest))
        return tuple(dict.fromkeys(found))

    def with_extrapolation(self, policy: Extrapolation | str) -> Any:
        parts = tuple(part.with_extrapolation(policy) for part in self.parts)
        return tree.replace_at(lambda one: one.parts, self, parts)

    def with_density(self, density: Numeric) -> Any:
        """The same medium with a measured density, not that of its parts [kg/m³]."""
        return tree.replace_at(lambda one: one.measured_density, self, density)


def indices(media: Sequence[Medium], wavelength: np.ndarray) -> tuple[Numeric, Numeric]:
    """Values of n and k of media, shape (media, ...); ``wavelength``: concrete."""
    n, k = zip(*(medium.index(wavelength) for medium in media), strict=True)
    return stack_arrays(n), stack_arrays(k)


@entry_point
def stack_arrays(values: tuple[Numeric, ...]) -> Numeric:
    """One array of several, in double precision."""
    return xp.stack(xp.broadcast_arrays(*values))


def vector(value: Any) -> Numeric:
    """Fractions as a vector, from a number or a sequence of numbers that may be traced."""
    if isinstance(value, list | tuple) and is_traced(value):
        return stack_arrays(tuple(value))
    if is_traced(value):
        return value if np.ndim(value) else value[None]
    return np.atleast_1d(np.asarray(value, float))


class TemperatureDependentMedium(Compound):
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
    Differentiable in the temperature, from one side at the tables' temperatures. A traced
    temperature beyond the tables, such as a rare sample of an uncertain one, has the values of the
    nearest.
    """

    parts: tuple[Medium, ...]
    temperatures: tuple[float, ...] = field(static=True)
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
        n, k = indices(self.parts, np.asarray(wavelength, float))
        return _interpolate(n, k, np.array(self.temperatures), self.temperature)

    @property
    def diagnostics(self) -> tuple[str, ...]:
        """Warns of the temperature, and repeats what the parts warn of."""
        at = f"{float(self.temperature):g} K" if is_concrete(self.temperature) else "a temperature"
        tables = ", ".join(f"{one:g}" for one in self.temperatures)
        between = f"{self.name} has n and k at {at}, linear between tables at {tables} K"
        parts = [
            text
            for part in self.parts
            for text in part.diagnostics
            if " has n and k at " not in text
        ]
        return (between, *dict.fromkeys(parts))


def at_temperature(parts: Sequence[Material], temperature: Numeric) -> TemperatureDependentMedium:
    """A medium at a temperature between those of its tables.

    Parameters
    ----------
    parts : sequence of Material
        That state their temperature, such as pages of refractiveindex.info, in any order.
    temperature : float
        [K].

    Returns
    -------
    TemperatureDependentMedium

    Raises
    ------
    ParameterError
        If a part states no temperature.

    Examples
    --------
    >>> from lightflyer.film import material
    >>> warm = at_temperature([material(f"main/Si/Franta-{T}K") for T in (300, 400)], 350.0)
    >>> print(f"{warm.index(10e-6)[0]:.4f}")
    3.4280
    """
    for part in parts:
        if part.temperature is None:
            raise ParameterError(
                f"{part.name} states no temperature; use TemperatureDependentMedium and give it"
            )
    ordered = {float(part.temperature or 0.0): part for part in parts}
    known = tuple(sorted(ordered))
    return TemperatureDependentMedium(tuple(ordered[one] for one in known), known, temperature)


@entry_point
def _interpolate(
    n: Numeric, k: Numeric, temperatures: Numeric, temperature: Numeric
) -> tuple[Numeric, Numeric]:
    steps = xp.searchsorted(temperatures, temperature, side="right") - 1
    lower = xp.clip(steps, 0, temperatures.size - 2)
    share = (temperature - temperatures[lower]) / (temperatures[lower + 1] - temperatures[lower])
    share = xp.clip(share, 0.0, 1.0)  # of a traced temperature, which may be beyond
    return (
        n[lower] + share * (n[lower + 1] - n[lower]),
        k[lower] + share * (k[lower + 1] - k[lower]),
    )
