"""The optical, surface and mass properties of a film, and ``[film]`` of a flyer file.

The properties may be measured, as the section here states them, or computed.
"""

import abc
import dataclasses
import functools
import warnings
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
import pydantic

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module
from lightflyer.core.checks import is_concrete
from lightflyer.core.errors import ConfigurationError, ParameterError, ParameterWarning
from lightflyer.core.quantity import (
    AccommodationCoefficient,
    ArealDensity,
    Checked,
    Contradictions,
    Correlation,
    Emittance,
    Fraction,
    Temperature,
    contradiction_in,
)
from lightflyer.core.units import Measured
from lightflyer.files.section import Alternative
from lightflyer.film.optics.curve import (
    EmittanceCurve,
    black_growth,
    coefficients_of,
    emission_growth,
    emittance_at,
    emittance_bounds,
)
from lightflyer.structure.laminate import Laminate

_WHOLE = 1.0 + 1e-9  # all radiation, and rounding
_PASSING = ("transmittance", "transmittance_bottom", "infrared_transmittance")
FACES = ("tac_top", "tac_bottom")  # Numbers whose errors ``tac_correlation`` is about


class FilmProperties(Checked):
    """Properties of a thin film, one value or an array of them each.

    Attributes
    ----------
    areal_density : array
        Mass per area [kg/m²].
    absorptance : array
        Absorptance of the top face for the incoming light [1].
    emittance_top, emittance_bottom : array or EmittanceCurve
        Hemispherical thermal emittance of each face [1]; a curve makes it a function of the
        film's own temperature.
    tac_top, tac_bottom : array
        Thermal accommodation coefficient of each face [1]. A flyer is pushed up where the
        bottom's is the larger.
    absorptance_bottom : array or None
        Absorptance of the bottom face, for light reflected from below [1]; by default that of
        the top.
    transmittance : array
        Share of the incoming light that passes through the film [1]. It matters where one film
        shades another, as the infrared transmittance does.
    infrared_transmittance : array or EmittanceCurve
        Share of heat radiation that passes through the film, from either side [1]; a curve makes
        it a function of the temperature of a black body that radiates.
    highest_temperature : array or None
        Temperature that the film withstands [K]; None where it is not known. It changes no result:
        predictions warn, and optimisation stays, above it.
    transmittance_bottom : array or None
        Share of light on the bottom face that passes [1]; by default that of the top. It differs
        where the light comes from other directions.
    laminate : Laminate or None
        The film as a structure; None where its stiffness and stress are not known.

    Raises
    ------
    ParameterError
        If a concrete value is impossible.

    Warns
    -----
    ParameterWarning
        If a TAC exceeds one.
    """

    areal_density: ArealDensity
    absorptance: Fraction
    emittance_top: Emittance
    emittance_bottom: Emittance
    tac_top: AccommodationCoefficient
    tac_bottom: AccommodationCoefficient
    absorptance_bottom: Fraction | None = None
    transmittance: Fraction = 0.0
    infrared_transmittance: Fraction = 0.0
    highest_temperature: Temperature | None = None
    transmittance_bottom: Fraction | None = None
    laminate: Laminate | None = None

    def __check_init__(self) -> None:
        for name in ("tac_top", "tac_bottom"):
            tac = getattr(self, name)
            if is_concrete(tac) and np.any(np.asarray(tac) > 1.0):
                warnings.warn(
                    f"{name} = {np.max(tac):g} exceeds 1: unphysical; treated as a measured value "
                    "with a systematic error, where only the difference of TACs counts",
                    ParameterWarning,
                    stacklevel=2,
                )

    @staticmethod
    def contradiction(
        absorptance: Numeric,
        absorptance_bottom: Numeric | None,
        transmittance: Numeric | None,
        transmittance_bottom: Numeric | None,
        emittance_top: Numeric,
        emittance_bottom: Numeric,
        infrared_transmittance: Numeric | None,
    ) -> Contradictions:
        """Where more radiation is absorbed and transmitted than arrives."""
        passed, absorbed = ("transmittance", transmittance), ("absorptance", absorptance)
        passed_up = "transmittance_bottom", transmittance_bottom
        absorbed_below = "absorptance_bottom", absorptance_bottom
        heat = "infrared_transmittance", infrared_transmittance
        pairs: Any = (
            (passed, absorbed),
            (passed if transmittance_bottom is None else passed_up,
             absorbed if absorptance_bottom is None else absorbed_below),
            (heat, ("emittance_top", emittance_top)),
            (heat, ("emittance_bottom", emittance_bottom)),
        )  # fmt: skip
        for (passing, through), (absorbing, share) in pairs:
            if through is None or EmittanceCurve in (type(through), type(share)):
                continue
            words = ""
            if is_concrete(through, share):
                words = (
                    f"{passing} = {np.max(through):g} and {absorbing} = {np.max(share):g} exceed 1 "
                    "together"
                )
            yield through + share > _WHOLE, words

    @property
    def tac_mean(self) -> Numeric:
        r"""Mean TAC of the faces, :math:`\bar\alpha` [1]."""
        return 0.5 * (self.tac_top + self.tac_bottom)

    @property
    def tac_difference(self) -> Numeric:
        r"""Bottom minus top, :math:`\Delta\alpha` [1]; positive pushes up."""
        return self.tac_bottom - self.tac_top

    @property
    def emittance_sum(self) -> Numeric:
        """Emittance of both faces together, where neither is a curve [1]."""
        return self.emittance_top + self.emittance_bottom

    def emittances_at(self, temperature: Numeric) -> tuple[Numeric, Numeric]:
        """Emittance of the top and the bottom face at a temperature [1]."""
        return (
            emittance_at(self.emittance_top, temperature),
            emittance_at(self.emittance_bottom, temperature),
        )

    def infrared_transmittance_at(self, temperature: Numeric) -> Numeric:
        """Share of a black body's radiation that passes the film, by its temperature [1]."""
        return emittance_at(self.infrared_transmittance, temperature)

    def emission_growth(self, temperature: Numeric, excess: Numeric) -> Numeric:
        r"""Growth of both faces' emission with temperature, over that of one black face [1]."""
        # .. math:: \sum_\mathrm{faces}\left[\varepsilon(T_h)(1+\theta)^4-\varepsilon(T)\right],
        #     \qquad T_h=T(1+\theta)
        if self._is_grey:
            return self.emittance_sum * black_growth(excess)
        return sum(self.emission_growths(temperature, excess))

    def emission_growths(self, temperature: Numeric, excess: Numeric) -> tuple[Numeric, Numeric]:
        """Growth of each face's emission with temperature, as :meth:`emission_growth` [1]."""
        top, bottom = self.emittance_top, self.emittance_bottom
        return (
            emission_growth(top, temperature, excess),
            emission_growth(bottom, temperature, excess),
        )

    def emission_bound(self, temperature: Numeric, power: Numeric) -> Numeric:
        r"""Bound of :math:`(1+\theta)^4-1` in radiative equilibrium [1]."""
        faces = (self.emittance_top, self.emittance_bottom)
        if self._is_grey:
            return power / self.emittance_sum
        cold = sum(self.emittances_at(temperature))
        bounds = [emittance_bounds(face) for face in faces]
        lowest, highest = (sum(pair) for pair in zip(*bounds, strict=True))
        return (power + cold) / xp.where(power > 0.0, lowest, highest) - 1.0

    @property
    def _is_grey(self) -> bool:
        """Whether neither emittance depends on temperature."""
        faces = (self.emittance_top, self.emittance_bottom)
        return not any(isinstance(face, EmittanceCurve) for face in faces)

    @property
    def absorptance_below(self) -> Numeric:
        """Absorptance of the bottom face, or the top's where none is given [1]."""
        return self.absorptance if self.absorptance_bottom is None else self.absorptance_bottom

    @property
    def transmittance_below(self) -> Numeric:
        """Transmittance for light on the bottom face, or the top's where none is given [1]."""
        below = self.transmittance_bottom
        return self.transmittance if below is None else below


PROPERTIES = tuple(
    field.name for field in dataclasses.fields(FilmProperties) if field.name != "laminate"
)
"""Names of all properties of a film that are numbers."""


def area_weighted_mean(
    films: Sequence[FilmProperties], shares: Sequence[Numeric]
) -> FilmProperties:
    """Properties of a patterned film, of whose area each of several films has a share.

    Parameters
    ----------
    films : sequence of FilmProperties
        Such as a film with an absorber, and the same without it.
    shares : sequence of array, shape (...)
        Of the area, one for each film [1].

    Returns
    -------
    FilmProperties
        Means over the area; the highest temperature is that of the film that withstands least.

    Raises
    ------
    ParameterError
        If there is not one share a film, or the shares do not add up to one.

    Notes
    -----
    For patches wide against the wavelength, and so near each other that they are equally warm.

    Examples
    --------
    >>> clear = FilmProperties(3e-4, 0.02, 0.1, 0.1, 0.8, 0.8, transmittance=0.9)
    >>> dark = FilmProperties(4e-4, 0.60, 0.2, 0.2, 0.8, 0.8, transmittance=0.3)
    >>> print(f"{area_weighted_mean([dark, clear], [0.25, 0.75]).absorptance:.3f}")
    0.165
    """
    total = sum(shares)
    if len(films) != len(shares):
        raise ParameterError(f"{len(films)} films need as many shares, not {len(shares)}")
    if is_concrete(total) and np.any(np.abs(np.asarray(total) - 1.0) > _WHOLE - 1.0):
        raise ParameterError(f"the shares add up to {np.max(total):g}, not to 1")

    def mean(values: Sequence[Any]) -> Any:
        if any(isinstance(value, EmittanceCurve) for value in values):
            rows = map(coefficients_of, values)
            parts = (share * row.T for share, row in zip(shares, rows, strict=True))
            return EmittanceCurve(sum(parts).T)  # curves that differ along leading axes too
        return sum(share * value for share, value in zip(shares, values, strict=True))

    apart = ("absorptance_bottom", "transmittance_bottom", "highest_temperature")
    averaged = [name for name in PROPERTIES if name not in apart]
    return FilmProperties(
        absorptance_bottom=mean([film.absorptance_below for film in films]),
        transmittance_bottom=mean([film.transmittance_below for film in films]),
        highest_temperature=lowest_limit(films),
        **{name: mean([getattr(film, name) for film in films]) for name in averaged},
    )


def excess_of_growth(growth: Numeric) -> Array:
    r"""Temperature excess at which a black face's emission has grown by a share [1]."""
    root = xp.sqrt(xp.sqrt(xp.maximum(1.0 + growth, 0.0)))
    return growth / ((root + 1.0) * (root**2 + 1.0))


def lowest_limit(films: Sequence[FilmProperties]) -> Numeric | None:
    """Temperature that all of some films withstand [K]; None where none states one."""
    limits = [film.highest_temperature for film in films if film.highest_temperature is not None]
    if not limits:
        return None
    minimum: Any = np.minimum if is_concrete(*limits) else xp.minimum
    return functools.reduce(minimum, limits)


class WholeFilm(Module):
    """All properties of a film, in which a section replaces nothing."""

    properties: FilmProperties


class FilmSection(Alternative, abc.ABC):
    """``[film]``: a film whose properties are measured, or computed from its layers."""

    kind: ClassVar[str]
    """``"measured"`` or ``"layered"``."""

    layered: ClassVar[bool] = False
    """Whether properties are computed from layers, which takes more than arithmetic."""

    not_varied: ClassVar[Mapping[str, str]] = {
        "tac_correlation": "is about uncertainties and changes no design",
        "highest_temperature": "is a limit and not a property",
    }

    absorptance_bottom: Fraction | None = None
    emittance: Emittance | None = None
    emittance_top: Emittance | None = None
    emittance_bottom: Emittance | None = None
    tac_correlation: Correlation = Measured(0.0)
    transmittance: Fraction | None = None
    transmittance_bottom: Fraction | None = None
    infrared_transmittance: Fraction | None = None
    highest_temperature: Temperature | None = None

    def idle(self) -> dict[str, str]:
        """A correlation without two errors has no effect."""
        faces = [getattr(self, name, None) or self.implied.get(name) for name in FACES]
        exact = [name for name, face in zip(FACES, faces, strict=True) if not (face and face[1])]
        shared = exact and self.tac_correlation.value
        return {"tac_correlation": f"without a ± of {' and '.join(exact)}"} if shared else {}

    @pydantic.model_validator(mode="after")
    def _one_emittance_a_face(self) -> "FilmSection":
        if self.emittance is not None and (self.emittance_top or self.emittance_bottom):
            raise ConfigurationError(
                "give either emittance, or emittance_top and emittance_bottom, not both"
            )
        return self

    @classmethod
    def tag(cls) -> str:
        return cls.kind

    @classmethod
    def tag_of(cls, content: Any) -> str:
        """``"layered"`` for a film with layers, else ``"measured"``."""
        layered = (
            "layers" in content if isinstance(content, Mapping) else hasattr(content, "layers")
        )
        return "layered" if layered else "measured"

    def with_values(self, values: Mapping[str, Any]) -> "FilmSection":
        """The same section with other numbers; one emittance stands for both faces."""
        cleared: dict[str, Measured | None] = {}
        if "emittance" in values:
            cleared = {"emittance_top": None, "emittance_bottom": None}
        elif self.emittance is not None and {"emittance_top", "emittance_bottom"} & values.keys():
            both = self.emittance
            cleared = {"emittance": None, "emittance_top": both, "emittance_bottom": both}
        section = self.model_copy(update=cleared) if cleared else self
        return super(FilmSection, section).with_values(values)  # type: ignore[return-value]

    def stated_values(self) -> dict[str, Measured]:
        """The values that the file gives, by the name of the film's property."""
        given = {
            name: getattr(self, name) for name in PROPERTIES if getattr(self, name) is not None
        }
        if self.emittance is not None:
            given |= {"emittance_top": self.emittance, "emittance_bottom": self.emittance}
        return given

    @property
    def implied(self) -> dict[str, Measured]:
        """Numbers that the file leaves to the film's materials, by the name of the key."""
        return {}

    @property
    def implied_materials(self) -> dict[str, str]:
        """Material of each number of :attr:`implied`, by the name of the key."""
        return {}

    @property
    def correlations(self) -> dict[tuple[str, str], float]:
        """Correlation of the errors of two numbers, by their names."""
        shared = self.tac_correlation.value
        both = all(getattr(self, name) or name in self.implied for name in FACES)
        return {(FACES[0], FACES[1]): shared} if both and shared else {}

    def bounds(
        self, incidence: float = 0.0, *, passing: bool = True
    ) -> dict[str, tuple[FilmProperties, FilmProperties]]:
        """The film at the bounds of what missing data leave open."""
        return {}

    def warnings(self, incidence: float = 0.0, *, passing: bool = True) -> tuple[str, ...]:
        """What a reader of the film's properties must know, one line each."""
        unseen = [] if passing else [name for name in _PASSING if getattr(self, name) is not None]
        return tuple(f"{name} has no effect: nothing lies behind the film" for name in unseen)

    def report(self, incidence: float = 0.0, *, passing: bool = True) -> dict[str, Any]:
        """Value and origin of each property of a film of layers, as a JSON object in SI units."""
        return {}

    @abc.abstractmethod
    def build(
        self, incidence: float = 0.0, *, passing: bool = True, coarse: bool = False
    ) -> FilmProperties:
        """The film's properties, without their uncertainties."""
        # ``coarse`` is for their changes

    def lacking(self) -> str | None:
        """What the section must give beside its layers, in words; None where nothing lacks."""
        return None

    def with_optics(self, properties: FilmProperties | WholeFilm) -> "FilmSection":
        """A copy that does not compute the optics of layers anew."""
        return self

    def changes_optics(self, name: str, *, passing: bool = True) -> bool:
        """Whether a number's change means computing the optics of layers anew."""
        return False


class MeasuredFilmSection(FilmSection):
    """``[film]``: properties, measured or assumed."""

    kind: ClassVar[str] = "measured"

    areal_density: ArealDensity
    absorptance: Fraction
    tac_top: AccommodationCoefficient
    tac_bottom: AccommodationCoefficient

    @pydantic.model_validator(mode="after")
    def _both_emittances(self) -> "MeasuredFilmSection":
        if self.emittance is None and None in (self.emittance_top, self.emittance_bottom):
            raise ConfigurationError("give emittance, or both emittance_top and emittance_bottom")
        stated = {name: value.value for name, value in self.stated_values().items()}
        if problem := contradiction_in(FilmProperties, stated.get):
            raise ConfigurationError(problem)
        return self

    def build(
        self, incidence: float = 0.0, *, passing: bool = True, coarse: bool = False
    ) -> FilmProperties:
        """The film's properties, without their uncertainties; the same at any incidence."""
        stated: dict[str, Any] = self.stated_values()
        return FilmProperties(**{name: value.value for name, value in stated.items()})
