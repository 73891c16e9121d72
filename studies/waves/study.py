"""What waves and tides of the air do to flights: nights survived, and how far flyers spread.

Run as ``python studies/waves/study.py [swarms]``; ``swarms`` flies swarms that meet one weather
each, and prints the share of each that is left.
"""

import csv
import sys
from pathlib import Path

import numpy as np

import lightflyer as lf

HERE = Path(__file__).parent
RESULTS = HERE / "results.csv"
MEMBERS, DAYS = 400, 4
CASES = {  # of the air: waves over their climatology, and error of the mean vertical wind [m/s]
    "still": (0.0, 0.0),
    "mean vertical wind ± 0.02 m/s": (0.0, 0.02),
    "waves": (1.0, 0.0),
    "both": (1.0, 0.02),
    "both, waves twice as large": (2.0, 0.02),
}
FLYERS = {  # diameter [mm], latitude [°], month
    "2 mm, 45° N, June": (2.0, 45.0, 6),
    "2 mm, 45° N, December": (2.0, 45.0, 12),
    "3 mm, 60° N, June": (3.0, 60.0, 6),
}
COLUMNS = (
    "flyer", "air", "still flying [1]", "nights survived", "lowest at night [km]",
    "spread of altitude [km]", "distance from the stated flyer [km]",
)  # fmt: skip


def fly(millimetres, latitude, month, waves, vertical, members=MEMBERS, **swarm):
    """Flights of a polyimide film of 1 g/m² in the wind of the season."""
    film = lf.FilmProperties(
        1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9, highest_temperature=633.0
    )
    environment = lf.Earth(
        sky=lf.environment.Daylight(),
        wind=lf.environment.UniformWind(-60.0 if month == 6 else 60.0),
    )
    return lf.fly(
        lf.Disk(film, radius=0.5e-3 * millimetres), environment, lf.Kinetic(),
        release=lf.Release("75 km", latitude, 10.0, f"2026-{month:02d}-21T12:00Z"),
        duration=f"{24 * DAYS} h", attitude=lf.mission.Level(), lowest="50 km", every="30 min",
        ensemble=lf.mission.Ensemble(members, waves=waves, vertical_wind=vertical, **swarm),
    )  # fmt: skip


def row(flown):
    """Numbers of one line, without its names."""
    altitude = flown.ensemble_altitude.values / 1e3
    ends = flown.ensemble_end_elapsed.values
    last = altitude[:, -1]
    aloft = np.isfinite(last)
    nights = np.floor(ends / 86_400.0 + 0.1)
    here, there = (
        np.radians([flown[f"{name}latitude"].values, flown[f"{name}longitude"].values])
        for name in ("", "ensemble_")
    )
    cosine = np.sin(here[0, -1]) * np.sin(there[0, :, -1]) + np.cos(here[0, -1]) * np.cos(
        there[0, :, -1]
    ) * np.cos(here[1, -1] - there[1, :, -1])
    away = 6371.0 * np.arccos(np.clip(cosine, -1.0, 1.0))
    return (
        aloft.mean(), nights.mean(), np.nanmedian(np.nanmin(altitude, axis=1)),
        np.nanstd(last), np.nanmedian(away[aloft]),
    )  # fmt: skip


def swarms():
    """Shares of swarms of 3 mm, each in a weather of its own, that still fly at the end."""
    flown = (
        fly(
            *FLYERS["3 mm, 60° N, June"], *CASES["both"], 64, together=True, distance=1e3, seed=seed
        )
        for seed in range(20)
    )
    shares = [float(np.isfinite(one.ensemble_altitude.values[:, -1]).mean()) for one in flown]
    print(f"mean {np.mean(shares):.2f};", *(f"{share:.2f}" for share in sorted(shares)))


def main():
    """Fly all cases and write their numbers."""
    rows = [
        (flyer, air, *(f"{value:.3g}" for value in row(fly(*FLYERS[flyer], *CASES[air]))))
        for flyer in FLYERS
        for air in CASES
    ]
    with RESULTS.open("w", newline="", encoding="utf-8") as file:
        csv.writer(file).writerows([COLUMNS, *rows])


if __name__ == "__main__":
    swarms() if "swarms" in sys.argv else main()
