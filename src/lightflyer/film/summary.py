"""Optics and mass of a film in one object, as the command ``film`` reports them."""

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from lightflyer.film.averages import Average, absorptance, emittance
from lightflyer.film.materials import MICROMETRE
from lightflyer.film.spectra import Spectrum, am0
from lightflyer.film.stack import Film, Side
from lightflyer.film.transfer_matrix import StackOptics
from lightflyer.foundation.errors import ParameterError

SPECTRUM_RANGE = (0.25e-6, 25e-6)
"""Ends of a film's reported spectrum [m]."""
SPECTRUM_POINTS = 1000

_GRAMS = 1e3


@dataclasses.dataclass(frozen=True, eq=False)
class FilmSummary:
    """Areal density, absorptances, emittances and spectrum of a film.

    Attributes
    ----------
    film : Film
    light : Spectrum
        Light on the film: sunlight or a lamp.
    solar : dict of str to Average
        Absorptance of sunlight at normal incidence, of each face, ``"top"`` and ``"bottom"``.
    lamp : dict of str to Average
        The same for ``light``.
    thermal : dict of str to Average
        Hemispherical emittance of each face, arrays over ``temperatures``.
    thermal_normal : dict of str to Average
        The same along the normal.
    temperatures : array, shape (m,)
        [K].
    wavelength : array, shape (w,)
        [m]; from 0.25 µm to 25 µm, as far as the materials have data or extrapolate.
    optics : StackOptics
        Unpolarised, normal incidence from the top, arrays over ``wavelength``.
    """

    film: Film
    light: Spectrum
    solar: dict[str, Average]
    lamp: dict[str, Average]
    thermal: dict[str, Average]
    thermal_normal: dict[str, Average]
    temperatures: np.ndarray
    wavelength: np.ndarray
    optics: StackOptics

    @classmethod
    def of(cls, film: Film, light: Spectrum, temperatures: np.ndarray) -> "FilmSummary":
        """Summary of a film.

        Parameters
        ----------
        film : Film
        light : Spectrum
            Light on the film: sunlight or a lamp.
        temperatures : array, shape (m,)
            [K].

        Returns
        -------
        FilmSummary

        Raises
        ------
        ParameterError
            If the materials' data do not overlap, or lie outside the reported spectrum.
        """
        sides: tuple[Side, Side] = ("top", "bottom")
        shortest, longest = film.covered_range
        shortest, longest = max(shortest, SPECTRUM_RANGE[0]), min(longest, SPECTRUM_RANGE[1])
        if shortest >= longest:
            ends = " and ".join(f"{end / MICROMETRE:g} µm" for end in SPECTRUM_RANGE)
            raise ParameterError(f"the materials have no data between {ends}")
        wavelength = np.geomspace(shortest, longest, SPECTRUM_POINTS)
        solar: dict[str, Average] = {side: absorptance(film, side=side) for side in sides}
        lit: dict[str, Average] = {side: absorptance(film, light, side=side) for side in sides}
        return cls(
            film=film,
            light=light,
            solar=solar,
            lamp=solar if light is am0() else lit,
            thermal={side: emittance(film, temperatures, side=side) for side in sides},
            thermal_normal={
                side: emittance(film, temperatures, side=side, normal=True) for side in sides
            },
            temperatures=temperatures,
            wavelength=wavelength,
            optics=film.optics(wavelength).unpolarised(),
        )

    @property
    def extrapolated(self) -> list[str]:
        """Materials that were extrapolated anywhere in the summary."""
        averages = [*self.solar.values(), *self.lamp.values(), *self.thermal.values()]
        found = [text for average in averages for text in average.extrapolated]
        found += self.film.extrapolated(self.wavelength[0], self.wavelength[-1])
        return list(dict.fromkeys(found))

    def selectivity(self) -> np.ndarray:
        """Absorptance of the top for the light, over the mean emittance of both faces [1]."""
        mean = 0.5 * (self.thermal["top"].value + self.thermal["bottom"].value)
        return self.lamp["top"].value / mean

    def to_json(self) -> dict[str, Any]:
        """The summary as a JSON object, with a unit at the end of each name."""
        names = [f"{temperature:g}" for temperature in self.temperatures]

        def over_temperature(values: Any) -> dict[str, float]:
            return dict(zip(names, map(float, values), strict=True))

        entries: dict[str, Any] = {"areal_density_g_m2": float(self.film.areal_density) * _GRAMS}
        for side, solar in self.solar.items():
            entries[f"solar_absorptance_{side}"] = float(solar.value)
        if self.light is not am0():
            entries["lamp"] = self.light.name
            for side, lamp in self.lamp.items():
                entries[f"lamp_absorptance_{side}"] = float(lamp.value)
        for side, thermal in self.thermal.items():
            entries[f"emittance_{side}"] = over_temperature(thermal.value)
            entries[f"emittance_normal_{side}"] = over_temperature(self.thermal_normal[side].value)
        return entries | {
            "selectivity": over_temperature(self.selectivity()),
            "bounds": self._bounds(over_temperature),
            "spectrum": {
                "wavelength_um": (self.wavelength / MICROMETRE).tolist(),
                "reflectance": self.optics.reflectance.tolist(),
                "transmittance": self.optics.transmittance.tolist(),
                "absorptance": self.optics.absorptance.tolist(),
                "layer_absorptance": self.optics.layer_absorptance.tolist(),
            },
            "extrapolated": self.extrapolated,
        }

    def _bounds(self, over_temperature: Any) -> dict[str, Any]:
        """Share of each average's spectrum that has data, and bounds for the rest."""
        solar = {
            f"solar_absorptance_{side}": _covered(average, float)
            for side, average in self.solar.items()
        }
        thermal = {
            f"emittance_{side}": _covered(average, over_temperature)
            for side, average in self.thermal.items()
        }
        return {**solar, **thermal}


def _covered(average: Average, described: Callable[[Any], Any]) -> dict[str, Any]:
    return {
        "covered": described(average.covered),
        "lower": described(average.lower),
        "upper": described(average.upper),
    }
