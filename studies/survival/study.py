"""Which disks survive their own lift, and what lets them; see README.md."""

import csv
import dataclasses
import tempfile
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

import lightflyer as lf
from lightflyer.cli.commands.init import templates
from lightflyer.config.designs import as_design

HERE = Path(__file__).parent
RESULTS = HERE / "results.csv"
DIAMETERS_MM = (2.0, 5.0, 10.0, 15.0, 20.0)
LIMITS_K = (520.0, 633.0)  # mylar, and the polyimide of the library
# zenith angles of the sun [°]: overhead, and at noon of the solstice at 70° N
SUNS = {"overhead": 0.0, "June at 70° N": 46.6}
EMITTANCES = (0.08, 0.5)  # between which the least that survives is sought
COLUMNS = (
    "sun", "film withstands [K]", "diameter [mm]", "rests at [km]", "rests at [K]",
    "light survived [W/m²]", "least payload [mg]", "largest payload [mg]", "of own mass [1]",
    "least emittance [1]",
)  # fmt: skip


def disk_over_earth(folder):
    """The setup of ``lightflyer init``."""
    path = folder / "flyer.toml"
    path.write_text(templates()["earth"].read(), encoding="utf-8")
    return as_design(path).setup


def changed(setup, millimetres, limit, zenith, emittance=None):
    """The setup with a disk, a film and a sun of another kind."""
    film = dataclasses.replace(setup.flyer.film, highest_temperature=limit)
    if emittance is not None:
        film = dataclasses.replace(film, emittance_top=emittance, emittance_bottom=emittance)
    flyer = dataclasses.replace(setup.flyer, film=film, radius=0.5e-3 * millimetres)
    environment = setup.environment
    light = dataclasses.replace(environment.radiation, zenith_angle=np.radians(zenith))
    environment = dataclasses.replace(environment, radiation=light)
    return dataclasses.replace(setup, flyer=flyer, environment=environment)


def least_emittance(setup, *design):
    """Emittance of both faces from which on the empty disk survives at rest; NaN where none."""

    def excess(emittance):
        rest = lf.predict(changed(setup, *design, emittance)).verdict.rest
        return np.nan if rest is None else rest.values["temperature"] - design[1]

    emittances = np.linspace(*EMITTANCES, 22)
    hot = np.array([excess(one) for one in emittances])
    cool = np.flatnonzero(hot <= 0.0)
    if not cool.size or cool[0] == 0:
        return emittances[0] if cool.size else np.nan
    return brentq(excess, emittances[cool[0] - 1], emittances[cool[0]], xtol=1e-4)


def row(setup, sun, limit, millimetres):
    """One line of the table."""
    design = (millimetres, limit, SUNS[sun])
    prediction = lf.predict(changed(setup, *design))
    verdict, own = prediction.verdict, float(prediction.setup.flyer.area) * 1e-3
    if verdict.rest is None:
        return (sun, limit, millimetres, *(np.nan,) * 6, least_emittance(setup, *design))
    carries = 0.0, prediction.best.values["payload"]
    payloads = verdict.ballast or (carries if verdict.survives else (np.nan, np.nan))
    return (
        sun, limit, millimetres, verdict.rest.coordinate / 1e3,
        verdict.rest.values["temperature"], verdict.strongest_light,
        payloads[0] * 1e6, payloads[1] * 1e6, payloads[1] / own, least_emittance(setup, *design),
    )  # fmt: skip


def table():
    """All lines, the columns first."""
    with tempfile.TemporaryDirectory() as folder:
        setup = disk_over_earth(Path(folder))
    yield COLUMNS
    for sun in SUNS:
        for limit in LIMITS_K:
            for millimetres in DIAMETERS_MM:
                found = row(setup, sun, limit, millimetres)
                yield [x if isinstance(x, str) else f"{x:.4g}" for x in found]


def main():
    """Compute the table and write it beside this file."""
    lines = []
    for line in table():
        lines.append(line)
        print(*line, sep="  ", flush=True)
    with RESULTS.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file).writerows(lines)


if __name__ == "__main__":
    main()
