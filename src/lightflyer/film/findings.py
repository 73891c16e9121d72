"""What a reader of a film's averages must know: missing, extrapolated and interpolated data."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from lightflyer.film.averages import Average, thermal_coverage
from lightflyer.film.curve import EmittanceCurve
from lightflyer.film.spectra import Spectrum, am0
from lightflyer.film.stack import Film

WORTH_SAYING = 0.001
"""Least share of a spectrum's power whose absence or extrapolation is named [1]."""

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
    """Warnings of a film's averages, one line each.

    Parameters
    ----------
    film : Film
    light : Spectrum
    temperatures : array, shape (m,)
        [K].
    solar, lamp, thermal : mapping of str to Average
        By side.
    thickness_uncertainty : sequence of float or None
        By layer; None where none is stated [m].

    Returns
    -------
    tuple of str
    """
    spectra = {"sunlight (AM0)": solar["top"]}
    if light is not am0():
        spectra[light.name] = lamp["top"]
    found: list[str] = []
    for name, average in spectra.items():
        found += _shares(average, name, "absorptance", "")
    heat = f" ({_range(temperatures, 'g')} K)"
    found += _shares(thermal["top"], "a black body's radiation", "emittance", heat)
    found += medium_warnings(film)
    return (*found, *_unstated(film, thickness_uncertainty))


def property_warnings(name: str, mean: Average, film: Film) -> Iterator[str]:
    """Warnings of a film's property whose data do not cover the spectrum.

    Parameters
    ----------
    name : str
        Of the property.
    mean : Average
        One number, or an emittance at each of the nodes of a curve.
    film : Film

    Yields
    ------
    str
        With the bounds that missing data leave; of an emittance those at a light-flyer's
        temperature.
    """
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
    return list(dict.fromkeys(text for one in film.layers for text in one.material.caveats))


def _unstated(film: Film, uncertainty: Sequence[float | None]) -> list[str]:
    names = [layer.material.name for layer, spread in zip(film.layers, uncertainty, strict=True)
             if spread is None]  # fmt: skip
    if not names or len(names) == len(film.layers):
        return []
    return [
        f"no ± is stated for the thickness of {', '.join(dict.fromkeys(names))}: the intervals "
        "take it as exact"
    ]
