"""Make the table of what faces of Cercignani and Lampis push, which ships with the package.

Run as ``python studies/kinetic_scattering/study.py``. It takes some minutes. For each gas and
Knudsen number the gas is factorised once, then faces are solved that differ a little in one of
their three accommodation coefficients. ``--checks`` prints how much a better mesh and more modes
change.
"""

import argparse
from collections.abc import Iterator
from itertools import product
from pathlib import Path

import numpy as np

from lightflyer.kinetic_theory.disk.cases import FINE, MEDIUM, Resolution, totals
from lightflyer.kinetic_theory.disk.operators import assemble
from lightflyer.kinetic_theory.disk.scattering import (
    Scattering,
    ScatteringSystem,
    assemble_modes,
    modes_up_to,
)
from lightflyer.kinetic_theory.model_gases import gas_model

TABLE = Path(__file__).parents[2] / "src" / "lightflyer" / "data" / "kinetic_scattering.csv"
GASES = ("monatomic", "diatomic")
KNUDSEN = (0.006, 0.012, 0.02, 0.03, 0.05, 0.1, 0.2, 0.5, 1.0, 3.0, 10.0, 30.0)
NORMAL = (0.1, 0.4, 0.7, 0.98)
TANGENTIAL = (0.5, 0.75, 0.9, 0.98)  # of energy
ROTATIONAL = (0.3, 0.65, 0.98)
DIFFERENCE = 0.04
FEW, MANY = modes_up_to(4, 6), modes_up_to(8, 10)
COEFFICIENTS = ("normal", "tangential", "rotational")


def mixed(normal: float, tangential: float, rotational: float) -> Scattering:
    """A hot face; ``tangential`` is the accommodation of energy."""
    return Scattering(normal, 1.0 - np.sqrt(1.0 - tangential), rotational, 1.0)


def pushes(system: ScatteringSystem, means: tuple[float, ...]) -> list[float]:
    """Force per difference of each coefficient, over that of normal ones without collisions."""
    found = []
    for changed in range(3 if system.gas.has_rotation else 2):
        top, bottom = (
            mixed(*(m + sign * (k == changed) for k, m in enumerate(means)))
            for sign in (-0.5 * DIFFERENCE, 0.5 * DIFFERENCE)
        )
        force, _ = totals(system.operators.mesh, system.solve(top, bottom)[1])
        found.append(force / (0.25 * DIFFERENCE))
    return found


def systems(
    knudsen: float, resolution: Resolution = MEDIUM, modes: tuple = FEW
) -> Iterator[ScatteringSystem]:
    """The gases at a Knudsen number, whose rays are traced once."""
    rarefaction = float(np.sqrt(np.pi) / (4.0 * knudsen))
    mesh = resolution.mesh(rarefaction, np.inf)
    operators = assemble(mesh, rarefaction, resolution.quadrature)
    rows = assemble_modes(operators, rarefaction, resolution.quadrature, modes)
    for gas in GASES:
        yield ScatteringSystem(operators, rows, gas_model(gas))


COMMENTS = """\
# Force on a hot thin disk whose faces scatter as Cercignani and Lampis say and differ a little in
# one accommodation coefficient: that of normal energy, of tangential energy, or of rotational
# energy. Per difference of it, over the force that a difference of normal ones exerts without
# collisions, in the linear limit and open space, from the kinetic equation; made by
# studies/kinetic_scattering/study.py.
# knudsen: mean free path (mu/p) sqrt(pi R T_c/2) over the diameter; normal, tangential, rotational:
# the mean accommodation coefficients of both faces. A monatomic gas has no rotation; 0 stands for
# its values. Licence: MIT, as this package.
"""


def write_table() -> None:
    """Solve all places and write the table."""
    lines = []
    for knudsen in KNUDSEN:
        for system in systems(knudsen):
            rotates = system.gas.has_rotation
            for means in product(NORMAL, TANGENTIAL, ROTATIONAL if rotates else (0.0,)):
                found = [*pushes(system, means), 0.0][:3]
                cells = [system.gas.name, f"{knudsen:g}", *(f"{m:g}" for m in means)]
                lines.append(",".join([*cells, *(f"{value:.6f}" for value in found)]))
            print(knudsen, system.gas.name, flush=True)
    lines.sort(key=lambda line: line.split(",")[0])
    names = ",".join(("gas", "knudsen", *COEFFICIENTS, *(f"force_{c}" for c in COEFFICIENTS)))
    partial = TABLE.with_suffix(".partial")
    partial.write_text(COMMENTS + names + "\n" + "\n".join(lines) + "\n", encoding="utf-8")
    partial.rename(TABLE)
    print(f"wrote {TABLE.name}: {len(lines)} rows")


def check() -> None:
    """Print what a better mesh and more modes change, relative to the force of normal motion."""
    for knudsen in (0.02, 0.1, 1.0):
        for means in ((0.7, 0.75, 0.65), (0.1, 0.98, 0.3)):
            usual, better = (
                np.array([pushes(system, means)[:2] for system in systems(knudsen, *how)])
                for how in ((MEDIUM, FEW), (FINE, MANY))
            )
            worst = abs(better / better[:, :1] - usual / better[:, :1]).max()
            print(f"Kn {knudsen:g}, {means}: {worst:.1e}")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--checks", action="store_true")
    if parser.parse_args().checks:
        check()
    else:
        write_table()
