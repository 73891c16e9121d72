r"""Waves in coherent layers between two media, and in holes of a film.

A plane wave comes from above. With :math:`s` the sine of its angle times the index it comes from,
the relative normal wave number :math:`q_j=\sqrt{(n_j+ik_j)^2-s^2}` and the admittance
:math:`y_j=q_j` (s polarisation) or :math:`y_j=(n_j+ik_j)^2/q_j` (p), the ratio of upward to
downward tangential electric field is carried from the bottom up,

.. math::
    \Gamma_j=\frac{r_j+\Gamma_{j+1}e^{2i\varphi_{j+1}}}{1+r_j\Gamma_{j+1}e^{2i\varphi_{j+1}}},
    \qquad r_j=\frac{y_j-y_{j+1}}{y_j+y_{j+1}},\qquad
    \varphi_j=\frac{2\pi q_jd_j}{\lambda},

and then the downward field from the top down. It is algebraically the product of transfer
matrices, but only ever multiplies by decaying exponentials: nothing overflows however thick or
opaque a layer is.

Heights of a rough interface are normal with the standard deviation :math:`\sigma`, and vary over
lengths long against the wavelength. The mean field, which stays in the specular beams, is then
that of the smooth interface times

.. math::
    e^{-2\kappa^2a^2},\qquad e^{-2\kappa^2b^2},\qquad e^{-\kappa^2(a-b)^2/2},\qquad
    \kappa=\frac{2\pi\sigma}{\lambda}

where it is reflected above, reflected below, and passes; :math:`a,b` are the real parts of the
normal wave numbers above and below.

A hole passes less than falls on it where it is not wide against the wavelength. Kirchhoff's
integral for a round hole in a thin conducting screen, at normal incidence, gives

.. math::
    1 - T = \frac1x\int_0^x J_0(t)\,dt, \qquad x = \frac{2\pi D}{\lambda},

which goes to :math:`\lambda/(2\pi D)` for wide holes. Films and flyers here take :math:`T = 1`.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.numerics.special import imaginary, magnitude, quotient, real

LARGEST_DEFICIT = 0.05
"""Share that may be missing from what falls on a hole before it is worth a warning [1]."""

MEDIAN_WAVELENGTH_BY_TEMPERATURE = 4.107e-3
"""Half of a black body's radiation is beyond this wavelength times its temperature [m K]."""

MEDIAN_WAVELENGTH_OF_SUNLIGHT = 0.734e-6  # Half of sunlight's power is beyond this wavelength [m]

_MICROMETRE = 1e-6


class HalfSpace(NamedTuple):
    """A medium as waves meet it at an interface."""

    normal: Array  # shape (...); relative normal wave number, complex
    admittance: Array  # shape (2, ...); of s, then p polarisation, complex


class Sheets(NamedTuple):
    """Layers as waves meet them; the first axis of each array is the layer."""

    normal: Array  # shape (layers, ...); as that of :class:`HalfSpace`
    admittance: Array  # shape (layers, 2, ...)
    # Factors down through the layer and up again, shape (layers, ...)
    decay: Array  # of the power
    round_trip: Array  # of the field, complex

    def cut(self, layers: slice) -> "Sheets":
        """Some of the layers."""
        return Sheets(*(part[layers] for part in self))

    def medium(self, number: int) -> HalfSpace:
        """The medium of one layer."""
        return HalfSpace(self.normal[number], self.admittance[number])


class Fields(NamedTuple):
    """What a wave from above becomes in a group of layers; s, then p polarisation."""

    ratio: Array  # shape (2, ...); reflected over incident tangential electric field, complex
    passed: Array  # shape (2, ...); squared field below over that of the incident wave
    # shape (layers, 2, ...), without layers if not asked for; power that stays in each layer, over
    # the squared incident field
    absorbed: Array


class Beam(NamedTuple):
    """A plane wave in a medium that absorbs nothing."""

    n: Array  # Refractive index of the medium [1]
    cosine: Array  # Of the wave's angle to the normal [1]

    @property
    def half(self) -> HalfSpace:
        """The medium as the wave meets its interface."""
        normal = self.n * self.cosine
        return HalfSpace(normal, xp.stack([normal, self.n / self.cosine]))

    def into(self, n: Numeric, k: Numeric) -> HalfSpace:
        """Another medium as the wave meets it from inside, by its index."""
        loss = 2.0 * n * k
        # as the difference of the media: near grazing incidence the sine would lose the cosine
        excess = (n - self.n) * (n + self.n) - k * k
        normal = _root(excess + (self.n * self.cosine) ** 2, loss)
        permittivity = n * n - k * k + 1j * loss
        return HalfSpace(normal, xp.stack([normal, quotient(permittivity, normal)]))

    def through(self, n: Numeric, k: Numeric, phase: Numeric) -> Sheets:
        r"""Layers as the wave meets them; ``phase``: :math:`4\pi d/\lambda`, (layers, ...)."""
        normal, admittance = self.into(n, k)
        decay = xp.exp(-phase * imaginary(normal))
        # a quotient, as XLA would compute the factors of a product again for each of its uses
        round_trip = decay / xp.exp(-1j * phase * real(normal))
        return Sheets(normal, xp.moveaxis(admittance, 0, 1), decay, round_trip)


def _root(x: Array, y: Array) -> Array:
    """Square root in the first quadrant of x + iy in the upper half-plane."""
    # By real numbers: complex roots take three times as long. Each branch has the root's
    # derivatives also where x is zero, which an absolute value has not.
    propagates = x >= 0.0
    larger = xp.sqrt(0.5 * (xp.sqrt(x * x + y * y) + xp.where(propagates, x, -x)))
    smaller = 0.5 * y / larger  # by division, as a difference would cancel
    parts = xp.where(propagates, larger, smaller), xp.where(propagates, smaller, larger)
    return parts[0] + 1j * parts[1]


def respond(
    above: HalfSpace,
    layers: Sheets,
    below: HalfSpace,
    roughness: Numeric | None,
    shape: tuple[int, ...],
    *,
    inside: bool,
) -> Fields:
    r"""Fields in a group of layers, coherent with each other.

    ``roughness``: :math:`\kappa` of each interface, (layers + 1, ...); ``shape``: of the fields
    of one polarisation; ``inside``: whether to find what each layer absorbs.
    """
    count = layers.normal.shape[0]
    media = [above, *map(layers.medium, range(count)), below]
    # upward over downward field below the interface at hand, and above each that has been passed
    ratio: Numeric = 0.0
    upward: list[Array] = []
    gains: list[Array] = []  # squared downward field below an interface over that above it
    for place in reversed(range(count + 1)):
        (a, upper), (b, lower) = media[place], media[place + 1]
        plus, minus = upper + lower, upper - lower
        mirrored, through, back, gain = minus, plus, minus, 4.0 * magnitude(upper)
        if roughness is not None:
            a, b, square = real(a), real(b), roughness[place] ** 2
            up, down = xp.exp(-2.0 * square * a * a), xp.exp(-2.0 * square * b * b)
            passing = xp.exp(-square * (a - b) ** 2)  # twice: down and up again
            through = quotient(up * down * minus * minus + 4.0 * passing * upper * lower, plus)
            mirrored, back, gain = up * minus, down * minus, gain * passing
        under = plus + back * ratio
        upward.insert(0, quotient(mirrored + through * ratio, under))
        gains.insert(0, gain / magnitude(under))
        if place:
            ratio = upward[0] * layers.round_trip[place - 1]
    beam, absorbed = gains[0], []  # squared downward field at the top of a layer
    for number in range(count):
        admittance, decay = layers.admittance[number], layers.decay[number]
        if inside:
            low = upward[number + 1]
            entering = net_power(admittance, low * layers.round_trip[number])
            absorbed.append(beam * (entering - decay * net_power(admittance, low)))
        beam = beam * decay * gains[number + 1]
    wide = (2, *shape)
    rows = [xp.broadcast_to(part, wide) for part in absorbed]
    return Fields(
        xp.broadcast_to(upward[0], wide),
        xp.broadcast_to(beam, wide),
        xp.stack(rows) if rows else xp.zeros((0, *wide)),
    )


def net_power(admittance: Array, ratio: Array) -> Array:
    """Downward power where the downward field is one and the upward field has a ratio to it."""
    inward = real(admittance) * (1.0 - magnitude(ratio))
    return inward + 2.0 * imaginary(admittance) * imaginary(ratio)


def diffraction_deficit(hole_radius: Numeric, wavelength: Numeric) -> np.ndarray:
    """Share of the radiation on a round hole that does not pass it [1]; [Jackson1999]_ ch. 10.9."""
    # Kirchhoff's approximation: good for holes wider than the wavelength. In truth even less passes
    # holes that are much narrower.
    # The mean of J₀ up to x by Struve functions: itj0y0 of SciPy is wrong before 1.17.
    from scipy.special import j0, j1, struve  # slow to import

    x = _size(hole_radius, wavelength)
    return np.asarray(j0(x) + 0.5 * np.pi * (j1(x) * struve(0, x) - j0(x) * struve(1, x)))


def largest_deficit(hole_radius: Numeric, wavelength: Numeric) -> np.ndarray:
    """What :func:`diffraction_deficit` does not exceed [1], without SciPy; close for wide holes."""
    x = _size(hole_radius, wavelength)  # beyond x the integral of J₀ is at most √(2/(πx))
    return np.asarray((1.0 + np.sqrt(2.0 / (np.pi * x))) / x)


def _size(hole_radius: Numeric, wavelength: Numeric) -> np.ndarray:
    return 4.0 * np.pi * np.asarray(hole_radius) / wavelength


def narrow_holes(hole_radius: Numeric, temperature: Numeric) -> Iterator[str]:
    """Warnings of round holes that light or heat radiation does not pass as rays."""
    radius = float(np.min(hole_radius))
    yield from _narrow(f"holes of {2.0 * radius / _MICROMETRE:.3g} µm", radius, temperature)


def narrow_channels(width: Numeric, length: Numeric, temperature: Numeric) -> Iterator[str]:
    """Warnings of rectangular channels that are too narrow, as of :func:`narrow_holes`."""
    # What is missing goes, in wide channels, with the edge for the area: a rectangle lacks what a
    # round hole of the same ratio lacks.
    sides = np.broadcast_arrays(np.asarray(width, float), np.asarray(length, float))
    radius = sides[0] * sides[1] / (sides[0] + sides[1])
    narrowest = float(sides[0].ravel()[np.argmin(radius)])
    yield from _narrow(
        f"channels of {narrowest / _MICROMETRE:.3g} µm", float(np.min(radius)), temperature
    )


def _narrow(what: str, radius: float, temperature: Numeric) -> Iterator[str]:
    infrared = MEDIAN_WAVELENGTH_BY_TEMPERATURE / float(np.min(temperature))
    kinds = {"light": MEDIAN_WAVELENGTH_OF_SUNLIGHT, "heat radiation": infrared}
    for name, wavelength in kinds.items():
        if largest_deficit(radius, wavelength) <= LARGEST_DEFICIT:
            continue
        deficit = float(diffraction_deficit(radius, wavelength))
        if deficit > LARGEST_DEFICIT:
            yield (
                f"{what} are narrow for {name}, half of which has wavelengths beyond "
                f"{wavelength / _MICROMETRE:.2g} µm: by diffraction about {100.0 * deficit:.2g} % "
                "less passes them than open_fraction says"
            )
