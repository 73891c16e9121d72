"""Comparison of several flyers over altitude, or over pressure in chambers.

Each flyer is predicted in its own surroundings, with the bands of its own ±; all of them are then
tabulated on one grid.
"""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.array import tree
from lightflyer.array.records import ShortRepr
from lightflyer.comparison.text import (
    Difference,
    differing_models,
    differing_surroundings,
    require_comparable,
)
from lightflyer.config.designs import as_design
from lightflyer.core.errors import ConfigurationError, LightflyerError, ParameterError
from lightflyer.core.progress import report
from lightflyer.core.units import scale_and_offset
from lightflyer.design.design import AbstractDesign
from lightflyer.design.outputs import OUTPUTS, outputs_of
from lightflyer.design.setup import Setup
from lightflyer.environment.base import AbstractEnvironment, Coordinate
from lightflyer.files.result_text import Parts, PrintedResult
from lightflyer.force.base import AbstractForceModel
from lightflyer.prediction.evaluator import Evaluator, Place, Table
from lightflyer.prediction.prediction import Prediction, predict_design
from lightflyer.uncertainty.propagation import (
    DEFAULT_SAMPLES,
    PredictionUncertainty,
    propagate,
    require_samples,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FEWEST, MOST = 2, 9
"""Numbers of flyers that can be told apart in one figure."""

POINTS = 121  # Length of the common grid

_LEAST_LIFT = 0.3  # lift over weight around which a flyer is worth drawing
_AROUND = 0.05  # of the searched range, drawn beyond that on each side
_LISTED = 12  # most coordinates that are listed


@dataclass(frozen=True)
class Compared(ShortRepr):
    """One of the flyers of a comparison."""

    name: str  #: The file's, or a description
    prediction: Prediction
    uncertainty: PredictionUncertainty | None  #: None where no ± is stated
    table: Table  #: shape (n,); outputs on the common grid, in SI units
    listed: Table  #: shape (m,); outputs at the round coordinates of the comparison

    @property
    def setup(self) -> Setup:
        """The flyer, its environment and its force model."""
        return self.prediction.setup

    @property
    def description(self) -> str:
        """Flyer and force model in a few words."""
        return f"{self.setup.flyer.describe()}, {type(self.setup.model).__name__}"

    @property
    def best(self) -> Place:
        """Where it carries most and its film survives; else the peak of lift."""
        found = self.prediction.verdict.best
        return self.prediction.best if found is None else found

    @property
    def usable_payload(self) -> float:
        """Largest payload where its film survives [kg]; minus infinity where it does nowhere."""
        verdict = self.prediction.verdict
        flies_cool = verdict.best is not None or not self.prediction.bands
        return self.best.values["payload"] if flies_cool else -np.inf

    def band(self, output: str) -> tuple[np.ndarray, np.ndarray] | None:
        """95 % band of an output on the common grid, in SI units; None where there is none."""
        if self.uncertainty is None or output not in self.uncertainty.low:
            return None
        return self.uncertainty.low[output], self.uncertainty.high[output]

    def best_band(self, output: str) -> tuple[float, float] | None:
        """95 % band of an output at the best place, in SI units."""
        if self.uncertainty is None:
            return None
        key, scale = outputs_of(self.setup)[output].json
        verdict = self.prediction.verdict
        held = verdict.highest_temperature is not None and verdict.best is not None
        band = self.uncertainty.bands.get(f"{'verdict.' if held else ''}best.{key}")
        return None if band is None else (band[0] / scale, band[1] / scale)

    def summary(self) -> dict[str, Any]:
        """The flyer as a JSON object."""
        described = self.prediction.summary()
        del described["at"]
        _, scale = outputs_of(self.setup)["own_mass"].json
        described = {
            "name": self.name,
            "flyer": self.setup.flyer.describe(),
            "force_model": type(self.setup.model).__name__,
            "own_mass_kg": float(self.setup.flyer.own_mass) * scale,
        } | described
        if self.uncertainty is not None:
            described["uncertainty"] = self.uncertainty.summary()
        return described


@dataclass(frozen=True, repr=False)
class Comparison(PrintedResult):
    """Several flyers side by side."""

    flyers: tuple[Compared, ...]
    coordinates: np.ndarray  #: shape (n,); the common grid: altitudes [m] or pressures [Pa]
    listed: np.ndarray  #: shape (m,); round ones among them

    @property
    def coordinate(self) -> Coordinate:
        """The coordinate that all flyers share."""
        return self.flyers[0].prediction.coordinate

    @property
    def best(self) -> Compared:
        """The flyer of the largest payload that its film survives."""
        return max(self.flyers, key=lambda found: found.usable_payload)

    def display_unit(self, output: str) -> tuple[float, str]:
        """Factor from an output's SI unit, and the unit, that suit the best of all flyers."""
        return OUTPUTS[output].display_unit_for(
            [found.best.values[output] for found in self.flyers]
        )

    @cached_property
    def _setups(self) -> dict[str, Setup]:
        return {found.name: found.setup for found in self.flyers}

    @cached_property
    def differing_surroundings(self) -> tuple[Difference, ...]:
        """In what the surroundings differ."""
        return differing_surroundings(self._setups)

    @cached_property
    def differing_models(self) -> tuple[Difference, ...]:
        """In what the force models differ."""
        return differing_models(self._setups)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a reader must know, one line each: surroundings that differ, then each flyer's."""
        unequal = tuple(f"not on one footing: {found}" for found in self.differing_surroundings)
        own = tuple(
            f"{found.name}: {text}"
            for found in self.flyers
            for text in found.prediction.other_warnings
        )
        same = tuple(
            f"{first.name} and {second.name} are the same design"
            for first, second in combinations(self.flyers, 2)
            if tree.equal(first.setup, second.setup)
        )
        without = [found.name for found in self.flyers if found.uncertainty is None]
        if 0 < len(without) < len(self.flyers):
            unequal += (f"no band for {', '.join(without)}: no ± is stated",)
        return same + unequal + own

    def plot(self, output: str | None = None, ax: "Axes | None" = None) -> "Figure":
        """Draw the flyers over altitude or pressure, with 95 % bands where ± are stated."""
        from lightflyer.comparison.figures import plot_comparison

        return plot_comparison(self, output, ax)

    def text_parts(self) -> Parts:
        from lightflyer.comparison.text import comparison_parts

        return comparison_parts(self)

    def summary(self) -> dict[str, Any]:
        """The comparison as a JSON object, with a unit at the end of each name."""
        key, factor = self.flyers[0].prediction.coordinate_key
        return {
            f"{self.coordinate.name}_range{key.removeprefix(self.coordinate.name)}": [
                float(end) * factor for end in self.coordinates[[0, -1]]
            ],
            "best": self.best.name,
            "flyers": [found.summary() for found in self.flyers],
            "differing_surroundings": _as_json(self.differing_surroundings),
            "differing_force_models": _as_json(self.differing_models),
            "warnings": list(self.warnings),
        }

    @cached_property
    def dataset(self) -> "xr.Dataset":
        """The tables as a dataset with units; see :func:`~lightflyer.comparison.to_dataset`."""
        from lightflyer.comparison.text import to_dataset

        return to_dataset(self)


def _as_json(differences: Sequence[Difference]) -> dict[str, dict[str, str]]:
    return {found.what: found.values for found in differences}


def compare(
    what: Collection[Any],
    environment: AbstractEnvironment | None = None,
    model: AbstractForceModel | None = None,
    *,
    searched: tuple[float, float] | None = None,
    samples: int = DEFAULT_SAMPLES,
    seed: int = 0,
) -> Comparison:
    """Compare flyers, each in its own surroundings, on one grid of altitudes or pressures.

    Parameters
    ----------
    what : sequence or dict of AbstractFlyer, Setup, FlyerFile, path or AbstractDesign
        Two to nine of them, in a dict by their names; by default these are the names of files
        without ending, and descriptions.
    environment, model : optional
        Where ``what`` has flyers: those of all of them.
    searched : tuple of float, optional
        Altitudes [m] or pressures [Pa] between which all are compared, in place of what the files
        say; by default the grid reaches as far as any of them comes near to flying.
    samples : int
        Of Monte Carlo for the bands of those with ±, or whose force model states its own errors;
        0 for first order alone.
    seed : int
        Of the random numbers.

    Returns
    -------
    Comparison

    Raises
    ------
    ConfigurationError
        If a file cannot be used, some are described over altitude and others over pressure, or they
        have no altitude in common.
    ParameterError
        If there are too few or too many, or the range is not within each of the surroundings'.
    ConvergenceError
        If a heat balance has not converged.

    Examples
    --------
    >>> import lightflyer as lf
    >>> light, heavy = (
    ...     lf.FilmProperties(mass, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    ...     for mass in (1e-3, 2e-3)
    ... )
    >>> disks = {"light": lf.Disk(light, 0.01), "heavy": lf.Disk(heavy, 0.01)}
    >>> found = lf.compare(disks, lf.Earth(), lf.Lu2023())
    >>> found.best.name
    'light'
    """
    require_samples(samples, seed)
    if isinstance(model, list | tuple):
        raise ParameterError(
            "compare takes one model for all flyers; to compare models give a "
            "lightflyer.Setup(flyer, environment, model) of each"
        )
    if isinstance(what, str) or not isinstance(what, Collection):
        what = [what]
    parts = list(what.values() if isinstance(what, Mapping) else what)
    if not FEWEST <= len(parts) <= MOST:
        raise ParameterError(f"compare takes {FEWEST} to {MOST} flyers, not {len(parts)}")
    designs: dict[str, AbstractDesign] = {}  # by names that differ
    for name, one in zip(what, parts, strict=True):
        design = as_design(one, environment, model)
        if not isinstance(what, Mapping):
            is_file = isinstance(one, str | Path)
            name = Path(one).stem if is_file else design.setup.flyer.describe()
            same = sum(other.rpartition(" (")[0] == name or other == name for other in designs)
            name += f" ({same + 1})" if same else ""
        designs[name] = design
    (first, where), *others = (
        (name, design.setup.environment.coordinate) for name, design in designs.items()
    )
    for name, other in others:
        if other.name != where.name:
            raise ConfigurationError(
                f"{first} is described over {where.name} and {name} over {other.name}: "
                "compare flyers in an atmosphere with one another, or flyers in chambers"
            )
    require_comparable(design.setup for design in designs.values())
    if searched is not None:
        low, high = (float(where.quantity.number("searched", end)) for end in searched)
        if not low < high:
            factor, _ = scale_and_offset(where.unit, where.shown_unit)
            unit = where.shown_unit
            raise ParameterError(
                f"{where.name}: {low * factor:g} {unit} to {high * factor:g} {unit} is not a "
                "range; the first must be the lower one"
            )
        searched = low, high
    count = 2 * len(designs)
    predictions: dict[str, Prediction] = {}
    for name, design in designs.items():
        report(f"{name}: prediction", len(predictions), count)
        with _about(name):
            predictions[name] = predict_design(design, (), searched)

    def bands(name: str, grid: np.ndarray) -> PredictionUncertainty | None:
        report(f"{name}: 95 % band", len(designs) + list(designs).index(name), count)
        design = designs[name].with_open_errors()
        return propagate(
            design, prediction=predictions[name], samples=samples, seed=seed, over=grid
        )

    return side_by_side(predictions, bands, searched)


def side_by_side(
    predictions: Mapping[str, Prediction],
    bands: Callable[[str, np.ndarray], PredictionUncertainty | None] = lambda *_: None,
    searched: tuple[float, float] | None = None,
) -> Comparison:
    """Compare predictions; ``bands``: of a name and the grid, by default none."""
    first, *_ = predictions.values()
    where = first.coordinate
    if searched is None:  # where any flyer comes near to flying
        ends = np.array([_range_near_flight(one) for one in predictions.values()])
        ranges = np.array([one.coordinates[[0, -1]] for one in predictions.values()])
        searched = (
            max(ends[:, 0].min(), ranges[:, 0].max()),
            min(ends[:, 1].max(), ranges[:, 1].min()),
        )
        if searched[0] >= searched[1]:
            raise ConfigurationError(f"the flyers are searched over no {where.name} in common")
    grid = where.evenly(*searched, POINTS)
    listed = where.round_points(float(grid[0]), float(grid[-1]), _LISTED)
    flyers: list[Compared] = []
    for name, prediction in predictions.items():
        with _about(name):
            evaluate = Evaluator(prediction.setup)
            uncertainty = bands(name, grid)
            tables = evaluate(grid), evaluate(listed)
        flyers.append(Compared(name, prediction, uncertainty, *tables))
    return Comparison(tuple(flyers), grid, listed)


@contextmanager
def _about(name: str) -> Iterator[None]:
    """Let errors inside begin with the flyer that they are about."""
    try:
        yield
    except LightflyerError as error:
        raise type(error)(f"{name}: {error}") from None


def _range_near_flight(prediction: Prediction) -> tuple[float, float]:
    """Range in which lift comes near to the weight, or that around the best, and some more."""
    coordinates = prediction.coordinates
    near = np.flatnonzero(prediction.table["lift_over_weight"] >= _LEAST_LIFT)
    best = int(np.searchsorted(coordinates, prediction.best.coordinate))
    first, final = (near[0], near[-1]) if near.size else (best, best)
    more = int(_AROUND * coordinates.size)
    low, high = max(min(first, best) - more, 0), min(max(final, best) + more, coordinates.size - 1)
    return float(coordinates[low]), float(coordinates[high])
