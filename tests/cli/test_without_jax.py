"""Every command answers without JAX, to the last digit."""

import os
import subprocess
import sys

import pytest

from lightflyer.cli.commands.init import templates

BLOCKED = """
import sys
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
from lightflyer.__main__ import main
sys.argv[0] = "lightflyer"
main()
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "command"),
    [
        *((kind, ["predict"]) for kind in ("laden", "chamber", "mars", "sandwich", "plate")),
        ("laden", ["compare", "flyer.toml"]),
        ("optimise", ["optimise"]),
        ("sensitivity", ["sensitivity"]),
        ("layers", ["film"]),
        ("mission", ["fly"]),
    ],
)
def test_commands_answer_without_jax(kind, command, tmp_path):
    (tmp_path / "flyer.toml").write_text(templates()["laden"].read(), encoding="utf-8")
    (tmp_path / "file.toml").write_text(templates()[kind].read(), encoding="utf-8")

    def run(*arguments):
        return subprocess.run(
            [sys.executable, *arguments], cwd=tmp_path, capture_output=True, text=True,
            env=os.environ | {"LIGHTFLYER_PROGRESS": "off"},
        )  # fmt: skip

    name, *options = command
    blocked = run("-c", BLOCKED, name, "file.toml", *options)
    assert blocked.returncode == 0, blocked.stderr
    assert blocked.stdout == run("-m", "lightflyer", name, "file.toml", *options).stdout


@pytest.mark.slow
def test_a_sweep_and_a_report_are_written_without_jax(tmp_path):
    (tmp_path / "flyer.toml").write_text(templates()["laden"].read(), encoding="utf-8")
    (tmp_path / "sweep.toml").write_text(templates()["sweep"].read(), encoding="utf-8")
    for arguments in (
        ("sweep", "sweep.toml", "--out", "found"),
        ("predict", "flyer.toml", "--report", "report.html"),
    ):
        subprocess.run([sys.executable, "-c", BLOCKED, *arguments], cwd=tmp_path, check=True)
    assert (tmp_path / "found").is_dir()
    assert "not installed" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_importing_the_package_is_quick():
    """No library is loaded before it is used."""
    code = (
        "import sys, lightflyer\n"
        "print(*{name.split('.')[0] for name in sys.modules}"
        " & {'jax', 'numpy', 'scipy', 'pandas', 'pint', 'xarray'})"
    )
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert found.stdout.strip() == ""
