"""The NetCDF record of a measurement."""

import io
from collections.abc import Mapping, Sequence
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import lightflyer
from lightflyer.core.errors import ConfigurationError

if TYPE_CHECKING:
    import xarray as xr


class Doubt(str):
    """A warning of a number that ``--update`` writes on demand only."""


def require_no_doubt(path: Path, warnings: Sequence[str], *, insist: bool) -> None:
    """Refuse to write into a flyer file what is in doubt, unless the user insists."""
    for text in () if insist else warnings:
        if isinstance(text, Doubt):
            raise ConfigurationError(
                f"{text}; --insist writes it all the same; {path} is unchanged"
            )


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
