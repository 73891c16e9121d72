"""Films of the same media in other thicknesses: their properties quickly, on a coarse grid.

A search computes thousands of films. The grids of :mod:`lightflyer.film.optics.averages` resolve
sharp bands to 1e-5, which takes a search too long. The grid here has a hundredth of their points,
placed where the media's indices and the spectra change, and comes within 3e-3 of them. A search
takes the rest out by computing its best film on the full grids.
"""

from typing import Any

import numpy as np

from lightflyer.array.namespace import Array, Numeric, xp
from lightflyer.array.records import Module
from lightflyer.core.errors import ParameterError
from lightflyer.film.optics.averages import (
    POINTS_PER_E_FOLD,
    Grid,
    hemisphere,
    light_grid,
    thermal_grid,
)
from lightflyer.film.optics.curve import EmittanceCurve, node_temperatures
from lightflyer.film.optics.spectra import Spectrum, am0
from lightflyer.film.optics.stack import GRAZING, Film
from lightflyer.film.optics.transfer_matrix import transfer

DIRECTIONS = 4  # Directions of a hemispherical average, Gauss-Legendre in the cosine

THERMAL_POINTS, LIGHT_POINTS = 512, 256
"""Wavelengths of an average over thermal radiation and over the light."""

_BY_INDEX, _BY_POWER, _EVENLY = 0.5, 0.4, 0.1  # shares of a grid's points
_LEAST_EMITTANCE = 1e-9


class Sampled(Module):
    """Index of each layer at some wavelengths, and the weights of means over them."""

    n: Numeric  # shape (layers, w); [1]
    k: Numeric  # shape (layers, w); [1]
    wavelength: Numeric  # shape (w,); [m]
    weight: Numeric  # shape (m, w); one row a mean; each row's sum is one [1]

    @classmethod
    def of(cls, film: Film, grid: Grid, points: int) -> "Sampled":
        """The points of a fine grid that matter most, with the weights of those between them."""
        n, k = film.index(grid.wavelength)
        chosen = np.arange(grid.wavelength.size)
        if chosen.size > points:
            # dense where the means have their weight and where indices change
            power = grid.mean_weight.mean(axis=0)
            power = 0.5 * (power[1:] + power[:-1])
            permittivity = (n + 1j * k) ** 2
            change = np.abs(np.diff(permittivity, axis=1)) / (1.0 + np.abs(permittivity[:, 1:]))
            by_index, by_power = np.sqrt(power * change).sum(axis=0), np.sqrt(power)
            density = _BY_POWER * _share(by_power) + _EVENLY * _share(np.ones(power.size))
            density += _BY_INDEX * _share(by_index)
            along = np.concatenate([[0.0], np.cumsum(density)])
            places = np.interp(np.linspace(0.0, along[-1], points), along, np.arange(along.size))
            chosen = np.unique(np.round(places).astype(int))
        left = np.searchsorted(chosen, np.arange(grid.wavelength.size), side="right") - 1
        left = np.minimum(left, chosen.size - 2)
        ends = grid.wavelength[chosen]
        share = (grid.wavelength - ends[left]) / (ends[left + 1] - ends[left])
        weight = np.stack([
            np.bincount(left, row * (1.0 - share), chosen.size)
            + np.bincount(left + 1, row * share, chosen.size)
            for row in grid.mean_weight
        ])  # fmt: skip
        return cls(n[:, chosen], k[:, chosen], ends, weight)


class ThicknessSurrogate(Module):
    """Films of the same media in the same order, whose thicknesses may be anything."""

    # Over the light, and over the radiation of black bodies at the nodes of an
    # :class:`~lightflyer.film.optics.curve.EmittanceCurve`
    light: Sampled
    heat: Sampled

    @classmethod
    def of(cls, film: Film, spectrum: Spectrum | None = None) -> "ThicknessSurrogate":
        whole = film.free_standing and film.open_fraction is None
        if film.is_rough or not whole or not all(layer.coherent for layer in film.layers):
            raise ParameterError(
                "a search over thicknesses knows only smooth, coherent layers without holes; "
                "sweep this film"
            )
        film = film.homogeneous()
        light = light_grid(film, am0() if spectrum is None else spectrum, 0.0, diffuse=False)
        heat = thermal_grid(
            film, node_temperatures(), normal=False, points_per_e_fold=POINTS_PER_E_FOLD
        )
        return cls(Sampled.of(film, light, LIGHT_POINTS), Sampled.of(film, heat, THERMAL_POINTS))

    def properties(
        self, thickness: Numeric, incidence: Numeric = 0.0, *, passing: bool = True
    ) -> dict[str, Any]:
        """Optical properties of a film by name, to be traced; ``thickness`` (layers,)."""
        light, heat = self.light, self.heat
        beam = xp.cos(xp.minimum(incidence, GRAZING))
        n, k, wavelength = (
            xp.concatenate(parts, axis=-1)
            for parts in (
                (light.n, heat.n), (light.k, heat.k), (light.wavelength, heat.wavelength)
            )
        )  # fmt: skip
        cosine, share = hemisphere(DIRECTIONS)
        # both faces at once: the second half of each array is the film upside down
        n, k, depth = (xp.stack([part, part[::-1]], axis=1) for part in (n, k, thickness[:, None]))
        absorbed, through = _shares(n, k, depth, wavelength, cosine, share)
        of_light, of_heat = slice(None, light.wavelength.size), slice(light.wavelength.size, None)
        lit, lit_through = _shares(
            light.n[:, None], light.k[:, None], thickness[:, None, None], light.wavelength,
            xp.atleast_1d(beam), np.ones(1),
        )  # fmt: skip
        top, bottom = (heat.weight @ face[of_heat] for face in absorbed)
        found = {
            "absorptance": (light.weight @ lit[0])[0],
            "absorptance_bottom": (light.weight @ absorbed[1, of_light])[0],
            "emittance_top": _curve(top),
            "emittance_bottom": _curve(bottom),
        }
        if passing:
            found |= {
                "transmittance": (light.weight @ lit_through[0])[0],
                "transmittance_bottom": (light.weight @ through[1, of_light])[0],
                "infrared_transmittance": _curve(heat.weight @ through[0, of_heat]),
            }
        return found


def _shares(
    n: Numeric, k: Numeric, thickness: Numeric, wavelength: Numeric, cosine: Numeric, share: Numeric
) -> tuple[Array, Array]:
    """Absorptance and transmittance of unpolarised light, as means over directions."""
    # Arrays have the axes (layers, faces, wavelengths); the shares are of shape (faces, w).
    n, k, thickness = (xp.asarray(part)[:, :, None] for part in (n, k, thickness))
    incidence = xp.arccos(cosine)[:, None]
    optics = transfer(n, k, thickness, xp.asarray(wavelength), incidence, inside=False)
    reflected, passed = (
        xp.einsum("pfaw,a->fw", part, 0.5 * share)
        for part in (optics.reflectance, optics.transmittance)
    )
    return 1.0 - reflected - passed, passed


def _curve(values: Array) -> EmittanceCurve:
    return EmittanceCurve.through(xp.maximum(values, _LEAST_EMITTANCE))


def _share(values: np.ndarray) -> np.ndarray:
    total = values.sum()
    return values / total if total > 0.0 else np.zeros_like(values)
