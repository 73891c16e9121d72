"""
What disks of all sizes carry
=============================

Figure S8 of [Lu2023]_: the payload of the germanium-coated disk over its size and altitude. The
paper has the largest payload, 0.21 mg, at 3 cm, and no payload above 4.75 cm. The equations that
give the paper's altitudes best carry a little more, at a larger size: :doc:`/paper`, claims 4 and
5.
"""

import matplotlib.pyplot as plt
import numpy as np

import lightflyer as lf

film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
diameter = np.linspace(0.002, 0.06, 60)
altitude = np.linspace(62e3, 82e3, 81)

# %%
# Arrays broadcast: sixty disks at eighty-one altitudes are one call.

disks = lf.Disk(film, radius=diameter[:, None] / 2)
carried = 1e6 * lf.payload(disks, lf.lu2023_earth().state(altitude), lf.Lu2023())

fig, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2))
levels = np.linspace(0.0, 0.3, 7)
shown = left.contourf(1e2 * diameter, altitude / 1e3, carried.T, levels=levels, cmap="cividis")
left.set(xlabel="diameter [cm]", ylabel="altitude [km]")
fig.colorbar(shown, ax=left, label="payload [mg]")
right.plot(1e2 * diameter, carried.max(axis=1), label="best over altitude")
right.plot(3.0, 0.21, "s", color="C1", label="published, largest")
right.plot(4.75, 0.0, "D", color="C1", label="published, none above")
right.axhline(0.0, color="grey", lw=0.8)
right.set(xlabel="diameter [cm]", ylabel="payload [mg]", ylim=(-0.2, 0.5))
right.legend()
