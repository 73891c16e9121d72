"""What a first and a later answer of the command line cost, for each kind of flyer.

Run ``python benchmarks/answers.py [ROUNDS]`` on an idle machine. A first answer has an empty cache,
as in a checkout; later ones, and first ones of an installed wheel, read what was traced. The last
row is the peer: a loop of ten million additions in Python, by which machines compare. Prints the
table, and writes it to ``answers.csv``; the least of some rounds counts, by processor time.
"""

import csv
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

KINDS = {
    "disk over Earth": "laden",
    "sandwich": "sandwich",
    "film of layers": "layers",
    "plate": "plate",
    "solar balloon": "balloon",
    "disk over Mars": "mars",
    "hollow body": "hollow",
    "a flight of 48 h": "mission",
}
LOOP = "n = 0\nfor i in range(10_000_000): n += i"


def cost(folder, *arguments):
    """Processor time [s] and memory [MB] of a Python process in a folder."""
    setting = os.environ | {"LIGHTFLYER_CACHE": str(folder / "cache")}
    process = subprocess.Popen(
        [sys.executable, *map(str, arguments)], cwd=folder, env=setting, stdout=subprocess.DEVNULL
    )
    _, status, used = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"{' '.join(map(str, arguments))} failed")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024.0


def rows(rounds):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        loop = min(cost(folder, "-c", LOOP)[0] for _ in range(rounds))
        for words, kind in KINDS.items():
            file = f"{kind}.toml"
            cost(folder, "-m", "lightflyer", "init", file, "--kind", kind)
            asked = ("-m", "lightflyer", "fly" if kind == "mission" else "predict", file)
            both = []
            for _ in range(rounds):
                shutil.rmtree(folder / "cache", ignore_errors=True)
                both.append((cost(folder, *asked), cost(folder, *asked)))
            (first, most), (later, less) = map(min, zip(*both, strict=True))
            yield [words, *(f"{time:.2g}" for time in (first, later, first / loop, later / loop)),
                   *(f"{round(size, -1):.0f}" for size in (most, less))]  # fmt: skip
        yield ["ten million additions", f"{loop:.2g}", f"{loop:.2g}", "1", "1", "", ""]


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    head = ["", "first [s]", "later [s]", "first [loops]", "later [loops]",
            "memory first [MB]", "later [MB]"]  # fmt: skip
    table = []
    for row in (head, *rows(rounds)):
        print("  ".join(f"{cell:>18}" for cell in row), flush=True)
        table.append(row)
    with Path(__file__).with_suffix(".csv").open("w", newline="", encoding="utf-8") as file:
        csv.writer(file, lineterminator="\n").writerows(table)


if __name__ == "__main__":
    main()
