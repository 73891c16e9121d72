"""Where, and in which season, a disk stays aloft; what that hangs on; the best one for 30 days.

Run as ``python studies/where_can_it_stay/study.py [PART ...]``, with the parts of PARTS, all by
default, or ``draw`` alone. Writes results.json here and docs/images/where-can-it-stay*.png.
"""

import json
import sys
import time
from pathlib import Path

import drawing
import numpy as np
from flights import DAY, SIZES, Case, disks, fly, largest_payload, largest_size

import lightflyer as lf
from lightflyer.core.clock import seconds_of
from lightflyer.force.lu2023 import PRINTED
from lightflyer.mission.path.attitude import FollowSun, Level

HERE = Path(__file__).parent
RESULTS = HERE / "results.json"
LATITUDES = np.arange(-87.5, 88.0, 7.0)
NORTH = np.array(
    [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 55.0, 60.0, 65.0, 70.0, 75.0, 80.0, 85.0, 88.0]
)
SOLSTICE = seconds_of("2026-06-21T12:00Z")
DATES = np.array([seconds_of(f"2026-{month:02d}-21T12:00Z") for month in range(1, 13)])
THIN = 0.37e-3  # kg/m2: 100 nm of alumina with 10 nm of chromium
FILMS = ("1 g/m²", "0.37 g/m²")
SHARES = (0.0, 0.2, 0.3, 0.5)
DESIGNED = 1e-3 * np.array([2.0, 3.0, 4.5, 6.0, 7.5, 9.0, 10.5, 12.0, 14.0, 17.0])
PLACES = np.array([0.0, 30.0, 45.0, 60.0])  # degrees
MONTH = SOLSTICE + 15.0 * DAY * np.array([-1.0, 0.0, 1.0])
DENSITIES = (1e-3, 0.7e-3, THIN)

STATED = Case()
LU2023 = STATED.but("lu2023", model=lf.Lu2023())
CASES = (
    STATED,
    STATED.but("albedo 0.1", albedo=0.1),
    STATED.but("albedo 0.5", albedo=0.5),
    STATED.but("wind 0.1 m/s up", wind_up=0.1),
    STATED.but("wind 0.1 m/s down", wind_up=-0.1),
    LU2023,
    STATED.but("lu2023 as printed", model=lf.Lu2023(reading=PRINTED)),
    STATED.but("follows the sun", rule=FollowSun()),
)

MAPS = (
    (STATED, 1e-3, "1 g/m²"),
    (LU2023, 1e-3, "1 g/m², lu2023"),
    (STATED, THIN, "0.37 g/m²"),
)


def season():
    """Largest disk that stays over map, date, latitude [m]."""
    return [
        largest_size(case, LATITUDES, DATES[:, None], areal_density=density)
        for case, density, _ in MAPS
    ]


def cases():
    """The same at the June solstice over areal density, latitude, by case."""
    return {
        case.name: [
            largest_size(case, NORTH, SOLSTICE, areal_density=density) for density in (1e-3, THIN)
        ]
        for case in CASES
    }


def design():
    """Largest payload around the solstice over latitude and size, by tilt [kg]."""
    return {
        f"{share:g}": largest_payload(tilting(share), DESIGNED, PLACES[:, None], MONTH, THIN)
        for share in SHARES
    }


def tilting(share):
    """The case of a disk that tilts by a share of the sun's zenith angle."""
    return STATED.but(f"tilt {share:g}", rule=FollowSun(share=share) if share else Level())


def best(found):
    """Best size [m] and its payload [kg] by tilt and latitude."""
    for share, payloads in found.items():
        for latitude, payload in zip(PLACES, np.asarray(payloads, float), strict=True):
            at = int(np.nanargmax(payload))
            yield float(share), latitude, DESIGNED[at], payload[at]


def flown():
    """Altitude after each of 30 days of the best designs, with 5 % less payload and 5 % more."""
    rows = list(best(json.loads(RESULTS.read_text(encoding="utf-8"))["design"]))
    return [
        fly(tilting(share), disks(size, latitude, MONTH[0], 75e3, areal_density=THIN,
                                  payload=payload * np.array([0.95, 1.05])), days=30, every=DAY)
        for share, latitude, size, payload in rows if share in (0.0, 0.3)
    ]  # fmt: skip


def lasting():
    """Altitude at noon over areal density, latitude, size, day, after a release at the solstice."""
    return [
        fly(STATED, disks(SIZES, NORTH[::2, None], SOLSTICE, 75e3, areal_density=density),
            days=30, every=DAY)
        for density in DENSITIES
    ]  # fmt: skip


PARTS = {part.__name__: part for part in (season, cases, lasting, design, flown)}


def rounded(values):
    """Arrays in lists, dicts and arrays as lists of five digits."""
    if isinstance(values, dict):
        return {name: rounded(value) for name, value in values.items()}
    numbers = np.asarray(values)
    if numbers.ndim:
        return [rounded(row) for row in numbers]
    return float(f"{numbers:.5g}") if np.isfinite(numbers) else None


def main(names):
    """Compute some parts, keep the others, draw."""
    found = json.loads(RESULTS.read_text(encoding="utf-8")) if RESULTS.exists() else {}
    for name in [name for name in names if name != "draw"]:
        start = time.process_time()
        found[name] = rounded(PARTS[name]())
        RESULTS.write_text(json.dumps(found) + "\n", encoding="utf-8")
        print(f"{name}: {time.process_time() - start:.0f} s of CPU", flush=True)
    if set(PARTS) <= set(found):
        drawing.draw_season(found["season"], LATITUDES, [name for *_, name in MAPS])
        drawing.draw_cases(found["cases"], NORTH, FILMS)


if __name__ == "__main__":
    main(sys.argv[1:] or list(PARTS))
