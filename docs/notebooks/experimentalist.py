"""
From raw files to a prediction
==============================

You have a vacuum chamber, a lamp, and a heater with your coating. This notebook goes from raw
files to an accommodation coefficient, to the coefficients of the force, and to what a disk will do
at pressures that were not tried. All files are synthetic, so that the truth is known.
"""

from importlib import resources
from pathlib import Path
from tempfile import mkdtemp

import matplotlib.pyplot as plt
import numpy as np

import lightflyer as lf

# %%
# The accommodation coefficient
# -----------------------------
# The power that keeps a heater warmer than the gas depends on the pressure, and on how well the
# molecules accommodate to its surface. The example's second line states the truth. With a file of
# your own, start at ``read_tac``.

path = Path(mkdtemp()) / "tac-reduced.txt"
path.write_text(lf.lab.example_files("tac").files[path.name], encoding="utf-8")
print(path.read_text(encoding="utf-8").splitlines()[1])

# %%
# State how good your gauge is, as one standard uncertainty. What you leave out gets a default, and
# ``warnings`` says which.

run = lf.lab.read_tac(path)
heater = lf.lab.fit_tac(run, accuracy=lf.lab.TacAccuracy(gauge=0.05))
low, high = heater.tac.interval
print(f"TAC {heater.tac.value:.3f}, 95 % from {low:.3f} to {high:.3f}")

# %%
heater.plot()

# %%
# The interval is 95 % and holds the errors of the instruments beside the scatter. A gauge that is
# 5 % off is 5 % off in every row: more rows would not help, a better gauge would.

assert low < 0.75 < high  # the truth

# %%
# The coefficients of the force
# -----------------------------
# Points at which samples just lifted off give the two coefficients of the model of [Lu2023]_.
# Names of columns carry their units. These points were made with 0.4 and 3.0, and 4 % of noise.

points = lf.calibration.read_points(resources.files("lightflyer.data") / "points.csv")
film = lf.FilmProperties(
    areal_density=1e-3,
    absorptance=0.75,
    emittance_top=0.08,
    emittance_bottom=0.08,
    tac_top=0.8,
    tac_bottom=0.9,
)
disk, chamber = lf.Disk(film, radius=0.01), lf.Chamber()
fit = lf.calibrate(disk, chamber, lf.Lu2023(), points=points)
for name, value, (low, high) in zip(fit.names, fit.values, fit.intervals, strict=True):
    print(f"{name} = {value:.3g}, 95 % from {low:.3g} to {high:.3g}")

# %%
fit.plot()

# %%
# The coefficients came out with the film exactly as stated. But the force goes with the difference
# of two accommodation coefficients, 0.1, and an error of 0.03 in one of them is a third of it.
# ``fit.warnings`` says so; :doc:`/calibration` shows how a flyer file with ± gives the whole
# interval.

c_fm, c_cont = fit.values
assert abs(c_fm / 0.4 - 1.0) < 0.05
assert abs(c_cont / 3.0 - 1.0) < 0.2

# %%
# Pressures that were not tried
# -----------------------------
# The fitted setup predicts like any other. The curve goes beyond the points; the marks are where
# they were taken.

pressure = np.geomspace(0.3, 30.0, 100)
needed = lf.levitate(disk, chamber.state(pressure), fit.setup.model).irradiance
small = points.numbers["diameter"] == 0.02

fig, ax = plt.subplots()
ax.plot(pressure, needed, label="fit, 2 cm")
ax.plot(points.pressure[small], points.irradiance[small], "o", label="points, 2 cm")
ax.set(xlabel="pressure [Pa]", ylabel="irradiance to levitate [W/m²]", xscale="log", yscale="log")
ax.legend()

# %%
# The least light and its pressure, to aim at in the next run:

best = np.argmin(needed)
print(f"{needed[best]:.0f} W/m² at {pressure[best]:.1f} Pa")
