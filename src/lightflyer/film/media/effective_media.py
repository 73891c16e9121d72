r"""Refractive index of fine mixtures: laws of effective media, as plain functions.

A mixture of parts with permittivities :math:`\varepsilon_i=(n_i+ik_i)^2` and volume fractions
:math:`f_i`, much finer than the wavelength, acts as a medium of one permittivity
:math:`\varepsilon`. Which one depends on the arrangement of the parts.
"""

from collections.abc import Callable
from typing import TypeAlias

from lightflyer.core.checks import Choice
from lightflyer.core.types import Numeric
from lightflyer.film.media.pairs import Pair, multiply_real, over, plus, root, sum_first_axis, times
from lightflyer.program.entry_point import entry_point
from lightflyer.pytree.lazy_jax import Array, jnp, lax

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
    index, fraction = _pair(n, k), _align(fraction, jnp.ndim(n))
    solve = _bruggeman_of_two if index[0].shape[0] == 2 else _bruggeman_of_many
    return _index(solve(index, fraction, depolarisation))


def _bruggeman_of_two(index: Pair, fraction: Array, depolarisation: Numeric) -> Pair:
    """Permittivity over the geometric mean of both: a quadratic's root with real part > 0."""
    # The product of the roots is real and negative, so exactly one has a positive real part, and it
    # is the one with the principal square root.
    scale = times((index[0][0], index[1][0]), (index[0][1], index[1][1]))
    weight = fraction - depolarisation
    middle = over(sum_first_axis(multiply_real(times(index, index), weight)), scale)
    square = times(middle, middle)
    other = 1.0 - depolarisation
    inside = square[0] + 4.0 * depolarisation * other, square[1]
    return multiply_real(times(scale, plus(middle, root(inside))), 0.5 / other)


def _bruggeman_of_many(index: Pair, fraction: Array, depolarisation: Numeric) -> Pair:
    """The root as an eigenvalue of a diagonal matrix changed by one of rank one."""
    permittivity, other = times(index, index), 1.0 - depolarisation
    pole = multiply_real(permittivity, -depolarisation / other)
    residue = multiply_real(permittivity, fraction / other)
    value = _eigenvalue(*(lax.stop_gradient(part) for part in (permittivity, pole, residue)))
    for _ in range(_POLISHING):
        apart = value[0] - pole[0], value[1] - pole[1]
        terms = over(residue, apart)
        excess, slope = sum_first_axis(terms), sum_first_axis(over(terms, apart))
        value = plus(value, over((excess[0] - 1.0, excess[1]), slope))
    return value


def _eigenvalue(permittivity: Pair, pole: Pair, residue: Pair) -> Pair:
    """Eigenvalue in the half-plane of the permittivities."""
    poles, residues = (
        jnp.moveaxis(lax.complex(*jnp.broadcast_arrays(*part)), 0, -1) for part in (pole, residue)
    )
    matrix = poles[..., None] * jnp.eye(poles.shape[-1]) + residues[..., None]
    roots = jnp.linalg.eigvals(matrix)
    angle = jnp.arctan2(permittivity[1], permittivity[0])
    middle = 0.5 * (angle.min(axis=0) + angle.max(axis=0))[..., None]
    towards = (roots.real * jnp.cos(middle) + roots.imag * jnp.sin(middle)) / jnp.abs(roots)
    chosen = jnp.argmax(towards, axis=-1)[..., None]
    value = jnp.take_along_axis(roots, chosen, axis=-1)[..., 0]
    return value.real, value.imag


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
    index, fraction = _pair(n, k), _align(fraction, jnp.ndim(n))
    permittivity = times(index, index)
    host = permittivity[0][0], permittivity[1][0]
    rest = permittivity[0][1:] - host[0], permittivity[1][1:] - host[1]
    factors = jnp.atleast_1d(depolarisation)
    moment = above = jnp.zeros(()), jnp.zeros(())
    for factor in factors:
        one = sum_first_axis(
            multiply_real(over(rest, plus(host, multiply_real(rest, factor))), fraction[1:])
        )
        moment = plus(moment, multiply_real(one, 1.0 / factors.size))
        above = plus(above, multiply_real(one, factor / factors.size))
    more = over(moment, (1.0 - above[0], -above[1]))
    return _index(times(host, (1.0 + more[0], more[1])))


@entry_point
def parallel(
    n: Numeric, k: Numeric, fraction: Numeric, depolarisation: Numeric = 0.0
) -> tuple[Numeric, Numeric]:
    """Parts side by side along the field: the mean of the permittivities; [Markel2016]_."""
    # Wiener's bound, which no arrangement of lossless parts exceeds.
    #
    # .. math:: \varepsilon=\sum_i f_i\varepsilon_i
    del depolarisation
    index = _pair(n, k)
    return _index(sum_first_axis(multiply_real(times(index, index), _align(fraction, jnp.ndim(n)))))


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
    index, fraction = _pair(n, k), _align(fraction, jnp.ndim(n))
    shares = over((fraction, jnp.zeros_like(fraction)), times(index, index))
    inverse = sum_first_axis(shares)
    return _index(over((jnp.ones_like(inverse[0]), jnp.zeros_like(inverse[0])), inverse))


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


def _pair(n: Numeric, k: Numeric) -> Pair:
    return jnp.asarray(n), jnp.asarray(k)


def _align(fraction: Numeric, axes: int) -> Array:
    """Fractions with the axes of the indices behind the first."""
    fraction = jnp.asarray(fraction)
    return fraction.reshape(fraction.shape + (1,) * (axes - fraction.ndim))


def _index(permittivity: Pair) -> Pair:
    """Index from a permittivity in the upper half-plane."""
    n, k = root(permittivity)
    return n, jnp.where(k < 0.0, 0.0, k)  # rounding of lossless parts
