"""Make the table of the kinetic force on a disk with holes that ships with the package.

Run as ``python studies/kinetic_sandwich_table/study.py [--only PART]``. Each solved group of points
becomes a line of ``points.jsonl`` and is not solved again; the tables are written from these lines.
"""

import argparse
import json
from collections.abc import Iterator
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from lightflyer.kinetic_theory.disk.cases import (
    COARSE,
    FINE,
    MEDIUM,
    SMALLEST_ERROR,
    Case,
    DiskOutcome,
    Resolution,
    solve_case,
)
from lightflyer.kinetic_theory.disk.linear import FaceWalls, LinearSystem, face_result
from lightflyer.kinetic_theory.disk.operators import assemble
from lightflyer.kinetic_theory.model_gases import gas_model
from lightflyer.kinetic_theory.solver import FURTHEST_DEPTH

FOLDER = Path(__file__).parent
POINTS = FOLDER / "points.jsonl"
DATA = FOLDER.parents[1] / "src" / "lightflyer" / "data"

GASES = ("diatomic", "monatomic")
RAREFACTIONS = (0.03, 0.1, 0.3, 0.6, 1.2, 2.2, 4.0, 7.0, 12.0, 20.0, 35.0, 60.0, 100.0)
OPEN_FRACTIONS = (0.0, 0.1, 0.25, 0.4, 0.55, 0.7, 0.8, 0.9, 0.95, 0.99)
TACS = (0.6, 0.8, 1.0)
MIDDLE = (0.8, 0.5)  # mean TAC and open fraction at which a system is factorised
TAC_DIFFERENCE = 0.1  # of the two faces, top minus bottom

BOUNDARIES = (2.0, 3.0, 4.0, 6.0, 10.0, 20.0)
BOUNDARY_RAREFACTIONS = (0.1, 0.6, 2.2, 7.0, 20.0)
BOUNDARY_TAC = 0.85

CHECKED = {"gas": "monatomic", "tac": 0.8}  # above where the coarse mesh serves
CHECKED_RAREFACTIONS = (20.0, 60.0)
COARSE_SERVES = 20.0  # rarefaction up to which the difference to the coarse mesh is the error

HOT_RAREFACTIONS = (0.6, 2.2, 7.0)
HOT_OPEN_FRACTIONS = (0.0, 0.4, 0.8)
HOT_RATIOS = (2.4, 1.6)  # T/T_c, mean of both faces
HOT_TAC = 0.8
HOT_CHECKS = (  # between the points of the table: gas, rarefaction, open fraction, T/T_c
    ("monatomic", 4.0, 0.6, 2.0),
    ("diatomic", 1.2, 0.2, 1.3),
    ("diatomic", 12.0, 0.5, 1.6),
)
HALF_STEP = 0.08  # of T/T_c between a hot face and the mean

# simulations in helium whose force is known: rarefaction, half-width of a reservoir that is as
# large as theirs at δ = 1, and larger in denser gas, where theirs is not known
PUBLISHED = (
    (0.1, 3.0),
    (1.0, 3.0),
    (2.0, 3.0),
    (2.0, 4.0),
    (5.0, 4.0),
    (5.0, 6.0),
    (10.0, 6.0),
    (10.0, 10.0),
)
PUBLISHED_OPEN_FRACTIONS = (0.2, 0.6, 0.9)
PUBLISHED_RATIO = 4.0 / 3.0  # of the hot bottom face, of complete accommodation

NAMES = ("force", "tac_force", "heat", "heat_difference", "heat_cross")

Found = dict[str, dict[str, Any]]


def linear_group(
    gas: str, rarefaction: float, level: Resolution, boundary: float, tacs: tuple[float, ...]
) -> dict[str, list[float]]:
    """All open fractions and TACs at one rarefaction; a key for each, of the values in NAMES."""
    mesh = level.mesh(rarefaction, boundary)
    operators = assemble(mesh, rarefaction, level.quadrature)
    system = LinearSystem(operators, gas_model(gas), *MIDDLE)
    return {
        f"{open_fraction:g} {tac:g}": responses(system, open_fraction, tac)
        for open_fraction in OPEN_FRACTIONS
        for tac in tacs
    }


def responses(system: LinearSystem, open_fraction: float, tac: float) -> list[float]:
    """Responses to a temperature difference and to a TAC difference, over the free-molecular."""
    half = 0.5 * TAC_DIFFERENCE
    apart = FaceWalls((tac, tac), (-1.0, 1.0), open_fraction=open_fraction)
    unlike = FaceWalls((tac + half, tac - half), (1.0, 1.0), open_fraction=open_fraction)
    force, top, bottom = totals(system, apart)
    tac_force, hot_top, hot_bottom = totals(system, unlike)
    solid = 1.0 - open_fraction
    carried = solid * (1.5 if system.gas.has_rotation else 1.0) / np.sqrt(np.pi)
    return [
        force / (0.5 * solid * tac),
        tac_force / (-0.25 * solid * TAC_DIFFERENCE),
        (hot_top + hot_bottom) / (2.0 * carried * tac),
        (bottom - top) / (2.0 * carried * tac),
        (hot_top - hot_bottom) / (carried * TAC_DIFFERENCE),
    ]


def totals(system: LinearSystem, walls: FaceWalls) -> tuple[float, float, float]:
    """Upward force and the heat out of the top and the bottom face."""
    fields, _ = system.solve(walls)
    top, bottom = (face_result(system, walls, fields[face], face) for face in (0, 1))
    weights = system.operators.mesh.face_weights
    return (
        float(weights @ (bottom.pressure - top.pressure)),
        float(weights @ top.heat),
        float(weights @ bottom.heat),
    )


def hot_case(
    gas: str, rarefaction: float, open_fraction: float, ratio: float, *, apart: bool
) -> Case:
    """Two hot faces: of two temperatures and one TAC, or of one temperature and two TACs."""
    half, step = (0.0, HALF_STEP) if apart else (0.5 * TAC_DIFFERENCE, 0.0)
    return Case(
        rarefaction=rarefaction,
        tac=(HOT_TAC + half, HOT_TAC - half),
        temperature=(ratio - step, ratio + step),
        linear=False,
        gas=gas_model(gas),
        boundary=np.inf,
        open_fraction=open_fraction,
    )


def hot_group(gas: str, rarefaction: float, open_fraction: float, ratio: float) -> dict[str, Any]:
    """Responses of a hot disk, over the free-molecular values; nothing for heat_cross."""
    apart, unlike = (
        hot_case(gas, rarefaction, open_fraction, ratio, apart=word) for word in (True, False)
    )
    first = solve_case(apart, COARSE)
    second = solve_case(unlike, COARSE, start=first.fields)

    def difference(outcome: DiskOutcome | Any) -> float:
        return float(outcome.heat[1] - outcome.heat[0])

    free = apart.free_molecular(), unlike.free_molecular()
    return {
        "hot": [
            first.force / free[0].force,
            second.force / free[1].force,
            sum(second.heat) / sum(free[1].heat),
            difference(first) / difference(free[0]),
            difference(second) / difference(free[1]),
        ]
    }


def published_group(
    rarefaction: float, boundary: float, open_fraction: float
) -> dict[str, list[float]]:
    """Force and heat of the hot face as published: over p A ΔT/T and p √(2RT) A ΔT/T."""
    case = Case(
        rarefaction=rarefaction,
        tac=(1.0, 1.0),
        temperature=(1.0, PUBLISHED_RATIO),
        linear=False,
        gas=gas_model("monatomic"),
        boundary=boundary,
        open_fraction=open_fraction,
    )
    outcome = solve_case(case, COARSE)
    excess = PUBLISHED_RATIO - 1.0
    return {"published": [outcome.force / excess, outcome.heat[1] / excess]}


def linear_tasks() -> Iterator[tuple[str, Any]]:
    """Key and function of each group of the linear problem in open space."""
    levels = (("medium", MEDIUM), ("coarse", COARSE))
    for rarefaction, gas, (name, level) in product(RAREFACTIONS, GASES, levels):
        key = f"linear {gas} {rarefaction:g} {name}"
        yield key, partial(linear_group, gas, rarefaction, level, np.inf, TACS)


def boundary_tasks() -> Iterator[tuple[str, Any]]:
    """The same within reservoirs as far as they are resolved, and in open space."""
    for rarefaction, boundary in product(BOUNDARY_RAREFACTIONS, (np.inf, *BOUNDARIES)):
        if boundary == np.inf or boundary * rarefaction <= FURTHEST_DEPTH:
            key = f"boundary {rarefaction:g} {boundary:g}"
            tacs = (BOUNDARY_TAC,)
            yield key, partial(linear_group, "diatomic", rarefaction, COARSE, boundary, tacs)


def hot_tasks() -> Iterator[tuple[str, Any]]:
    """The same of the non-linear problem."""
    grid = product(("diatomic",), HOT_RAREFACTIONS, HOT_OPEN_FRACTIONS, HOT_RATIOS)
    for place in (*sorted(grid, key=lambda place: -place[-1]), *HOT_CHECKS):
        gas, *numbers = place
        key = " ".join(("hot", gas, *(f"{number:g}" for number in numbers)))
        yield key, partial(hot_group, *place)


def published_tasks() -> Iterator[tuple[str, Any]]:
    """Cases of the published simulations of a disk with holes."""
    for (rarefaction, boundary), open_fraction in product(PUBLISHED, PUBLISHED_OPEN_FRACTIONS):
        key = f"published {rarefaction:g} {boundary:g} {open_fraction:g}"
        yield key, partial(published_group, rarefaction, boundary, open_fraction)


def fine_tasks() -> Iterator[tuple[str, Any]]:
    """Dense gas on a mesh finer than that of the table."""
    gas, tac = CHECKED["gas"], (CHECKED["tac"],)
    for rarefaction in CHECKED_RAREFACTIONS:
        key = f"linear {gas} {rarefaction:g} fine"
        yield key, partial(linear_group, gas, rarefaction, FINE, np.inf, tac)


PARTS = {
    "linear": linear_tasks,
    "hot": hot_tasks,
    "boundary": boundary_tasks,
    "fine": fine_tasks,
    "published": published_tasks,
}


def read_found() -> Found:
    """The groups solved so far."""
    if not POINTS.exists():
        return {}
    return dict(json.loads(line) for line in POINTS.read_text().splitlines())


def keep(key: str, result: dict[str, Any]) -> None:
    """Append one solved group as a line."""
    rounded = {place: [round(v, 8) for v in values] for place, values in result.items()}
    with POINTS.open("a") as file:
        file.write(json.dumps([key, rounded]) + "\n")


COLUMNS = ("gas", "rarefaction", "open_fraction", "tac", *(f"{name}_ratio" for name in NAMES))
COMMENTS = f"""\
# Force and heat loss of a thin disk with holes over their exact free-molecular values for Maxwell
# walls, in open space, from the linear kinetic equation; made by
# studies/kinetic_sandwich_table/study.py.
# rarefaction: p a/(mu sqrt(2 R T)); open_fraction: share of the molecules that pass; tac: mean.
# force_ratio, heat_difference_ratio: faces of one TAC as much warmer and colder than the gas;
# heat_ratio: both faces as warm; tac_force_ratio, heat_cross_ratio: force and difference of the
# faces' heat if, then, their TACs differ by {TAC_DIFFERENCE}.
# Errors are absolute, from a second mesh. Licence: MIT, as this package.
"""
ERRORS = ("force_ratio_error", "tac_force_ratio_error", "heat_ratio_error")
ERROR_OF = {name: NAMES.index(name.removesuffix("_ratio_error")) for name in ERRORS}


def write_table(found: Found) -> None:
    """Write the table of the linear problem, of what is there."""
    rows = []
    for gas in GASES:
        for rarefaction in RAREFACTIONS:
            medium, coarse = (
                found.get(f"linear {gas} {rarefaction:g} {level}") for level in ("medium", "coarse")
            )
            if medium is None or coarse is None:
                print(f"{gas} at rarefaction {rarefaction:g} is incomplete and left out")
                continue
            for place, values in medium.items():
                others = coarse[place]
                if rarefaction > COARSE_SERVES:
                    others = finer_values(found, place.split()[0], values)
                errors = [
                    max(abs(values[k] - others[k]), min(SMALLEST_ERROR.values()) * abs(values[k]))
                    for k in ERROR_OF.values()
                ]
                numbers = [f"{value:.6f}" for value in values] + [f"{e:.1e}" for e in errors]
                rows.append(",".join((gas, f"{rarefaction:g}", *place.split(), *numbers)))
    write_whole("kinetic_sandwich.csv", COMMENTS, (*COLUMNS, *ERRORS), rows)


def finer_values(found: Found, open_fraction: str, values: list[float]) -> list[float]:
    """Values with the largest relative change that a finer mesh makes in dense gas."""
    place, changes = f"{open_fraction} {CHECKED['tac']:g}", [0.0] * len(values)
    for rarefaction in CHECKED_RAREFACTIONS:
        medium, fine = (
            found[f"linear {CHECKED['gas']} {rarefaction:g} {level}"][place]
            for level in ("medium", "fine")
        )
        ratios = [abs(x / y - 1.0) for x, y in zip(fine, medium, strict=True)]
        changes = [max(pair) for pair in zip(changes, ratios, strict=True)]
    return [value * (1.0 + change) for value, change in zip(values, changes, strict=True)]


BOUNDARY_COMMENTS = f"""\
# What a cold cylindrical reservoir of half-width and half-height `boundary` (disk radii) does to
# force and heat loss of a thin disk with holes: factors over open space, from the linear kinetic
# equation of a diatomic gas at a mean TAC of {BOUNDARY_TAC}; made by
# studies/kinetic_sandwich_table/study.py. Further out than is resolved, the excess over 1 is taken
# to fall as 1/boundary. Columns are those of kinetic_sandwich.csv. Licence: MIT, as this package.
"""
BOUNDARY_NAMES = ("force_factor", "tac_force_factor", "heat_factor", "heat_difference_factor")


def write_boundaries(found: Found) -> None:
    """Write the factors of a reservoir, at each rarefaction that is complete."""
    rows = []
    for rarefaction in BOUNDARY_RAREFACTIONS:
        near = [d for d in BOUNDARIES if d * rarefaction <= FURTHEST_DEPTH]
        free, *results = (
            found.get(f"boundary {rarefaction:g} {place:g}") for place in (np.inf, *near)
        )
        if free is None or None in results:
            print(f"boundaries at rarefaction {rarefaction:g} are incomplete and left out")
            continue
        for place in BOUNDARIES:
            nearest = min(place, near[-1])
            result = results[near.index(nearest)]
            for key, values in result.items():
                excess = (x / y - 1.0 for x, y in zip(values[:4], free[key][:4], strict=True))
                factors = [f"{1.0 + value * nearest / place:.5f}" for value in excess]
                rows.append(",".join((f"{rarefaction:g}", f"{place:g}", key.split()[0], *factors)))
    columns = ("rarefaction", "boundary", "open_fraction", *BOUNDARY_NAMES)
    write_whole("kinetic_sandwich_boundary.csv", BOUNDARY_COMMENTS, columns, rows)


HOT_COMMENTS = f"""\
# What heat does to the resistance of the gas around a thin disk with holes: the free-molecular
# value over the ratio of kinetic_sandwich.csv, less one, of a hot disk over that of a slightly warm
# one. From the non-linear kinetic equation of a diatomic gas at a mean TAC of {HOT_TAC}, in open
# space; made by studies/kinetic_sandwich_table/study.py.
# temperature_ratio: mean T/T_c of the faces; temperatures differ by {2 * HALF_STEP:g} T_c, or TACs
# by {TAC_DIFFERENCE}. Licence: MIT, as this package.
"""


def write_hot(found: Found) -> None:
    """Write the table of the non-linear problem, if it is complete."""
    rows = []
    for place in product(HOT_RAREFACTIONS, HOT_OPEN_FRACTIONS, HOT_RATIOS):
        numbers = [f"{number:g}" for number in place]
        hot = found.get(" ".join(("hot", "diatomic", *numbers)))
        cold = found.get(f"linear diatomic {numbers[0]} medium")
        if hot is None or cold is None:
            print(f"hot disk at {', '.join(numbers)} is missing: no table is written")
            return
        pairs = zip(hot["hot"][:4], cold[f"{numbers[1]} {HOT_TAC:g}"][:4], strict=True)
        growths = [f"{(1.0 / x - 1.0) / (1.0 / y - 1.0):.6f}" for x, y in pairs]
        rows.append(",".join((*numbers, *growths)))
    names = [f"{name}_growth" for name in NAMES[:4]]
    columns = ("rarefaction", "open_fraction", "temperature_ratio", *names)
    write_whole("kinetic_sandwich_hot.csv", HOT_COMMENTS, columns, rows)


def write_whole(name: str, comments: str, columns: tuple[str, ...], rows: list[str]) -> None:
    """Write a CSV file, whole or not at all."""
    if not rows:
        return
    path = DATA / name
    unfinished = path.with_suffix(".partial")
    unfinished.write_text(comments + ",".join(columns) + "\n" + "\n".join(rows) + "\n")
    unfinished.rename(path)
    print(f"wrote {name}: {len(rows)} rows")


def main() -> None:
    """Solve what is missing and write the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=(*PARTS, "tables"))
    arguments = parser.parse_args()
    found = read_found()
    for part in [arguments.only] if arguments.only else PARTS:
        for key, solve in PARTS[part]() if part in PARTS else ():
            if key not in found:
                keep(key, solve())
                print(key, flush=True)
    found = read_found()
    write_table(found)
    write_boundaries(found)
    write_hot(found)


if __name__ == "__main__":
    main()
