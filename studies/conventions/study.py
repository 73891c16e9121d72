"""How many combinations of conventions give the paper's numbers.

    python studies/conventions/study.py [--workers 1]

Enumerates every combination of the conventions in ``model.py`` and writes ``results.json``: how
many meet which claims of the paper, what those that meet the first two have in common, and which
of them differ least from what the paper prints.
"""

import argparse
import itertools
import json
import math
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import model
import numpy as np

HERE = Path(__file__).parent
RESULTS = HERE / "results.json"

DISK = 0.01  # radius of the 2-cm disk [m]
OBLIQUE = math.cos(math.radians(45.0))
BAND_ALTITUDES = np.arange(58e3, 86.001e3, 125.0)
PAYLOAD_ALTITUDES = np.arange(50e3, 86.001e3, 500.0)
STEP = 0.05  # around the size of the largest payload [cm]
LARGEST_AT = (2.5, 3.5)  # the paper's 3 cm, of sizes that it draws at intervals [cm]
SIZES = (0.4, 0.6, 3.0, 4.70, 4.80, 2.45, 2.55, 3.45, 3.55)  # [cm]
CLAIMS = (
    "1: 68 km to 78 km",
    "2: 70 km to 76 km at 45 degrees",
    "3: lowest temperature 300 K",
    "4: 3 cm, 0.21 mg, 0.30, the largest payload",
    "5: largest disk 4.75 cm",
    "6: relative payload 1 at 0.5 cm",
)
EDGES = ((68.0, 78.0), (70.0, 76.0))  # [km]
WITHIN = 0.5  # of the printed edges: rounding [km]
TOLERANCE = 1.0  # of the report of "lightflyer paper" [km]
COLDEST, COLDEST_WITHIN = 300.0, 10.0
PAYLOAD, PAYLOAD_WITHIN = 0.21, 0.01  # [mg]
RELATIVE, RELATIVE_WITHIN = 0.30, 0.01
TOGETHER = ((1, 2), (1, 2, 3), (1, 2, 4), (1, 2, 4, 5), (1, 2, 4, 6), (1, 2, 5), (1, 2, 6),
            (4, 5), (4, 6), (5, 6), (4, 5, 6), (1, 2, 4, 5, 6), (1, 2, 3, 4, 5, 6))  # fmt: skip


@dataclass(frozen=True)
class Outcome:
    """Numbers of all heat laws (first axis) with all force laws (second) in one environment.

    ``edges``: lower, upper, and both at 45 degrees [km]. ``coldest`` [K]. ``payload`` over
    ``SIZES`` [mass of the disk].
    """

    edges: np.ndarray
    coldest: np.ndarray
    payload: np.ndarray


def edges_of(excess: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest altitude [km] at which ``excess`` is positive, on the last axis.

    NaN where it is nowhere, or still is at the end of the altitudes.
    """
    flies = excess >= 0.0
    last = excess.shape[-1] - 1
    found = []
    for side, start in ((1, np.argmax(flies, axis=-1)),
                        (-1, last - np.argmax(flies[..., ::-1], axis=-1))):  # fmt: skip
        inside, outside = start, np.clip(start - side, 0, last)
        first = np.take_along_axis(excess, outside[..., None], axis=-1)[..., 0]
        second = np.take_along_axis(excess, inside[..., None], axis=-1)[..., 0]
        with np.errstate(invalid="ignore", divide="ignore"):
            share = first / (first - second)
            step = BAND_ALTITUDES[inside] - BAND_ALTITUDES[outside]
            place = BAND_ALTITUDES[outside] + share * step
        known = flies.any(axis=-1) & (first < 0.0)
        found.append(np.where(known, place / 1e3, np.nan))
    return found[0], found[1]


def top(values: np.ndarray) -> np.ndarray:
    """Largest value on the last axis, by a parabola through three points."""
    best = np.clip(np.argmax(values, axis=-1), 1, values.shape[-1] - 2)[..., None]
    low, mid, high = (np.take_along_axis(values, best + k, axis=-1)[..., 0] for k in (-1, 0, 1))
    slope, bend = 0.5 * (high - low), high - 2.0 * mid + low
    with np.errstate(invalid="ignore", divide="ignore"):
        peak = mid - 0.5 * slope**2 / bend
    return np.where(bend < 0.0, np.maximum(peak, mid), np.maximum(np.maximum(low, mid), high))


def _bands(heats, forces, environment):
    """Edges (heat, force, 4) and coldest temperature (force)."""
    there = model.place(environment, BAND_ALTITUDES, DISK)
    hot = np.array([model.levitation_temperature(law, there) for law in forces])
    finite = np.where(np.isfinite(hot), hot, model.HOTTEST)
    absorbed = there.area * model.ABSORPTIVITY * model.SUNLIGHT
    radiated = model.radiated(finite, there)
    thin, dense = {}, {}
    for heat in heats:
        thin.setdefault(heat[:2], None)
        dense.setdefault((heat[6], heat[5]), None)
    thin = {key: model.free_molecular_heat(finite, there, *key) for key in thin}
    dense = {key: model.continuum_heat(finite, there, *key) for key in dense}
    edges = np.empty((len(heats), len(forces), 4))
    for row, heat in enumerate(heats):
        area, counted, faces = model.factors(heat)
        first, second = area * thin[heat[:2]], counted * dense[heat[6], heat[5]]
        needed = first * second / (first + second) + faces * radiated
        light = np.where(np.isfinite(hot), absorbed / needed, 0.0)
        for column, incidence in ((0, 1.0), (2, OBLIQUE)):
            edges[row, :, column], edges[row, :, column + 1] = edges_of(light * incidence - 1.0)
    return edges, hot.min(axis=-1)


def _payloads(heats, forces, environment):
    """Largest relative payload (heat, force, size)."""
    radii = 0.5e-2 * np.array(SIZES)[:, None]
    there = model.place(environment, PAYLOAD_ALTITUDES, radii)
    payload = np.empty((len(heats), len(forces), len(SIZES)))
    kinds = {(heat[0], heat[1], heat[5], heat[6]) for heat in heats}
    for kind in sorted(kinds):
        rows = [i for i, heat in enumerate(heats) if (heat[0], heat[1], heat[5], heat[6]) == kind]
        hots = model.temperature_in_light([heats[i] for i in rows], there)
        for row, hot in zip(rows, hots, strict=True):
            thin, dense = {}, {}
            for law in forces:
                thin.setdefault(law[0], None)
                dense.setdefault(law[1:], None)
            thin = {k: 1.0 / (model.C_FM * model.thin_force(hot, there, k)) for k in thin}
            dense = {k: 1.0 / (model.C_CONT * model.dense_force(hot, there, k)) for k in dense}
            lift = np.array([1.0 / (thin[law[0]] + dense[law[1:]]) for law in forces])
            payload[row] = top(lift / there.weight) - 1.0
    return payload


def outcome(heats, forces, environment) -> Outcome:
    """Numbers of every heat law with every force law in one environment."""
    edges, coldest = _bands(heats, forces, environment)
    coldest = np.broadcast_to(coldest, edges.shape[:2])
    return Outcome(edges, coldest, _payloads(heats, forces, environment))


def met(found: Outcome, within: float = WITHIN) -> np.ndarray:
    """Which of the six claims each combination meets, shape (6, heat, force)."""
    printed = np.array([edge for pair in EDGES for edge in pair])
    with np.errstate(invalid="ignore"):
        near = np.abs(found.edges - printed) <= within
    at = {size: found.payload[..., i] for i, size in enumerate(SIZES)}
    mass = {size: model.AREAL_DENSITY * math.pi * (0.5e-2 * size) ** 2 * 1e6 for size in SIZES}
    carried = {size: at[size] * mass[size] for size in SIZES}  # [mg]
    (low, low_next), (high, high_next) = (
        (round(size - STEP, 3), round(size + STEP, 3)) for size in LARGEST_AT
    )
    three = (
        (np.abs(carried[3.0] - PAYLOAD) <= PAYLOAD_WITHIN)
        & (np.abs(at[3.0] - RELATIVE) <= RELATIVE_WITHIN)
        & (carried[low_next] > carried[low])
        & (carried[high_next] < carried[high])
    )
    return np.array(
        [
            near[..., 0] & near[..., 1],
            near[..., 2] & near[..., 3],
            np.abs(found.coldest - COLDEST) <= COLDEST_WITHIN,
            three,
            (at[4.70] >= 0.0) & (at[4.80] < 0.0),
            (at[0.4] >= 1.0) & (at[0.6] < 1.0),
        ]
    )


def changes(heat, force, environment) -> list[str]:
    """In what a combination differs from what the paper prints."""
    chosen = (*environment, *heat, *force)
    printed = (*model.PRINTED_ENVIRONMENT, *model.PRINTED_HEAT, *model.PRINTED_FORCE)
    names = (*model.ENVIRONMENT, *model.HEAT, *model.FORCE)
    return [f"{n}: {c}" for n, c, p in zip(names, chosen, printed, strict=True) if c != p]


def summary_of(environment, heats=None, forces=None) -> dict:
    """Counts of one environment."""
    heats = model.all_of(model.HEAT) if heats is None else heats
    forces = model.all_of(model.FORCE) if forces is None else forces
    found = outcome(heats, forces, environment)
    claims = met(found)
    loose = met(found, TOLERANCE)
    both = claims[0] & claims[1]
    rows = [
        (heats[i], forces[k], found.coldest[i, k], claims[:, i, k]) for i, k in np.argwhere(both)
    ]
    return {
        "environment": environment,
        "combinations": int(claims[0].size),
        "each": [int(claim.sum()) for claim in claims],
        "together": [
            int(np.logical_and.reduce([claims[n - 1] for n in numbers]).sum())
            for numbers in TOGETHER
        ],
        "within_1_km": [int(loose[0].sum()), int(loose[1].sum()), int((loose[0] & loose[1]).sum())],
        "coldest_of_1_and_2_within_1_km": _least(found.coldest, loose[0] & loose[1]),
        "most_claims": _most(claims),
        "rows": [
            {
                "heat": heat,
                "force": force,
                "coldest": float(coldest),
                "claims": [n for n, yes in enumerate(which, 1) if yes],
                "changes": changes(heat, force, environment),
            }
            for heat, force, coldest, which in rows
        ],
    }


def _least(values: np.ndarray, where: np.ndarray) -> float | None:
    return float(values[where].min()) if where.any() else None


def _most(claims: np.ndarray) -> dict[str, int]:
    """How many combinations meet how many claims."""
    numbers, counts = np.unique(claims.sum(axis=0), return_counts=True)
    return {str(n): int(c) for n, c in zip(numbers, counts, strict=True)}


def report(parts: list[dict]) -> dict:
    """All environments together."""
    rows = [dict(row, environment=part["environment"]) for part in parts for row in part["rows"]]
    names = (*model.ENVIRONMENT, *model.HEAT, *model.FORCE)
    shares: dict[str, dict[str, int]] = {
        name: dict.fromkeys(choices, 0)
        for name, choices in (model.ENVIRONMENT | model.HEAT | model.FORCE).items()
    }
    for row in rows:
        chosen = (*row["environment"], *row["heat"], *row["force"])
        for name, choice in zip(names, chosen, strict=True):
            shares[name][choice] += 1
    fewest = min((len(row["changes"]) for row in rows), default=0)
    most: dict[str, int] = {}
    for part in parts:
        for number, count in part["most_claims"].items():
            most[number] = most.get(number, 0) + count
    cold = [row["coldest"] for row in rows]
    looser = [part["coldest_of_1_and_2_within_1_km"] for part in parts]
    return {
        "conventions": model.ENVIRONMENT | model.HEAT | model.FORCE,
        "combinations": sum(part["combinations"] for part in parts),
        "meet": dict(zip(CLAIMS, _sums(parts, "each"), strict=True)),
        "meet_together": {
            " ".join(map(str, numbers)): count
            for numbers, count in zip(TOGETHER, _sums(parts, "together"), strict=True)
        },
        "meet_within_1_km": dict(zip(("1", "2", "1 2"), _sums(parts, "within_1_km"), strict=True)),
        "number_of_claims_met": dict(sorted(most.items())),
        "coldest_of_those_that_meet_1_and_2_k": [round(min(cold), 2), round(max(cold), 2)],
        "coldest_of_those_within_1_km_k": round(min(t for t in looser if t is not None), 2),
        "by_atmosphere_gas_and_gravity": [_one_environment(part) for part in parts],
        "choices_of_those_that_meet_1_and_2": shares,
        "fewest_changes_from_printed": fewest,
        "with_fewest_changes": sorted(
            {"; ".join(row["changes"]) for row in rows if len(row["changes"]) == fewest}
        ),
        "most_claims_of_those_that_meet_1_and_2": _best(rows),
    }


def _one_environment(part: dict) -> dict:
    """Counts of one environment, and the coldest disks of those that meet 1 and 2 [K]."""
    cold = [row["coldest"] for row in part["rows"]]
    return {
        "environment": " | ".join(part["environment"]),
        "combinations": part["combinations"],
        "meet": dict(zip(map(str, range(1, 7)), part["each"], strict=True)),
        "meet_together": {
            " ".join(map(str, numbers)): count
            for numbers, count in zip(TOGETHER, part["together"], strict=True)
        },
        "coldest_k": [round(min(cold), 2), round(max(cold), 2)] if cold else None,
    }


def _best(rows: list[dict]) -> dict:
    most = max((len(row["claims"]) for row in rows), default=0)
    best = [row for row in rows if len(row["claims"]) == most]
    claims = sorted({" ".join(map(str, row["claims"])) for row in best})
    nearest = min(best, key=lambda row: len(row["changes"]))
    return {"claims": claims, "combinations": len(best), "nearest to printed": nearest["changes"]}


def _sums(parts: list[dict], name: str) -> list[int]:
    return [sum(counts) for counts in zip(*(part[name] for part in parts), strict=True)]


def main() -> None:
    """Enumerate everything and write the results."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--workers", type=int, default=1)
    workers = parser.parse_args().workers
    environments = model.all_of(model.ENVIRONMENT)
    with ProcessPoolExecutor(workers) as pool:
        parts = list(pool.map(summary_of, environments))
    results = report(parts)
    RESULTS.write_text(json.dumps(results, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    for name, count in itertools.chain(
        [("combinations", results["combinations"])],
        results["meet"].items(),
        results["meet_together"].items(),
    ):
        print(f"{name:45} {count}")
    print(f"wrote {RESULTS}")


if __name__ == "__main__":
    main()
