"""A comparison in numbers and words."""

from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.core.clock import date_text, seconds_of
from lightflyer.files.display_units import suitable
from lightflyer.files.result_text import Parts, as_text, rows_of, table_of
from lightflyer.mission.measured.comparison import BAND, PERIOD
from lightflyer.mission.measured.explanation import TELLING, evidence, rms_of, weights_of
from lightflyer.mission.report.summary import SECONDS_AN_HOUR
from lightflyer.mission.report.text import place_text

if TYPE_CHECKING:
    import xarray as xr
    from rich.table import Table

RESIDUALS = {
    "altitude": "altitude_residual",
    "along": "along_residual",
    "across": "across_residual",
    "distance": "distance",
}
EXPLANATIONS = {"mass": "kg", "vertical_wind": "m/s"}

_WAYS, _VALUE = ("east", "north"), ("value", "low", "high")
_PERCENT = 100.0


def summarise_comparison(compared: "xr.Dataset") -> dict[str, Any]:
    """A comparison with a measured track in numbers.

    Parameters
    ----------
    compared : xarray.Dataset
        From :func:`lightflyer.mission.compare_track`.

    Returns
    -------
    dict
        Ready for JSON, with a unit at the end of each name.
    """
    elapsed = compared.measured_elapsed.values
    beside = np.isfinite(compared.altitude_residual.values)
    found: dict[str, Any] = {
        "source": compared.attrs["source"],
        "fixes": int(elapsed.size),
        "compared": int(beside.sum()),
        "compared_h": float(np.ptp(elapsed[beside])) / SECONDS_AN_HOUR,
        "ended": date_text(seconds_of(compared.measured_time.values[-1])),
        "end_latitude_deg": float(compared.measured_latitude[-1]),
        "end_longitude_deg": float(compared.measured_longitude[-1]),
        "end_altitude_km": float(compared.measured_altitude[-1]) / 1e3,
        "residuals": {
            name: _size(elapsed, compared[variable].values) for name, variable in RESIDUALS.items()
        },
        "wind_by_time": _winds(compared, PERIOD, SECONDS_AN_HOUR, "h"),
        "wind_by_altitude": _winds(compared, BAND, 1e3, "km"),
    }
    if "altitude_rms" in compared:
        found["explanations"] = _explanations(compared)
    return found | {"notes": [note for note in compared.attrs["notes"].split("\n") if note]}


def describe_comparison(compared: "xr.Dataset") -> str:
    """A comparison with a measured track as a short text.

    Parameters
    ----------
    compared : xarray.Dataset
        From :func:`lightflyer.mission.compare_track`.

    Returns
    -------
    str
    """
    return as_text(comparison_parts(summarise_comparison(compared)))


def comparison_parts(found: dict[str, Any]) -> Parts:
    """Lines and tables of a comparison, from its summary."""
    place = (found["end_latitude_deg"], found["end_longitude_deg"], found["end_altitude_km"] * 1e3)
    yield rows_of({
        "beside": f"{found['source']}, {found['compared']} of {found['fixes']} fixes, "
        f"{found['compared_h']:.2f} h",
        "ended": f"{found['ended']}, {place_text(*place)}",
    })  # fmt: skip
    rows = [
        (f"{name} [km]", f"{one['rms_km']:.3f}", f"{one['largest_km']:.3f}", f"{one['at_h']:.2f}")
        for name, one in found["residuals"].items()
        if one is not None
    ]
    yield table_of(("measured less flown", "rms", "largest", "at [h]"), rows, pad_edge=False)
    for key, name in (("time", "after the release [h]"), ("altitude", "altitude [km]")):
        if found[f"wind_by_{key}"]:
            yield _wind_table(found[f"wind_by_{key}"], name)
    if "explanations" in found:
        yield from _explanation_parts(found["explanations"])
    yield from found["notes"]


def verdict(found: dict[str, Any]) -> str:
    """Which explanation is preferred; ``found``: ``explanations`` of a summary."""
    better, other = (
        name.replace("_", " ")
        for name in sorted(EXPLANATIONS, key=lambda name: found[name]["rms_km"])
    )
    count = f"{found['independent']:.2g}"
    left = f"what is left counts as {count} independent residual{'s' * (count != '1')}"
    if found["evidence"] < TELLING:
        after = min(found[name]["rms_km"] for name in EXPLANATIONS)
        fall = f"the rms falls from {found['rms_before_km']:.3g} km to {after:.3g} km"
        return f"neither is established: {fall}, and {left}"
    if found["evidence_between"] < TELLING:
        return f"{better} or {other}: the altitudes do not tell which; {left}"
    return f"the {better} explains the altitudes better than the {other}; {left}"


def _size(elapsed: np.ndarray, values: np.ndarray) -> dict[str, float] | None:
    known = np.isfinite(values)
    if known.sum() < 2:
        return None
    elapsed, values = elapsed[known], values[known]
    largest = int(np.argmax(np.abs(values)))
    return {
        "rms_km": rms_of(values, weights_of(elapsed)) / 1e3,
        "largest_km": float(values[largest]) / 1e3,
        "at_h": float(elapsed[largest]) / SECONDS_AN_HOUR,
        "last_km": float(values[-1]) / 1e3,
    }


def _winds(
    compared: "xr.Dataset", dimension: str, size: float, unit: str
) -> list[dict[str, float]]:
    columns = {
        f"from_{unit}": compared[f"{dimension}_lowest"].values / size,
        f"to_{unit}": compared[f"{dimension}_highest"].values / size,
        "east_m_s": compared[f"{dimension}_east"].values,
        "north_m_s": compared[f"{dimension}_north"].values,
        "duration_h": compared[f"{dimension}_duration"].values / SECONDS_AN_HOUR,
        "altitude_km": compared[f"{dimension}_altitude"].values / 1e3,
    }
    rows = zip(*columns.values(), strict=True)
    return [dict(zip(columns, map(float, row), strict=True)) for row in rows]


def _explanations(compared: "xr.Dataset") -> dict[str, Any]:
    independent = float(compared.independent_residuals)
    found: dict[str, Any] = {
        name: {end: _known(float(compared[f"{name}_{end}"])) for end in _VALUE}
        | {"unit": unit, "rms_km": float(compared[f"{name}_rms"]) / 1e3}
        for name, unit in EXPLANATIONS.items()
    }
    better, worse = sorted(found[name]["rms_km"] for name in EXPLANATIONS)
    before = float(compared.altitude_rms) / 1e3
    found |= {
        "flyer_kg": float(compared.flyer_mass),
        "rms_before_km": before,
        "independent": independent,
        "alike": _known(float(compared.explanations_alike)),
        "evidence": evidence(before * 1e3, better * 1e3, independent),
        "evidence_between": evidence(worse * 1e3, better * 1e3, independent),
    }
    return found | {"verdict": verdict(found)}


def _known(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _wind_table(rows: list[dict[str, float]], name: str) -> "Table":
    low, high = list(rows[0])[:2]
    return table_of(
        (name, "east [m/s]", "north [m/s]"),
        [
            (f"{row[low]:g} to {row[high]:g}", *(_plain(row[f"{way}_m_s"]) for way in _WAYS))
            for row in rows
        ],
        title="wind that is missing", pad_edge=False,
    )  # fmt: skip


def _plain(speed: float) -> str:
    """A speed without the sign of a zero."""
    return f"{round(speed, 2) + 0.0:.2f}"


def _ends(found: dict[str, Any]) -> list[float]:
    """A value and the ends of its interval, which are infinite where they are not known."""
    unknown = {"low": -np.inf, "high": np.inf}
    return [unknown[end] if found[end] is None else found[end] for end in _VALUE]


def _explanation_parts(found: dict[str, Any]) -> Parts:
    rows = [("as stated, in the track's wind", "", "", f"{found['rms_before_km']:.3f}")]
    for name, unit in EXPLANATIONS.items():
        one = found[name]
        ends = _ends(one)
        factor, shown = suitable(unit, ends)
        value, low, high = (f"{factor * end:+.3g}" for end in ends)
        label = f"{name.replace('_', ' ')} [{shown}]"
        rows.append((label, value, f"{low} to {high}", f"{one['rms_km']:.3f}"))
    headings = ("what would explain the altitudes", "add", "95 % interval", "rms [km]")
    yield table_of(headings, rows, pad_edge=False)
    yield found["verdict"]
    shares = (f"{_PERCENT * end / found['flyer_kg']:+.3g}" for end in _ends(found["mass"]))
    yield (
        "the mass is {} % ({} % to {} %) of the flyer's; it stands for all that weighs or lifts as "
        "much, such as a wrong absorptance".format(*shares)
    )
    if found["alike"] is not None:
        alike = f"{found['alike']:.2f}"
        yield f"what mass and wind change of the altitudes is alike to {alike} (1: the same)"
