"""Answers by kept programs need no JAX, whose loading takes as long as the answer."""

import os
import subprocess
import sys

import pytest

BLOCKED = """
import sys
class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in ("jax", "jaxlib", "equinox"):
            raise AssertionError(name + " is loaded")
sys.meta_path.insert(0, Blocked())
from lightflyer.__main__ import main
sys.argv[0] = "lightflyer"
main()
"""


@pytest.mark.parametrize(
    ("kind", "command"),
    [
        *((kind, "predict") for kind in ("laden", "chamber", "mars", "sandwich")),
        ("layers", "film"),
        ("mission", "fly"),
    ],
)
def test_the_second_answer_loads_no_jax(kind, command, tmp_path):
    environment = os.environ | {"LIGHTFLYER_CACHE": str(tmp_path / "cache")}

    def run(*arguments):
        return subprocess.run(
            [sys.executable, *arguments], cwd=tmp_path, env=environment, capture_output=True,
            text=True,
        )  # fmt: skip

    run("-m", "lightflyer", "init", "file.toml", "--kind", kind)
    first = run("-m", "lightflyer", command, "file.toml")
    assert first.returncode == 0, first.stderr
    second = run("-c", BLOCKED, command, "file.toml")
    assert second.returncode == 0, second.stderr
    assert second.stdout == first.stdout
