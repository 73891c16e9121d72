"""`kinetic` as a user runs it."""

import json
import subprocess
import sys

import pytest

from lightflyer.files.result_text import unwrap
from lightflyer.kinetic_theory import solver
from lightflyer.kinetic_theory.chamber import cases as chamber_cases
from lightflyer.kinetic_theory.disk import cases
from lightflyer.kinetic_theory.disk.operators import Quadrature

pytestmark = pytest.mark.slow  # numba compiles the solver

CASE = ("kinetic", "--kn", "2", "--tac-top", "0.8", "--tac-bottom", "0.9")


def test_one_json_and_a_figure(prints, tmp_path):
    out = tmp_path / "out"
    found = json.loads(prints(*CASE, "--boundary", "4", "--json", "--out", out))
    assert set(found) == {
        "kn",
        "force_ratio",
        "heat_ratio_top",
        "heat_ratio_bottom",
        "heat_ratio",
        "error_estimate",
        "iterations",
        "seconds",
    }
    assert set(found["error_estimate"]) == {"force_ratio", "heat_ratio"}
    assert found["kn"] == 2.0
    assert 0.85 < found["force_ratio"] < found["heat_ratio"] < 1.0
    assert found["heat_ratio_bottom"] < found["heat_ratio"] < found["heat_ratio_top"]
    inputs = {
        "knudsen": 2.0,
        "tac_top": 0.8,
        "tac_bottom": 0.9,
        "top_temperature": 1.0,
        "bottom_temperature": 1.0,
        "open_fraction": 0.0,
        "gas": "monatomic",
        "wall": "maxwell",
        "collisions": "shakhov",
        "boundary": 4.0,
    }
    assert json.loads((out / "kinetic.json").read_text()) == found | {"inputs": inputs}
    assert (out / "flow.png").stat().st_size > 10_000
    assert (out / "flow.svg").read_text().startswith("<?xml")


def test_table_of_a_hot_disk(prints, monkeypatch):
    meshes = [cases.Resolution(order, 0.7, Quadrature(3, 3, 3)) for order in (3, 2)]
    monkeypatch.setattr(cases, "meshes", lambda knudsen, *, linear: meshes)
    ratios = ("--temperature-ratio", "2", "--top-temperature-ratio", "1.5")
    text = prints(*CASE, *ratios, "--open-fraction", "0.3", "--gas", "diatomic")
    heading = "TAC 0.8 top, 0.9 bottom, Maxwell walls, open fraction 0.3, diatomic, T_h/T_c 1.5"
    assert heading in " ".join(text.split())  # lines are 80 columns wide
    assert "force" in text
    assert "heat, bottom" in text


def test_a_folder_that_cannot_be_written_is_found_before_solving(refuses, tmp_path, monkeypatch):
    monkeypatch.setattr(solver, "_molecule", None)  # any solution would fail on it
    (tmp_path / "file").write_text("")
    assert "cannot be written" in refuses(*CASE, "--out", tmp_path / "file")


def test_without_numba_the_extra_is_named():
    program = (
        f"import sys; sys.modules['numba'] = None; from lightflyer import cli; cli.main({CASE})"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 2
    assert unwrap(done.stderr) == [
        "lightflyer: error: the kinetic solver needs numba: pip install 'lightflyer[kinetic]'"
    ]


def test_a_disk_in_a_chamber(prints, monkeypatch, tmp_path):
    meshes = [cases.Resolution(order, 0.7, Quadrature(3, 3, 3)) for order in (3, 2)]
    monkeypatch.setattr(chamber_cases, "meshes", lambda *, linear: meshes)
    place = ("--floor", "1", "--lid", "2", "--side", "2", "--reservoir", "lid")
    text = prints(*CASE, *place, "--local-balance", "--out", tmp_path / "out")
    assert "floor 1, lid 2 (reservoir), side 2 radii away" in text
    assert "in the centre" in text
    found = json.loads((tmp_path / "out" / "kinetic.json").read_text())
    assert set(found["forces"]) == {"disk", "floor", "lid", "side"}
    assert found["imbalance"] < 1e-6
    assert found["inputs"]["chamber"]["lid"]["solid"] is False
    assert (tmp_path / "out" / "flow.png").stat().st_size > 10_000
