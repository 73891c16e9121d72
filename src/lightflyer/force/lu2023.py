"""The paper's model: two limits joined by interpolation, with two fitted coefficients.

The paper's equations as printed do not give the paper's own predictions. Other conventions give its
bands of altitude. One such choice of many is here as :data:`REPORTED`, beside :data:`PRINTED`;
neither is the truth, nor known to be the paper's.
"""

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Literal, NamedTuple

import numpy as np
import pydantic

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module, field
from lightflyer.core.checks import is_concrete
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import ForceCoefficient, StandardErrors
from lightflyer.core.validity import Looks, Validity
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.disk import Disk
from lightflyer.force.base import AbstractForceModel, ForceSection
from lightflyer.force.laws.faces import free_molecular_conductance, in_series
from lightflyer.gas.air import AbstractAir
from lightflyer.gas.base import AbstractGas

_THERMAL_CREEP = 1.14  # κ_s of [Lu2023] Eq. (20)
_DISK_NUSSELT = 8.0 / math.pi  # isothermal disk at rest, [Lu2023] Eq. (7)
_CONVECTION = 0.417  # Rayleigh-number term of [Lu2023] Eq. (7)
_FITTED_C_FM, _FITTED_C_CONT = 0.4, 3.0  # below [Lu2023] Eq. (18)
# Logarithmic standard error of the fit: root mean square by which measured lights at lift-off leave
# it, of germanium (+0.27) and nanotubes (-0.15) at 2 cm and of their ratio at 3 and 4 cm (0.47 and
# 0.56, half of each on either film, which leaves four degrees of freedom), at 1.15 g/m²
_SCATTER = 0.3
_FITTED_DIAMETERS = Validity(
    "the diameter [m]", 0.02, 0.04, "c_fm and c_cont of lu2023 were fitted to disks of 2 to 4 cm"
)
_FITTED_WARMER = Validity(
    "T_h/T_c", 1.0, math.inf, "c_fm and c_cont of lu2023 were fitted to films warmer than the gas"
)
# mylar melts at 527 K, and the paper's chamber is at 293 K
_FITTED_HEATING = Validity(
    "T_h/T_c",
    -math.inf,
    1.8,
    "c_fm and c_cont of lu2023 were fitted to mylar films at room temperature, which melt there",
)


class Reading(Module):
    """The conventions in which the two readings of the paper differ.

    A weight of 0 stands for the gas temperature, 1 for the mean of gas and disk, 2 for the disk.
    """

    #: Temperature at which Eq. (4) takes the molecules' mean speed
    heat_weight: float = field(static=True)
    #: How often Eq. (5) is counted. The isothermal disk's 8rκΔT is for both faces already
    continuum_faces: float = field(static=True)
    #: Temperature that divides the difference in Eq. (19)
    force_weight: float = field(static=True)
    #: Temperature in the numerator of Eq. (20)
    creep_weight: float = field(static=True, default=2.0)


PRINTED = Reading(heat_weight=1.0, continuum_faces=1.0, force_weight=0.0)
"""The equations as printed."""

REPORTED = Reading(heat_weight=0.0, continuum_faces=2.0, force_weight=1.0)
"""Conventions that give the bands of altitude the paper reports: one choice of many."""

READINGS = {"printed": PRINTED, "reported": REPORTED}
"""Readings by the name they have in a flyer file."""


def rayleigh_number(
    excess: Numeric,
    *,
    radius: Numeric,
    pressure: Numeric,
    temperature: Numeric,
    gravity: Numeric,
    gas: AbstractGas,
) -> Array:
    r"""Rayleigh number of a disk, from the size of the temperature difference [1]."""
    # .. math:: \mathrm{Ra} = \frac{g}{\bar T}\,\frac{\rho\,(2r)^3\,|\Delta T|}{\mu D},
    #     \qquad D = \frac{\kappa}{\rho c_p}, \quad \rho = \frac{p}{R\bar T}
    #
    # Source: [Lu2023]_ Eqs. (8)-(10), with (9) corrected.
    mean = _mean_temperature(temperature, excess)
    density = gas.density(pressure, mean)
    viscosity, conductivity = gas.viscosity(mean), gas.conductivity(mean)
    difference = temperature * abs(excess)
    buoyancy = gravity * density * (2.0 * radius) ** 3 * difference
    return buoyancy * density * gas.heat_capacity(mean) / (mean * viscosity * conductivity)


def heat_conductances(
    excess: Numeric,
    *,
    radius: Numeric,
    tac_mean: Numeric,
    pressure: Numeric,
    temperature: Numeric,
    gravity: Numeric,
    gas: AbstractGas,
    reading: Reading = REPORTED,
) -> tuple[Array, Array]:
    """Heat loss of a disk per relative temperature excess in the two limits [W]."""
    # Source: [Lu2023]_ Eqs. (4), (5) and (7).
    stretch = 1.0 + 0.5 * reading.heat_weight * excess
    speed = gas.mean_speed(temperature) / xp.sqrt(stretch)
    ratio = gas.heat_capacity_ratio_at(_mean_temperature(temperature, excess))
    free_molecular = free_molecular_conductance(
        2.0 * np.pi * radius**2, tac_mean, pressure, speed, ratio
    )
    rayleigh = rayleigh_number(
        excess, radius=radius, pressure=pressure, temperature=temperature, gravity=gravity, gas=gas
    )
    # the fourth root has no derivative at zero; its product with the excess there is zero
    still = rayleigh == 0.0
    fourth_root = xp.where(still, 0.0, xp.sqrt(xp.sqrt(xp.where(still, 1.0, rayleigh))))
    nusselt = _DISK_NUSSELT + _CONVECTION * fourth_root
    conductivity = gas.conductivity(_mean_temperature(temperature, excess))
    continuum = nusselt * np.pi * radius * conductivity * temperature
    return free_molecular, reading.continuum_faces * continuum


def creep_stiffness(
    excess: Numeric,
    creep_temperature: Numeric,
    *,
    radius: Numeric,
    tac_mean: Numeric,
    pressure: Numeric,
    temperature: Numeric,
    gas: AbstractGas,
) -> Array:
    r"""Continuum force per relative temperature excess and TAC difference [N]."""
    # .. math:: \frac{F_\mathrm{cont}}{\Delta\alpha\,\theta} = 16\mu \cdot 6\kappa_s \frac\mu\rho
    #     \cdot \frac{T_h\kappa}{r p\bar v}\cdot\frac{\gamma-1}{\gamma+1}\cdot\frac1{\bar\alpha}
    #
    # Source: [Lu2023]_ Eq. (20), with the factor μ that its misprint lost.
    mean = _mean_temperature(temperature, excess)
    viscosity = gas.viscosity(mean)
    kinematic = viscosity / gas.density(pressure, mean)
    creep = 16.0 * viscosity * 6.0 * _THERMAL_CREEP * kinematic
    flux = creep_temperature * gas.conductivity(mean)
    thermal = flux / (radius * pressure * gas.mean_speed(mean))
    ratio = gas.heat_capacity_ratio_at(mean)
    internal_modes = (ratio - 1.0) / (ratio + 1.0)
    return creep * thermal * internal_modes / tac_mean


def _mean_temperature(temperature: Numeric, excess: Numeric) -> Array:
    return temperature * (1.0 + 0.5 * excess)


class Lu2023(AbstractForceModel):
    r"""Interpolation between free-molecular and continuum limits for a disk.

    .. math::
        \frac1{Q} = \frac1{Q_\mathrm{fm}} + \frac1{Q_\mathrm{cont}}, \qquad
        \frac1{F} = \frac1{C_\mathrm{fm}F_\mathrm{fm}} + \frac1{C_\mathrm{cont}F_\mathrm{cont}}

    Attributes
    ----------
    c_fm, c_cont : array
        Coefficients of the force's limits [1]. The paper fits 0.4 and 3 to its experiments;
        aerosols have 1 and 1.
    reading : Reading
        Default :data:`REPORTED`.
    force_error : array or None
        Deviation of the force from the model, in standard errors of 30 % [1]: so much do the lights
        that the paper measured scatter about its fit. A flyer file gives it as 0 ± 1, unless it
        gives coefficients of its own.

    Raises
    ------
    ParameterError
        If a concrete coefficient is not positive.

    Notes
    -----
    With :data:`REPORTED` the force saturates as the disk gets hotter, so a flyer may be unable
    to levitate at any irradiance.

    References
    ----------
    [Lu2023]_ Eqs. (3)-(10) and (18)-(20), with their misprints corrected (see the errata).
    """

    flyers: ClassVar[tuple[type[AbstractFlyer], ...]] = (Disk,)
    feels_walls: ClassVar[bool] = False

    c_fm: ForceCoefficient = _FITTED_C_FM
    c_cont: ForceCoefficient = _FITTED_C_CONT
    reading: Reading = REPORTED
    force_error: StandardErrors | None = None

    @entry_point
    def heat_loss(
        self, flyer: Disk, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        (excess,) = unknowns
        limits = heat_conductances(
            excess,
            radius=flyer.radius,
            tac_mean=flyer.film.tac_mean,
            pressure=state.pressure,
            temperature=state.temperature,
            gravity=state.gravity,
            gas=state.gas,
            reading=self.reading,
        )
        return (excess * in_series(*limits),)

    @entry_point
    def force(self, flyer: Disk, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
        (excess,) = unknowns
        stretch = 1.0 + 0.5 * self.reading.force_weight * excess
        free_molecular = 0.25 * flyer.area * state.pressure / stretch
        continuum = creep_stiffness(
            excess,
            state.temperature * (1.0 + 0.5 * self.reading.creep_weight * excess),
            radius=flyer.radius,
            tac_mean=flyer.film.tac_mean,
            pressure=state.pressure,
            temperature=state.temperature,
            gas=state.gas,
        )
        per_difference = in_series(self.c_fm * free_molecular, self.c_cont * continuum)
        if self.force_error is not None:
            per_difference = per_difference * xp.exp(_SCATTER * self.force_error)
        return flyer.film.tac_difference * excess * per_difference

    @property
    def open_errors(self) -> tuple[str, ...]:
        """Coefficients of one's own have their own ±, not the scatter about the paper's."""
        fitted = (self.c_fm, self.c_cont) == (_FITTED_C_FM, _FITTED_C_CONT)
        return super().open_errors if fitted else ()

    def ranges(self, flyer: Disk, state: EnvironmentState, temperature: Numeric) -> Looks:
        """Those of the tests to which the paper's coefficients were fitted."""
        # Other coefficients hold where those who fitted them say.
        fitted = (self.c_fm == _FITTED_C_FM) & (self.c_cont == _FITTED_C_CONT)
        ratio, diameter = temperature / state.temperature, 2.0 * flyer.radius
        where = np.where if is_concrete(ratio, diameter, self.c_fm, self.c_cont) else xp.where
        ratio = where(fitted, ratio, np.nan)
        yield _FITTED_DIAMETERS, where(fitted, diameter, np.nan)
        yield _FITTED_WARMER, ratio
        yield _FITTED_HEATING, ratio

    def remarks(
        self, flyer: Disk, state: EnvironmentState, temperature: Numeric
    ) -> tuple[str, ...]:
        if isinstance(state.gas, AbstractAir) or (float(self.c_fm), float(self.c_cont)) != (
            _FITTED_C_FM,
            _FITTED_C_CONT,
        ):
            return ()
        return (f"c_fm and c_cont of lu2023 were fitted in air, and the gas is {state.gas.name}",)


class Lu2023ForceSection(ForceSection, of=Lu2023):
    """``[force]``: the paper's interpolation between limits."""

    model: Literal["lu2023"] = "lu2023"
    reading: Literal["reported", "printed"] = "reported"

    @pydantic.model_validator(mode="before")
    @classmethod
    def _without_scatter(cls, content: Any) -> Any:
        """Coefficients of one's own have their own ±, not the scatter about the paper's."""
        if isinstance(content, Mapping) and {"c_fm", "c_cont"} & content.keys():
            return {"force_error": 0.0, **content}
        return content

    def make(self, **given: Any) -> Lu2023:
        """The model in that reading."""
        return super().make(reading=READINGS[self.reading], **given)


class SimpleForm(NamedTuple):
    """The interpolation of Lu et al. with coefficients fitted to another model."""

    model: Lu2023
    deviation: float  #: Root mean square of the logarithm of its force over the other model's [1]
    largest: float  #: Largest absolute value of that logarithm [1]


def fit_simple_form(
    model: AbstractForceModel,
    flyer: Disk,
    state: EnvironmentState,
    excess: Numeric,
    reading: Reading = REPORTED,
) -> SimpleForm:
    """Fit the coefficients of Lu et al. to the force of another model.

    Parameters
    ----------
    model : AbstractForceModel
        The model to imitate.
    flyer : Disk
    state : EnvironmentState
        Surroundings in which the forces shall agree: arrays, at least two points.
    excess : array, shape (...)
        Relative temperature excess there [1].
    reading : Reading
        Default :data:`lightflyer.force.REPORTED`.

    Returns
    -------
    SimpleForm
        Least squares in the logarithm of the force.

    Raises
    ------
    ParameterError
        If there are fewer than two forces, or one is not positive.

    Examples
    --------
    >>> import numpy as np
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> state = lf.Chamber().state(np.geomspace(0.1, 100.0, 20))
    >>> same = lf.force.fit_simple_form(lf.Lu2023(0.7, 2.0), lf.Disk(film, 0.01), state, 0.5)
    >>> print(f"{same.model.c_fm:.6f} {same.model.c_cont:.6f}")
    0.700000 2.000000
    """
    # 1/F is linear in 1/C_fm and 1/C_cont; only the weights, those of the logarithm, are not
    from scipy.optimize import least_squares

    unknowns = (excess,)
    wanted = np.ravel(model.force(flyer, state, unknowns))
    if wanted.size < 2 or not np.all(wanted > 0.0):
        raise ParameterError("the forces to imitate must be positive, and at least two")
    huge = 1e30  # takes the other limit out
    thin = np.ravel(Lu2023(1.0, huge, reading).force(flyer, state, unknowns))
    dense = np.ravel(Lu2023(huge, 1.0, reading).force(flyer, state, unknowns))

    def misfit(logarithms: np.ndarray) -> np.ndarray:
        c_fm, c_cont = np.exp(logarithms)
        return -np.log(wanted / (c_fm * thin) + wanted / (c_cont * dense))

    found = least_squares(misfit, np.zeros(2), xtol=1e-14, ftol=1e-14, gtol=1e-14)
    c_fm, c_cont = map(float, np.exp(found.x))
    return SimpleForm(
        model=Lu2023(c_fm, c_cont, reading),
        deviation=float(np.sqrt(np.mean(found.fun**2))),
        largest=float(np.max(np.abs(found.fun))),
    )
