"""A file of measured ordinates beside a sample file, and the part of it that is used."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pydantic
from pydantic import ValidationInfo

from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Length
from lightflyer.files.section import Section
from lightflyer.files.toml_file import file_beside
from lightflyer.film.optics.stack import Side
from lightflyer.lab.readers.spectra.interpretation import MeasuredSpectrum


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
