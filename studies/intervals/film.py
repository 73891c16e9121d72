"""Intervals of ``film``: what ± of the layers' thicknesses does to its averages.

A film has known thicknesses. Its averages are the truth: tmm at each wavelength, direction and
polarisation, and sums in NumPy. A flyer file states thicknesses that were measured with errors of
the stated ±, and the command's summary of that file is compared with the truth. Seeds alternate
between two films; run twice as many cases as each is to have.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
import tmm
from trial import Trial

from lightflyer.film import Film, FilmSummary, Layer, am0, cold_white_led, material, planck

COMMAND = "film"
TEMPERATURES = np.array([300.0, 441.0])
_WAVELENGTHS, _DIRECTIONS = 500, 8


class Case(NamedTuple):
    """Materials, true thicknesses and their ± [m]."""

    name: str
    materials: tuple[str, ...]
    thickness: tuple[float, ...]
    spread: tuple[float, ...]


CASES = (
    Case("Al2O3, Ge, PET, Ge, ± 3 to 8 %", ("Al2O3", "Ge", "PET", "Ge"),
         (50e-9, 20e-9, 500e-9, 20e-9), (2e-9, 1.5e-9, 15e-9, 1.5e-9)),
    Case("SiO2, Al, polyimide, ± 10 %", ("SiO2", "Al", "polyimide"),
         (100e-9, 15e-9, 300e-9), (10e-9, 1.5e-9, 30e-9)),
)  # fmt: skip


def trials(seed: int) -> list[Trial]:
    """Intervals of one film whose thicknesses were measured once."""
    case = CASES[seed % len(CASES)]
    rng = np.random.default_rng(seed)
    read = np.array(case.thickness) + case.spread * rng.normal(size=len(case.thickness))
    layers = [Layer(material(name), d) for name, d in zip(case.materials, read, strict=True)]
    summary = FilmSummary.of(Film(tuple(layers)), cold_white_led(), TEMPERATURES,
                             thickness_uncertainty=case.spread)  # fmt: skip
    found = []
    for name, value in truth(case).items():
        low, high = summary.interval(name)
        for at, ends in enumerate(zip(np.ravel(value), np.ravel(low), np.ravel(high), strict=True)):
            where = f" at {TEMPERATURES[at]:g} K" if np.ndim(value) else ""
            found.append(Trial(f"{name.replace('_', ' ')}{where}, {case.name}", *map(float, ends)))
    return found


@cache
def truth(case: Case) -> dict[str, np.ndarray]:
    """The averages of the true film, by the names of the summary."""
    materials = [material(name) for name in case.materials]
    shortest = max(one.wavelength_range[0] for one in materials)
    longest = min(one.wavelength_range[1] for one in materials)
    found = {"areal_density_g_m2": 1e3 * sum(
        one.density * d for one, d in zip(materials, case.thickness, strict=True))}  # fmt: skip
    for kind, light in (("solar", am0()), ("lamp", cold_white_led())):
        inside = (light.wavelength > shortest) & (light.wavelength < longest)
        wavelength = light.wavelength[inside]
        power = light.irradiance[inside]
        for side in ("top", "bottom"):
            absorbed = absorptance(case, side, wavelength, 1.0)
            found[f"{kind}_absorptance_{side}"] = _mean(absorbed, power, wavelength)
    wavelength = np.geomspace(shortest, longest, _WAVELENGTHS)
    nodes, shares = np.polynomial.legendre.leggauss(_DIRECTIONS)
    cosines = 0.5 * (nodes + 1.0)
    for side in ("top", "bottom"):
        normal = absorptance(case, side, wavelength, 1.0)
        whole = sum(share * one * absorptance(case, side, wavelength, one)
                    for one, share in zip(cosines, shares, strict=True))  # fmt: skip
        for name, spectral in (("emittance_normal", normal), ("emittance", whole)):
            found[f"{name}_{side}"] = np.array(
                [_mean(spectral, planck(wavelength, t), wavelength) for t in TEMPERATURES]
            )
    both = found["emittance_top"] + found["emittance_bottom"]
    return found | {"selectivity": found["lamp_absorptance_top"] / (0.5 * both)}


def absorptance(case: Case, side: str, wavelength: np.ndarray, cosine: float) -> np.ndarray:
    """Absorptance of unpolarised light by tmm."""
    step = 1 if side == "top" else -1
    layers = [np.array(material(name).index(wavelength)) for name in case.materials][::step]
    d = [np.inf, *case.thickness[::step], np.inf]
    found = []
    for number, at in enumerate(wavelength):
        index = [1.0, *(complex(*one[:, number]) for one in layers), 1.0]
        if cosine == 1.0:
            data = tmm.coh_tmm("s", index, d, 0.0, at)
        else:
            data = tmm.unpolarized_RT(index, d, np.arccos(cosine), at)
        found.append(1.0 - data["R"] - data["T"])
    return np.array(found)


def _mean(values: np.ndarray, weight: np.ndarray, wavelength: np.ndarray) -> float:
    over = np.trapezoid(values * weight, wavelength)
    return float(over / np.trapezoid(weight, wavelength))
