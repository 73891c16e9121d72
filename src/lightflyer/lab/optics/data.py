r"""A sample, its spectra and the numbers to be fitted, from a sample file.

Measured Ψ and Δ are three ordinates that have no jumps,

.. math:: N = \cos 2\Psi,\qquad C = \sin 2\Psi\cos\Delta,\qquad S = \sin 2\Psi\sin\Delta

with :math:`r_p/r_s=\tan\Psi\,e^{i\Delta}`. They are fitted as transmittance and reflectance are.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
import pydantic
from pydantic import Field, ValidationInfo

from lightflyer.array.namespace import Numeric
from lightflyer.array.records import ShortRepr
from lightflyer.core.checks import require_range
from lightflyer.core.entry_point import reads_units
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import RADIANS_PER_DEGREE, Fraction, Incidence, Length, Quantity
from lightflyer.core.units import Measured
from lightflyer.files.section import Section
from lightflyer.files.table import read_table
from lightflyer.files.table_layout import Column
from lightflyer.files.toml_file import FileKind, file_beside, place_of, read_file
from lightflyer.film.layer_section import LayerSection
from lightflyer.film.layered_section import SampleSection
from lightflyer.film.optics.stack import GRAZING, Film, Side
from lightflyer.lab.readers.formats import Ordinate
from lightflyer.lab.readers.interpretation import MeasuredSpectrum
from lightflyer.lab.readers.spectrum_data import AXES, COLUMNS, read_spectrum
from lightflyer.lab.result import require_distinct

ORDINATES: tuple[Literal["N", "C", "S"], ...] = ("N", "C", "S")

_GRAZING = 90.0
_ANGLE = Quantity("deg", 0.0, 90.0)
_COLUMNS = (
    *(column for column in COLUMNS if column.name in AXES),
    Column("psi", _ANGLE, ("Ψ",), required=True, suggested_unit="deg"),
    Column("delta", Quantity("deg", -360.0, 360.0), ("Δ",), required=True, suggested_unit="deg"),
    Column("incidence", _ANGLE, ("angle", "aoi", "angle_of_incidence"), suggested_unit="deg"),
)
_ANGLES = ("psi", "delta", "incidence")
_DEGREES = [replace(one, assumed_unit="deg") if one.name in _ANGLES else one for one in _COLUMNS]
_RADIANS = 1.58  # no Ψ is above it where radians are written

Polarisation = Literal["s", "p", "none"]

DEFAULT_SCALE_ACCURACY = 0.01
"""Relative standard uncertainty of an ordinate's scale where none is stated [1]: an assumption, as
in :data:`lightflyer.lab.ftir.reduction.DEFAULT_ACCURACY`."""

DEFAULT_ZERO_ACCURACY = 0.002
"""Standard uncertainty of an ordinate's zero where none is stated [1]: an assumption."""

_WIDEST = 4.0  # bounds of a positive number without any, as a factor either side of its start
_PORES = 0.9  # Largest porosity tried where no bound is given: a film with more is foam

_LEAST_ACCURATE = 0.5  # a spectrum that is off by more than half of full scale measures nothing
_Accuracy = Annotated[Numeric, Quantity("", 0.0, _LEAST_ACCURATE)]
_SHARES = ("porosity", "porosity_bottom", "fraction", "fraction_bottom", "open_fraction")
_OPTICAL = ("layers.", "substrate.", "ambient.", "roughness_bottom", "open_fraction")
_FIXED = ("density", "tac", "grain", "at", "hole_diameter", "tac_top", "tac_bottom")


class MeasuredFile(Section):
    """What all entries of measured files have."""

    file: str
    columns: str | None = None
    side: Side = "top"
    shortest: Length | None = None
    longest: Length | None = None

    @pydantic.field_validator("file")
    @classmethod
    def _beside(cls, name: str, info: ValidationInfo) -> str:
        path = file_beside(name, info)
        if not Path(path).is_file():
            raise ConfigurationError("there is no such file")
        return path

    def within(self, found: MeasuredSpectrum) -> MeasuredSpectrum:
        """The points between ``shortest`` and ``longest``."""
        shortest = 0.0 if self.shortest is None else self.shortest.value
        longest = np.inf if self.longest is None else self.longest.value
        if len(found.value) < 2:
            raise ConfigurationError(f"{self.file}: has one point; a spectrum needs two or more")
        inside = (found.wavelength >= shortest) & (found.wavelength <= longest)
        if np.count_nonzero(inside) < 2:
            ends = 1e9 * found.wavelength[[-1, 0]]
            raise ConfigurationError(
                f"{self.file}: has no points between shortest and longest; its data extend from "
                f"{ends[0]:.5g} to {ends[1]:.5g} nm"
            )
        return replace(found, wavenumber=found.wavenumber[inside], value=found.value[inside])


class EllipsometrySection(MeasuredFile):
    """An entry of ``ellipsometry``."""

    incidence: Incidence | None = None
    #: Standard uncertainty that all points of N, of C and of S have in common [1]; the default is
    #: an assumption, 0.06° of Ψ
    accuracy: Fraction = Measured(0.002)
    #: What instruments make of Δ: a rotating analyser knows its cosine only and shows it within
    #: 0 to 180°, which leaves S out; others count it in the other direction, which turns S
    delta: Literal["full", "folded", "reversed"] = "full"

    def read(self) -> Iterator[tuple[MeasuredSpectrum, float]]:
        """Spectra of N, C and S with their incidence [rad], for each one in the file."""
        try:
            table = read_table(self.file, _COLUMNS, layout=self.columns)
        except ConfigurationError as error:
            if "has no unit" not in str(error):
                raise
            # angles whose header names no unit are in degrees
            table = read_table(self.file, _DEGREES, layout=self.columns)
            if table.numbers["psi"].max() <= _RADIANS:
                raise ConfigurationError(
                    f"{self.file}: no Ψ is above {_RADIANS:g}, which looks like radians; name the "
                    'unit in the header, "psi [rad]" or "psi [deg]"'
                ) from None
        angles = table.numbers.get("incidence")
        if angles is not None and self.incidence is not None:
            raise ConfigurationError(f"{self.file}: has a column incidence; leave incidence out")
        if angles is None:
            if self.incidence is None:
                raise ConfigurationError(
                    f'{self.file}: has no column incidence; write incidence = "70 deg"'
                )
            angles = np.full(len(table), self.incidence.value)
        axes = [name for name in AXES if name in table.numbers]
        if len(axes) != 1:
            raise ConfigurationError(f"{self.file}: needs one column of {', '.join(AXES)}")
        wavenumber = AXES[axes[0]](table.numbers[axes[0]])
        double, delta = (
            factor * RADIANS_PER_DEGREE * table.numbers[name]
            for name, factor in (("psi", 2.0), ("delta", 1.0))
        )
        sign = -1.0 if self.delta == "reversed" else 1.0
        sine = sign * np.sin(double) * np.sin(delta)
        values = np.cos(double), np.sin(double) * np.cos(delta), sine
        for angle in np.unique(angles):
            if not 0.0 < angle < _GRAZING:
                raise ConfigurationError(
                    f"{self.file}: incidence = {angle:g} deg must be above 0 and below 90 deg; at "
                    "normal incidence Ψ and Δ carry no information"
                )
            here = np.flatnonzero(angles == angle)
            here = here[np.argsort(wavenumber[here])]
            if np.any(np.diff(wavenumber[here]) == 0.0):
                raise ConfigurationError(
                    f"{self.file}: has a wavelength twice at {angle:g} deg; the column incidence "
                    "tells angles apart"
                )
            shown = ORDINATES[: 2 if self.delta == "folded" else 3]
            for name, value in zip(shown, values, strict=False):
                is_first = name == ORDINATES[0] and angle == angles.min()
                rejected = tuple(table.rejected) if is_first else ()
                spectrum = MeasuredSpectrum(
                    self.file, name, wavenumber[here], value[here], rejected
                )
                yield self.within(spectrum), float(angle) * RADIANS_PER_DEGREE


@dataclass(frozen=True)
class FreeNumber:
    """A number of a film that spectra are to tell."""

    name: str
    start: float  # First value and bounds
    lowest: float  # First value and bounds
    highest: float  # First value and bounds
    unit: str = ""  # SI unit
    # Standard uncertainty of ``start``, known before the spectra; None where nothing is known
    prior: float | None = None

    def __post_init__(self) -> None:
        if not self.lowest < self.highest:
            raise ParameterError(f"{self.name}: lowest must be below highest")
        if not self.lowest <= self.start <= self.highest:
            raise ParameterError(
                f"{self.name} = {self.start:g} must be from {self.lowest:g} to {self.highest:g}"
            )
        if self.prior is not None and not self.prior > 0.0:
            raise ParameterError(f"{self.name}: its uncertainty must be above zero")


@dataclass(frozen=True)
class FilmSpectrum:
    """A measured spectrum of a film, and how it was measured."""

    spectrum: MeasuredSpectrum
    incidence: float = 0.0  # Angle between the light and the film's normal [rad]
    polarisation: Polarisation = "none"
    side: Side = "top"  # Where the light comes from
    # Relative standard uncertainty of the ordinate's scale [1]; None where none is stated
    scale_accuracy: float | None = None
    # Standard uncertainty of the ordinate's zero [1]; None where none is stated
    zero_accuracy: float | None = None

    def __post_init__(self) -> None:
        require_range("incidence", self.incidence, 0.0, GRAZING)
        for name in ("scale_accuracy", "zero_accuracy"):
            require_range(name, getattr(self, name), 0.0, _LEAST_ACCURATE)

    @property
    def errors(self) -> tuple[float, float]:
        """Standard uncertainties of scale and zero, the assumed ones where none are stated."""
        return (
            DEFAULT_SCALE_ACCURACY if self.scale_accuracy is None else self.scale_accuracy,
            DEFAULT_ZERO_ACCURACY if self.zero_accuracy is None else self.zero_accuracy,
        )

    @property
    def accuracy(self) -> float:
        """Standard uncertainty of a mean over its points, by scale and zero [1]."""
        scale, zero = self.errors
        return float(np.hypot(scale * np.sqrt(np.mean(self.spectrum.value**2)), zero))

    @property
    def where(self) -> tuple[str, float]:
        """File and incidence [rad], which N, C and S of one measurement have in common."""
        return self.spectrum.source, self.incidence

    @property
    def label(self) -> str:
        """Quantity and file in words."""
        angle = self.incidence / RADIANS_PER_DEGREE
        at = f" at {angle:.4g}°" if self.spectrum.quantity in ORDINATES else ""
        return f"{self.spectrum.quantity}{at}, {Path(self.spectrum.source).name}"


@dataclass(frozen=True)
class OpticsSample(ShortRepr):
    """A film with numbers to be fitted, and its spectra."""

    #: Makes the film from the free numbers by name, which may be traced by JAX
    build: Callable[[Mapping[str, Any]], Film]
    free: tuple[FreeNumber, ...]
    spectra: tuple[FilmSpectrum, ...]
    section: SampleSection | None = None  #: The film as a file gives it
    source: str = ""  #: Name of the file
    #: Names of all numbers that a free one stands for, its own first
    same: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


class FreeSection(Section):
    """An entry of ``free``: a number of ``[film]``, with bounds, and others that equal it."""

    number: str
    lowest: str | float | None = None
    highest: str | float | None = None
    same: tuple[str, ...] = ()


class SpectrumSection(MeasuredFile):
    """An entry of ``spectra``."""

    ordinate: Ordinate | None = None
    scale: Literal["%", "1"] | None = None
    spectrum: str | None = None
    collection: Literal["specular", "diffuse", "total"] | None = None
    incidence: Incidence = Measured(0.0)
    polarisation: Polarisation = "none"
    scale_accuracy: _Accuracy | None = None
    zero_accuracy: _Accuracy | None = None


class SampleFile(Section):
    """A sample file: ``[film]``, ``free``, and ``spectra`` or ``ellipsometry``."""

    free: Annotated[tuple[FreeSection, ...], Field(min_length=1)]
    spectra: tuple[SpectrumSection, ...] = ()
    ellipsometry: tuple[EllipsometrySection, ...] = ()
    film: SampleSection

    @pydantic.model_validator(mode="after")
    def _measured(self) -> "SampleFile":
        if not (self.spectra or self.ellipsometry):
            raise ConfigurationError(
                "there is nothing measured: give [[spectra]] or [[ellipsometry]]"
            )
        return self

    def read(self) -> Iterator[FilmSpectrum]:
        """Everything measured."""
        for one in self.spectra:
            found = read_spectrum(
                one.file, columns=one.columns, quantity=one.ordinate, scale=one.scale,
                spectrum=one.spectrum, collection=one.collection,
            )  # fmt: skip
            stated = (None if accuracy is None else float(accuracy.value)
                      for accuracy in (one.scale_accuracy, one.zero_accuracy))  # fmt: skip
            incidence = float(one.incidence.value) * RADIANS_PER_DEGREE
            yield FilmSpectrum(one.within(found), incidence, one.polarisation, one.side, *stated)
        for angles in self.ellipsometry:
            for spectrum, incidence in angles.read():
                accuracy = float(angles.accuracy.value)
                yield FilmSpectrum(spectrum, incidence, "none", angles.side, 0.0, accuracy)


def _keys_of(section: str, document: Any) -> list[str]:  # noqa: ARG001
    parts = [part for part in section.split(".") if not part.isdigit()]
    kinds: dict[tuple[str, ...], type[Section]] = {
        (): SampleFile, ("free",): FreeSection, ("spectra",): SpectrumSection,
        ("ellipsometry",): EllipsometrySection,
        ("film",): SampleSection, ("film", "layers"): LayerSection,
    }  # fmt: skip
    kind = kinds.get(tuple(part for part in parts if part))
    return [] if kind is None else list(kind.model_fields)


SAMPLE_FILE = FileKind(
    "a sample file", _keys_of, "'lightflyer lab example optics' writes one",
    lambda document: "" if not {"flyer", "environment"} & document.keys() else
    "a flyer file; a sample file has [film], free and spectra, as docs/lab-optics.md shows",
)  # fmt: skip


@reads_units
def read_sample(path: str | Path) -> OpticsSample:
    """Read a sample file and the spectra that it names.

    Parameters
    ----------
    path : str or path
        TOML with ``[film]``, the numbers in it that are ``free``, and ``spectra``.

    Returns
    -------
    OpticsSample

    Raises
    ------
    ConfigurationError
        One line for each mistake: file, line, key, value and what is allowed.
    """
    path = Path(path)
    file, text = read_file(SampleFile, path, SAMPLE_FILE)
    try:
        free, same = _free_numbers(file)
    except ConfigurationError as error:
        raise ConfigurationError(f"{place_of(['free'], text, path)}: free: {error}") from None
    section = file.film

    def build(values: Mapping[str, Any]) -> Film:
        full = {alias: value for name, value in values.items() for alias in same[name]}
        changed = section.with_values(full)
        assert isinstance(changed, SampleSection)
        return changed.film()

    spectra = tuple(file.read())
    measured = (one.spectrum for one in spectra)
    require_distinct([(one.source, (one.wavenumber, one.value)) for one in measured])
    sample = OpticsSample(build, free, spectra, section, str(path), same)
    try:
        build({one.name: one.start for one in free})
    except ParameterError as error:
        raise ConfigurationError(f"{path}: {error}") from None
    return sample


def _free_numbers(file: SampleFile) -> tuple[tuple[FreeNumber, ...], dict[str, tuple[str, ...]]]:
    # Numbers of optics with ± that are not asked for are free too, within what is known of them.
    known = {name: (kind, value) for name, kind, value in file.film.numbers()}
    given = [name for name, (_, value) in known.items() if value is not None]

    def why_not(name: str) -> str | None:
        if name.rpartition(".")[2] in _FIXED or not name.startswith(_OPTICAL):
            return "does not change reflectance and transmittance"
        return file.film.reason_not_varied(name)

    free, same = [], {}
    taken: set[str] = set()
    for entry in file.free:
        for name in (entry.number, *entry.same):
            if name not in given:
                fit = ", ".join(key for key in given if why_not(key) is None) or "none"
                raise ConfigurationError(
                    f"{name} is not a number that [film] gives; it gives {fit}"
                )
            if reason := why_not(name):
                raise ConfigurationError(f"{name} {reason}")
            if name in taken:
                raise ConfigurationError(f"{name} is named twice")
            taken.add(name)
        free.append(_free_number(entry, *known[entry.number]))
        same[entry.number] = (entry.number, *entry.same)
    for name, (kind, value) in known.items():
        uncertain = value is not None and bool(value.uncertainty)
        if uncertain and name not in taken and why_not(name) is None:
            free.append(_free_number(FreeSection(number=name), kind, value))
            same[name] = (name,)
    return tuple(free), same


def _free_number(entry: FreeSection, kind: Quantity, value: Measured | None) -> FreeNumber:
    assert value is not None  # as checked
    name, start = entry.number, float(value.value)
    last = name.rpartition(".")[2]
    # bounds of a number that states none: all that is possible of a share, else a factor
    if last in _SHARES:
        ends = kind.lowest, max(_PORES, start)
    elif last in ("roughness", "roughness_bottom", "gap"):
        ends = kind.lowest, max(_WIDEST * start, kind.lowest)
    elif start == 0.0:
        raise ConfigurationError(f"{name} = 0 needs bounds: lowest and highest")
    else:
        ends = start / _WIDEST, min(_WIDEST * start, kind.highest)
        ends = ends if start > 0.0 else (_WIDEST * start, start / _WIDEST)
    bounds = []
    for end, text in zip(ends, (entry.lowest, entry.highest), strict=True):
        try:
            bounds.append(float(end if text is None else kind.read(text).value))
        except ConfigurationError as error:
            raise ConfigurationError(f"bound of {name}: {text}: {error}") from None
    low, high = bounds
    if not low < high:
        raise ConfigurationError(f"{name}: lowest must be below highest")
    if not low <= start <= high:
        raise ConfigurationError(
            f"{name} = {start:g} {kind.unit} in [film] must be from lowest to highest"
        )
    return FreeNumber(name, start, low, high, kind.unit, value.uncertainty or None)


def names_of_layers(section: SampleSection) -> dict[str, str]:
    """What each layer of a section is made of, by the first part of its numbers' names."""
    layers: Sequence[LayerSection] = section.layers
    found = {f"layers.{number}": layer.label for number, layer in enumerate(layers)}
    if section.substrate is not None:
        found["substrate"] = section.substrate.label
    if section.ambient is not None:
        found["ambient"] = section.ambient.label
    return found
