"""Make the table of what walls of Cercignani and Lampis change in the force of a sandwich.

Run as ``python studies/kinetic_scattering/sandwich.py``; it takes about ten minutes. The sandwich
is a thin disk with holes, hot below and cold above, whose faces scatter alike. For each gas,
rarefaction and open fraction the gas is factorised once.
"""

from itertools import product

import numpy as np
from study import NORMAL, ROTATIONAL, TABLE, TANGENTIAL, mixed

from lightflyer.kinetic_theory.disk.cases import MEDIUM, totals
from lightflyer.kinetic_theory.disk.operators import assemble
from lightflyer.kinetic_theory.disk.scattering import ScatteringSystem, assemble_modes, modes_up_to
from lightflyer.kinetic_theory.model_gases import gas_model

OUTPUT = TABLE.with_name("kinetic_sandwich_scattering.csv")
RAREFACTIONS = (0.02, 0.1, 0.3, 1.0, 2.0, 4.0, 8.0, 15.0, 30.0, 70.0)
OPEN_FRACTIONS = (0.0, 0.3, 0.6, 0.9)
MODES = modes_up_to(4, 6)

COMMENTS = """\
# Force on a thin disk with holes, hot below and cold above, whose faces both scatter as Cercignani
# and Lampis say, over what it is without collisions where normal motion accommodates wholly; in
# the linear limit and open space, from the kinetic equation; made by
# studies/kinetic_scattering/sandwich.py.
# rarefaction: sqrt(pi)/(4 Kn); normal, tangential, rotational: accommodation coefficients of
# energy. A monatomic gas has no rotation; 0 stands for its value. Licence: MIT, as this package.
"""


def rows_at(rarefaction: float) -> list[str]:
    """Lines of the table at a rarefaction."""
    mesh = MEDIUM.mesh(rarefaction, np.inf)
    operators = assemble(mesh, rarefaction, MEDIUM.quadrature)
    rows = assemble_modes(operators, rarefaction, MEDIUM.quadrature, MODES)
    lines = []
    for gas, open_fraction in product(("monatomic", "diatomic"), OPEN_FRACTIONS):
        system = ScatteringSystem(operators, rows, gas_model(gas), open_fraction)
        rotations = ROTATIONAL if system.gas.has_rotation else (0.0,)
        for coefficients in product(NORMAL, TANGENTIAL, rotations):
            hot = mixed(*coefficients)
            cold = hot.__class__(hot.normal, hot.tangential, hot.rotational)
            force, _ = totals(mesh, system.solve(cold, hot)[1])
            found = force / (0.25 * (1.0 - open_fraction))
            cells = (rarefaction, open_fraction, *coefficients)
            lines.append(",".join([gas, *(f"{cell:g}" for cell in cells), f"{found:.6f}"]))
        print(rarefaction, gas, open_fraction, flush=True)
    return lines


def main() -> None:
    """Solve all places and write the table."""
    lines = [line for rarefaction in RAREFACTIONS for line in rows_at(rarefaction)]
    lines.sort(key=lambda line: line.split(",")[0])
    names = "gas,rarefaction,open_fraction,normal,tangential,rotational,force"
    OUTPUT.write_text(COMMENTS + names + "\n" + "\n".join(lines) + "\n", encoding="utf-8")
    print(f"wrote {OUTPUT.name}: {len(lines)} rows")


if __name__ == "__main__":
    main()
