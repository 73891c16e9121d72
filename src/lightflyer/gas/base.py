"""Base class of gases, and the lengths and speeds derived from them.

A gas is three correlations in temperature, two numbers and what its molecules are. What kinetic
theory needs follows from them. A gas of your own is one subclass of :class:`AbstractGas`; files
know it once it is in :data:`lightflyer.gas.GASES`.
"""

import abc
from typing import ClassVar

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import AbstractClassVar, AbstractVar, Module
from lightflyer.core.checks import require_positive
from lightflyer.core.entry_point import entry_point, reads_units
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import Length, Pressure, Temperature
from lightflyer.core.validity import Looks, describe
from lightflyer.gas.molecules import COLLISION_RATE, Parker, vhs_collision_rate

_RATIOS = 1.002, 1.001  # of temperatures between which a slope is taken


class AbstractGas(Module):
    """An ideal gas. Every method takes arrays of any shape and is differentiable for T > 0."""

    name: AbstractClassVar[str]  #: What messages call it
    #: ``"monatomic"``, ``"diatomic"`` or ``"polyatomic"``: which internal motion takes part in
    #: collisions. Force models that depend on it refuse other gases
    molecules: AbstractClassVar[str]
    #: Shares of the rotating molecules and :class:`~lightflyer.gas.molecules.Parker`'s law of
    #: each, for :meth:`rotational_collision_number`; empty where it is not known
    rotation: ClassVar[tuple[tuple[float, Parker], ...]] = ()
    #: Molar gas constant over molar mass [J/(kg K)]
    specific_gas_constant: AbstractVar[Numeric]
    #: Isobaric over isochoric heat capacity [1]. A gas in which it depends on temperature has none;
    #: laws take :meth:`heat_capacity_ratio_at`
    heat_capacity_ratio: AbstractVar[Numeric]

    @abc.abstractmethod
    def viscosity(self, temperature: Temperature) -> Array:
        """Dynamic viscosity [Pa s] at ``temperature`` [K]."""

    @abc.abstractmethod
    def conductivity(self, temperature: Temperature) -> Array:
        """Thermal conductivity [W/(m K)] at ``temperature`` [K]."""

    @abc.abstractmethod
    def heat_capacity(self, temperature: Temperature) -> Array:
        """Isobaric specific heat capacity [J/(kg K)] at ``temperature`` [K]."""

    def heat_capacity_ratio_at(self, temperature: Temperature) -> Numeric:
        """Ratio of heat capacities [1] at ``temperature`` [K]; by default the same at any.

        For free molecules between a gas and a wall take it at the mean of the two temperatures;
        in carbon dioxide between 140 K and 260 K their heat is then right to 0.3 %.
        """
        return self.heat_capacity_ratio

    @entry_point
    def viscosity_exponent(self, temperature: Temperature) -> Array:
        r"""Local exponent of the viscosity, :math:`\omega = d\ln\mu/d\ln T` [1].

        ½ for hard spheres, 1 for Maxwell molecules. [Bird1994]_ gives exponents of variable hard
        spheres for 273 K; they are means over a range of temperatures.
        """
        # by differences of fourth order in the logarithm of the temperature, good to 1e-11; a gas
        # whose formula has a slope gives that
        far, near = (
            xp.log(self.viscosity(temperature * ratio) / self.viscosity(temperature / ratio))
            / (2.0 * np.log(ratio))
            for ratio in _RATIOS
        )
        share = (np.log(_RATIOS[1]) / np.log(_RATIOS[0])) ** 2
        return (near - share * far) / (1.0 - share)

    @entry_point
    def prandtl_number(self, temperature: Temperature) -> Array:
        r"""Prandtl number :math:`\mathrm{Pr} = \mu c_p/\kappa` [1]."""
        conductivity = self.conductivity(temperature)
        return self.viscosity(temperature) * self.heat_capacity(temperature) / conductivity

    @entry_point
    def reduced_conductivity(self, temperature: Temperature) -> Array:
        r"""Conductivity over viscosity and gas constant, :math:`\kappa/(\mu R)` [1].

        By kinetic theory :math:`\frac32 f_\mathrm{tr} + \frac j2 f_\mathrm{int}` with the Eucken
        factors of translation and of :math:`j` internal degrees of freedom. In a monatomic gas it
        is 15/4, within 0.4 %.
        """
        viscous = self.viscosity(temperature) * self.specific_gas_constant
        return self.conductivity(temperature) / viscous

    @entry_point
    def eucken_factor(self, temperature: Temperature) -> Array:
        r"""Eucken factor :math:`f = \kappa/(\mu c_v)` [1]; 5/2 for monatomic gas.

        Vibrations count in the heat capacity.
        """
        isochoric = self.heat_capacity(temperature) / self.specific_gas_constant - 1.0
        return self.reduced_conductivity(temperature) / isochoric

    @entry_point
    def internal_degrees_of_freedom(self, temperature: Temperature) -> Array:
        r"""Internal degrees of freedom that walls share, :math:`j = 2/(\gamma-1) - 3` [1].

        0 for a monatomic gas, 2 for rotating diatomic molecules; a gas of which walls exchange
        vibration has more, which need be no integer.
        """
        ratio = xp.asarray(self.heat_capacity_ratio_at(temperature))
        return 2.0 / (ratio - 1.0) - 3.0 + xp.zeros_like(temperature)

    @entry_point
    def rotational_collision_number(
        self, temperature: Temperature, viscosity_exponent: Numeric | None = None
    ) -> Array:
        r"""Collisions of a variable hard sphere until its rotation relaxes.

        .. math::
            Z = \nu\tau, \qquad \frac{dT_r}{dt} = \frac{T - T_r}{\tau}, \qquad
            \nu = \frac{30}{(7-2\omega)(5-2\omega)}\frac p\mu

        with the collision rate :math:`\nu` of one molecule and the temperature :math:`T` of its
        flight, held constant.

        Parameters
        ----------
        temperature : array, shape (...)
            [K].
        viscosity_exponent : array, shape (...), optional
            :math:`\omega` of the variable hard sphere [1]; by default the local one.

        Returns
        -------
        array, broadcast shape
            [1].

        Raises
        ------
        ParameterError
            If the molecules do not rotate, or how their rotation relaxes is not known.

        Notes
        -----
        Model equations take :math:`\tau p/\mu = Z\,(7-2\omega)(5-2\omega)/30`, which does not
        depend on :math:`\omega`.

        In Larsen and Borgnakke's method, where a collision exchanges the rotation of one of its
        molecules with probability :math:`P`, and never that of both,
        :math:`P = \left(1 + \frac{j}{5-2\omega}\right)\frac1Z` for each of them: an exchange leaves
        it with a share of the energy, not with none [Haas1994]_.

        The source's formula fits measurements, which scatter by a fifth.

        References
        ----------
        [Parker1959]_, [LordiMates1970]_, [Bird1994]_.
        """
        if not self.rotation:
            atoms = self.molecules == "monatomic"
            reason = "its atoms do not rotate" if atoms else "how it relaxes is not known"
            raise ParameterError(f"{self.name} has no rotational collision number: {reason}")
        if viscosity_exponent is None:
            viscosity_exponent = self.viscosity_exponent(temperature)
        rotating = sum(share for share, _ in self.rotation)
        rate = sum(share / law(temperature) for share, law in self.rotation) / rotating
        return vhs_collision_rate(viscosity_exponent) / COLLISION_RATE / rate

    def assumptions(self) -> tuple[str, ...]:
        """What is assumed about the gas, in short texts."""
        return ()

    def ranges(self, temperature: Temperature) -> Looks:
        """Ranges in which the gas is known, each with a number of its own."""
        return ()

    def diagnostics(self, temperature: Temperature, pressure: Pressure) -> tuple[str, ...]:
        """Warnings where the gas is outside its known range; arguments are concrete."""
        return describe(self.ranges(temperature), pressure)

    @entry_point
    def density(self, pressure: Pressure, temperature: Temperature) -> Array:
        """Density of the ideal gas [kg/m³] at ``pressure`` [Pa] and ``temperature`` [K]."""
        return pressure / (self.specific_gas_constant * temperature)

    @entry_point
    def mean_speed(self, temperature: Temperature) -> Array:
        r"""Mean molecular speed :math:`\bar v = \sqrt{8RT/\pi}` [m/s]."""
        return xp.sqrt(8.0 * self.specific_gas_constant * temperature / np.pi)


@entry_point
def _mean_free_path(pressure: Pressure, temperature: Temperature, gas: AbstractGas) -> Array:
    thermal = xp.sqrt(np.pi * gas.specific_gas_constant * temperature / 2.0)
    return gas.viscosity(temperature) / pressure * thermal


@reads_units
def mean_free_path(pressure: Pressure, temperature: Temperature, gas: AbstractGas) -> Array:
    r"""Mean free path from viscosity.

    .. math:: \lambda = \frac{\mu}{p}\sqrt{\frac{\pi R T}{2}}

    Parameters
    ----------
    pressure : array, shape (...)
        Gas pressure [Pa].
    temperature : array, shape (...)
        Gas temperature [K].
    gas : AbstractGas

    Returns
    -------
    array, broadcast shape
        Mean free path [m].

    Raises
    ------
    ParameterError
        If a concrete pressure or temperature is not positive.

    Notes
    -----
    Differentiable for p, T > 0. The US Standard Atmosphere defines another one from a
    collision diameter; see :meth:`US1976.mean_free_path`.

    References
    ----------
    [VincentiKruger1965]_ ch. I.4.

    Examples
    --------
    >>> from lightflyer.gas import AIR
    >>> print(f"{mean_free_path(101325.0, 288.15, AIR):.3e} m")
    6.384e-08 m
    """
    require_positive(pressure=pressure, temperature=temperature)
    return _mean_free_path(pressure, temperature, gas)


@reads_units
def knudsen_number(
    pressure: Pressure, temperature: Temperature, radius: Length, gas: AbstractGas
) -> Array:
    r"""Knudsen number of a disk, :math:`\mathrm{Kn} = \lambda/(2r)`.

    Parameters
    ----------
    pressure, temperature : array, shape (...)
        Gas pressure [Pa] and temperature [K].
    radius : array, shape (...)
        Disk radius [m].
    gas : AbstractGas

    Returns
    -------
    array, broadcast shape
        Knudsen number [1].

    Raises
    ------
    ParameterError
        If a concrete argument is not positive.

    Examples
    --------
    >>> from lightflyer.gas import AIR
    >>> print(f"{knudsen_number(3.446, 215.4, 0.01, AIR):.4f}")
    0.0641
    """
    require_positive(pressure=pressure, temperature=temperature, radius=radius)
    return _knudsen_number(pressure, temperature, radius, gas)


@entry_point
def _knudsen_number(
    pressure: Pressure, temperature: Temperature, radius: Length, gas: AbstractGas
) -> Array:
    return _mean_free_path(pressure, temperature, gas) / (2.0 * radius)
