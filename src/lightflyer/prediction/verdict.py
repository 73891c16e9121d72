"""What a prediction comes to: where its flyer is usable, where it comes to rest, what limits it."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.design.diagnostics import shape_failures
from lightflyer.design.operating_point import sinks_at_night
from lightflyer.design.tables import NIGHT_SPEED
from lightflyer.prediction.evaluator import Evaluator, Place, Rows, find_usable
from lightflyer.statics.grid_refinement import crossing, rows_around
from lightflyer.statics.sinking import night_length, night_places

if TYPE_CHECKING:
    from lightflyer.prediction.prediction import Prediction

Limit = Literal["light", "film", "lift"]

_CLOSER = 200  # places between two rows of the table, where a range ends


@dataclass(frozen=True)
class Verdict(ShortRepr):
    """Where a flyer can be used, what becomes of it when nothing holds it, and what limits it."""

    #: That the film withstands [K]; None where the flyer does not state it
    highest_temperature: float | None
    #: Ranges of the coordinate in which the flyer levitates and its film survives, lowest first
    usable: list[tuple[float, float]]
    best: Place | None  #: Where in them it carries the largest payload, if something holds it there
    #: Whether nothing has to hold it there: at the peak of lift it rests, so loaded
    carries_afloat: bool
    #: Lower edge of the widest band [m], below which the flyer sinks; None where the band reaches
    #: the end of the search
    lowest_release: float | None
    #: Its upper edge, at which lift falls with altitude: there a flyer comes to rest that nothing
    #: holds. None where the band reaches the end of the search, and in a chamber
    rest: Place | None
    #: Time to sink in the dark from there to the lower edge of the band [s], infinite for a flyer
    #: that stays up; None where either is unknown, and for a flyer without a law of drag or tilted
    longest_night: float | None
    #: Whether the film survives at rest; None where rest or limit are unknown
    survives: bool | None
    #: Irradiance up to which it does [W/m²]: zero where no light that lifts the flyer is weak
    #: enough, infinite where none that leaves it within the search is too strong. None where
    #: ``survives`` is
    strongest_light: float | None
    #: Where it rests in that light; None where that is zero, infinite or unknown
    strongest_rest: float | None
    #: Payloads between which it comes to rest, when released, where its film survives [kg], though
    #: it does not with its own payload; None where there are none
    ballast: tuple[float, float] | None
    #: Parts of the bands that the ranges of force model and gas cover; elsewhere they are
    #: extrapolated
    covered: list[tuple[float, float]]
    #: Where it carries most in the usable parts that they cover, where ``best`` is not among them
    best_covered: Place | None
    #: What decides: the light where it lifts the flyer nowhere, the film where it does not survive
    #: in the whole band, else the lift at both edges
    limit: Limit
    #: Outputs by which it does not hold its shape where it flies, such as ``"gap_closed"``
    shape_failures: tuple[str, ...] = ()


def verdict_of(prediction: "Prediction") -> Verdict:
    """The verdict on a prediction."""
    evaluate, found = Evaluator(prediction.setup), prediction
    stated = found.setup.flyer.highest_temperature
    highest = None if stated is None else float(stated)
    if found.widest is None:
        unknown: dict[str, Any] = dict.fromkeys(
            ("best", "lowest_release", "rest", "longest_night", "survives")
        )
        unknown |= dict.fromkeys(("strongest_light", "strongest_rest", "ballast", "best_covered"))
        return Verdict(highest, [], carries_afloat=False, covered=[], limit="light", **unknown)
    lower, upper = found.bands[found.widest]
    drifts = found.coordinate.name == "altitude"
    rest = evaluate.place(upper) if drifts and upper < found.coordinates[-1] else None
    usable: list[tuple[float, float]] = found.bands
    best: Place | None = found.best
    survives, strongest, strongest_rest = None, None, None
    if highest is not None:
        # the parts of the bands in which the film survives, and the place of most payload in them
        edges, to_axis = np.array(found.bands), found.coordinate.to_axis
        exact = [found.best.coordinate, *edges.ravel()]
        rows = Rows(evaluate, found.coordinates, found.table, exact)
        known = {name: np.array([value]) for name, value in found.best.values.items()}
        parts = find_usable(
            rows.tabulate,
            rows.places,
            rows.columns,
            to_axis(edges.T[:, :, None]),
            (to_axis(np.array([found.best.coordinate])), known),
            highest,
        )
        usable, place = rows.ranges(parts.edges), rows.place(parts.best, parts.at_best)
        if place.coordinate != found.best.coordinate:
            best = place
        best = best if usable else None
        if rest is not None:
            survives = rest.values["temperature"] <= highest
            strongest, strongest_rest = _strongest_light(
                evaluate, found, highest, survives=survives
            )
    ballast = None
    if survives is False and best is found.best:  # the peak of lift, below which nothing floats
        (top,) = (high for low, high in usable if low <= best.coordinate <= high)
        ballast = evaluate.place(top).values["payload"], best.values["payload"]
    night = None
    if rest is not None and lower > found.coordinates[0] and sinks_at_night(found.setup):
        ends = np.float64(rest.coordinate), np.float64(lower)
        speed = evaluate(night_places(*ends), names=(NIGHT_SPEED,))[NIGHT_SPEED]
        night = float(night_length(*ends, speed))
    covered, best_covered = _covered(evaluate, found), None
    both = [
        (max(low, start), min(high, end))
        for low, high in usable
        for start, end in covered
        if max(low, start) <= min(high, end)
    ]
    if best is not None and both and not any(low <= best.coordinate <= up for low, up in both):
        grid = found.coordinates
        inside = [grid[(low < grid) & (grid < high)] for low, high in both]
        places = np.unique(np.concatenate([*both, *inside]))
        payloads = evaluate(places, names=("payload",))["payload"]
        best_covered = evaluate.place(float(places[np.nanargmax(payloads)]))
    return Verdict(
        highest_temperature=highest,
        usable=usable,
        best=best,
        carries_afloat=rest is not None and best is found.best,
        lowest_release=lower if drifts and lower > found.coordinates[0] else None,
        rest=rest,
        longest_night=night,
        survives=survives,
        strongest_light=strongest,
        strongest_rest=strongest_rest,
        ballast=ballast,
        covered=covered,
        best_covered=best_covered,
        limit="lift" if usable == found.bands else "film",
        shape_failures=tuple(shape_failures(found.setup, found.table)),
    )


def _covered(evaluate: Evaluator, found: "Prediction") -> list[tuple[float, float]]:
    """Parts of the bands within the ranges of force model and gas."""
    parts, grid = [], found.coordinates
    for low, high in found.bands:
        places = np.array([low, *grid[(low < grid) & (grid < high)], high])
        inside = _within_ranges(evaluate, places)
        starts = np.flatnonzero(inside[1:] != inside[:-1])
        if starts.size:  # a closer look where a range ends
            closer = [
                found.coordinate.evenly(places[start], places[start + 1], _CLOSER)
                for start in starts
            ]
            places = np.unique(np.concatenate([places, *closer]))
            inside = _within_ranges(evaluate, places)
        ends = np.flatnonzero(np.diff(np.r_[False, inside, False])).reshape(-1, 2)
        parts += [(float(places[first]), float(places[end - 1])) for first, end in ends]
    return parts


def _within_ranges(evaluate: Evaluator, places: np.ndarray) -> np.ndarray:
    return evaluate(places, names=("covered",))["covered"] > 0.0


def _strongest_light(
    evaluate: Evaluator, prediction: "Prediction", highest: float, *, survives: bool
) -> tuple[float, float | None]:
    """Strongest light at whose place of rest the film survives, and that place."""

    # At rest the light is the least that levitates, and the temperature is the one in that light.
    # So from the place of the least light upwards, the table of levitation lists the places of
    # rest in stronger and stronger light; a flyer that survives is followed from where it rests.
    def margin(temperature: np.ndarray) -> np.ndarray:
        return 1.0 - temperature / highest

    def cool(places: np.ndarray) -> np.ndarray:
        found = evaluate(places.ravel(), names=(light, heat))
        light_at.update(zip(places.ravel(), found[light], strict=True))
        return margin(found[heat].reshape(places.shape))

    grid, light, heat = prediction.coordinates, "levitation_irradiance", "levitation_temperature"
    band = prediction.bands[prediction.widest or 0]
    easiest = band[0] if prediction.easiest is None else prediction.easiest.coordinate
    added = np.array([*band, max(band[0], easiest)])
    more = evaluate(added, names=(light, heat))
    places, order = np.unique([*added, *grid], return_index=True)
    lights, heats = (np.append(more[name], prediction.table[name])[order] for name in (light, heat))
    solved = (places >= band[0]) & ~np.isnan(lights)
    places, lights, heats = places[solved], lights[solved], heats[solved]
    light_at = dict(zip(places, lights, strict=True))
    within = int(np.count_nonzero(places <= band[1]))
    start = within - 1 if survives else int(np.argmin(lights[:within]))
    places, margins = places[start:], margin(heats[start:])
    first = int(np.argmin([*(margins >= 0.0), False]))
    if first in (0, places.size):
        return (np.inf if first else 0.0), None
    ends, column = places[[[first], [first - 1]]], places[:, None]
    known = rows_around(column, column, ends), rows_around(margins[:, None], column, ends)
    place = crossing(cool, ends[0], ends[1], known=known)
    return float(light_at[place[0]]), float(place[0])
