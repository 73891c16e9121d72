"""Make the tables of what a chamber, and a film that is not isothermal, do to the kinetic force.

Run as ``python studies/kinetic_chamber/study.py [--only tables]``. Each solved point becomes a line
of ``points.jsonl`` and is not solved again; the package's tables are written from these lines.
"""

import argparse
import json
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from scipy.linalg import lu_solve

from lightflyer.kinetic_theory.chamber.cases import MEDIUM, ChamberCase, assemble_case
from lightflyer.kinetic_theory.chamber.enclosure import Chamber, Film
from lightflyer.kinetic_theory.chamber.linear import ChamberSystem
from lightflyer.kinetic_theory.disk.linear import solve_by_gmres
from lightflyer.kinetic_theory.model_gases import DIATOMIC

FOLDER = Path(__file__).parent
POINTS = FOLDER / "points.jsonl"
DATA = FOLDER.parents[1] / "src" / "lightflyer" / "data"

KNUDSEN = (0.12, 0.25, 0.06, 0.6, 0.03, 2.0)
FAR, VERY_FAR = 20.0, 60.0  # radii; the latter for a floor in open air
# floor, lid, side wall [radii], all solid: those first that matter most
GEOMETRIES = (
    (np.inf, np.inf, np.inf),
    (2.25, 4.0, 4.0), (3.0, 6.0, 6.0), (4.5, 9.0, 9.0), (2.25, 10.0, 10.0), (3.0, 12.0, 4.0),
    (1.0, 4.0, 4.0), (2.25, 6.0, 2.25), (4.0, 4.0, 4.0), (8.0, 8.0, 8.0), (2.0, 2.0, 2.0),
    (4.5, FAR, FAR), (0.5, 4.0, 4.0), (1.0, 10.0, 10.0), (4.0, 12.0, 1.5), (2.0, 2.0, 8.0),
    (9.0, FAR, FAR), (1.0, 2.0, 1.5), (4.0, 8.0, 15.0), (2.25, FAR, FAR),
    *((floor, VERY_FAR, VERY_FAR) for floor in (2.25, 1.0, 4.5, 0.5, 9.0)),
)  # fmt: skip
LIKE, UNLIKE = (0.85, 0.85), (0.8, 0.9)
OTHERS = {
    "local": Film(UNLIKE, (1.0, 1.0), local=True),
    "poor": Film((0.45, 0.55), (1.0, 1.0)),
    "poor_like": Film((0.5, 0.5), (1.0, 1.0)),
}
CHECKED = (GEOMETRIES[1], GEOMETRIES[3])  # that are solved for OTHERS too


@dataclass(frozen=True)
class Place:
    """A point of the table; distances in radii, infinite in open space."""

    knudsen: float
    floor: float
    lid: float
    wall: float

    @property
    def is_open(self) -> bool:
        """Whether there is no chamber."""
        return bool(np.isinf(self.wall))

    @property
    def chamber(self) -> Chamber | None:
        """What encloses the disk."""
        return None if self.is_open else Chamber(self.floor, self.lid, self.wall)


def places() -> Iterator[Place]:
    """All points, those first that matter most."""
    for geometry in GEOMETRIES:
        for knudsen in KNUDSEN:
            yield Place(knudsen, *geometry)


def measure(place: Place) -> dict[str, float]:
    """Solve a point: force [p A] and heat [p √(2RT) A] by temperature, of disk and of floor."""
    rarefaction = float(np.sqrt(np.pi) / 4.0 / place.knudsen)
    warm, chamber = (1.0, 1.0), place.chamber
    case = ChamberCase(rarefaction, Film(LIKE, warm), DIATOMIC, chamber, True)
    halves = assemble_case(case, MEDIUM)
    found = {}

    def system(film: Film) -> ChamberSystem:
        return ChamberSystem(halves, DIATOMIC, chamber, film)

    def keep(name: str, of: ChamberSystem, unknowns: np.ndarray) -> None:
        totals = of.totals(unknowns)
        found[f"{name}_force"] = float(totals.force)
        found[f"{name}_heat"] = float(sum(totals.heat))
        found[f"{name}_imbalance"] = float(totals.force + sum(totals.forces.values()))

    like = system(Film(LIKE, warm))
    keep("like", like, like.solve())
    if not place.is_open:
        keep("floor_like", system(Film(LIKE, (0.0, 0.0))), solved(like, warm_floor(like), like))
    unlike = system(Film(UNLIKE, warm))
    keep("unlike", unlike, solved(unlike, unlike.equations[1], like))
    if place.is_open or (place.floor, place.lid, place.wall) in CHECKED:
        for name, film in OTHERS.items():
            other = system(film)
            keep(name, other, other.solve())
    return found


def warm_floor(system: ChamberSystem) -> np.ndarray:
    """Right-hand side of a cold disk above a floor that is warmer by one unit."""
    right, (_, (_, _, flat)) = np.zeros(system.layout.size), system.surface_masks(1)
    right[system.layout.wall_temperature(1)][flat] = 1.0
    return right


def solved(system: ChamberSystem, right: np.ndarray, similar: ChamberSystem) -> np.ndarray:
    """Unknowns by the factors of a similar system, which precondition."""
    if system is similar:
        return lu_solve(similar.factors, right)
    matrix = system.equations[0]
    return solve_by_gmres(
        lambda vector: lu_solve(similar.factors, matrix @ vector), lu_solve(similar.factors, right)
    )[0]


def read_kept() -> dict[Place, dict[str, float]]:
    """The points solved so far."""
    if not POINTS.exists():
        return {}
    lines = (json.loads(line) for line in POINTS.read_text().splitlines())
    return {Place(**place): result for place, result in lines}


def write_tables(kept: dict[Place, dict[str, float]]) -> None:
    """Write the package's tables."""
    opened = {p.knudsen: result for p, result in kept.items() if p.is_open}
    chambers, local = [], []
    for place, found in sorted(kept.items(), key=lambda item: tuple(asdict(item[0]).values())):
        free = opened[place.knudsen]
        if place.is_open:
            ratios = (found[f"local_{name}"] / found[f"unlike_{name}"] for name in OF_DISK)
            local.append(_row((place.knudsen,), ratios))
            continue
        by_tac = found["unlike_force"] - found["like_force"]
        values = (
            by_tac / free["unlike_force"],
            found["unlike_heat"] / free["unlike_heat"],
            found["like_force"],
            found["unlike_force"],
            free["unlike_heat"] * np.sqrt(np.pi) / (MODES * sum(UNLIKE)),
            -found["floor_like_heat"] / found["like_heat"],
            found["floor_like_force"],
        )
        chambers.append(_row(asdict(place).values(), values))
    _write("kinetic_chamber.csv", CHAMBERS, chambers)
    _write("kinetic_local_balance.csv", LOCAL, local)


def _row(place: Iterable[object], values: Iterable[float]) -> str:
    return ",".join([*(str(part) for part in place), *(f"{value:.6g}" for value in values)])


def _write(name: str, head: str, rows: list[str]) -> None:
    partial = (DATA / name).with_suffix(".partial")
    partial.write_text(head + "\n".join(rows) + "\n")
    partial.rename(DATA / name)
    print(f"wrote {name}: {len(rows)} rows")


MODES = 1.5  # energy of diatomic molecules over that of atoms
OF_DISK = ("force", "heat")
CHAMBERS = """\
# What solid floor, lid and side wall do to a thin disk, distances in radii: small temperature
# differences, diatomic gas, linear kinetic equation (lightflyer.kinetic_theory), mean TAC 0.85;
# made by studies/kinetic_chamber/study.py. Licence: MIT, as this package.
# knudsen: mean free path over the disk's diameter; force_factor, heat_factor: force by the
# difference of the TACs, and heat, over open space; lift: force on a disk of like faces [p A per
# unit of the disk's T/T_c - 1]; force: of TACs 0.8 above and 0.9 below [as lift]; open_heat_ratio:
# heat in open space over that of free molecules. Of a disk of like faces as cold as lid and side
# wall, over a floor that is warmer: floor_share: heat that it takes over what it gives off if it is
# the warm one; floor_push: force on it [p A per unit of the floor's T/T_c - 1].
knudsen,floor,lid,wall,force_factor,heat_factor,lift,force,open_heat_ratio,floor_share,floor_push
"""
LOCAL = """\
# What force and heat of a film whose spots balance their own heat are, over those of an isothermal
# one of the same mean temperature: open space, small temperature differences, cooled by gas alone,
# TACs 0.8 and 0.9; made by studies/kinetic_chamber/study.py. Licence: MIT, as this package.
knudsen,force_factor,heat_factor
"""


def main() -> None:
    """Solve what is missing and write the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", choices=("tables",))
    asked = parser.parse_args()
    if asked.only:
        write_tables(read_kept())
        return
    kept = read_kept()
    missing = [place for place in places() if place not in kept]
    for number, place in enumerate(missing, 1):
        result = measure(place)
        with POINTS.open("a") as file:
            file.write(json.dumps([asdict(place), result]) + "\n")
        told = ", ".join(f"{name} {value:.5g}" for name, value in result.items())
        print(f"{number} of {len(missing)}: {place} {told}", flush=True)
    write_tables(read_kept())


if __name__ == "__main__":
    main()
