"""What can fly where: the best of each kind of flyer over altitude; see README.md."""

import argparse
import copy
import hashlib
import json
import time
from pathlib import Path

import numpy as np
from kinds import KINDS, SMALLEST

import lightflyer as lf
from lightflyer.core.atomic_files import output_directory
from lightflyer.search.objectives import ObjectiveFunction
from lightflyer.search.optimiser import find_optimum
from lightflyer.search.problem import as_problem
from lightflyer.statics.equations import FlightEquations
from lightflyer.uncertainty.inputs import draw, uncertain_inputs
from lightflyer.uncertainty.targets import tabulate_samples

HERE = Path(__file__).parent
RESULTS = HERE / "results.json"
ALTITUDES_KM = tuple(range(20, 101, 5))
OBJECTIVES = ("payload", "payload_per_area")
STARTS, SAMPLES, SEED = 6, 500, 0
MANY_SEEDS = {"hollow sphere, corrected": 8, "hollow rocket, corrected": 8}  # several optima
PERCENTILES = (2.5, 97.5)
REPORTED = (*OBJECTIVES, "relative_payload", "lift_over_weight", "temperature", "pressure")


def flyer_file(kind, values=()):
    """The kind's flyer file with some numbers replaced, in SI units, each with its ±."""
    content = copy.deepcopy(kind.file)
    for name, value in dict(values).items():
        *path, key = name.split(".")
        section = content
        for part in path:
            section = section[part]
        spread = kind.absolute.get(name, kind.relative.get(name, 0.0) * value)
        unit = " m" if isinstance(section[key], str) else ""
        text = f"{value:.9g} ± {spread:.3g}" if spread else f"{value:.9g}"
        section[key] = f"{text}{unit}" if unit or spread else value
    return lf.FlyerFile(**content)


def bounds(low, high):
    """Bounds of a free number; in the logarithm where they have a unit."""
    return {"from": low, "to": high} | ({"scale": "log"} if isinstance(low, str) else {})


def problem_of(kind, largest, objective, altitude_km, seed=SEED):
    """What is maximised for a kind."""
    over = {name: bounds(*ends) for name, ends in kind.free.items()}
    over |= {kind.size: bounds(SMALLEST, f"{largest} m"), "altitude": f"{altitude_km} km"}
    for name, (low, high) in kind.shares.items():
        ends = f"{low * largest} m", f"{high * largest} m"
        over[name] = ends[0] if low == high else bounds(*ends)
    return as_problem(
        flyer_file(kind),
        None,
        None,
        maximise=objective,
        over=over,
        starts=STARTS,
        seed=seed,
        beyond_range=True,
        constraints={"temperature": {"at_most": f"{kind.hottest} K"}},
    )


def best_of(kind, largest, objective, altitude_km):
    """The best design of a kind at an altitude, as a row of the results."""
    begun = time.perf_counter()
    row = {
        "kind": kind.name,
        "largest_m": largest,
        "objective": objective,
        "altitude_km": altitude_km,
    }
    try:
        case = (largest, objective, altitude_km)
        searches = [
            find_optimum(ObjectiveFunction(problem_of(kind, *case, seed)))
            for seed in range(SEED, SEED + MANY_SEEDS.get(kind.name, 1))
        ]
        found = max(searches, key=lambda search: search.value)
        fixed = {name: value for name, value in found.problem.fixed.items() if name != "altitude"}
        design = fixed | found.design
        row |= {
            "design": {name: float(f"{value:.6g}") for name, value in design.items()},
            "at_bounds": found.active_bounds,
            "agreeing": [found.agreeing, found.starts],
            **outcomes(kind, design, 1e3 * altitude_km),
            "warnings": list(found.warnings),
        }
    except lf.LightflyerError as error:
        row["trouble"] = str(error)
    return row | {"seconds": round(time.perf_counter() - begun, 1)}


def outcomes(kind, design, altitude):
    """Outputs of a design, and the 95 % bands of its payloads by Monte Carlo."""
    built = flyer_file(kind, design).design()
    inputs = uncertain_inputs(built)
    drawn = np.vstack([inputs.values, draw(inputs, SAMPLES, SEED)])
    table = tabulate_samples(inputs, drawn, np.array([altitude]))
    found = {"buoyancy_share": buoyancy_share(built.setup, altitude)}
    found["own_mass"] = float(f"{float(built.setup.flyer.own_mass):.6g}")
    for name in REPORTED:
        found[name] = float(f"{table[name][0, 0]:.6g}")
    for name in OBJECTIVES:
        ends = np.percentile(table[name][1:, 0], PERCENTILES)
        found[f"{name}_95"] = [float(f"{end:.4g}") for end in ends]
    return found


def buoyancy_share(setup, altitude):
    """Share of the lift that is buoyancy."""
    state = setup.environment.state(altitude)
    balance = lf.equilibrium(setup.flyer, state, setup.model)
    lift = lf.lift(setup.flyer, state, setup.model)
    warm = FlightEquations(setup.flyer, state, setup.model).buoyancy(balance.unknowns)
    return float(f"{float(warm / lift):.4g}")


def fingerprint(kind):
    """Of all that a row rests on."""
    about = repr((kind, SMALLEST, STARTS, SAMPLES, SEED))
    about += str(MANY_SEEDS.get(kind.name, ""))
    return hashlib.sha256(about.encode()).hexdigest()[:12]


def cases(kind):
    """Largest size, objective and altitude of each search.

    Where the size is free, payload per area is best at the largest bound of it as well.
    """
    for largest in kind.sizes:
        free = kind.size not in kind.shares
        for objective in OBJECTIVES[:1] if free and largest < max(kind.sizes) else OBJECTIVES:
            yield from ((largest, objective, altitude) for altitude in ALTITUDES_KM)


def main():
    """Compute what is missing, one row at a time, and draw."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kinds", default="", help="only those whose name contains this")
    parser.add_argument("--draw", action="store_true", help="draw only")
    asked = parser.parse_args()
    for kind in KINDS:
        if not asked.draw and asked.kinds in kind.name:
            compute(kind)
    from drawing import draw_all

    draw_all(read(), HERE)


def compute(kind):
    """Compute the rows of a kind that are missing."""
    for row in (rows := read()):
        if row["kind"] == kind.name and "design" in row and "buoyancy_share" not in row:
            setup = flyer_file(kind, row["design"]).build()
            row["buoyancy_share"] = buoyancy_share(setup, 1e3 * row["altitude_km"])
    write(rows)
    done = {(row["largest_m"], row["objective"], row["altitude_km"])
            for row in read() if row["kind"] == kind.name}  # fmt: skip
    missing = [case for case in cases(kind) if case not in done]
    for case in missing:
        row = best_of(kind, *case)
        write([*read(), row | {"of": fingerprint(kind)}])
        told = row.get("trouble") or f"{1e6 * row['payload']:.4g} mg, {row['design']}"
        print(kind.name, *case, told, row["seconds"], flush=True)


def read():
    """The rows that are there and rest on what the kinds are now."""
    rows = json.loads(RESULTS.read_text("utf-8")) if RESULTS.exists() else []
    known = {kind.name: fingerprint(kind) for kind in KINDS}
    return [row for row in rows if known.get(row["kind"]) == row["of"]]


def write(rows):
    """Write the rows, all or none."""
    order = [kind.name for kind in KINDS]
    rows.sort(
        key=lambda row: (
            order.index(row["kind"]),
            row["largest_m"],
            row["objective"],
            row["altitude_km"],
        )
    )
    text = ",\n".join(json.dumps(row, ensure_ascii=False) for row in rows)
    with output_directory(HERE) as stage:
        stage(RESULTS.name).write_text(f"[\n{text}\n]\n", encoding="utf-8")


if __name__ == "__main__":
    main()
