"""Code that is kept from one command to the next."""

from pathlib import Path
from types import SimpleNamespace

import lightflyer as lf
from lightflyer.cli import code_cache


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
