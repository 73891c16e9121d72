"""The documentation's own tools, and the program that runs what they write."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

EXTENSIONS = Path(__file__).parents[2] / "docs" / "_extensions"
if str(EXTENSIONS) not in sys.path:
    sys.path.insert(0, str(EXTENSIONS))

# runs calls of functions that the scripts before it define; JSON has no infinity and no NaN
DRIVER = """
{
  const asked = JSON.parse(require("fs").readFileSync(0, "utf8"));
  const plain = (_, value) =>
    typeof value === "number" && !Number.isFinite(value) ? String(value) : value;
  const found = asked.map(([name, ...given]) => eval(name)(...given));
  process.stdout.write(JSON.stringify(found, plain));
}
"""


@pytest.fixture(scope="session")
def node():
    """Path of Node.js, which runs JavaScript without a browser."""
    found = shutil.which("node")
    if found is None:
        pytest.skip("Node.js is not installed: what the calculator computes is not compared")
    return found


@pytest.fixture(scope="session")
def run_javascript(node, tmp_path_factory):
    """A function that makes many calls of a script's functions in one process."""

    def run(script, calls):
        file = tmp_path_factory.mktemp("javascript") / "script.js"
        file.write_text(script + DRIVER, encoding="utf-8")
        given = json.dumps([[name, *arguments] for name, arguments in calls])
        done = subprocess.run(
            [node, str(file)], input=given, capture_output=True, text=True, check=False, timeout=60
        )
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return run


@pytest.fixture(scope="session")
def numbers():
    """A function that makes an array of what JavaScript gave."""
    return lambda found: np.array([float(value) for value in found])


@pytest.fixture(scope="session")
def calculator_files(tmp_path_factory):
    """Folder with the scripts and the style that the calculator's page loads."""
    from calculator import write

    folder = tmp_path_factory.mktemp("calculator")
    write(folder)
    return folder
