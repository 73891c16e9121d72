r"""Reflection, transmission and absorption of a stack of layers.

Fields of neighbouring coherent layers are added (:mod:`lightflyer.film.optics.waves`). In an
incoherent layer, one so thick or uneven that interference averages out, powers are added instead:
it has a downward and an upward power, and the groups of coherent layers above and below it reflect
and pass shares of them.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module, field
from lightflyer.core.entry_point import entry_point
from lightflyer.film.optics.waves import Beam, Fields, HalfSpace, Sheets, net_power, respond
from lightflyer.numerics.special import imaginary, magnitude, real


class StackOptics(Module):
    """Shares of the light on a stack that are reflected, transmitted, absorbed and scattered.

    The first axis of each field is the polarisation: s, then p.
    """

    #: shape (2, ...); specular [1]. What enters an endless substrate is transmitted
    reflectance: Numeric
    transmittance: Numeric  #: As ``reflectance``
    #: shape (layers, 2, ...); absorptance of each layer, the lit side first [1]
    layer_absorptance: Numeric
    #: shape (2, ...); share that rough interfaces scatter out of the specular beams [1]. It is not
    #: followed: layers may absorb some of it
    scattered: Numeric = 0.0

    @property
    def absorptance(self) -> Numeric:
        """Absorptance of the stack, shape (2, ...) [1]."""
        return self.layer_absorptance.sum(axis=0)

    def merge_layers(self, sizes: Sequence[int]) -> "StackOptics":
        """The absorptances of neighbouring layers added up."""
        groups = np.repeat(np.eye(len(sizes)), sizes, axis=1)
        absorptance = _sum(groups, self.layer_absorptance)
        return StackOptics(self.reflectance, self.transmittance, absorptance, self.scattered)

    def with_holes(self, share: Numeric) -> "StackOptics":
        """Optics of the stack with holes, through which all light passes."""
        solid = 1.0 - share
        return StackOptics(
            reflectance=solid * self.reflectance,
            transmittance=solid * self.transmittance + share,
            layer_absorptance=solid * self.layer_absorptance,
            scattered=solid * self.scattered,
        )

    def polarisation_mean(self) -> "StackOptics":
        """The mean of both polarisations, without their axis."""
        scattered = self.scattered
        return StackOptics(
            reflectance=self.reflectance.mean(axis=0),
            transmittance=self.transmittance.mean(axis=0),
            layer_absorptance=self.layer_absorptance.mean(axis=1),
            scattered=scattered.mean(axis=0) if np.ndim(scattered) else scattered,
        )


@entry_point
def _sum(groups: Numeric, parts: Numeric) -> Numeric:
    return xp.tensordot(groups, parts, axes=1)


class Structure(Module):
    """What a stack is besides its layers: by default free-standing, smooth and coherent."""

    # Refractive index of the medium that the light comes from, which absorbs nothing [1]
    above: Numeric = 1.0
    below: tuple[Numeric, Numeric] = (1.0, 0.0)  # n and k of the endless medium below [1]
    # shape (layers + 1, ...); standard deviation of the height of each interface, top to bottom [m]
    roughness: Numeric | None = None
    # Whether light interferes in each layer; empty where it does in all
    coherent: tuple[bool, ...] = field(static=True, default=())


def stack_optics(
    n: Numeric,
    k: Numeric,
    thickness: Numeric,
    wavelength: Numeric,
    incidence: Numeric = 0.0,
    *,
    above: Numeric = 1.0,
    below: tuple[Numeric, Numeric] = (1.0, 0.0),
    roughness: Numeric | None = None,
    coherent: Sequence[bool] = (),
) -> StackOptics:
    r"""Reflectance, transmittance and absorptance of each layer, for light from above.

    Parameters
    ----------
    n, k : array, shape (layers, ...)
        Real and imaginary part of each layer's refractive index, top layer first [1].
    thickness : array, shape (layers, ...)
        [m].
    wavelength : array, shape (...)
        In vacuum [m].
    incidence : array, shape (...)
        Angle between the light and the stack's normal in the medium above [rad], below pi/2.
    above : array, shape (...)
        Refractive index of the medium that the light comes from, which absorbs nothing [1]; by
        default vacuum.
    below : pair of array, shape (...)
        n and k of the endless medium below [1]; by default vacuum.
    roughness : array, shape (layers + 1, ...), optional
        Standard deviation of the height of each interface, top to bottom [m]; by default zero.
    coherent : sequence of bool, optional
        Whether light interferes in each layer; by default in all.

    Returns
    -------
    StackOptics
        The axes behind ``layers`` are broadcast together.

    Notes
    -----
    Differentiable in every numeric argument, except where a medium's index equals the sine of the
    incidence times the index above (grazing inside). Values are not checked here;
    :class:`Film` checks them.

    Rough interfaces reflect and pass the mean field of a surface whose heights are normal and vary
    over lengths long against the wavelength (scalar theory). That holds for
    :math:`4\pi\sigma n\cos\theta/\lambda\lesssim1`; finer relief is better an effective medium.
    All that is missing from the specular beams is scattered; each passage scatters independently.
    Where media on both sides of a rough interface absorb strongly, energy is kept to some 1 % only:
    a negative ``scattered`` shows it.

    References
    ----------
    [Byrnes2016]_ for the definitions of absorption and for incoherent layers; the recursion is
    Rouard's, [Heavens1955]_. [BennettPorteus1961]_ and [Ohlidal1999]_ for rough interfaces.

    Examples
    --------
    >>> optics = stack_optics([1.5], [0.0], [1e-7], 5e-7)
    >>> print(f"{optics.reflectance[0]:.6f} {optics.transmittance[0]:.6f}")
    0.135720 0.864280

    A millimetre of glass, in which light does not interfere:

    >>> glass = stack_optics([1.5], [0.0], [1e-3], 5e-7, coherent=[False])
    >>> print(f"{glass.transmittance[0]:.6f}")
    0.923077
    """
    everywhere = () if all(coherent) else tuple(bool(one) for one in coherent)
    structure = Structure(above, (below[0], below[1]), roughness, everywhere)
    return structured_optics(n, k, thickness, wavelength, incidence, structure)


@entry_point
def structured_optics(
    n: Numeric,
    k: Numeric,
    thickness: Numeric,
    wavelength: Numeric,
    incidence: Numeric,
    structure: Structure,
) -> StackOptics:
    """:func:`stack_optics` of a :class:`Structure`."""
    return transfer(n, k, thickness, wavelength, incidence, structure)


def transfer(
    n: Numeric,
    k: Numeric,
    thickness: Numeric,
    wavelength: Numeric,
    incidence: Numeric,
    structure: Structure | None = None,
    *,
    inside: bool = True,
) -> StackOptics:
    """:func:`stack_optics` for use inside other compiled functions."""
    # With ``inside`` false the absorptances of layers are left out, as an array without rows,
    # unless interfaces are rough: what is scattered is what is missing beside them.
    group = _grouped(n, k, thickness, wavelength, incidence, structure, inside=inside)
    reflected, passed, absorbed = group.shares()
    scattered: Numeric = 0.0
    if group.kappa is not None:
        scattered = 1.0 - reflected - passed - absorbed.sum(axis=0)
    return StackOptics(reflected, passed, absorbed, scattered)


@entry_point
def ellipsometric_angles(
    n: Numeric,
    k: Numeric,
    thickness: Numeric,
    wavelength: Numeric,
    incidence: Numeric,
    structure: Structure,
) -> Numeric:
    r"""Cos 2Ψ, sin 2Ψ cos Δ and sin 2Ψ sin Δ of the light that a stack reflects, (3, ...)."""
    # .. math:: r_p/r_s=\tan\Psi\,e^{i\Delta} in the convention of [Fujiwara2007]_ ch. 3.2, in which
    # fields go as e^{+iωt} and Δ of a clear mirror is 180° at normal incidence. Fields here go as
    # e^{-iωt}, and those of p polarisation are tangential. Light that has been through an
    # incoherent layer is not counted: it is elsewhere on the detector, or scattered at the back.
    group = _grouped(n, k, thickness, wavelength, incidence, structure, inside=False)
    s, p = group.first().ratio
    powers, product = (magnitude(s), magnitude(p)), xp.conj(s) * p
    parts = [powers[0] - powers[1], -2.0 * real(product), 2.0 * imaginary(product)]
    return xp.stack(parts) / (powers[0] + powers[1])


def _grouped(
    n: Numeric,
    k: Numeric,
    thickness: Numeric,
    wavelength: Numeric,
    incidence: Numeric,
    structure: Structure | None,
    *,
    inside: bool,
) -> "_Grouped":
    structure = Structure() if structure is None else structure
    roughness = structure.roughness

    def aligned(value: Numeric, leading: int) -> Array:
        """An array whose axes behind the leading ones are as many as the widest array's."""
        array = xp.asarray(value)
        ones = (1,) * (leading + rank - array.ndim)
        return array.reshape(array.shape[:leading] + ones + array.shape[leading:])

    each_layer = n, k, thickness
    single = wavelength, incidence, structure.above, *structure.below
    rows = each_layer if roughness is None else (*each_layer, roughness)
    rank = max([*(xp.ndim(one) - 1 for one in rows), *map(xp.ndim, single)])
    n, k, thickness = (aligned(one, 1) for one in each_layer)
    wavelength, incidence, above, below_n, below_k = (aligned(one, 0) for one in single)
    beam = Beam(above, xp.cos(incidence))
    outside, substrate = beam.half, beam.into(below_n, below_k)
    layers = beam.through(n, k, (4.0 * np.pi) * thickness / wavelength)
    kappa = None if roughness is None else (2.0 * np.pi) * aligned(roughness, 1) / wavelength
    shape = xp.broadcast_shapes(
        layers.decay.shape[1:], outside.normal.shape, substrate.normal.shape, wavelength.shape,
        () if kappa is None else kappa.shape[1:],
    )  # fmt: skip
    inside = inside or kappa is not None
    return _Grouped(outside, layers, substrate, kappa, structure.coherent, shape, inside)


class _Grouped(NamedTuple):
    """Layers, cut where light does not interfere."""

    outside: HalfSpace
    layers: Sheets
    substrate: HalfSpace
    kappa: Array | None
    coherent: tuple[bool, ...]
    shape: tuple[int, ...]
    inside: bool

    @property
    def thick(self) -> tuple[int, ...]:
        """Numbers of the incoherent layers."""
        return tuple(number for number, one in enumerate(self.coherent) if not one)

    def first(self) -> Fields:
        """What the layers above the first incoherent one do to the light."""
        end = next(iter(self.thick), self.layers.normal.shape[0])
        below = self.layers.medium(end) if self.thick else self.substrate
        kappa = None if self.kappa is None else self.kappa[: end + 1]
        part = self.layers.cut(slice(end))
        return respond(self.outside, part, below, kappa, self.shape, inside=False)

    def shares(self) -> tuple[Array, Array, Array]:
        """Reflectance, transmittance and layers' absorptances, by adding powers."""
        starts = [0, *(number + 1 for number in self.thick)]
        ends = [*self.thick, self.layers.normal.shape[0]]
        media = [self.outside, *map(self.layers.medium, self.thick), self.substrate]
        down: list[Fields] = []  # what groups of coherent layers do to waves from above
        up: list[Fields] = []  # and to waves from below
        for place, (start, end) in enumerate(zip(starts, ends, strict=True)):
            part, above, below = self.layers.cut(slice(start, end)), *media[place : place + 2]
            kappa = None if self.kappa is None else self.kappa[start : end + 1]
            down.append(respond(above, part, below, kappa, self.shape, inside=self.inside))
            if place < len(self.thick):
                turned = slice(None, None, -1)
                part, kappa = part.cut(turned), None if kappa is None else kappa[turned]
                up.append(respond(below, part, above, kappa, self.shape, inside=self.inside))
        decays = [self.layers.decay[number] for number in self.thick]
        reflected = magnitude(down[-1].ratio)
        returns: list[Array] = []  # upward over downward power at the top of each incoherent layer
        gains: list[Array] = []
        for first, back, decay in zip(down[-2::-1], up[::-1], decays[::-1], strict=True):
            returned = decay * decay * reflected
            gain = 1.0 / (1.0 - magnitude(back.ratio) * returned)
            reflected = magnitude(first.ratio) + first.passed * back.passed * returned * gain
            returns.insert(0, returned)
            gains.insert(0, gain)
        beams = [xp.ones_like(reflected)]  # squared downward field above each group
        rising = []  # squared upward field below each group but the last
        for one, gain, returned, decay in zip(down[:-1], gains, returns, decays, strict=True):
            entered = beams[-1] * one.passed * gain
            rising.append(entered * returned)
            beams.append(entered * decay)
        incident = self.outside.admittance
        admittances = [one.admittance for one in media]
        passed = beams[-1] * down[-1].passed * real(self.substrate.admittance) / incident
        if not self.inside:
            return reflected, passed, xp.zeros((0, *reflected.shape))
        absorbed = []  # power in groups of coherent layers and in incoherent ones, top to bottom
        for place, one in enumerate(down):
            group = beams[place] * one.absorbed
            if place < len(up):
                group = group + rising[place] * up[place].absorbed[::-1]
            absorbed.append(group)
            if place < len(up):
                inside, following = admittances[place + 1], down[place + 1]
                top = real(inside) * one.passed * beams[place]
                top = top - net_power(inside, up[place].ratio) * rising[place]
                bottom = net_power(inside, following.ratio) * beams[place + 1]
                if place + 1 < len(up):
                    bottom = bottom - real(inside) * up[place + 1].passed * rising[place + 1]
                absorbed.append((top - bottom)[None])
        return reflected, passed, xp.concatenate(absorbed) / incident
