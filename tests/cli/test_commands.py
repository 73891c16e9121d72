"""The commands as a user runs them, in a process of their own where that matters."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

import lightflyer

PNG, SVG = b"\x89PNG\r\n", b"<?xml"


def test_predict_prints_a_table_and_writes_whole_files(prints, flyer_file, tmp_path):
    out = tmp_path / "out"
    path = flyer_file("tac_bottom = 0.9", 'tac_bottom = "0.90 ± 0.03"')
    text = prints("predict", path, "--out", out, "--csv", "--verbose", "--samples", "0")
    assert "68.022 km to 78.047 km" in text
    assert sorted(path.name for path in out.iterdir()) == [
        "levitation-irradiance.png",
        "levitation-irradiance.svg",
        "payload.png",
        "payload.svg",
        "prediction.csv",
        "prediction.json",
        "prediction.nc",
    ]
    for figure in out.glob("*.png"):
        assert figure.read_bytes().startswith(PNG)
    for figure in out.glob("*.svg"):
        assert figure.read_bytes().startswith(SVG)
        assert "altitude [km]" in figure.read_text()
    for file in out.iterdir():
        assert str(file.name) in text.replace("\n", "")
    header = (out / "prediction.csv").read_text().splitlines()[0].split(",")
    assert header[:2] == ["altitude [m]", "pressure [Pa]"]
    values = np.loadtxt(out / "prediction.csv", delimiter=",", skiprows=1)
    assert values.shape == (301, len(header))
    with xr.open_dataset(out / "prediction.nc", engine="h5netcdf") as dataset:
        for name in (*dataset.data_vars, *dataset.coords):
            assert dataset[name].attrs["units"], name
            assert dataset[name].attrs["long_name"], name
        assert dataset.attrs["configuration"] == path.read_text()
        assert dataset.attrs["lightflyer_version"] == lightflyer.__version__
        assert json.loads(dataset.attrs["uncertainties"])["film.tac_bottom"] == pytest.approx(0.03)
        near = dataset.sel(altitude=72e3, method="nearest")
        assert float(near["lift_over_weight"]) == pytest.approx(1.59, rel=0.02)
    with h5py.File(out / "prediction.nc") as file:
        assert "altitude" in file


def test_files_are_the_same_every_time(run, flyer_file, tmp_path):
    path = flyer_file()
    for name in ("one", "two"):
        run("predict", path, "--out", tmp_path / name)
    for first in (tmp_path / "one").iterdir():
        second = tmp_path / "two" / first.name
        if first.suffix == ".nc":
            with xr.open_dataset(first) as a, xr.open_dataset(second) as b:
                xr.testing.assert_identical(a, b)
        else:
            assert first.read_bytes() == second.read_bytes(), first.name


def test_json_names_and_values(prints, flyer_file):
    result = json.loads(prints("predict", flyer_file(), "--json", "--at", "68 km,72 km, 78000 m"))
    assert result["altitude_band_km"] == pytest.approx([68.022, 78.047], abs=1e-3)
    assert result["altitude_bands_km"] == [result["altitude_band_km"]]
    assert result["pressure_band_pa"] == pytest.approx([6.388, 1.280], abs=2e-3)
    assert set(result["minimum_irradiance"]) == {"value_w_m2", "altitude_km", "temperature_k"}
    assert set(result["best"]) >= {
        "altitude_km",
        "payload_mg",
        "relative_payload",
        "temperature_k",
    }
    assert [point["altitude_km"] for point in result["at"]] == [68.0, 72.0, 78.0]
    assert [point["levitation_irradiance_w_m2"] for point in result["at"]] == pytest.approx(
        [1365.098, 811.018, 1341.540], rel=1e-5
    )
    assert set(result["at"][0]) == {
        "altitude_km",
        "pressure_pa",
        "gas_temperature_k",
        "levitation_irradiance_w_m2",
        "levitation_temperature_k",
        "temperature_k",
        "lift_n",
        "lift_over_weight",
    }


def test_a_flyer_that_never_levitates_is_an_answer(prints, flyer_file, tmp_path):
    heavy, out = flyer_file('"1.0 g/m^2"', '"100 g/m^2"'), tmp_path / "out"
    asked = ("predict", heavy, "--verbose", "--out", out, "--format", "png")
    assert "no irradiance lifts it" in prints(*asked)
    assert len(list(out.glob("*.png"))) == 2
    result = json.loads((out / "prediction.json").read_text())
    assert result["altitude_band_km"] is None
    assert result["pressure_band_pa"] is None
    assert result["minimum_irradiance"] is None
    assert result["best"]["payload_mg"] < 0.0


def test_chamber(run, prints, tmp_path):
    path = tmp_path / "chamber.toml"
    assert run("init", path, "--kind", "chamber")[0] == 0
    text = prints("predict", path, "--out", tmp_path / "out", "--at", "3 Pa,30 mTorr")
    assert "least irradiance" in text
    result = json.loads((tmp_path / "out" / "prediction.json").read_text())
    assert result["at"][1]["pressure_pa"] == pytest.approx(3.99967, rel=1e-5)
    # no pressure needs less light than the optimum
    with xr.open_dataset(tmp_path / "out" / "prediction.nc") as dataset:
        least = float(dataset["levitation_irradiance"].min())
        assert result["optimum"]["irradiance_w_m2"] == pytest.approx(least, rel=1e-3)
        assert result["optimum"]["irradiance_w_m2"] <= least
        assert dataset["map_temperature"].dims == ("map_pressure", "map_irradiance")
        dark = dataset["map_temperature"].isel(map_irradiance=0)
        np.testing.assert_allclose(dark, 293.0)


def test_init_writes_what_predict_reads(run, refuses, tmp_path):
    path = tmp_path / "flyer.toml"
    assert run("init", path)[0] == 0
    assert "--force" in refuses("init", path)
    assert run("init", path, "--force")[0] == 0
    assert lightflyer.read_flyer_file(path).flyer.shape == "disk"


def test_init_writes_another_force_model(run, refuses, tmp_path):
    path = tmp_path / "flyer.toml"
    assert run("init", path, "--model", "lu2023")[0] == 0
    assert isinstance(lightflyer.read_flyer_file(path).build().model, lightflyer.Lu2023)
    assert 'model = "lu2023"                 # or "kinetic", ' in path.read_text("utf-8")
    for words, says in (
        (("--model", "lu2022"), '--model "lu2022" is not for --kind "earth"; choose from'),
        (("--kind", "sweep", "--model", "lu2023"), '--kind "sweep" is not a flyer file'),
        (("--kind", "mars", "--model", "kinetic"), "Kinetic is not for co2"),
    ):
        assert says in refuses("init", tmp_path / "other.toml", *words)
    assert not (tmp_path / "other.toml").exists()


def test_tac_above_one_warns_in_one_line(run, flyer_file):
    code, text, errors = run("predict", flyer_file("tac_bottom = 0.9", "tac_bottom = 1.08"))
    assert code == 0
    assert errors.count("\n") == 1
    assert errors.startswith("lightflyer: warning: tac_bottom = 1.08 exceeds 1")
    assert "It flies from " in text


def test_a_folder_that_cannot_be_written_is_one_line(refuses, flyer_file, tmp_path):
    (tmp_path / "file").write_text("in the way")
    assert "cannot be written" in refuses("predict", flyer_file(), "--out", tmp_path / "file")


def test_a_failure_half_way_leaves_nothing(refuses, flyer_file, tmp_path, monkeypatch):
    def full_disk(*_, **__):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("lightflyer.files.drawing.save", full_disk)
    assert "No space left" in refuses("predict", flyer_file(), "--out", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_an_interrupt_leaves_no_partial_file(flyer_file, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    command = [sys.executable, "-m", "lightflyer", "predict", str(flyer_file()), "--out", str(out)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    # interrupt while files are being staged
    deadline = time.monotonic() + 60.0
    while not any(out.iterdir()) and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60.0)
    names = {path.name for path in out.iterdir()}
    assert process.returncode in (130, 0)
    if process.returncode == 130:
        assert names == set()
        assert errors == b"lightflyer: interrupted; the same command begins anew\n"
    else:  # it was faster than the signal
        assert len(names) == 6


LONG = {
    "optimise": """
[optimise]
maximise = "payload"
starts = 200
[optimise.over]
"flyer.diameter" = { from = "0.5 cm", to = "10 cm" }
"film.areal_density" = { from = "0.5 g/m^2", to = "2 g/m^2" }
altitude = { from = "60 km", to = "90 km" }
""",
    "sweep": """
[sweep]
"flyer.diameter" = { from = "0.5 cm", to = "5 cm", points = 1000 }
"film.areal_density" = { from = "0.5 g/m^2", to = "2 g/m^2", points = 1000 }
altitude = { from = "60 km", to = "80 km", points = 1000 }
[outputs]
variables = ["payload", "levitation_irradiance"]
""",
}
WHAT_NEXT = {
    "optimise": "the same command begins anew",
    "sweep": "what was computed is kept; the same command goes on from there",
}


def wait_until_interrupts_are_answered(process):
    """Python itself may take long to start, and fails in its own way if it is interrupted then."""
    status, interrupt = Path(f"/proc/{process.pid}/status"), 1 << (signal.SIGINT - 1)
    if not status.exists():
        time.sleep(0.5)
        return
    deadline = time.monotonic() + 60.0
    while process.poll() is None and time.monotonic() < deadline:
        (blocked,) = re.findall(r"SigBlk:\s*(\w+)", status.read_text())
        if int(blocked, 16) & interrupt:
            return
        time.sleep(0.01)


@pytest.mark.parametrize(
    ("command", "delay"), [("optimise", 0.0), ("optimise", 2.0), ("sweep", 0.4), ("sweep", 1.6)]
)
def test_an_interrupt_is_one_line_at_any_moment(flyer_file, tmp_path, command, delay):
    study = tmp_path / "study.toml"
    study.write_text(f'flyer = "{flyer_file()}"\n{LONG[command]}', encoding="utf-8")
    arguments = [str(study), *(["--out", str(tmp_path / "out.zarr")] if command == "sweep" else [])]
    process = subprocess.Popen(
        [sys.executable, "-m", "lightflyer", command, *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    wait_until_interrupts_are_answered(process)
    time.sleep(delay)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60.0)
    assert process.returncode == 130, errors
    assert errors.endswith(f"lightflyer: interrupted; {WHAT_NEXT[command]}\n".encode())


INTERRUPTS = """
import os, signal, sys

os.kill(os.getpid(), signal.SIGINT)  # while the package is imported, before any of its commands
sys.path.remove(os.path.dirname(__file__))
del sys.modules["lazy_loader"]
import lazy_loader

globals().update(vars(lazy_loader))
"""


@pytest.mark.skipif(not hasattr(signal, "pthread_sigmask"), reason="signals cannot wait there")
def test_an_interrupt_of_the_import_is_one_line(tmp_path):
    (tmp_path / "lazy_loader.py").write_text(INTERRUPTS, encoding="utf-8")
    path = os.pathsep.join([str(tmp_path), *filter(None, [os.environ.get("PYTHONPATH")])])
    command = [sys.executable, "-m", "lightflyer", "predict", "flyer.toml"]
    found = subprocess.run(command, env=os.environ | {"PYTHONPATH": path}, capture_output=True)
    assert found.returncode == 130
    assert found.stderr == b"lightflyer: interrupted; the same command begins anew\n"
    # a job in the background ignores interrupts, unless told otherwise
    listen = "import signal; signal.signal(signal.SIGINT, signal.default_int_handler)"
    library = [sys.executable, "-c", f"{listen}; import lightflyer"]
    found = subprocess.run(library, env=os.environ | {"PYTHONPATH": path}, capture_output=True)
    assert b"KeyboardInterrupt" in found.stderr


@pytest.mark.parametrize("words", ["lab tac no.csv", "compare no.toml a.toml"])
def test_a_missing_file_is_said_before_anything_is_loaded(words):
    check = (
        "import sys; from lightflyer.cli import main\n"
        f"try: main({words.split()})\n"
        "finally: assert not {'jax', 'numpy', 'pint'} & set(sys.modules)"
    )
    found = subprocess.run([sys.executable, "-c", check], capture_output=True, text=True)
    assert found.returncode == 2, found.stderr
    name = next(word for word in words.split() if "." in word)
    assert found.stderr == f"lightflyer: error: {name}: cannot be read: {os.strerror(2)}\n"


def printed_without_importing(heavy, code):
    """What a program prints that must not import some packages."""
    check = f"import sys\nfound = {heavy} & set(sys.modules)\nassert not found, found"
    result = subprocess.run(
        [sys.executable, "-c", f"{code}\n{check}"], capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stderr
    return result.stdout


def test_help_imports_nothing_heavy():
    heavy = {"jax", "numpy", "xarray", "matplotlib", "pint", "pydantic"}
    code = (
        "from lightflyer.cli import app\nfor asked in ('--help', 'lab tac --help'):\n"
        "    app(asked, exit_on_error=False, result_action='return_value')"
    )
    shown = printed_without_importing(heavy, code)
    assert "predict" in shown
    assert "--gauge-factor" in shown


def test_reading_a_flyer_file_imports_nothing_to_draw_with():
    heavy = {"matplotlib", "xarray", "jax"}
    # some releases of dask import xarray
    code = "import sys\nsys.modules['dask'] = None\nimport lightflyer.config.reader"
    printed_without_importing(heavy, code)


def test_commands_hide_dask_until_an_extra_may_need_it():
    """It takes long to load, and xarray loads it for nothing."""
    code = (
        "import sys\nsys.argv = ['lightflyer', '--version']\n"
        "from lightflyer.__main__ import main\ntry:\n    main()\nexcept SystemExit:\n    pass\n"
        "import lightflyer.core.quantity, xarray\nassert sys.modules['dask'] is None\n"
        "from lightflyer.core.extras import extra\nextra('json', 'a test', 'all')"
    )
    printed_without_importing({"dask"}, code)


def test_runs_as_a_module_with_a_closed_pipe(flyer_file):
    command = f"{sys.executable} -m lightflyer predict {flyer_file()} | head -1"
    result = subprocess.run(
        ["bash", "-c", command], capture_output=True, text=True, check=False, env={**os.environ}
    )
    assert "Traceback" not in result.stderr
    assert "disk of 2 cm" in result.stdout


def test_what_to_do_next_stands_last(run, prints, flyer_file):
    path = flyer_file()
    for words in (["predict", path], ["drift", path, "--altitudes", "70 km to 71 km"], ["doctor"]):
        assert prints(*words).splitlines()[-1].startswith("next: "), words
    assert "next: " not in run("predict", path, "--json")[1]
