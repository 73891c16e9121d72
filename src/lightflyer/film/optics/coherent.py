r"""Fields in coherent layers between two media.

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

Complex numbers are pairs of real ones here: XLA compiles those into far faster loops.
"""

from typing import Any, NamedTuple, TypeAlias

from lightflyer.core.types import Numeric
from lightflyer.numerics.trigonometry import sine_and_cosine
from lightflyer.pytree import tree
from lightflyer.pytree.lazy_jax import Array, custom_jvp, jax, jnp

Complex: TypeAlias = tuple[Array, Array]


class HalfSpace(NamedTuple):
    """A medium as waves meet it at an interface."""

    normal: Complex  # Relative normal wave number
    magnetic: Complex  # Admittance of p polarisation; that of s polarisation is ``normal``

    @property
    def admittances(self) -> tuple[Complex, Complex]:
        """Admittance of s and p polarisation."""
        return self.normal, self.magnetic


class Sheets(NamedTuple):
    """Layers as waves meet them; the first axis of each array is the layer."""

    half: HalfSpace
    exponent: Complex  # Of the field's factor, down through the layer and up again

    @property
    def decay(self) -> Array:
        """Factor of the power, down through the layer."""
        return jnp.exp(self.exponent[0])

    @property
    def round_trip(self) -> Complex:
        """Factor of the field, down through the layer and up again."""
        sine, cosine = sine_and_cosine(self.exponent[1])
        return self.decay * cosine, self.decay * sine

    def cut(self, start: int, stop: int) -> "Sheets":
        found: Sheets = tree.map_leaves(lambda one: one[start:stop], self)
        return found

    def flip(self) -> "Sheets":
        """The layers in reverse order."""
        found: Sheets = tree.map_leaves(lambda one: one[::-1], self)
        return found


class Fields(NamedTuple):
    """What a wave from above becomes in a group of layers, for one polarisation."""

    ratio: Complex  # Reflected over incident tangential electric field
    passed: Array  # Squared magnitude of the field below over that of the incident field
    # shape (layers, ...); power that stays in each layer, over the squared magnitude of the
    # incident field
    absorbed: Array


class Beam(NamedTuple):
    """A plane wave in a medium that absorbs nothing."""

    n: Array  # Refractive index of the medium [1]
    cosine: Array  # Of the wave's angle to the normal [1]

    @property
    def half(self) -> HalfSpace:
        """The medium as the wave meets its interface."""
        normal, magnetic = self.n * self.cosine, self.n / self.cosine
        return HalfSpace((normal, jnp.zeros_like(normal)), (magnetic, jnp.zeros_like(magnetic)))

    def into(self, n: Numeric, k: Numeric) -> HalfSpace:
        """Another medium as the wave meets it from inside, by its index."""
        imaginary = 2.0 * n * k
        # as the difference of the media: near grazing incidence the sine would lose the cosine
        excess = (n - self.n) * (n + self.n) - k * k
        normal = _root(excess + (self.n * self.cosine) ** 2, imaginary)
        return HalfSpace(normal, _quotient((n * n - k * k, imaginary), normal))


def sheets(beam: Beam, n: Numeric, k: Numeric, phase: Numeric) -> Sheets:
    """Layers of indices and thicknesses; ``n``, ``k`` (layers, ...); ``phase`` (layers, ...)."""
    half = beam.into(n, k)
    return Sheets(half, (-phase * half.normal[1], phase * half.normal[0]))


def respond(
    above: HalfSpace,
    layers: Sheets,
    below: HalfSpace,
    roughness: Numeric | None,
    shape: tuple[int, ...],
    *,
    inside: bool,
) -> tuple[Fields, Fields]:
    r"""Fields of both polarisations; ``roughness`` (layers + 1, ...); s, then p polarisation."""
    if roughness is None:
        risen = _smooth(shape, inside, above, layers, below)
    else:
        risen, _ = _sweep(shape, inside, above, layers, below, roughness)
    first, second = (
        Fields(
            one.ratio,
            one.passed,
            jnp.zeros((0, *shape)) if one.met is None else _absorption(layers, number, one),
        )
        for number, one in enumerate(risen)
    )
    return first, second


def net_power(admittance: Complex, ratio: Complex) -> Array:
    """Downward power where the downward field is one and the upward field has a ratio to it."""
    inward = 1.0 - magnitude(ratio)
    return admittance[0] * inward + 2.0 * admittance[1] * ratio[1]


def magnitude(one: Complex) -> Array:
    """Squared magnitude of a complex number."""
    return one[0] * one[0] + one[1] * one[1]


class _Wave(NamedTuple):
    """State of the recursion at an interface."""

    # ``below`` is the admittance below it, ``ratio`` the upward over the downward field there, and
    # ``power`` the squared magnitude of the field at the very bottom over that there.

    below: Complex
    ratio: Complex
    power: Array


class _Risen(NamedTuple):
    """What the recursion finds at the topmost interface, for one polarisation."""

    # ``gain`` is the squared field that this interface lets through; ``met`` holds ratio and gain
    # at the top of each layer. Both are None where what layers absorb is not wanted.

    ratio: Complex
    passed: Array
    gain: Array | None
    met: tuple[Complex, Array] | None


_Pair: TypeAlias = tuple[_Risen, _Risen]


def _sweep(
    shape: tuple[int, ...],
    inside: bool,
    above: HalfSpace,
    layers: Sheets,
    below: HalfSpace,
    roughness: Numeric | None = None,
) -> tuple[_Pair, Any]:
    """The recursion from the bottom up, and the ratios below each interface, top to bottom."""
    full = jnp.zeros(shape)
    lowest = tree.map_leaves(lambda part: part + full, below)
    waves = tuple(_Wave(one, (full, full), full + 1.0) for one in lowest.admittances)
    rows = (layers.half, layers.round_trip, layers.decay)
    damped = None if roughness is None else roughness[1:]

    def step(carry: Any, row: Any) -> tuple[Any, Any]:
        under, waves = carry
        (half, round_trip, decay), kappa = row
        damping = None if kappa is None else _damping(half, under, kappa)
        met = tuple(
            _interface(one, wave.below, wave.ratio, damping)
            for one, wave in zip(half.admittances, waves, strict=True)
        )
        risen = tuple(
            _Wave(one, _product(ratio, round_trip), wave.power * gain * decay)
            for one, wave, (ratio, gain) in zip(half.admittances, waves, met, strict=True)
        )
        widened = tree.map_leaves(lambda part: part + full, (half, risen))
        return widened, (met if inside else None, tuple(wave.ratio for wave in widened[1]))

    under: HalfSpace = lowest
    met: Any = None
    empty = jnp.zeros((0, *shape))
    ratios: Any = ((empty, empty), (empty, empty))
    if layers.exponent[0].shape[0]:
        # derivatives compute a step again, which is faster than to keep what was in it
        frugal = jax.checkpoint(step, prevent_cse=False)
        (under, waves), (met, ratios) = jax.lax.scan(
            frugal, (lowest, waves), (rows, damped), reverse=True
        )
    damping = None if roughness is None else _damping(above, under, roughness[0])
    found = []
    for number, wave in enumerate(waves):
        ratio, gain = _interface(above.admittances[number], wave.below, wave.ratio, damping)
        own = None if met is None else met[number]
        found.append(_Risen(ratio, wave.power * gain, gain if inside else None, own))
    none = jnp.zeros((1, *shape))
    nothing: Any = ((none, none), (none, none))  # comes up from below the stack
    return (found[0], found[1]), _stack(shape, ratios, nothing)


def _smooth_sweep(
    shape: tuple[int, ...], inside: bool, above: HalfSpace, layers: Sheets, below: HalfSpace
) -> _Pair:
    """The recursion where all interfaces are smooth."""
    return _sweep(shape, inside, above, layers, below)[0]


def _slopes(
    shape: tuple[int, ...],
    inside: bool,
    primals: tuple[HalfSpace, Sheets, HalfSpace],
    tangents: tuple[HalfSpace, Sheets, HalfSpace],
) -> tuple[_Pair, _Pair]:
    """Derivatives by a recursion of changes, written out."""
    # In those that JAX finds by itself, each intermediate result has a loop of its own, which
    # computes the step again.
    found, ratios = _sweep(shape, inside, *primals)
    rows = _rows(shape, ratios, primals, tangents)

    def step(carry: Any, row: Any) -> tuple[Any, Any]:
        interfaces, round_trip, exponent = row
        ends, changes = [], []
        for upper, lower, ratio, moved, (wave, passed) in zip(*interfaces, carry, strict=True):
            risen, change, gain = _change(upper, lower, ratio, moved, wave)
            turned = _product(risen, exponent)
            wave = _product(round_trip, (change[0] + turned[0], change[1] + turned[1]))
            ends.append((wave, passed + gain + exponent[0]))
            changes.append((change, gain))
        return tuple(ends), (changes if inside else None)

    frugal = jax.checkpoint(step, prevent_cse=False)
    full = jnp.zeros(shape)
    ends, changes = jax.lax.scan(frugal, (((full, full), full),) * 2, rows, reverse=True)
    slopes = []
    for number, (one, (ratio, passed)) in enumerate(zip(found, ends, strict=True)):
        gain, met = None, None
        if inside:
            (real, imaginary), gains = changes[number]
            gain = one.gain * gains[0]
        if one.met is not None:
            met = (real[1:], imaginary[1:]), one.met[1] * gains[1:]
        slopes.append(_Risen(ratio, one.passed * passed, gain, met))
    return found, (slopes[0], slopes[1])


_smooth: Any = custom_jvp(_smooth_sweep, nondiff_argnums=(0, 1))
_smooth.defjvp(_slopes)


def _rows(
    shape: tuple[int, ...],
    ratios: tuple[Complex, Complex],
    primals: tuple[HalfSpace, Sheets, HalfSpace],
    tangents: tuple[HalfSpace, Sheets, HalfSpace],
) -> Any:
    """What the recursion of changes needs of each interface and the layer above it."""
    (tops, bottoms), (top_changes, bottom_changes) = (
        _faces(shape, *one) for one in (primals, tangents)
    )
    moved = tuple(
        _less(_product(_quotient(lower, upper), change), other)
        for upper, lower, change, other in zip(
            tops, bottoms, top_changes, bottom_changes, strict=True
        )
    )
    # no layer is above the topmost interface
    none = jnp.zeros((1, *shape))
    round_trips = _stack(shape, (none + 1.0, none), primals[1].round_trip)
    exponents = _stack(shape, (none, none), tangents[1].exponent)
    return (tops, bottoms, ratios, moved), round_trips, exponents


def _faces(
    shape: tuple[int, ...], above: HalfSpace, layers: Sheets, below: HalfSpace
) -> tuple[tuple[Complex, Complex], tuple[Complex, Complex]]:
    """Admittances above each interface, and below each, for s and p polarisation."""
    first, last = (tree.map_leaves(lambda part: part[None], one) for one in (above, below))
    upper, lower = _stack(shape, first, layers.half), _stack(shape, layers.half, last)
    return upper.admittances, lower.admittances


def _change(
    above: Complex, below: Complex, ratio: Complex, moved: Complex, wave: Complex
) -> tuple[Complex, Complex, Array]:
    r"""Ratio above a smooth interface, its change, and that of the logarithm of the gain."""
    # ``ratio`` is the one below and ``wave`` its change; ``moved`` is :math:`(y_b/y_a)\,\delta
    # y_a-\delta y_b`, with the admittances above and below.
    plus = (above[0] + below[0], above[1] + below[1])
    minus = _less(above, below)
    returned, gone = _product(minus, ratio), _product(plus, ratio)
    inverse = _inverse((plus[0] + returned[0], plus[1] + returned[1]))
    upward = _product(inverse, (minus[0] + gone[0], minus[1] + gone[1]))
    driven = _product(inverse, _product((1.0 - ratio[0], -ratio[1]), moved))
    passed_on = _product(inverse, wave)
    own, through = _product((1.0 + ratio[0], ratio[1]), driven), _product(below, passed_on)
    both = own[0] + 2.0 * through[0], own[1] + 2.0 * through[1]
    change = _product(_product(inverse, above), both)
    gain = driven[0] - (minus[0] * passed_on[0] - minus[1] * passed_on[1])
    return upward, (2.0 * change[0], 2.0 * change[1]), 2.0 * gain


def _stack(shape: tuple[int, ...], *parts: Any) -> Any:
    """Arrays whose first axis is the layer, broadcast behind it and put one upon the other."""

    def wide(part: Array) -> Array:
        ones = (1,) * (len(shape) + 1 - part.ndim)
        rows = part.reshape(part.shape[:1] + ones + part.shape[1:])
        return jnp.broadcast_to(rows, (part.shape[0], *shape))

    return tree.map_leaves(lambda *rows: jnp.concatenate([wide(one) for one in rows]), *parts)


def _absorption(layers: Sheets, number: int, risen: _Risen) -> Array:
    """Power that enters each layer less what leaves it, from the top down."""
    assert risen.met is not None
    assert risen.gain is not None
    ratio, gains = risen.met
    admittance, decay = layers.half.admittances[number], layers.decay
    falls = decay * gains
    beam = jnp.cumprod(jnp.concatenate([risen.gain[None], falls[:-1]]), axis=0)
    entering = net_power(admittance, _product(ratio, layers.round_trip))
    return beam * (entering - decay * net_power(admittance, ratio))


@custom_jvp
def _root(real: Array, imaginary: Array) -> Complex:
    """Square root in the first quadrant of a number in the upper half-plane."""
    modulus = jnp.sqrt(real * real + imaginary * imaginary)
    larger = jnp.sqrt(0.5 * (modulus + jnp.abs(real)))
    smaller = 0.5 * imaginary / larger  # by division, as a difference would cancel
    propagates = real >= 0.0
    return jnp.where(propagates, larger, smaller), jnp.where(propagates, smaller, larger)


@_root.defjvp
def _slope_of_root(primals: Complex, tangents: Complex) -> tuple[Complex, Complex]:
    root = _root(*primals)
    slope = _product(_inverse(root), tangents)
    return root, (0.5 * slope[0], 0.5 * slope[1])


def _product(one: Complex, other: Complex) -> Complex:
    (a, b), (c, d) = one, other
    return a * c - b * d, a * d + b * c


def _less(one: Complex, other: Complex) -> Complex:
    return one[0] - other[0], one[1] - other[1]


def _inverse(one: Complex) -> Complex:
    scale = 1.0 / magnitude(one)
    return one[0] * scale, -one[1] * scale


@custom_jvp
def _quotient(over: Complex, under: Complex) -> Complex:
    (a, b), (c, d) = over, under
    scale = 1.0 / (c * c + d * d)
    return (a * c + b * d) * scale, (b * c - a * d) * scale


@_quotient.defjvp
def _slope_of_quotient(
    primals: tuple[Complex, Complex], tangents: tuple[Complex, Complex]
) -> tuple[Complex, Complex]:
    found = _quotient(*primals)
    return found, _product(_inverse(primals[1]), _less(tangents[0], _product(found, tangents[1])))


class _Damping(NamedTuple):
    """Factors of the field at a rough interface."""

    above: Array  # where it is reflected above
    below: Array
    passing: Array  # where it passes, squared: down and up again


def _damping(above: HalfSpace, below: HalfSpace, kappa: Numeric) -> _Damping:
    """Factors of a rough interface."""
    a, b = above.normal[0], below.normal[0]
    power = kappa * kappa
    difference = a - b
    return _Damping(
        jnp.exp(-2.0 * power * a * a),
        jnp.exp(-2.0 * power * b * b),
        jnp.exp(-power * difference * difference),
    )


def _interface(
    above: Complex, below: Complex, ratio: Complex, damping: _Damping | None
) -> tuple[Complex, Array]:
    """Upward over downward field above an interface, and the squared field it lets through."""
    # ``ratio`` is upward over downward field below it.
    plus = (above[0] + below[0], above[1] + below[1])
    minus = (above[0] - below[0], above[1] - below[1])
    mirrored, through, back, gain = minus, plus, minus, 4.0 * magnitude(above)
    if damping is not None:
        reflected, passing = damping.above * damping.below, damping.passing
        both, product = _product(minus, minus), _product(above, below)
        kept = tuple(
            reflected * one + 4.0 * passing * other
            for one, other in zip(both, product, strict=True)
        )
        through = _quotient((kept[0], kept[1]), plus)
        mirrored = (damping.above * minus[0], damping.above * minus[1])
        back = (damping.below * minus[0], damping.below * minus[1])
        gain = gain * passing
    risen, returned = _product(through, ratio), _product(back, ratio)
    over = (mirrored[0] + risen[0], mirrored[1] + risen[1])
    under = (plus[0] + returned[0], plus[1] + returned[1])
    scale = 1.0 / magnitude(under)
    upward = (
        (over[0] * under[0] + over[1] * under[1]) * scale,
        (over[1] * under[0] - over[0] * under[1]) * scale,
    )
    return upward, gain * scale
