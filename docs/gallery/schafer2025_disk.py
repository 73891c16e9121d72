r"""
Force on a disk with holes
==========================

[Schafer2025]_ published simulations of a thin disk with holes, one face of which is warm. The
force is shown over that of free molecules, against the rarefaction :math:`\delta =
\sqrt\pi/(4\,\mathrm{Kn})`. Markers are the simulations; lines are this package's solver of the
kinetic equation, which shares nothing with them. In thin gas they agree. In dense gas the solver
gives less, a quarter at δ = 10: the simulated gas ended near the disk, which raises the force.
Within the same bounds the two agree, which :doc:`/sandwich` shows.
"""

import matplotlib.pyplot as plt
import numpy as np

from lightflyer.files.table import shipped_table
from lightflyer.force.membranes.sandwich import FREE_FORCE

path = "../../tests/validation/schafer2025.csv"  # in the repository, not in the package
published = np.genfromtxt(path, names=True, delimiter=",", skip_header=2)
solved = shipped_table("kinetic_sandwich.csv")
monatomic = np.array(solved.texts["gas"]) == "monatomic"
solved = {name: column[monatomic] for name, column in solved.numbers.items()}

fig, ax = plt.subplots()
for number, open_fraction in enumerate((0.0, 0.4, 0.7, 0.9)):
    row = published[published["beta"] == open_fraction]
    ratio = row["force"] / ((1.0 - open_fraction) * FREE_FORCE)
    ax.plot(row["delta"], ratio, "osD^"[number], color=f"C{number}")
    ours = (solved["open_fraction"] == open_fraction) & (solved["tac"] == 1.0)
    label = f"{open_fraction:.0%} holes"
    force = solved["force_ratio"][ours]
    ax.plot(solved["rarefaction"][ours], force, color=f"C{number}", label=label)
ax.set(xlabel="rarefaction δ", ylabel="force over that of free molecules")
ax.set(xscale="log", yscale="log", xlim=(0.08, 120.0), ylim=(2e-3, 1.3))
ax.legend()
