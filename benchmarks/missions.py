"""Time of ten thousand flights of a day.

Run: python benchmarks/missions.py [FLIGHTS]
"""

import sys
import time

import numpy as np

import lightflyer as lf
from lightflyer.design import ObjectDesign
from lightflyer.mission.fleet import BATCH, Ensemble, flights_of, fly_all
from lightflyer.mission.path.attitude import Level
from lightflyer.mission.path.integration import Accuracy, Limits

DAY = 86_400.0


def design():
    film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    earth = lf.Earth(sky=lf.environment.Daylight(), wind=lf.environment.UniformWind(east=-40.0))
    uncertain = {"flyer.film.tac_bottom": 0.01, "flyer.film.emittance_top": 0.005}
    return ObjectDesign(lf.Setup(lf.Disk(film, radius=0.005), earth, lf.Lu2023()), uncertain)


def timed(count):
    release = lf.Release("70 km", latitude=45.0, longitude=0.0, time="2026-06-21T12:00Z")
    with lf.float64():
        start = release.start()
    flights = flights_of(design(), Level(), start, Ensemble(count - 1, wind=10.0))
    wall, processor = time.perf_counter(), time.process_time()
    times = np.linspace(0.0, DAY, 289)
    tracks = fly_all(flights, Limits(0.0, 1000e3), times, Accuracy.for_duration(DAY))
    return time.perf_counter() - wall, time.process_time() - processor, tracks


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    for what, number in (("with the compilation", BATCH), ("compiled", count)):
        wall, processor, tracks = timed(number)
        print(
            f"{number} flights of 24 h, {what}: {wall:.1f} s, {processor:.1f} s of processor time, "
            f"{tracks.steps.mean():.0f} steps each"
        )


if __name__ == "__main__":
    main()
