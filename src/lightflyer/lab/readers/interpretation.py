"""From a spectrum as it stands in its file to transmittance or reflectance over wavenumber."""

import re
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple, get_args

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.core.errors import ParameterError
from lightflyer.core.quantity import Quantity
from lightflyer.files.table_rows import Rejected
from lightflyer.lab.readers.formats import (
    WORDS,
    Collection,
    Ordinate,
    RawSpectrum,
    Source,
    SpectrumMetadata,
)

PER_CENTIMETRE = 100.0  # One reciprocal centimetre [1/m]

_WAVELENGTHS = {"nm": 1e-9, "um": 1e-6}  # [m]
_AXIS = re.compile(r"^(?:wave(?:number|length)s?)?[\[(/]?(.*?)[\])]?$")

_QUANTITIES = {word: name for name, words in WORDS["ordinates"].items() for word in words}

# wider than zero to one for noise, and for detectors that are not quite linear
SHARE = Quantity("", -0.2, 1.5)  # Transmittance and reflectance that a file may hold
_PERCENT = 100.0
_EMPTY = 1e-30  # of an ordinate: JASCO marks points without a value by ∓1.2e-38
_DARK = 1.5  # per cent, nowhere exceeded if a fraction is taken for a percentage
_KEPT = 2 / 3  # share of the points that is left without its ends, at least
_LEAST_KEPT = 20
_MOSTLY = 0.5  # share of the points above any fraction, from which an ordinate is in per cent
_NO_METADATA = SpectrumMetadata("")


class Axis(NamedTuple):
    """Unit of an abscissa."""

    scale: float  # To 1/m or m
    is_wavelength: bool


class OrdinateUnit(NamedTuple):
    """Quantity of an ordinate."""

    # ``"transmittance"``, ``"reflectance"``, ``"absorbance"``, ``"log(1/R)"``, or empty where the
    # name tells none
    quantity: str
    percent: bool  # Whether the name says per cent


def axis_of(name: str) -> Axis | None:
    """Unit that the name of an abscissa states."""
    text = re.sub(r"\s+", "", name.casefold()).replace("µ", "u").replace("μ", "u")
    match = _AXIS.match(text)
    inner = match[1] if match else text
    for unit, names in WORDS["axes"].items():
        if text in names or inner in names:
            scale = _WAVELENGTHS.get(unit)
            return Axis(scale or PER_CENTIMETRE, is_wavelength=scale is not None)
    return None


def parse_ordinate(name: str) -> OrdinateUnit | str:
    """Quantity that the name of an ordinate states."""
    text = " ".join(name.casefold().split())
    percent = "%" in text or "percent" in text or "per cent" in text
    core = re.sub(r"per ?cent(?:age)?|%|\bunits?\b", "", text)
    core = re.sub(r"[\s_]+|\[\s*\]|\(\s*\)|[\[(]a\.?u\.?[\])]", "", core).strip("-.:,;/")
    core = core[1:-1] if core.startswith("(") and core.endswith(")") else core
    quantity = _QUANTITIES.get(core)
    if quantity is not None:
        return OrdinateUnit(quantity, percent)
    for pattern, what in WORDS["refused"].items():
        if re.search(pattern, text):
            return f"shows {what}"
    return f'shows "{name[:40]}", which is not known as transmittance, reflectance or absorbance'


@dataclass(frozen=True)
class MeasuredSpectrum(ShortRepr):
    """Transmittance or reflectance over wavenumber."""

    source: str  #: Name of the file
    quantity: Ordinate | Literal["N", "C", "S"]  #: The last three of an ellipsometer
    wavenumber: np.ndarray  #: shape (n,); increasing [1/m]
    value: np.ndarray  #: shape (n,); [1]
    rejected: tuple[Rejected, ...] = ()  #: Rejected rows of its file
    #: What the file says of instrument, resolution and sample
    metadata: SpectrumMetadata = _NO_METADATA
    #: Light that was collected, by the file or the user; None if neither says
    collection: Collection | None = None
    notes: tuple[str, ...] = ()  #: What the reader decided, such as that values are per cent

    @property
    def wavelength(self) -> np.ndarray:
        """Wavelength in vacuum, decreasing, shape (n,) [m]."""
        return 1.0 / self.wavenumber


class ReadOptions(NamedTuple):
    """What the user says of a file."""

    # What the ordinate shows where its name does not say, and the one to choose of several
    quantity: Ordinate | None = None
    # Whether the values are per cent or fractions, against name and values
    scale: str | None = None
    spectrum: str | None = None  # Number, counted from 1, or title of one of several spectra
    collection: Collection | None = None

    def check(self) -> None:
        """Raise ParameterError if an entry is unknown."""
        for name, value, allowed in (
            ("quantity", self.quantity, get_args(Ordinate)),
            ("scale", self.scale, ("%", "1")),
            ("collection", self.collection, get_args(Collection)),
        ):
            if value is not None and value not in allowed:
                raise ParameterError(f'{name} "{value}" is not one of {", ".join(allowed)}')


def interpret_spectrum(source: Source, raw: RawSpectrum, options: ReadOptions) -> MeasuredSpectrum:
    """The spectrum in SI units, with what was decided on the way."""
    notes = list(raw.notes)
    shown = parse_ordinate(raw.ordinate_name)
    if isinstance(shown, str):
        source.refuse(shown)
    known = shown.percent or options.scale is not None  # that it is a share of light
    if not shown.quantity and (options.quantity is None or not known):
        said = f' but "{raw.ordinate_name}"' if raw.ordinate_name else ""
        source.refuse(
            f"does not name its ordinate{said}; if it is transmittance or reflectance, say which "
            '(quantity="reflectance"), and --scale % or --scale 1 (scale="%" or "1")'
        )
    if shown.quantity == "absorbance" and options.quantity is None and _collection_of(raw.metadata):
        source.refuse(
            f'shows absorbance, measured with "{raw.metadata.accessory[:60]}": say whether it is '
            'that of transmittance or reflectance (quantity="reflectance")'
        )
    if options.quantity is not None and not shows(raw, options.quantity):
        source.refuse(f"shows {shown.quantity}, not {options.quantity}")
    wavenumber, ordinate = _points(source, raw, notes)
    absorbance = shown.quantity == "absorbance"
    mirror = shown.quantity in ("reflectance", "log(1/R)")
    quantity = options.quantity or ("reflectance" if mirror else "transmittance")
    if absorbance and options.quantity is None:
        notes.append("absorbance is taken as log10(1/T), of transmittance")
    elif absorbance and quantity == "reflectance":
        notes.append("absorbance is taken as log10(1/R): it is said to be of reflectance")
    with np.errstate(over="ignore"):
        if shown.quantity in ("absorbance", "log(1/R)"):
            value = 10.0**-ordinate
            if options.scale is not None:
                notes.append(f"the scale {options.scale} is not used: the file shows absorbance")
        else:
            value = _fraction(source, ordinate, raw, shown, options, notes)
    wavenumber, value = _possible(source, quantity, wavenumber, value, notes)
    metadata = replace(raw.metadata, ordinate=raw.ordinate_name)
    collected, accessory = _collection_of(metadata), f'"{metadata.accessory[:60]}"'
    if absorbance and quantity == "transmittance" and collected:
        notes.append(
            f"absorbance is taken as that of transmittance, but its accessory {accessory} is one "
            "for reflectance"
        )
    elif quantity == "reflectance" and collected == "total" and options.collection is None:
        notes.append(
            f"its accessory {accessory} is taken to collect all light; with an open specular port "
            "it collects the diffuse part only"
        )
    collection = options.collection or collected
    distinct, place, count = np.unique(wavenumber, return_inverse=True, return_counts=True)
    if distinct.size < 2:
        source.refuse(f"has {distinct.size} wavenumber; a spectrum needs two or more")
    mean = np.bincount(place, value) / count
    if distinct.size < value.size:
        notes.append(f"{value.size} points have {distinct.size} wavenumbers; each has their mean")
    return MeasuredSpectrum(
        str(source.path), quantity, distinct, mean, raw.rejected, metadata, collection, tuple(notes)
    )


def readable(raw: RawSpectrum) -> bool:
    """Whether transmittance or reflectance may follow from a spectrum."""
    return (
        isinstance(parse_ordinate(raw.ordinate_name), OrdinateUnit)
        and axis_of(raw.abscissa_name) is not None
    )


def shows(raw: RawSpectrum, quantity: Ordinate) -> bool:
    """Whether a spectrum may show this quantity."""
    shown = parse_ordinate(raw.ordinate_name)
    if isinstance(shown, str):
        return False
    return shown.quantity in (quantity, "", "absorbance") or (
        quantity == "reflectance" and shown.quantity == "log(1/R)"
    )


def _points(source: Source, raw: RawSpectrum, notes: list[str]) -> tuple[np.ndarray, np.ndarray]:
    """Wavenumber [1/m] and ordinate of the points that have a value."""
    axis = axis_of(raw.abscissa_name)
    if axis is None:
        source.refuse(
            f'its abscissa "{raw.abscissa_name[:40]}" is not known as wavenumber [1/cm] or '
            "wavelength [nm, um]"
        )
    x, y = np.asarray(raw.abscissa, float), np.asarray(raw.ordinate, float)
    if x.shape != y.shape or not np.isfinite(x).all() or (x <= 0.0).any():
        source.refuse("is damaged: its abscissa is not a positive number for every point")
    empty = ~np.isfinite(y) | ((y != 0.0) & (np.abs(y) < _EMPTY))
    if empty.any():
        if empty.mean() > _MOSTLY:
            source.refuse(f"{np.count_nonzero(empty)} of its {y.size} points have no value")
        ends = np.sort(x[empty])[[0, -1]]
        notes.append(
            f"{np.count_nonzero(empty)} points without a value, between {ends[0]:g} and "
            f"{ends[1]:g} {raw.abscissa_name}, are left out"
        )
        x, y = x[~empty], y[~empty]
    with np.errstate(over="ignore", divide="ignore"):
        wavenumber = 1.0 / (x * axis.scale) if axis.is_wavelength else x * axis.scale
    if not np.isfinite(wavenumber).all():
        source.refuse("is damaged: an abscissa is zero or too large")
    return wavenumber, y


def _fraction(
    source: Source,
    ordinate: np.ndarray,
    raw: RawSpectrum,
    shown: OrdinateUnit,
    options: ReadOptions,
    notes: list[str],
) -> np.ndarray:
    """Values as fractions, by the user's word, the format, the name, or the values themselves."""
    if options.scale is not None:
        return ordinate / _PERCENT if options.scale == "%" else ordinate
    percent = shown.percent if raw.percent is None else raw.percent
    highest = float(ordinate.max(initial=-np.inf))
    if percent:
        if highest < _DARK:
            notes.append(
                f"its values are nowhere above {highest:.2f} %; if the file holds fractions, not "
                'per cent, say --scale 1 (scale="1")'
            )
        return ordinate / _PERCENT
    if highest <= SHARE.highest or raw.percent is False:
        return ordinate
    beyond = float(np.mean(ordinate > SHARE.highest))
    if beyond < _MOSTLY:
        source.refuse(
            f"{np.count_nonzero(ordinate > SHARE.highest)} of its {ordinate.size} values of "
            f"{raw.ordinate_name or 'an unnamed ordinate'} exceed {SHARE.highest:g} (highest "
            f"{highest:.4g}), and it is not clear that they are per cent: as %, the mean would be "
            f"{ordinate.mean():.3g} %, as fractions {ordinate.mean():.3g}; say --scale % or "
            '--scale 1 (scale="%" or "1")'
        )
    notes.append(
        f"values up to {highest:.4g} are taken as per cent, although they are not marked as %"
    )
    return ordinate / _PERCENT


def _possible(
    source: Source, quantity: Ordinate, wavenumber: np.ndarray, value: np.ndarray, notes: list[str]
) -> tuple[np.ndarray, np.ndarray]:
    # Beyond the range of detector and beam splitter there is no light, and a ratio is noise. What
    # is left holds no impossible value, so that no part of it is chosen by its noise.
    outside = ~((value >= SHARE.lowest) & (value <= SHARE.highest))
    if not outside.any():
        return wavenumber, value
    order = np.argsort(wavenumber)
    edges = np.concatenate([[-1], np.flatnonzero(outside[order]), [len(value)]])
    longest = int(np.argmax(np.diff(edges)))
    first, last = edges[longest] + 1, edges[longest + 1]
    if last - first < _KEPT * len(value) or last - first < _LEAST_KEPT:
        at = int(np.argmax(outside))
        source.refuse(
            f"{quantity} = {value[at]:g} at {wavenumber[at] / PER_CENTIMETRE:g} cm^-1 is not "
            f"{SHARE.allowed}; check its background"
        )
    kept = order[first:last]
    ends = wavenumber[kept[[0, -1]]] / PER_CENTIMETRE
    notes.append(
        f"points outside {ends[0]:.5g} to {ends[1]:.5g} cm^-1 are left out: there, {quantity} "
        f"is as far out as {value[outside][np.argmax(np.abs(value[outside]))]:.3g}"
    )
    return wavenumber[kept], value[kept]


def _collection_of(metadata: SpectrumMetadata) -> Collection | None:
    said = metadata.accessory.casefold()
    known = WORDS["collected"].items()
    return next((light for light, words in known if any(word in said for word in words)), None)
