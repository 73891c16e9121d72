"""Compare the hot solver and the force model with simulations of Cercignani and Lampis's walls.

Run as ``python studies/direct_simulation/scattering.py``. Each solved point becomes a line of
``scattering.jsonl`` and is not solved again. A table is printed. What collisions take more than in
the model equation is also taken from the simulation of the same gas at Maxwell walls at the same
place, solved by ``studies/kinetic_collisions/comparison.py``: then only the walls are tested.
"""

import json
from collections.abc import Iterator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from dsmc.gas import GASES
from study import CL, FOLDER, Point, combined, label, read_runs

from lightflyer.array.namespace import float64
from lightflyer.force.kinetic.chamber import reservoir
from lightflyer.force.kinetic.collisions import (
    FORCE_HEATED,
    HEAT_HEATED,
    collision_fit,
    with_collisions,
)
from lightflyer.force.kinetic.ratios import kinetic_fit
from lightflyer.force.kinetic.walls import Accommodations, scattering_fit, wall_fit
from lightflyer.force.laws.faces import accommodated_force
from lightflyer.kinetic_theory.disk.cases import MEDIUM, Case, Resolution, solve_case
from lightflyer.kinetic_theory.model_gases import gas_model
from lightflyer.kinetic_theory.walls import Accommodation

SOLVED: Path = FOLDER / "scattering.jsonl"
MAXWELL: Path = FOLDER.parent / "kinetic_collisions" / "solved.jsonl"
FORCE_BIAS, HEAT_BIAS = -0.002, 0.0005  # of the simulation: see the README
Pair = tuple[float, float]
"""Force and heat over those of free molecules."""


class Compared(NamedTuple):
    """A simulation, less its bias, and what stands beside it."""

    simulated: Pair
    error: Pair  # standard errors
    solver: Pair
    corrected: Pair  # solver with the force model's factors of collisions
    model: Pair  # the force model
    # Force by the solver with the collisions that were simulated at Maxwell walls, and its standard
    # error
    by_walls: Pair


def kind_of(point: Point) -> str:
    """Gas of the tables."""
    return "diatomic" if GASES[point.gas].rotational_freedoms else "monatomic"


def case_of(point: Point) -> Case:
    """The same disk in the solver."""
    kind, tacs = kind_of(point), (point.tac_top, point.tac_bottom)
    top, bottom = (
        Accommodation(tac, float(1.0 - np.sqrt(1.0 - along)), tac)
        for tac, along in zip(tacs, point.tangential or tacs, strict=True)
    )
    mean = [
        float(np.mean(face.of_energy[: 3 if kind == "diatomic" else 2])) for face in (top, bottom)
    ]
    return Case(
        rarefaction=float(np.sqrt(np.pi) / (4.0 * point.knudsen)),
        tac=(mean[0], mean[1]),
        temperature=(point.temperature_ratio, point.temperature_ratio),
        linear=False,
        gas=replace(gas_model(kind), viscosity_exponent=GASES[point.gas].viscosity_exponent),
        boundary=point.boundary,
        wall="accommodated",
        scattering=(top, bottom),
    )


def solve_point(point: Point, resolution: Resolution = MEDIUM) -> Pair:
    """By the solver."""
    case = case_of(point)
    found, limit = solve_case(case, resolution), case.free_molecular()
    return found.force / limit.force, float(sum(found.heat) / sum(limit.heat))


def solved() -> dict[Point, Pair]:
    """Solutions at all points, which are solved where they are missing."""
    found = {}
    if SOLVED.exists():
        for line in SOLVED.read_text(encoding="utf-8").splitlines():
            place, pair = json.loads(line)
            tangential = place["tangential"] and tuple(place["tangential"])
            found[Point(**{**place, "tangential": tangential})] = tuple(pair)
    for point in combined(read_runs()):
        if point.wall == CL and point not in found:
            found[point] = solve_point(point)
            with SOLVED.open("a", encoding="utf-8") as file:
                rounded = [round(value, 6) for value in found[point]]
                file.write(json.dumps([asdict(point), rounded]) + "\n")
            print(label(point), found[point], flush=True)
    return found


def taken(point: Point) -> Pair:
    """What collisions of molecules take over those of the model equation, by the force model."""
    kind, case = kind_of(point), case_of(point)
    place = kind, point.temperature_ratio, case.gas.viscosity_exponent
    found = collision_fit(kind).factors(point.knudsen, place[-1], 0.5 * sum(case.tac))
    force, heat = (
        value * heated(*place)
        for value, heated in zip(found, (FORCE_HEATED, HEAT_HEATED), strict=True)
    )
    return float(force), float(heat)


def by_model(point: Point) -> Pair:
    """By what the force model is made of: it takes one tangential accommodation of both faces."""
    kind, case, excess = kind_of(point), case_of(point), point.temperature_ratio - 1.0
    mean, apart = 0.5 * sum(case.tac), case.tac[1] - case.tac[0]
    knudsen, fit = point.knudsen, kinetic_fit(kind)
    place = knudsen, 1.0 + excess, mean, apart, case.gas.viscosity_exponent
    linear = (knudsen, 1.0, mean, apart)
    opened = fit.force_ratio(*linear), fit.heat_ratio(*linear)
    factors = fit.wall_factors(knudsen, point.boundary, mean, apart)
    around = reservoir(factors, opened, knudsen, 1.0 + excess)
    ratios = around.force_ratio(fit.force_ratio(*place)), around.heat_ratio(fit.heat_ratio(*place))
    force, heat = (
        with_collisions(ratio, factor) for ratio, factor in zip(ratios, taken(point), strict=True)
    )
    assert case.scattering is not None
    top, bottom = (Accommodations(*face.of_energy) for face in case.scattering)
    tacs = scattering_fit(kind).effective(knudsen, (top, bottom))
    walls = wall_fit(kind)
    force *= walls.force_factor(knudsen, 1.0 + excess, mean)
    force *= accommodated_force(1.0, *tacs, 1.0, excess) / case.free_molecular().force
    drawn = [tac * walls.heat_factor(knudsen, 1.0 + excess, tac) for tac in case.tac]
    return float(force), float(heat * sum(drawn) / sum(case.tac))


def by_walls(point: Point, force: float, runs: dict[Point, Any]) -> Pair:
    """A force of the solver, with collisions as simulated at Maxwell walls at the same place."""
    maxwell = replace(point, wall="maxwell", tangential=None)
    solutions = (json.loads(line) for line in MAXWELL.read_text(encoding="utf-8").splitlines())
    (model,) = (
        found["force"]
        for place, found in solutions
        if place == {name: value for name, value in asdict(maxwell).items() if name in place}
    )
    simulated, error = runs[maxwell]["force"]
    simulated -= FORCE_BIAS
    factor = (1.0 / simulated - 1.0) / (1.0 / model - 1.0)
    found = float(with_collisions(force, factor))
    of_factor = error / simulated**2 / (1.0 / model - 1.0)
    return found, found * (1.0 - found) / factor * of_factor


def compared() -> dict[Point, Compared]:
    """All simulations at walls of Cercignani and Lampis."""
    runs, found = combined(read_runs()), {}
    for point, ratios in solved().items():
        simulated, error = zip(runs[point]["force"], runs[point]["heat"], strict=True)
        pairs = zip(ratios, taken(point), strict=True)
        force, heat = (float(with_collisions(ratio, factor)) for ratio, factor in pairs)
        unbiased = simulated[0] - FORCE_BIAS, simulated[1] - HEAT_BIAS
        walls = by_walls(point, ratios[0], runs)
        found[point] = Compared(unbiased, error, ratios, (force, heat), by_model(point), walls)
    return found


def table() -> Iterator[str]:
    """Simulations and what is beside them, as a table in Markdown."""
    ways = "solver", "with molecules", "force model"
    cells = [f"{name}, {way}" for name in ("F", "Q") for way in ways]
    cells.append("F, collisions as at Maxwell walls")
    yield "| point | F | Q | " + " | ".join(cells) + " |"
    yield "|---" * (3 + len(cells)) + "|"
    for point, row in compared().items():
        measured = [
            f"{value:.4f} ± {error:.4f}"
            for value, error in zip(row.simulated, row.error, strict=True)
        ]
        apart = [
            f"{100.0 * (way[k] / row.simulated[k] - 1.0):+.{1 + k}f} %"
            for k in (0, 1)
            for way in (row.solver, row.corrected, row.model)
        ]
        value, error = row.by_walls
        off = value - row.simulated[0]
        sigma = off / float(np.hypot(error, row.error[0]))
        apart.append(f"{100.0 * off / row.simulated[0]:+.1f} %, {sigma:+.1f} σ")
        tangential = point.tangential or (point.tac_top, point.tac_bottom)
        where = f"{point.gas}, Kn {point.knudsen:.2g}, {point.temperature_ratio:.3g}, "
        yield f"| {where}{tangential[0]:g}/{tangential[1]:g} | {' | '.join(measured + apart)} |"


if __name__ == "__main__":
    with float64():
        print("\n".join(table()))
