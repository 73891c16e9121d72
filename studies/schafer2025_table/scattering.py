"""Solve the published cases whose walls are those of Cercignani and Lampis.

Run as ``python studies/schafer2025_table/scattering.py``. Each solved point becomes a line of
``scattering.jsonl`` and is not solved again; a table beside the published simulations is printed.
About ten minutes on one core. The reservoirs are those of ``solve.py``.
"""

import csv
import json
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from solve import RATIO, RESERVOIRS

from lightflyer.array.namespace import float64
from lightflyer.force.kinetic.collisions import FORCE_HEATED, collision_fit, with_collisions
from lightflyer.kinetic_theory.disk.cases import MEDIUM, Case, solve_case
from lightflyer.kinetic_theory.model_gases import gas_model
from lightflyer.kinetic_theory.walls import Accommodation

FOLDER = Path(__file__).parent
PUBLISHED = FOLDER.parents[1] / "tests" / "validation" / "schafer2025_scattering.csv"
POINTS = FOLDER / "scattering.jsonl"
EXPONENT = 0.66  # of helium's viscosity
EXCESS = RATIO - 1.0
OPEN_FRACTIONS = (0.0, 0.2, 0.4, 0.6, 0.8, 0.9)
DENSEST = 5.0


class Place(NamedTuple):
    """A published case."""

    normal: float
    tangential: float  # of momentum
    beta: float
    delta: float


def published() -> dict[Place, tuple[float, ...]]:
    """Force and heat of both faces, in the units of the publication."""
    with PUBLISHED.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    names = "force", "heat_top", "heat_bottom"
    found = {
        Place(*(float(row[name]) for name in Place._fields)): tuple(float(row[n]) for n in names)
        for row in rows
    }
    return {
        place: values
        for place, values in found.items()
        if place.beta in OPEN_FRACTIONS and place.delta <= DENSEST
    }


def case_of(place: Place) -> Case:
    """The same disk in the solver."""
    face = Accommodation(place.normal, place.tangential, place.normal)
    tac = float(np.mean(face.of_energy[:2]))
    gas = replace(gas_model("monatomic"), viscosity_exponent=EXPONENT)
    reservoir = RESERVOIRS[place.delta]
    walls = place.beta, "accommodated", (face, face)
    return Case(place.delta, (tac, tac), (1.0, RATIO), False, gas, reservoir, *walls)


def solved() -> dict[Place, tuple[float, ...]]:
    """Force and heat of both faces by the solver, solved where they are missing."""
    lines = POINTS.read_text(encoding="utf-8").splitlines() if POINTS.exists() else []
    found = {Place(*place): tuple(values) for place, values in map(json.loads, lines)}
    for place in published():
        if place not in found:
            outcome = solve_case(case_of(place), MEDIUM)
            values = [round(value / EXCESS, 7) for value in (outcome.force, *outcome.heat)]
            found[place] = tuple(values)
            with POINTS.open("a", encoding="utf-8") as file:
                file.write(json.dumps([place, values]) + "\n")
            print(place, values, flush=True)
    return found


def with_molecules(place: Place, force: float) -> float:
    """A force of the model equation with the collisions of molecules of the force model."""
    case = case_of(place)
    knudsen = float(np.sqrt(np.pi) / (4.0 * place.delta))
    mean = 0.5 * (1.0 + RATIO)
    factor = collision_fit("monatomic").factors(knudsen, EXPONENT, case.tac[0])[0]
    factor *= FORCE_HEATED("monatomic", mean, EXPONENT)
    free = case.free_molecular().force / EXCESS
    return float(with_collisions(force / free, factor)) * free


def main() -> None:
    """Solve what is missing and print the table."""
    known, found = published(), solved()
    print("| α_n, σ_t | β | δ | F published | solver | with molecules | Q published | solver |")
    print("|---|---|---|---|---|---|---|---|")
    for place, (force, *_, hot) in known.items():
        own, *_, heat = found[place]
        apart = [value / force - 1.0 for value in (own, with_molecules(place, own))]
        print(
            f"| {place.normal:g}, {place.tangential:g} | {place.beta:g} | {place.delta:g} "
            f"| {force:.5f} | {100.0 * apart[0]:+.1f} % | {100.0 * apart[1]:+.1f} % "
            f"| {hot:.5f} | {100.0 * (heat / hot - 1.0):+.2f} % |"
        )


if __name__ == "__main__":
    with float64():
        main()
