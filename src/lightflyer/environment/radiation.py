"""Light and heat radiation that reach a flyer."""

import equinox as eqx
import jax.numpy as jnp
import numpy as np
from jax import Array

from lightflyer.foundation import constants
from lightflyer.foundation.checks import require_range
from lightflyer.foundation.types import Numeric


class Radiation(eqx.Module):
    r"""The beam of light and the thermal surroundings of the two faces.

    Attributes
    ----------
    irradiance : array
        Irradiance of the beam on a surface that faces it [W/m²].
    incidence : array
        Angle between the beam and the normal of the flyer [rad]. The absorbed light goes with
        its cosine.
    infrared_top, infrared_bottom : array or None
        Thermal irradiance on the top and bottom face [W/m²]. None stands for black
        surroundings at the gas temperature, :math:`\sigma T_c^4`, as in the paper.
    albedo : array
        Share of the beam that a surface below reflects onto the bottom face [1].
    stefan_boltzmann : array
        Stefan-Boltzmann constant [W/(m² K⁴)]; a field only because the paper's computed
        values rest on a rounded one.

    Raises
    ------
    ParameterError
        If a concrete value is out of its range.
    """

    irradiance: Numeric = constants.SOLAR_CONSTANT
    incidence: Numeric = 0.0
    infrared_top: Numeric = None
    infrared_bottom: Numeric = None
    albedo: Numeric = 0.0
    stefan_boltzmann: Numeric = constants.STEFAN_BOLTZMANN

    def __check_init__(self) -> None:
        require_range("irradiance", self.irradiance, 0.0)
        require_range("incidence", self.incidence, 0.0, np.pi / 2)
        require_range("infrared_top", self.infrared_top, 0.0)
        require_range("infrared_bottom", self.infrared_bottom, 0.0)
        require_range("albedo", self.albedo, 0.0, 1.0)

    def beam_power(self, absorptance_top: Numeric, absorptance_bottom: Numeric) -> Array:
        """Absorbed light per area and per irradiance of the beam [1].

        Parameters
        ----------
        absorptance_top, absorptance_bottom : array, shape (...)
            Absorptance of the faces for the light [1].

        Returns
        -------
        array, broadcast shape
        """
        return jnp.cos(self.incidence) * (absorptance_top + self.albedo * absorptance_bottom)

    def infrared_excess(
        self, gas_temperature: Numeric, emittance_top: Numeric, emittance_bottom: Numeric
    ) -> Array:
        """Absorbed thermal radiation beyond that of surroundings at the gas temperature.

        Parameters
        ----------
        gas_temperature : array, shape (...)
            [K].
        emittance_top, emittance_bottom : array, shape (...)
            Emittance of the faces, by Kirchhoff also their absorptance for heat radiation [1].

        Returns
        -------
        array, broadcast shape
            [W/m²]; zero where both surroundings are None.
        """
        black = self.stefan_boltzmann * gas_temperature**4
        excess = jnp.zeros(jnp.broadcast_shapes(jnp.shape(black), jnp.shape(emittance_top)))
        faces = ((self.infrared_top, emittance_top), (self.infrared_bottom, emittance_bottom))
        for infrared, emittance in faces:
            if infrared is not None:
                excess = excess + emittance * (infrared - black)
        return excess
