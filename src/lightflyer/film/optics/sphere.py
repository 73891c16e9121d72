"""What a homogeneous sphere does with light and heat radiation, by the theory of Mie.

It scatters, absorbs, and is heated unevenly: the asymmetry of its heat sources drives
photophoresis. Where a particle of any shape absorbs light comes from a file of a program such as
ADDA.
"""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from lightflyer.array.namespace import Numeric
from lightflyer.array.records import Module, field, short_repr
from lightflyer.core.checks import is_traced, require_positive, require_range
from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import Length, Quantity
from lightflyer.files.table import read_table
from lightflyer.files.table_layout import Column
from lightflyer.film.media.medium import Medium
from lightflyer.film.optics.averages import (
    COARSE_POINTS_PER_E_FOLD,
    light_coverage,
    light_grid,
    thermal_coverage,
    thermal_grid,
)
from lightflyer.film.optics.curve import EmittanceCurve, node_temperatures
from lightflyer.film.optics.spectra import Spectrum, am0
from lightflyer.film.optics.stack import Film, Layer

LARGEST_SIZE = 1e4
"""Largest size parameter that is computed [1]."""

_SERIES = (4.05, 12.0)  # factor of x^(1/3) and orders beyond x of the series [1]
_CONVERGED = 20.0  # of the inner recurrence, in e-folds of amplitude
_AT_ONCE = 512  # Spheres computed at a time, and orders times spheres: what memory they need
_ORDERS_AT_ONCE = 500_000
_TYPICAL, _NEARLY_ALL = 300.0, 0.999  # Temperature [K] and share at which data are reported missing
_LEAST_WEIGHT = 1e-10  # of a wavelength in an average, over the largest

_COLUMNS = (
    *(Column(name, Quantity(), required=True, any_unit=True) for name in "xyz"),
    Column("q", Quantity("", 0.0), ("|E|^2",), required=True, any_unit=True),
)
_ROUNDED = 0.01  # of a grid step: digits that a file leaves out
_IN_A_POINT = (
    0.75  # Asymmetry factor over efficiency, where all is absorbed in one place of the surface
)


class Mie(NamedTuple):
    """Efficiencies of a sphere in a plane wave: powers over that which falls on its cross-section.

    Each of the shape of index and size parameter.
    """

    extinction: np.ndarray  #: Scattered and absorbed [1]
    scattering: np.ndarray  #: [1]
    absorption: np.ndarray  #: [1]
    asymmetry: np.ndarray  #: Mean cosine of the scattering angle, g [1]
    #: Asymmetry factor of the heat sources, J₁ [1]: 1/2 for an opaque sphere, which is heated on
    #: its lit side, negative where it is heated on its far side
    source_asymmetry: np.ndarray

    @property
    def pressure(self) -> np.ndarray:
        """Efficiency of radiation pressure [1]."""
        return np.asarray(self.extinction - self.asymmetry * self.scattering)

    def __repr__(self) -> str:
        return short_repr(self)


def mie(index: ArrayLike, size: ArrayLike) -> Mie:
    r"""Efficiencies of a homogeneous sphere in a plane wave, and asymmetry of its heat sources.

    The asymmetry factor is the first moment of the absorbed power :math:`q` [W/m³] in light of the
    irradiance :math:`I`, :math:`z` towards the light,

    .. math:: J_1 = \frac{3}{4\pi a^3 I}\int q\,z\,\mathrm{d}V

    Parameters
    ----------
    index : complex array, shape (...)
        Refractive index of the sphere over that of the gas [1]; :math:`n-ik` and :math:`n+ik` mean
        the same absorbing sphere.
    size : array, shape (...)
        Size parameter, circumference over wavelength, :math:`x = 2\pi a/\lambda` [1].

    Returns
    -------
    Mie

    Raises
    ------
    ParameterError
        If a size parameter is not positive or above :data:`LARGEST_SIZE`, or an index is not
        finite or its real part not positive.

    Notes
    -----
    Both integrals over the sphere, of :math:`q` and of :math:`qz`, are sums over products of
    the internal coefficients with

    .. math::
        G_n = \int_0^1 |\psi_n(mxr)|^2\,\mathrm{d}r,\qquad
        W_n = \int_0^1 r\,\psi_n(mxr)\,\psi_{n+1}^*(mxr)\,\mathrm{d}r,

    which follow from downward recurrences that lose no digits where absorption is weak.

    References
    ----------
    [BohrenHuffman1983]_ ch. 4 for the coefficients; [Mackowski1989]_ for :math:`J_1`.

    Examples
    --------
    >>> print(f"{mie(1.57 - 0.038j, 10.0).source_asymmetry:.10f}")
    -0.0544132904
    """
    m, x = np.broadcast_arrays(np.asarray(index, complex), np.asarray(size, float))
    require_range("size", x, 0.0, LARGEST_SIZE, open_below=True)
    if not np.all(np.isfinite(m) & (m.real > 0.0)):
        raise ParameterError("index must be finite and have a positive real part")
    found = np.empty((len(Mie._fields), x.size))
    # spheres whose recurrences are as long stand together
    order = np.argsort(np.abs(m * x).ravel(), kind="stable")
    flat = m.real.ravel() + 1j * np.abs(m.imag.ravel()), x.ravel()
    at_once = int(min(_AT_ONCE, max(1.0, _ORDERS_AT_ONCE / np.max(x, initial=1.0))))
    for start in range(0, x.size, at_once):
        part = order[start : start + at_once]
        found[:, part] = _efficiencies(flat[0][part], flat[1][part])
    return Mie(*(one.reshape(x.shape)[()] for one in found))


class SphereAbsorption(Module):
    """What a sphere absorbs and emits, averaged over light and over heat radiation."""

    #: Power absorbed over that of the light on its cross-section [1]
    absorption_efficiency: Numeric
    #: Asymmetry factor J₁ of the heat sources in this light [1]
    asymmetry: Numeric
    #: Efficiency of the light's radiation pressure [1]
    pressure: Numeric
    #: Emittance of its surface 4πa², which may be above one, over its temperature
    emittance: EmittanceCurve
    #: Asymmetry factor J₁ of the heat sources in parallel rays of a black body, over its
    #: temperature
    infrared_asymmetry: EmittanceCurve
    #: What a reader must know of the data, one line each
    diagnostics: tuple[str, ...] = field(static=True, default=())


@reads_units
def sphere_absorption(
    medium: Medium, radius: Length, light: Spectrum | None = None
) -> SphereAbsorption:
    """Averages of a homogeneous sphere over light and over heat radiation.

    Parameters
    ----------
    medium : Medium
        With k > 0 where it is to absorb.
    radius : array, shape (...)
        [m].
    light : Spectrum, optional
        By default sunlight above the atmosphere; :func:`spectral_line` makes that of a laser.

    Returns
    -------
    SphereAbsorption
        Of the shape of the radius.

    Raises
    ------
    ParameterError
        If the radius is not positive, or so large that its size parameter is above
        :data:`LARGEST_SIZE`; if the light has no power where the medium has data.

    Notes
    -----
    The means are over those wavelengths at which the medium has data or extrapolates. They are
    computed by NumPy, without derivatives.

    References
    ----------
    [BohrenHuffman1983]_ ch. 4; [ASTME490]_ for sunlight.

    Examples
    --------
    >>> from lightflyer.film import material
    >>> carbon = sphere_absorption(material("a-C", extrapolation="hold"), 0.5e-6)
    >>> absorbed, asymmetry = carbon.absorption_efficiency, carbon.asymmetry
    >>> print(f"{absorbed:.2f}, {carbon.emittance(300.0):.3f}, {asymmetry:.2f}")
    1.27, 0.195, 0.28
    """
    if is_traced(medium, radius):
        raise ParameterError("the optics of a sphere have no derivatives: give concrete numbers")
    require_positive(radius=radius)
    if len(medium.sheets) > 1:
        raise ParameterError(f"{medium.name} changes with depth: a sphere needs a uniform medium")
    film = Film((Layer(medium, 1e-6),))
    light = am0() if light is None else light
    grids = (
        light_grid(film, light, 0.0, diffuse=False),
        thermal_grid(
            film, node_temperatures(), normal=True, points_per_e_fold=COARSE_POINTS_PER_E_FOLD
        ),
    )
    radii, places = np.unique(radius, return_inverse=True)
    means = []
    for grid in grids:
        weights = grid.mean_weight
        used = np.any(weights > _LEAST_WEIGHT * weights.max(axis=1, keepdims=True), axis=0)
        n, k = medium.index(wavelength := grid.wavelength[used])
        size = 2.0 * np.pi * radii[:, None] / wavelength
        if size.max() > LARGEST_SIZE:
            raise ParameterError(
                f"radius = {radii[-1]:g} m is too large for the theory of Mie: its circumference "
                f"is {size.max():.3g} wavelengths of {wavelength[0] * 1e6:.3g} µm, at most "
                f"{LARGEST_SIZE:g} are computed; give what it absorbs and emits"
            )
        optics = mie(n + 1j * k, size)
        spectral = np.stack([optics.absorption, optics.source_asymmetry, optics.pressure])
        means.append((spectral @ weights[:, used].T)[:, places])
    absorption, asymmetry, pressure = means[0].reshape(3, *np.shape(radius))
    emittance, infrared = means[1][:2].reshape(2, *np.shape(radius), -1)
    reach = next(iter(medium.extrapolations(0.0, np.inf)), medium.describe_range())
    shares = {
        light.name: light_coverage(film, light),
        f"heat radiation at {_TYPICAL:g} K": float(thermal_coverage(film, _TYPICAL)),
    }
    diagnostics = medium.diagnostics + tuple(
        f"{reach}; its data cover {100.0 * share:.3g} % of {name}"
        for name, share in shares.items()
        if share < _NEARLY_ALL
    )
    return SphereAbsorption(
        *(absorption[()], asymmetry[()], pressure[()]),
        *(EmittanceCurve.through(emittance), EmittanceCurve.through(infrared)),
        diagnostics,
    )


class _Inside(NamedTuple):
    """What the field of each order is within the sphere, relative to its value at the surface."""

    # ψₙ: Riccati-Bessel function of the first kind at mxr, with its values at the surface
    slope: np.ndarray  # mx ψₙ'/ψₙ
    step: np.ndarray  # ψₙ₊₁/ψₙ
    square: np.ndarray  # ∫|ψₙ|² dr / |ψₙ|²
    mixed: np.ndarray  # ∫r ψₙψₙ₊₁* dr / (ψₙψₙ₊₁*)


def _efficiencies(m: np.ndarray, x: np.ndarray) -> tuple[np.ndarray, ...]:
    """Fields of :class:`Mie`, each shape (s,), for spheres of shape (s,)."""
    last = np.ceil(x + _SERIES[0] * np.cbrt(x) + _SERIES[1]).astype(int)
    p, orders = m * x, int(last.max())
    inside, outside = _inside(p, orders + 1, last), _inside(x + 0j, orders + 1, last)
    n = np.arange(1, orders + 1)[:, None]
    used = n <= last

    # ξₙ, the Riccati-Hankel function at x: its inverse goes to zero where it would overflow
    inverse, slope = np.empty((2, orders + 1, x.size), complex)
    ratio, inverse[0], slope[0] = np.full(x.shape, -1j), 1j * np.exp(-1j * x), 1j * x
    for k in range(1, orders + 1):
        ratio = (2 * k - 1) / x - 1.0 / ratio
        inverse[k] = inverse[k - 1] / ratio
        slope[k] = x / ratio - k
    inverse, hankel = inverse[1:], slope[1:]
    bessel, within = outside.slope[1:-1], inside.slope[1:-1]

    electric, magnetic = m**2 * hankel - within, hankel - within
    common = np.where(used, inverse, 0.0) * 1j * x
    c, d = common * m / magnetic, common * m**2 / electric  # times ψₙ(mx)
    common = common * inverse / (hankel - bessel)
    a, b = common * (m**2 * bessel - within) / electric, common * (bessel - within) / magnetic

    degeneracy = 2 * n + 1
    scattering = 2.0 / x**2 * np.sum(degeneracy * (_square(a) + _square(b)), axis=0)
    product = (n * (n + 2) / (n + 1))[:-1] * (a[:-1] * a[1:].conj() + b[:-1] * b[1:].conj()).real
    forward = product.sum(axis=0) + np.sum(degeneracy / (n * (n + 1)) * (a * b.conj()).real, axis=0)

    before, after = np.abs(inside.step[:-2]) ** 2, inside.step[1:-1]
    lower, square, upper = inside.square[:-2], inside.square[1:-1], inside.square[2:]
    mixed = inside.mixed[1:-1]
    both = ((n + 1) * lower / before + n * upper * _square(after)) / degeneracy
    loss = 2.0 * m.real * m.imag / _square(m)
    absorbed = np.sum(degeneracy * (_square(c) * square + _square(d) * both), axis=0)
    absorption = 2.0 * loss / x * absorbed

    turn = after / after.conj()
    electric = (n + 1) * (square / (p * after.conj()) + upper * after / p.conj())
    neighbours = c[:-1] * c[1:].conj() * mixed[:-1]
    neighbours += d[:-1] * d[1:].conj() * (electric - mixed.conj() * turn)[:-1]
    crossed = c * d.conj() * ((n + 1) * square / p.conj() - mixed * after.conj())
    moment = np.sum((n * (n + 2) / (n + 1))[:-1] * neighbours.imag, axis=0)
    moment -= np.sum(degeneracy / (n * (n + 1)) * crossed.imag, axis=0)
    source = -3.0 * loss / x * moment
    g = 4.0 / x**2 * forward / scattering
    return scattering + absorption, scattering, absorption, g, source


def _square(z: np.ndarray) -> np.ndarray:
    return np.asarray(z.real**2 + z.imag**2)


def _inside(p: np.ndarray, orders: int, last: np.ndarray) -> _Inside:
    """Orders 0 to ``orders`` at arguments ``p``, by downward recurrence; shapes (orders + 1, s)."""
    start = _first_order(p, np.minimum(last + 1, orders))
    slopes, steps, mixtures = np.empty((3, orders + 1, p.size), complex)
    found = _Inside(slopes, steps, np.empty((orders + 1, p.size)), mixtures)
    n = max(start, orders) + 1
    # above all orders that count, those of a small argument; what is wrong with them fades
    step: Any = p / (2 * n + 3)
    slope, real = (n + 1.0) + 0j * p, (p**2).real
    square, mixed = np.full(p.shape, 1.0 / (2 * n + 3)), np.full(p.shape, 1.0 / (2 * n + 5) + 0j)
    while n > 0:
        over = slope + n
        previous = p / over
        mixed = previous * ((2 * n + 1) * square / p - step * mixed.conj())
        square = (over.real + real * square) / (over.real**2 + over.imag**2)
        slope, step = n - p * previous, previous
        n -= 1
        if n <= orders:
            for table, now in zip(found, (slope, step, square, mixed), strict=True):
                table[n] = now
    return found


def _first_order(p: np.ndarray, order: np.ndarray) -> int:
    """Order from which a downward recurrence has converged at ``order``, whatever it began with."""

    def decay(nu: np.ndarray) -> np.ndarray:
        ratio = nu / p
        return np.real(nu * np.arccosh(ratio) - p * np.sqrt(ratio - 1.0) * np.sqrt(ratio + 1.0))

    low, high = order.astype(float), np.abs(p) + order + 0.0
    high = high + 10.0 * np.cbrt(high) + _CONVERGED
    base = decay(low)
    while np.max(high - low) > 1.0:
        middle = 0.5 * (low + high)
        enough = decay(middle) - base > _CONVERGED
        low, high = np.where(enough, low, middle), np.where(enough, middle, high)
    return int(np.ceil(high.max()))


class AbsorbedPowers(Module):
    r"""Absorbed power at the points of a cubic grid that fill a particle.

    Only shares count: the unit of positions and of powers is any. The particle stands for the
    sphere of its volume, whose temperature difference drives the force.
    """

    position: np.ndarray  #: shape (points, 3); from the middle of the volume, in grid steps [1]
    share: np.ndarray  #: shape (points,); of the absorbed power [1]
    propagation: np.ndarray  #: shape (3,); direction in which the light travels [1]

    @property
    def radius(self) -> float:
        """Radius of the sphere of equal volume [grid steps]."""
        return float(np.cbrt(0.75 / np.pi * self.share.size))

    @property
    def asymmetry(self) -> float:
        r"""Asymmetry factor J₁ over the absorption efficiency, where heat is conducted evenly [1].

        The first harmonic of the surface temperature follows the dipole of the sources.
        """
        return float(self._toward_light @ self.share) * _IN_A_POINT / self.radius

    @property
    def asymmetry_without_conduction(self) -> float:
        """The same where heat leaves straight outwards and none flows sideways [1]."""
        distance = np.linalg.norm(self.position, axis=1)
        cosine = np.divide(self._toward_light, distance, where=distance > 0.0,
                           out=np.zeros_like(distance))  # fmt: skip
        return float(cosine @ self.share) * _IN_A_POINT

    @property
    def sideways(self) -> np.ndarray:
        """Part of :attr:`asymmetry` across the light [1], shape (3,); its force is not computed."""
        mean = self.share @ self.position
        return (mean - (mean @ self.propagation) * self.propagation) * _IN_A_POINT / self.radius

    @property
    def _toward_light(self) -> np.ndarray:
        return -self.position @ self.propagation


def read_absorbed_powers(
    *paths: str | Path, propagation: tuple[float, float, float] = (0.0, 0.0, 1.0)
) -> AbsorbedPowers:
    """Absorbed powers of a particle from text files, such as the internal fields of ADDA.

    Parameters
    ----------
    *paths : str or path
        The columns are ``x y z q``, or ``x y z |E|^2 ...`` as ``adda -store_int_field`` writes
        them to ``IntField-X`` and ``IntField-Y``. Both files together are unpolarised light.
        The points are those of a cubic grid, and ``q`` is the power per volume, in any unit.
        The squared field stands for it where all of the particle is one medium.
    propagation : sequence of 3 numbers
        Direction in which the light travels; ADDA's default is along z.

    Returns
    -------
    AbsorbedPowers

    Raises
    ------
    ConfigurationError
        One line that says what is wrong and where.
    """
    if not paths:
        raise ParameterError("read_absorbed_powers() needs the path of a file, such as IntField-X")
    direction = np.asarray(propagation, float)
    if direction.shape != (3,):
        raise ParameterError("propagation has three numbers, such as (0, 0, 1)")
    require_positive(length_of_propagation=np.linalg.norm(direction))
    tables = [read_table(path, _COLUMNS, strict=True) for path in paths]
    grids = []  # whole numbers of steps from one corner, shape (points, 3) each
    for table in tables:
        places = np.stack([table.numbers[name] for name in "xyz"], axis=1)
        places = places - places.min(axis=0)
        gaps = np.diff(np.sort(places, axis=0), axis=0)
        step = np.min(gaps[gaps > _ROUNDED * np.max(gaps, initial=0.0)], initial=np.inf)
        whole = np.rint(places / step)
        if np.isinf(step) or np.any(np.abs(places / step - whole) > _ROUNDED):
            raise ConfigurationError(
                f"{table.source}: its points are not those of a cubic grid; write one row for each "
                "cell of a grid with equal steps, as adda -store_int_field does"
            )
        _, first = np.unique(whole, axis=0, return_index=True)
        if first.size < len(whole):
            line = table.lines[np.setdiff1d(np.arange(len(whole)), first)[0]]
            raise ConfigurationError(f"{table.source}:{line}: repeats the point of another line")
        if not np.any(table.numbers["q"] > 0.0):
            raise ConfigurationError(f"{table.source}: no point absorbs anything")
        grids.append(whole)
    order = [np.lexsort(grid.T) for grid in grids]
    points = grids[0][order[0]]
    for path, grid, one in zip(paths[1:], grids[1:], order[1:], strict=True):
        if not np.array_equal(grid[one], points):
            raise ConfigurationError(f"{path}: has other points than {paths[0]}")
    powers = [table.numbers["q"][one] for table, one in zip(tables, order, strict=True)]
    power = np.sum(powers, axis=0)
    position = points - points.mean(axis=0)
    return AbsorbedPowers(position, power / power.sum(), direction / np.linalg.norm(direction))
