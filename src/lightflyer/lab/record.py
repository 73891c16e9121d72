"""What all measurements share: doubts and likely numbers, the NetCDF record, distinct data."""

import io
from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np

import lightflyer
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.errors import Doubt as Doubt
from lightflyer.core.quantity import Quantity

if TYPE_CHECKING:
    import xarray as xr

LABORATORY = Quantity(
    "K", likely=(280.0, 315.0), known="chambers stand in laboratories, unless they are cooled"
)
"""Temperature of the surroundings."""

EMISSIVITY = Quantity(
    likely=(5e-3, 0.98), known="polished gold has 0.02, black paint and skin have 0.95 to 0.98"
)
"""Emissivity of a film in the infrared."""

ABSORPTANCE = Quantity(
    likely=(1e-3, 0.99), known="black paint absorbs 0.97, all but forests of nanotubes less"
)
"""Absorptance of a film for visible light."""

AREA_RATIO = Quantity(likely=(0.5, 2.0), known="films cover a heater and not much else")
"""Effective over nominal area of a heater; [Lu2023]_ has 1.22."""

_NOT_LOGGED = 273.15  # [K]: what loggers write of an input that nothing is connected to


def joint_warnings(found: Sequence[tuple[str, Sequence[str]]]) -> list[str]:
    """Warnings of several files."""
    shared = [text for text in found[0][1] if all(text in texts for _, texts in found)]
    own = [
        text if text.startswith(name) else type(text)(f"{name}: {text}")
        for name, texts in found
        for text in texts
        if text not in shared
    ]
    return own + shared


def require_distinct(measured: Sequence[tuple[str, Any]]) -> None:
    """Refuse the same data twice, which would count as a repeat; names, and arrays (n,)."""
    for (first, one), (second, other) in combinations(measured, 2):
        if np.array_equal(one, other, equal_nan=True):
            raise ConfigurationError(
                f"{second}: has the same data as {first}; each measurement may be given once"
            )


def csv_text(comments: Sequence[str], columns: Mapping[str, np.ndarray]) -> str:
    """Columns of numbers as a table of commas, by their headings; arrays of shape (n,)."""
    text = io.StringIO()
    text.write("\n".join([*comments, ",".join(columns)]) + "\n")
    np.savetxt(text, np.column_stack(list(columns.values())), delimiter=",", fmt="%.8g")
    return text.getvalue()


def dataset(
    title: str,
    variables: Mapping[str, Any],
    files: Sequence[str],
    *,
    warnings: Sequence[str] = (),
    **attributes: Any,
) -> "xr.Dataset":
    """Dataset with its title, its input files and the package's version."""
    import xarray as xr

    return xr.Dataset(
        dict(variables),
        attrs={
            "title": f"lightflyer lab: {title}",
            "lightflyer_version": lightflyer.__version__,
            "files": ", ".join(files),
            "warnings": "; ".join(warnings),
            **attributes,
        },
    )


def doubts_of(name: str, quantity: Quantity, value: float, hint: str = "") -> list[Doubt]:
    """A line where a value is not likely; ``hint``: what may be the reason."""
    why = quantity.unlikely(value)
    return [Doubt(f"{name} {why}{'; ' * bool(hint)}{hint}")] if why else []


def ambient_doubts(temperature: np.ndarray) -> list[Doubt]:
    """A line about surroundings colder or warmer than a laboratory; ``temperature`` (n,) [K]."""
    middle = float(np.median(temperature))
    unlogged = abs(middle - _NOT_LOGGED) < 1e-6
    hint = "0 °C is what loggers write where no sensor is connected" if unlogged else ""
    return doubts_of("ambient_temperature", LABORATORY, middle, hint)
