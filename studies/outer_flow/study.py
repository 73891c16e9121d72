"""Force of the gas on a thin disk that sucks gas in on top and blows it out below.

    python studies/outer_flow/study.py run FOLDER    # needs OpenFOAM; two hours on one core
    python studies/outer_flow/study.py               # seconds

``run`` makes the meshes in a folder, runs simpleFoam for each case, and writes pumped.csv,
warm.csv and streamlines.csv; what is there already is not run again. Without it they are read.
Either writes results.json and the figures of the docs.
"""

import csv
import json
import sys
from pathlib import Path

import figures
import findings
import runs
from mesh import Mesh

HERE = Path(__file__).parent

REYNOLDS = (0.01, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0)
CELLS = {"coarse": (60, 50), "medium": (90, 76), "fine": (120, 100), "finest": (180, 150)}
FAR, FAR_IN_CREEP, NEAR = 300.0, 1000.0, 100.0  # radius of the domain, over the disk's
UNSTEADY = 1000.0  # the jet is steady on the finer meshes only
FINEST = (0.1, 10.0, 100.0, 500.0)  # those on a third mesh
CHECKED = (0.1, 10.0, 100.0)  # those in a smaller domain
DRAWN = (0.1, 100.0)  # those whose streamlines are kept

GRASHOF = (300.0, 1000.0, 3000.0, 10000.0)
PUMPED = (0.0, 0.05)
FAR_IF_WARM, WIDE_IF_WARM = 50.0, 200.0


def plan():
    """All cases by name, the cheapest first."""
    cases = {}
    for cells in ("coarse", "medium", "fine"):
        for reynolds in REYNOLDS:
            if cells != "fine" and (cells == "coarse") == (reynolds >= UNSTEADY):
                continue
            cases[f"{cells}-{reynolds:g}"] = pumped(reynolds, cells, distance(reynolds))
    for grashof in GRASHOF:
        for velocity in PUMPED:
            cases[f"warm-coarse-{grashof:g}-{velocity:g}"] = warm(grashof, velocity)
    middle = GRASHOF[2]
    cases["warm-coarse-wide"] = warm(middle, 0.0, far=WIDE_IF_WARM)
    cases["warm-coarse-fast"] = warm(middle, 0.2)
    cases["warm-fine"] = warm(middle, 0.0, "fine")
    for reynolds in CHECKED:
        cases[f"near-{reynolds:g}"] = pumped(reynolds, "fine", NEAR)
    for reynolds in FINEST:
        cases[f"finest-{reynolds:g}"] = pumped(reynolds, "finest", distance(reynolds))
    return cases


def distance(reynolds):
    """Radius of the domain."""
    return FAR_IN_CREEP if reynolds < 1.0 else FAR


def pumped(reynolds, cells, far):
    """A case of gas at rest but for what the disk pumps."""
    return runs.Pumped(reynolds, Mesh(*CELLS[cells], far, wall=20.0, jet=2.0))


def warm(grashof, velocity, cells="coarse", far=FAR_IF_WARM):
    """A case of a warm disk."""
    return runs.Warm(grashof, velocity, Mesh(*CELLS[cells], far, wall=20.0))


def run(folder):
    """Run what has not been run, and write the tables."""
    rows = {"pumped": [], "warm": []}
    for name, case in plan().items():
        path = folder / name / "found.json"
        if not path.exists():
            found = runs.run(case, folder / name)
            path.write_text(json.dumps(found) + "\n", "utf-8")
            print(name, found, flush=True)
        found = json.loads(path.read_text("utf-8"))
        rows["pumped" if isinstance(case, runs.Pumped) else "warm"].append(
            row(case, found, folder / name)
        )
    for name, members in rows.items():
        write_table(HERE / f"{name}.csv", members)
    write_table(HERE / "streamlines.csv", streamlines(folder))


def row(case, found, folder):
    """A line of a table."""
    size = {
        "domain": case.mesh.outer,
        "cells_outward": case.mesh.outward,
        "cells_around": case.mesh.around,
    }
    if isinstance(case, runs.Pumped):
        first = {"reynolds": case.reynolds, **size, "force_over_mu_a_u": found["coefficient"]}
    else:
        first = {
            "grashof": case.grashof,
            "velocity_over_U": case.pumped,
            **size,
            "force_over_rho_U2_area": found["coefficient"],
            "heat_over_kappa_a_dT": runs.heat_loss(folder, case.mesh),
        }
    return {**first, "last_change": found["change"], "iterations": found["iterations"]}


def streamlines(folder):
    """Stream function near the disk, at every second point."""
    found = []
    for reynolds in DRAWN:
        case = plan()[f"fine-{reynolds:g}"]
        fields = runs.streamfunction(folder / f"fine-{reynolds:g}", case.mesh)
        for r, z, psi in fields[:, : findings.SHOWN : 2, ::2].reshape(3, -1).T:
            found.append({"reynolds": reynolds, "r": r, "z": z, "psi": psi})
    return found


def write_table(path, rows):
    """A table of numbers."""
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(rows[0])
        writer.writerows([f"{value:.6g}" for value in row.values()] for row in rows)


def main():
    """See the module's description."""
    if sys.argv[1:2] == ["run"]:
        run(Path(sys.argv[2]))
    results = findings.summary()
    (HERE / "results.json").write_text(json.dumps(results, indent=1) + "\n", "utf-8")
    figures.draw_all(results)


if __name__ == "__main__":
    main()
