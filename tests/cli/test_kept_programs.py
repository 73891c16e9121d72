"""Programs that are kept from one command to the next."""

import os
import subprocess
import sys

import pytest

from lightflyer.core.cache import SETTING


@pytest.fixture
def predict(flyer_file):
    """Run a prediction in a process of its own; returns what it printed."""

    def command(cache):
        return subprocess.run(
            [sys.executable, "-m", "lightflyer", "predict", str(flyer_file())],
            capture_output=True,
            text=True,
            check=True,
            env=os.environ | {SETTING: str(cache)},
        )

    return command


def entries(folder):
    return set(folder.rglob("*.program"))


def test_what_was_traced_is_kept_and_used_again(predict, tmp_path):
    folder = tmp_path / "cache"
    first = predict(folder)
    kept = entries(folder)
    assert kept
    assert folder.stat().st_mode & 0o077 == 0 or (folder / "programs").stat().st_mode & 0o077 == 0
    second = predict(folder)
    assert second.stdout == first.stdout
    assert entries(folder) == kept


def test_none_is_kept_where_none_is_wanted_or_can_be(predict, tmp_path):
    (tmp_path / "file").write_text("")
    for cache in ("off", tmp_path / "file"):
        assert predict(cache).stderr == ""
    assert not entries(tmp_path)


def test_a_damaged_entry_is_traced_again(predict, tmp_path):
    first = predict(tmp_path / "cache")
    for path in entries(tmp_path / "cache"):
        path.write_bytes(b"damaged")
    second = predict(tmp_path / "cache")
    assert second.stdout == first.stdout
    assert "Traceback" not in second.stderr
