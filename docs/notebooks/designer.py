"""
From one disk to the best one
=============================

You want to carry something. This notebook predicts one disk, looks at all sizes and altitudes at
once, asks what the payload depends on, and lets the computer choose within limits.
"""

import jax
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
earth, model = lf.Earth(), lf.Lu2023()

# %%
# One disk
# --------

found = lf.predict(lf.Disk(film, radius=0.01), earth, model)
found.plot()

# %%
# ``best`` is the altitude of the largest payload. ``warnings`` say what the numbers rest on; read
# them before you trust one.

print(f"{1e6 * found.best.values['payload']:.3f} mg at {found.best.coordinate / 1e3:.1f} km")
for warning in found.warnings:
    print(warning)

# %%
# All sizes and altitudes
# -----------------------
# Every number of a flyer may be an array. Forty disks at sixty altitudes are one call.

radius = np.geomspace(0.002, 0.03, 40)
altitude = np.linspace(60e3, 85e3, 60)
disks = lf.Disk(film, radius=radius[:, None])
carried = lf.payload(disks, earth.state(altitude), model)

fig, ax = plt.subplots()
shown = ax.contourf(
    200 * radius, altitude / 1e3, 1e6 * carried.T, np.linspace(0, 0.8, 9), cmap="cividis"
)
ax.set(xlabel="diameter [cm]", ylabel="altitude [km]")
fig.colorbar(shown, label="payload [mg]")

# %%
# A milligram is too much for one disk of this film. The largest payload of all is

print(f"{1e6 * carried.max():.2f} mg")
assert carried.max() < 1e-6

# %%
# What it depends on
# ------------------
# Results are differentiable. An elasticity is by how many per cent the payload changes where a
# number changes by one per cent.

state = earth.state("72 km")
numbers = {"areal_density": 1e-3, "absorptance": 0.75, "tac_top": 0.8, "tac_bottom": 0.9}


def payload(numbers):
    film = lf.FilmProperties(emittance_top=0.08, emittance_bottom=0.08, **numbers)
    return lf.payload(lf.Disk(film, radius=0.01), state, model)


with lf.float64():
    value, slope = jax.value_and_grad(payload)(numbers)
elasticity = {name: float(slope[name]) * numbers[name] / float(value) for name in numbers}
for name, percent in elasticity.items():
    print(f"{name:14} {percent:+6.1f}")

# %%
# The accommodation coefficients decide: one per cent of either is more than ten per cent of the
# payload. A difference quotient says the same:

more = payload(numbers | {"tac_bottom": 0.9009}) / payload(numbers) - 1.0
print(f"{more / 1e-3:+.1f}")
assert abs(more / 1e-3 / elasticity["tac_bottom"] - 1.0) < 0.01

# %%
# The best within limits
# ----------------------
# The force model was fitted to disks of 2 cm to 4 cm, less than 1.8 times as hot as the gas.
# Within these limits the optimiser follows gradients from several starts, and says which limits
# hold it back. Beyond them it would refuse: a search goes where its model promises most, and that
# is often where it fails.

best = lf.optimise(
    lf.Disk(film, radius=0.01),
    earth,
    model,
    maximise="payload",
    over={
        "flyer.radius": {"from": "1 cm", "to": "2 cm"},
        "altitude": {"from": "60 km", "to": "85 km"},
    },
    constraints={"temperature": {"at_most": "390 K"}},
)
print(f"{1e6 * best.value:.3f} mg")
for name, number in best.design.items():
    print(f"{name} {number:.5g}")
print(f"held back by {', '.join(best.active_constraints)}")

# %%
# No disk on the map is better that keeps the limit:

inside = (radius >= 0.01) & (radius <= 0.02)
warmth = lf.equilibrium(disks, earth.state(altitude), model).temperature
allowed = np.where((warmth <= 390.0) & inside[:, None], carried, -np.inf)
assert best.value >= allowed.max()

# %%
# Next: other kinds of flyers (:doc:`/flyers`), whether it is still up tomorrow (:doc:`/missions`),
# and how sure all this is (:doc:`/uncertainty`).
