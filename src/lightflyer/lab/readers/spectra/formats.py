"""All formats of spectra: how each is recognised, and what reads it."""

import struct

import numpy as np

from lightflyer.core.errors import ConfigurationError, MissingExtraError
from lightflyer.lab.readers.formats import Format, Source, find_format, one_line
from lightflyer.lab.readers.spectra import (
    jasco,
    jcamp_dx,
    omnic,
    opus,
    perkin_elmer,
    spc,
)
from lightflyer.lab.readers.spectra.interpretation import ReadOptions, readable, shows
from lightflyer.lab.readers.spectra.raw import RawSpectrum

SPECTRUM_FORMATS = [
    Format(opus.FORMAT, opus.is_opus, opus.read_opus),
    Format(omnic.FORMAT, omnic.is_omnic, omnic.read_omnic),
    Format(perkin_elmer.SP, perkin_elmer.is_sp, perkin_elmer.read_sp),
    Format(jasco.JWS, jasco.is_jws, jasco.read_jws),
    Format(spc.FORMAT, spc.is_spc, spc.read_spc),
    Format(jcamp_dx.FORMAT, jcamp_dx.is_jcamp, jcamp_dx.read_jcamp),
    Format(perkin_elmer.ASC, perkin_elmer.is_asc, perkin_elmer.read_asc),
    Format(jasco.TEXT, jasco.is_jasco_text, jasco.read_jasco_text),
]
"""All formats; binary ones, whose first bytes tell, before text. A plug-in adds its own."""

_BINARY = {".spa": omnic.FORMAT, ".spg": omnic.FORMAT, ".spc": spc.FORMAT, ".sp": perkin_elmer.SP,
           ".jws": jasco.JWS, ".jrs": jasco.JWS}  # fmt: skip
_NOT_READ = {".srs": "a series of OMNIC", ".map": "a map of OMNIC", ".jwb": "a block of JASCO",
             ".fsm": "an image of PerkinElmer", ".wdf": "Raman data of Renishaw",
             ".ispd": "a file of Shimadzu", ".seq": "a sequence of Agilent"}  # fmt: skip
_LISTED, _TITLE = 8, 40  # spectra that a message names, and characters of a title


def format_of(source: Source) -> Format | None:
    """Format of a file."""
    found = find_format(source, SPECTRUM_FORMATS)
    named = _BINARY.get(source.suffix)
    if found is None and named is not None:
        source.refuse(f"is damaged or not {named}, which its name says")
    other = _NOT_READ.get(source.suffix)
    if found is None and other is not None:
        source.refuse(f"is {other}, which is not read; export the spectrum as text or JCAMP-DX")
    return found


def read_raw(source: Source, kind: Format, options: ReadOptions) -> RawSpectrum:
    """The spectrum of a file, or the one of several that is asked for."""
    try:
        with np.errstate(all="ignore"):  # what is not finite is refused or left out later
            spectra = kind.read(source)
    except (ConfigurationError, MissingExtraError):
        raise
    # readers of binary formats go beyond the end of a damaged file in many ways
    except (ArithmeticError, LookupError, OSError, TypeError, ValueError, struct.error) as error:
        said = one_line(str(error))[:100]
        raise ConfigurationError(
            f"{source.path}: is damaged and cannot be read as {kind.name}: {said}"
        ) from None
    return _choose(source, spectra, options)


def _choose(source: Source, spectra: list[RawSpectrum], options: ReadOptions) -> RawSpectrum:
    fit = [one for one in spectra if readable(one)]
    if options.quantity is not None:
        fit = [one for one in fit if shows(one, options.quantity)] or fit
    if options.spectrum is not None:
        return _choose_spectrum(source, spectra, options.spectrum)
    if len(spectra) == 1:
        return spectra[0]
    if not fit:
        names = sorted({f"{one.ordinate_name} over {one.abscissa_name}" for one in spectra})
        source.refuse(
            f"holds {len(spectra)} spectra, none of transmittance or reflectance: "
            f"{', '.join(names)[:100]}"
        )
    if len(fit) > 1:
        source.refuse(
            f'holds {len(fit)} spectra; choose one with --spectrum (spectrum="1"): '
            f"{_list_names(spectra, fit)}"
        )
    return fit[0]


def _list_names(spectra: list[RawSpectrum], fit: list[RawSpectrum]) -> str:
    names = [
        f"{number} {one.ordinate_name} of {one.metadata.sample[:_TITLE] or 'no title'}"
        for number, one in enumerate(spectra, start=1)
        if any(one is other for other in fit)
    ]
    bare = [name.partition(" ")[2] for name in names]
    for place, one in enumerate(fit) if len(set(bare)) < len(bare) else ():
        x, y = one.abscissa, one.ordinate  # what tells apart those of one name
        names[place] += (
            f" ({len(y)} points from {x[0]:.5g} to {x[-1]:.5g}, {y.min():.3g} to {y.max():.3g})"
        )
    more = f", and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
    return ", ".join(names[:_LISTED]) + more


def _choose_spectrum(source: Source, spectra: list[RawSpectrum], spectrum: str) -> RawSpectrum:
    """The spectrum of this number or title."""
    if spectrum.isascii() and spectrum.isdigit() and 1 <= int(spectrum[:9]) <= len(spectra):
        return spectra[int(spectrum[:9]) - 1]
    titled = [one for one in spectra if one.metadata.sample == spectrum.strip()]
    if len(titled) != 1:
        source.refuse(
            f'has {len(titled)} spectra "{spectrum[:40]}"; it holds {_list_names(spectra, spectra)}'
        )
    return titled[0]
