"""A film's properties from its layers, with measured values where there are any."""

import dataclasses
from collections.abc import Mapping
from functools import reduce
from typing import Any

import numpy as np

from lightflyer.array.namespace import Numeric, xp
from lightflyer.array.records import ShortRepr
from lightflyer.core.checks import is_traced
from lightflyer.core.errors import ParameterError
from lightflyer.core.units import Measured
from lightflyer.film.optics.averages import (
    POINTS_PER_E_FOLD,
    Average,
    Shares,
    heat_shares,
    light_shares,
    thermal_coverage,
)
from lightflyer.film.optics.curve import NODES, EmittanceCurve, node_temperatures
from lightflyer.film.optics.diagnostics import (
    medium_warnings,
    property_warnings,
    roughness_warnings,
    thick_warnings,
)
from lightflyer.film.optics.spectra import Spectrum
from lightflyer.film.optics.stack import GRAZING, Film, Side
from lightflyer.film.optics.thickness_surrogate import ThicknessSurrogate
from lightflyer.film.properties import PROPERTIES, FilmProperties

REPORT_TEMPERATURES = (200.0, 250.0, 300.0, 350.0, 400.0, 450.0, 500.0)
"""Temperatures at which an emittance is reported [K]: those of light-flyers."""

_FACES: tuple[Side, Side] = ("top", "bottom")
_LEAST_EMITTANCE = 1e-9
_ABSORBED_LIGHT = ("absorptance", "absorptance_bottom")
_IN_LIGHT, _IN_INFRARED = ("transmittance", "transmittance_bottom"), "infrared_transmittance"
_COMPLETE = 1.0 - 1e-6  # share of a spectrum beyond which what is missing has no effect

_PASSING = {
    "absorptance": "transmittance",
    "absorptance_bottom": "transmittance_bottom",
    "emittance_top": "infrared_transmittance",
    "emittance_bottom": "infrared_transmittance",
}
"""What passes, by the name of what the same radiation leaves in the film."""


@dataclasses.dataclass(frozen=True, eq=False)
class ComputedFilm(ShortRepr):
    """A film's properties and where each comes from."""

    film: Film
    properties: FilmProperties
    #: Properties that were measured, by name; all others are computed
    measured: dict[str, Measured]
    #: Averages behind the computed absorptances and transmittances, and for heat radiation at the
    #: temperatures of :func:`~lightflyer.film.optics.curve.node_temperatures`, by name
    averages: dict[str, Average]

    @property
    def bounds(self) -> dict[str, tuple[FilmProperties, FilmProperties]]:
        """The film at the bounds of what missing data leave open, by what is open."""
        # ``"absorptance_without_data"`` and ``"emittance_without_data"``: the film at the lower
        # bound, where it absorbs nothing at wavelengths without data, and at the upper one, where
        # it absorbs everything. Both faces are at the same bound. ``"transmittance_without_data"``
        # and ``"infrared_transmittance_without_data"``: nothing passes there, or everything that
        # may.
        found = {}
        for what in ("absorptance", "transmittance", "emittance", "infrared_transmittance"):
            means = {name: mean for name, mean in self.averages.items() if name.startswith(what)}
            if not any(np.any(mean.covered < _COMPLETE) for mean in means.values()):
                continue
            lower, upper = {}, {}
            for name, mean in means.items():
                lower[name] = _property(mean.lower)
                through = self.averages.get(_PASSING.get(name, ""))
                if through is not None:  # of what is not absorbed as much passes as by the data
                    upper[name] = _property(mean.upper)
                    least, missing = through.lower, 1.0 - mean.covered
                    share = _ratio(through.value, 1.0 - mean.value)
                    lower[_PASSING[name]] = _property(least + missing * share)
                    upper[_PASSING[name]] = _property(least)
                    continue
                # what passes leaves room to absorb, and the other way round
                others = [_PASSING[name]] if name in _PASSING else [
                    absorbing for absorbing, passing in _PASSING.items() if passing == name
                ]  # fmt: skip
                taken = (_numbers(_value_of(self.properties, other)) for other in others)
                room = 1.0 - np.maximum.reduce(np.broadcast_arrays(*taken))
                upper[name] = _property(np.minimum(mean.upper, room))
            found[f"{what}_without_data"] = (
                dataclasses.replace(self.properties, **lower),
                dataclasses.replace(self.properties, **upper),
            )
        return found

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a reader of the properties must know: where data are missing or extrapolated."""
        missing = [
            text
            for name, mean in self.averages.items()
            for text in property_warnings(name, mean, self.film)
        ]
        extrapolated = (f"extrapolated {text}" for text in self._extrapolations())
        film = self.film
        of_layers = (*medium_warnings(film), *thick_warnings(film), *roughness_warnings(film))
        return (*missing, *extrapolated, *of_layers)

    @classmethod
    def of(
        cls,
        film: Film,
        measured: dict[str, Measured],
        *,
        spectrum: Spectrum | None = None,
        incidence: float = 0.0,
        highest_temperature: float | None = None,
        passing: bool = True,
        points_per_e_fold: int = POINTS_PER_E_FOLD,
    ) -> "ComputedFilm":
        """Compute what has not been measured."""
        require_free(film)
        given: dict[str, Any] = dict(measured)
        if not passing:
            given |= dict.fromkeys((*_IN_LIGHT, _IN_INFRARED))
        computed = _light_averages(film, spectrum, incidence, given)
        computed |= _heat_averages(film, given, points_per_e_fold)
        averages = {name: mean for name, mean in computed.items() if name not in given}
        values: dict[str, Numeric] = {name: value.value for name, value in measured.items()}
        values |= {name: _property(average.value) for name, average in averages.items()}
        if "areal_density" not in values:
            values["areal_density"] = film.areal_density
        properties = FilmProperties(**values, highest_temperature=highest_temperature)
        return cls(film, properties, measured, averages)

    def report(self) -> dict[str, Any]:
        """Value and origin of each property, as a JSON object in SI units."""
        entries: dict[str, Any] = {
            name: {"value": float(getattr(self.properties, name)), **self._origin(name)}
            for name in ("areal_density", "absorptance", "absorptance_bottom", *_IN_LIGHT)
            if getattr(self.properties, name) is not None and self._is_reported(name)
        }
        for name in filter(self._is_reported, ("emittance_top", "emittance_bottom", _IN_INFRARED)):
            value = getattr(self.properties, name)
            entries[name] = {"value": _over_temperatures(value), **self._origin(name)}
        for name in ("tac_top", "tac_bottom"):
            value = float(getattr(self.properties, name))
            entries[name] = {"value": value, **self._origin(name)}
        return {**entries, "extrapolated": self._extrapolations()}

    def _is_reported(self, name: str) -> bool:
        """Whether a property is of concern: a transmittance only if it is computed or measured."""
        return "transmittance" not in name or name in self.averages or name in self.measured

    def _extrapolations(self) -> list[str]:
        found = [text for mean in self.averages.values() for text in mean.extrapolated]
        return list(dict.fromkeys(found))

    def _origin(self, name: str) -> dict[str, Any]:
        if name in self.measured:
            return {"origin": "measured", "uncertainty": self.measured[name].uncertainty}
        if name not in self.averages:
            return {"origin": "computed"}
        mean = self.averages[name]
        bounds = {"lower": _property(mean.lower), "upper": _property(mean.upper)}
        if np.ndim(mean.covered) == 0:
            covered: Any = float(mean.covered)
        else:
            covered = {f"{t:g}": float(thermal_coverage(self.film, t)) for t in REPORT_TEMPERATURES}
        shown = {end: _over_temperatures(value) for end, value in bounds.items()}
        return {"origin": "computed", "covered": covered, **shown}


def surrogate_properties(
    film: Film,
    surrogate: ThicknessSurrogate,
    beside: Mapping[str, Any],
    incidence: Numeric = 0.0,
    *,
    passing: bool = True,
) -> FilmProperties:
    """Properties of a film by a surrogate of its media; ``beside``: those that are no optics."""
    optics = surrogate.properties(film.homogeneous().thickness, incidence, passing=passing)
    mass = {} if "areal_density" in beside else {"areal_density": film.areal_density}
    return FilmProperties(**beside, **mass, **optics)


def require_free(film: Film) -> None:
    """Raise where a film cannot be that of a flyer: on a substrate, or with holes of its own."""
    if not film.free_standing:
        raise ParameterError(
            "substrate: a flyer's film stands free; samples on substrates are for the command film "
            "and for Film.optics"
        )
    if film.open_fraction is not None:
        raise ParameterError(
            "open_fraction: a flyer's holes belong to the flyer, as gas flows through them; a "
            "perforated film is for the command film and for Film.optics"
        )


def _property(mean: Numeric) -> Any:
    """Property of a film from a mean, a curve where it is one at each of the curve's nodes."""
    if np.ndim(mean) == 0:
        return mean
    return EmittanceCurve.through(xp.maximum(mean, _LEAST_EMITTANCE))


def _over_temperatures(value: Any) -> Any:
    """A number, or a curve's values by the temperature in kelvin."""
    if not isinstance(value, EmittanceCurve):
        return float(value)
    values = value(np.array(REPORT_TEMPERATURES))
    return dict(zip(map("{:g}".format, REPORT_TEMPERATURES), map(float, values), strict=True))


def with_measurements(optics: FilmProperties, given: dict[str, Any]) -> dict[str, Any]:
    """Properties of a film of which some are measured, and others were computed."""
    # Where an absorptance or emittance is another than the one beside which a transmittance was
    # computed, what passes keeps its share of what is not absorbed.
    found = {name: getattr(optics, name) for name in PROPERTIES}
    for name in ("absorptance", "transmittance"):
        if name in given:
            found[f"{name}_bottom"] = None  # the top's then stands for both
    found |= given
    for absorbing, passing in zip(_ABSORBED_LIGHT, _IN_LIGHT, strict=True):
        absorbed = {"absorptance", absorbing} & given.keys()
        if absorbed and not {"transmittance", passing} & given.keys():
            now = found["absorptance"] if found[absorbing] is None else found[absorbing]
            share = _ratio(1.0 - now, 1.0 - _value_of(optics, absorbing))
            found[passing] = _value_of(optics, passing) * share
    factors = [
        _ratio(1.0 - _numbers(given[name], axis=True), 1.0 - _numbers(getattr(optics, name), True))
        for name in ("emittance_top", "emittance_bottom")
        if given.get(name) is not None
    ]
    if factors and _IN_INFRARED not in given:
        through, factor = optics.infrared_transmittance, reduce(xp.minimum, factors)
        if isinstance(through, EmittanceCurve) and factor.shape[-1] == 1:
            found[_IN_INFRARED] = EmittanceCurve(through.coefficients * factor)
        else:
            nodes = _numbers(through, axis=True) * factor
            found[_IN_INFRARED] = EmittanceCurve.through(nodes + np.zeros(NODES))
    return found


def _ratio(over: Any, under: Any) -> Any:
    """Quotient of two shares, zero where both are."""
    return over / xp.where(under > 0.0, under, 1.0)


def _numbers(value: Any, axis: bool = False) -> Any:
    """A number as it is or with an axis behind, or the numbers at the nodes of a curve."""
    if isinstance(value, EmittanceCurve):
        return value.at_nodes
    return xp.expand_dims(value, -1) if axis else value


def _value_of(film: FilmProperties, name: str) -> Any:
    """Property of a film; what is not given for the bottom face is that of the top."""
    value = getattr(film, name)
    return getattr(film, name.removesuffix("_bottom")) if value is None else value


def _light_averages(
    film: Film, spectrum: Spectrum | None, incidence: float, measured: dict[str, Measured]
) -> dict[str, Average]:
    """Shares of the beam on the top face, and of diffuse light on the bottom face."""
    # A measured absorptance or transmittance of the top applies to both faces, as in a film without
    # layers.
    wanted = [name for name in ("absorptance", "transmittance") if name not in measured]
    if not wanted:
        return {}
    try:
        top = light_shares(film, spectrum, min(incidence, GRAZING))
        bottom = light_shares(film, spectrum, side="bottom", diffuse=True)
    except ParameterError:  # no data at any wavelength of the light
        if "absorptance" in wanted:
            raise
        return dict.fromkeys(_IN_LIGHT, Average(value=0.0, covered=0.0))
    found: dict[str, Average] = {}
    if "absorptance" in wanted:
        found |= {"absorptance": top.absorptance, "absorptance_bottom": bottom.absorptance}
    if "transmittance" in wanted:
        given = measured.get("absorptance")
        found["transmittance"] = _transmitted((top, given))
        found["transmittance_bottom"] = _transmitted(
            (bottom, measured.get("absorptance_bottom", given))
        )
    return found


def _transmitted(*faces: tuple[Shares, Measured | None]) -> Average:
    """Transmittance beside each face's measured absorptance, or the computed one where None."""
    # what passes keeps its share of what is not absorbed, the lesser share of two faces
    mean = faces[0][0].transmittance
    factors = [
        _ratio(1.0 - absorbed.value, 1.0 - shares.absorptance.value)
        for shares, absorbed in faces
        if absorbed is not None
    ]
    if not factors:
        return mean
    factor = reduce(xp.minimum, factors)
    within = None if mean.within is None else mean.within * factor
    return dataclasses.replace(mean, value=mean.value * factor, within=within)


def _heat_averages(
    film: Film, measured: dict[str, Measured], points_per_e_fold: int
) -> dict[str, Average]:
    """Emittance of both faces, and infrared transmittance, at the nodes of a curve."""
    given = [measured.get(f"emittance_{side}") for side in _FACES]
    if None not in given and _IN_INFRARED in measured:
        return {}
    try:
        shares = [
            heat_shares(film, node_temperatures(), side=side, points_per_e_fold=points_per_e_fold)
            for side in _FACES
        ]
    except ParameterError:  # no data at any wavelength of the radiation
        if None in given:
            raise
        return {_IN_INFRARED: Average(np.zeros(NODES), covered=np.zeros(NODES))}
    found: dict[str, Average] = {}
    for side, share, value in zip(_FACES, shares, given, strict=True):
        if value is not None:
            continue
        mean = found[f"emittance_{side}"] = share.absorptance
        if not is_traced(mean.value) and np.min(mean.value) < _LEAST_EMITTANCE:
            raise ParameterError(
                f"emittance of the {side} face is {np.min(mean.value):.1g}: by their data its "
                f"layers absorb no infrared; give a measured emittance_{side}"
            )
    return found | {_IN_INFRARED: _transmitted(*zip(shares, given, strict=True))}
