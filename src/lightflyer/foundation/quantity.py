"""How a field of a flyer file holds a quantity, and what every section shares."""

import math
from dataclasses import dataclass
from typing import Any

import pydantic
from pydantic import ConfigDict
from pydantic_core import CoreSchema, core_schema

from lightflyer.foundation.checks import require_range
from lightflyer.foundation.errors import ConfigurationError, ParameterError
from lightflyer.foundation.units import Measured, parse


@dataclass(frozen=True)
class Quantity:
    """Annotation of a field that holds a number with unit, range and optional uncertainty.

    Attributes
    ----------
    unit : str
        SI unit of the stored value, empty for a pure number.
    lowest, highest : float
        Allowed range.
    open_below : bool
        Whether ``lowest`` itself is excluded.
    """

    unit: str = ""
    lowest: float = -math.inf
    highest: float = math.inf
    open_below: bool = False

    def read(self, value: Any) -> Measured:
        """Parse and check a text or number from the file; a Measured is only checked."""
        measured = value if isinstance(value, Measured) else parse(value, self.unit)
        try:
            require_range("", measured.value, self.lowest, self.highest, open_below=self.open_below)
        except ParameterError as error:
            allowed = str(error).partition(" is not ")[2]
            in_unit = f" {self.unit}" if self.unit and "between" in allowed else ""
            raise ConfigurationError(f"must be {allowed}{in_unit}") from None
        return measured

    def __get_pydantic_core_schema__(
        self, source: Any, handler: pydantic.GetCoreSchemaHandler
    ) -> CoreSchema:
        """Tell Pydantic to read before it checks the type."""
        return core_schema.no_info_before_validator_function(self.read, handler(source))


class Section(pydantic.BaseModel):
    """A section of a flyer file; it takes no key that it does not know."""

    model_config = ConfigDict(extra="forbid", frozen=True)
