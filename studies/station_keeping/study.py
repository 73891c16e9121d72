"""How long a flyer stays within 100 km of a place when nothing, a tilt or shade steers it.

Run as ``python studies/station_keeping/study.py [draw]``; writes results.json here and
docs/images/station-keeping.png, and prints the numbers of docs/missions.md. Flights begin at 80 km,
at six in the morning on the 21st of each month, in the gradient wind of NRLMSIS, which has no tides
and no weather.
"""

import json
import sys
import time
from pathlib import Path

import matplotlib.colors
import numpy as np

import lightflyer as lf
from lightflyer.core.clock import seconds_of
from lightflyer.environment import Daylight, GlobalNRLMSIS, GradientWind, Place
from lightflyer.files import drawing as plot
from lightflyer.files import palette
from lightflyer.mission import ChooseWind, Circle, Level, Shaded, TowardsStation
from lightflyer.mission.fleet import Flights, fly_all
from lightflyer.mission.path.integration import Accuracy, Limits, Start
from lightflyer.mission.path.motion import Vehicle

HERE = Path(__file__).parent
RESULTS = HERE / "results.json"
IMAGE = HERE.parents[1] / "docs" / "images" / "station-keeping.png"
LATITUDES = np.array([-80, -70, -60, -50, -40, -30, -22, 22, 30, 40, 50, 60, 70, 80], float)
DATES = np.array([seconds_of(f"2026-{month:02d}-21T00:00Z") for month in range(1, 13)])
MORNING, ALTITUDE = 21_600.0, 80e3  # at longitude 0
DAYS, EVERY = 5, 300.0
ELAPSED = np.arange(0.0, DAYS * 86_400.0 + 1.0, EVERY)
RADIUS = 100e3
RULES = ("level", "tilted", "shaded", "both")
DISKS = {"2 mm, 1 g/m²": (2e-3, 1e-3), "1 cm, 0.37 g/m²": (1e-2, 0.37e-3)}
LOWEST, HIGHEST, AHEAD, TILT = 64e3, 92e3, 3600.0, np.radians(15.0)
SHOWN = [0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 9.0, 12.0, 18.0]  # hours, in the picture


def hours_near(rule, disk, environment):
    """Hours until a flyer first leaves the radius, and hours within; shape (months, latitudes)."""
    size, density = DISKS[disk]
    film = lf.FilmProperties(density, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    setup = lf.Setup(lf.Disk(film, radius=0.5 * size), environment, lf.Kinetic())
    date, latitude = (part.ravel() for part in np.meshgrid(DATES, LATITUDES, indexing="ij"))
    station = Circle(latitude[:, None], 0.0, RADIUS)
    tilted = TowardsStation(station, TILT) if rule in ("tilted", "both") else Level()
    chosen = ChooseWind(station, LOWEST, HIGHEST, AHEAD)
    steered = Shaded(chosen, tilted) if rule in ("shaded", "both") else tilted
    north = np.radians(latitude)
    place = Place(north, np.zeros(date.size), date + MORNING)
    flights = Flights(Vehicle(setup, steered), Start(np.full(date.size, ALTITUDE), place))
    accuracy = Accuracy.for_duration(float(ELAPSED[-1]), 1e-6)
    flown = fly_all(flights, Limits(20e3, 110e3), ELAPSED, accuracy)
    flies = np.isfinite(flown.altitude)
    middle = np.stack([np.cos(north), 0.0 * north, np.sin(north)], axis=-1)
    chord = np.linalg.norm(
        np.where(flies[..., None], flown.position, 0.0) - middle[:, None], axis=-1
    )
    distance = 2.0 * environment.planet.radius * np.arcsin(0.5 * chord)
    near = flies & (distance <= RADIUS)
    left = np.where(near.all(axis=1), ELAPSED.size, np.argmin(near, axis=1))
    hours = np.stack([left, near.sum(axis=1)]) * EVERY / 3600.0
    return hours.reshape(2, DATES.size, LATITUDES.size)


def compute():
    """Hours by disk and rule, into results.json."""
    atmosphere = GlobalNRLMSIS(f107=150.0, ap=4.0)
    light = Daylight().over(DATES[0], DATES[-1] + 7 * 86_400.0)
    earth = lf.Earth(atmosphere=atmosphere, sky=light, wind=GradientWind(atmosphere))
    found = {}
    for disk in DISKS:
        for rule in RULES:
            began = time.process_time()
            left, near = hours_near(rule, disk, earth).round(3).tolist()
            found.setdefault(disk, {})[rule] = {"left": left, "near": near}
            print(f"{disk}, {rule}: {time.process_time() - began:.0f} s", flush=True)
    RESULTS.write_text(json.dumps(found), encoding="utf-8")


def draw():
    """Maps of the hours by month and latitude."""
    found = json.loads(RESULTS.read_text(encoding="utf-8"))
    figure = plot.new_figure(width=8.0, height=5.6, rows=len(DISKS), columns=len(RULES))
    axes = np.reshape(figure.axes, (len(DISKS), len(RULES)))
    steps = matplotlib.colors.BoundaryNorm(SHOWN, 256, extend="max")
    edges = np.concatenate([LATITUDES[:7] - 5.0, [-18.0, 18.0], LATITUDES[7:] + 5.0])
    for row, (disk, rules) in enumerate(found.items()):
        for column, rule in enumerate(RULES):
            axis, hours = axes[row, column], np.array(rules[rule]["left"]).T
            shown = axis.pcolormesh(
                np.arange(13) + 0.5, edges, np.insert(hours, 7, np.nan, axis=0), norm=steps,
                cmap=palette.QUANTITY_MAP,
            )  # fmt: skip
            axis.set(xticks=[3, 6, 9, 12], yticks=[-60, -30, 0, 30, 60])
            axis.set_title("" if row else rule)
            axis.set_ylabel("" if column else f"{disk}\nlatitude [°]")
            axis.set_xlabel("month" if row else "")
    figure.colorbar(shown, ax=list(axes.ravel()), label="hours until 100 km away", ticks=SHOWN)
    figure.savefig(IMAGE, dpi=150)


def show():
    """Mean hours until it leaves by season, and where each rule is worse than none."""
    found = json.loads(RESULTS.read_text(encoding="utf-8"))
    seasons = {"Dec-Feb": [11, 0, 1], "Mar-May": [2, 3, 4], "Jun-Aug": [5, 6, 7],
               "Sep-Nov": [8, 9, 10]}  # fmt: skip
    for disk, rules in found.items():
        left = {rule: np.array(rules[rule]["left"]) for rule in RULES}
        for name, months in seasons.items():
            means = (f"{left[rule][months].mean():.1f}" for rule in RULES)
            print(f"{disk}, {name}:", *means)
        for rule in RULES[1:]:
            lost = left[rule] - left["level"]
            print(f"{disk}, {rule}: shorter at {np.mean(lost < -0.1):.0%}, by at most "
                  f"{-lost.min():.1f} h; longer at {np.mean(lost > 0.1):.0%}")  # fmt: skip


if __name__ == "__main__":
    if "draw" not in sys.argv:
        compute()
    show()
    draw()
