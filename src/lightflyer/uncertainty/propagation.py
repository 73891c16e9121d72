r"""Uncertainty of a prediction, by first order and by Monte Carlo.

First order propagates the covariance :math:`\Sigma` of the inputs through exact gradients,
:math:`u^2 = \nabla q^\top\,\Sigma\,\nabla q`. An edge :math:`h` of the altitude band, where
:math:`m(h, x) = F/W - 1 = 0`, moves by :math:`\mathrm dh = -(m_x/m_h)\,\mathrm dx`; an optimum of
:math:`f` moves by :math:`-(f_{hx}/f_{hh})\,\mathrm dx`. Monte Carlo draws the inputs from normal
distributions, cut off where a value is impossible, and repeats the prediction.
"""

import warnings
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.config.designs import as_design
from lightflyer.core.constants import NORMAL_HALF_WIDTH_95
from lightflyer.core.errors import ParameterError, ParameterWarning
from lightflyer.core.progress import report
from lightflyer.core.units import dataset_unit
from lightflyer.design.outputs import outputs_of
from lightflyer.design.tables import LEVITATION, group_of
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.files.result_text import Parts, PrintedResult
from lightflyer.force.base import AbstractForceModel
from lightflyer.prediction.evaluator import Table
from lightflyer.prediction.prediction import Prediction, predict_design, search_grid
from lightflyer.uncertainty.inputs import Inputs, draw_possible, uncertain_inputs
from lightflyer.uncertainty.targets import (
    LEAST_LIGHT,
    NIGHT,
    derivatives,
    find_targets,
    sample_result,
    search_samples,
    spread_of,
    tabulate_samples,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from lightflyer.prediction.text import SampleShares

DEFAULT_SAMPLES = 500  # Monte Carlo samples where nothing else is asked for

FEWEST_SAMPLES = 100
"""Samples below which the ends of a 95 % band mean nothing: two or three lie outside of it."""

COVERAGE = (2.5, 97.5)  # Percentiles of the bands
_SAME = 1e-4  # relative difference up to which a flyer is the one that was predicted
BAND_POINTS = 61  # Coordinates at which the bands of the figures are known

BANDS = (
    "levitation_irradiance",
    "levitation_temperature",
    "temperature",
    "lift_over_weight",
    "payload",
    "relative_payload",
    "payload_per_area",
)
"""Outputs that have bands over the coordinate, besides those of the force model's own."""

_POSITIVE = LEAST_LIGHT  # goes with the inverse of the TACs' difference
_MARGIN = 10  # points of the prediction's table searched beyond the nominal range
_LIGHT_SPAN = 30.0  # irradiance, over the least, up to which the nominal range reaches
_SEARCHED_POINTS = 31  # over the whole searched range, besides those of the bands


@dataclass(frozen=True, repr=False)
class PredictionUncertainty(PrintedResult):
    """Uncertainty of each result of a prediction."""

    prediction: Prediction
    inputs: Inputs
    #: The results, named as in the prediction's summary: ``"best.payload_mg"``
    nominal: dict[str, float]
    first_order: dict[str, float]  #: Standard uncertainty of each
    #: shape (samples,); monte Carlo results; NaN in samples where there is no such result
    sampled: dict[str, np.ndarray]
    samples: int
    seed: int
    coordinate: np.ndarray  #: shape (n,); altitude [m] or pressure [Pa] of the bands
    draws: np.ndarray  #: shape (samples, k); inputs of each sample
    #: shape (samples, m); outputs of the samples that their results needed, at every second of the
    #: coordinates of the bands; empty where these are others
    found: Table = field(default_factory=dict)
    #: The results that are positive, and infinite in samples that have none
    endless: frozenset[str] = frozenset()
    #: The results that are edges of the band in which the flyer flies. First order has no 95 % band
    #: for them: how far they are from linear depends on the margin, which is uncertain too
    edges: frozenset[str] = frozenset()
    warnings: tuple[str, ...] = ()  #: What a reader must know, one line each

    def plot(self, what: str | None = None, ax: "Axes | None" = None) -> "Figure":
        """Draw the prediction with its 95 % bands."""
        from lightflyer.uncertainty.text import plot_uncertainty

        return plot_uncertainty(self, what, ax)

    def text_parts(self) -> Parts:
        from lightflyer.prediction.text import prediction_parts
        from lightflyer.uncertainty.text import band_parts

        yield from prediction_parts(self.prediction, bands=self.bands, shares=self.shares)
        yield from band_parts(self.summary())

    def add_to_dataset(self, dataset: "xr.Dataset") -> None:
        """Add the 95 % bands as ``..._low`` and ``..._high`` over a coordinate of their own."""
        coords, variables = self.columns()
        dataset.update(variables | coords)

    def columns(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Coordinate and variables of the bands, as a dataset takes them."""
        where, known = self.prediction.coordinate, outputs_of(self.prediction.setup)
        name = f"band_{where.name}"
        about = {"units": dataset_unit(where.unit), "long_name": where.long_name}
        bands = {}
        for end, table in (("low", self.low), ("high", self.high)):
            for output, values in table.items():
                told = known[output].attributes
                long_name = f"{told['long_name']}, {end} end of the 95 % band"
                bands[f"{output}_{end}"] = (name, values, told | {"long_name": long_name})
        return {name: (name, self.coordinate, about)}, bands

    @property
    def sources(self) -> str:
        """What the bands are from, in short."""
        from lightflyer.uncertainty.text import sources_line

        return f"brackets: 95 % bands from {sources_line(self.summary(), short=True)}"

    @property
    def low(self) -> Table:
        """Lower ends of the 95 % bands of outputs at ``coordinate``, shape (n,), in SI units."""
        return self._ends[0]

    @property
    def high(self) -> Table:
        """Upper ends, as ``low``."""
        return self._ends[1]

    @cached_property
    def _ends(self) -> tuple[Table, Table]:
        # computed when a figure or file asks for them: the results above need none
        names = (*BANDS, *self.prediction.own_names)
        low, high = {}, {}
        if not self.samples:
            slopes = derivatives(self.inputs, self.coordinate)
            for name in names:
                value, spread = slopes.value[name], slopes.spreads(name)
                if group_of(name) == LEVITATION:
                    # beyond the model's range its continuation bends: nothing tells its error
                    value = np.where(slopes.value["covered"] > 0.0, value, np.nan)
                low[name], high[name] = _normal_ends(value, spread, positive=name == _POSITIVE)
            return low, high
        report("bands of the curves")
        fresh = [name for name in names if name not in self.found]
        table = tabulate_samples(self.inputs, self.draws, self.coordinate, fresh)
        if self.found:
            rest = tabulate_samples(self.inputs, self.draws, self.coordinate[1::2], [*self.found])
            for name, values in self.found.items():
                table[name] = np.empty((self.samples, self.coordinate.size))
                table[name][:, ::2], table[name][:, 1::2] = values, rest[name]
        for name in names:
            values = table[name]
            # an irradiance that does not exist is above any other; a temperature then is unknown
            whole = np.where(np.isnan(values), np.inf, values)
            ends = np.percentile(whole, COVERAGE, axis=0, method="nearest")
            low[name], high[name] = np.where(np.isfinite(ends), ends, np.nan)
        return low, high

    @cached_property
    def bands(self) -> dict[str, tuple[float, float]]:
        """95 % band of each result that has one, in the unit of its name."""
        found = {}
        for name, result in self.summary()["results"].items():
            band = result.get("monte_carlo", result["first_order"])
            if band["low"] is not None and band["high"] is not None:
                found[name] = band["low"], band["high"]
        return found

    def summary(self) -> dict[str, Any]:
        """Everything as a JSON object; bands are 95 %."""
        return {
            "inputs": {
                name: spread
                for name, spread in zip(
                    self.inputs.names, self.inputs.spreads.tolist(), strict=True
                )
                if name not in self.inputs.open_names
            },
            "between_bounds": list(self.inputs.open_names),
            "tac_correlation": self.tac_correlation,
            "samples": self.samples,
            "seed": self.seed,
            "share_that_levitates": self.share_that_levitates,
            "share_that_survives": self.share_that_survives,
            "warnings": list(self.warnings),
            "results": {name: self._result(name) for name in self.nominal},
        }

    @property
    def share_that_levitates(self) -> float | None:
        """Share of the samples that levitate somewhere; None without samples."""
        if not self.samples:
            return None
        return float(np.mean(self.sampled["best.lift_over_weight"] > 1.0))

    @property
    def share_that_survives(self) -> float | None:
        """Share of the samples whose film survives where they rest when released, or None."""
        heat = self.sampled.get("verdict.rest.temperature_k")
        highest = self.prediction.verdict.highest_temperature
        return None if heat is None or highest is None else float(np.mean(heat <= highest))

    @property
    def shares(self) -> "SampleShares":
        """In how many samples it flies and survives, as the verdict tells it."""
        from lightflyer.prediction.text import SampleShares

        return SampleShares(self.samples, self.share_that_levitates, self.share_that_survives)

    @property
    def tac_correlation(self) -> float | None:
        """Correlation of the errors of a film's TACs; None where not both are uncertain."""
        for name in self.inputs.names:
            other = f"{name.removesuffix('tac_top')}tac_bottom"
            if name.endswith("tac_top") and other in self.inputs.names:
                return self.inputs.shared.get((name, other), 0.0)
        return None

    def _result(self, name: str) -> dict[str, Any]:
        value, spread = self.nominal[name], self.first_order[name]
        positive = name in self.endless
        low, high = map(float, _normal_ends(value, spread, positive=positive))
        known = np.isfinite(spread)  # not at a jump
        linear = known and name not in self.edges
        first_order = {
            "standard_uncertainty": spread if known else None,
            "low": low if linear else None,
            "high": high if linear else None,
        }
        result: dict[str, Any] = {"value": value, "first_order": first_order}
        if not self.samples:
            return result
        drawn = self.sampled[name]
        known = np.isfinite(drawn)
        # of a result that may be endless a missing value is larger than any other
        counted, ends = (
            np.where(known, drawn, np.inf) if positive else drawn[known],
            np.full(3, np.nan),
        )
        if counted.size:
            # outwards to the next sample: a finite number of them knows the ends badly
            ends[0] = np.percentile(counted, COVERAGE[0], method="lower")
            ends[1] = np.percentile(counted, 50.0, method="nearest")
            ends[2] = np.percentile(counted, COVERAGE[1], method="higher")
        result["monte_carlo"] = {
            name: float(end) if np.isfinite(end) else None
            for name, end in zip(("low", "median", "high"), ends, strict=True)
        } | {"share_of_samples": float(known.mean())}
        return result


def propagate(
    what: Any,
    environment: AbstractEnvironment | None = None,
    model: AbstractForceModel | None = None,
    *,
    prediction: Prediction | None = None,
    samples: int = DEFAULT_SAMPLES,
    seed: int = 0,
    over: np.ndarray | None = None,
) -> PredictionUncertainty | None:
    """Uncertainty of a prediction from the ± of its design.

    Parameters
    ----------
    what : FlyerFile, path, AbstractDesign, Setup or AbstractFlyer
        A flyer file states ± itself; for objects make an
        :class:`~lightflyer.design.design.ObjectDesign` with ``uncertainties``.
    environment, model : optional
        Where ``what`` is a flyer.
    prediction : Prediction, optional
        Prediction of the same design, where there is one already.
    samples : int
        Of Monte Carlo; 0 for first order alone.
    seed : int
        Of the random numbers: the same seed gives the same samples.
    over : array, shape (n,), optional
        Coordinates at which the bands are wanted, evenly spaced or, in a chamber, in equal ratios;
        by default those around which the flyer flies.

    Returns
    -------
    PredictionUncertainty or None
        None where nothing that can be propagated has a ±.

    Raises
    ------
    ParameterError
        If the uncertainties make nearly every sample impossible, ``samples`` is neither zero nor
        at least :data:`FEWEST_SAMPLES`, or ``seed`` is negative.

    Notes
    -----
    Inputs go through the design's own build: first order by its derivatives, Monte Carlo by
    building every sample. The optics of layers are taken as parabolas in each thickness and in the
    light's angle of incidence. What missing optical data leave open lies evenly between its bounds,
    as often below the nominal value as above it. Uncertainties of an atmosphere's date, place and
    indices are not propagated. Of several bands the samples, too, have the widest.
    """
    require_samples(samples, seed)
    design = as_design(what, environment, model)
    inputs = uncertain_inputs(design)
    if inputs is None:
        return None
    prediction = predict_design(design) if prediction is None else prediction
    targets, points = find_targets(prediction)
    near = _even_grid(prediction)
    report("bands to first order")
    slopes = derivatives(inputs, points)
    lift = next(target for target in targets if target.quantity == "lift_over_weight")
    now = slopes.value[lift.quantity][lift.point]
    if abs(now - lift.nominal) > _SAME * abs(lift.nominal):  # as a changed constant makes it
        warnings.warn(
            "no bands: the force model or the flyer gives other numbers than when this was "
            "predicted; predict again",
            ParameterWarning,
            stacklevel=2,
        )
        return None
    sampled: dict[str, np.ndarray] = {}
    draws, found_near = np.zeros((0, inputs.values.size)), {}
    told: tuple[str, ...] = ()
    if samples:
        report("bands by Monte Carlo")
        draws, refused, why = draw_possible(inputs, samples, seed)
        if refused:
            told += (
                f"{100.0 * refused:.2g} % of the Monte Carlo draws were impossible and were "
                f"drawn again ({why}); first order does not know of that limit",
            )
        asked = {target.quantity for target in targets} - {"", NIGHT}
        wanted = tuple(dict.fromkeys((*BANDS, *sorted(asked))))
        whole = search_grid(prediction.setup, _SEARCHED_POINTS)
        beyond = whole[(whole < near[0]) | (whole > near[-1])]
        # the least light takes longest, and changes slowly from place to place
        rows = {False: [points, near[::2], beyond], True: [points, whole[::2]]}
        tables = []
        for lit, parts in rows.items():
            names = tuple(name for name in wanted if (group_of(name) == LEVITATION) is lit)
            coordinates = np.unique(np.concatenate(parts))
            table = tabulate_samples(inputs, draws, coordinates, names)
            # a balance may have no solution within the tolerance
            missing = np.isnan(table[LEAST_LIGHT if LEAST_LIGHT in table else "lift_over_weight"])
            if missing.any():
                told += (
                    f"{100.0 * missing.mean():.2g} % of the Monte Carlo balances missed their "
                    "tolerance; they count as places that no light lifts",
                )
            tables.append((coordinates, table))
            if not lit and over is None:
                columns = np.searchsorted(coordinates, near[::2])
                found_near = {name: table[name][:, columns] for name in names if name in BANDS}
        within = ((whole[0] <= place) & (place <= whole[-1]) for place, _ in tables)
        inside = [
            (place[chosen], {name: values[:, chosen] for name, values in table.items()})
            for (place, table), chosen in zip(tables, within, strict=True)
        ]
        found = search_samples(inputs, draws, inside)
        sampled = {target.name: sample_result(target, found, tables) for target in targets}
    return PredictionUncertainty(
        prediction=prediction,
        inputs=inputs,
        nominal={target.name: target.nominal for target in targets},
        first_order={target.name: spread_of(target, slopes) for target in targets},
        sampled=sampled,
        samples=samples,
        seed=seed,
        coordinate=near if over is None else np.asarray(over, float),
        draws=draws,
        found=found_near,
        endless=frozenset(target.name for target in targets if target.quantity == _POSITIVE),
        edges=frozenset(target.name for target in targets if target.is_edge),
        warnings=told,
    )


def require_samples(samples: int, seed: int, prefix: str = "") -> None:
    """Raise unless a number of Monte Carlo samples gives a band."""
    if not (samples == 0 or samples >= FEWEST_SAMPLES):
        raise ParameterError(
            f"{prefix}samples = {samples}: give at least {FEWEST_SAMPLES} for a 95 % band, or 0 "
            "for first order alone"
        )
    if seed < 0:
        raise ParameterError(f"{prefix}seed = {seed}: must be zero or positive")


def _even_grid(prediction: Prediction) -> np.ndarray:
    """Coordinates [m], [Pa] at which bands are known, evenly spaced or in equal ratios."""
    coordinates = prediction.coordinates
    last = coordinates.size - 1
    best = int(np.searchsorted(coordinates, prediction.best.coordinate))
    low, high = best - 3 * _MARGIN, best + 3 * _MARGIN
    if prediction.easiest is not None:
        least = prediction.easiest.values["levitation_irradiance"]
        needed = prediction.table["levitation_irradiance"]
        near = np.flatnonzero(needed < (_LIGHT_SPAN * least or np.inf))
        low, high = min(low, near[0] - _MARGIN), max(high, near[-1] + _MARGIN)
    if prediction.widest is not None:
        lower, upper = np.searchsorted(coordinates, prediction.bands[prediction.widest])
        low, high = min(low, lower - _MARGIN), max(high, upper + _MARGIN)
    if prediction.coordinate.logarithmic:
        low, high = 0, last
    ends = coordinates[max(low, 0)], coordinates[min(high, last)]
    return prediction.coordinate.evenly(*ends, BAND_POINTS)


def _normal_ends(value: Any, spread: Any, *, positive: bool) -> tuple[Any, Any]:
    """Ends of a 95 % band to first order; in the logarithm for what is positive."""
    half = NORMAL_HALF_WIDTH_95 * spread
    if not positive:
        return value - half, value + half
    with np.errstate(invalid="ignore", divide="ignore"):
        factor = np.exp(np.divide(half, value))
        # what needs no light, needs none to first order
        low, high = (np.where(value == 0.0, 0.0, end) for end in (value / factor, value * factor))
    return low, high
