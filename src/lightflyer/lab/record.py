"""The NetCDF record of a measurement."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import lightflyer

if TYPE_CHECKING:
    import xarray as xr


def joint_warnings(found: Sequence[tuple[str, Sequence[str]]]) -> list[str]:
    """Warnings of several files.

    Examples
    --------
    >>> joint_warnings([("a.csv", ["no accuracy"]), ("b.csv", ["no accuracy", "skewed"])])
    ['b.csv: skewed', 'no accuracy']
    """
    shared = [text for text in found[0][1] if all(text in texts for _, texts in found)]
    own = [
        text if text.startswith(name) else f"{name}: {text}"
        for name, texts in found
        for text in texts
        if text not in shared
    ]
    return own + shared


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
