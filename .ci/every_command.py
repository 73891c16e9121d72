"""Try every command once where no extra is installed, and check how much is installed.

Run by the Python of an environment that holds ``lightflyer`` and what it needs, and nothing else.
"""

import os
import re
import shlex
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from lightflyer.lab.commands import measurements

MOST = 520  # MB of the whole environment
BIN = Path(sys.executable).parent / "lightflyer"

# what to type, and the extra that the command asks for where it needs one
TRIED = [
    ("doctor", None),
    ("materials", None),
    ("materials --search chromium", "materials"),
    ("init flyer.toml --kind laden", None),
    ("init layers.toml --kind layers", None),
    ("init chamber.toml --kind chamber", None),
    ("predict flyer.toml --out prediction --report flyer.html", None),
    ("predict layers.toml", None),
    ("film layers.toml --out film", None),
    ("compare flyer.toml layers.toml --out comparison", None),
    ("stability flyer.toml --rod 5mm --out stability", None),
    ("drift flyer.toml --out drift", None),
    ("swarm flyer.toml --payload 10mg --out swarm", None),
    ("init mission.toml --kind mission", None),
    ("fly mission.toml --out mission", None),
    ("spread swarm.toml --out spread", None),
    ("init sweep.toml --kind sweep", None),
    ("sweep sweep.toml --out designs.zarr", "sweep"),
    ("map designs.zarr --x diameter --value relative_payload", "sweep"),
    ("init best.toml --kind optimise", None),
    ("optimise best.toml --out best", None),
    ("init which.toml --kind sensitivity", None),
    ("sensitivity which.toml", "optimise"),
    ("init points.csv --kind points", None),
    ("calibrate points.csv --flyer chamber.toml", None),
    ("kinetic --kn 1 --tac-top 0.8 --tac-bottom 0.9", "kinetic"),
    ("explore flyer.toml", "explorer"),
    ("paper --out paper", None),
]
SWARM = """
[mission.ensemble]
members = 20
wind_uncertainty = "10 m/s"
"""
MEASUREMENTS = list(measurements())


def run(line: str, extra: str | None) -> str:
    """Output of a command, which must end as it should."""
    start = time.perf_counter()
    done = subprocess.run([BIN, *shlex.split(line)], capture_output=True, text=True)
    print(f"{time.perf_counter() - start:6.1f} s  lightflyer {line}", flush=True)
    told = done.stdout + done.stderr
    if extra is None:
        assert done.returncode == 0, told
        assert "Traceback" not in told, told
    else:
        assert done.returncode == 2, told
        assert f"pip install 'lightflyer[{extra}]'" in done.stderr, told
        assert "Traceback" not in told, told
    return told


def listed(command: str) -> set[str]:
    """Names of the commands that a help text lists."""
    told = subprocess.run([BIN, *command.split(), "--help"], capture_output=True, text=True).stdout
    return set(re.findall(r"^│ ([a-z]+) {2,}", told, re.M))


def measure() -> None:
    """Every command of the bench, on the files that it comes with, as it says itself."""
    for name in MEASUREMENTS:
        told = run(f"lab example {name} --out .", None)
        following = re.findall(r"^next: lightflyer (.*)$", told, re.M)
        assert following, told
        for line in following:
            run(line, None)
    run("lab summary .", None)


def main() -> None:
    """Try all and measure."""
    tried = {line.split()[0] for line, _ in TRIED} | {"lab"}
    assert tried == listed(""), tried ^ listed("")
    assert {*MEASUREMENTS, "example", "summary"} == listed("lab")
    megabytes = sum(path.lstat().st_blocks * 512 for path in Path(sys.prefix).rglob("*")) / 2**20
    print(f"{megabytes:.0f} MB in the environment")
    assert megabytes <= MOST
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        for line, extra in TRIED:
            if line.startswith("spread"):
                mission = Path("mission.toml").read_text("utf-8")
                Path("swarm.toml").write_text(mission + SWARM, "utf-8")
            run(line, extra)
        measure()


if __name__ == "__main__":
    main()
