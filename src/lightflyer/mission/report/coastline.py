"""Coastlines of the world, coarse enough for a figure."""

from functools import cache

import numpy as np

from lightflyer.files.table import shipped_table


@cache
def coastline() -> tuple[np.ndarray, np.ndarray]:
    """Coastlines as one line with gaps [deg], shape (n,); -180 to 180; NaN between two lines."""
    # Source: [NaturalEarth]_, physical vectors, 1:110 million.
    rows = shipped_table("coastline.csv").numbers
    gaps = np.flatnonzero(np.diff(rows["line"])) + 1
    return np.insert(rows["longitude"], gaps, np.nan), np.insert(rows["latitude"], gaps, np.nan)
