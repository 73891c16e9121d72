"""One verdict, whoever is asked: predictions, comparisons, explorer, reports, sweeps, searches."""

import html
import itertools
import re

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.cli.commands.init import templates
from lightflyer.config.designs import as_design
from lightflyer.explorer.compute import prediction_of, readings
from lightflyer.prediction.text import verdict_lines

FILES = {name: file.read() for name, file in templates().items()}
KINDS = sorted(name for name, text in FILES.items() if "shape" in text and name != "mission")
REPORTED = ("chamber",)  # the kinds whose report is written too: drawing takes most of the time

FILM = {"areal_density": "1 g/m^2", "tac_top": 0.75, "tac_bottom": 0.95,
        "absorptance": 0.75, "highest_temperature": "520 K"}  # fmt: skip


def plain(text):
    """Words of a page or a screen, without tags and line breaks."""
    return re.sub(r"\s+", " ", html.unescape(re.sub("<[^>]*>", " ", text)))


@pytest.fixture(scope="module")
def compared(tmp_path_factory):
    """Paths of the templates, and the verdicts of those over altitude and over pressure."""
    folder, groups = tmp_path_factory.mktemp("templates"), {}
    paths = {kind: folder / f"{kind}.toml" for kind in KINDS}
    for kind, path in paths.items():
        path.write_text(FILES[kind], encoding="utf-8")
        groups.setdefault(as_design(path).setup.environment.coordinate.name, {})[kind] = path
    found = (lf.compare(group, samples=0).summary()["flyers"] for group in groups.values())
    return paths, {one["name"]: one["verdict"] for flyers in found for one in flyers}


@pytest.mark.parametrize("kind", KINDS)
def test_templates(kind, prints, tmp_path, compared):
    path, told = compared[0][kind], compared[1][kind]
    prediction = prediction_of(as_design(path))
    verdict, summary = prediction.verdict, prediction.summary()
    assert told == summary["verdict"]
    shown = {one.name: one for one in readings(prediction, None)}
    if verdict.rest is not None:
        assert shown["verdict.rest.temperature_k"].value == verdict.rest.values["temperature"]
    best = verdict.best or prediction.best
    group = "best" if best is prediction.best else "verdict.best"
    assert shown[f"{group}.payload_mg"].value == 1e6 * best.values["payload"]
    report = tmp_path / "report.html"
    written = ("--report", report) if kind in REPORTED else ()
    line = next(verdict_lines(prediction))
    assert line in plain(prints("predict", path, "--samples", 0, *written))
    assert not written or line in plain(report.read_text(encoding="utf-8"))


def test_ten_disks():
    """Between disks that nothing lifts, that are too hot at rest, and that survive."""
    absorptances, emittances = (0.4, 0.9), (0.03, 0.08, 0.15, 0.3, 0.9)
    file = lf.FlyerFile(flyer={"diameter": "2 cm"}, film=FILM | {"emittance": 0.08})
    over = {"film.absorptance": absorptances, "film.emittance": emittances}
    swept = lf.sweep(file, over=over, outputs=["usable_payload", "rest_temperature"])
    survive = set()
    for absorptance, emittance in itertools.product(absorptances, emittances):
        film = FILM | {"absorptance": absorptance, "emittance": emittance}
        found = lf.predict(lf.FlyerFile(flyer={"diameter": "2 cm"}, film=film))
        place = {"film.absorptance": absorptance, "film.emittance": emittance}
        row = {name: float(values) for name, values in swept.sel(place).data_vars.items()}
        verdict = found.verdict
        survive.add(verdict.survives)
        assert np.isfinite(row["rest_temperature"]) == bool(found.bands)
        if not found.bands:
            continue
        assert row["rest_temperature"] == pytest.approx(
            verdict.rest.values["temperature"], rel=1e-6
        )
        carried = 0.0 if verdict.best is None else verdict.best.values["payload"]
        assert max(row["usable_payload"], 0.0) == pytest.approx(carried, rel=1e-6)
    assert survive == {None, False, True}
