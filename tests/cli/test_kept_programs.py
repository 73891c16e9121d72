"""Programs that are kept from one command to the next."""

import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

import lightflyer as lf
from lightflyer.cli import code_cache
from lightflyer.cli.commands.init import templates
from lightflyer.core.cache import SETTING


def in_process(arguments, cache, **environment):
    """Run a command in a process of its own."""
    return subprocess.run(
        [sys.executable, "-m", "lightflyer", *arguments],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | {SETTING: str(cache)} | environment,
    )


@pytest.fixture
def predict(flyer_file):
    """Run a prediction in a process of its own; returns what it printed."""
    return lambda cache: in_process(["predict", str(flyer_file())], cache)


def entries(folder):
    return set(folder.rglob("*.program"))


@pytest.mark.slow
def test_what_was_traced_is_kept_and_used_again(predict, tmp_path):
    folder = tmp_path / "cache"
    first = predict(folder)
    kept = entries(folder)
    assert kept
    assert all(place.stat().st_mode & 0o077 == 0 for place in (folder, folder / "programs"))
    second = predict(folder)
    assert second.stdout == first.stdout
    assert entries(folder) == kept


@pytest.mark.slow
def test_a_later_calibration_traces_nothing(tmp_path):
    """Its design has sets of keys, whose order is another one in each process."""
    flyer, points = tmp_path / "flyer.toml", tmp_path / "points.csv"
    flyer.write_text(templates()["chamber"].read(), encoding="utf-8")
    points.write_text(templates()["points"].read(), encoding="utf-8")
    arguments = ["calibrate", str(points), "--flyer", str(flyer)]
    first, *later = [
        (in_process(arguments, tmp_path / "cache", PYTHONHASHSEED=str(seed)).stdout,
         entries(tmp_path / "cache"))
        for seed in (1, 2, 3)
    ]  # fmt: skip
    assert first[1]
    assert later == [first, first]


@pytest.mark.slow
def test_none_is_kept_where_none_is_wanted_or_can_be(predict, tmp_path):
    (tmp_path / "file").write_text("")
    for cache in ("off", tmp_path / "file"):
        assert predict(cache).stderr == ""
    assert not entries(tmp_path)


@pytest.mark.slow
def test_a_damaged_entry_is_traced_again(predict, tmp_path):
    first = predict(tmp_path / "cache")
    for path in entries(tmp_path / "cache"):
        path.write_bytes(b"damaged")
    second = predict(tmp_path / "cache")
    assert second.stdout == first.stdout
    assert "Traceback" not in second.stderr


def test_code_that_is_not_as_it_was_left_is_removed(tmp_path):
    kept, flipped, planted = (tmp_path / name for name in ("a/f.nbc", "x-cache", "a/g.nbi"))
    kept.parent.mkdir()
    kept.write_bytes(bytes(100))
    flipped.write_bytes(bytes(100))
    code_cache.note_hashes(tmp_path)
    flipped.write_bytes(bytes(50) + b"\x01" + bytes(49))
    planted.write_bytes(b"code")
    (tmp_path / "x-atime").write_bytes(b"1")  # JAX's, not code
    code_cache.remove_strange(tmp_path)
    assert kept.exists()
    assert not flipped.exists()
    assert not planted.exists()
    (tmp_path / "hashes.json").write_text("[")
    code_cache.remove_strange(tmp_path)
    assert not kept.exists()


def test_kernels_of_another_source_have_another_folder(tmp_path, monkeypatch):
    before = code_cache._for_kernels(tmp_path)
    source = Path(lf.__file__).parent / "kinetic_theory" / "solver.py"
    known, later = type(source).stat, SimpleNamespace(st_mtime_ns=1)
    monkeypatch.setattr(
        type(source), "stat", lambda path, **more: later if path == source else known(path, **more)
    )
    assert code_cache._for_kernels(tmp_path) != before
