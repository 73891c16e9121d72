"""Altitude of a tracked balloon less that of its flight: python compare.py SHAB14V-APRS.csv."""

import sys
from pathlib import Path

import numpy as np
import pandas as pd

import lightflyer as lf

mission = lf.mission.read_mission_file(Path(__file__).parent / "mission.toml")
flown = lf.fly(mission.design, mission=mission.mission)
track = pd.read_csv(sys.argv[1], parse_dates=["time"])
track = track[track.time.between(flown.time.values[0], flown.time.values[-1])]
beside = flown.swap_dims(elapsed="time").interp(time=track.time.to_numpy())
missed = track.altitude.to_numpy() - beside.altitude
rms = float(np.sqrt((missed**2).mean()))
print(f"{len(track)} fixes, rms of altitude {rms / 1e3:.2f} km")
