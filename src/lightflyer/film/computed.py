"""A film's properties from its layers, with measured values where there are any."""

import dataclasses
from typing import Any

import numpy as np

from lightflyer.film.averages import (
    Average,
    absorptance,
    emittance_curve,
    thermal_coverage,
    thermal_range,
)
from lightflyer.film.curve import EmittanceCurve, node_temperatures
from lightflyer.film.properties import FilmProperties
from lightflyer.film.spectra import Spectrum
from lightflyer.film.stack import GRAZING, Film, Side
from lightflyer.foundation.errors import ParameterError
from lightflyer.foundation.types import Numeric
from lightflyer.foundation.units import Measured

REPORT_TEMPERATURES = (200.0, 250.0, 300.0, 350.0, 400.0, 450.0, 500.0)
"""Temperatures at which an emittance is reported [K]: those of light-flyers."""

_FACES: tuple[Side, Side] = ("top", "bottom")
_LEAST_EMITTANCE = 1e-9


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
        The averages behind the computed absorptances, by name.
    """

    film: Film
    properties: FilmProperties
    measured: dict[str, Measured]
    averages: dict[str, Average]

    @classmethod
    def of(
        cls,
        film: Film,
        measured: dict[str, Measured],
        *,
        spectrum: Spectrum | None = None,
        incidence: float = 0.0,
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
        values: dict[str, Numeric] = {name: value.value for name, value in measured.items()}
        values |= {name: average.value for name, average in averages.items()}
        if "areal_density" not in values:
            values["areal_density"] = film.areal_density
        for side in _FACES:
            name = f"emittance_{side}"
            if name not in values:
                values[name] = _radiating(emittance_curve(film, side), side)
        return cls(film, FilmProperties(**values), measured, averages)

    def report(self) -> dict[str, Any]:
        """Value and origin of each property, as a JSON object in SI units."""
        entries: dict[str, Any] = {
            name: {"value": float(getattr(self.properties, name)), **self._origin(name)}
            for name in ("areal_density", "absorptance", "absorptance_bottom")
            if getattr(self.properties, name) is not None
        }
        for side in _FACES:
            name = f"emittance_{side}"
            entries[name] = {"value": self._emittance(side), **self._origin(name)}
        for name in ("tac_top", "tac_bottom"):
            value = float(getattr(self.properties, name))
            entries[name] = {"value": value, **self._origin(name)}
        return {**entries, "extrapolated": self._extrapolated()}

    def _extrapolated(self) -> list[str]:
        found = [text for mean in self.averages.values() for text in mean.extrapolated]
        if any(f"emittance_{side}" not in self.measured for side in _FACES):
            found += self.film.extrapolated(*thermal_range(self.film))
        return list(dict.fromkeys(found))

    def _emittance(self, side: Side) -> Any:
        value = getattr(self.properties, f"emittance_{side}")
        if not isinstance(value, EmittanceCurve):
            return float(value)
        values = value(np.array(REPORT_TEMPERATURES))
        return dict(zip(map("{:g}".format, REPORT_TEMPERATURES), map(float, values), strict=True))

    def _origin(self, name: str) -> dict[str, Any]:
        if name in self.measured:
            return {"origin": "measured", "uncertainty": self.measured[name].uncertainty}
        if name in self.averages:
            return {"origin": "computed", "covered": float(self.averages[name].covered)}
        if not name.startswith("emittance"):
            return {"origin": "computed"}
        covered = {f"{t:g}": float(thermal_coverage(self.film, t)) for t in REPORT_TEMPERATURES}
        return {"origin": "computed", "covered": covered}


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


def _radiating(curve: EmittanceCurve, side: Side) -> EmittanceCurve:
    """The curve, if it is positive everywhere."""
    least = float(np.min(curve(node_temperatures())))
    if least < _LEAST_EMITTANCE:
        raise ParameterError(
            f"emittance of the {side} face is {least:.1g}: by their data its layers absorb no "
            f"infrared; give a measured emittance_{side}"
        )
    return curve
