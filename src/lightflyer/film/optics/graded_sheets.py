"""How far the sheets of graded layers are from the continuous layers they stand for."""

import dataclasses

import numpy as np

from lightflyer.core.checks import is_traced
from lightflyer.film.media.graded import Graded
from lightflyer.film.optics.spectra import SPECTRUM_RANGE
from lightflyer.film.optics.stack import Film, Layer

_WAVELENGTHS = 100
_OF_SECOND_ORDER = 4.0 / 3.0  # error over the difference to twice as many sheets


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
    wavelength = np.geomspace(shortest, longest, _WAVELENGTHS)
    optics = [one.optics(wavelength) for one in (film, _finer(film))]
    changes = (
        np.max(np.abs(optics[1].reflectance - optics[0].reflectance)),
        np.max(np.abs(optics[1].transmittance - optics[0].transmittance)),
    )
    return float(_OF_SECOND_ORDER * max(changes))


def _finer(film: Film) -> Film:
    """The film with twice as many sheets."""
    return dataclasses.replace(film, layers=tuple(map(_halve, film.layers)))


def _halve(layer: Layer) -> Layer:
    medium = layer.material
    if not isinstance(medium, Graded):
        return layer
    finer = dataclasses.replace(medium, count=2 * medium.count)
    return dataclasses.replace(layer, material=finer)
