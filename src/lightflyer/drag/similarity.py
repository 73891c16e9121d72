"""Numbers on which drag depends: speed ratio, rarefaction, Reynolds number, heating of the gas."""

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.validity import Validity
from lightflyer.gas.base import AbstractGas

SLOW = Validity(
    "the speed over that of molecules, in gas where these collide,",
    0.0,
    0.3,
    "compression of the gas, which the drag leaves out, matters there",
)
"""Range of the speed ratio where gas is not thin: a Mach number of 0.36 in air."""

THIN = 0.1  # Rarefaction up to which collisions take less than 6 % of the drag at any speed

WARMTH = Validity(
    "the growth of the drag of dense gas by the flyer's warmth",
    0.9,
    1.1,
    "that is an estimate, within a third of the growth",
)
"""Where the effect of a warm flyer counts."""

_FILM_SHARE = 0.5  # studies/drag/hot_sphere.py: 0.48 to 0.60 for T_w/T from 0.8 to 2.5
_HALF_GROWN = 80.0
"""Rarefaction at which the viscosity has half of its growth in dense gas: by a disk broadside
(studies/drag/hot_disk.py), 2 % at a rarefaction of 4.4 and 3 % at 8.9 for T_w/T = 1.6. In thinner
gas slip at the hot wall takes the rest away."""


def molecular_speed(temperature: Numeric, gas: AbstractGas) -> Array:
    r"""Most probable speed of molecules, :math:`\sqrt{2RT}` [m/s]."""
    return xp.sqrt(2.0 * gas.specific_gas_constant * xp.asarray(temperature))


def rarefaction_parameter(
    pressure: Numeric, temperature: Numeric, radius: Numeric, gas: AbstractGas
) -> Array:
    r"""Rarefaction parameter, :math:`\delta = p\,r/(\mu\sqrt{2RT}) = \sqrt\pi/(4\,\mathrm{Kn})`."""
    return pressure * radius / (gas.viscosity(temperature) * molecular_speed(temperature, gas))


def reynolds_number(speed_ratio: Numeric, rarefaction: Numeric) -> Array:
    r"""Reynolds number by the diameter, :math:`2\rho\,|U|\,r/\mu = 4\,|s|\,\delta` [1]."""
    return 4.0 * xp.abs(xp.asarray(speed_ratio)) * rarefaction


def viscosity_growth(
    excess: Numeric, rarefaction: Numeric, temperature: Numeric, gas: AbstractGas
) -> Array:
    r"""Growth of the drag of dense gas by the warmth of the body [1]."""
    # .. math:: \frac{\mu(T + 0.5\,w\,\theta\,T)}{\mu(T)}, \qquad w = \frac\delta{\delta + 80}
    #
    # Slow flow of gas of the density :math:`1/T` around a sphere of any temperature, with the
    # stress of uneven temperature, has the drag of gas of the mean temperature within 2 % for
    # :math:`T_w/T` from 0.8 to 2.5 (``studies/drag/hot_sphere.py``).
    grown = rarefaction / (rarefaction + _HALF_GROWN)
    film = temperature * (1.0 + _FILM_SHARE * grown * excess)
    return gas.viscosity(film) / gas.viscosity(temperature)
