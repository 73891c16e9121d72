"""``lightflyer compare``: tables, files and what it refuses."""

import json

import pytest
import xarray as xr


@pytest.fixture
def files(run, tmp_path):
    first, second = tmp_path / "narrow.toml", tmp_path / "wide.toml"
    assert run("init", first, "--model", "lu2023")[0] == 0  # which compiles fastest
    text = first.read_text("utf-8").replace('diameter = "2 cm"', 'diameter = "4 cm"')
    assert "4 cm" in text
    second.write_text(text, encoding="utf-8")
    return first, second


def test_table_and_files(prints, files, tmp_path):
    with files[1].open("a", encoding="utf-8") as file:
        file.write("\n")
    text = files[1].read_text("utf-8")
    files[1].write_text(text.replace("tac_bottom = 0.9", 'tac_bottom = "0.90 ± 0.03"'), "utf-8")
    out = tmp_path / "out"
    lines = prints("compare", *files, "--out", out, "--samples", "100").splitlines()
    assert lines[0] == "A  narrow: disk of 2 cm, Lu2023"
    table = lines[: next(i for i, line in enumerate(lines) if line.startswith("warning"))]
    assert max(map(len, table)) <= 80
    marked = [line for line in table if line.startswith(("A*", "B*"))]
    assert len(marked) == 1
    (uncertain,) = [line for line in table[2:] if line.startswith(("B ", "B*"))]
    assert uncertain.count(" to ") == 2  # the band and where it levitates
    summary = json.loads((out / "comparison.json").read_text("utf-8"))
    best = max(summary["flyers"], key=lambda found: found["best"]["payload_mg"])
    assert summary["best"] == best["name"]
    assert marked[0].split()[1] == f"{best['best']['payload_mg']:.4g}"
    with xr.open_dataset(out / "comparison.nc") as dataset:
        assert {"payload", "payload_low", "payload_high", "temperature"} <= set(dataset)
        assert list(dataset.flyer.values) == ["narrow", "wide"]
    assert (out / "comparison.csv").is_file()
    assert {"comparison.png", "comparison.svg"} <= {path.name for path in out.iterdir()}


def test_json_within_a_range(prints, files):
    asked = ("compare", *files, "--samples", "0", "--altitudes")
    summary = json.loads(prints(*asked, "65 km to 85 km", "--json"))
    assert summary["altitude_range_km"] == pytest.approx([65.0, 85.0])
    assert summary["differing_surroundings"] == {}
    text = prints(*asked, "50 km to 55 km")  # what lies beyond the range is not denied
    assert text.count("not in range") == 2
    assert "nowhere" not in text


def test_one_file_given_twice_is_said(prints, files):
    text = prints("compare", files[0], files[0], *files[1:], "--samples", "0")
    assert text.count("are the same design") == 1
    assert "narrow and narrow (2) are the same design" in " ".join(text.split())


def test_a_mistake_names_its_file(refuses, files, tmp_path):
    broken = tmp_path / "broken.toml"
    broken.write_text(files[0].read_text("utf-8").replace("2 cm", "-2 cm"), "utf-8")
    assert "broken.toml:7: flyer.diameter" in refuses("compare", files[0], broken)
