"""Every command answers without JAX, to the last digit."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from lightflyer.cli.commands.init import templates

BLOCKED = """
import json, os, sys
class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in ("jax", "jaxlib"):
            raise ModuleNotFoundError(name + " is not installed", name=name)
sys.meta_path.insert(0, Blocked())
from importlib import metadata
version = metadata.version
def known(name):
    if name in ("jax", "jaxlib"):
        raise metadata.PackageNotFoundError(name)
    return version(name)
metadata.version = known
from lightflyer.cli import main
for number, words in enumerate(json.load(sys.stdin)):
    sys.stdout = open(f"{number}.txt", "w", encoding="utf-8")
    try:
        main(words)
    except SystemExit as end:
        assert not end.code, words
"""
COMMANDS = [line.split() for line in (
    "predict laden.toml", "predict chamber.toml", "predict sandwich.toml --samples 0",
    "compare laden.toml mars.toml --samples 0", "optimise optimise.toml",
    "sensitivity sensitivity.toml", "film layers.toml", "fly mission.toml",
)]  # fmt: skip
LESS = [
    ('duration = "48 h"', 'duration = "2 h"'), ("points = 1024", "points = 32"),
    ('maximise = "payload"', 'maximise = "payload"\nstarts = 1'),
]  # fmt: skip
WRITTEN = [
    ["sweep", "sweep.toml", "--out", "found"],
    ["predict", "flyer.toml", "--report", "report.html", "--samples", "0"],
]


@pytest.mark.slow
def test_commands_answer_and_write_without_jax(prints, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    kinds = templates()
    for name, template in (kinds | {"flyer": kinds["laden"]}).items():
        text = template.read()
        for much, little in LESS:
            text = text.replace(much, little)
        Path(f"{name}.toml").write_text(text, encoding="utf-8")
    asked = json.dumps(COMMANDS + WRITTEN)
    subprocess.run([sys.executable, "-c", BLOCKED], input=asked, text=True, check=True)
    for number, words in enumerate(COMMANDS):
        assert Path(f"{number}.txt").read_text(encoding="utf-8") == prints(*words), words
    assert Path("found").is_dir()
    assert "not installed" in Path("report.html").read_text(encoding="utf-8")


def test_importing_the_package_is_quick():
    """No library is loaded before it is used."""
    code = (
        "import sys, lightflyer\nfrom lightflyer import cli\n"
        "print(*{name.split('.')[0] for name in sys.modules}"
        " & {'jax', 'numpy', 'scipy', 'pandas', 'pint', 'xarray'})"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == ""
