"""Answers by kept programs need no JAX, whose loading takes as long as the answer."""

import os
import subprocess
import sys

import pytest

from lightflyer.cli.commands.init import templates

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

COUNTED = """
import sys
from collections import Counter
from pathlib import Path
from lightflyer.__main__ import main
from lightflyer.program import kept
from lightflyer.program.entry_point import _Runner
kept._SHIPPED = Path("none")  # where a wheel was built, the package has these programs
counts, run = Counter(), _Runner._run_in_double
def counted(self, *args, **kwargs):
    counts[self._function.__qualname__] += 1
    return run(self, *args, **kwargs)
_Runner._run_in_double = counted
sys.argv[0] = "lightflyer"
try:
    main()
finally:
    print(*(f"{name} {counts[name]}" for name in sorted(counts)), sep="\\n", file=sys.stderr)
"""


@pytest.mark.slow
def test_a_first_answer_traces_what_day_night_and_bands_share_once(tmp_path):
    environment = os.environ | {"LIGHTFLYER_CACHE": str(tmp_path / "cache")}
    (tmp_path / "file.toml").write_text(templates()["laden"].read(), encoding="utf-8")
    found = subprocess.run(
        [sys.executable, "-c", COUNTED, "predict", "file.toml"], cwd=tmp_path, env=environment,
        capture_output=True, text=True,
    )  # fmt: skip
    assert found.returncode == 0, found.stderr
    shared = {"tabulate", "solve_equilibrium", "Kinetic.force", "Kinetic.heat_loss", "_along"}
    lines = (line.split() for line in found.stderr.splitlines())
    counts = {line[0]: int(line[1]) for line in lines if line and line[0] in shared}
    assert counts == dict.fromkeys(shared, 1)


@pytest.mark.slow
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
