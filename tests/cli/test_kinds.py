"""Every kind of flyer through the commands that a flyer file goes through."""

import json

import numpy as np
import pytest
import xarray as xr

import lightflyer as lf
from lightflyer.cli.commands.init import templates

EXACT = {  # derivatives take long to compile
    "balloon": "convection_error = 0.0\n",
    "plate": "force_error = 0.0\nheat_error = 0.0\n",
}
# kind, what is swept, the template's own design among it, an output, and what is never negative
SWEPT = {
    "balloon": (
        {"flyer.diameter": ["4 m", "5.8 m", "8 m"], "altitude": ["15 km", "18 km"]},
        {"flyer.diameter": 5.8, "altitude": 18e3},
        ("film_tension", "N/m"),
        lambda found: found.relative_payload.diff("flyer.diameter"),
    ),
    "particle": (
        {"flyer.diameter": ["1 um", "2 um", "4 um"], "altitude": ["50 km", "70 km"]},
        {"flyer.diameter": 2e-6, "altitude": 70e3},
        ("side_difference", "K"),
        lambda found: found.side_difference,
    ),
    "plate": (
        {"flyer.height": ["30 um", "50 um", "100 um"], "pressure": ["10 Pa", "100 Pa"]},
        {"flyer.height": 50e-6, "pressure": 100.0},
        ("flow_velocity", "m s-1"),
        lambda found: found.flow_velocity,
    ),
    "sandwich": (
        {"flyer.gap": ["50 um", "125 um", "300 um"], "altitude": ["70 km", "75 km"]},
        {"flyer.gap": 125e-6, "altitude": 75e3},
        ("temperature_bottom", "K"),
        lambda found: found.temperature_bottom - found.temperature_top,
    ),
    "hollow": (
        {"flyer.channel_width": ["0.4 mm", "0.8 mm"], "altitude": ["75 km"]},
        {"flyer.channel_width": 8e-4, "altitude": 75e3},
        ("jet_velocity", "m s-1"),
        lambda found: found.temperature_inner - found.temperature_outer,
    ),
}
EACH = {
    "balloon": ["relative_payload"],
    "sandwich": ["temperature_top", "temperature_bottom"],
    "hollow": ["temperature_inner", "temperature_outer"],
}


@pytest.fixture
def file_of(write):
    """A template's file, some of its texts replaced."""

    def make(kind, *changes):
        return write(templates()[kind].read() + EXACT.get(kind, ""), "flyer.toml", *changes)

    return make


def lift_over_weight(setup, state):
    return lf.lift(setup.flyer, state, setup.model) / lf.statics.weight(setup.flyer, state)


@pytest.mark.parametrize("kind", SWEPT)
def test_a_sweep_gives_what_one_design_gives(prints, file_of, tmp_path, kind):
    swept, own, (output, unit), positive = SWEPT[kind]
    setup = lf.read_flyer_file(file_of(kind)).build()
    outputs = ["lift_over_weight", output, *EACH.get(kind, ())]
    study, out = tmp_path / "study.toml", tmp_path / "results.zarr"
    lines = [f'"{name}" = {json.dumps(values)}' for name, values in swept.items()]
    study.write_text(
        "\n".join(['flyer = "flyer.toml"', "[sweep]", *lines])
        + f"\n[outputs]\nvariables = {json.dumps([*dict.fromkeys(outputs)])}\n",
        encoding="utf-8",
    )
    prints("sweep", study, "--out", out)
    found = lf.parametric.open_sweep(out)
    here = found.lift_over_weight.sel(own, method="nearest")
    expected = lift_over_weight(setup, setup.environment.state([*own.values()][-1]))
    assert float(here) == pytest.approx(expected, rel=1e-9)
    assert found[output].attrs["units"] == unit
    assert bool((positive(found) > 0.0).all())


def predicted(prints, path, out, *options):
    """What is printed, the dictionary and the data set of a prediction."""
    text = prints("predict", path, "--out", out, "--format", "svg", *options)
    assert {"levitation-irradiance.svg", "payload.svg"} <= {one.name for one in out.iterdir()}
    with xr.open_dataset(out / "prediction.nc") as dataset:
        return text, json.loads((out / "prediction.json").read_text()), dataset.load()


# kind, where, first words, what else is said, and units of curves
PREDICTED = [
    ("balloon", 18e3, "open balloon of 5.8 m", "", {"film_tension": "N/m", "buoyancy": "N"}),
    ("particle", 70e3, "sphere of 2 µm, 5.027 pg, in 1361 W/m²", "its limit is not stated.",
     {"climb_speed": "m s-1"}),
    ("plate", 100.0, "plate of 8 mm, 0.01851 mg", "flow velocity",
     {"flow_velocity": "m s-1", "pressure_difference": "Pa", "temperature_top": "K"}),
    ("sandwich", 75e3, "sandwich of 2 cm, 0.117 mg", "warning: gap over the mean free path is",
     {"temperature_top": "K"}),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "place", "first", "said", "units"), PREDICTED)
def test_a_prediction_is_what_python_gives(
    prints, file_of, tmp_path, kind, place, first, said, units
):
    path, out = file_of(kind), tmp_path / "out"
    at = f"{place} Pa" if kind == "plate" else f"{place} m"
    text, summary, dataset = predicted(prints, path, out, "--at", at, "--samples", "0")
    assert text.startswith(first)
    assert said in " ".join(text.split())
    assert {name: dataset[name].units for name in units} == units
    setup = lf.read_flyer_file(path).build()
    state = setup.environment.state(place)
    found, ratio = lf.equilibrium(setup.flyer, state, setup.model), lift_over_weight(setup, state)
    (there,) = summary["at"]
    assert there["temperature_k"] == pytest.approx(found.temperature, rel=1e-9, abs=0.0)
    assert there["lift_over_weight"] == pytest.approx(ratio, rel=1e-9)
    if kind in ("plate", "sandwich"):
        assert there["temperature_k"] == there["temperature_bottom_k"] > there["temperature_top_k"]
    if kind == "balloon":
        assert summary["altitude_band_km"] == pytest.approx((1.0, 19.5), abs=0.3)
        assert there["filled_share"] == 1.0
        np.testing.assert_allclose(dataset.lift, dataset.buoyancy, rtol=1e-12)  # all of it
    elif kind == "particle":
        speed = -lf.statics.sinking_speed(setup.flyer, state, setup.model)
        assert there["climb_speed_m_s"] == pytest.approx(speed, rel=1e-6, abs=0.0)
        top, bottom = found.temperatures
        assert there["side_difference_k"] == pytest.approx(top - bottom, rel=1e-5, abs=0.0)
    else:
        low, high = (
            summary.get("pressure_band_pa")
            if kind == "plate"
            else (1e3 * edge for edge in summary["altitude_band_km"])
        )
        for edge, inwards in ((low, 1.001), (high, 0.999)):
            near = [lift_over_weight(setup, setup.environment.state(edge * share))
                    for share in (1.0 / inwards, inwards)]  # fmt: skip
            assert near[0] < 1.0 < near[1]
    if kind == "plate":
        assert low < 10.0 < 200.0 < high  # where such plates levitated
        assert there["stopping_pressure_mpa"] > there["pressure_difference_mpa"] > 0.0
        assert "highest_temperature" not in dataset.attrs["warnings"]  # the template states it
    if kind == "sandwich":
        assert "mean free path" in dataset.attrs["warnings"]


def test_a_limit_of_a_particle_is_not_called_a_films(prints, file_of):
    stated = '# highest_temperature = "900 K"', 'highest_temperature = "900 K"'
    text = prints("predict", file_of("particle", stated), "--samples", 0)
    assert "; it withstands 900 K and survives." in " ".join(text.split())
    assert "film" not in text.partition("next:")[0]


def test_a_balloon_too_heavy_to_fly_gets_no_advice_on_accommodation(prints, file_of):
    path = file_of("balloon", ('payload = "1.7 kg"', 'payload = "1.7 kg"\ngas_mass = "6 kg"'))
    text = prints("predict", path, "--samples", "0")
    assert "It does not fly" in text
    assert "tac_bottom" not in text


def test_helium_needs_no_light(prints, file_of, tmp_path):
    path = file_of("balloon", ('"1.7 kg"', '"1.7 ± 0.1 kg"\ngas = "helium"'))
    text, summary, _ = predicted(prints, path, tmp_path / "out", "--samples", "0", "--verbose")
    assert "least irradiance  0.0 W/m²" in text
    least = summary["uncertainty"]["results"]["minimum_irradiance.value_w_m2"]
    assert (least["first_order"]["low"], least["first_order"]["high"]) == (0.0, 0.0)


def test_warnings_are_of_where_it_flies(run, file_of):
    path = file_of("sandwich", ('"1361 W/m^2"', '"400 W/m^2"'), ('"125 um"', '"100 um"'))
    assert "warning: " not in run("predict", path, "--at", "75 km", "--samples", 0)[1]
    told = run("predict", path, "--at", "44 km", "--samples", 0)[1]
    assert "warning: the rarefaction parameter is" in told
    assert "at 169 Pa, above 100: the table" in told


def test_the_best_sandwich_is_better_than_its_template(prints, file_of, tmp_path):
    setup, study = lf.read_flyer_file(file_of("sandwich")).build(), tmp_path / "study.toml"
    study.write_text(
        'flyer = "flyer.toml"\n[optimise]\nmaximise = "payload"\nbeyond_range = true\n'
        'starts = 2\n[optimise.over]\naltitude = "75 km"\n'
        '"flyer.gap" = { from = "30 um", to = "2 mm", scale = "log" }\n'
        '"flyer.bottom.emittance_bottom" = { from = 0.05, to = 0.3 }\n',
        encoding="utf-8",
    )
    best = json.loads(prints("optimise", study, "--json"))
    here = lf.payload(setup.flyer, setup.environment.state(75e3), setup.model)
    assert best["outputs"]["payload"] > here
    assert best["design"]["flyer.bottom.emittance_bottom"] == pytest.approx(0.05)


def test_a_sandwich_is_sensitive_to_what_its_model_takes(prints, file_of, tmp_path):
    file_of("sandwich")
    study = tmp_path / "study.toml"
    study.write_text(
        'flyer = "flyer.toml"\n[sensitivity]\noutputs = "payload"\npoints = 64\n'
        '[sensitivity.at]\naltitude = "75 km"\n[sensitivity.inputs]\n'
        '"flyer.support_fraction" = "1.0e-4 ± 0.2e-4"\n"flyer.top.tac_top" = "0.80 ± 0.05"\n',
        encoding="utf-8",
    )
    inputs = json.loads(prints("sensitivity", study, "--json"))["payload"]["inputs"]
    assert inputs["flyer.top.tac_top"]["total"] == 0.0  # the model takes it for one
    assert inputs["flyer.support_fraction"]["total"] == pytest.approx(1.0, abs=0.15)


def test_a_mistake_in_a_hollow_body_is_one_line(refuses, file_of):
    path = file_of("hollow", ('"8 cm"', '"11 cm"'))
    errors = refuses("predict", path)
    assert errors.strip().splitlines() == [
        f"lightflyer: error: {path}:6: [flyer]: the outlet must be smaller than the sphere"
    ]


def test_a_study_names_the_flyer_that_it_needs(prints, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    needed = {
        "sweep": "",
        "optimise-film": " --kind layers",
        "optimise-structure": " --kind ligaments",
    }
    for kind, given in needed.items():
        text = prints("init", f"{kind}.toml", "--kind", kind)
        assert f"it needs a flyer file: lightflyer init flyer.toml{given}\n" in text
