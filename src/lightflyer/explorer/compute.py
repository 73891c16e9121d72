"""Results of the design that the page shows: the package's own, and nothing else.

What was computed for a design is kept for a while.
"""

import math
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache, wraps
from typing import Any, NamedTuple, ParamSpec, TypeVar

import numpy as np

from lightflyer.config.flyer_file import FileDesign
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.units import parse, scale_and_offset
from lightflyer.design.outputs import OUTPUTS, Output, outputs_of
from lightflyer.design.setup import Setup
from lightflyer.environment.base import Coordinate
from lightflyer.prediction.evaluator import POINTS, Evaluator, Table
from lightflyer.prediction.prediction import Prediction, predict_design, search_grid
from lightflyer.prediction.text import verdict_lines
from lightflyer.uncertainty.propagation import PredictionUncertainty, propagate

KEPT = 48  # Predictions that are kept: those of the designs that somebody looks at

_DIGITS = 4
_INTERVAL_DIGITS = 3
_SURE = 0.95  # share of the samples below which a verdict is unsure

P = ParamSpec("P")
R = TypeVar("R")


class Quick(NamedTuple):
    """What follows a slider: the outputs over the coordinate."""

    setup: Setup
    coordinates: np.ndarray  # shape (n,); altitudes [m] or pressures [Pa]
    table: Table  # shape (n,); outputs by name, in SI units


@dataclass(frozen=True)
class Reading:
    """A result in words and numbers."""

    name: str  # As in the prediction's JSON, such as ``"best.payload_mg"``
    label: str
    text: str  # Value and unit
    # In the JSON's unit; None where there is none, and for a band, which has two
    value: float | None
    spread: str = ""  # 95 % interval; empty where no ± is stated


def _once(function: Callable[P, R]) -> Callable[P, R]:
    """Keep results, and compute each only once however many threads ask for it."""
    lock, pending = threading.Lock(), {}  # type: tuple[threading.Lock, dict[Any, threading.Lock]]
    kept = lru_cache(KEPT)(function)

    @wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        with lock:
            own = pending.setdefault(args, threading.Lock())
        try:
            with own:
                return kept(*args, **kwargs)  # type: ignore[arg-type]
        finally:
            with lock:
                pending.pop(args, None)

    return wrapper


def quick(design: FileDesign) -> Quick:
    """Outputs over the coordinate, as a prediction tabulates them."""
    setup = design.setup
    coordinates = search_grid(setup, POINTS)
    return Quick(setup, coordinates, Evaluator(setup)(coordinates))


@_once
def prediction_of(design: FileDesign) -> Prediction:
    """The prediction of a design, as :func:`lightflyer.predict` gives it."""
    return predict_design(design)


@_once
def uncertainty_of(design: FileDesign) -> PredictionUncertainty | None:
    """The uncertainty of a design's prediction, as the command samples it; None without a ±."""
    return propagate(design, prediction=prediction_of(design))


def place_of(text: str, setup: Setup) -> float | None:
    """Coordinate that a page asks about [m]; or; ``text``: such as ``"75 km"``; empty for none."""
    where = setup.environment.coordinate
    if not text.strip():
        return None
    try:
        value = parse(text, where.unit).value
    except ConfigurationError as error:
        raise ConfigurationError(f"at: {error}") from None
    factor, _ = scale_and_offset(where.unit, where.shown_unit)
    low, high = float(where.quantity.lowest), float(where.quantity.highest)
    if not low <= value <= high:
        ends = f"{low * factor:.4g} and {high * factor:.4g} {where.shown_unit}"
        raise ConfigurationError(f"at = {text}: must be between {ends}")
    return value


def readings(prediction: Prediction, uncertainty: PredictionUncertainty | None) -> list[Reading]:
    """What a prediction says in a few numbers."""
    where, verdict = prediction.coordinate, prediction.verdict
    key, factor = prediction.coordinate_key
    spreads = {} if uncertainty is None else uncertainty.summary()["results"]
    name, ending = f"{where.name}_band", key.removeprefix(where.name)
    if prediction.widest is None:
        found = [Reading(f"{name}{ending}", "levitates", "nowhere in this light", None)]
    else:
        low, high = (edge * factor for edge in prediction.bands[prediction.widest])
        more = len(prediction.bands) - 1
        label = "levitates" if not more else f"levitates (and in {more} more bands)"
        ends = [_interval(spreads.get(f"{name}{ending}.{end}")) for end in ("lower", "upper")]
        each = (" to ".join(_number(end, "", _INTERVAL_DIGITS) for end in pair) for pair in ends)
        spread = f"95 %: {' and '.join(each)} {where.shown_unit}" if all(ends) else ""
        text = f"{low:.{_DIGITS}g} to {high:.{_DIGITS}g} {where.shown_unit}"
        found = [Reading(f"{name}{ending}", label, text, None, spread)]
    if verdict.rest is not None:
        at = _number(verdict.rest.coordinate * factor, where.shown_unit)
        hot, name = verdict.rest.values["temperature"], "verdict.rest.temperature_k"
        found.append(_reading(name, f"released, rests at {at}", hot, "K", spreads))
    if verdict.highest_temperature is not None and prediction.bands:
        parts = (
            " to ".join(f"{edge * factor:.{_DIGITS}g}" for edge in part) for part in verdict.usable
        )
        words = " and ".join(f"{part} {where.shown_unit}" for part in parts) or "nowhere there"
        survives = f"film survives (withstands {verdict.highest_temperature:.0f} K)"
        found.append(Reading(f"verdict.usable_bands{ending}", survives, words, None))
    group, light = where.easiest_keys
    if prediction.easiest is not None:
        least = prediction.easiest.values["levitation_irradiance"]
        at = _number(prediction.easiest.coordinate * factor, where.shown_unit)
        found.append(_reading(f"{group}.{light}", f"least light, at {at}", least, "W/m²", spreads))
    place = verdict.best or prediction.best
    held = "afloat at" if verdict.carries_afloat else "at"
    best = f"{held} {_number(place.coordinate * factor, where.shown_unit)}"
    group = "best" if place is prediction.best else "verdict.best"
    for name in ("payload", "lift_over_weight", "temperature"):
        label = f"{_SHORT[name]}, {best}"
        found.append(_of_output(OUTPUTS[name], place.values[name], f"{group}.", label, spreads))
    flyer = prediction.setup.flyer
    own = {"own_mass": flyer.own_mass, "areal_density": flyer.own_mass / flyer.area}
    for name, number in own.items():
        value = float(np.asarray(number))
        scale, unit = OUTPUTS[name].display_unit_for(value)
        shown = _number(value * scale, pretty_unit(unit))
        found.append(Reading(name, _SHORT[name], shown, value))
    return found


def verdict_of(
    prediction: Prediction,
    uncertainty: PredictionUncertainty | None,
    *,
    to_be_sampled: bool = False,
) -> dict[str, Any]:
    """The verdict in sentences, and its state: ``flies``, ``unsure``, too ``hot`` or ``not``."""
    told = () if uncertainty is None else (uncertainty.bands, uncertainty.shares)
    lines = list(verdict_lines(prediction, *told))
    found = prediction.verdict
    melts = found.survives is False or found.limit == "film"
    state = "not" if not prediction.bands else "hot" if melts else "flies"
    shares = [] if uncertainty is None else list(uncertainty.shares[1:])
    unsure = to_be_sampled or any(share is not None and share < _SURE for share in shares)
    if state == "flies" and unsure:
        state = "unsure"
    return {"state": state, "lines": lines[1:]}


_SHORT = {
    "payload": "largest payload",
    "lift_over_weight": "lift over weight",
    "temperature": "flyer's temperature",
    "own_mass": "flyer's mass",
    "areal_density": "areal density",
}


def _reading(
    name: str,
    label: str,
    value: float,
    unit: str,
    spreads: Mapping[str, Any],
    scale: float = 1.0,
) -> Reading:
    band, shown = _interval(spreads.get(name)), ""
    if band:
        ends = (_number(end * scale, "", _INTERVAL_DIGITS) for end in band)
        shown = f"95 %: {' to '.join(ends)} {unit}".rstrip()
    finite = float(value) if math.isfinite(value) else None
    return Reading(name, label, _number(value * scale, unit), finite, shown)


def _of_output(
    output: Output, value: float, group: str, label: str, spreads: Mapping[str, Any]
) -> Reading:
    (key, factor), (scale, unit) = output.json, output.display_unit_for(value)
    unit = pretty_unit(unit)
    return _reading(f"{group}{key}", label, value * factor, unit, spreads, scale / factor)


def _interval(spread: Mapping[str, Any] | None) -> tuple[float, ...]:
    """Ends of a result's 95 % interval, of the samples where there are; empty without one."""
    found = {} if spread is None else spread.get("monte_carlo", spread["first_order"])
    ends = [found[end] for end in ("low", "high") if found.get(end) is not None]
    return tuple(ends) if len(ends) == 2 else ()


def _number(value: float, unit: str, digits: int = _DIGITS) -> str:
    if not math.isfinite(value):
        return "none"
    large = abs(value) >= 10.0**digits
    return f"{f'{value:.0f}' if large else f'{value:.{digits}g}'} {unit}".rstrip()


def values_at(setup: Setup, place: float) -> list[Reading]:
    """Outputs at one altitude or pressure."""
    known = outputs_of(setup)
    return [
        _of_output(known[name], float(column[0]), "", known[name].long_name, {})
        for name, column in Evaluator(setup)(np.array([place])).items()
    ]


def pretty_unit(unit: str) -> str:
    """A unit as people write it; ``unit``: as files spell it."""
    return unit.replace("^2", "²").replace("^3", "³")


def coordinate_factor(where: Coordinate) -> float:
    """Factor from a coordinate's SI unit to the one shown."""
    return scale_and_offset(where.unit, where.shown_unit)[0]
