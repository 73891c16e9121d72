"""Where a particle of any shape absorbs light, from a file of a program such as ADDA."""

from pathlib import Path

import numpy as np

from lightflyer.array.records import Module
from lightflyer.core.checks import require_positive
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.core.quantity import Quantity
from lightflyer.files.table import Table, read_table
from lightflyer.files.table_layout import Column

_COLUMNS = (
    *(Column(name, Quantity(), required=True, any_unit=True) for name in "xyz"),
    Column("q", Quantity("", 0.0), ("|E|^2",), required=True, any_unit=True),
)
_ROUNDED = 0.01  # of a grid step: digits that a file leaves out
_IN_A_POINT = (
    0.75  # Asymmetry factor over efficiency, where all is absorbed in one place of the surface
)


class AbsorbedPowers(Module):
    r"""Absorbed power at the points of a cubic grid that fill a particle.

    Only shares count: the unit of positions and of powers is any. The particle stands for the
    sphere of its volume, whose temperature difference drives the force.
    """

    position: np.ndarray  #: shape (points, 3); from the middle of the volume, in grid steps [1]
    share: np.ndarray  #: shape (points,); of the absorbed power [1]
    propagation: np.ndarray  #: shape (3,); direction in which the light travels [1]

    @property
    def radius(self) -> float:
        """Radius of the sphere of equal volume [grid steps]."""
        return float(np.cbrt(0.75 / np.pi * self.share.size))

    @property
    def asymmetry(self) -> float:
        r"""Asymmetry factor J₁ over the absorption efficiency, where heat is conducted evenly [1].

        The first harmonic of the surface temperature follows the dipole of the sources.
        """
        return float(self._toward_light @ self.share) * _IN_A_POINT / self.radius

    @property
    def asymmetry_without_conduction(self) -> float:
        """The same where heat leaves straight outwards and none flows sideways [1]."""
        distance = np.linalg.norm(self.position, axis=1)
        cosine = np.divide(self._toward_light, distance, where=distance > 0.0,
                           out=np.zeros_like(distance))  # fmt: skip
        return float(cosine @ self.share) * _IN_A_POINT

    @property
    def sideways(self) -> np.ndarray:
        """Part of :attr:`asymmetry` across the light [1], shape (3,); its force is not computed."""
        mean = self.share @ self.position
        return (mean - (mean @ self.propagation) * self.propagation) * _IN_A_POINT / self.radius

    @property
    def _toward_light(self) -> np.ndarray:
        return -self.position @ self.propagation


def read_absorbed_powers(
    *paths: str | Path, propagation: tuple[float, float, float] = (0.0, 0.0, 1.0)
) -> AbsorbedPowers:
    """Absorbed powers of a particle from text files, such as the internal fields of ADDA.

    Parameters
    ----------
    *paths : str or path
        The columns are ``x y z q``, or ``x y z |E|^2 ...`` as ``adda -store_int_field`` writes
        them to ``IntField-X`` and ``IntField-Y``. Both files together are unpolarised light.
        The points are those of a cubic grid, and ``q`` is the power per volume, in any unit.
        The squared field stands for it where all of the particle is one medium.
    propagation : sequence of 3 numbers
        Direction in which the light travels; ADDA's default is along z.

    Returns
    -------
    AbsorbedPowers

    Raises
    ------
    ConfigurationError
        One line that says what is wrong and where.
    """
    if not paths:
        raise ParameterError("read_absorbed_powers() needs the path of a file, such as IntField-X")
    direction = np.asarray(propagation, float)
    if direction.shape != (3,):
        raise ParameterError("propagation has three numbers, such as (0, 0, 1)")
    require_positive(length_of_propagation=np.linalg.norm(direction))
    tables = [read_table(path, _COLUMNS, strict=True) for path in paths]
    grids = [_grid(table) for table in tables]
    order = [np.lexsort(grid.T) for grid in grids]
    points = grids[0][order[0]]
    for path, grid, one in zip(paths[1:], grids[1:], order[1:], strict=True):
        if not np.array_equal(grid[one], points):
            raise ConfigurationError(f"{path}: has other points than {paths[0]}")
    powers = [table.numbers["q"][one] for table, one in zip(tables, order, strict=True)]
    power = np.sum(powers, axis=0)
    position = points - points.mean(axis=0)
    return AbsorbedPowers(position, power / power.sum(), direction / np.linalg.norm(direction))


def _grid(table: Table) -> np.ndarray:
    """Whole numbers of grid steps from one corner, shape (points, 3)."""
    places = np.stack([table.numbers[name] for name in "xyz"], axis=1)
    places = places - places.min(axis=0)
    gaps = np.diff(np.sort(places, axis=0), axis=0)
    step = np.min(gaps[gaps > _ROUNDED * np.max(gaps, initial=0.0)], initial=np.inf)
    whole = np.rint(places / step)
    if np.isinf(step) or np.any(np.abs(places / step - whole) > _ROUNDED):
        raise ConfigurationError(
            f"{table.source}: its points are not those of a cubic grid; write one row for each "
            "cell of a grid with equal steps, as adda -store_int_field does"
        )
    _, first = np.unique(whole, axis=0, return_index=True)
    if first.size < len(whole):
        line = table.lines[np.setdiff1d(np.arange(len(whole)), first)[0]]
        raise ConfigurationError(f"{table.source}:{line}: repeats the point of another line")
    if not np.any(table.numbers["q"] > 0.0):
        raise ConfigurationError(f"{table.source}: no point absorbs anything")
    return np.asarray(whole)
