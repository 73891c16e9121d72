"""What a reader of a film's averages must know: missing, extrapolated and interpolated data."""

import dataclasses
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from lightflyer.array.namespace import Numeric
from lightflyer.core.checks import is_traced
from lightflyer.core.quantity import Density, Quantity, quantity_of
from lightflyer.film.media.medium import MICROMETRE, Medium
from lightflyer.film.media.mixture import Graded
from lightflyer.film.optics.averages import Average, thermal_coverage
from lightflyer.film.optics.curve import EmittanceCurve
from lightflyer.film.optics.spectra import SPECTRUM_RANGE, Spectrum, am0
from lightflyer.film.optics.stack import Film
from lightflyer.film.optics.waves import narrow_holes

WORTH_SAYING = 0.001
"""Least share of a spectrum's power whose absence or extrapolation is named [1]."""

_REFERENCE_WAVELENGTH = 0.5e-6  # [m], near the peak of sunlight
_ROUNDING = 1e-9  # of a share
_SHEET_WAVELENGTHS = 100
_OF_SECOND_ORDER = 4.0 / 3.0  # error over the difference to twice as many sheets
_DENSITY = quantity_of(Density) or Quantity()
_MOST_WAVELENGTHS = 50.0  # inside a coherent layer: four steps of the table of AM0 in a fringe

TYPICAL_TEMPERATURE = 350.0
"""Temperature of light-flyers at which a warning gives the bounds of an emittance [K]."""


def film_warnings(
    film: Film,
    light: Spectrum,
    temperatures: np.ndarray,
    solar: Mapping[str, Average],
    lamp: Mapping[str, Average],
    thermal: Mapping[str, Average],
    thickness_uncertainty: Sequence[float | None],
) -> tuple[str, ...]:
    """Warnings of a film's averages, one line each; ``temperatures`` (m,)."""
    spectra = {"sunlight (AM0)": solar["top"]}
    if light is not am0():
        spectra[light.name] = lamp["top"]
    found: list[str] = []
    for name, average in spectra.items():
        found += _shares(average, name, "absorptance", "")
    heat = f" ({_range(temperatures, 'g')} K)"
    found += _shares(thermal["top"], "a black body's radiation", "emittance", heat)
    found += _scatter_lines(solar["top"], "sunlight (AM0)", "absorptance", "")
    found += _scatter_lines(thermal["top"], "a black body's radiation", "emittance", heat)
    found += [*medium_warnings(film), *thick_warnings(film), *roughness_warnings(film)]
    if film.below is not None:
        found.append(
            f"the substrate, {film.below.name}, has no lower face: what enters it counts as "
            "transmitted, and the emittance is that of the layers alone"
        )
    if film.above is not None:
        found.append(f"the film is in {film.above.name}: angles and the emittance are those in it")
    if film.open_fraction is not None and film.hole_diameter is not None:
        found += narrow_holes(0.5 * film.hole_diameter, temperatures)
    if film.unknown_density is not None:
        found.append(f"no areal density: {film.unknown_density}")
    exact = [
        layer.material.name
        for layer, spread in zip(film.layers, thickness_uncertainty, strict=True)
        if spread is None
    ]
    if exact and len(exact) < len(film.layers):
        found.append(
            f"no ± is stated for the thickness of {', '.join(dict.fromkeys(exact))}: the intervals "
            "take it as exact"
        )
    return tuple(found)


def property_warnings(name: str, mean: Average, film: Film) -> Iterator[str]:
    """Warnings of a film's property whose data do not cover the spectrum."""
    covered, lower, upper = mean.covered, mean.lower, mean.upper
    spectrum = "of the light"
    if np.ndim(covered):
        spectrum = f"of a black body's radiation at {TYPICAL_TEMPERATURE:g} K"
        covered = thermal_coverage(film, TYPICAL_TEMPERATURE)
        lower, upper = (EmittanceCurve.through(end)(TYPICAL_TEMPERATURE) for end in (lower, upper))
    if covered < 1.0 - WORTH_SAYING:
        yield (
            f"{name} is computed from data for {100.0 * float(covered):.3g} % {spectrum}; what is "
            f"missing leaves it between {float(lower):.3g} and {float(upper):.3g}"
        )
    if np.min(mean.scattered) < -_ROUNDING:
        yield _unphysical(mean)
    elif np.max(mean.scattered) > WORTH_SAYING:
        share = _range(np.asarray(mean.scattered), ".2g")
        of = "a black body's radiation" if np.ndim(mean.covered) else "the light"
        yield (
            f"rough faces scatter {share} of {of}; {name} leaves it out and is up to as much higher"
        )


def _scatter_lines(average: Average, spectrum: str, quantity: str, where: str) -> list[str]:
    """What rough interfaces scatter, and where it may be missing."""
    if np.min(average.scattered) < -_ROUNDING:
        return [_unphysical(average)]
    if np.max(average.scattered) <= WORTH_SAYING:
        return []
    return [
        f"{_range(np.asarray(average.scattered), '.1%')} of {spectrum}{where} is scattered at "
        f"rough faces and not followed: {quantity} and transmittance leave it out, and each is up "
        "to as much higher"
    ]


def _unphysical(average: Average) -> str:
    return (
        f"rough faces scatter {_range(np.asarray(average.scattered), '.2g')}, less than nothing: "
        "between two absorbing media the scalar theory does not keep energy; make the faces "
        "between them smooth"
    )


def roughness_warnings(film: Film) -> list[str]:
    """Where a film's faces are too rough for the theory of their scattering, one line each."""
    if not film.is_rough:
        return []
    wavelength = float(np.clip(_REFERENCE_WAVELENGTH, *film.covered_range))
    media = [film.above, *(end for layer in film.layers
                           for end in (layer.material.sheets[0], layer.material.sheets[-1])),
             film.below]  # fmt: skip
    indices = [1.0 if one is None else _index(one, wavelength) for one in media]
    highest = np.maximum(indices[::2], indices[1::2])
    limit = wavelength / (4.0 * np.pi * highest)
    return [
        f"face {number} from the top has a roughness of {_nanometres(height)}: the scalar theory "
        f"of scattering holds up to about {_nanometres(most)} at {wavelength / MICROMETRE:.2g} µm"
        for number, (height, most) in enumerate(zip(film.faces, limit, strict=True), 1)
        if height is not None and height > most
    ]


def thick_warnings(film: Film) -> list[str]:
    """Layers of an unlikely density, or coherent and too thick for an average's wavelengths."""
    wavelength = float(np.clip(_REFERENCE_WAVELENGTH, *film.covered_range))
    found = [
        f"{layer.material.name}: density = {doubt}"
        for layer in film.layers
        if layer.material.density is not None
        and (doubt := _DENSITY.unlikely(layer.material.density))
    ]
    for layer in film.layers:
        if not layer.coherent:
            continue
        depth = float(layer.thickness) * _index(layer.material.sheets[0], wavelength)
        if depth > _MOST_WAVELENGTHS * wavelength:
            found.append(
                f"{layer.material.name}, {layer.thickness_text}, is so thick that its interference "
                "fringes are finer than the steps of spectra: give it coherent = false, unless a "
                "laser measures it"
            )
    return found


def _index(medium: Medium, wavelength: float) -> float:
    n, _ = medium.index(np.array([wavelength]))
    return float(n[0])


def _nanometres(length: Numeric) -> str:
    return f"{float(length) * 1e9:.3g} nm"


def _shares(average: Average, spectrum: str, quantity: str, where: str) -> list[str]:
    found = []
    if np.any(average.left_out > WORTH_SAYING):
        found.append(
            f"{_range(average.left_out, '.1%')} of {spectrum}{where} lies outside the optical "
            f"data; {quantity} is the mean over the rest, and its bounds take nothing or "
            "everything absorbed there"
        )
    if np.any(average.extrapolated_share > WORTH_SAYING):
        found.append(
            f"{_range(average.extrapolated_share, '.1%')} of {spectrum}{where} lies where optical "
            f"data are extrapolated ({'; '.join(average.extrapolated)}); the bounds of {quantity} "
            "do not rest on them"
        )
    return found


def _range(values: np.ndarray, form: str) -> str:
    ends = [format(float(end), form) for end in (np.min(values), np.max(values))]
    return " to ".join(dict.fromkeys(ends))


def medium_warnings(film: Film) -> list[str]:
    """What a reader must know of the optical data of a film's media, one line each."""
    said = [text for one in film.media for text in one.diagnostics]
    return [*dict.fromkeys(said), *sheet_warnings(film)]


def sheet_warnings(film: Film) -> list[str]:
    """What a reader must know of a film's graded layers, one line each."""
    graded = [one.material for one in film.layers if isinstance(one.material, Graded)]
    if not graded:
        return []
    error = None if is_traced(film) else sheet_error(film)
    within = "" if error is None else (
        f"; the film's reflectance and transmittance are within {error:.1g} of those with a "
        "continuous layer"
    )  # fmt: skip
    said = (f"{one.name} is computed as {one.count} sheets{within}" for one in graded)
    return list(dict.fromkeys(said))


def sheet_error(film: Film) -> float | None:
    """Largest error of reflectance and transmittance by the sheets of graded layers [1]."""
    shortest, longest = film.covered_range
    shortest, longest = max(shortest, SPECTRUM_RANGE[0]), min(longest, SPECTRUM_RANGE[1])
    if shortest >= longest:
        return None
    wavelength = np.geomspace(shortest, longest, _SHEET_WAVELENGTHS)
    finer = [
        dataclasses.replace(
            layer, material=dataclasses.replace(layer.material, count=2 * layer.material.count)
        )
        if isinstance(layer.material, Graded)
        else layer
        for layer in film.layers
    ]
    films = film, dataclasses.replace(film, layers=tuple(finer))
    optics = [one.optics(wavelength) for one in films]
    changes = (
        np.max(np.abs(optics[1].reflectance - optics[0].reflectance)),
        np.max(np.abs(optics[1].transmittance - optics[0].transmittance)),
    )
    return float(_OF_SECOND_ORDER * max(changes))
