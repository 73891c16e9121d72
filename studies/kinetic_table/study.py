"""Make the tables of the kinetic force that ship with the package.

Run as ``python studies/kinetic_table/study.py [--only PART]``. Each solved point becomes a line of
``points.jsonl`` and is not solved again; the tables are written from these lines.
"""

import argparse
import json
import sys
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, replace
from itertools import groupby, product
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from lightflyer.array.namespace import float64
from lightflyer.force.kinetic.ratios import KineticFit
from lightflyer.kinetic_theory.disk.cases import COARSE, FINE, MEDIUM, Case, solve_case
from lightflyer.kinetic_theory.disk.linear import FaceResult, FaceWalls, LinearSystem, face_result
from lightflyer.kinetic_theory.disk.operators import assemble
from lightflyer.kinetic_theory.model_gases import GasModel, gas_model
from lightflyer.kinetic_theory.solver import furthest_boundary

FOLDER = Path(__file__).parent
sys.path.append(str(FOLDER.parent))

from kinetic_fits.common import some, table_of  # noqa: E402
from kinetic_fits.disk import fit  # noqa: E402

POINTS = FOLDER / "points.jsonl"
DATA = FOLDER.parents[1] / "src" / "lightflyer" / "data"
MESHES = {"fine": FINE, "medium": MEDIUM, "coarse": COARSE}
CORRECTED = "corrected"
"""Mesh of non-linear points of the coarse one, corrected by what the medium one changes at a mean
TAC of 0.8."""

GASES = ("monatomic", "diatomic")
# below 0.03 the meshes are those of a moving disk
DENSE = (0.006, 0.009, 0.013, 0.02)
KNUDSEN = (0.03, 0.05, 0.08, 0.125, 0.2, 0.35, 0.6, 1.0, 2.0, 5.0, 10.0, 30.0)
BETWEEN = (0.04, 0.065, 0.1, 0.16, 0.27, 0.45, 1.5, 3.0)
FINE_BELOW = 0.3  # Knudsen number above which the medium mesh is as good

SMALL = 0.1  # difference of the faces' TACs at most, and this share of twice the mean
TAC = (0.1, 0.2, 0.35, 0.55, 0.6, 0.8, 1.0)
# mean TAC and difference of faces that are very unlike
UNLIKE = ((0.35, 0.5), (0.6, 0.8), (0.2, 0.3), (0.55, 0.9), (0.8, 0.4), (0.65, 0.7))
DENSE_TAC, DENSE_UNLIKE = (0.1, 0.35, 0.6, 0.8, 1.0), UNLIKE[:2]
ALSO_TAC = (0.02, 0.2)  # Knudsen number and mean TAC, for a point of the non-linear problem
MOVED_TAC = 0.8  # mean for which reciprocity is checked
LINEAR_TAC = 0.5  # mean at which the linear problem is factorised for all of them

HOT_KNUDSEN = (0.05, 0.2, 1.0, 0.03, 0.125, 0.35, 0.08, 0.02, 3.0, 0.6, 5.0, 0.013, 2.0)
_ENDS = tuple(knudsen for knudsen in HOT_KNUDSEN if knudsen not in (0.013, 2.0, 3.0))
_SMOOTH = (0.03, 0.05, 0.125, 0.35, 1.0, 3.0)
_FEW = (0.05, 0.2, 1.0)
_EXTREME = (0.02, 0.03, 0.05, 0.08, 0.2, 0.35, 1.0, 3.0)
# T_h/T_c, mean TAC and viscosity exponent: gases and Knudsen numbers; neighbours in the order of
# solution. The other points of the non-linear problem, at ratios of 1.6 and 2.5 and mean TACs of
# 0.6, 0.8 and 1, were solved before: both gases and all of KNUDSEN, medium and corrected meshes
HOT = {
    (3.5, 0.8, None): (GASES, _ENDS),
    (3.5, 0.8, 0.95): (GASES[:1], (0.05, 0.35)),
    (3.5, 0.2, None): (GASES, _EXTREME),
    (2.5, 0.8, None): (GASES, (0.013, 0.02, 0.03, *_FEW)),
    (2.5, 0.8, 0.5): (GASES[:1], (0.02, 0.03, 0.08, 0.2, 1.0, 5.0)),
    (2.5, 0.8, 0.95): (GASES[:1], (0.02, 0.03, 0.08, 0.2, 1.0, 5.0)),
    (2.5, 0.35, None): (GASES, _SMOOTH),
    (2.5, 0.1, None): (GASES, _SMOOTH),
    (0.5, 0.8, None): (GASES, _ENDS),
    (0.5, 0.8, 0.95): (GASES[:1], (0.05, 0.35)),
    (2.5, 0.8, 0.93): (GASES[1:], (0.02, 0.05, 0.125, 0.2, 0.6, 2.0)),
    (3.5, 0.8, 0.93): (GASES[1:], (0.05, 0.125, 0.6)),
    (0.5, 0.8, 0.93): (GASES[1:], (0.05, 0.35)),
    (0.5, 0.2, None): (GASES, _EXTREME),
}

# faces that are very unlike, of a hot disk
UNLIKE_RATIO, UNLIKE_HOT = 2.5, UNLIKE[3:5]
UNLIKE_HOT_KNUDSEN = {
    "monatomic": (0.03, 0.08, 0.2, 0.6),
    "diatomic": (0.03, 0.05, 0.125, 0.35, 1.0),
}

BOUNDARIES = (2.0, 3.0, 4.0, 6.0, 10.0, 20.0, 50.0)
BOUNDARY_TAC = 0.85
BETTER_SHARE = 0.3
"""Of the coarse mesh's error in what heating does that is left on the others: at Kn 0.03 it is
0.8 %, 0.2 % once corrected, and 0.06 % on the medium mesh beside the fine one."""
LEAST_ERROR = {"force_ratio": 1e-4, "heat_ratio": 5e-5}  # relative


@dataclass(frozen=True)
class Point:
    """One solution: a place of a table and a mesh.

    ``ratio`` is T_h/T_c, 1 for the limit of small differences; ``difference`` that of the faces'
    TACs; ``exponent`` the viscosity's, None for that of the gas; an infinite ``boundary`` is open
    space.
    """

    gas: str
    knudsen: float
    ratio: float
    tac: float
    difference: float
    mesh: str
    exponent: float | None = None
    boundary: float = np.inf

    @property
    def model(self) -> GasModel:
        """Model gas, with the exponent of this point."""
        model = gas_model(self.gas)
        return model if self.exponent is None else replace(model, viscosity_exponent=self.exponent)

    @property
    def case(self) -> Case:
        """The faces' TACs lie above and below the mean by half of the difference."""
        half, linear = 0.5 * self.difference, self.ratio == 1.0
        temperature = 1.0 if linear else self.ratio
        return Case(
            rarefaction=float(np.sqrt(np.pi) / (4.0 * self.knudsen)),
            tac=(self.tac + half, self.tac - half),
            temperature=(temperature, temperature),
            linear=linear,
            gas=self.model,
            boundary=self.boundary,
        )


Result = dict[str, float]
Kept = dict[Point, Result]


def small_difference(tac: float) -> float:
    """A difference of TACs for which only its square's effect is left, and that is small."""
    return min(SMALL, 0.5 * tac)


def parts() -> dict[str, list[Point]]:
    """Points of each part of the study."""
    return {
        "linear": linear_points(),
        "boundary": boundary_points(),
        "nonlinear": list(nonlinear_points()),
        "checks": list(check_points()),
    }


def linear_points() -> list[Point]:
    """Both gases, mean TACs and the unlike faces, on two or three meshes."""
    faces = {
        is_dense: [(tac, small_difference(tac)) for tac in means] + list(unlike)
        for is_dense, means, unlike in ((False, TAC, UNLIKE), (True, DENSE_TAC, DENSE_UNLIKE))
    }
    return [
        Point(gas, knudsen, 1.0, *pair, mesh)
        for knudsen in sorted((*DENSE, *KNUDSEN, *BETWEEN), reverse=True)
        for mesh in MESHES
        if mesh != "fine" or knudsen < FINE_BELOW
        for gas in GASES
        for pair in (
            *faces[knudsen in DENSE],
            *([(ALSO_TAC[1], small_difference(ALSO_TAC[1]))] if knudsen == ALSO_TAC[0] else []),
        )
    ]


def boundary_points() -> list[Point]:
    """Reservoirs at distances that are resolved, and open space."""
    return [
        Point(gas, knudsen, 1.0, BOUNDARY_TAC, SMALL, "medium", boundary=place)
        for knudsen, gas, place in product(KNUDSEN, GASES, (*BOUNDARIES, np.inf))
        if place <= furthest_boundary(knudsen) or place == np.inf
    ]


def nonlinear_points() -> Iterator[Point]:
    """An irregular grid, dense where the answer varies; each starts from its neighbour's fields."""
    for knudsen, gas in product(HOT_KNUDSEN, GASES):
        for (ratio, tac, exponent), (gases, places) in HOT.items():
            if gas in gases and knudsen in places:
                yield coarse(gas, knudsen, ratio, tac, exponent=exponent)
    for gas, places in UNLIKE_HOT_KNUDSEN.items():
        for knudsen, pair in product(places, UNLIKE_HOT):
            yield Point(gas, knudsen, UNLIKE_RATIO, *pair, "coarse")
    for knudsen, ratio in ((0.05, 3.5), (0.35, 0.5)):
        yield replace(coarse("diatomic", knudsen, ratio, 0.8), mesh="medium")


def check_points() -> Iterator[Point]:
    """Places that the fit is not shown."""
    yield Point("diatomic", 0.08, 3.5, *UNLIKE[3], "coarse")
    yield Point("diatomic", 0.1, 0.5, *UNLIKE[1], "coarse")
    yield Point("monatomic", 0.125, 2.5, *UNLIKE[5], "coarse")
    yield coarse("diatomic", 0.08, 3.0, 0.8, exponent=0.93)
    for gas, knudsen, ratio, tac in (
        ("diatomic", 0.06, 3.0, 0.7),
        ("monatomic", 0.1, 0.75, 0.5),
        ("diatomic", 0.16, 2.0, 0.25),
        ("monatomic", 0.3, 3.2, 0.9),
        ("diatomic", 0.5, 0.6, 0.4),
        ("monatomic", 1.4, 2.0, 0.12),
    ):
        yield coarse(gas, knudsen, ratio, tac)
        yield replace(coarse(gas, knudsen, ratio, tac), ratio=1.0)
        yield replace(coarse(gas, knudsen, ratio, tac), ratio=1.0, mesh="medium")
    for ratio in (0.98, 1.02):  # a small difference, and its reverse
        yield coarse("diatomic", 0.125, ratio, 0.8)


def coarse(
    gas: str, knudsen: float, ratio: float, tac: float, exponent: float | None = None
) -> Point:
    """A point with a small difference of TACs on the coarse mesh."""
    return Point(gas, knudsen, ratio, tac, small_difference(tac), "coarse", exponent)


def solved(points: Iterable[Point]) -> Iterator[Kept]:
    """Solve points: linear ones of a mesh together, non-linear ones from a neighbour's fields."""
    wanted = list(points)
    linear = [point for point in wanted if point.ratio == 1.0]
    for _, group in groupby(linear, lambda point: (point.knudsen, point.mesh, point.boundary)):
        yield solve_linear(list(group))
    previous, fields = None, None
    for point in wanted:
        if point.ratio == 1.0:
            continue
        start = None
        if fields is not None and previous is not None and are_neighbours(previous, point):
            start = fields * (point.ratio - 1.0) / (previous.ratio - 1.0)
        outcome = solve_case(point.case, MESHES[point.mesh], start=start)
        previous, fields = point, outcome.fields
        yield {point: ratios(point, outcome.force, outcome.heat)}


def are_neighbours(one: Point, other: Point) -> bool:
    """Whether a solution is a start for another: gas, mesh and the sign of heating are the same."""
    same = replace(one, ratio=other.ratio, tac=other.tac, difference=other.difference)
    apart = (one.ratio - 1.0) / (other.ratio - 1.0)
    return replace(same, exponent=other.exponent) == other and apart > 0.0


def solve_linear(points: list[Point]) -> Kept:
    """Linear points of one mesh, whose rays are traced once."""
    first, level = points[0], MESHES[points[0].mesh]
    mesh = level.mesh(first.case.rarefaction, first.boundary)
    operators = assemble(mesh, first.case.rarefaction, level.quadrature)
    found: Kept = {}
    for gas, group in groupby(points, lambda point: point.gas):
        system = LinearSystem(operators, gas_model(gas), LINEAR_TAC)
        found |= {point: solve_in(system, point) for point in group}
    return found


def solve_in(system: LinearSystem, point: Point) -> Result:
    """A linear point; for one TAC also its force by reciprocity, the heat that motion draws."""
    weights, case = system.operators.mesh.face_weights, point.case

    def faces(walls: FaceWalls) -> list[FaceResult]:
        fields, _ = system.solve(walls)
        return [face_result(system, walls, fields[face], face) for face in (0, 1)]

    top, bottom = faces(FaceWalls(case.tac, case.temperature))
    force = float(weights @ (bottom.pressure - top.pressure))
    result = ratios(point, force, (float(weights @ top.heat), float(weights @ bottom.heat)))
    if (point.tac, point.difference) == (MOVED_TAC, SMALL):
        drawn = sum(weights @ face.heat for face in faces(FaceWalls(case.tac, (0.0, 0.0), 1.0)))
        result["drawn_ratio"] = float(drawn) / case.free_molecular().force
    return result


def ratios(point: Point, force: float, heat: tuple[float, float]) -> Result:
    """Force and heat of both faces over their free-molecular values."""
    limit = point.case.free_molecular()
    return {"force_ratio": force / limit.force, "heat_ratio": sum(heat) / sum(limit.heat)}


def read_kept() -> Kept:
    """The points solved so far."""
    found: Kept = {}
    if POINTS.exists():
        for line in POINTS.read_text().splitlines():
            place, result = json.loads(line)
            found[Point(**place)] = result
    return found


def keep(results: Kept) -> None:
    """Append solved points, a line each, at once."""
    lines = []
    for point, result in results.items():
        place = {k: v for k, v in asdict(point).items() if v is not None and v != np.inf}
        lines.append(json.dumps([place, {k: float(f"{v:.9g}") for k, v in result.items()}]) + "\n")
    with POINTS.open("a") as file:
        file.write("".join(lines))


TABLE_COLUMNS = (
    "gas,knudsen,temperature_ratio,tac,tac_difference,viscosity_exponent,force_ratio,heat_ratio,"
    "force_ratio_error,heat_ratio_error"
)
TABLE_COMMENTS = """\
# Force and heat loss of a thin disk over their exact free-molecular values for Maxwell walls, in
# open space, from the kinetic equation; made by studies/kinetic_table/study.py.
# knudsen: mean free path (mu/p) sqrt(pi R T_c/2) over the diameter, in the gas far away;
# temperature_ratio: T_h/T_c, where 1 is the linear limit; tac: mean of both faces, tac_difference:
# between them; viscosity_exponent: omega of mu ~ T^omega; heat_ratio: of both faces together.
# Errors are absolute, at 95 %: of meshes, and of the package's fit to this table where it is not
# shown the Knudsen number. Licence: MIT, as this package.
"""
BOUNDARY_COLUMNS = "gas,knudsen,boundary,force_factor,heat_factor"
BOUNDARY_COMMENTS = f"""\
# What a cold cylindrical reservoir of half-width and half-height `boundary` (disk radii) does to
# force and heat loss of a thin disk: factors over open space, from the linear kinetic equation
# (lightflyer.kinetic_theory) at a mean TAC of {BOUNDARY_TAC}; made by
# studies/kinetic_table/study.py.
# Further out than is resolved, the excess over 1 is taken to fall as 1/boundary.
# knudsen: mean free path over the disk's diameter. Licence: MIT, as this package.
"""
QUANTITIES = ("force_ratio", "heat_ratio")


def table_rows(found: Kept) -> list[tuple[Point, Result]]:
    """All places with their best values and the meshes' relative errors."""
    checks = set(parts()["checks"])
    places = {
        replace(point, mesh="")
        for point in found
        if point.boundary == np.inf and point.tac != BOUNDARY_TAC and point not in checks
    }
    growth_errors = errors_of_growth(found)
    ordered = sorted(
        places,
        key=lambda p: (p.gas, p.ratio, p.model.viscosity_exponent, p.knudsen, p.tac, p.difference),
    )
    return [(place, best(place, found, growth_errors)) for place in ordered]


def best(place: Point, found: Kept, growth_errors: dict[str, np.ndarray]) -> Result:
    """Values of a place, and their relative errors by the mesh.

    What heat does is taken from the best mesh on which it is known, the limit of small differences
    from the best of all.
    """
    cold = replace(place, ratio=1.0, exponent=None)
    levels = [level for level in MESHES if replace(cold, mesh=level) in found]
    fine, other = (found[replace(cold, mesh=level)] for level in levels[:2])
    errors = {name: abs(other[name] / fine[name] - 1.0) for name in QUANTITIES}
    if place.ratio == 1.0:
        return {name: fine[name] for name in QUANTITIES} | errors_by_name(errors)
    level = next(m for m in (*MESHES, CORRECTED) if replace(place, mesh=m) in found)
    same = found[replace(cold, mesh="medium" if level == CORRECTED else level)]
    hot = found[replace(place, mesh=level)]
    share = 1.0 if level == "coarse" else BETTER_SHARE
    for name in QUANTITIES:
        further = share * np.interp(np.log(place.knudsen), *growth_errors[name])
        errors[name] = float(np.hypot(errors[name], further))
    return {name: hot[name] * fine[name] / same[name] for name in QUANTITIES} | errors_by_name(
        errors
    )


def errors_by_name(errors: Result) -> Result:
    """Relative errors of force and heat, no smaller than two meshes agree by chance."""
    return {f"{name}_error": max(LEAST_ERROR[name], value) for name, value in errors.items()}


def errors_of_growth(found: Kept) -> dict[str, np.ndarray]:
    """Largest relative errors of what heat does on the coarse mesh, shape (2, n) over ln Kn."""
    seen: dict[str, dict[float, float]] = {name: {} for name in QUANTITIES}
    for point, hot in found.items():
        same = replace(point, mesh="medium")
        if point.ratio == 1.0 or point.mesh != "coarse" or same not in found:
            continue
        cold, cold_same = (found[replace(p, ratio=1.0)] for p in (point, same))
        for name in QUANTITIES:
            change = hot[name] / found[same][name] * cold_same[name] / cold[name] - 1.0
            place = float(np.log(point.knudsen))
            seen[name][place] = max(seen[name].get(place, 0.0), abs(change))
    return {name: np.transpose(sorted(errors.items())) for name, errors in seen.items()}


def as_table(rows: list[tuple[Point, Result]]) -> SimpleNamespace:
    """Rows of one gas as the package's table."""
    places = [
        (p.knudsen, p.ratio, p.tac, p.difference, p.model.viscosity_exponent) for p, _ in rows
    ]
    results = [
        [r[f"{name}{end}"] for end in ("", "_error") for name in QUANTITIES] for _, r in rows
    ]
    columns = np.hstack([places, results]).T
    columns[-2:] *= columns[-4:-2]  # absolute
    return SimpleNamespace(**dict(zip(TABLE_COLUMNS.split(",")[1:], columns, strict=True)))


def unseen(
    table: SimpleNamespace, walls: SimpleNamespace, gas: str
) -> tuple[np.ndarray, np.ndarray]:
    """Relative misfits of force and heat by fits that were not shown a row's Knudsen number.

    A row at the end of its series, of the same temperature ratio, TACs and exponent, is shown: a
    fit without it has nothing to go by.
    """
    series = np.stack(
        [table.temperature_ratio, table.tac, table.tac_difference, table.viscosity_exponent]
    )
    places = np.unique(series, axis=1, return_inverse=True)[1].ravel()
    ends = np.zeros(places.size, bool)
    for place in range(places.max() + 1):
        rows = np.flatnonzero(places == place)
        ends[rows[[table.knudsen[rows].argmin(), table.knudsen[rows].argmax()]]] = True
    misfits = misfit(fit(gas, table, walls), table)
    for knudsen in np.unique(table.knudsen[~ends]):
        hidden = ~ends & (table.knudsen == knudsen)
        found = fit(gas, some(table, ~hidden), walls)
        misfits[:, hidden] = misfit(found, table)[:, hidden]
    return misfits[0], misfits[1]


def misfit(found: KineticFit, table: SimpleNamespace) -> np.ndarray:
    """Relative deviations of a fit's force and heat from a table, shape (2, n)."""
    where = (
        table.knudsen,
        table.temperature_ratio,
        table.tac,
        table.tac_difference,
        table.viscosity_exponent,
    )
    with float64():
        force, heat = (np.asarray(f(*where)) for f in (found.force_ratio, found.heat_ratio))
    return np.stack([force / table.force_ratio - 1.0, heat / table.heat_ratio - 1.0])


def write_table(found: Kept) -> None:
    """Write the table of force and heat; its errors are those of meshes and fit."""
    lines = []
    for gas in GASES:
        rows = [row for row in table_rows(found) if row[0].gas == gas]
        table = as_table(rows)
        fit_errors = unseen(table, table_of("kinetic_boundary", gas), gas)
        lines += [
            table_row(point, result, errors)
            for (point, result), errors in zip(rows, np.transpose(fit_errors), strict=True)
        ]
    write_whole(DATA / "kinetic.csv", TABLE_COMMENTS, TABLE_COLUMNS, lines)


def table_row(point: Point, result: Result, fit_errors: np.ndarray) -> str:
    """One line of the table."""
    numbers = (
        point.knudsen,
        point.ratio,
        point.tac,
        point.difference,
        point.model.viscosity_exponent,
    )
    place = ",".join(f"{number:g}" for number in numbers)
    values = [f"{result[name]:.7g}" for name in QUANTITIES]
    errors = [
        f"{result[name] * np.hypot(result[f'{name}_error'], error):.1e}"
        for name, error in zip(QUANTITIES, fit_errors, strict=True)
    ]
    return ",".join((point.gas, place, *values, *errors))


def write_boundaries(found: Kept) -> None:
    """Write the factors of a reservoir."""
    rows = []
    for gas, knudsen in product(GASES, KNUDSEN):
        free = replace(boundary_points()[0], gas=gas, knudsen=knudsen, boundary=np.inf)
        near = [d for d in BOUNDARIES if d <= furthest_boundary(knudsen)]
        results = [found[replace(free, boundary=place)] for place in near]
        excess = [[r[name] / found[free][name] - 1.0 for name in QUANTITIES] for r in results]
        for place in BOUNDARIES:
            nearest = min(place, near[-1])
            values = excess[near.index(nearest)]
            force, heat = (1.0 + value * nearest / place for value in values)
            rows.append(f"{gas},{knudsen:g},{place:g},{force:.5f},{heat:.5f}")
    write_whole(DATA / "kinetic_boundary.csv", BOUNDARY_COMMENTS, BOUNDARY_COLUMNS, rows)


def write_whole(path: Path, comments: str, columns: str, rows: list[str]) -> None:
    """Write a CSV file, whole or not at all."""
    partial = path.with_suffix(".partial")
    partial.write_text(comments + columns + "\n" + "\n".join(rows) + "\n")
    partial.rename(path)
    print(f"wrote {path.name}: {len(rows)} rows")


def main() -> None:
    """Solve what is missing and write the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=(*parts(), "tables"))
    arguments = parser.parse_args()
    for part in [arguments.only] if arguments.only else parts():
        if part == "tables":
            continue
        found = read_kept()
        todo = [point for point in parts()[part] if point not in found]
        done = 0
        for results in solved(todo):
            keep(results)
            done += len(results)
            print(f"{part}: {done}/{len(todo)} {next(iter(results))}", flush=True)
    found = read_kept()
    write_boundaries(found)
    write_table(found)


if __name__ == "__main__":
    main()
