import os
import subprocess
import sys
import time

import pytest

from lightflyer.core.atomic_files import TEMPORARY, output_directory
from lightflyer.core.errors import ParameterWarning


def write(folder, *names):
    with output_directory(folder) as stage:
        for name in names:
            stage(name).write_text("x", encoding="utf-8")


def test_results_of_another_run_are_named(tmp_path):
    write(tmp_path, "tac.json", "tac.svg")
    (tmp_path / "rows.csv").write_text("an input", encoding="utf-8")
    write(tmp_path, "tac.json", "tac.svg")
    with pytest.warns(ParameterWarning, match=r"there before: tac\.svg"):
        write(tmp_path, "tac.json", "tac.png")
    assert {path.name for path in tmp_path.iterdir()} == {
        "rows.csv", "tac.json", "tac.png", "tac.svg"
    }  # fmt: skip


@pytest.mark.parametrize(("age", "stays"), [(3600.0, True), (2 * 86400.0, False)])
def test_what_a_killed_run_left_is_removed_after_a_day(tmp_path, age, stays):
    left = tmp_path / f"{TEMPORARY}abc"
    left.mkdir()
    (left / "half.nc").write_text("x", encoding="utf-8")
    then = time.time() - age
    os.utime(left, (then, then))
    write(tmp_path, "tac.json")
    assert left.exists() == stays


@pytest.mark.skipif(os.name != "posix", reason="processes are asked for by a signal")
def test_what_a_killed_process_left_is_removed_at_once(tmp_path):
    code = (
        "import os, signal, sys; from pathlib import Path\n"
        "from lightflyer.core.atomic_files import output_directory\n"
        "with output_directory(Path(sys.argv[1])) as stage:\n"
        "    stage('half.nc').write_text('x')\n"
        "    os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    subprocess.run([sys.executable, "-c", code, str(tmp_path)], check=False)
    (left,) = tmp_path.iterdir()
    assert left.name.startswith(TEMPORARY)
    with output_directory(tmp_path) as stage:  # one that is at it stays
        stage("tac.json").write_text("x", encoding="utf-8")
        write(tmp_path, "tac.txt")
        assert len(list(tmp_path.glob(f"{TEMPORARY}*"))) == 1
    assert {path.name for path in tmp_path.iterdir()} == {"tac.json", "tac.txt"}
