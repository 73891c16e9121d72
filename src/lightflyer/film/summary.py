"""Optics and mass of a film in one object, as the command ``film`` reports them."""

import dataclasses
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.array.namespace import Numeric
from lightflyer.array.records import ShortRepr
from lightflyer.core.constants import NORMAL_HALF_WIDTH_95
from lightflyer.core.errors import ParameterError
from lightflyer.film.media.medium import MICROMETRE
from lightflyer.film.optics.averages import (
    COARSE_POINTS_PER_E_FOLD,
    POINTS_PER_E_FOLD,
    Average,
    Shares,
    heat_shares,
    light_shares,
)
from lightflyer.film.optics.diagnostics import film_warnings
from lightflyer.film.optics.spectra import SPECTRUM_RANGE, Spectrum, am0
from lightflyer.film.optics.stack import Film
from lightflyer.film.optics.stack import thickness_uncertainty as propagate
from lightflyer.film.optics.transfer_matrix import StackOptics

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SPECTRUM_POINTS = 1000

_GRAMS = 1e3
_LEAST_EMITTANCE = 1e-9  # of which a ratio is more than rounding
_MASS = "areal_density_g_m2"


@dataclasses.dataclass(frozen=True, eq=False)
class FilmSummary(ShortRepr):
    """Areal density, absorptances, transmittances, emittances and spectrum of a film."""

    film: Film
    light: Spectrum  #: Light on the film: sunlight or a lamp
    #: Absorptance of sunlight at normal incidence, of each face, ``"top"`` and ``"bottom"``; the
    #: top alone where the film lies on an endless substrate
    solar: dict[str, Average]
    lamp: dict[str, Average]  #: The same for ``light``
    #: Hemispherical emittance of each face, arrays over ``temperatures``
    thermal: dict[str, Average]
    thermal_normal: dict[str, Average]  #: The same along the normal
    #: Transmittance, the same from both sides: ``"solar"`` and ``"lamp"`` at normal incidence,
    #: ``"thermal"`` hemispherical, an array over ``temperatures``
    passing: dict[str, Average]
    temperatures: np.ndarray  #: shape (m,); [K]
    #: shape (w,); [m]; from 0.25 µm to 25 µm, as far as the materials have data or extrapolate
    wavelength: np.ndarray
    optics: StackOptics  #: Unpolarised, normal incidence from the top, arrays over ``wavelength``
    #: Standard uncertainty from those of the layers' thicknesses and densities, by the names of
    #: :meth:`values`; None where no layer has one
    uncertainty: dict[str, Any] | None = None
    warnings: tuple[str, ...] = ()  #: What a reader must know of these numbers

    @classmethod
    def of(
        cls,
        film: Film,
        light: Spectrum,
        temperatures: np.ndarray,
        *,
        thickness_uncertainty: Sequence[float | None] = (),
        density_uncertainty: Sequence[float | None] = (),
        others: Sequence[tuple[Film, Film]] = (),
    ) -> "FilmSummary":
        """Summary of a film; ``temperatures`` (m,)."""
        spreads = tuple(thickness_uncertainty) or (None,) * len(film.layers)
        densities = tuple(density_uncertainty) or (None,) * len(film.layers)
        shortest, longest = film.covered_range
        shortest, longest = max(shortest, SPECTRUM_RANGE[0]), min(longest, SPECTRUM_RANGE[1])
        if shortest >= longest:
            ends = " and ".join(f"{end / MICROMETRE:g} µm" for end in SPECTRUM_RANGE)
            raise ParameterError(f"the materials have no data between {ends}")
        wavelength = np.geomspace(shortest, longest, SPECTRUM_POINTS)
        averages = _averages(film, light, temperatures, POINTS_PER_E_FOLD)
        uncertainty = None
        if any(spreads) or any(densities) or others:

            def coarse_values(one: Film) -> dict[str, Any]:
                found = _averages(one, light, temperatures, COARSE_POINTS_PER_E_FOLD)
                return _values(one, light, found)

            uncertainty = propagate(
                coarse_values, film, [spread or 0.0 for spread in spreads], others
            )
            if _MASS in uncertainty:  # to which those of the densities add
                parts = [
                    layer.thickness * (spread or 0.0) * _GRAMS
                    for layer, spread in zip(film.layers, densities, strict=True)
                ]
                uncertainty[_MASS] = float(np.hypot(uncertainty[_MASS], np.linalg.norm(parts)))
        return cls(
            film=film,
            light=light,
            **averages,
            temperatures=temperatures,
            wavelength=wavelength,
            optics=film.optics(wavelength).polarisation_mean(),
            uncertainty=uncertainty,
            warnings=film_warnings(
                film, light, temperatures, averages["solar"], averages["lamp"],
                averages["thermal"], spreads,
            ),
        )  # fmt: skip

    @property
    def extrapolated(self) -> list[str]:
        """Materials that were extrapolated anywhere in the summary."""
        averages = [*self.solar.values(), *self.lamp.values(), *self.thermal.values()]
        found = [text for average in averages for text in average.extrapolated]
        found += self.film.extrapolations(self.wavelength[0], self.wavelength[-1])
        return list(dict.fromkeys(found))

    def selectivity(self) -> np.ndarray:
        """Absorptance of the top for the light, over the mean emittance of the faces [1]."""
        return _selectivity(self.lamp, self.thermal)

    def values(self) -> dict[str, Any]:
        """Numbers and arrays over the temperatures, by name with the unit at its end."""
        averages = {"solar": self.solar, "lamp": self.lamp, "thermal": self.thermal,
                    "thermal_normal": self.thermal_normal, "passing": self.passing}  # fmt: skip
        return _values(self.film, self.light, averages)

    def interval(self, name: str) -> np.ndarray | None:
        """95 % interval of a number of :meth:`values`, cut at what is possible, shape (2,)."""
        if self.uncertainty is None:
            return None
        highest = 1.0 if "tance" in name else np.inf  # absorptance and emittance
        return possible_interval(self.values()[name], self.uncertainty[name], highest)

    def plot(self, ax: "Axes | None" = None) -> "Figure":
        """Draw the spectra, and what each layer absorbs."""
        from lightflyer.film.figures import plot_film

        return plot_film(self, ax)

    def to_json(self) -> dict[str, Any]:
        """The summary as a JSON object, with a unit at the end of each name."""
        entries: dict[str, Any] = {_MASS: None}  # where a density is unknown
        entries |= {name: self._json_value(value) for name, value in self.values().items()}
        if self.light is not am0():
            entries["lamp"] = self.light.name
        averages = {f"solar_absorptance_{side}": mean for side, mean in self.solar.items()}
        if self.light is not am0():
            averages |= {f"lamp_absorptance_{side}": mean for side, mean in self.lamp.items()}
        averages |= {f"emittance_{side}": mean for side, mean in self.thermal.items()}
        averages |= {f"emittance_normal_{side}": one for side, one in self.thermal_normal.items()}
        averages |= _transmittances_by_name(self.passing, self.light)
        # share of each average's spectrum that has data, and bounds for the rest
        keys = ("covered", "extrapolated_share", "lower", "upper")
        bounds = {
            name: {key: self._json_value(getattr(average, key)) for key in keys}
            for name, average in averages.items()
        }
        return entries | {
            "uncertainty": {
                name: self._json_value(value) for name, value in (self.uncertainty or {}).items()
            },
            "interval_95": {name: self._ends(name) for name in self.uncertainty or {}},
            "bounds": bounds,
            "spectrum": {
                "wavelength_um": (self.wavelength / MICROMETRE).tolist(),
                "reflectance": self.optics.reflectance.tolist(),
                "transmittance": self.optics.transmittance.tolist(),
                "absorptance": self.optics.absorptance.tolist(),
                "layer_absorptance": self.optics.layer_absorptance.tolist(),
            }
            | ({"scattered": self.optics.scattered.tolist()} if self.film.is_rough else {}),
            "extrapolated": self.extrapolated,
            "warnings": list(self.warnings),
        }

    def _json_value(self, value: Any) -> Any:
        """A number, or numbers by temperature; None where it is none."""
        if np.ndim(value) == 0:
            return float(value)
        names = [f"{temperature:g}" for temperature in self.temperatures]
        return dict(zip(names, map(_number, value), strict=True))

    def _ends(self, name: str) -> Any:
        low, high = self.interval(name)  # type: ignore[misc]
        if np.ndim(low) == 0:
            return [_number(low), _number(high)]
        ends = zip(self.temperatures, low, high, strict=True)
        return {f"{at:g}": [_number(one), _number(other)] for at, one, other in ends}


def _number(value: Any) -> float | None:
    """A number for JSON, which knows no NaN."""
    return None if np.isnan(value) else float(value)


def possible_interval(value: Numeric, uncertainty: Numeric, highest: float) -> np.ndarray:
    """95 % interval of a normal variable, cut at zero and at the highest possible value."""
    half = NORMAL_HALF_WIDTH_95 * np.asarray(uncertainty)
    return np.clip(np.stack([value - half, value + half]), 0.0, highest)


def _averages(
    film: Film, light: Spectrum, temperatures: np.ndarray, points_per_e_fold: int
) -> dict[str, dict[str, Average]]:
    """Averages by the names of the summary's fields."""

    def heat(normal: bool) -> dict[str, Shares]:
        return {
            side: heat_shares(
                film, temperatures, side=side, normal=normal, points_per_e_fold=points_per_e_fold
            )
            for side in film.lit_sides
        }

    def absorbed(shares: Mapping[str, Shares]) -> dict[str, Average]:
        return {side: share.absorptance for side, share in shares.items()}

    solar: dict[str, Shares] = {side: light_shares(film, side=side) for side in film.lit_sides}
    lamp, hemispherical = solar, heat(False)
    if light is not am0():
        lamp = {side: light_shares(film, light, side=side) for side in film.lit_sides}
    through = {"solar": solar, "lamp": lamp, "thermal": hemispherical}
    absorbed_solar = absorbed(solar)
    return {
        "solar": absorbed_solar,
        "lamp": absorbed_solar if lamp is solar else absorbed(lamp),
        "thermal": absorbed(hemispherical),
        "thermal_normal": absorbed(heat(True)),
        "passing": {name: shares["top"].transmittance for name, shares in through.items()},
    }


def _transmittances_by_name(passing: Mapping[str, Average], light: Spectrum) -> dict[str, Average]:
    """Transmittances by their names among the values."""
    found = {"solar_transmittance": passing["solar"]}
    if light is not am0():
        found["lamp_transmittance"] = passing["lamp"]
    return found | {"infrared_transmittance": passing["thermal"]}


def _values(film: Film, light: Spectrum, averages: dict[str, dict[str, Average]]) -> dict[str, Any]:
    entries: dict[str, Any] = {}
    if film.unknown_density is None:
        entries[_MASS] = film.areal_density * _GRAMS
    for side, solar in averages["solar"].items():
        entries[f"solar_absorptance_{side}"] = solar.value
    if light is not am0():
        for side, lamp in averages["lamp"].items():
            entries[f"lamp_absorptance_{side}"] = lamp.value
    for side, thermal in averages["thermal"].items():
        entries[f"emittance_{side}"] = thermal.value
        entries[f"emittance_normal_{side}"] = averages["thermal_normal"][side].value
    entries |= {
        name: mean.value
        for name, mean in _transmittances_by_name(averages["passing"], light).items()
    }
    return entries | {"selectivity": _selectivity(averages["lamp"], averages["thermal"])}


def _selectivity(lamp: dict[str, Average], thermal: dict[str, Average]) -> np.ndarray:
    emitted = np.asarray(sum(mean.value for mean in thermal.values()) / len(thermal))
    ratio = lamp["top"].value / np.where(emitted > _LEAST_EMITTANCE, emitted, 1.0)
    return np.where(emitted > _LEAST_EMITTANCE, ratio, np.nan)
