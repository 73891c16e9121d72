"""sweep, map, optimise and sensitivity as a user runs them."""

import contextlib
import json
import socket
import threading
import time

import pytest
import xarray as xr

import lightflyer as lf

STUDY = """\
flyer = "flyer.toml"

[sweep]
"flyer.diameter" = { from = "0.5 cm", to = "5 cm", points = 20, scale = "log" }
"film.emittance" = [0.06, 0.08]
altitude = { from = "60 km", to = "90 km", points = 31 }

[outputs]
variables = ["temperature", "lift", "relative_payload", "levitation_irradiance"]

[optimise]
maximise = "payload"
beyond_range = true
starts = 2
[optimise.over]
"flyer.diameter" = { from = "0.5 cm", to = "5 cm", scale = "log" }
altitude = { from = "60 km", to = "90 km" }
[optimise.constraints]
temperature = { at_most = "330 K" }

[sensitivity]
outputs = "payload"
points = 256
[sensitivity.at]
altitude = "72 km"
[sensitivity.inputs]
"film.tac_top" = "0.80 ± 0.01"
"film.absorptance" = "0.75 ± 0.05"
"""


@pytest.fixture
def study(flyer_file, write):
    flyer_file()
    return lambda old="", new="": write(STUDY, "study.toml", (old, new))


def test_a_sweep_its_repetition_and_its_maps(run, prints, refuses, study, tmp_path):
    path, out, maps = study(), tmp_path / "results.zarr", tmp_path / "maps"
    text = prints("sweep", path, "--out", out, "--chunk", 300)
    assert "1,240 designs, 1,240 computed" in text
    assert "largest relative_payload" in text
    with xr.open_zarr(out, chunks=None) as dataset:
        assert dataset.attrs["study"] == path.read_text()
        assert dataset.attrs["configuration"].startswith("[flyer]")
        assert dataset.relative_payload.shape == (20, 2, 31)
    summary = json.loads(prints("sweep", path, "--out", out, "--json"))
    assert (summary["found"], summary["computed"]) == (1240, 0)
    ask = ("map", out, "--x", "diameter", "--value", "relative_payload", "--out", maps)
    text = prints(*ask, "--y", "altitude", "--pareto")
    assert "at film.emittance 0.06" in text
    drawn = lf.parametric.open_sweep(out).relative_payload.sel({"film.emittance": 0.06}).to_series()
    (diameter, altitude), most = drawn.idxmax(), drawn.max()
    first, *lines = text.splitlines()
    assert first == (
        f"largest relative_payload: {most:.4g} at flyer.diameter {diameter * 100:.6g} cm, "
        f"altitude {altitude / 1e3:.6g} km"
    )
    of_each = drawn.groupby("flyer.diameter").max()
    rows = [line.split() for line in lines if line[:1] == " "]
    told = {float(row[0]): row[2] for row in rows}
    assert len(told) == 12
    for size, shown in told.items():
        at = of_each.index[abs(of_each.index * 100 - size).argmin()]
        assert float(shown) == pytest.approx(of_each[at], rel=1e-3)
    assert sorted(file.name for file in maps.iterdir()) == [
        f"relative_payload-{name}.{suffix}"
        for name in ("map", "pareto")
        for suffix in ("png", "svg")
    ]
    drawing = (maps / "relative_payload-map.svg").read_text()
    for words in ("cannot fly", "flyer diameter [cm]", "altitude [km]", "most at each"):
        assert words in drawing
    assert "smallest irradiance" in (maps / "relative_payload-pareto.svg").read_text()
    assert "at altitude 71 km" in run(*ask, "--at", "altitude = 71.2 km, emittance = 0.08")[1]
    heavy = ("map", out, "--x", "altitude", "--value", "relative_payload", "--out", maps)
    text = run(*heavy, "--at", "diameter = 5 cm, emittance = 0.08")[1]
    assert "\n           60 " in text
    assert text.partition("\n           60 ")[2].split()[0] == "–"
    for wrong, message in (
        (("--y", "altitud"), 'did you mean "altitude"'),
        (("--y", "diameter"), "--x and --y are both flyer.diameter"),
        (("--at", "altitude 71 km"), 'as in "altitude = 70 km"'),
    ):
        assert message in refuses(*ask, *wrong)


def test_a_band_of_samples_is_drawn(run, study, tmp_path):
    path = study('"film.emittance" = [0.06, 0.08]', '"film.emittance" = "0.08 ± 0.02"')
    path.write_text(path.read_text() + "\n[sampling]\npoints = 16\n")
    out, maps = tmp_path / "results.zarr", tmp_path / "maps"
    run("sweep", path, "--out", out)
    ask = ("map", out, "--x", "altitude", "--value", "relative_payload", "--out", maps)
    assert run(*ask, "--at", "diameter = 2 cm")[0] == 0
    assert "95 % band" in (maps / "relative_payload-map.svg").read_text()
    assert run(*ask, "--y", "diameter")[0] == 0
    assert "in less than half of the samples" in (maps / "relative_payload-map.svg").read_text()


def test_a_huge_study_says_how_large_and_how_long(refuses, study, tmp_path):
    path = study("points = 20", "points = 10000000")
    path.write_text(path.read_text().replace("points = 31", "points = 100000"))
    errors = refuses("sweep", path, "--out", tmp_path / "results.zarr")
    assert "the study has 2 trillion designs: about" in errors
    assert "64 TB on the disk" in errors
    assert "start it with --yes" in errors
    assert not (tmp_path / "results.zarr").exists()


def test_a_folder_with_something_else_is_left_alone(refuses, study, tmp_path):
    path = study()
    assert "already exists and is not a sweep" in refuses("sweep", path, "--out", tmp_path)
    assert sorted(file.name for file in tmp_path.iterdir()) == ["flyer.toml", "study.toml"]
    assert "is not a sweep" in refuses("map", tmp_path, "--x", "altitude", "--value", "lift")


@pytest.mark.parametrize("answer", [None, b"", b"HTTP/1.1 400 Bad request\r\n\r\n"])
def test_what_is_no_scheduler_is_not_waited_for(refuses, study, tmp_path, monkeypatch, answer):
    """Nothing listens, or something else."""
    monkeypatch.setattr("lightflyer.compute.scheduler.ANSWER_WITHIN", 1.0)
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve():
            with contextlib.suppress(OSError):
                while answer:
                    caller, _ = server.accept()
                    caller.sendall(answer)

        threading.Thread(target=serve, daemon=True).start()
        address = f"tcp://127.0.0.1:{9 if answer is None else server.getsockname()[1]}"
        out, start = tmp_path / "r.zarr", time.perf_counter()
        errors = refuses("sweep", study(), "--out", out, "--scheduler", address)
    assert errors.startswith(f"lightflyer: error: --scheduler {address}: no answer within 1 s")
    assert time.perf_counter() - start < 10.0
    assert not out.exists()


def test_the_best_design_is_written_as_a_flyer_file(run, prints, study, tmp_path):
    best = tmp_path / "best.toml"
    text = prints("optimise", study(), "--write", best)
    assert f"next: lightflyer predict {best}" in text
    assert "mg" in text
    assert " kg" not in text
    found = json.loads(run("optimise", study(), "--json", "--write", best)[1])
    assert run("predict", best, "--json", "--samples", 0)[0] == 0
    there = lf.read_flyer_file(best).flyer
    assert there.diameter.value == pytest.approx(found["design"]["flyer.diameter"], rel=1e-11)
    written = best.read_text(encoding="utf-8")
    assert ' cm"' in written  # the unit that it had
    assert "# " in written  # comments are kept
    assert written.count("optimised: lightflyer optimise") == len(found["design"]) - 1


@pytest.mark.parametrize("name", ["flyer.toml", "folder"])
def test_what_people_wrote_is_not_overwritten(name, refuses, study, tmp_path):
    path = study()
    (tmp_path / "folder").mkdir()
    errors = refuses("optimise", path, "--write", tmp_path / name)
    assert errors == (
        f"lightflyer: error: {tmp_path / name}: already exists, and no search wrote it; choose "
        "another name\n"
    )


def test_optimise_prints_and_writes(run, prints, refuses, study, tmp_path):
    out = tmp_path / "out"
    text = prints("optimise", study(), "--out", out)
    assert "temperature 330 K (at most 330 K; active: 1 % looser is worth" in text
    assert "starts agree" in text
    assert "warning: the diameter [m] is 0.011 at" in text
    told = prints("optimise", study("beyond_range = true", "beyond_range = false"))
    assert "warning: the diameter [m] is 0.011 at" in told
    written = json.loads((out / "optimum.json").read_text())
    assert written["objective"] == {"maximise": "payload"}
    path = study('maximise = "payload"', 'maximise = "payload"\nminimise = "levitation_irradiance"')
    code, text, errors = run("optimise", path, "--out", out)
    assert code == 0
    assert "not of this run, but there before: " in errors
    assert "elasticities.svg" in errors
    assert "designs on the front" in text
    assert (out / "front.png").exists()
    for wrong in ("3", '["payload", 3]'):
        path = study('maximise = "payload"', f"maximise = {wrong}")
        errors = refuses("optimise", path)
        assert 'is not the name of an output, such as "payload"' in errors
        assert "study.toml:" in errors
    errors = refuses("optimise", study("[optimise.over]", "[optimise.ober]"))
    assert 'did you mean "over"?' in errors


def test_sensitivity_prints_and_writes(prints, refuses, study, tmp_path):
    out = tmp_path / "out"
    assert "measure film.tac_top next" in prints("sensitivity", study(), "--out", out)
    assert "film absorptance" in (out / "payload-tornado.svg").read_text()
    found = json.loads((out / "sensitivity.json").read_text())["payload"]
    assert found["measure_next"] == "film.tac_top"
    assert "study.toml:" in refuses("sensitivity", study("[sensitivity.at]", "[sensitivity.where]"))
