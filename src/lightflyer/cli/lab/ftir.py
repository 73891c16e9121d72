"""``lightflyer lab ftir``: emissivity, or its upper bound, from infrared spectra."""

import re
from collections.abc import Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from lightflyer.cli.figure_files import AS_USUAL, ResultOptions
from lightflyer.cli.lab.shared import Files, Insist, deliver, rejected_parts, updater
from lightflyer.cli.options import Json, only_with
from lightflyer.cli.quantities import optional_share, quantities, quantity
from lightflyer.core.errors import ConfigurationError
from lightflyer.files.result_text import Parts, warning_lines

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from lightflyer.lab.ftir.reduction import Ftir
    from lightflyer.lab.readers.spectra.interpretation import MeasuredSpectrum

_RANGE = re.compile(r"^\s*([\d.]+)\s*(?:-|–|to)\s*([\d.]+)\s*([^\d\s.]\S*)\s*$")  # a band's ends


@only_with(
    reflectance_spectrum="reflectance", collection="reflectance", face="update", insist="update"
)
def ftir_command(
    files: Files,
    /,
    *,
    reflectance: Path | None = None,
    columns: str | None = None,
    spectrum: str | None = None,
    reflectance_spectrum: str | None = None,
    scale: Literal["%", "1"] | None = None,
    collection: Literal["specular", "diffuse", "total"] | None = None,
    band: str = "900 ± 400 cm^-1",
    temperatures: str = "300 K,400 K,441 K,500 K",
    accuracy: str | None = None,
    air: Path | None = None,
    straight_line: str | None = None,
    film: Path | None = None,
    out: Path | None = None,
    update: Path | None = None,
    insist: Insist = False,
    face: Literal["top", "bottom", "both"] = "both",
    json_output: Json = False,
    figures: ResultOptions = AS_USUAL,
) -> None:
    """Average infrared spectra over a band and over Planck's spectrum, for the emissivity.

    Intervals are 95 % and include noise and the spectrometer's accuracy.

    Parameters
    ----------
    files
        Spectra of transmittance of one film, several being repeats: files of JASCO (text, .jws),
        Bruker OPUS, Thermo OMNIC (.spa, .spg), PerkinElmer (.sp, .asc), GRAMS (.spc), JCAMP-DX, or
        tables of wavenumber or wavelength and transmittance or absorbance, units in the header.
    reflectance
        Spectrum of its reflectance. Without it, only an upper bound of the emissivity follows,
        which is never written into a flyer file.
    columns
        Columns of tables without a header: "wavenumber [cm^-1], transmittance [%]".
    spectrum
        Which one of several spectra in each file of transmittance: its number or title.
    reflectance_spectrum
        Which one of several spectra in the file of reflectance.
    scale
        Whether values are per cent ("%") or fractions ("1"), where a file is wrong or unclear.
    collection
        Light that the reflectance collects: the specular beam, diffuse light, or both ("total").
        Default: as the file names its accessory.
    band
        The band, such as "500 to 1300 cm^-1", or its centre ± half its width.
    temperatures
        Temperatures of the Planck weighting.
    accuracy
        Standard uncertainty of the ordinate, such as "0.5 %" of full scale: photometric error,
        zero level, and drift between background and sample. Default: 1 %, assumed.
    air
        Spectrum of transmittance of air alone: a background with more of it over one with less,
        at the same resolution. Its lines of carbon dioxide and water vapour are taken out of the
        other spectra, each gas by as much as leaves them smoothest.
    straight_line
        Ranges in which spectra are replaced by a straight line between their ends, such as
        "2280-2400 cm^-1, 655-680 cm^-1" for carbon dioxide.
    film
        TOML file with the layers of a film; draws its computed spectrum.
    out
        Folder to write the record (JSON, NetCDF) and the figure into.
    update
        Flyer file to write the emissivity over the band into; needs --reflectance.
    insist
        Have --update write also what is in doubt: of a wrong unit, not determined, or of data that
        do not fit or not cover it.
    face
        Face of that film.
    json_output
        Print one JSON object instead of tables.
    figures
        How figures are written.
    """
    out = figures.folder(out)
    from lightflyer.config.update import emittance_keys
    from lightflyer.lab.ftir.reduction import reduce_ftir, to_dataset
    from lightflyer.lab.ftir.text import finding_parts, ftir_parts
    from lightflyer.lab.readers.spectrum_data import read_spectrum

    if update is not None and reflectance is None:
        raise ConfigurationError(
            "--update: transmittance alone gives only an upper bound of the emittance; add "
            "--reflectance"
        )
    read = partial(read_spectrum, columns=columns, scale=scale)
    spectra = [read(file, quantity="transmittance", spectrum=spectrum) for file in files]
    mirrors = [
        read(one, quantity="reflectance", spectrum=reflectance_spectrum, collection=collection)
        for one in ([] if reflectance is None else [reflectance])
    ]
    clean = partial(_without_lines, air, straight_line)
    spectra, mirrors = ([clean(one) for one in group] for group in (spectra, mirrors))
    result = reduce_ftir(
        spectra, mirrors,
        band=_ends(band),
        temperatures=list(quantities("--temperatures", temperatures, "K")),
        accuracy=optional_share("--accuracy", accuracy),
    )  # fmt: skip
    if update is not None:
        _require_radiating(result)
    computed, extrapolated = _compute(film, result)
    warnings = [*result.warnings, *extrapolated]
    document = (
        result.summary()
        | {"warnings": warnings}
        | {"read": [_read(one) for one in (*spectra, *mirrors)]}
    )
    emissivity = result.emissivity
    values = {} if emissivity is None else dict.fromkeys(emittance_keys(face), emissivity)

    def draw() -> "dict[str, Figure]":
        from lightflyer.lab.ftir.figures import ftir_figures

        return ftir_figures(result, computed)

    sources = [*files, *([reflectance] if reflectance else [])]
    deliver(
        "ftir", document, to_dataset(result), draw,
        [
            *finding_parts(result), *_read_parts([*spectra, *mirrors]), *ftir_parts(result),
            *warning_lines(warnings),
        ],
        out=out, figures=figures, json_output=json_output,
        update=updater(update, values, "ftir", sources, insist=insist,
                       warnings=warnings),
        tables={"emissivity.csv": result.table_text()},
    )  # fmt: skip


def _without_lines(
    air: Path | None, straight_line: str | None, one: "MeasuredSpectrum"
) -> "MeasuredSpectrum":
    """A spectrum without the lines of the air, and straight where the user says so."""
    from lightflyer.lab.ftir.air import parse_ranges, with_straight_lines, without_air
    from lightflyer.lab.readers.spectrum_data import read_spectrum

    if air is not None:
        one = without_air(one, read_spectrum(air, quantity="transmittance"))
    return one if straight_line is None else with_straight_lines(one, parse_ranges(straight_line))


def _require_radiating(result: "Ftir") -> None:
    """A flyer's film must radiate; an emissivity of zero is none."""
    if result.emissivity is not None and result.emissivity.value <= 0.0:
        raise ConfigurationError(
            "--update: the emissivity is not distinguishable from 0; it is at most "
            f"{result.at_most:.3g} (95 %, one-sided), and nothing is written"
        )


def _ends(band: str) -> tuple[float, float]:
    """Lowest and highest wavenumber of a band [1/m]."""
    whole = _RANGE.match(band)
    if whole is not None:
        first, last = (
            quantity("--band", f"{end} {whole[3]}", "m^-1").value for end in whole.groups()[:2]
        )
        if first >= last:
            raise ConfigurationError(f'--band "{band}": {whole[1]} must be below {whole[2]}')
        return first, last
    centre = quantity("--band", band, "m^-1")
    if not centre.uncertainty:
        raise ConfigurationError(
            f'--band "{band}" has no width; write "500 to 1300 cm^-1" or "900 ± 400 cm^-1"'
        )
    if centre.uncertainty >= centre.value:
        raise ConfigurationError(f'--band "{band}" reaches below zero')
    return centre.value - centre.uncertainty, centre.value + centre.uncertainty


def _read(spectrum: "MeasuredSpectrum") -> dict[str, Any]:
    return {
        "file": spectrum.source,
        "quantity": spectrum.quantity,
        **asdict(spectrum.metadata),
        "collection": spectrum.collection,
        "points": len(spectrum.wavenumber),
        "rejected": [{"line": row.line, "reason": row.reason} for row in spectrum.rejected],
    }


def _compute(film: Path | None, result: "Ftir") -> tuple[dict[str, Any], list[str]]:
    """Computed spectra of the film, and warnings."""
    if film is None:
        return {}, []
    from lightflyer.config.reader import read_film_file
    from lightflyer.core.errors import ParameterError
    from lightflyer.lab.ftir.film import computed_spectra

    try:
        found, extrapolated = computed_spectra(read_film_file(film).film(), result)
    except ParameterError as error:
        raise ConfigurationError(f"{film}: {error}") from None
    return found, [f"{film}: the computed spectrum extrapolates {text}" for text in extrapolated]


def _read_parts(spectra: "Sequence[MeasuredSpectrum]") -> Parts:
    from lightflyer.lab.readers.spectra.names import PER_CENTIMETRE

    for one in spectra:
        ends = one.wavenumber[[0, -1]] / PER_CENTIMETRE
        yield (
            f"read {len(one.wavenumber)} points of {one.quantity} from {one.source}, "
            f"{ends[0]:.5g} to {ends[1]:.5g} cm⁻¹"
        )
        yield f"  {_facts(one)}"
        yield from rejected_parts(one.rejected)


def _facts(spectrum: "MeasuredSpectrum") -> str:
    """What the file says of its spectrum, as it says it."""
    metadata = spectrum.metadata
    words = [
        f'{metadata.format} with "{metadata.ordinate}"',
        metadata.instrument,
        f"resolution {metadata.resolution}" if metadata.resolution else "resolution not stated",
        metadata.accessory,
        f"{spectrum.collection} light" if spectrum.collection else "",
        f'sample "{metadata.sample}"' if metadata.sample else "",
        f"of {metadata.measured}" if metadata.measured else "",
    ]
    return ", ".join(filter(None, words))
