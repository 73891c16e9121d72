"""Computed spectra of a layered film beside its measured ones."""

import numpy as np

from lightflyer.core.errors import ParameterError
from lightflyer.film.optics.stack import Film
from lightflyer.lab.ftir.reduction import Ftir

_WAVENUMBERS = 1000


def computed_spectra(
    film: Film, measured: Ftir
) -> tuple[dict[str, tuple[np.ndarray, np.ndarray]], list[str]]:
    """Spectra of a film over the measured wavenumbers that its materials' data cover."""
    shortest, longest = film.covered_range
    ends = [one.wavenumber[[0, -1]] for one in measured.spectra]
    low = max(min(end[0] for end in ends), 1.0 / longest)
    high = max(end[1] for end in ends)
    if shortest > 0.0:  # zero if all materials are extrapolated
        high = min(high, 1.0 / shortest)
    if low >= high:
        raise ParameterError("its materials have no data in the range of the spectra")
    # by rounding, the ends themselves may lie outside the materials' range
    wavenumber = np.linspace(low, high, _WAVENUMBERS + 2)[1:-1]
    optics = film.optics(1.0 / wavenumber).polarisation_mean()
    found = {"transmittance": (wavenumber, np.asarray(optics.transmittance))}
    if measured.reflectances:
        found["reflectance"] = (wavenumber, np.asarray(optics.reflectance))
    return found, list(film.extrapolations(1.0 / wavenumber[-1], 1.0 / wavenumber[0]))
