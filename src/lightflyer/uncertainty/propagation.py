r"""Uncertainty of a prediction, by first order and by Monte Carlo.

First order propagates the covariance :math:`\Sigma` of the inputs through exact gradients,
:math:`u^2 = \nabla q^\top\,\Sigma\,\nabla q`. An edge :math:`h` of the altitude band, where
:math:`m(h, x) = F/W - 1 = 0`, moves by :math:`\mathrm dh = -(m_x/m_h)\,\mathrm dx`; an optimum of
:math:`f` moves by :math:`-(f_{hx}/f_{hh})\,\mathrm dx`. Monte Carlo draws the inputs from normal
distributions, cut off where a value is impossible, and repeats the prediction.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from lightflyer.config.sections import FlyerFile
from lightflyer.prediction.prediction import AltitudePrediction, ChamberPrediction
from lightflyer.uncertainty import monte_carlo as sampling
from lightflyer.uncertainty.derivatives import Sensitivity, sensitivity
from lightflyer.uncertainty.inputs import Inputs, draw, uncertain_inputs

DEFAULT_SAMPLES = 500
"""Monte Carlo samples where nothing else is asked for."""

COVERAGE = (2.5, 97.5)
"""Percentiles of the bands."""

BAND_POINTS = 121
"""Coordinates at which the bands of the figures are known."""

BANDS = ("levitation_irradiance", "levitation_temperature", "temperature", "payload")
"""Quantities that have bands in the figures."""

_STANDARD_DEVIATIONS = 1.959963984540054  # of a normal distribution, for 95 %
_KILO = 1e3
_MILLIGRAMS = 1e6
_MARGIN = 5e3  # altitude searched beyond the nominal range [m]
_LIGHT_SPAN = 30.0  # irradiance, over the least, up to which the nominal range reaches

Table = dict[str, np.ndarray]


@dataclass(frozen=True)
class _Target:
    """One result: which quantity, in which unit, at which coordinate, and what moves that.

    ``mover`` is empty at a fixed coordinate, ``lower`` or ``upper`` at an edge, or names the
    objective of an optimum. Without a quantity the coordinate itself is the result. ``at_end``:
    the optimum is an end of the searched range, which does not move to first order.
    """

    name: str
    nominal: float
    quantity: str
    scale: float
    point: int
    mover: str = ""
    at_end: bool = False


@dataclass(frozen=True)
class PredictionUncertainty:
    """How far each result of a prediction may be off.

    Attributes
    ----------
    inputs : Inputs
    nominal : dict of str to float
        The results, named as in the prediction's summary: ``"best.payload_mg"``.
    first_order : dict of str to float
        Standard uncertainty of each.
    sampled : dict of str to array, shape (samples,)
        Monte Carlo results; NaN in samples where there is no such result.
    samples, seed : int
    coordinate : array, shape (n,)
        Altitude [m] or pressure [Pa] of the bands.
    low, high : dict of str to array, shape (n,)
        95 % bands of :data:`BANDS`, in SI units.
    """

    inputs: Inputs
    nominal: dict[str, float]
    first_order: dict[str, float]
    sampled: dict[str, np.ndarray]
    samples: int
    seed: int
    coordinate: np.ndarray
    low: Table = field(default_factory=dict)
    high: Table = field(default_factory=dict)

    def summary(self) -> dict[str, Any]:
        """All of it as a JSON object; bands are 95 %."""
        return {
            "inputs": dict(zip(self.inputs.names, self.inputs.spreads.tolist(), strict=True)),
            "tac_correlation": self.inputs.tac_correlation,
            "samples": self.samples,
            "seed": self.seed,
            "results": {name: self._result(name) for name in self.nominal},
        }

    def _result(self, name: str) -> dict[str, Any]:
        value, spread = self.nominal[name], self.first_order[name]
        half = _STANDARD_DEVIATIONS * spread
        first_order = {"standard_uncertainty": spread, "low": value - half, "high": value + half}
        result: dict[str, Any] = {"value": value, "first_order": first_order}
        if self.samples:
            found = self.sampled[name][np.isfinite(self.sampled[name])]
            levels = (COVERAGE[0], 50.0, COVERAGE[1])
            numbers = np.percentile(found, levels).tolist() if found.size else [None] * 3
            low, median, high = numbers
            share = found.size / self.samples
            band = {"low": low, "median": median, "high": high, "share_of_samples": share}
            result["monte_carlo"] = band
        return result


def propagate(
    configuration: FlyerFile,
    prediction: AltitudePrediction | ChamberPrediction,
    samples: int = DEFAULT_SAMPLES,
    seed: int = 0,
) -> PredictionUncertainty | None:
    """Uncertainty of a prediction from the ± of its flyer file.

    Parameters
    ----------
    configuration : FlyerFile
    prediction : AltitudePrediction or ChamberPrediction
        Of that file.
    samples : int
        Of Monte Carlo; 0 for first order alone.
    seed : int
        Of the random numbers: the same seed gives the same samples.

    Returns
    -------
    PredictionUncertainty or None
        None where nothing that can be propagated has a ±.

    Raises
    ------
    ParameterError
        If the uncertainties make nearly every sample impossible.

    Notes
    -----
    Uncertainties of an atmosphere's date, place and indices are not propagated. Of several
    altitude bands the samples follow the one around the strongest lift.
    """
    inputs = uncertain_inputs(configuration)
    if inputs is None:
        return None
    targets, points = _targets(prediction)
    low, high = _range(prediction)
    chamber = isinstance(prediction, ChamberPrediction)
    even = np.linspace(np.log(low), np.log(high), BAND_POINTS) if chamber else None
    grid = np.linspace(low, high, BAND_POINTS) if even is None else np.exp(even)
    coordinates = np.concatenate([grid, points])
    derivatives = sensitivity(inputs, coordinates)
    sampled: dict[str, np.ndarray] = {}
    if samples:
        shifts = draw(inputs, samples, seed) - inputs.values
        table = sampling.tabulate(inputs.setup, inputs.slopes, shifts, coordinates)
        sampled = _sampled(targets, table, grid if even is None else even, chamber=chamber)
        bands = _quantiles({name: table[name][:, :BAND_POINTS] for name in BANDS})
    else:
        bands = _normal_bands(derivatives)
    return PredictionUncertainty(
        inputs=inputs,
        nominal={target.name: target.nominal for target in targets},
        first_order={target.name: _spread(target, derivatives) for target in targets},
        sampled=sampled,
        samples=samples,
        seed=seed,
        coordinate=grid,
        low=bands[0],
        high=bands[1],
    )


def _targets(
    prediction: AltitudePrediction | ChamberPrediction,
) -> tuple[list[_Target], np.ndarray]:
    """The results of a prediction, and the coordinates at which they are."""
    if isinstance(prediction, ChamberPrediction):
        return _chamber_targets(prediction)
    points: list[float] = []
    targets: list[_Target] = []
    searched = (prediction.altitude[0], prediction.altitude[-1])

    def add(group: str, coordinate: float, mover: str, parts: dict[str, tuple[Any, ...]]) -> None:
        points.append(coordinate)
        for key, (nominal, quantity, scale) in parts.items():
            if nominal is not None and np.isfinite(nominal):
                name = f"{group}.{key}"
                place, at_end = len(points) - 1, coordinate in searched
                targets.append(_Target(name, float(nominal), quantity, scale, place, mover, at_end))

    summary, widest = prediction.summary(), prediction.widest
    if widest is not None:
        for edge, coordinate in zip(("lower", "upper"), prediction.bands[widest], strict=True):
            if coordinate not in searched:  # else it is not the flyer's own edge
                parts = {edge: (coordinate / _KILO, "", 1.0 / _KILO)}
                add("altitude_band_km", coordinate, edge, parts)
    if prediction.easiest is not None:
        found = summary["minimum_irradiance"]
        parts = {
            "altitude_km": (found["altitude_km"], "", 1.0 / _KILO),
            "value_w_m2": (found["value_w_m2"], "levitation_irradiance", 1.0),
            "temperature_k": (found["temperature_k"], "levitation_temperature", 1.0),
        }
        add("minimum_irradiance", prediction.easiest[0], "levitation_irradiance", parts)
    best = summary["best"]
    parts = {
        "altitude_km": (best["altitude_km"], "", 1.0 / _KILO),
        "payload_mg": (best["payload_mg"], "payload", _MILLIGRAMS),
        "relative_payload": (best["relative_payload"], "relative_payload", 1.0),
        "temperature_k": (best["temperature_k"], "temperature", 1.0),
        "lift_over_weight": (best["lift_over_weight"], "lift_over_weight", 1.0),
    }
    add("best", prediction.best[0], "payload", parts)
    for number, row in enumerate(summary["at"]):
        add(f"at[{number}]", float(prediction.at_altitude[number]), "", _point_parts(row))
    return targets, np.array(points)


def _point_parts(row: dict[str, Any]) -> dict[str, tuple[Any, ...]]:
    quantities = {
        "levitation_irradiance_w_m2": "levitation_irradiance",
        "levitation_temperature_k": "levitation_temperature",
        "temperature_k": "temperature",
        "lift_n": "lift",
        "lift_over_weight": "lift_over_weight",
    }
    return {key: (row[key], name, 1.0) for key, name in quantities.items()}


def _chamber_targets(prediction: ChamberPrediction) -> tuple[list[_Target], np.ndarray]:
    summary, points, targets = prediction.summary(), [], []
    if prediction.optimum is not None:
        found = summary["optimum"]
        points.append(prediction.optimum[0])
        at_end = points[0] in (prediction.pressure[0], prediction.pressure[-1])
        for key, quantity in (
            ("pressure_pa", ""),
            ("irradiance_w_m2", "levitation_irradiance"),
            ("temperature_k", "levitation_temperature"),
        ):
            name = f"optimum.{key}"
            mover = "levitation_irradiance"
            targets.append(_Target(name, found[key], quantity, 1.0, 0, mover, at_end))
    for number, row in enumerate(summary["at"]):
        points.append(float(prediction.at_pressure[number]))
        for key, (nominal, quantity, scale) in _point_parts(row).items():
            if nominal is not None:
                name = f"at[{number}].{key}"
                targets.append(_Target(name, nominal, quantity, scale, len(points) - 1))
    return targets, np.array(points)


def _range(prediction: AltitudePrediction | ChamberPrediction) -> tuple[float, float]:
    """Coordinates between which bands are drawn and samples searched."""
    if isinstance(prediction, ChamberPrediction):
        return float(prediction.pressure[0]), float(prediction.pressure[-1])
    needed, altitude = prediction.table["levitation_irradiance"], prediction.altitude
    centre = prediction.best[0]
    low, high = centre - 3.0 * _MARGIN, centre + 3.0 * _MARGIN
    if prediction.easiest is not None:
        least = prediction.easiest[1]["levitation_irradiance"][0]
        near = np.flatnonzero(needed < _LIGHT_SPAN * least)
        low, high = min(low, altitude[near[0]] - _MARGIN), max(high, altitude[near[-1]] + _MARGIN)
    return float(max(low, altitude[0])), float(min(high, altitude[-1]))


def _spread(target: _Target, derivatives: Sensitivity) -> float:
    """Standard uncertainty of a result to first order."""
    point = BAND_POINTS + target.point
    if target.mover in ("lower", "upper"):
        moving = derivatives.edge(point)
    elif target.mover and not target.at_end:
        moving = derivatives.optimum(target.mover, point)
    else:
        moving = np.zeros(len(derivatives.covariance))
    if target.quantity:
        moving = derivatives.moving(target.quantity, point, moving)
    return target.scale * derivatives.spread(moving)


def _sampled(
    targets: list[_Target], table: Table, even: np.ndarray, *, chamber: bool
) -> dict[str, np.ndarray]:
    """Each result in each sample; ``even`` is the evenly spaced coordinate of the bands."""
    over_grid = {name: values[:, : even.size] for name, values in table.items()}
    found: dict[str, Any] = {}
    lower, upper = sampling.edges(even, over_grid["lift_over_weight"])
    found["lower"], found["upper"] = (lower, {}), (upper, {})
    found["payload"] = sampling.optimum(even, over_grid["payload"], over_grid)
    logarithms = dict(over_grid)
    with np.errstate(divide="ignore"):
        logarithms["levitation_irradiance"] = np.log(over_grid["levitation_irradiance"])
    place, there = sampling.optimum(even, -logarithms["levitation_irradiance"], logarithms)
    there["levitation_irradiance"] = np.exp(there["levitation_irradiance"])
    found["levitation_irradiance"] = place, there
    results = {}
    for target in targets:
        if target.mover:
            place, there = found[target.mover]
            coordinate = np.exp(place) if chamber else place
            values = there[target.quantity] if target.quantity else coordinate
        else:
            values = table[target.quantity][:, even.size + target.point]
        results[target.name] = target.scale * values
    return results


def _quantiles(table: Table) -> tuple[Table, Table]:
    low, high = {}, {}
    for name, values in table.items():
        # an irradiance that does not exist is above any other; a temperature then is unknown
        whole = np.where(np.isnan(values), np.inf, values)
        ends = np.percentile(whole, COVERAGE, axis=0, method="nearest")
        low[name], high[name] = np.where(np.isfinite(ends), ends, np.nan)
    return low, high


def _normal_bands(derivatives: Sensitivity) -> tuple[Table, Table]:
    low, high = {}, {}
    for name in BANDS:
        value = derivatives.value[name][:BAND_POINTS]
        half = _STANDARD_DEVIATIONS * derivatives.spreads(name)[:BAND_POINTS]
        low[name], high[name] = value - half, value + half
    return low, high
