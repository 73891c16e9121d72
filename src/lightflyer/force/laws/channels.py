r"""A wall with channels as a pump: flow of gas through slots and round holes.

Gas creeps along the walls of a channel towards the warmer end, and flows back where the pressure
there is higher. Per area of a wall whose open fraction is :math:`\varphi` the mass flux towards the
warmer side is

.. math::
    j = \frac{\varphi\,g}{v}\,(\Delta p_0 - \Delta p), \qquad v = \sqrt{2RT}

with the pressure difference :math:`\Delta p` of the warmer over the colder side, the difference
:math:`\Delta p_0` that stops the flow (:func:`thermomolecular_pressure`), and a conductance
:math:`g` (:func:`channel_conductance`). Channel and entrances are resistances in series:

.. math::
    \frac1g = \frac{L}{A\,G_P} + \frac{\sqrt\pi\,(1-\varphi)}{1+\kappa\,\delta}, \qquad
    \delta = \frac{p A}{\mu v}

:math:`A` is the **width of a slot** and the **radius of a round hole**, :math:`L` the length of the
channel in the direction of the flow, and ``length`` in this module always :math:`L/A`.

**At which temperatures?** What drives the flow are the temperatures of the gas that *comes* to the
two mouths of a channel, not those of the wall (:func:`thermomolecular_pressure` says why). They
are the wall's in dense gas and those of the surroundings to free molecules; between these limits
:func:`gas_at_faces` has them. Gas that comes equally warm from both sides drives nothing.

All functions take arrays that broadcast, and are differentiable for positive arguments. They are
used with :data:`SLOT` or :data:`ROUND`::

    length = wall_thickness / width
    exponent = thermomolecular_exponent(SLOT, rarefaction, length)
    stopping = thermomolecular_pressure(exponent, pressure, excess_warm, excess_cold)
    g = channel_conductance(SLOT, rarefaction, length, open_fraction)
    flux = pumped_flux(open_fraction, g, speed, stopping - difference)
"""

import abc
import math
from functools import lru_cache
from typing import ClassVar, NamedTuple

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.files.table import shipped_table
from lightflyer.gas.molecules import coaxial_share, slot_transmission
from lightflyer.numerics.interpolation import Curves

_ROOT_PI = math.sqrt(math.pi)
_SLIP = 1.018  # viscous slip σ_P of the Shakhov equation, diffuse walls, [SharipovSeleznev1998]
_FREE_ROUND = 8.0 / (3.0 * _ROOT_PI)  # Knudsen's long tube
_FREE_EXPONENT = 0.5  # p ∝ √T to free molecules
_KNOTS = 4  # each fourth row of the table; tests look at the others


class Coefficients(NamedTuple):
    r"""Coefficients of :math:`j = \frac{p}{v}\frac AL(-G_P\,\Delta p/p + G_T\,\Delta T/T)`."""

    poiseuille: Array  # :math:`G_P` and :math:`G_T` [1]
    creep: Array  # :math:`G_P` and :math:`G_T` [1]

    @property
    def exponent(self) -> Array:
        r"""Exponent :math:`\gamma = G_T/G_P` of :math:`p \propto T^\gamma` without flow [1]."""
        return self.creep / self.poiseuille


class ChannelShape(abc.ABC):
    r"""Cross section of a channel; the two there are, are :data:`SLOT` and :data:`ROUND`."""

    name: ClassVar[str]
    size: ClassVar[str]  # What length :math:`A` is
    viscous: ClassVar[float]  # Slope of :math:`G_P` over the rarefaction in dense gas [1]
    # How both entrances conduct in dense gas, over free molecules and the rarefaction:
    # :math:`\kappa` [1]
    entrance: ClassVar[float]

    @abc.abstractmethod
    def coefficients(self, rarefaction: Numeric, length: Numeric | None) -> Coefficients:
        """Poiseuille and thermal-creep coefficients [1]; ``length``: over the :attr:`size`."""

    @abc.abstractmethod
    def direct_share(self, length: Numeric) -> Array:
        """Share of straight paths through the mouth that do not meet the wall [1]."""


class _Slot(ChannelShape):
    name = "slot"
    size = "width"
    viscous = 1.0 / 6.0
    entrance = math.pi**1.5 / 16.0  # Stokes flow through a slit in a thin wall, [Hasimoto1958]

    def coefficients(self, rarefaction: Numeric, length: Numeric | None) -> Coefficients:
        paths = (rarefaction * xp.exp(part) for part in _slot_curves()(xp.log(rarefaction)))
        # a molecule that flies along the slot meets another one, or leaves by its end
        ends: tuple[Numeric, Numeric] = 0.0, 0.0
        if length is not None:
            passing = slot_transmission(length)
            free = length * passing.through / (_ROOT_PI * passing.back)
            ends = 1.0 / xp.expm1(_ROOT_PI * (free - _SLIP)), 1.0 / xp.expm1(_ROOT_PI * free)
        poiseuille, creep = (
            xp.log1p(1.0 / (path + end)) / _ROOT_PI for path, end in zip(paths, ends, strict=True)
        )
        return Coefficients(self.viscous * rarefaction + _SLIP + poiseuille, _FREE_EXPONENT * creep)

    def direct_share(self, length: Numeric) -> Array:
        return 1.0 / (xp.sqrt(1.0 + length**2) + length)


class _Round(ChannelShape):
    name = "round hole"
    size = "radius"
    viscous = 0.25
    entrance = 2.0 / (3.0 * _ROOT_PI)  # Sampson's flow through a hole in a thin wall

    def coefficients(self, rarefaction: Numeric, length: Numeric | None) -> Coefficients:
        slipping, creeping = (
            rarefaction * xp.exp(part) for part in _round_curves()(xp.log(rarefaction))
        )
        # equivalent length of a tube to free molecules over its length, [Santeler1986]
        stretch = 1.0 if length is None else 1.0 + 1.0 / (3.0 + 3.0 * length / 7.0)
        free = _FREE_ROUND / stretch
        return Coefficients(
            self.viscous * rarefaction + (free + _SLIP * slipping) / (1.0 + slipping),
            _FREE_EXPONENT * _FREE_ROUND / (stretch + creeping),
        )

    def direct_share(self, length: Numeric) -> Array:
        return coaxial_share(length)


SLOT: ChannelShape = _Slot()
"""Between two parallel walls, whose distance is :math:`A`; much wider than that."""

ROUND: ChannelShape = _Round()  # A round hole or tube of the radius :math:`A`


@lru_cache
def _slot_curves() -> Curves:
    r"""What is left of the coefficients of a slot without their limits, over :math:`\ln\delta`."""
    # Both grow as the logarithm of the mean free path in thin gas.
    table = channel_table()
    slipping = table["slot_poiseuille"] - SLOT.viscous * table["rarefaction"] - _SLIP
    paths = np.stack(
        [np.expm1(_ROOT_PI * slipping), np.expm1(_ROOT_PI / _FREE_EXPONENT * table["slot_creep"])]
    )
    return _curves(table["rarefaction"], 1.0 / (table["rarefaction"] * paths))


@lru_cache
def _round_curves() -> Curves:
    """The same of a round hole, whose coefficients have finite limits."""
    table = channel_table()
    slipping = table["round_poiseuille"] - ROUND.viscous * table["rarefaction"]
    parts = np.stack(
        [
            (_FREE_ROUND - slipping) / (slipping - _SLIP),
            _FREE_EXPONENT * _FREE_ROUND / table["round_creep"] - 1.0,
        ]
    )
    return _curves(table["rarefaction"], parts / table["rarefaction"])


def _curves(rarefaction: np.ndarray, values: np.ndarray) -> Curves:
    return Curves.through(np.log(rarefaction)[::_KNOTS], np.log(values).T[::_KNOTS])


def channel_table() -> dict[str, np.ndarray]:
    r"""Coefficients of long channels with diffuse walls by the linearised Shakhov equation [1]."""
    return shipped_table("channels.csv").numbers


def channel_coefficients(
    shape: ChannelShape, rarefaction: Numeric, length: Numeric | None = None
) -> Coefficients:
    """Poiseuille and thermal-creep coefficient of a channel with diffuse walls."""
    # Smooth functions through a solution of the linearised Shakhov equation from a rarefaction of
    # 10⁻⁴ to 30; within 0.2 % of it, exact in both limits. Other model equations and the Boltzmann
    # equation differ from it by up to 3 %.
    #
    # A channel of finite length passes as many free molecules as Clausing's integral equation says,
    # within 0.4 % (slot) or 0.7 % (round), and is like an endless one where the mean free path is
    # shorter than the channel. :math:`G_T/G_P` for free molecules is ½. An endless slot gets there
    # only as the logarithm of the mean free path.
    #
    # Source: [Shakhov1968]_, [SharipovSeleznev1998]_, [Berman1965]_, [Santeler1986]_.
    return shape.coefficients(rarefaction, length)


def direct_share(shape: ChannelShape, length: Numeric) -> Array:
    """Share of straight paths through a channel's mouth that do not meet its wall [1]."""
    # Of diffuse light or heat radiation, or of free molecules; the view factor of the two mouths.
    #
    # Source: [HowellMenguc2020]_: parallel strips, coaxial discs.
    return shape.direct_share(length)


def channel_conductance(
    shape: ChannelShape,
    rarefaction: Numeric,
    length: Numeric,
    open_fraction: Numeric = 0.0,
    coefficients: Coefficients | None = None,
) -> Array:
    r"""Conductance :math:`g` of a channel with its two entrances [1]."""
    # .. math::
    #     \frac1g = \frac{L}{A\,G_P} + \frac{\sqrt\pi\,(1-\varphi)}{1+\kappa\,\delta}
    #
    # In dense gas the resistance of the entrances is that of Stokes flow through a hole in a thin
    # wall, :math:`\kappa = 2/(3\sqrt\pi)` (round) or :math:`\pi^{3/2}/16` (slot), and Poiseuille's
    # in series is within 1 % [Dagan1982]_. The factor :math:`1-\varphi`: of gas that drifts towards
    # a wall more molecules arrive than of gas at rest, and a wall that is all hole does not resist.
    # The pressure difference :math:`\Delta p` is then the force on the wall per area, by what the
    # flow outside does.
    if coefficients is None:
        coefficients = channel_coefficients(shape, rarefaction, length)
    entrances = entrance_resistance(shape, rarefaction, open_fraction)
    return 1.0 / (length / coefficients.poiseuille + entrances)


def entrance_resistance(
    shape: ChannelShape, rarefaction: Numeric, open_fraction: Numeric = 0.0
) -> Array:
    r"""Resistance of both entrances of a channel, the last term of :func:`channel_conductance`."""
    return _ROOT_PI * (1.0 - open_fraction) / (1.0 + shape.entrance * rarefaction)


def thermomolecular_exponent(
    shape: ChannelShape, rarefaction: Numeric, length: Numeric | None = None
) -> Array:
    r"""Exponent :math:`\gamma = G_T/G_P` of :math:`p \propto T^\gamma` without flow [1]."""
    return channel_coefficients(shape, rarefaction, length).exponent


def thermomolecular_pressure(
    exponent: Numeric, pressure: Numeric, excess_warm: Numeric, excess_cold: Numeric
) -> Array:
    r"""Pressure of the warmer over the colder side at which no gas flows [Pa]."""
    # .. math::
    #     \Delta p_0 = 2p\,\sinh\left[\frac\gamma2\ln\frac{1+\theta_w}{1+\theta_c}\right]
    #     \approx \gamma\,p\,\frac{\Delta T}{\bar T}
    #
    # :math:`p_w/p_c = (T_w/T_c)^\gamma` between the temperatures of the gas. Three pumps are in
    # series: one along the wall of the channel, between the wall's temperatures at both ends, with
    # the exponent :math:`\gamma`; and one at each entrance, between gas and wall, with an exponent
    # that is ½ to free molecules too and vanishes in dense gas. Here it is taken for
    # :math:`\gamma`, so that the wall's temperatures cancel. That is exact for free molecules, of
    # which as many pass whatever the wall's temperature; for a hole in a thin wall; and where the
    # gas is as warm as the wall's faces, as it is at a wall much wider than the mean free path.
    ratio = xp.log1p(excess_warm) - xp.log1p(excess_cold)
    return 2.0 * pressure * xp.sinh(0.5 * exponent * ratio)


def pumped_flux(
    open_fraction: Numeric,
    conductance: Numeric,
    most_probable_speed: Numeric,
    pressure_difference: Numeric,
) -> Array:
    r"""Mass flux of gas through a wall with channels, per area of the wall [kg/(m² s)]."""
    # .. math:: j = \frac{\varphi\,g}{v}\,(\Delta p_0 - \Delta p)
    return open_fraction * conductance * pressure_difference / most_probable_speed


class GasAround(NamedTuple):
    r"""Heat that gas at the two faces of a wall gives to the gas far away."""

    # Over what free molecules would exchange with one face at complete accommodation, per
    # temperature difference. Conduction around a body in dense gas, infinite where the body is much
    # smaller than the mean free path.

    common: Numeric  # Of each side where the gas is equally warm at both faces [1]
    # Of each side where it is as much warmer at one as it is colder at the other [1]
    difference: Numeric


def gas_at_faces(
    excess_one: Numeric,
    excess_other: Numeric,
    exchange_one: Numeric,
    exchange_other: Numeric,
    passing: Numeric,
    surroundings: GasAround,
) -> tuple[Array, Array]:
    r"""Temperature of the gas that comes to the two faces of a wall with channels [1]."""
    # .. math::
    #     e_1\,(\theta_1 - \vartheta_1) = \tau\,(\vartheta_1 - \vartheta_2)
    #         + \tfrac12 c_+\,(\vartheta_1 + \vartheta_2)
    #         + \tfrac12 c_-\,(\vartheta_1 - \vartheta_2)
    #
    # and the same the other way round: what gas at temperature :math:`\vartheta` takes from a face,
    # it gives to the gas at the other face through the wall, and to the gas far away.
    common, difference = surroundings
    here = passing + 0.5 * (difference + common)
    there = passing + 0.5 * (difference - common)
    # here² − there², without cancellation
    determinant = exchange_one * exchange_other + here * (exchange_one + exchange_other)
    determinant = determinant + (common * (2.0 * passing + difference))
    given_one, given_other = exchange_one * excess_one, exchange_other * excess_other
    return (
        ((exchange_other + here) * given_one + there * given_other) / determinant,
        ((exchange_one + here) * given_other + there * given_one) / determinant,
    )
