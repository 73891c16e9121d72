"""What is said, printed and written of a film's fitted numbers, flyer files included."""

import datetime
from collections.abc import Iterator, Mapping
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import tomlkit

from lightflyer.config.update import measured_text, replace_file, require_no_doubt
from lightflyer.core.errors import ConfigurationError, Doubt
from lightflyer.core.text import read_text
from lightflyer.core.units import scale_and_offset
from lightflyer.film.layered_section import LayeredFilmSection
from lightflyer.film.optics.stack import Film
from lightflyer.lab.estimate import Estimate, point_noise
from lightflyer.lab.optics.data import (
    DEFAULT_SCALE_ACCURACY,
    DEFAULT_ZERO_ACCURACY,
    FilmSpectrum,
    OpticsSample,
    names_of_layers,
)
from lightflyer.lab.optics.search import FilmFit
from lightflyer.lab.result import Series, csv_text

if TYPE_CHECKING:
    from lightflyer.lab.optics.fit import OpticsFit

_DIGITS = 3  # of an uncertainty: correlated numbers round less
_LEAST = 0.005  # correlation that is written
_KEPT = 6  # digits of a correlation


def tables(result: "OpticsFit") -> dict[str, str]:
    """Text of the tables of a fit."""
    found = {}
    for number, one in enumerate(result.spectra, start=1):
        spectrum = one.measured.spectrum
        found[f"optics-spectrum-{number}.csv"] = csv_text(
            [f"# {one.measured.label}"],
            [Series("wavelength", 1e9 * spectrum.wavelength, "nm"),
             Series("measured", spectrum.value), Series("fitted reading", one.reading),
             Series("film", one.share)],
        )  # fmt: skip
    for number, layer in enumerate(result.indices, start=1):
        found[f"optics-constants-{number}.csv"] = csv_text(
            [f"# {layer.name}, fitted; 95 % bands"],
            [Series("wavelength", 1e6 * layer.wavelength, "um"),
             Series("n", layer.n), Series("k", layer.k),
             *map(Series, ("n_low", "n_high"), layer.n_band),
             *map(Series, ("k_low", "k_high"), layer.k_band)],
        )  # fmt: skip
    return found


def update_layers(
    path: str | Path, fit: "OpticsFit", origin: str, *, insist: bool = False
) -> list[str]:
    """Write fitted numbers of layers, their ± and their correlations into a flyer file."""
    path = Path(path)
    names = list(fit.numbers)
    require_same_layers(path, fit.sample)
    for name in names:
        one = fit.numbers[name]
        if all(fit.open_ends[name]) or not (one.uncertainty or 0.0) < abs(one.value):
            raise ConfigurationError(
                f"{path}: the spectra do not determine {name}; fix it in {fit.sample.source}, or "
                "state it with ±; the file is unchanged"
            )
    require_no_doubt(path, fit.warnings, insist=insist)
    document: Any = tomlkit.parse(read_text(path))
    table, lines, written = document["film"], [], []
    for name, estimate in fit.numbers.items():
        text = measured_text(in_display_unit(estimate), _DIGITS)
        for alias in _aliases(fit.sample, name):
            *sections, key = alias.split(".")
            part = table
            for section in sections:
                part = part[int(section) if section.isdigit() else section]
            part[key] = text
            lines.append(f'film.{alias} = "{text}"')
            written += [] if insist else [f"film.{alias}"]
    full = [(alias, row) for row, name in enumerate(names) for alias in _aliases(fit.sample, name)]
    entries: list[Mapping[str, Any]] = []
    for (first, row), (other, column) in combinations(full, 2):
        value = float(np.clip(fit.correlation[row, column], -1.0, 1.0))
        if abs(value) >= _LEAST:
            entries.append({"of": [first, other], "value": round(value, _KEPT)})
    ours = {alias for alias, _ in full}
    kept = [one for one in table.get("correlated", []) if ours.isdisjoint(map(str, one["of"]))]
    if kept or entries:
        table["correlated"] = [*kept, *entries]
    lines += [f"film.correlated: {' and '.join(one['of'])} {one['value']:+.3f}" for one in entries]
    table["layers"].comment(f"fitted: lab optics, {origin}, {datetime.date.today().isoformat()}")
    replace_file(path, document.as_string(), written)
    return lines


def require_same_layers(path: str | Path, sample: OpticsSample) -> None:
    """Raise unless the numbers that are free in a sample are those of layers of a flyer's film."""
    from lightflyer.config.reader import read_flyer_file  # slow to import

    film, section = read_flyer_file(path).film, sample.section
    if not isinstance(film, LayeredFilmSection):
        raise ConfigurationError(f"{path}: [film] has no layers; the file is unchanged")
    if section is None:
        raise ConfigurationError("only the fit of a sample file can be written into a flyer file")
    ours = names_of_layers(section)
    theirs = {f"layers.{number}": layer.label for number, layer in enumerate(film.layers)}
    for name in (alias for one in sample.free for alias in _aliases(sample, one.name)):
        layer = ".".join(name.split(".")[:2])
        if not name.startswith("layers."):
            raise ConfigurationError(
                f"{path}: {name} is free in {sample.source}, and a flyer's film has none; "
                "the file is unchanged"
            )
        if ours[layer].removeprefix("porous ") != theirs.get(layer, "").removeprefix("porous "):
            raise ConfigurationError(
                f"{path}: film.{layer} is of {theirs.get(layer) or 'nothing'}, that of "
                f"{sample.source} of {ours[layer]}; the file is unchanged"
            )


def _aliases(sample: OpticsSample, name: str) -> tuple[str, ...]:
    return sample.same.get(name, (name,))


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
) -> Iterator[str]:
    """Warnings of a fit, one line each; ``correlation`` (free, free)."""
    names = list(numbers)
    for free in sample.free:
        low, high = numbers[free.name].interval
        if high - low > _FLAT * (free.highest - free.lowest):
            yield f"{free.name} is not determined: its interval is nearly all between its bounds"
        elif any(open_ends[free.name]):
            named = (("lower", free.lowest), ("upper", free.highest))
            ends = " and ".join(
                f"{name} bound {amount_text(end, free.unit)}"
                for (name, end), is_open in zip(named, open_ends[free.name], strict=True)
                if is_open
            )
            yield f"the interval of {free.name} ends at its {ends}, not by the spectra"
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
    for free in sample.free:
        if free.prior is None:
            continue
        value = numbers[free.name]
        known = f"{amount_text(free.start, free.unit)} ± {amount_text(free.prior, free.unit)}"
        if abs(value.value - free.start) > _FAR * free.prior:
            found = amount_text(value.value, free.unit)
            yield f"{free.name} = {found} contradicts what was stated, {known}"
        elif (value.uncertainty or 0.0) > TIED * free.prior:
            yield f"{free.name} is as stated, {known}: the spectra tell nothing of it"
        else:
            yield f"{free.name} was stated as {known}, which the fit takes into account"
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


def in_display_unit(one: Estimate) -> Estimate:
    """The estimate in the unit that people write such numbers of films in."""
    scale, unit = display_unit(one.unit)
    low, high = one.interval
    spread = (one.uncertainty or 0.0) / scale
    return Estimate(one.value / scale, (low / scale, high / scale), unit, spread)
