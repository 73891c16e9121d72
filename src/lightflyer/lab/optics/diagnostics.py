"""What a reader must know of numbers that were fitted to spectra."""

from collections.abc import Iterator, Mapping

import numpy as np

from lightflyer.core.errors import Doubt
from lightflyer.core.units import scale_and_offset
from lightflyer.film.optics.stack import Film
from lightflyer.lab.estimate import Estimate
from lightflyer.lab.optics.data import (
    DEFAULT_SCALE_ACCURACY,
    DEFAULT_ZERO_ACCURACY,
    FilmSpectrum,
    OpticsSample,
)
from lightflyer.lab.optics.search import FilmFit
from lightflyer.lab.spectrum_noise import point_noise

TIED = 0.95  # Correlation above which two numbers are said not to be told apart

_FLAT = 0.8  # of the way between the bounds that an interval covers
_FAR = 3.0  # standard uncertainties, of an instrument's error or a number known beforehand
_MISFIT = 2.0  # residuals over their differences from point to point
_VISIBLE_MISFIT = 0.005  # [1]; smaller ones are those of any photometer
_FAR_ABOVE = 10.0  # times the stated accuracy: residuals that no noise excuses
_SHOWN = 3  # other minima
_WRITTEN = {
    unit: (scale_and_offset(name, unit)[0], name)
    for unit, name in (("m", "nm"), ("J", "eV"), ("m^2", "um^2"), ("m^4", "um^4"))
}


def diagnose(
    sample: OpticsSample,
    numbers: Mapping[str, Estimate],
    open_ends: Mapping[str, tuple[bool, bool]],
    correlation: np.ndarray,
    fit: FilmFit,
    film: Film,
) -> tuple[str, ...]:
    """Warnings of a fit, one line each; ``correlation`` (free, free)."""

    def generate() -> Iterator[str]:
        names = list(numbers)
        yield from _about_bounds(sample, numbers, open_ends)
        for i in range(len(names)):
            for j in range(i):
                if abs(correlation[i, j]) > TIED:
                    yield (
                        f"{names[i]} and {names[j]} are hardly told apart: their errors have a "
                        f"correlation of {correlation[i, j]:+.3f}"
                    )
        for solution, excess in fit.rivals[:_SHOWN]:
            if excess <= fit.factor**2:
                values = zip(sample.free, fit.problem.model.values(solution.position), strict=True)
                words = (f"{one.name} = {amount_text(value, one.unit)}" for one, value in values)
                yield (
                    f"another minimum fits as well (cost +{excess:.2g}, excluded from "
                    f"{fit.factor**2:.2g}) and is not in the intervals: {', '.join(words)}"
                )
        yield from _about_what_was_stated(sample, numbers)
        yield from _about_residuals(sample, fit)
        yield from _about_instruments(sample, fit)
        total = [one for one in sample.spectra if one.spectrum.collection == "total"]
        if film.is_rough and total:
            files = ", ".join(one.spectrum.source for one in total)
            yield (
                "the film is rough, and the model has its specular beams only; total light was "
                f"collected in {files}"
            )
        yield from dict.fromkeys(text for medium in film.media for text in medium.diagnostics)
        for one in sample.spectra:
            yield from (f"{one.spectrum.source}: {note}" for note in one.spectrum.notes)

    return tuple(generate())


def _about_bounds(
    sample: OpticsSample, numbers: Mapping[str, Estimate],
    open_ends: Mapping[str, tuple[bool, bool]],
) -> Iterator[str]:  # fmt: skip
    for one in sample.free:
        low, high = numbers[one.name].interval
        if high - low > _FLAT * (one.highest - one.lowest):
            yield (
                f"the spectra do not tell {one.name}: its interval is nearly all between its bounds"
            )
        elif any(open_ends[one.name]):
            named = (("lower", one.lowest), ("upper", one.highest))
            ends = " and ".join(
                f"{name} bound {amount_text(end, one.unit)}"
                for (name, end), is_open in zip(named, open_ends[one.name], strict=True)
                if is_open
            )
            yield f"the interval of {one.name} ends at its {ends}, not by the spectra"


def _about_what_was_stated(sample: OpticsSample, numbers: Mapping[str, Estimate]) -> Iterator[str]:
    for one in sample.free:
        if one.prior is None:
            continue
        value = numbers[one.name]
        known = f"{amount_text(one.start, one.unit)} ± {amount_text(one.prior, one.unit)}"
        if abs(value.value - one.start) > _FAR * one.prior:
            found = amount_text(value.value, one.unit)
            yield f"{one.name} = {found} contradicts what was stated, {known}"
        elif (value.uncertainty or 0.0) > TIED * one.prior:
            yield f"{one.name} is as stated, {known}: the spectra tell nothing of it"
        else:
            yield f"{one.name} was stated as {known}, which the fit takes into account"


def _about_residuals(sample: OpticsSample, fit: FilmFit) -> Iterator[str]:
    for one, reading in zip(sample.spectra, fit.problem.readings(fit.best), strict=True):
        residual = one.spectrum.value - reading
        deviation, noise = float(np.sqrt(np.mean(residual**2))), point_noise(residual)
        # residuals of few points look like noise whatever they are: what is stated tells
        if is_off(one, residual):
            yield Doubt(
                f"{one.label}: residuals of {deviation:.2g}, where an accuracy of "
                f"{one.accuracy:.1g} is stated or assumed: the film is not that of the model, or "
                "the data are not what they are taken for"
            )
        elif deviation > max(_MISFIT * noise, _VISIBLE_MISFIT):
            yield (
                f"{one.label}: residuals of {deviation:.2g} exceed the noise of "
                f"{noise:.1g}: the film or its optical constants differ from the model; intervals "
                "are wider for it, and may still miss what the model leaves out"
            )


def is_off(one: FilmSpectrum, residual: np.ndarray) -> bool:
    """Whether residuals are far above what the accuracy stated of a spectrum allows."""
    limit = max(_FAR_ABOVE * one.accuracy, _VISIBLE_MISFIT)
    return bool(np.sqrt(np.mean(residual**2)) > limit)


def _about_instruments(sample: OpticsSample, fit: FilmFit) -> Iterator[str]:
    unstated = [one for one in sample.spectra if None in (one.scale_accuracy, one.zero_accuracy)]
    if unstated:
        yield (
            f"no accuracy is stated of {', '.join(one.spectrum.source for one in unstated)}: "
            f"{100 * DEFAULT_SCALE_ACCURACY:g} % of the scale and "
            f"{100 * DEFAULT_ZERO_ACCURACY:g} % of zero are assumed (scale_accuracy, "
            "zero_accuracy)"
        )
    for one, errors in zip(sample.spectra, fit.best.errors, strict=True):
        for name, error in zip(("scale", "zero"), errors, strict=True):
            if abs(error) > _FAR:
                yield Doubt(
                    f"{one.spectrum.source}: the fit wants an error of its {name} of "
                    f"{error:+.1f} stated standard uncertainties"
                )


def amount_text(value: float, unit: str) -> str:
    """A number with its unit, lengths in nanometres and energies in electronvolts."""
    scale, name = display_unit(unit)
    return f"{value / scale:.4g} {name}".rstrip()


def display_unit(unit: str) -> tuple[float, str]:
    """Unit that people write an SI unit's numbers of films in, with its size."""
    return _WRITTEN.get(unit, (1.0, unit))
