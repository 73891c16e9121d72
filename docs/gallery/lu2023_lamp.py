"""
How much of the light a coated film absorbs
===========================================

[Lu2023]_ measured that mylar with 20 nm of germanium on both sides and alumina on top absorbs 0.75
± 0.03 of visible light. Computed from its layers, the film absorbs as much of a white lamp, and
far less of sunlight, half of which is infrared. :doc:`/film-comparison` has more causes.
"""

import matplotlib.pyplot as plt
import numpy as np

import lightflyer as lf

germanium, mylar, alumina = (lf.film.material(name) for name in ("Ge", "PET", "Al2O3"))
thicknesses = np.array([5, 10, 15, 20, 25, 30, 40]) * 1e-9
lamps = {"cold-white lamp": lf.film.cold_white_led(), "sunlight": lf.film.am0()}

fig, ax = plt.subplots()
for name, light in lamps.items():
    absorbed = []
    for thickness in thicknesses:
        coat = lf.film.Layer(germanium, thickness)
        layers = (lf.film.Layer(alumina, 50e-9), coat, lf.film.Layer(mylar, 500e-9), coat)
        absorbed.append(lf.film.absorptance(lf.film.Film(layers), light).value)
    ax.plot(1e9 * thicknesses, absorbed, "o-", label=name)
ax.errorbar(20, 0.75, yerr=0.06, fmt="s", color="black", capsize=3, label="measured, 95 %")
ax.set(xlabel="germanium on each side [nm]", ylabel="absorptance", ylim=(0, 1))
ax.legend()
