"""Dust in the air of Mars: how it dims the sun's beam and what it scatters down."""

from typing import NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import Checked, Fraction, OpticalDepth
from lightflyer.core.text import span

OPTICAL_DEPTH = 0.3
"""Vertical, of the whole air in visible light [1]: a clear season; the default of Mars-GRAM,
[Justh2021]_. Dust storms have 1 to 5."""

FALL_OFF = 0.003
"""How fast dust gets less with altitude [1]; the default of Mars-GRAM, [Justh2021]_."""

SCATTERED_SHARE = 0.92
"""Share of the light meeting dust that is scattered, not absorbed [1]; [ClancyLee1991]_."""

ASYMMETRY = 0.66
"""Mean cosine of the angle of scattering [1]. After Ockert-Bell and others, J. Geophys. Res. 102,
9039 (1997), from memory."""

_THICKNESS = 9e3  # of an even layer with the optical depth of the air, its scale height [m]
_SINGULAR = 1e-6  # next to which the two-stream solution is 0/0

# Gauss-Legendre nodes and weights on 0 to 1, for the column of dust
_NODES, _WEIGHTS = (
    0.5 * (values + offset)
    for values, offset in zip(np.polynomial.legendre.leggauss(20), (1.0, 0.0), strict=True)
)


class DustyLight(NamedTuple):
    """What dust above a place leaves of sunlight."""

    beam: Array  # Transmittance of the beam [1]
    # Irradiance of a level face by scattered light from above, per irradiance of the beam above the
    # dust on a face that looks at the sun [1]
    scattered: Array


class Dust(Checked):
    r"""Dust whose share of the air falls off with altitude.

    .. math:: q(p) = q_0 \exp\left[\nu\left(1 - \frac{p_0}{p}\right)\right]


    Raises
    ------
    ParameterError
        If a concrete number is out of range.

    Notes
    -----
    The beam is dimmed along its slant path through an even spherical layer, below the horizontal
    too. Scattered light is that of two streams in a level layer over black ground, with the
    forward peak counted as beam only in the scattering: light that the ground sends up and dust
    sends back is left out. Below 20 km that is up to a tenth of the scattered light; above 40 km
    all of it is negligible with the default.

    References
    ----------
    The profile is [Conrath1975]_'s, the two streams are [MeadorWeaver1980]_'s with the scaling of
    [Joseph1976]_.
    """

    optical_depth: OpticalDepth = OPTICAL_DEPTH  #: Vertical, of all the air above altitude 0 [1]
    fall_off: Fraction = FALL_OFF  #: :math:`\nu` [1]
    scattered_share: Fraction = SCATTERED_SHARE  #: Single-scattering albedo [1]
    asymmetry: Fraction = ASYMMETRY  #: Mean cosine of the angle of scattering [1]

    def depth_above(self, share_of_pressure: Numeric) -> Array:
        """Vertical optical depth of what is above [1]."""
        return _depth_above(self, share_of_pressure)

    def describe(self) -> str:
        """Dust in words."""
        return (
            f"dust: optical depth {span(self.optical_depth)} above altitude 0, of which the part "
            "above the flyer dims the beam and scatters light down"
        )


@entry_point
def _depth_above(dust: Dust, share_of_pressure: Numeric) -> Array:
    share = xp.asarray(share_of_pressure)

    def column(part: Array) -> Array:
        mixed = xp.exp(dust.fall_off * (1.0 - 1.0 / (part[..., None] * _NODES)))
        return part * xp.sum(mixed * _WEIGHTS, axis=-1)

    return dust.optical_depth * column(share) / column(xp.ones(()))


@entry_point
def air_mass(cosine: Numeric, distance: Numeric) -> Array:
    """Slant path through an even spherical layer over the vertical one [1]."""
    steep = distance / _THICKNESS * cosine
    return xp.sqrt(steep**2 + 2.0 * distance / _THICKNESS + 1.0) - steep


@entry_point
def two_stream_transmittance(
    depth: Numeric, cosine: Numeric, scattered_share: Numeric, asymmetry: Numeric
) -> Array:
    """Share of a slanting beam that passes a level layer, scattered light included [1]."""
    # Source: [MeadorWeaver1980]_ Eqs. (15) and table 1 (Eddington), with depth, share and asymmetry
    # scaled by [Joseph1976]_ Eqs. (5).
    forward = asymmetry**2
    depth = (1.0 - scattered_share * forward) * depth
    share = (1.0 - forward) * scattered_share / (1.0 - scattered_share * forward)
    skew = asymmetry / (1.0 + asymmetry)
    g1 = 0.25 * (7.0 - share * (4.0 + 3.0 * skew))
    g2 = -0.25 * (1.0 - share * (4.0 - 3.0 * skew))
    g3 = 0.25 * (2.0 - 3.0 * skew * cosine)
    g4 = 1.0 - g3
    a1 = g1 * g4 + g2 * g3
    k = xp.sqrt(xp.maximum(g1**2 - g2**2, _SINGULAR))
    slant = k * cosine
    resonance = 1.0 - slant**2
    resonance = xp.where(xp.abs(resonance) < _SINGULAR, _SINGULAR, resonance)
    # all over exp(k depth), so that thick layers do not overflow
    fading = xp.exp(-2.0 * k * depth)
    below = (k + g1) + (k - g1) * fading
    beam = xp.exp(-depth / cosine)
    up = (1.0 + slant) * (a1 + k * g4) * beam
    down = (1.0 - slant) * (a1 - k * g4) * fading * beam
    straight = 2.0 * k * (g4 + a1 * cosine) * xp.exp(-k * depth)
    return beam - share * (up - down - straight) / (resonance * below)


@entry_point
def dusty_light(
    dust: Dust, depth: Numeric, lowest_depth: Numeric, cosine: Numeric, distance: Numeric
) -> DustyLight:
    """What dust leaves of sunlight at a place; ``distance``: from the planet's centre."""
    mass = air_mass(xp.abs(cosine), distance)
    under = 2.0 * lowest_depth * air_mass(0.0, distance) - depth * mass
    path = xp.where(cosine < 0.0, under, depth * mass)
    high = 1.0 / air_mass(xp.maximum(cosine, 0.0), distance)
    passed = two_stream_transmittance(depth, high, dust.scattered_share, dust.asymmetry)
    scattered = high * xp.maximum(passed - xp.exp(-depth / high), 0.0)
    return DustyLight(xp.exp(-path), scattered)
