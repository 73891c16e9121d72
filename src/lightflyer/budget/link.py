"""A radio link: the power that a bit rate over a distance takes."""

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core import constants
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import (
    Checked,
    DataRate,
    Decibels,
    Efficiency,
    Fraction,
    Frequency,
    LinkDistance,
    Temperature,
)

REQUIRED_SIGNAL_DB = 9.6
"""Energy per bit over noise density [dB] at which one bit in 1e5 is wrong: coherent detection of
two phases without coding, :math:`\\tfrac12\\operatorname{erfc}\\sqrt{E_b/N_0}`."""


def from_decibels(decibels: Numeric) -> Array:
    """Ratio of two powers [1]; ``decibels`` [dB]."""
    return xp.power(10.0, 0.1 * xp.asarray(decibels))


@entry_point
def free_space_loss(distance: LinkDistance, frequency: Frequency) -> Array:
    r"""Power sent over power received between antennas without gain in free space.

    .. math:: L = \left(\frac{4\pi d f}{c}\right)^2

    Parameters
    ----------
    distance, frequency : array, shape (...)
        [m], [Hz].

    Returns
    -------
    array, broadcast shape
        [1].

    Notes
    -----
    H. T. Friis, Proc. IRE 34, 254 (1946).

    Examples
    --------
    >>> import math
    >>> print(f"{10.0 * math.log10(free_space_loss(30e3, 434e6)):.2f} dB")
    114.74 dB
    """
    return (4.0 * np.pi * distance * frequency / constants.SPEED_OF_LIGHT) ** 2


class RadioLink(Checked):
    r"""A transmitter on the flyer and a receiver elsewhere.

    .. math:: P = k_B T R\,\frac{E_b}{N_0}\,\frac{L\,L_0\,m}{G_t G_r}


    Raises
    ------
    ParameterError
        If a concrete number is out of range.

    Notes
    -----
    Free space without obstacle, reflection from the ground and horizon. What electronics take
    that does not send belongs to an item of the budget.
    """

    distance: LinkDistance  #: Between the antennas, d [m]
    frequency: Frequency  #: [Hz]
    data_rate: DataRate  #: R while it sends [bit/s]
    noise_temperature: Temperature  #: Of receiver and sky together, T [K]
    #: Of the antennas [dB over one that sends evenly in all directions]
    transmit_gain_dbi: Decibels = 0.0
    receive_gain_dbi: Decibels = 0.0  #: As ``transmit_gain_dbi``
    #: Energy per bit over noise density at the receiver, :math:`E_b/N_0` [dB]
    required_signal_db: Decibels = REQUIRED_SIGNAL_DB
    losses_db: Decibels = 0.0  #: Of cables, air, pointing and polarisation, :math:`L_0` [dB]
    margin_db: Decibels = 3.0  #: m [dB]
    efficiency: Efficiency = 0.3  #: Power sent over power that the transmitter takes [1]
    duty: Fraction = 1.0  #: Share of the time in which it sends [1]

    def transmit_power(self) -> Array:
        """Power that the antenna sends while it sends [W]."""
        return _transmit_power(self)

    def consumed_power(self) -> Array:
        """Mean power that the transmitter takes [W]."""
        return self.transmit_power() * self.duty / self.efficiency

    def describe(self) -> str:
        """The link in words, with its numbers."""
        return (
            f"radio link: {float(self.data_rate):g} bit/s over {float(self.distance) / 1e3:g} km "
            f"at {float(self.frequency) / 1e6:g} MHz, {float(self.noise_temperature):g} K, gains "
            f"{float(self.transmit_gain_dbi):g} and {float(self.receive_gain_dbi):g} dB, losses "
            f"{float(self.losses_db):g} dB, margin {float(self.margin_db):g} dB, "
            f"{100.0 * float(self.duty):g} % of the time"
        )


@entry_point
def _transmit_power(link: RadioLink) -> Array:
    noise = constants.BOLTZMANN * link.noise_temperature * link.data_rate
    decibels = (
        link.required_signal_db
        + link.losses_db
        + link.margin_db
        - link.transmit_gain_dbi
        - link.receive_gain_dbi
    )
    return noise * from_decibels(decibels) * free_space_loss(link.distance, link.frequency)
