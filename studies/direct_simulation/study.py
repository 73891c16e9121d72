"""Force and heat of a hot disk by direct simulation, beside another program's.

Run as ``python studies/direct_simulation/study.py [--runs 2] [--only WORD]``. Each run of a point
becomes a line of ``points.jsonl`` and is not made again; ``--table`` prints what is there.
"""

import argparse
import csv
import json
import math
import time
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from dsmc.cells import fits
from dsmc.gas import GASES, HARD_SPHERE_PATH
from dsmc.simulation import Block, Numerics, Simulation
from dsmc.vessel import build_vessel
from dsmc.walls import build_faces

FOLDER = Path(__file__).parent
POINTS = FOLDER / "points.jsonl"
PEERS = FOLDER / "peer.csv", FOLDER / "peer_floor.csv"

FLIGHT = round(480.0 / 205.0, 6)  # T_h/T_c of the 2-cm disk
BLOCKS = 40
BLOCK_TIME = 500.0  # [radii/√(2RT_c)], many times the relaxation of the gas in the reservoir
WARM_UP_TIME = 250.0
# of a time step: relative to the time between collisions λ/v̄, and to crossing a cell's width
_COLLISION_SHARE, _CELL_SHARE = 0.17, 1.0
_WIDTHS, _FINE_WIDTHS = (0.1,), (1.0 / 15.0, 1.0 / 16.0)  # the first that the vessel is made of
_DENSE = 0.2  # Knudsen number below which cells are fine
_MEAN_SPEED = 2.0 / math.sqrt(math.pi)
# means over blocks, and the name of each in the results
MEASURED = (
    "force",
    "force_reservoir",
    "heat",
    "heat_top",
    "heat_bottom",
    "heat_reservoir",
)
MEASURED_ON_FLOOR = ("force_floor", "heat_floor")  # where it is solid


@dataclass(frozen=True)
class Point:
    """One case; the Knudsen number is the package's."""

    gas: str
    knudsen: float
    temperature_ratio: float
    tac_top: float
    tac_bottom: float
    wall: str = "maxwell"
    boundary: float = 4.0
    floor: float | None = None  # distance below the disk, where not `boundary`
    solid: str = ""  # parts of the vessel that are walls
    floor_temperature: float = 1.0  # over that of the rest
    # accommodation of tangential energy, top and bottom, where it is not the TAC
    tangential: tuple[float, float] | None = None

    @property
    def measured(self) -> tuple[str, ...]:
        """Quantities."""
        return MEASURED + (MEASURED_ON_FLOOR if "floor" in self.solid else ())


Run = tuple[Point, int, dict[str, tuple[float, float]]]
"""A point, the seed, and mean and standard error of each measured quantity."""

_TENTH, _THIRD = (round(number / HARD_SPHERE_PATH, 6) for number in (0.1, 0.3))
_ONE = 10.0 * _TENTH
CL = "cercignani-lampis"
_HIGH, _LOW = 2.25, 1.0  # disk of 4 cm, and one of 9 cm, 4.5 cm above a floor
POINTS_TO_RUN = [
    Point("nitrogen", _THIRD, FLIGHT, 0.5, 1.0),
    *(
        Point("nitrogen", _THIRD, FLIGHT, 0.4, 1.0, wall, boundary=2.0)
        for wall in ("maxwell", "accommodated", CL)
    ),
    *(
        Point("nitrogen", knudsen, FLIGHT, 0.01, 1.0, floor=floor, solid=solid)
        for knudsen, floor, solid in (
            (_THIRD, _HIGH, "floor"),
            (_TENTH, _HIGH, "floor"),
            (_THIRD, _LOW, "floor"),
            (_THIRD, _HIGH, ""),
        )
    ),
    # faces as good as alike: what pushes is the floor
    *(
        Point("nitrogen", kn, FLIGHT, 0.99, 1.0, floor=_HIGH, solid="floor")
        for kn in (_THIRD, _TENTH)
    ),
    # tangential motion that accommodates otherwise than the rest, by Cercignani and Lampis
    *(
        Point(gas, _THIRD, FLIGHT, 0.4, 1.0, CL, boundary=2.0, tangential=tangential)
        for gas in ("nitrogen", "argon", "hard spheres")
        for tangential in ((0.9, 0.9), (1.0, 0.4))
    ),
    *(
        Point(gas, knudsen, ratio, 0.4, 1.0, CL, boundary=2.0, tangential=tangential)
        for gas, knudsen, ratio, tangential in (
            ("carbon dioxide", _ONE, FLIGHT, (1.0, 0.4)),
            ("argon", _ONE, FLIGHT, (0.9, 0.9)),
            ("helium", _THIRD, FLIGHT, (1.0, 0.4)),
            ("helium", _THIRD, 1.5, (0.9, 0.9)),
        )
    ),
    # what heating does to collisions, by TACs and viscosity exponent
    *(
        Point(gas, _THIRD, FLIGHT, top, 1.0, boundary=2.0)
        for gas, tops in (
            ("hard spheres", (0.01, 0.4, 0.7)),
            ("argon", (0.4, 0.7)),
            ("nitrogen", (0.7,)),
            ("carbon dioxide", (0.4,)),
        )
        for top in tops
    ),
    # the other places of those walls, at Maxwell's
    *(
        Point(gas, knudsen, ratio, 0.4, 1.0, boundary=2.0)
        for gas, knudsen, ratio in (
            ("carbon dioxide", _ONE, FLIGHT),
            ("argon", _ONE, FLIGHT),
            ("helium", _THIRD, FLIGHT),
            ("helium", _THIRD, 1.5),
        )
    ),
    # and a warm one, beside a reservoir and beside a cold side wall
    *(
        Point("nitrogen", _THIRD, 1.2, 0.99, 1.0, "maxwell", 4.0, _HIGH, solid, 1.5)
        for solid in ("floor lid", "floor side")
    ),
]


def numerics(point: Point) -> Numerics:
    """Time step and cells of a point."""
    dense = point.knudsen < _DENSE
    widths, particles = (_FINE_WIDTHS, 16.0) if dense else (_WIDTHS, 20.0)
    distances = (point.boundary, point.floor or point.boundary)
    width = next(w for w in widths if all(fits(distance, w) for distance in distances))
    collision = 2.0 * point.knudsen / _MEAN_SPEED
    duration = min(_COLLISION_SHARE * collision, _CELL_SHARE * width / _MEAN_SPEED)
    return Numerics(duration, width, particles)


def simulation(point: Point, seed: int) -> Simulation:
    """A point's simulation."""
    gas = GASES[point.gas]
    faces = build_faces(
        point.wall,
        (point.tac_top, point.tac_bottom),
        (point.temperature_ratio, point.temperature_ratio),
        gas.rotational_freedoms,
        point.tangential,
    )
    vessel = build_vessel(
        point.boundary, point.floor, solid=point.solid, floor_temperature=point.floor_temperature
    )
    return Simulation(gas, point.knudsen, faces, vessel, numerics(point), seed)


def measure(point: Point, seed: int) -> Run:
    """Simulate a point once."""
    made = simulation(point, seed)
    warm_up, steps = (round(t / made.duration) for t in (WARM_UP_TIME, BLOCK_TIME))
    blocks = []
    for block in made.blocks(BLOCKS, steps, warm_up):
        blocks.append(block)
        print(f"\r{label(point)}, seed {seed}: block {len(blocks)}/{BLOCKS} ", end="", flush=True)
    print()
    return point, seed, means(blocks, point.measured)


def means(blocks: list[Block], names: Iterable[str] = MEASURED) -> dict[str, tuple[float, float]]:
    """Mean and standard error of each quantity by means over blocks."""
    found = {}
    for name in names:
        values = np.array([getattr(block, name) for block in blocks])
        error = values.std(ddof=1) / math.sqrt(values.size)
        found[name] = (float(values.mean()), float(error))
    return found


def combined(runs: Iterable[Run]) -> dict[Point, dict[str, tuple[float, float]]]:
    """Mean over the runs of each point, which are equally long."""
    together = defaultdict(list)
    for point, _, result in runs:
        together[point].append(result)
    found = {}
    for point, results in together.items():
        values = np.array([[result[name] for name in point.measured] for result in results])
        errors = np.sqrt((values[..., 1] ** 2).sum(axis=0)) / len(results)
        pairs = zip(values[..., 0].mean(axis=0).tolist(), errors.tolist(), strict=True)
        found[point] = dict(zip(point.measured, pairs, strict=True))
    return found


def read_runs() -> list[Run]:
    """The runs made so far."""
    if not POINTS.exists():
        return []
    lines = [json.loads(line) for line in POINTS.read_text(encoding="utf-8").splitlines()]
    return [
        (_read_point(place), seed, {name: tuple(pair) for name, pair in result.items()})
        for place, seed, _, result in lines
    ]


def _read_point(place: dict[str, Any]) -> Point:
    pair = place.get("tangential")
    return Point(**{**place, "tangential": None if pair is None else tuple(pair)})


def keep(run: Run, seconds: float) -> None:
    """Append a run as a line."""
    point, seed, result = run
    rounded = {name: [round(x, 6) for x in pair] for name, pair in result.items()}
    how = asdict(numerics(point)) | {"seconds": round(seconds)}
    with POINTS.open("a", encoding="utf-8") as file:
        file.write(json.dumps([asdict(point), seed, how, rounded]) + "\n")


def read_peer() -> dict[Point, dict[str, tuple[float, float]]]:
    """Results of the other program."""
    found = {}
    for path in PEERS:
        with path.open(encoding="utf-8", newline="") as file:
            rows = csv.DictReader(line for line in file if not line.startswith("#"))
            found |= {_peer_point(row): _peer_result(row) for row in rows}
    return found


def _peer_point(row: dict[str, str]) -> Point:
    names = ("knudsen", "temperature_ratio", "tac_top", "tac_bottom")
    numbers = {name: float(row[name]) for name in names}
    floor = float(row["floor"]) if row.get("floor") else None
    place = {"boundary": float(row["boundary"]), "floor": floor, "solid": row.get("solid", "")}
    return Point(row["gas"], **numbers, **place)


def _peer_result(row: dict[str, str]) -> dict[str, tuple[float, float]]:
    names = [name for name in MEASURED if row.get(name)]
    return {name: (float(row[name]), float(row[f"{name}_error"])) for name in names}


def label(point: Point) -> str:
    """A point in words."""
    return (
        f"{point.gas}, Kn {point.knudsen:.4g}, T_h/T_c {point.temperature_ratio:.4g}, "
        f"TAC {point.tac_top:g}/{point.tac_bottom:g}, {wall(point)}, {vessel(point)}"
    )


def wall(point: Point) -> str:
    """A point's walls in words."""
    if point.tangential is None:
        return point.wall
    return point.wall + ", tangential {:g}/{:g}".format(*point.tangential)


def vessel(point: Point) -> str:
    """A point's vessel in words."""
    words = f"D {point.boundary:g}"
    if point.floor is not None:
        words += f", {'solid' if 'floor' in point.solid else 'open'} floor {point.floor:g}"
    if point.floor_temperature != 1.0:
        words += f" at {point.floor_temperature:g} T_c"
    words += "".join(f", solid {part}" for part in ("side", "lid") if part in point.solid)
    return words


def table() -> Iterator[str]:
    """All results as a table in Markdown."""
    yield "| gas | Kn | T_h/T_c | α_t, α_b | wall | D | F/F_fm | by the reservoir | Q/Q_fm | by |"
    yield "|---|---|---|---|---|---|---|---|---|---|"
    results = [(point, found, "this") for point, found in combined(read_runs()).items()]
    results += [(point, found, "other") for point, found in read_peer().items()]
    results.sort(
        key=lambda result: (result[0].gas, -result[0].knudsen, result[0].wall != "maxwell")
    )
    for point, found, by in results:
        cells = [
            point.gas,
            f"{point.knudsen:.4f}",
            f"{point.temperature_ratio:.3f}",
            f"{point.tac_top:g}, {point.tac_bottom:g}",
            wall(point),
            vessel(point).removeprefix("D "),
            *(_shown(found.get(name)) for name in ("force", "force_reservoir", "heat")),
            by,
        ]
        yield f"| {' | '.join(cells)} |"


def _shown(pair: tuple[float, float] | None) -> str:
    return "" if pair is None else f"{pair[0]:.4f} ± {pair[1]:.4f}"


def main() -> None:
    """Simulate what is missing."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=1, help="runs of each point, of other seeds")
    parser.add_argument("--only", default="", help="a word that the names of points contain")
    parser.add_argument("--table", action="store_true", help="print the results and stop")
    arguments = parser.parse_args()
    if arguments.table:
        print("\n".join(table()))
        return
    made = {(point, seed) for point, seed, _ in read_runs()}
    chosen = [point for point in POINTS_TO_RUN if arguments.only in label(point)]
    if not chosen:
        parser.error(f"--only {arguments.only}: no point has that in its name")
    missing = [(p, s) for s in range(arguments.runs) for p in chosen if (p, s) not in made]
    for point, seed in missing:
        began = time.process_time()
        keep(measure(point, seed), time.process_time() - began)
    print(f"{len(missing)} runs made; print the results with --table")


if __name__ == "__main__":
    main()
