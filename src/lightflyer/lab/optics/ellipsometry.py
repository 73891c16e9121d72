r"""Measured Ψ and Δ as three ordinates that have no jumps.

.. math:: N = \cos 2\Psi,\qquad C = \sin 2\Psi\cos\Delta,\qquad S = \sin 2\Psi\sin\Delta

with :math:`r_p/r_s=\tan\Psi\,e^{i\Delta}`. They are fitted as transmittance and reflectance are.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
import pydantic
from pydantic import ValidationInfo

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import RADIANS_PER_DEGREE, Fraction, Incidence, Length, Quantity
from lightflyer.core.units import Measured
from lightflyer.files.section import Section
from lightflyer.files.table import read_table
from lightflyer.files.table_layout import Column
from lightflyer.files.toml_file import file_beside
from lightflyer.film.optics.stack import Side
from lightflyer.lab.readers.interpretation import MeasuredSpectrum
from lightflyer.lab.readers.spectrum_data import AXES, COLUMNS

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
