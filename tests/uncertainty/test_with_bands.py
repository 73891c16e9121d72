"""A prediction in Python has the bands that the command prints."""

import json
import re

import numpy as np
import pytest
import xarray as xr

import lightflyer as lf
from lightflyer import cli
from lightflyer.config.designs import as_design
from lightflyer.force.kinetic.model import KineticSection
from lightflyer.force.lu2023 import Lu2023ForceSection
from lightflyer.force.membranes.schafer2025 import Schafer2025

TEXT = """\
[flyer]
diameter = "2 cm"
[film]
areal_density = "1.0 g/m^2"
absorptance = 0.75
emittance = 0.08
tac_top = 0.8
tac_bottom = 0.9
highest_temperature = "520 K"
[environment]
albedo = 0.29
[force]
model = "lu2023"
"""


@pytest.fixture
def path(write):
    return write(TEXT, "flyer.toml")


def test_print_shows_what_the_command_prints(path, capsys):
    with pytest.raises(SystemExit, match="0"):
        cli.main(["predict", str(path), "--samples", "100"])
    told = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    found = lf.predict(path, samples=100)
    printed = str(found).splitlines()
    assert "(" in printed[1]
    assert told[: len(printed)] == printed
    assert repr(found) == str(found)


def test_objects_have_the_bands_of_a_file(path):
    """The force model's own errors count, as in a file, and move no nominal value."""
    setup = lf.read_flyer_file(path).build()
    assert setup.model.force_error == 0.0
    model = lf.Lu2023()
    of_file = lf.predict(path, samples=100)
    found = lf.predict(setup.flyer, setup.environment, model, samples=100)
    assert found.setup.model is model
    assert found.bands == of_file.bands
    assert found.uncertainty.bands == of_file.uncertainty.bands
    assert found.summary()["uncertainty"] == json.loads(
        json.dumps(of_file.summary()["uncertainty"])
    )
    assert "payload_low" in found.dataset
    assert np.all(found.dataset.payload_low <= found.dataset.payload_high)


def test_without_samples_there_are_no_bands(path):
    found = lf.predict(path, samples=0)
    assert found.uncertainty is None
    assert "uncertainty" not in found.summary()
    assert "samples" not in str(found)
    assert "payload_low" not in found.dataset
    with pytest.raises(lf.ParameterError, match="at least 100"):
        lf.predict(path, samples=50)


def test_a_stated_error_is_not_counted_twice(path):
    setup = lf.read_flyer_file(path).build()
    quiet = lf.predict(setup.flyer, setup.environment, lf.Lu2023(force_error=0.0))
    assert quiet.uncertainty is None
    wide = lf.design.ObjectDesign(setup, {"force.force_error": 2.0})
    assert lf.predict(wide, samples=100).uncertainty.inputs.spreads == [2.0]


@pytest.mark.parametrize(
    ("section", "content"),
    [
        (KineticSection, {}),
        (KineticSection, {"wall": "maxwell"}),
        (KineticSection, {"wall": "accommodated"}),
        (KineticSection, {"wall": "cercignani-lampis", "tangential_accommodation": 0.9}),
        (Lu2023ForceSection, {}),
        (Lu2023ForceSection, {"c_fm": 0.5, "c_cont": 3.1}),
    ],
)
def test_open_errors_are_those_that_a_file_counts(section, content):
    made = section(**content)
    counted = {name for name, _, value in made.numbers() if value and value.uncertainty}
    assert {*section.model_type(**content).open_errors} == counted


def test_every_model_has_its_own_open_errors():
    assert Schafer2025().open_errors == ("force_error",)
    assert Schafer2025(force_error=0.0).open_errors == ()


@pytest.mark.parametrize("kind", ["laden", "chamber"])
def test_the_written_file_is_the_dataset(kind, tmp_path):
    """The command writes without xarray what xarray reads as the dataset of Python."""
    flyer, out = tmp_path / "flyer.toml", tmp_path / "out"
    less = ["--samples", "100", "--format", "svg"]
    for words in (["init", str(flyer), "--kind", kind],
                  ["predict", str(flyer), "--out", str(out), *less]):  # fmt: skip
        with pytest.raises(SystemExit, match="0"):
            cli.main(words)
    with xr.open_dataset(out / "prediction.nc") as written:
        expected = lf.predict(flyer, samples=100).dataset
        assert {*written.attrs} == {*expected.attrs, "uncertainties", "summary"}
        xr.testing.assert_equal(written.load(), expected)
        for name in (*expected.variables, *written.variables):
            assert written[name].attrs == expected[name].attrs
            assert written[name].dims == expected[name].dims


@pytest.mark.slow
def test_results_at_a_jump_have_no_band_to_first_order(tmp_path):
    """At 82 km no light lifts this sphere any more; samples there are not solved."""
    path = tmp_path / "flyer.toml"
    with pytest.raises(SystemExit, match="0"):
        cli.main(["init", str(path), "--kind", "hollow"])
    text = path.read_text(encoding="utf-8")
    for key, size in (("size", "30 cm"), ("outlet_diameter", "24 cm")):
        text = re.sub(rf'(?m)^{key} = "[^"]*"', f'{key} = "{size}"', text)
    path.write_text(text, encoding="utf-8")
    design = as_design(path).with_open_errors()
    found = lf.propagate(design, samples=100)
    assert "lift_over_weight" in json.dumps(found.summary(), allow_nan=False)


def test_bands_to_first_order_end_with_the_range_of_the_force_model(film):
    """At 61 km, where the kinetic tables end, that of the irradiance was eight times as wide."""
    disk, over = lf.Disk(film, radius=0.01), np.linspace(58e3, 66e3, 33)
    design = as_design(disk, lf.Earth(), lf.Kinetic()).with_open_errors()
    found = lf.propagate(design, samples=0, over=over)
    evaluated = lf.predict(disk, lf.Earth(), lf.Kinetic(), at=over)
    covered = evaluated.at["covered"] > 0.0
    assert 5 < covered.sum() < 30
    for name in ("levitation_irradiance", "levitation_temperature"):
        np.testing.assert_array_equal(np.isfinite(found.low[name]), covered)
        width = (found.high[name] - found.low[name])[covered]
        assert np.abs(np.diff(np.log(width))).max() < 0.7
    assert np.isfinite(found.low["payload"]).all()
    assert found.plot()
