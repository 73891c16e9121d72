"""A sphere: a particle that light warms on one side, or whose halves accommodate unlike."""

from collections.abc import Mapping
from functools import lru_cache, partial
from typing import Any, ClassVar, Literal

import numpy as np
import pydantic

from lightflyer.array.namespace import Array, Numeric, by_numpy, xp
from lightflyer.array.records import field
from lightflyer.core import constants
from lightflyer.core.checks import is_traced
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import (
    AccommodationCoefficient,
    Asymmetry,
    Conductivity,
    Contradictions,
    Density,
    Distance,
    Emittance,
    Length,
    Mass,
    Multiple,
    ParticleRadius,
    Temperature,
)
from lightflyer.environment.base import EnvironmentState
from lightflyer.environment.radiation import Attitude
from lightflyer.files.section import DIAMETER, Spelling
from lightflyer.files.toml_file import file_beside
from lightflyer.film.layer_section import NamedSection, Policy, named_medium
from lightflyer.film.layered_section import LitSection, light_of
from lightflyer.film.media.medium import Extrapolation, Medium
from lightflyer.film.optics.curve import (
    NODES,
    EmittanceCurve,
    emission_growth,
    emittance_at,
    emittance_bounds,
)
from lightflyer.film.optics.spectra import Spectrum
from lightflyer.film.optics.sphere import read_absorbed_powers, sphere_absorption
from lightflyer.film.properties import excess_of_growth
from lightflyer.flyer.base import AbstractRoundFlyer, FlyerSection
from lightflyer.numerics.interpolation import Spline

Upright = Literal["nothing", "gravity", "dipole"]
"""What keeps the lower half of a sphere below."""

_OPAQUE = 0.5  # Asymmetry factor of a sphere that absorbs all at its surface, over its efficiency
_MOST = 0.75  # The same of one that absorbs all in a point of its surface
_GIVEN = ("absorption_efficiency", "emittance")  # in a file without a material
_COMPUTED = ("absorption_efficiency", "asymmetry", "emittance", "infrared_asymmetry")
_SIZES = 25  # of a table, from whose interpolation more sizes follow
_RANGE = 8.0  # of sizes over that of the file, of which searches ask
_ROUNDING = 1e-9
_NO_TILT = "its lower half is below, or anywhere"
_MICROMETRE, _MILLIMETRE = 1e-6, 1e-3
_FEW = 1e-2  # energy over k T below which Langevin's function is summed as a series


class Sphere(AbstractRoundFlyer):
    r"""A solid sphere in light from anywhere.

    Its surface is as warm as :math:`\bar T + A\cos\vartheta`, with the angle from the vertical:
    higher harmonics push no sphere. The two unknowns are the temperatures of its poles,
    :math:`\bar T\pm A`. With the asymmetry factor :math:`J_1` of its source of heat

    .. math::
        J_1 = \frac3{4\pi a^3 I}\int q\,z\,dV, \qquad A = \frac{J_1\,I_z\,a}{k_p + h\,a}

    where z points to the light, :math:`I_z` is the net irradiance of a level face from above, and
    h is what gas and radiation take of the first harmonic, per area and kelvin.

    Attributes
    ----------
    radius : array
        [m].
    absorption_efficiency : array
        Light that it absorbs, over that which falls on its cross section [1].
    emittance : array or EmittanceCurve
        Heat radiation that it emits, over that of a black sphere [1]; a curve makes it a function
        of its temperature.
    conductivity : array
        Thermal conductivity :math:`k_p` [W/(m K)].
    tac_top : array
        Thermal accommodation coefficient (TAC) of its upper half [1].
    tac_bottom : array or None
        TAC of its lower half [1]; by default as above.
    density : array or None
        [kg/m³]. Either this or its mass is given.
    body_mass : array or None
        Mass without payload [kg].
    asymmetry : array or None
        Asymmetry factor for light [1]: positive where the lit side is warmer, negative where the
        sphere focuses light on its far side. By default that of an opaque sphere, half of the
        absorption efficiency.
    infrared_asymmetry : array or EmittanceCurve or None
        The same for heat radiation; by default half of the emittance.
    upright : {"nothing", "gravity", "dipole"}
        What keeps its lower half below. With nothing it tumbles, and the force of unlike halves
        averages to zero; the force of the temperature difference follows the light.
    mass_offset : array or None
        How far below the sphere's centre its centre of mass is [m]. Gravity then holds it as well
        as molecules let it; None stands for a firm hold.
    payload : array
        Mass carried beside its own [kg].
    attitude : None
        A sphere has none.
    highest_temperature : array or None
        Temperature that it withstands [K]; None where it is not known.

    Raises
    ------
    ParameterError
        If a concrete number is impossible, or does not fit the others.

    References
    ----------
    [Rohatschek1995]_

    Examples
    --------
    >>> soot = Sphere(0.5e-6, 1.0, 0.3, 0.2, 0.9, density=1800.0)
    >>> print(f"{soot.describe()}, {soot.own_mass * 1e15:.3f} pg")
    sphere of 1 µm, 0.942 pg
    """

    nodes: ClassVar[tuple[str, ...]] = ("top", "bottom")
    lifted_by: ClassVar[str] = "gas that leaves one side with more energy than the other"
    hangs: ClassVar[str | None] = f"a sphere has no tilt: {_NO_TILT}"
    steady: ClassVar[bool] = True
    drag_law: ClassVar[str] = "of a sphere by Cunningham's law, with inertia"

    radius: ParticleRadius
    absorption_efficiency: Multiple
    emittance: Emittance
    conductivity: Conductivity
    tac_top: AccommodationCoefficient
    tac_bottom: AccommodationCoefficient | None = None
    density: Density | None = None
    body_mass: Mass | None = None
    asymmetry: Asymmetry | None = None
    infrared_asymmetry: Asymmetry | None = None
    upright: Upright = field(static=True, default="nothing")
    mass_offset: Distance | None = None
    payload: Mass = 0.0
    attitude: Attitude | None = None
    highest_temperature: Temperature | None = None

    @staticmethod
    def contradiction(
        radius: Numeric,
        absorption_efficiency: Numeric,
        asymmetry: Numeric | None,
        emittance: Numeric,
        infrared_asymmetry: Numeric | None,
        density: Numeric | None,
        body_mass: Numeric | None,
        upright: Upright,
        mass_offset: Numeric | None,
    ) -> Contradictions:
        """How numbers contradict each other."""
        neither = (density is None) == (body_mass is None)
        yield neither, "a sphere needs either its density or its mass"
        for name, factor, share in (
            ("asymmetry", asymmetry, absorption_efficiency),
            ("infrared_asymmetry", infrared_asymmetry, emittance),
        ):
            if factor is None or share is None:
                continue
            whole = "emittance" if share is emittance else "absorption_efficiency"
            most = f"{name} is at most 3/4 of {whole}: no heat is released outside of the sphere"
            yield abs(factor) > _MOST * share, most
        if mass_offset is not None:
            turns = 'mass_offset, by which gravity turns a sphere, needs upright = "gravity"'
            yield upright != "gravity", turns
            yield mass_offset >= radius, "mass_offset must be less than the radius"

    @classmethod
    def of(
        cls, medium: Medium, radius: Length, light: Spectrum | None = None, **given: Any
    ) -> "Sphere":
        """A sphere of a medium, from which its optics and density follow.

        ``light``: by default sunlight. ``given``: other numbers, which replace those computed.
        """
        found = sphere_absorption(medium, radius, light)
        computed = {name: getattr(found, name) for name in _COMPUTED}
        if "body_mass" not in given:
            computed["density"] = medium.density
        return cls(radius, **(computed | given))

    def __check_init__(self) -> None:
        if self.attitude is not None:
            raise ParameterError(f"a sphere has no attitude: {_NO_TILT}")

    @property
    def displaced_volume(self) -> Numeric:
        return self.volume

    @property
    def own_mass(self) -> Numeric:
        if self.body_mass is not None:
            return self.body_mass
        return self.density * self.displaced_volume

    @property
    def tacs(self) -> tuple[Numeric, Numeric]:
        """TAC of the upper and the lower half [1]."""
        return self.tac_top, self.tac_top if self.tac_bottom is None else self.tac_bottom

    @property
    def tac_mean(self) -> Numeric:
        """Mean TAC of the halves [1]."""
        top, bottom = self.tacs
        return 0.5 * (top + bottom)

    def alignment(self, state: EnvironmentState) -> Numeric:
        r"""Mean cosine of the angle between its axis and the vertical [1]."""
        # Langevin's function of the energy that turns it against that of molecules,
        # .. math:: \coth x - \frac1x, \qquad x = \frac{m\,g\,s}{k_B T}
        if self.upright == "nothing":
            return 0.0
        if self.mass_offset is None:
            return 1.0
        turning = self.own_mass * state.gravity * self.mass_offset
        ratio = xp.asarray(turning / (constants.BOLTZMANN * state.temperature))
        small = ratio < _FEW
        few, much = xp.where(small, ratio, 0.0), xp.where(small, 1.0, ratio)
        series = few * (1.0 / 3.0 - few**2 * (1.0 / 45.0 - few**2 * 2.0 / 945.0))
        return xp.where(small, series, 1.0 / xp.tanh(much) - 1.0 / much)

    def outer_wall(self, unknowns: tuple[Array, ...]) -> tuple[Numeric, Numeric]:
        return self.tac_mean, 0.5 * (unknowns[0] + unknowns[1])

    def beam_areas(self, state: EnvironmentState) -> tuple[Array, ...]:
        level = state.radiation.on_faces()
        return self._by_halves(
            self.absorption_efficiency,
            self.asymmetry,
            state.radiation.on_sphere().beam,
            level.beam_top - level.beam_bottom,
        )

    def heat_gains(self, state: EnvironmentState) -> tuple[Array, ...]:
        radiation, temperature = state.radiation, state.temperature
        level = radiation.on_faces()
        light = self._by_halves(
            self.absorption_efficiency,
            self.asymmetry,
            radiation.on_sphere().diffuse,
            level.diffuse_top - level.diffuse_bottom,
        )
        above, below = radiation.infrared_excess(temperature)
        infrared = self._by_halves(
            emittance_at(self.emittance, temperature),
            emittance_at(self.infrared_asymmetry, temperature),
            radiation.infrared_excess_on_sphere(temperature),
            above - below,
        )
        return light[0] + infrared[0], light[1] + infrared[1]

    def _by_halves(
        self, share: Numeric, asymmetry: Numeric | None, mean: Numeric, net: Numeric
    ) -> tuple[Array, Array]:
        """Power of the upper and the lower half, whose harmonics are those of a source [W].

        ``mean``: irradiance over the sphere; ``net``: of a level face from above less from below.
        """
        # over a half, cos is a quarter of the sphere
        factor = _OPAQUE * share if asymmetry is None else asymmetry
        whole, uneven = self.surface * share * mean, self.area * factor * net
        return 0.5 * whole + uneven, 0.5 * whole - uneven

    def heat_losses(self, state: EnvironmentState, unknowns: tuple[Array, ...]) -> tuple[Any, ...]:
        # Radiation of both harmonics, the first one to first order, and what the warmer half
        # conducts to the other.
        top, bottom = unknowns
        mean, side = 0.5 * (top + bottom), 0.5 * (top - bottom)
        black = state.radiation.stefan_boltzmann * state.temperature**4
        emitted = self.surface * black * emission_growth(self.emittance, state.temperature, mean)
        emittance = emittance_at(self.emittance, state.temperature * (1.0 + mean))
        steepness = self.area * black * 4.0 * emittance * (1.0 + mean) ** 3
        conducted = np.pi * self.radius * self.conductivity * state.temperature
        uneven = (steepness + conducted) * side
        return 0.5 * emitted + uneven, 0.5 * emitted - uneven

    def highest_excess(self, state: EnvironmentState, power: Array) -> Array:
        """Excess in vacuum, of the whole sphere [1]."""
        black = self.surface * state.radiation.stefan_boltzmann * state.temperature**4
        lowest, highest = emittance_bounds(self.emittance)
        limit = xp.where(power > 0.0, lowest, highest)
        growth = power / black + (emittance_at(self.emittance, state.temperature) - limit)
        return xp.abs(excess_of_growth(growth / limit))

    def describe(self) -> str:
        diameter = 2.0 * float(np.asarray(self.radius))
        small = diameter < _MILLIMETRE
        size = f"{diameter / (_MICROMETRE if small else _MILLIMETRE):g}"
        return f"sphere of {size} {'µm' if small else 'mm'}"


class SphereSection(FlyerSection, NamedSection, LitSection, of=Sphere):
    """``[flyer]``: a sphere, which has no section of a film but may have a material."""

    needs_film: ClassVar[bool] = False
    default_model: ClassVar[str] = "kinetic-sphere"
    not_varied: ClassVar[Mapping[str, str]] = {
        "highest_temperature": "is a limit and not a property",
    }
    spelled: ClassVar[Mapping[str, Spelling]] = {
        "radius": DIAMETER,
        "body_mass": Spelling("mass"),
    }
    first_keys: ClassVar[tuple[str, ...]] = ("shape", "diameter", "density", "mass")

    shape: Literal["sphere"]
    material: str | None = None
    extrapolation: Policy = "error"
    absorbed_powers: str | None = None
    absorption_efficiency: Multiple | None = None
    emittance: Emittance | None = None

    _nominal: float = pydantic.PrivateAttr(0.0)

    @pydantic.field_validator("absorbed_powers")
    @classmethod
    def _readable(cls, name: str, info: pydantic.ValidationInfo) -> str:
        path = file_beside(name, info)
        read_absorbed_powers(path)
        return path

    @pydantic.model_validator(mode="after")
    def _has_optics(self) -> "SphereSection":
        self._nominal = float(self._value_of("radius"))
        if self.material is None:
            lacking = [name for name in _GIVEN if getattr(self, name) is None]
            if lacking:
                raise ConfigurationError(f"needs {' and '.join(lacking)}, or a material")
        else:
            _optics_of_size(self.material, self.extrapolation, self.spectrum, self._nominal)
        return self

    def idle(self) -> dict[str, str]:
        """A sphere has no attitude."""
        turned = [key for key in ("tilt", "azimuth") if getattr(self, key).value != 0.0]
        of_media = ("extrapolation", "spectrum") if self.material is None else ()
        stated = () if self.asymmetry is None else ("absorbed_powers",)  # type: ignore[attr-defined] # a generated field
        return {
            **dict.fromkeys(turned, f"on a sphere: {_NO_TILT}"),
            **dict.fromkeys(of_media, "without material"),
            **dict.fromkeys(stated, "beside asymmetry"),
        }

    def _value_of(self, field: str) -> Any:
        own = super()._value_of(field)
        if field != "density" or own is not None or self.mass is not None or not self.material:  # type: ignore[attr-defined] # generated fields
            return own
        return named_medium(self.material, Extrapolation.ERROR).density

    @property
    def warnings(self) -> tuple[str, ...]:
        if self.material is None:
            return ()
        medium = named_medium(self.material, Extrapolation(self.extrapolation))
        return sphere_absorption(medium, self._nominal, self.light()).diagnostics

    def make(self, **given: Any) -> Sphere:
        """The sphere, with what its material absorbs and emits where the file does not say."""
        if self.material is not None:
            found = self._optics(self._value_of("radius"))
            given |= {key: one for key, one in found.items() if getattr(self, key) is None}
        if self.absorbed_powers is not None:
            share = read_absorbed_powers(self.absorbed_powers).asymmetry
            stated = self._value_of("absorption_efficiency")
            given["asymmetry"] = share * given.get("absorption_efficiency", stated)
        made: Sphere = super().make(**given)
        return made

    def _optics(self, radius: Numeric) -> dict[str, Any]:
        """What a sphere of the material absorbs and emits; of many sizes by a table."""
        of = partial(_optics_of_size, str(self.material), self.extrapolation, self.spectrum)
        if is_traced(radius):
            sizes = self._nominal * np.geomspace(1.0 / _RANGE, _RANGE, _SIZES)
        else:
            sizes, places = np.unique(radius, return_inverse=True)
            if sizes.size <= _SIZES:
                return _named_optics(np.stack([of(size) for size in sizes])[places])
            sizes = np.geomspace(sizes[0], sizes[-1], _SIZES)
        logarithms = np.log(sizes)
        table = Spline.through(logarithms, np.stack([of(size) for size in sizes]))
        place = xp.log(radius)
        rows = table(place)
        beyond = (place < logarithms[0] - _ROUNDING) | (place > logarithms[-1] + _ROUNDING)
        return _named_optics(xp.where(beyond[..., None], np.nan, rows))


@lru_cache(maxsize=1000)
def _optics_of_size(material: str, policy: str, spectrum: str, radius: float) -> np.ndarray:
    """Efficiency, asymmetry, and coefficients of the curves of a sphere of a material."""
    medium = named_medium(material, Extrapolation(policy))
    with by_numpy():  # it stays, so it must not belong to a trace
        found = sphere_absorption(medium, radius, light_of(spectrum))
    curves = found.emittance.coefficients, found.infrared_asymmetry.coefficients
    return np.concatenate([[found.absorption_efficiency, found.asymmetry], *curves])


def _named_optics(rows: Array) -> dict[str, Any]:
    """Fields of a sphere from :func:`_optics_of_size`, shape (..., 42)."""
    curves = (EmittanceCurve(part) for part in (rows[..., 2 : 2 + NODES], rows[..., 2 + NODES :]))
    return dict(zip(_COMPUTED, (rows[..., 0], rows[..., 1], *curves), strict=True))
