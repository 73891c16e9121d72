"""What survives its own lift: every kind of flyer, tilted disks, the best films; see README.md."""

import csv
import dataclasses
import sys
import tempfile
from pathlib import Path

import numpy as np
from study import SUNS, changed, disk_over_earth

import lightflyer as lf
from lightflyer.cli.commands.init import templates
from lightflyer.config.designs import as_design

HERE = Path(__file__).parent
KINDS = ("layers", "laden", "sandwich", "hollow", "balloon", "mars")
TILTS = np.radians(np.arange(0.0, 61.0, 2.0))
POLYMERS = {"mylar": ("PET", 520.0), "polyimide": ("polyimide", 633.0)}


def in_sun(setup, sun):
    """A setup with the sun elsewhere."""
    environment = setup.environment
    light = dataclasses.replace(environment.radiation, zenith_angle=np.radians(SUNS[sun]))
    environment = dataclasses.replace(environment, radiation=light)
    return dataclasses.replace(setup, environment=environment)


def kinds():
    """Where the templates of all kinds rest, how hot, and what they survive."""
    yield ("kind", "sun", "rests at [km]", "rests at [K]", "withstands [K]",
           "light survived [W/m²]", "least payload [mg]", "largest payload [mg]")  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        for kind in KINDS:
            path = Path(folder) / "flyer.toml"
            path.write_text(templates()[kind].read(), encoding="utf-8")
            setup = as_design(path).setup
            for sun in SUNS:
                yield kind, sun, *rest_of(in_sun(setup, sun))


def rest_of(setup):
    """Numbers of where a flyer rests, NaN where it does not."""
    prediction = lf.predict(setup)
    verdict, rest = prediction.verdict, prediction.verdict.rest
    if rest is None:
        return (np.nan,) * 6
    carries = 0.0, prediction.best.values["payload"]
    payloads = verdict.ballast or (carries if verdict.survives else (np.nan, np.nan))
    return (
        rest.coordinate / 1e3, rest.values["temperature"], verdict.highest_temperature,
        verdict.strongest_light, *(1e6 * one for one in payloads),
    )  # fmt: skip


def tilts():
    """Tilts with which empty disks of the template fly and survive, the sun overhead."""
    yield "diameter [mm]", "withstands [K]", "least tilt [°]", "largest tilt [°]"
    with tempfile.TemporaryDirectory() as folder:
        setup = disk_over_earth(Path(folder))
    for millimetres in (2.0, 5.0, 10.0, 15.0, 20.0):
        level = changed(setup, millimetres, 520.0, 0.0)
        survives = [lf.predict(tilted(level, tilt)).verdict.survives for tilt in TILTS]
        able = np.degrees(TILTS[[bool(one) for one in survives]])
        ends = (able[0], able[-1]) if able.size else (np.nan, np.nan)
        yield millimetres, 520.0, *ends


def tilted(setup, tilt):
    """A setup whose disk is tilted towards the north."""
    attitude = lf.environment.Attitude(tilt=tilt, azimuth=0.0)
    return dataclasses.replace(setup, flyer=dataclasses.replace(setup.flyer, attitude=attitude))


def film_disk(material, limit, zenith, centimetres="1", germanium="10"):
    """A disk of germanium under a polymer; diameter [cm] and thickness [nm] as texts."""
    layers = [
        {"material": material, "thickness": "500 nm"},
        {"material": "Ge", "thickness": f"{germanium} nm"},
    ]
    film = {
        "layers": layers, "spectrum": "AM0", "extrapolation": "hold", "tac_top": 0.77,
        "tac_bottom": 0.90, "highest_temperature": f"{limit} K",
    }  # fmt: skip
    return lf.FlyerFile(
        flyer={"diameter": f"{centimetres} cm"},
        film=film,
        environment={"kind": "earth", "incidence": f"{zenith} deg"},
    )


def films():
    """Germanium under a polymer: the disk that carries most afloat, with the limit and without."""
    yield ("polymer", "sun", "limit", "payload [mg]", "diameter [cm]", "germanium [nm]",
           "laden [K]", "empty [K]")  # fmt: skip
    over = {
        "flyer.diameter": {"from": "0.1 cm", "to": "5 cm", "scale": "log"},
        "film.layers.1.thickness": {"from": "2 nm", "to": "60 nm", "scale": "log"},
    }
    for polymer, film in POLYMERS.items():
        for sun, zenith in SUNS.items():
            for limited in (True, False):
                found = lf.optimise(
                    film_disk(*film, zenith), maximise="afloat_payload", over=over,
                    beyond_range=not limited, starts=4,
                )  # fmt: skip
                diameter, germanium = (found.design[name] for name in over)
                best = lf.predict(film_disk(*film, zenith, 1e2 * diameter, 1e9 * germanium))
                yield (
                    polymer, sun, "kept" if limited else "none", 1e6 * found.value,
                    1e2 * diameter, 1e9 * germanium, best.best.values["temperature"],
                    best.verdict.rest.values["temperature"],
                )  # fmt: skip


TABLES = {table.__name__: table for table in (kinds, tilts, films)}


def main():
    """Compute the tables, or those named, and write them beside this file."""
    asked = sys.argv[1:] or TABLES
    for table in (TABLES[name] for name in asked):
        lines = []
        for line in table():
            lines.append([one if isinstance(one, str) else f"{one:.4g}" for one in line])
            print(*lines[-1], sep="  ", flush=True)
        path = HERE / f"{table.__name__}.csv"
        with path.open("w", encoding="utf-8", newline="") as file:
            csv.writer(file).writerows(lines)


if __name__ == "__main__":
    main()
