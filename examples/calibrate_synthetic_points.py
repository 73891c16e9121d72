"""Fit the paper's two coefficients to synthetic points with 3 % of scatter."""

import numpy as np

import lightflyer as lf

film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
disk, chamber = lf.Disk(film, radius=0.01), lf.Chamber()
pressure = np.geomspace(1.5, 25.0, 12)
truth = lf.Lu2023(c_fm=0.4, c_cont=3.0)
light = lf.levitate(disk, chamber.state(pressure), truth).irradiance
light = light * np.exp(0.03 * np.random.default_rng(0).standard_normal(pressure.size))

numbers = {"pressure": pressure, "irradiance": light}
points = lf.calibration.Points("synthetic", ["disk"] * 12, numbers)
fit = lf.calibrate(disk, chamber, lf.Lu2023(c_fm=1.0, c_cont=1.0), points=points)
for name, value, (low, high) in zip(fit.names, fit.values, fit.intervals, strict=True):
    print(f"{name} = {value:.3f}, 95 % from {low:.3f} to {high:.3f}")
assert abs(fit.values[0] - 0.4) < 0.02
assert abs(fit.values[1] - 3.0) < 0.4
