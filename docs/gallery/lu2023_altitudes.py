"""
Where the coated disk levitates
===============================

Figure 6(a) of [Lu2023]_: the irradiance that a germanium-coated disk of 2 cm needs, over altitude.
The disk levitates where its curve is below the sunlight. The paper reports 68 km to 78 km at
normal incidence and 70 km to 76 km at 45°; the bars show that.

The paper's equations as printed do not give its own altitudes; the reading "reported", which is
the default, does. :doc:`/errata` has the difference.
"""

import matplotlib.pyplot as plt
import numpy as np

import lightflyer as lf

film = lf.FilmProperties(
    areal_density=1e-3,
    absorptance=0.75,
    emittance_top=0.08,
    emittance_bottom=0.08,
    tac_top=0.8,
    tac_bottom=0.9,
)
disk = lf.Disk(film, radius=0.01)
altitude = np.linspace(60e3, 88e3, 200)
sunlight = 1360.0

fig, ax = plt.subplots()
published = {0.0: (68, 78), 45.0: (70, 76)}
for number, (angle, (low, high)) in enumerate(published.items()):
    earth = lf.lu2023_earth(incidence=np.radians(angle))
    needed = lf.levitate(disk, earth.state(altitude), lf.Lu2023()).irradiance
    ax.plot(altitude / 1e3, needed, color=f"C{number}", label=f"{angle:.0f}°")
    height = sunlight * (1.0 + 0.12 * (number + 1))
    ax.plot(
        [low, high], [height, height], "|-", color=f"C{number}", label=f"{angle:.0f}°, published"
    )
ax.axhline(sunlight, color="grey", ls="--", label="sunlight")
ax.set(xlabel="altitude [km]", ylabel="irradiance to levitate [W/m²]", ylim=(0, 4000))
ax.legend()

# %%
# The edges of the band come from a root-find, not from the figure:

band = lf.levitation_band(disk, lf.lu2023_earth(), lf.Lu2023())
print(f"{band.lower / 1e3:.2f} km to {band.upper / 1e3:.2f} km")
