"""What a prediction comes to: where its flyer is usable, where it comes to rest, what limits it."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from lightflyer.flight.grid_refinement import crossing, peak
from lightflyer.prediction.evaluator import Evaluator, Place

if TYPE_CHECKING:
    from lightflyer.prediction.prediction import Prediction

Limit = Literal["light", "film", "lift"]


@dataclass(frozen=True)
class Verdict:
    """Where a flyer can be used, what becomes of it when nothing holds it, and what limits it."""

    #: That the film bears [K]; None where the flyer does not state it
    highest_temperature: float | None
    #: Ranges of the coordinate in which the flyer levitates and its film survives, lowest first
    usable: list[tuple[float, float]]
    best: Place | None  #: Where in them it carries the largest payload, if something holds it there
    #: Lower edge of the widest band [m], below which the flyer sinks; None where the band reaches
    #: the end of the search
    lowest_release: float | None
    #: Its upper edge, at which lift falls with altitude: there a flyer comes to rest that nothing
    #: holds. None where the band reaches the end of the search, and in a chamber
    rest: Place | None
    #: Whether the film survives at rest; None where rest or limit are unknown
    survives: bool | None
    #: Irradiance up to which it does [W/m²]: zero where no light that lifts the flyer is weak
    #: enough, infinite where none that leaves it within the search is too strong. None where
    #: ``survives`` is
    strongest_light: float | None
    #: What decides: the light where it lifts the flyer nowhere, the film where it does not survive
    #: in the whole band, else the lift at both edges
    limit: Limit


def verdict_of(prediction: "Prediction") -> Verdict:
    """The verdict on a prediction."""
    evaluate, found = Evaluator(prediction.setup), prediction
    stated = found.setup.flyer.highest_temperature
    highest = None if stated is None else float(stated)
    if found.widest is None:
        return Verdict(highest, [], None, None, None, None, None, "light")
    lower, upper = found.bands[found.widest]
    drifts = found.coordinate.name == "altitude"
    rest = evaluate.place(upper) if drifts and upper < found.coordinates[-1] else None
    usable = found.bands
    survives, strongest = None, None
    if highest is not None:
        parts = (_cool_parts(evaluate, found.coordinates, band, highest) for band in found.bands)
        usable = [part for of_band in parts for part in of_band]
        if rest is not None:
            survives = rest.values["temperature"] <= highest
            strongest = _strongest_light(evaluate, found, highest, survives=survives)
    return Verdict(
        highest_temperature=highest,
        usable=usable,
        best=_best(evaluate, found, usable),
        lowest_release=lower if drifts and lower > found.coordinates[0] else None,
        rest=rest,
        survives=survives,
        strongest_light=strongest,
        limit="lift" if usable == found.bands else "film",
    )


def _column(evaluate: Evaluator, name: str) -> Callable[[np.ndarray], np.ndarray]:
    """One output of places of any shape."""

    def column(places: np.ndarray) -> np.ndarray:
        return evaluate(places.ravel(), names=(name,))[name].reshape(places.shape)

    return column


def _coolness(evaluate: Evaluator, name: str, highest: float) -> Callable[[np.ndarray], np.ndarray]:
    """How far a temperature is below the film's limit, as a share of it, at places of any shape."""
    column = _column(evaluate, name)
    # NaN stands where no light lifts the flyer: on the way there it gets hotter and hotter
    return lambda places: np.nan_to_num(1.0 - column(places) / highest, nan=-1.0)


def _cool_parts(
    evaluate: Evaluator, grid: np.ndarray, band: tuple[float, float], highest: float
) -> list[tuple[float, float]]:
    """Parts of a band in which the film survives."""
    cool = _coolness(evaluate, "temperature", highest)
    places = np.array([band[0], *grid[(grid > band[0]) & (grid < band[1])], band[1]])
    places = places[~np.isnan(_column(evaluate, "temperature")(places))]  # those solved
    survives = cool(places) >= 0.0
    before = np.flatnonzero(survives[1:] != survives[:-1])
    ends = [band[0], *_between(cool, places[before], places[before + 1], survives[before]), band[1]]
    start = 0 if survives[0] else 1
    return list(zip(ends[start::2], ends[start + 1 :: 2], strict=False))


def _between(
    cool: Callable[[np.ndarray], np.ndarray], left: Any, right: Any, left_is_cool: Any
) -> list[float]:
    """Where the film's limit is passed between two places."""
    if not np.size(left):
        return []
    outside, inside = np.where(left_is_cool, (right, left), (left, right))
    return [float(edge) for edge in crossing(cool, outside, inside)]


def _strongest_light(
    evaluate: Evaluator, prediction: "Prediction", highest: float, *, survives: bool
) -> float:
    """Strongest light at whose place of rest the film survives."""
    # At rest the light is the least that levitates, and the temperature is the one in that light.
    # So from the place of the least light upwards, the table of levitation lists the places of
    # rest in stronger and stronger light; a flyer that survives is followed from where it rests.
    light, grid = _column(evaluate, "levitation_irradiance"), prediction.coordinates
    band = prediction.bands[prediction.widest or 0]
    easiest = band[0] if prediction.easiest is None else prediction.easiest.coordinate
    places = np.unique([*band, *grid[grid > band[0]], max(band[0], easiest)])
    places = places[~np.isnan(light(places))]  # those solved
    within = places[places <= band[1]]
    start = within.size - 1 if survives else int(np.argmin(light(within)))
    places = places[start:]
    cool = _coolness(evaluate, "levitation_temperature", highest)
    first = int(np.argmin([*(cool(places) >= 0.0), False]))
    if first in (0, places.size):
        return np.inf if first else 0.0
    return float(light(np.array(_between(cool, places[[first - 1]], places[[first]], True)))[0])


def _best(
    evaluate: Evaluator, prediction: "Prediction", usable: list[tuple[float, float]]
) -> Place | None:
    """Place of the largest payload within the usable bands."""
    where = prediction.best.coordinate
    if any(low <= where <= high for low, high in usable):
        return prediction.best
    if not usable:
        return None
    places, payloads = peak(_column(evaluate, "payload"), *np.transpose(usable))
    return evaluate.place(float(places[np.argmax(payloads)]))
