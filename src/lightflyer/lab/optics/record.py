"""What is printed and written of a film's fitted numbers, flyer files included."""

import datetime
from collections.abc import Mapping, Sequence
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import tomlkit

from lightflyer.config.update import measured_text, replace_file, require_no_doubt
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.text import read_text
from lightflyer.film.layered_section import LayeredFilmSection
from lightflyer.lab.estimate import Estimate
from lightflyer.lab.optics.data import OpticsSample, names_of_layers
from lightflyer.lab.optics.diagnostics import display_unit
from lightflyer.lab.optics.fit import OpticsFit
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
    path: str | Path, fit: OpticsFit, origin: str, *, insist: bool = False
) -> list[str]:
    """Write fitted numbers of layers, their ± and their correlations into a flyer file."""
    path = Path(path)
    names = list(fit.numbers)
    require_same_layers(path, fit.sample)
    for name in names:
        one = fit.numbers[name]
        if all(fit.open_ends[name]) or not (one.uncertainty or 0.0) < abs(one.value):
            raise ConfigurationError(
                f"{path}: the spectra do not tell {name}; fix it in {fit.sample.source}, or state "
                "it with ±; the file is unchanged"
            )
    require_no_doubt(path, fit.warnings, insist=insist)
    document: Any = tomlkit.parse(read_text(path))
    table, lines, written = document["film"], [], []
    for name, estimate in fit.numbers.items():
        scale, unit = display_unit(estimate.unit)
        low, high = estimate.interval
        spread = (estimate.uncertainty or 0.0) / scale
        written_as = Estimate(estimate.value / scale, (low / scale, high / scale), unit, spread)
        text = measured_text(written_as, _DIGITS)
        for alias in _aliases(fit.sample, name):
            *sections, key = alias.split(".")
            part = table
            for section in sections:
                part = part[int(section) if section.isdigit() else section]
            part[key] = text
            lines.append(f'film.{alias} = "{text}"')
            written += [] if insist else [f"film.{alias}"]
    entries = _correlations(fit, names)
    ours = {alias for name in names for alias in _aliases(fit.sample, name)}
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


def _correlations(fit: OpticsFit, names: Sequence[str]) -> list[Mapping[str, Any]]:
    """Entries of ``correlated`` for all pairs; numbers that are the same have one error."""
    full = [(alias, row) for row, name in enumerate(names) for alias in _aliases(fit.sample, name)]
    found: list[Mapping[str, Any]] = []
    for (one, row), (other, column) in combinations(full, 2):
        value = float(np.clip(fit.correlation[row, column], -1.0, 1.0))
        if abs(value) >= _LEAST:
            found.append({"of": [one, other], "value": round(value, _KEPT)})
    return found
