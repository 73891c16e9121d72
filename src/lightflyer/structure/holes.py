"""Films with round holes: how much stiffness these leave, and how they raise stress."""

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point

_ALIKE, _APART = -1.2, -1.77  # powers of the solid share, of stresses alike and apart


@entry_point
def perforated_share(open_fraction: Numeric) -> Array:
    r"""Stiffness of a film with round holes over that of a whole one [1]."""
    # .. math:: \frac{1-\beta}{1+2\beta}
    #
    # The bound of isotropic films by Hashin and Shtrikman, which holes in a triangular pattern
    # nearly reach; it does not depend on Poisson's ratio. Source: [Hashin1965]_
    return (1.0 - xp.asarray(open_fraction)) / (1.0 + 2.0 * open_fraction)


@entry_point
def tension_at_holes(first: Numeric, second: Numeric, open_fraction: Numeric) -> Array:
    r"""Largest tension in a film [Pa], whose whole parts would have two principal stresses [Pa]."""
    # .. math:: \sigma = \frac{1-\beta}{1+2\beta}\left(\frac{\sigma_1+\sigma_2}{(1-\beta)^{1.2}}
    #     + \frac{2|\sigma_1-\sigma_2|}{(1-\beta)^{1.77}}\right)
    #
    # At a lone hole Kirsch's 3σ₁ - σ₂. The powers are fitted to finite elements of holes in a
    # triangular pattern (studies/structure): 4 % too much to 1.5 % too little up to β = 0.6.
    # Corners of slots have more.
    share, larger = xp.asarray(open_fraction), xp.maximum(first, second)
    solid = 1.0 - share
    alike, apart = first + second, 2.0 * xp.abs(first - second)
    peak = alike * solid**_ALIKE + apart * solid**_APART
    return xp.where(share > 0.0, perforated_share(share) * peak, larger)
