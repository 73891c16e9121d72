import contextlib
import copy
import io
import json
import threading
import tomllib
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from scipy.optimize import minimize

import lightflyer as lf
from lightflyer.config.flyer_file import FlyerFile
from lightflyer.config.reader import FLYER_FILE
from lightflyer.explorer import jobs, pages, view
from lightflyer.explorer.compute import prediction_of, quick
from lightflyer.explorer.editing import download, python_lines
from lightflyer.explorer.grammar import templates
from lightflyer.explorer.maps import Choices
from lightflyer.explorer.panes import panes
from lightflyer.explorer.state import View, keeping_warnings, plain, to_toml
from lightflyer.files.toml_file import parse_toml, validate
from lightflyer.film.optics.spectra import am0
from lightflyer.lab.levitation.data import read_lift_offs
from lightflyer.mission.report.events import Event, Events, add_events
from lightflyer.prediction.text import verdict_lines


@pytest.fixture
def document(workplace):
    """The first design, with the force that compiles fastest."""
    return copy.deepcopy(workplace.initial) | {"force": {"model": "lu2023", "force_error": 0}}


@pytest.fixture
def uncertain(document):
    document["film"]["tac_bottom"] = "0.90 ± 0.03"
    return document


def job(name, workplace, document, **choices):
    return jobs.run(
        name, workplace, document, Choices(**choices), lambda _: None, threading.Event()
    )


def test_page_shows_what_the_command_line_prints(workplace, document, write, prints):
    document["flyer"]["diameter"] = "2.3456789 cm"
    shown = pages.ANSWERS["predict"](workplace, {"document": document})
    path = write(download("toml", workplace, document, Choices()).content, "flyer.toml")
    told = json.loads(prints("predict", path, "--json"))
    for key, value in shown["summary"].items():
        assert told[key] == value, key  # to the last digit


def test_lines_of_python_give_the_same(workplace, document, capsys):
    document["film"]["absorptance"] = "0.7654321"
    names = {}
    exec(python_lines(document), names)
    own = prediction_of(workplace.design(document))
    assert names["prediction"].summary() == own.summary()
    assert json.dumps(own.summary()["best"])[:20].strip("{") in capsys.readouterr().out.replace(
        "'", '"'
    )


def test_downloads_hold_the_prediction(workplace, uncertain):
    prediction = prediction_of(workplace.design(uncertain))
    table = download("csv", workplace, uncertain, Choices()).content.decode()
    rows = np.genfromtxt(io.StringIO(table), delimiter=",", skip_header=1)
    np.testing.assert_allclose(rows[:, 0], prediction.coordinates, rtol=1e-9)
    dataset = xr.open_dataset(
        io.BytesIO(download("netcdf", workplace, uncertain, Choices()).content), engine="h5netcdf"
    )
    with dataset:
        np.testing.assert_array_equal(dataset["payload"], prediction.table["payload"])
        assert any("low" in name or "band" in name for name in dataset.variables)
    svg = download("irradiance.svg", workplace, uncertain, Choices()).content
    png = download("map.png", workplace, uncertain, Choices()).content
    assert b"95 % band" in svg
    bars = download("sensitivity.svg", workplace, uncertain, Choices()).content
    assert b"film tac bottom" in bars
    assert png.startswith(b"\x89PNG")
    with pytest.raises(lf.ConfigurationError, match="no figure"):
        download("nothing.svg", workplace, uncertain, Choices())


def test_mistakes_are_told_at_their_fields(workplace, document):
    document["flyer"]["diameter"] = "2 xm"
    document["film"] |= {"absorptance": "1.5", "emitance": "0.1"}
    told = pages.ANSWERS["move"](workplace, {"document": document})
    assert {one["key"] for one in told["errors"]} == {
        "flyer.diameter", "film.absorptance", "film.emitance",
    }  # fmt: skip
    assert all("\n" not in one["text"] and ".toml" not in one["text"] for one in told["errors"])
    assert "figures" not in told
    assert told["url"].startswith("flyer.shape=disk&flyer.diameter=2+xm")


def test_warnings_about_parameters_are_in_the_result(workplace, document):
    document["film"]["tac_top"] = "1.05"
    with keeping_warnings():
        found = pages.ANSWERS["predict"](workplace, {"document": document})
    assert any("tac_top = 1.05 exceeds 1" in text for text in found["warnings"])


def test_bands_are_those_that_the_samples_of_the_command_have(workplace, uncertain):
    found = job("bands", workplace, uncertain)
    design = workplace.design(uncertain)
    expected = lf.propagate(design)
    band = found["figures"]["temperature"]["sources"]["band"]
    np.testing.assert_allclose(band["low"], expected.low["temperature"], rtol=1e-12)
    np.testing.assert_allclose(band["x"], expected.coordinate / 1e3, rtol=1e-12)
    reading = next(one for one in found["readings"] if one["name"] == "best.temperature_k")
    ends = expected.summary()["results"]["best.temperature_k"]["monte_carlo"]
    assert reading["spread"] == f"95 %: {ends['low']:.3g} to {ends['high']:.3g} K"
    assert "500 samples" in found["note"]


def test_verdict_is_that_of_the_command(workplace, document, tmp_path, run, prints):
    """A flyer whose film survives in a third of the samples is no flyer that survives."""
    shown = pages.ANSWERS["predict"](workplace, {"document": document})["verdict"]
    own = prediction_of(workplace.design(document))
    assert shown["state"] == ("flies" if own.verdict.survives else "hot")
    assert shown["lines"] == list(verdict_lines(own))[1:]
    document["flyer"]["diameter"] = "50 cm"
    heavy = pages.ANSWERS["predict"](workplace, {"document": document})["verdict"]
    assert heavy["state"] == "not"
    assert heavy["lines"][0].startswith("It does not fly")
    run("init", tmp_path / "laden.toml", "--kind", "laden")
    printed = prints("predict", tmp_path / "laden.toml")
    laden = tomllib.loads((tmp_path / "laden.toml").read_text(encoding="utf-8"))
    first = pages.ANSWERS["predict"](workplace, {"document": laden})["verdict"]
    assert first["state"] == "unsure"  # until samples say more
    found = job("bands", workplace, laden)["verdict"]
    assert found["state"] == "unsure"
    assert " ".join(found["lines"]) in " ".join(printed.split())


def test_moving_curves_clear_bands_of_another_design(workplace, document):
    figures = view.curves(quick(workplace.design(document)))
    assert all(data["sources"]["band"]["x"] == [] for data in figures.values())
    exact = view.marks(prediction_of(workplace.design(document)))
    for name, data in figures.items():
        for end in ("low", "high"):
            quick_edge = data["sources"]["flies"][end]
            assert quick_edge == pytest.approx(exact[name]["sources"]["flies"][end], abs=0.1)


def test_optimum_of_the_map_is_that_of_a_search(workplace, document):
    found = job("map", workplace, document)
    film = workplace.design(document).setup.flyer.film
    environment, model = workplace.design(document).setup.environment, lf.Lu2023()

    def lacking(place):
        disk = lf.Disk(film, radius=0.5 * np.exp(place[0]))
        return -1e6 * float(lf.payload(disk, environment.state(1e3 * place[1]), model))

    best = minimize(lacking, [np.log(0.03), 74.0], method="Nelder-Mead", options={"xatol": 1e-4})
    assert found["best"][0] == pytest.approx(np.exp(best.x[0]), rel=0.02)
    assert found["best"][1] == pytest.approx(1e3 * best.x[1], abs=100.0)
    assert found["best"][2] == pytest.approx(-1e-6 * best.fun, rel=1e-3)
    values = np.array([value or 0.0 for value in found["sources"]["cells"]["value"]])
    assert values.max() == pytest.approx(found["best"][2] * 1e6, rel=0.02)
    assert "Largest payload" in found["words"]
    assert any("at the optimum: " in text for text in found["warnings"])  # hotter than was measured


def test_sensitivity_is_the_derivative_that_propagation_uses(workplace, uncertain):
    found = job("sensitivity", workplace, uncertain, output="levitation_irradiance")
    expected = lf.propagate(workplace.design(uncertain), samples=0)
    name = "minimum_irradiance.value_w_m2"
    relative = expected.first_order[name] / expected.nominal[name] / (0.03 / 0.90)
    # at the optimum the place's own motion has no part in it
    assert abs(found["elasticities"]["film.tac_bottom"]) == pytest.approx(relative, rel=1e-4)
    assert found["elasticities"]["film.areal_density"] > 0.0


def test_force_models_side_by_side_are_those_of_compare(workplace, document, monkeypatch):
    monkeypatch.setattr(jobs, "models_for", lambda _: ["lu2023", "free-molecular", "schafer2025"])
    found = job("models", workplace, document)
    lines = found["sources"]["curves"]
    assert lines["name"] == ["lu2023", "lu2023", "free-molecular", "free-molecular"]
    assert lines["alpha"] == [0.35, 1.0, 0.35, 1.0]
    faint, strong = (sum(value is not None for value in ys) for ys in lines["ys"][2:])
    assert strong == 0 < faint  # nothing that flies is at a Knudsen number above ten
    assert any("left out: schafer2025" in text for text in found["warnings"])
    own = lf.predict(workplace.design(document)).easiest.values["levitation_irradiance"]
    assert min(value for value in lines["ys"][0] if value) == pytest.approx(own, rel=1e-2)


def test_a_mission_begins_where_the_flyer_carries_most_under_the_sun(workplace, document):
    asked = {"document": document, "section": "mission", "tag": "given"}
    given = pages.ANSWERS["switch"](workplace, asked)["document"]
    best = prediction_of(workplace.design(document)).verdict.best
    assert given["mission"]["altitude"] == f"{best.coordinate / 1e3:.1f} km"
    assert "irradiance" not in given["environment"]
    workplace.mission(given)  # which a file with this content would be


def named(content):
    """Names that the parts of a figure have, with the columns of its sources."""
    if isinstance(content, list):
        for part in content:
            yield from named(part)
    elif isinstance(content, dict):
        attributes = content.get("attributes", {})
        if attributes.get("name"):
            yield (
                attributes["name"],
                {key for key, _ in attributes.get("data", {}).get("entries", [])},
            )
        for part in content.values():
            yield from named(part)


@pytest.mark.parametrize("logarithmic", [False, True])
def test_figures_have_what_data_are_put_into(workplace, uncertain, logarithmic, monkeypatch):
    monkeypatch.setattr(jobs, "models_for", lambda _: ["lu2023", "free-molecular"])
    drawn = {name: list(named(item)) for name, item in panes(logarithmic=logarithmic).items()}
    design = workplace.design(uncertain)
    put = [view.curves(quick(design)), view.marks(prediction_of(design))]
    put += [job("bands", workplace, uncertain)["figures"]]
    put += [{name: job(name, workplace, uncertain)} for name in ("map", "models", "sensitivity")]
    for figures in put:
        for figure, data in figures.items():
            names = [name for name, _ in drawn[figure]]
            assert len(set(names)) == len(names), f"{figure}: two parts have one name"
            for source, columns in data["sources"].items():
                assert dict(drawn[figure])[source] == set(columns), (figure, source)
    for figure, parts in drawn.items():
        wanted = {"x-axis", "y-axis"} | ({"colours"} if figure == "map" else set())
        assert wanted <= {name for name, _ in parts}
        assert "hover" in dict(parts)


def test_film_of_measured_numbers_says_that_it_has_no_spectrum(workplace, document):
    with pytest.raises(lf.ConfigurationError, match="choose layers"):
        job("film", workplace, document)


@pytest.mark.parametrize("over_altitude", [True, False])
def test_points_are_where_their_reader_has_them(workplace, document, points_file, over_altitude):
    """Over altitude, where the air has their pressure."""
    if not over_altitude:
        document["environment"] = {
            "kind": "chamber", "temperature": "293 K", "irradiance": "1500 W/m^2",
        }  # fmt: skip
    found = pages.points(workplace, points_file.read_text(), "mine.csv", document)
    samples, _ = read_lift_offs(points_file)
    pressure = np.concatenate([one.pressure for one in samples])
    places = np.array(found["columns"]["x"])
    if over_altitude:
        np.testing.assert_allclose(lf.Earth().state(1e3 * places).pressure, pressure, rtol=1e-3)
        assert any("altitude whose pressure" in text for text in found["warnings"])
    else:
        np.testing.assert_allclose(np.sort(places), np.sort(pressure), rtol=1e-12)
    assert "mine.csv" in found["words"]
    assert str(points_file) not in json.dumps(found)


def test_pinned_designs_show_what_differs(workplace, document):
    other = copy.deepcopy(document)
    other["flyer"]["diameter"] = "3 cm"
    found = pages.ANSWERS["pins"](workplace, {"document": document, "pins": [other], "scale": 1e6})
    assert found["differences"] == [{"key": "flyer.diameter", "values": ["2 cm", "3 cm"]}]
    curve = found["figures"]["payload"]["sources"]["pins"]["ys"][0]
    own = lf.predict(workplace.design(other)).table["payload"]
    np.testing.assert_allclose(np.array(curve), own * 1e6)


def test_results_at_a_place(workplace, document):
    ask = {"document": document, "at": "75 km"}
    found = pages.ANSWERS["move"](workplace, ask)["place"]
    listed = lf.predict(workplace.design(document), at=[75e3]).summary()["at"][0]
    by_name = {row["name"]: row["value"] for row in found["rows"]}
    for name in ("temperature_k", "lift_over_weight", "levitation_irradiance_w_m2"):
        assert by_name[name] == listed[name]
    for wrong, words in (("75", "has no unit"), ("-3 km", "between 0 and"), ("x", "not a number")):
        told = pages.ANSWERS["move"](workplace, {**ask, "at": wrong})
        assert words in told["errors"][0]["text"]
        assert "figures" in told


def test_film_of_layers_shows_the_share_of_sunlight_that_it_absorbs(workplace, document):
    layers = [{"material": "Al", "thickness": "30 nm"}]
    document["film"] = {
        "layers": layers,
        "tac_top": 0.8,
        "tac_bottom": 0.9,
        "extrapolation": "hold",
    }
    found = job("film", workplace, document)
    curve = {name: np.array(column) for name, column in found["sources"]["curve"].items()}
    whole = curve["absorptance"] + curve["reflectance"] + curve["transmittance"]
    np.testing.assert_allclose(whole, 1.0, rtol=1e-9)
    sun = am0()
    share = np.interp(sun.wavelength * 1e6, curve["x"], curve["absorptance"])
    absorbed = np.trapezoid(share * sun.irradiance, sun.wavelength)
    told = float(found["words"].partition("absorptance ")[2].split()[0])
    assert told == pytest.approx(absorbed / np.trapezoid(sun.irradiance, sun.wavelength), abs=2e-3)


def test_mission_is_drawn_with_its_nights(workplace, document, monkeypatch):
    """Altitude over time as ``fly`` gives it, which has tests of its own."""
    hours = np.arange(49.0)
    flown = xr.Dataset(
        {
            "altitude": ("elapsed", 75e3 + 5e3 * np.sin(2.0 * np.pi * hours / 24.0)),
            "irradiance": ("elapsed", 1000.0 * np.maximum(np.cos(2.0 * np.pi * hours / 24.0), 0.0)),
            "temperature": ("elapsed", np.full(hours.size, 300.0)),
            "end_elapsed": 48.0 * 3600.0,
            "end_altitude": 75e3,
            "longitude": ("elapsed", (170.0 + hours + 180.0) % 360.0 - 180.0),  # over the date line
            "latitude": ("elapsed", -40.0 + 0.5 * hours),
            "end_longitude": -142.0,
            "end_latitude": -16.0,
            "ensemble_altitude": (("member", "elapsed"), np.full((200, hours.size), 60e3)),
            "ensemble_longitude": (("member", "elapsed"), np.full((200, hours.size), 179.0)),
            "ensemble_latitude": (("member", "elapsed"), np.full((200, hours.size), -30.0)),
        },
        {
            "elapsed": 3600.0 * hours,
            "time": ("elapsed", np.datetime64("2026-06-21", "h") + hours.astype("m8[h]")),
        },
        {"end": "is still aloft", "warnings": "one\ntwo", "assumptions": "light",
         "planet": "Earth"},
    )  # fmt: skip
    kinds = np.array([Event.LIGHT_BEGINS, Event.LIGHT_ENDS] * 3)[:5]
    passed = 3600.0 * np.array([0.0, 4.0, 20.0, 28.0, 44.0])
    add_events(flown, Events(kinds, passed, 75e3 + 0.0 * passed, 300.0 + 0.0 * passed))
    asked = {}
    monkeypatch.setattr(
        "lightflyer.mission.mission.fly", lambda design, **given: asked.update(given) or flown
    )
    mission = pages.ANSWERS["switch"](
        workplace, {"document": document, "section": "mission", "tag": "given"}
    )["document"]
    mission["mission"]["altitude"] = "77 km"
    found = job("mission", workplace, mission)
    assert float(asked["mission"].release.altitude) == 77e3
    nights = found["sources"]["nights"]
    # darker than half of the noon's light: four hours after noon to four before the next
    np.testing.assert_allclose(nights["low"], [4.0, 28.0], atol=0.1)
    np.testing.assert_allclose(nights["high"], [20.0, 44.0], atol=0.1)
    assert found["warnings"] == ["one", "two"]
    assert "After 48 h, at 75 km, the flyer is still aloft." in found["words"]
    assert len(found["sources"]["members"]["ys"]) == 100  # as many as can be told apart
    assert found["y"][0] <= 60.0
    track = found["track"]
    way, shores = track["sources"]["curve"], np.array(track["sources"]["shores"]["x"], float)
    np.testing.assert_allclose(way["x"], 170.0 + hours)  # goes on beyond the date line
    np.testing.assert_allclose(way["y"], flown.latitude)
    assert way["utc"][12] == "2026-06-21 12:00 UTC"
    assert track["x"][0] < 170.0 < 218.0 < track["x"][1]
    assert track["words"] == "From 40° S, 170° E to 16° S, 142° W."
    known = shores[np.isfinite(shores)]
    assert known.size > 100  # New Zealand
    assert track["x"][0] - 5.0 < known.min() < 180.0 < known.max() < track["x"][1] + 5.0
    with pytest.raises(lf.ConfigurationError, match="mission"):
        job("mission", workplace, document)


PIECES = [
    *(["0", "-1", "1e400", "nan", "±", "²", "\x00", "[", "{}", "2026-13-45", "true"]),
    *("", " ", "2 cm", "2 ± 3 cm", "\ud800", "a" * 3000),
    *(None, True, 0, -1, 1e308, float("nan")),
    *([], {}, [{}], {"a": 1}, ["x"], [None], [[[]]], {"a": {"b": None}}),
]


def test_documents_torn_apart_are_told_in_words(rng):
    """No value anywhere in a design makes anything but a line for its mistake."""
    starts = [plain(one.document) for one in templates().values()]
    for _ in range(400):
        torn = copy.deepcopy(starts[rng.integers(len(starts))])
        for _ in range(rng.integers(1, 3)):
            places = [part for part in torn.values() if isinstance(part, dict) and part]
            place = places[rng.integers(len(places))]
            place[rng.choice(list(place))] = PIECES[rng.integers(len(PIECES))]
        with contextlib.suppress(lf.LightflyerError):
            pages.require_document(torn)
            assert pages.tags_of(torn) is not None
            assert pages.to_url(View(torn)).isascii()
            read_only(torn)


def read_only(document):
    """Check a design without building it."""
    content = {name: part for name, part in document.items() if name != "mission"}
    text = to_toml(content)
    content = parse_toml(text, Path("flyer.toml"), FLYER_FILE)
    validate(FlyerFile, content, text, Path("flyer.toml"), FLYER_FILE)
