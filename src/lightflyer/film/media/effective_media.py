r"""Refractive index of fine mixtures: laws of effective media, as plain functions.

A mixture of parts with permittivities :math:`\varepsilon_i=(n_i+ik_i)^2` and volume fractions
:math:`f_i`, much finer than the wavelength, acts as a medium of one permittivity
:math:`\varepsilon`. Which one depends on the arrangement of the parts.
"""

from collections.abc import Callable
from typing import TypeAlias

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.transformations import stop_gradient
from lightflyer.core.checks import Choice
from lightflyer.core.entry_point import entry_point
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
