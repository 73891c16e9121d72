"""Emissivity, or its upper bound, from infrared spectra."""

from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.files.quantities import ends, quantities, quantity
from lightflyer.lab.options import Face, Share, measurement

if TYPE_CHECKING:
    import numpy as np

    from lightflyer.film.optics.stack import Film
    from lightflyer.lab.ftir.reduction import Ftir
    from lightflyer.lab.readers.interpretation import MeasuredSpectrum
    from lightflyer.lab.result import Outcome

_WAVENUMBERS = 1000  # of a computed spectrum


def _read_band(option: str, text: str) -> tuple[float, float]:
    whole = ends(option, text, "m^-1")
    if whole is not None:
        return whole
    centre, half = quantity(option, text, "m^-1")
    if not half:
        raise ConfigurationError(
            f'{option} "{text}" has no width; write "500 to 1300 cm^-1" or "900 ± 400 cm^-1"'
        )
    if half >= centre:
        raise ConfigurationError(f'{option} "{text}" reaches below zero')
    return centre - half, centre + half


@measurement(reflectance_spectrum="reflectance", collection="reflectance", face="update")
def ftir(
    files: list[Path],
    /,
    *,
    reflectance: Path | None = None,
    columns: str | None = None,
    spectrum: str | None = None,
    reflectance_spectrum: str | None = None,
    scale: Literal["%", "1"] | None = None,
    collection: Literal["specular", "diffuse", "total"] | None = None,
    band: Annotated[Any, _read_band] = "900 ± 400 cm^-1",
    temperatures: Annotated[Any, partial(quantities, unit="K")] = "300 K,400 K,441 K,500 K",
    accuracy: Share = None,
    air: Path | None = None,
    straight_line: str | None = None,
    film: Path | None = None,
    update: Path | None = None,
    face: Face = "both",
) -> "Outcome":
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
    update
        Flyer file to write the emissivity over the band into; needs --reflectance.
    face
        Face of that film.
    """
    from lightflyer.config.update import emittance_keys
    from lightflyer.lab.ftir.means import parse_ranges, with_straight_lines, without_air
    from lightflyer.lab.ftir.reduction import reduce_ftir, to_dataset
    from lightflyer.lab.readers.spectrum_data import PER_CENTIMETRE, read_spectrum
    from lightflyer.lab.result import Outcome, figures_by, rejected_json, rejected_lines

    if update is not None and reflectance is None:
        raise ConfigurationError(
            "--update: transmittance alone gives only an upper bound of the emittance; add "
            "--reflectance"
        )

    def read(file: Path, **wanted: Any) -> "MeasuredSpectrum":
        one = read_spectrum(file, columns=columns, scale=scale, **wanted)
        if air is not None:
            one = without_air(one, read_spectrum(air, quantity="transmittance"))
        if straight_line is not None:
            one = with_straight_lines(one, parse_ranges(straight_line))
        return one

    spectra = [read(file, quantity="transmittance", spectrum=spectrum) for file in files]
    mirrors = [
        read(one, quantity="reflectance", spectrum=reflectance_spectrum, collection=collection)
        for one in ([] if reflectance is None else [reflectance])
    ]
    result = reduce_ftir(
        spectra, mirrors, band=band, temperatures=list(temperatures), accuracy=accuracy
    )
    emissivity = result.emissivity
    if update is not None and emissivity is not None and emissivity.value <= 0.0:
        raise ConfigurationError(
            "--update: the emissivity is not distinguishable from 0; it is at most "
            f"{result.at_most:.3g} (95 %, one-sided), and nothing is written"
        )
    computed: dict[str, Any] = {}
    warnings = list(result.warnings)
    if film is not None:
        from lightflyer.config.reader import read_film_file

        try:
            computed, extrapolated = _computed(read_film_file(film).film(), result)
        except ParameterError as error:
            raise ConfigurationError(f"{film}: {error}") from None
        warnings += [f"{film}: the computed spectrum extrapolates {text}" for text in extrapolated]
    parts = [*result.finding()]
    for one in (*spectra, *mirrors):
        first, last = one.wavenumber[[0, -1]] / PER_CENTIMETRE
        said = one.metadata
        words = [  # as the file has them
            f'{said.format} with "{said.ordinate}"',
            said.instrument,
            f"resolution {said.resolution}" if said.resolution else "resolution not stated",
            said.accessory,
            f"{one.collection} light" if one.collection else "",
            f'sample "{said.sample}"' if said.sample else "",
            f"of {said.measured}" if said.measured else "",
        ]
        parts += [
            f"read {len(one.wavenumber)} points of {one.quantity} from {one.source}, "
            f"{first:.5g} to {last:.5g} cm⁻¹",
            f"  {', '.join(filter(None, words))}",
            *rejected_lines(one.rejected),
        ]

    return Outcome(
        result.summary(),
        to_dataset(result),
        [*parts, *result.parts()],
        read=[
            {
                "file": one.source, "quantity": one.quantity, **asdict(one.metadata),
                "collection": one.collection, "points": len(one.wavenumber),
                "rejected": rejected_json(one.rejected),
            }
            for one in (*spectra, *mirrors)
        ],
        warnings=warnings,
        figures=figures_by("ftir.figures:ftir_figures", result, computed),
        tables={"emissivity.csv": result.table_text()},
        sources=[*files, *([reflectance] if reflectance else [])],
        values={} if emissivity is None else dict.fromkeys(emittance_keys(face), emissivity),
    )  # fmt: skip


def _computed(
    film: "Film", measured: "Ftir"
) -> "tuple[dict[str, tuple[np.ndarray, np.ndarray]], list[str]]":
    """Spectra of a film over the measured wavenumbers that its materials' data cover."""
    import numpy as np

    shortest, longest = film.covered_range
    low = max(min(one.wavenumber[0] for one in measured.spectra), 1.0 / longest)
    high = max(one.wavenumber[-1] for one in measured.spectra)
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
