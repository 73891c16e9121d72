"""Comparison of flyers on one grid, beside what each of them does alone."""

import csv
import dataclasses
import json
from importlib.resources import files

import numpy as np
import pytest

import lightflyer as lf
from lightflyer.comparison import to_dataset, write_csv
from lightflyer.comparison.text import join_outputs, require_comparable
from lightflyer.design.outputs import outputs_of

EXACT = lf.Lu2023(force_error=0.0)  # as if its force had no error


def disk(areal_density=1e-3, radius=0.01, tac_bottom=0.9):
    film = lf.FilmProperties(areal_density, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=tac_bottom)
    return lf.Disk(film, radius)


def over_earth(flyer, **earth):
    return lf.Setup(flyer, lf.Earth(**earth), EXACT)


@pytest.fixture(scope="module")
def designs():
    uncertain = lf.design.ObjectDesign(
        over_earth(disk(radius=0.02)), {"flyer.film.tac_bottom": 0.02, "flyer.radius": 5e-4}
    )
    return [over_earth(disk()), uncertain]


@pytest.fixture(scope="module")
def found(designs):
    return lf.compare(dict(zip(("small", "wide"), designs, strict=True)), samples=0)


def test_each_flyer_is_as_it_is_alone(designs, found):
    for compared, design in zip(found.flyers, designs, strict=True):
        setup = getattr(design, "setup", design)
        state = setup.environment.state(found.coordinates)
        masses = lf.payload(setup.flyer, state, setup.model)
        np.testing.assert_allclose(compared.table["payload"], masses, rtol=1e-9, atol=1e-15)
        listed = setup.environment.state(found.listed)
        there = lf.payload(setup.flyer, listed, setup.model)
        np.testing.assert_allclose(compared.listed["payload"], there, rtol=1e-9, atol=1e-15)
        ((low, high),) = compared.prediction.bands
        assert found.coordinates[0] < low < high < found.coordinates[-1]
    assert found.best.name == "wide"
    assert np.all(found.listed % 1e3 == 0.0)
    assert 5 <= found.listed.size <= 13


def test_bands_are_those_of_shifted_flyers(found):
    small, wide = found.flyers
    assert small.band("payload") is None
    assert small.best_band("payload") is None
    state = lf.Earth().state(found.coordinates)

    def per_area(tac_bottom, radius):
        flyer = disk(radius=radius, tac_bottom=tac_bottom)
        return lf.payload(flyer, state, lf.Lu2023()) / (np.pi * radius**2)

    by_tac = (per_area(0.901, 0.02) - per_area(0.899, 0.02)) / 0.002 * 0.02
    by_size = (per_area(0.9, 0.02001) - per_area(0.9, 0.01999)) / 2e-5 * 5e-4
    half = 1.959964 * np.hypot(by_tac, by_size)
    low, high = wide.band("payload_per_area")
    np.testing.assert_allclose(0.5 * (high - low), half, rtol=1e-4, atol=1e-12)
    at_best = wide.best_band("payload")
    assert at_best[0] < wide.prediction.best.values["payload"] < at_best[1]
    assert "no band for small: no ± is stated" in found.warnings


def test_what_is_not_on_one_footing_is_named(designs):
    dim = over_earth(disk(), radiation=lf.environment.sunlight(1000.0), gravity=9.0)
    found = lf.compare({"a": designs[0], "b": dim})
    told = [text for text in found.warnings if text.startswith("not on one footing: ")]
    assert told[0].endswith(
        "light: 1361 W/m², 0° from the vertical (a); 1000 W/m², 0° from the vertical (b)"
    )
    assert told[1:] == ["not on one footing: gravity: not given (a); 9 m/s^2 (b)"]
    assert not found.differing_models
    paper = lf.Setup(disk(), lf.lu2023_earth(), lf.Lu2023(reading=lf.force.PRINTED))
    found = lf.compare({"a": designs[0], "b": paper}, searched=(60e3, 80e3))
    topics = [difference.what for difference in found.differing_surroundings]
    assert {"light", "atmosphere", "gravity", "infrared", "reflected light"} <= set(topics)
    assert "searched" not in topics
    assert "force model reading heat weight" in [
        difference.what for difference in found.differing_models
    ]
    assert found.coordinates[[0, -1]] == pytest.approx([60e3, 80e3])
    best = found.flyers[1].prediction.best.coordinate
    assert 60e3 <= best <= 80e3


def test_tables_hold_everything(found, tmp_path):
    dataset = to_dataset(found)
    assert dataset.sizes == {"flyer": 2, "altitude": 121}
    assert dataset.payload_per_area.attrs["units"] == "kg m-2"
    assert dataset.payload_low.attrs["long_name"].endswith("low end of the 95 % band")
    assert np.isnan(dataset.payload_low.sel(flyer="small")).all()
    assert np.isfinite(dataset.payload_low.sel(flyer="wide")).all()
    dataset.to_netcdf(tmp_path / "found.nc", engine="h5netcdf")
    write_csv(found, tmp_path / "found.csv")
    with (tmp_path / "found.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 2 * 121
    assert rows[0]["flyer"] == "small"
    assert rows[0]["payload_low [kg]"] == ""
    wide = [float(row["payload [kg]"]) for row in rows if row["flyer"] == "wide"]
    np.testing.assert_allclose(wide, dataset.payload.sel(flyer="wide"), rtol=1e-9)
    summary = json.loads(json.dumps(found.summary(), allow_nan=False))
    assert [flyer["name"] for flyer in summary["flyers"]] == ["small", "wide"]
    assert "uncertainty" in summary["flyers"][1]
    assert summary["best"] == "wide"


def test_chambers_are_compared_over_pressure():
    setups = [
        lf.Setup(disk(), lf.Chamber(radiation=lf.environment.Radiation(light)), lf.Lu2023())
        for light in (1000.0, 2000.0)
    ]
    found = lf.compare(setups)
    assert [flyer.name for flyer in found.flyers] == ["disk of 2 cm", "disk of 2 cm (2)"]
    ratios = found.coordinates[1:] / found.coordinates[:-1]
    np.testing.assert_allclose(ratios, ratios[0])
    assert {1.0, 10.0} < set(found.listed)
    assert found.dataset.pressure.attrs["units"] == "Pa"


def test_the_figure_marks_what_the_film_does_not_bear():
    film = lf.FilmProperties(
        1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9, highest_temperature=520.0
    )
    found = lf.compare(
        [over_earth(lf.Disk(film, radius)) for radius in (0.01, 0.02)], samples=0,
        searched=(60e3, 90e3),
    )  # fmt: skip
    (axes,) = found.plot("temperature").axes
    crosses = [line for line in axes.get_lines() if line.get_marker() == "x"]
    assert len(crosses) == 2
    for line, one in zip(crosses, found.flyers, strict=True):
        hot = found.coordinates[one.table["temperature"] > 520.0] / 1e3
        assert np.min(line.get_ydata()) > 520.0
        assert np.ptp(line.get_xdata()) == pytest.approx(np.ptp(hot), rel=0.2)


def test_figure_tells_nine_flyers_apart(designs):
    from lightflyer.comparison.figures import comparison_figure

    setups = [over_earth(disk(mass)) for mass in np.geomspace(2e-4, 2e-3, 8)]
    found = lf.compare([*setups, designs[1]], samples=0, searched=(60e3, 90e3))
    figure = comparison_figure(found)
    (legend,) = figure.legends
    labels = [text.get_text() for text in legend.get_texts()]
    assert labels[9:] == ["outside the range of force model or gas", "95 % band"]
    axes = figure.axes[0]
    looks = {(line.get_color(), line.get_linestyle()) for line in axes.get_lines()[:9]}
    assert len(looks) == 9
    assert len(axes.collections) == 1
    # every flyer that carries something is seen
    low, high = axes.get_ylim()
    for compared in found.flyers:
        best = compared.prediction.best.values["payload"] * 1e6
        assert best <= 0.0 or low < best < high


@pytest.mark.parametrize(
    ("arguments", "options", "message"),
    [
        (1, {}, "compare takes 2 to 9 flyers, not 1"),
        (10, {}, "flyers, not 10"),
        (2, {"searched": (8e4, 6e4)}, "80 km to 60 km is not a range"),
        (2, {"searched": (0.0, 2e6)}, "^disk of 2 cm: searched altitude"),
        (2, {"samples": 5}, "samples = 5"),
    ],
)
def test_what_cannot_be_compared_is_refused(designs, arguments, options, message):
    with pytest.raises(lf.ParameterError, match=message):
        lf.compare([designs[0]] * arguments, **options)


def test_one_flyer_is_no_comparison(designs):
    for one in (designs[0], "flyer.toml", designs[0].flyer):
        with pytest.raises(lf.ParameterError, match="flyers, not 1"):
            lf.compare(one)


def test_flyers_share_surroundings_and_model():
    disks = {"light": disk(5e-4), "heavy": disk(1e-3)}
    found = lf.compare(disks, lf.Earth(), lf.Lu2023(), samples=0)
    assert [flyer.name for flyer in found.flyers] == ["light", "heavy"]
    one = lf.predict(disks["heavy"], lf.Earth(), lf.Lu2023())
    assert found.flyers[1].prediction.bands == one.bands
    with pytest.raises(lf.ParameterError, match="stand beside a flyer"):
        lf.compare([over_earth(one) for one in disks.values()], lf.Earth(), lf.Lu2023())
    with pytest.raises(lf.ParameterError, match=r"one model .* a lightflyer.Setup\(flyer, "):
        lf.compare(disks, lf.Earth(), [lf.Lu2023(), lf.Kinetic()])


def test_errors_of_force_models_and_what_does_not_fly_are_said():
    heavy = lf.Disk(disk().film, 0.01, payload="5 mg", attitude=None)
    models = {"kinetic": lf.Kinetic(), "fitted": lf.Lu2023(), "thin": lf.FreeMolecular()}
    setups = {name: lf.Setup(disk(), lf.Earth(), model) for name, model in models.items()}
    found = lf.compare(setups | {"heavy": over_earth(heavy)}, samples=0)
    low, high = found.flyers[0].best_band("payload")
    alone = lf.propagate(lf.predict(disk(), lf.Earth(), lf.Kinetic()).setup, samples=0)
    assert alone is None  # as nobody stated them
    assert low < found.flyers[0].best.values["payload"] < high
    assert found.flyers[2].uncertainty is None
    text = " ".join(str(found).split())
    assert "thin carries most" in text
    assert "km, outside the range of force model or gas" in text
    assert "D: It does not fly: lift is at most 0." in text


def test_altitude_and_pressure_are_not_mixed(designs):
    chamber = lf.Setup(disk(), lf.Chamber(), lf.Lu2023())
    with pytest.raises(lf.ConfigurationError, match="a is described over altitude and b over pres"):
        lf.compare({"a": designs[0], "b": chamber})


def test_one_name_for_two_things_in_one_unit():
    plate, hollow = (
        lf.read_flyer_file(str(files("lightflyer") / "data" / f"flyer-{kind}.toml")).build()
        for kind in ("plate", "hollow")
    )
    require_comparable([plate, hollow])  # of which both have a pressure_difference
    mine, theirs = (outputs_of(setup)["pressure_difference"] for setup in (plate, hollow))
    assert mine.long_name != theirs.long_name
    both = join_outputs(mine, theirs)
    assert both.long_name == f"{mine.long_name}; or {theirs.long_name}"
    assert join_outputs(both, mine) is join_outputs(both, theirs) is both
    with pytest.raises(lf.ConfigurationError, match=r"\[Pa\] of one flyer .* \[m\] of another"):
        join_outputs(mine, dataclasses.replace(theirs, unit="m"))
