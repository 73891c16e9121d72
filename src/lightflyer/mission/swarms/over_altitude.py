"""Drift, hanging payloads and tethered swarms over altitude."""

import re
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import lightflyer
from lightflyer.core.errors import ParameterError
from lightflyer.design.setup import Setup
from lightflyer.environment.section import altitude_coordinate
from lightflyer.files.display_units import amount, suitable
from lightflyer.files.result_text import Parts, table_of, warning_lines, wrap
from lightflyer.mission.path.steady import hanging_stability, steady_drift
from lightflyer.mission.report.assumptions import describe_object
from lightflyer.mission.swarms.tethers import tethered_swarm
from lightflyer.statics.grid_refinement import crossing
from lightflyer.statics.loads import payload as payload_of

if TYPE_CHECKING:
    import xarray as xr

ALTITUDE, TILT = "altitude", "tilt"
_COLUMNS = {
    ALTITUDE: ("m", "altitude"),
    TILT: ("degree", "tilt"),
    "speed": ("m s-1", "speed along the tilt"),
    "climb": ("m s-1", "climb"),
    "steepest": ("degree", "tilt that keeps the altitude"),
    "fastest": ("m s-1", "speed at that tilt"),
    "longest_rod": ("m", "longest stable rod"),
    "growth_rate": ("s-1", "growth of disturbances, negative where stable"),
    "count": ("1", "flyers"),
    "layer_radius": ("m", "radius of the layer"),
    "depth": ("m", "depth of the payload"),
    "tether_mass": ("kg", "mass of all tethers"),
    "largest_pull": ("N", "largest pull of a tether"),
    "largest_tilt": ("degree", "largest tilt"),
}
"""Units and descriptions of all results."""

_POINTS, _ROWS = 41, 15  # altitudes of figures and files, and about as many of tables
_STEP = 250.0  # metres between altitudes at which is tried whether a flyer lifts itself
_TILTS = np.arange(0.0, 60.1, 2.5)  # degrees
_SHOWN_TILTS = 5.0, 10.0, 20.0, 30.0
_STILL = 1e-6  # m/s of a climb that is none
_HEADING = 13  # characters of a line


def drift_over_altitude(
    setup: Setup, ends: tuple[float, float] | None = None, *, azimuth: float = 0.0
) -> "xr.Dataset":
    """Drift by altitude and tilt, and at the steepest tilt at which a flyer keeps its altitude.

    ``ends``: of the altitudes [m]; ``azimuth``: as of :func:`steady_drift` [rad].
    """
    if setup.flyer.hangs is not None:
        raise ParameterError(f"nothing drifts by a tilt: {setup.flyer.hangs}")
    heights, tilts = _altitudes(setup, ends, float(setup.flyer.payload)), np.radians(_TILTS)

    def drift(tilt: Any) -> Any:
        return steady_drift(setup, altitude=heights, tilt=tilt, azimuth=azimuth)

    found = drift(tilts[:, None])
    climbs = np.asarray(found.climb) >= 0.0
    last = tilts.size - 1 - np.argmax(climbs[::-1], axis=0)
    beyond = np.minimum(last + 1, tilts.size - 1)
    between = climbs.any(axis=0) & (beyond > last)
    edge = crossing(
        lambda tilt: np.asarray(drift(tilt).climb), tilts[beyond], tilts[last], between, _STILL
    )
    steepest = np.where(climbs.any(axis=0), edge, np.nan)
    values = {
        "speed": np.transpose(found.speed),
        "climb": np.transpose(found.climb),
        "steepest": np.degrees(steepest),
        "fastest": np.where(np.isnan(steepest), np.nan, drift(np.nan_to_num(steepest)).speed),
    }
    return _dataset("drift", setup, heights, values, found.warnings)


def stability_over_altitude(
    setup: Setup, ends: tuple[float, float] | None = None, **how: Any
) -> "xr.Dataset":
    """Whether a flyer keeps level with its payload below it; ``how``: its rod and string."""
    heights = _altitudes(setup, ends, float(setup.flyer.payload))
    found = [
        hanging_stability(setup.flyer, setup.environment.state(height), setup.model, **how)
        for height in heights
    ]
    names = "longest_rod", "growth_rate"
    return _dataset_of("stability", setup, heights, found, names)


def swarm_over_altitude(
    setup: Setup, ends: tuple[float, float] | None = None, **how: Any
) -> "xr.Dataset":
    """How many flyers carry a payload together; ``how``: as of :func:`tethered_swarm`."""
    heights, reason = _altitudes(setup, ends, 0.0), ""
    found: list[Any] = [None] * heights.size
    for number, height in enumerate(heights):
        try:
            found[number] = tethered_swarm(setup, altitude=height, **how)
        except ParameterError as error:
            reason = str(error)
    if not any(found):
        raise ParameterError(reason)
    names = "count", "layer_radius", "depth", "tether_mass", "largest_pull", "largest_tilt"
    dataset = _dataset_of("swarm", setup, heights, found, names)
    dataset["largest_tilt"].values[:] = np.degrees(dataset["largest_tilt"])
    return dataset


def _dataset_of(
    title: str, setup: Setup, heights: np.ndarray, found: list[Any], names: tuple[str, ...]
) -> "xr.Dataset":
    """Fields of results, NaN where there is none, and warnings with their altitudes."""
    # of those that differ in numbers alone the first
    warnings: dict[str, str] = {}
    for height, one in zip(heights, found, strict=True):
        for text in getattr(one, "warnings", ()):
            warnings.setdefault(re.split(r"\d", text)[0], f"at {height / 1e3:.4g} km: {text}")
    values = {name: [getattr(one, name, np.nan) for one in found] for name in names}
    return _dataset(title, setup, heights, values, warnings.values())


def _altitudes(setup: Setup, ends: tuple[float, float] | None, carried: float) -> np.ndarray:
    """Altitudes between two, by default those between which a flyer carries a mass [m]."""
    where = setup.environment.coordinate
    if where.name != ALTITUDE:
        raise ParameterError(
            f"{setup.flyer.describe()} is described over {where.name}; this is for an atmosphere"
        )
    if ends is None:
        low, high = setup.searched
        tried = np.linspace(low, high, 1 + round((high - low) / _STEP))
        state = setup.environment.state(tried)
        lifts = payload_of(setup.flyer, state, setup.model, throw=False)
        carries = tried[np.asarray(lifts) > carried]
        if not carries.size:
            raise ParameterError(
                f"{setup.flyer.describe()} does not lift {amount(carried, 'kg')} between "
                f"{low / 1e3:g} km and {high / 1e3:g} km; give altitudes"
            )
        ends = float(carries[0]), float(carries[-1])
    return np.union1d(where.evenly(*ends, _POINTS), where.round_points(*ends, _ROWS))


def _dataset(
    title: str, setup: Setup, heights: np.ndarray, values: dict[str, Any], warnings: Iterable[str]
) -> "xr.Dataset":
    import xarray as xr

    arrays = {name: np.asarray(value, float) for name, value in values.items()}
    about = {
        "title": f"lightflyer {title}",
        "lightflyer_version": lightflyer.__version__,
        "flyer": setup.flyer.describe(),
        "force_model": describe_object(setup.model),
        "warnings": "\n".join(warnings),
    }
    dims = {name: (ALTITUDE, TILT)[: value.ndim] for name, value in arrays.items()}
    coords = {ALTITUDE: heights} | ({TILT: _TILTS} if 2 in map(np.ndim, arrays.values()) else {})
    dataset = xr.Dataset({name: (dims[name], arrays[name]) for name in arrays}, coords, about)
    for name in dataset.variables:
        unit, words = _COLUMNS[str(name)]
        dataset[name].attrs.update(units=unit, long_name=words)
    return dataset


def table_parts(dataset: "xr.Dataset") -> Parts:
    """Results at round altitudes as a table, and warnings."""
    low, high = dataset[ALTITUDE].values[[0, -1]]
    round_ones = altitude_coordinate((low, high), high).round_points(low, high, _ROWS)
    rows = dataset.sel({ALTITUDE: round_ones})
    headings, columns = [], []
    for name in (ALTITUDE, *rows.data_vars):
        unit, words = _COLUMNS[str(name)]
        found = {words: rows[name]}
        if rows[name].ndim > 1:
            tilts = _SHOWN_TILTS if name == "speed" else ()
            found = {f"speed at {tilt:g}°": rows[name].sel({TILT: tilt}) for tilt in tilts}
        for title, values in found.items():
            factor, shown = suitable("" if unit == "1" else unit, values.values)
            headings.append(wrap(title, _HEADING) + (f"\n[{shown}]" if shown else ""))
            cells = (f"{one * factor:.4g}" if np.isfinite(one) else "" for one in values.values)
            columns.append([*cells])
    yield table_of(headings, zip(*columns, strict=True), left=())
    yield from map(wrap, warning_lines(dataset.attrs["warnings"].splitlines()))


def summary_of(dataset: "xr.Dataset") -> dict[str, Any]:
    """Results over altitude, ready for JSON; null where there is none."""
    found: dict[str, Any] = {**dataset.attrs}
    found["warnings"] = dataset.attrs["warnings"].splitlines()
    for name in (ALTITUDE, *dataset.data_vars):
        if dataset[name].ndim == 1:
            values = [one if np.isfinite(one) else None for one in dataset[name].values.tolist()]
            found[str(name)] = {"unit": _COLUMNS[str(name)][0], "values": values}
    return found


def write_csv(dataset: "xr.Dataset", path: Path) -> None:
    """Write a row for each altitude, and for each tilt where there are several."""
    names = {name: f"{name} [{_COLUMNS[str(name)][0]}]" for name in dataset.variables}
    table = dataset.to_dataframe().reset_index().rename(columns=names)
    table.to_csv(path, index=False, float_format="%.10g", lineterminator="\n")
