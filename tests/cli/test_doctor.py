"""``lightflyer doctor``."""

import importlib.metadata
import json

import jax
import pytest

import lightflyer as lf
from lightflyer import cli
from lightflyer.cli.commands import doctor


def report(capsys):
    with pytest.raises(SystemExit, match="0"):
        cli.main(["doctor", "--json"])
    return json.loads(capsys.readouterr().out)


def test_doctor_says_what_is_installed(capsys):
    found = report(capsys)
    assert found["lightflyer"] == lf.__version__
    assert found["jax"] == jax.__version__
    assert len(found["devices"]) == jax.device_count()
    assert {"lab", "kinetic", "sweep"} <= set(found["extras"])
    assert "all" not in found["extras"]
    packages = {entry["package"] for entry in found["requirements"]}
    assert {"scipy", "numpy"} <= packages
    assert not {"numba", "jax"} & packages
    assert all(entry["problem"] is None for entry in found["requirements"])


def test_doctor_names_what_is_missing_and_how_to_get_it(capsys, monkeypatch):
    version = importlib.metadata.version

    def installed(name):
        if name == "numba":
            raise importlib.metadata.PackageNotFoundError(name)
        return "0.1" if name == "openpyxl" else version(name)

    monkeypatch.setattr(importlib.metadata, "version", installed)
    extras = report(capsys)["extras"]
    assert extras["kinetic"] == [{"package": "numba", "version": None, "problem": "missing"}]
    (workbooks,) = (entry for entry in extras["lab"] if entry["package"] == "openpyxl")
    assert workbooks["problem"].startswith("is 0.1, but ")
    with pytest.raises(SystemExit, match="0"):
        cli.main(["doctor"])
    assert "pip install 'lightflyer[kinetic]'" in capsys.readouterr().out


def test_doctor_says_where_code_is_kept(capsys, monkeypatch, tmp_path):
    monkeypatch.setenv("LIGHTFLYER_CACHE", str(tmp_path / "kept"))
    assert report(capsys)["compiled_code"]["folder"].startswith(str(tmp_path / "kept"))
    monkeypatch.setenv("LIGHTFLYER_CACHE", "off")
    assert report(capsys)["compiled_code"]["folder"] is None


def test_every_extra_is_among_all_of_them():
    # the extra for GRIB files needs ecCodes, a library in C, and is asked for by name
    extras = set(importlib.metadata.metadata("lightflyer").get_all("Provides-Extra"))
    extras -= {"all", "grib"}
    each = {entry["package"] for extra in extras for entry in doctor._requirements(extra)}
    assert {entry["package"] for entry in doctor._requirements("all")} == each
