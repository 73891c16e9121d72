"""A film's properties from its layers, with measured values where there are any."""

import dataclasses
from typing import Any

import jax.numpy as jnp
import numpy as np

from lightflyer.film.averages import (
    Average,
    absorptance,
    emittance,
    thermal_coverage,
)
from lightflyer.film.curve import EmittanceCurve, node_temperatures
from lightflyer.film.findings import gap_warnings, property_warnings
from lightflyer.film.properties import FilmProperties
from lightflyer.film.spectra import Spectrum
from lightflyer.film.stack import GRAZING, Film, Side
from lightflyer.foundation.errors import ParameterError
from lightflyer.foundation.precision import is_traced
from lightflyer.foundation.types import Numeric
from lightflyer.foundation.units import Measured

REPORT_TEMPERATURES = (200.0, 250.0, 300.0, 350.0, 400.0, 450.0, 500.0)
"""Temperatures at which an emittance is reported [K]: those of light-flyers."""

_FACES: tuple[Side, Side] = ("top", "bottom")
_LEAST_EMITTANCE = 1e-9
_COMPLETE = 1.0 - 1e-6  # share of a spectrum beyond which what is missing has no effect


@dataclasses.dataclass(frozen=True, eq=False)
class ComputedFilm:
    """A film's properties and where each comes from.

    Attributes
    ----------
    film : Film
    properties : FilmProperties
        Transmittances are not computed: zero unless measured.
    measured : dict of str to Measured
        The properties that were measured, by name; all others are computed.
    averages : dict of str to Average
        The averages behind the computed absorptances, and emittances at the temperatures of
        :func:`~lightflyer.film.curve.node_temperatures`, by name.
    """

    film: Film
    properties: FilmProperties
    measured: dict[str, Measured]
    averages: dict[str, Average]

    @property
    def bounds(self) -> dict[str, tuple[FilmProperties, FilmProperties]]:
        """The film at the bounds of what missing data leave open, by what is open.

        ``"absorptance_without_data"`` and ``"emittance_without_data"``: the film at the lower
        bound, where it absorbs nothing at wavelengths without data, and at the upper one, where it
        absorbs everything. Both faces are at the same bound.
        """
        found = {}
        for what in ("absorptance", "emittance"):
            mine = {name: mean for name, mean in self.averages.items() if name.startswith(what)}
            if any(np.any(mean.covered < _COMPLETE) for mean in mine.values()):
                lower = {name: _property(mean.lower) for name, mean in mine.items()}
                upper = {name: _property(mean.upper) for name, mean in mine.items()}
                found[f"{what}_without_data"] = (self._with(lower), self._with(upper))
        return found

    def _with(self, values: dict[str, Any]) -> FilmProperties:
        names = FilmProperties.__dataclass_fields__
        return FilmProperties(**{name: getattr(self.properties, name) for name in names} | values)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a reader of the properties must know: where data are missing or extrapolated."""
        missing = [
            text
            for name, mean in self.averages.items()
            for text in property_warnings(name, mean, self.film)
        ]
        extrapolated = (f"extrapolated {text}" for text in self._extrapolated())
        return (*missing, *extrapolated, *gap_warnings(self.film))

    @classmethod
    def of(
        cls,
        film: Film,
        measured: dict[str, Measured],
        *,
        spectrum: Spectrum | None = None,
        incidence: float = 0.0,
        highest_temperature: float | None = None,
    ) -> "ComputedFilm":
        """Compute what has not been measured.

        Parameters
        ----------
        film : Film
        measured : dict of str to Measured
            Must hold ``tac_top`` and ``tac_bottom``, which are never computed.
        spectrum : Spectrum, optional
            Spectrum of the light; by default sunlight above the atmosphere.
        incidence : float
            Angle between the light and the film's normal [rad].
        highest_temperature : float, optional
            Temperature that the film bears [K].

        Returns
        -------
        ComputedFilm

        Raises
        ------
        ParameterError
            If a density is unknown, or a face emits no thermal radiation.
        """
        averages = {
            name: average
            for name, average in _absorptances(film, spectrum, incidence, measured).items()
            if name not in measured
        }
        for side in _FACES:
            if f"emittance_{side}" not in measured:
                averages[f"emittance_{side}"] = _radiating(film, side)
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
            for name in ("areal_density", "absorptance", "absorptance_bottom")
            if getattr(self.properties, name) is not None
        }
        for side in _FACES:
            name = f"emittance_{side}"
            value = getattr(self.properties, name)
            entries[name] = {"value": _over_temperatures(value), **self._origin(name)}
        for name in ("tac_top", "tac_bottom"):
            value = float(getattr(self.properties, name))
            entries[name] = {"value": value, **self._origin(name)}
        return {**entries, "extrapolated": self._extrapolated()}

    def _extrapolated(self) -> list[str]:
        found = [text for mean in self.averages.values() for text in mean.extrapolated]
        return list(dict.fromkeys(found))

    def _origin(self, name: str) -> dict[str, Any]:
        if name in self.measured:
            return {"origin": "measured", "uncertainty": self.measured[name].uncertainty}
        if name not in self.averages:
            return {"origin": "computed"}
        mean = self.averages[name]
        bounds = {"lower": _property(mean.lower), "upper": _property(mean.upper)}
        if not name.startswith("emittance"):
            covered: Any = float(mean.covered)
        else:
            covered = {f"{t:g}": float(thermal_coverage(self.film, t)) for t in REPORT_TEMPERATURES}
        shown = {end: _over_temperatures(value) for end, value in bounds.items()}
        return {"origin": "computed", "covered": covered, **shown}


def _property(mean: Numeric) -> Any:
    """Property of a film from a mean, a curve where it is one at each of the curve's nodes."""
    if np.ndim(mean) == 0:
        return mean
    floor = jnp.maximum if is_traced(mean) else np.maximum  # JAX's is in single precision here
    return EmittanceCurve.through(floor(mean, _LEAST_EMITTANCE))


def _over_temperatures(value: Any) -> Any:
    """A number, or a curve's values by the temperature in kelvin."""
    if not isinstance(value, EmittanceCurve):
        return float(value)
    values = value(np.array(REPORT_TEMPERATURES))
    return dict(zip(map("{:g}".format, REPORT_TEMPERATURES), map(float, values), strict=True))


def _absorptances(
    film: Film, spectrum: Spectrum | None, incidence: float, measured: dict[str, Measured]
) -> dict[str, Average]:
    """Absorptance of the top face for the beam, and of the bottom face for diffuse light.

    A measured absorptance of the top applies to both faces, as in a film without layers.
    """
    if "absorptance" in measured:
        return {}
    return {
        "absorptance": absorptance(film, spectrum, min(incidence, GRAZING)),
        "absorptance_bottom": absorptance(film, spectrum, side="bottom", diffuse=True),
    }


def _radiating(film: Film, side: Side) -> Average:
    """Emittance of a face at the nodes of a curve, if it is positive everywhere."""
    mean = emittance(film, node_temperatures(), side=side)
    if not is_traced(mean.value) and np.min(mean.value) < _LEAST_EMITTANCE:
        raise ParameterError(
            f"emittance of the {side} face is {np.min(mean.value):.1g}: by their data its layers "
            f"absorb no infrared; give a measured emittance_{side}"
        )
    return mean
