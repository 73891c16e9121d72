r"""
Force between thin and dense gas
================================

Flyers fly where the mean free path is neither long nor short beside them. [Lu2023]_ joins the two
limits with coefficients fitted to experiments in a chamber; the kinetic equation needs no fit.
Both are shown over the force of free molecules, for a disk of 2 cm at twice the temperature of the
gas. :doc:`/force-models` says which to trust where.
"""

import matplotlib.pyplot as plt
import numpy as np

import lightflyer as lf

film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
disk = lf.Disk(film, radius=0.01)
knudsen = np.geomspace(0.03, 100.0, 200)
pressure = lf.gas.mean_free_path(1.0, 205.0, lf.gas.AIR) / (2.0 * disk.radius * knudsen)
state = lf.Chamber(temperature=205.0).state(pressure)
excess = (np.ones_like(knudsen),)  # (T_h - T_c)/T_c

# %%
# The force of free molecules at a wall of Maxwell's, in closed form:

walls = film.tac_bottom - film.tac_top
free = 0.5 * pressure * disk.area * walls * (np.sqrt(2.0) - 1.0)

fig, ax = plt.subplots()
for name, model in {"kinetic": lf.Kinetic(), "Lu et al. 2023": lf.Lu2023()}.items():
    ax.plot(knudsen, model.force(disk, state, excess) / free, label=name)
ax.axhline(1.0, color="grey", ls="--", label="free molecules")
ax.axvspan(0.043, 0.42, color="grey", alpha=0.2, lw=0, label="2 cm at 70 km to 85 km")
ax.set(xscale="log", xlabel="Knudsen number", ylabel="force over that of free molecules")
ax.legend()
