r"""Photophoresis of spheres: rival laws of the force on a sphere of any conductivity.

All share one law of the heat that the gas takes: of the sphere as a whole from free molecules over
the temperature jump to conduction and natural convection
(:func:`~lightflyer.force.convection.sphere_conductance`), of its first harmonic to conduction.

With the amplitude A of the surface's temperature :math:`\bar T + A\cos\vartheta` the gas pushes the
sphere away from the warmer side; unlike halves are pushed towards the one of less accommodation.
"""

import math
from collections.abc import Mapping
from typing import ClassVar, Literal

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.core.entry_point import entry_point
from lightflyer.core.quantity import StandardErrors
from lightflyer.core.validity import Looks, Validity
from lightflyer.drag.similarity import rarefaction_parameter
from lightflyer.environment.base import EnvironmentState
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.flyer.sphere import Sphere
from lightflyer.force.base import AbstractForceModel, ForceSection, ModelResult
from lightflyer.force.convection import joined_conductance, sphere_conductance
from lightflyer.force.laws.faces import accommodated_force, free_molecular_conductance
from lightflyer.gas.base import knudsen_number

_THERMAL_CREEP = 1.14  # κ of [Rohatschek1995]
_ONSET = 0.311  # of transition_share
_KINETIC_SCATTER = 0.1
"""Logarithmic standard error: creep is 3 % above ``_THERMAL_CREEP`` by Shakhov's equation, 4 %
below by molecules of variable hard spheres, 11 % below by hard spheres; the fit adds 3 %."""

_SCATTER = 0.3
"""Logarithmic standard error of the force: by as much it is above that of the kinetic equation
between Knudsen numbers of 0.05 and 1 (studies/sphere_force)."""

_THIN = Validity(
    "the Knudsen number", 10.0, math.inf, "collisions, which this model leaves out, matter there"
)
_MODERATE_DIFFERENCES = Validity(
    "T_h/T_c",
    0.5,
    2.0,
    "what collisions leave of the force is known for spheres about as warm as the gas",
)
_SMALL_DIFFERENCES = Validity(
    "T_h/T_c", 0.0, 1.2, "rohatschek1995 is for a sphere about as warm as the gas"
)


@entry_point
def uneven_free_molecular_force(
    area: Numeric,
    tac_top: Numeric,
    tac_bottom: Numeric,
    pressure: Numeric,
    excess: Numeric,
    side: Numeric,
) -> Array:
    r"""Free-molecular force by the first harmonic of a sphere's temperature, upward [N].

    ``area``: of its cross section [m²]; ``excess``: of the mean temperature, ``side``: amplitude of
    the harmonic, both over the gas temperature [1].
    """

    # Molecules leave each place at one accommodated temperature:
    #
    # .. math:: F = -\oint\frac p2\sqrt{1+\alpha\,(\theta+s\cos\vartheta)}\,\cos\vartheta\,dA
    #
    # Over a half, with :math:`c=1+\alpha\theta`, :math:`b=\alpha s`, :math:`r_0=\sqrt c` and
    # :math:`r_1=\sqrt{c+b}`,
    #
    # .. math:: \int_0^1\sqrt{c+b\mu}\,\mu\,d\mu = \frac{r_0}2
    #     + b\,\frac{12r_1^2+21r_1r_0+7r_0^2}{30\,(r_1+r_0)^3}
    def growth(tac: Numeric, towards: Numeric) -> Array:
        cold = xp.sqrt(1.0 + tac * excess)
        hot = xp.sqrt(1.0 + tac * (excess + towards))
        polynomial = 12.0 * hot**2 + 21.0 * hot * cold + 7.0 * cold**2
        return tac * polynomial / (30.0 * (hot + cold) ** 3)

    return -area * pressure * side * (growth(tac_top, side) + growth(tac_bottom, -side))


def _mean_and_side(unknowns: tuple[Array, ...]) -> tuple[Array, Array]:
    """Excess of the mean, and the amplitude of the first harmonic [1]."""
    top, bottom = unknowns
    return 0.5 * (top + bottom), 0.5 * (top - bottom)


class AbstractSphereForce(AbstractForceModel):
    """Heat that the gas takes from a sphere, which the models share."""

    flyers: ClassVar[tuple[type[AbstractFlyer], ...]] = (Sphere,)
    results: ClassVar[Mapping[str, ModelResult]] = {
        "side_difference": ModelResult("K", "temperature of the top less that of the bottom"),
        "alignment": ModelResult("", "mean cosine of the axis to the vertical"),
    }

    @entry_point
    def heat_loss(
        self, flyer: Sphere, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> tuple[Array, ...]:
        mean, side = _mean_and_side(unknowns)
        whole, uneven = self._conductances(flyer, state, mean)
        return 0.5 * whole * mean + uneven * side, 0.5 * whole * mean - uneven * side

    def _conductances(
        self, flyer: Sphere, state: EnvironmentState, excess: Array
    ) -> tuple[Array, Array]:
        """Heat loss of the sphere, and of a half by the first harmonic, per excess [W]."""
        whole = sphere_conductance(
            excess,
            radius=flyer.radius,
            tac=flyer.tac_mean,
            pressure=state.pressure,
            temperature=state.temperature,
            gravity=state.gravity,
            gas=state.gas,
            wall_distance=state.wall_distance,
        )
        thin = _free_conductance(flyer.area, 1.0, state, excess)
        # conduction of the first harmonic is 2 k/a per area
        film = state.temperature * (1.0 + 0.5 * excess)
        dense = 2.0 * np.pi * flyer.radius * state.gas.conductivity(film) * state.temperature
        return whole, joined_conductance(thin, dense, flyer.tac_mean)

    @entry_point
    def own_results(
        self, flyer: Sphere, state: EnvironmentState, unknowns: tuple[Array, ...]
    ) -> dict[str, Array]:
        top, bottom = unknowns
        aligned = flyer.alignment(state) + 0.0 * top
        return {"side_difference": (top - bottom) * state.temperature, "alignment": aligned}

    def assumptions(self, flyer: Sphere) -> tuple[str, ...]:
        held = {
            "nothing": "the sphere tumbles: unlike halves push it nowhere",
            "gravity": "gravity holds the lower half of the sphere below",
            "dipole": "a dipole holds the lower half of the sphere below",
        }
        return (
            held[flyer.upright],
            "light from the side pushes the sphere sideways, which is left out, as is the pressure "
            "of radiation",
        )


def _free_conductance(
    area: Numeric, tac: Numeric, state: EnvironmentState, excess: Numeric
) -> Array:
    """Heat loss of an area to free molecules, per excess [W]."""
    return free_molecular_conductance(
        area,
        tac,
        state.pressure,
        state.gas.mean_speed(state.temperature),
        state.gas.heat_capacity_ratio_at(state.temperature * (1.0 + 0.5 * excess)),
    )


class Rohatschek1995(AbstractSphereForce):
    r"""Interpolation between free molecules and thermal creep.

    .. math::
        F = -\frac{2\hat F}{p/\hat p + \hat p/p} + \frac{\gamma-1}{\gamma+1}\,
            \frac{\Delta\alpha}{2\,\bar c\,\bar\alpha}\,\frac H{1+(p/p^*)^2}

    with :math:`\hat F`, :math:`\hat p` and :math:`p^*` of the paper and the heat H that the gas
    takes. Where the paper divides the asymmetry of the light by the particle's conductivity alone,
    gas and radiation take their part of the difference too.

    Attributes
    ----------
    force_error : array or None
        Deviation of the force from the model, in standard errors of 30 % [1].

    References
    ----------
    [Rohatschek1995]_
    """

    force_error: StandardErrors | None = None

    @entry_point
    def force(self, flyer: Sphere, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
        # .. math::
        #     D = \frac\pi2\sqrt{\frac{\pi\kappa}3}\,\frac{\bar c\,\eta}T, \qquad
        #     \hat F = D\sqrt{\frac\alpha2}\,a\,A, \qquad
        #     \hat p = \sqrt{\frac2\alpha}\,\frac{3\,T\,D}{\pi\,a}, \qquad
        #     p^* = \frac12\sqrt{3\pi\kappa}\,\frac{\bar c\,\eta}a
        #
        # where :math:`a\,A` stands for the paper's :math:`a^2 J_1 I/k_p`.
        mean, side = _mean_and_side(unknowns)
        whole, _ = self._conductances(flyer, state, mean)
        radius, pressure, temperature = flyer.radius, state.pressure, state.temperature
        gas, root = state.gas, math.sqrt(math.pi * _THERMAL_CREEP / 3.0)
        speed, ratio = gas.mean_speed(temperature), gas.heat_capacity_ratio_at(temperature)
        creep = gas.viscosity(temperature) * speed
        strength, tac = 0.5 * math.pi * root * creep / temperature, xp.asarray(flyer.tac_mean)
        strongest = strength * xp.sqrt(0.5 * tac) * radius * side * temperature
        best = xp.sqrt(2.0 / tac) * 3.0 * temperature * strength / (math.pi * radius)
        pushed = 2.0 * strongest / (pressure / best + best / pressure)
        top, bottom = flyer.tacs
        unlike = (ratio - 1.0) / (ratio + 1.0) * (bottom - top) / (2.0 * speed * tac)
        turn = 1.5 * root * creep / radius
        halves = unlike * whole * mean / (1.0 + (pressure / turn) ** 2)
        error = 1.0 if self.force_error is None else xp.exp(_SCATTER * self.force_error)
        return error * (flyer.alignment(state) * halves - pushed)

    def ranges(self, flyer: Sphere, state: EnvironmentState, temperature: Numeric) -> Looks:
        yield _SMALL_DIFFERENCES, temperature / state.temperature


def transition_share(rarefaction: Numeric) -> Array:
    r"""Force by the first harmonic in gas of any density, over that of free molecules [1]."""
    # .. math:: \frac1{1 + 0.311\,\delta + \delta^2/(6\kappa)}
    #
    # of a sphere at complete accommodation, whose last term is thermal creep in dense gas. The
    # second one is fitted to the linearised Shakhov equation, which it follows within 3 %
    # (studies/sphere_force).
    rarefaction = xp.asarray(rarefaction)
    return 1.0 / (1.0 + rarefaction * (_ONSET + rarefaction / (6.0 * _THERMAL_CREEP)))


class KineticSphere(AbstractSphereForce):
    r"""Free-molecular force, exact for any temperature, times what collisions leave of it.

    .. math::
        F = \frac{f(\delta)}{\bar\alpha + q(\delta)\,(1-\bar\alpha)}
            \left[\frac{H}{H_\mathrm{fm}}\,F_{\Delta\alpha} + F_{\Delta T}\right]

    with the forces of free molecules on unlike halves and by the temperature difference, and the
    shares f of the force and q of the heat loss of the first harmonic that are left at complete
    accommodation (:func:`transition_share`). In linear kinetic theory the denominator, and the heat
    loss H over that to free molecules, are exact for diffuse emission at one accommodated
    temperature: the gas sees only the temperature of what leaves the wall.

    Attributes
    ----------
    force_error : array or None
        Deviation of the force from the model, in standard errors of 10 % [1]: thermal creep of
        other molecules differs by so much. A flyer file gives it as 0 ± 1.

    References
    ----------
    [KalempaSharipov2021]_ for the same force at other walls.
    """

    force_error: StandardErrors | None = None

    @entry_point
    def force(self, flyer: Sphere, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
        mean, side = _mean_and_side(unknowns)
        whole, uneven = self._conductances(flyer, state, mean)
        thin, tac = _free_conductance(flyer.area, 1.0, state, mean), flyer.tac_mean
        # at complete accommodation, 1/q less what the wall adds
        left = 1.0 / (thin / uneven - (1.0 / tac - 1.0))
        gas = (state.pressure, state.temperature, flyer.radius, state.gas)
        share = transition_share(rarefaction_parameter(*gas)) / (tac + left * (1.0 - tac))
        cooled = whole / (4.0 * tac * thin)
        error = 1.0 if self.force_error is None else xp.exp(_KINETIC_SCATTER * self.force_error)
        return error * share * _free_molecular_force(flyer, state, mean, side, cooled)

    def ranges(self, flyer: Sphere, state: EnvironmentState, temperature: Numeric) -> Looks:
        yield _MODERATE_DIFFERENCES, temperature / state.temperature


class FreeMolecularSphere(AbstractSphereForce):
    r"""Free-molecular heat loss and force of a sphere, exact for any temperature.

    .. math:: F = -\oint\frac p2\sqrt{1+\alpha\,(\theta+s\cos\vartheta)}\,\cos\vartheta\,dA

    for molecules that leave each place at one accommodated temperature. Right for Knudsen numbers
    much greater than one only.
    """

    feels_walls: ClassVar[bool] = False

    def _conductances(
        self, flyer: Sphere, state: EnvironmentState, excess: Array
    ) -> tuple[Array, Array]:
        uneven = _free_conductance(flyer.area, flyer.tac_mean, state, excess)
        return 4.0 * uneven, uneven

    @entry_point
    def force(self, flyer: Sphere, state: EnvironmentState, unknowns: tuple[Array, ...]) -> Array:
        mean, side = _mean_and_side(unknowns)
        return _free_molecular_force(flyer, state, mean, side)

    def ranges(self, flyer: Sphere, state: EnvironmentState, temperature: Numeric) -> Looks:
        yield _THIN, knudsen_number(state.pressure, state.temperature, flyer.radius, state.gas)


def _free_molecular_force(
    flyer: Sphere, state: EnvironmentState, excess: Array, side: Array, cooled: Numeric = 1.0
) -> Array:
    """Upward force of free molecules on a sphere that is held upright in part [N].

    ``cooled``: its heat loss, over that to free molecules [1].
    """
    held = flyer.alignment(state)
    halves = accommodated_force(flyer.area, *flyer.tacs, state.pressure, excess)
    top, bottom = flyer.tacs
    upright, turned = (
        uneven_free_molecular_force(flyer.area, *tacs, state.pressure, excess, side)
        for tacs in ((top, bottom), (bottom, top))
    )
    tumbling = 0.5 * (upright + turned)
    return held * (cooled * halves + upright) + (1.0 - held) * tumbling


class Rohatschek1995Section(ForceSection, of=Rohatschek1995):
    """``[force]``: Rohatschek's interpolation for a sphere."""

    model: Literal["rohatschek1995"]


class KineticSphereSection(ForceSection, of=KineticSphere):
    """``[force]``: free molecules, and what collisions leave of them."""

    model: Literal["kinetic-sphere"]


class FreeMolecularSphereSection(ForceSection, of=FreeMolecularSphere):
    """``[force]``: the exact free-molecular limit of a sphere."""

    model: Literal["free-molecular-sphere"]
