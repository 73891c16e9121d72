"""What an answer of the command line costs, for each kind of flyer.

Run ``python benchmarks/answers.py [ROUNDS] [OTHER]`` on an idle machine; ``OTHER``: a checkout to
compare with, which answers in turn, from an empty cache first and then again. The last row is the
peer: a loop of ten million additions in Python, by which machines compare. Prints the table, and
without another checkout writes it to ``answers.csv``; the least of some rounds counts, by processor
time.
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
HERE = Path(__file__).parents[1]
LOOP = "n = 0\nfor i in range(10_000_000): n += i"


def cost(folder, *arguments, source=HERE):
    """Processor time [s] and memory [MB] of a Python process in a folder."""
    own = {"LIGHTFLYER_CACHE": str(folder / "cache"), "PYTHONPATH": str(source / "src")}
    setting = os.environ | own
    process = subprocess.Popen(
        [sys.executable, *map(str, arguments)], cwd=folder, env=setting, stdout=subprocess.DEVNULL
    )
    _, status, used = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"{' '.join(map(str, arguments))} failed")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024.0


def rows(rounds, other):
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        loop = min(cost(folder, "-c", LOOP)[0] for _ in range(rounds))
        for words, kind in KINDS.items():
            file = f"{kind}.toml"
            cost(folder, "-m", "lightflyer", "init", file, "--kind", kind)
            asked = ("-m", "lightflyer", "fly" if kind == "mission" else "predict", file)
            each = []
            for _ in range(rounds):
                each.append([cost(folder, *asked)])
                if other:
                    shutil.rmtree(folder / "cache", ignore_errors=True)
                    each[-1] += [cost(folder, *asked, source=other) for _ in range(2)]
            (time, size), *theirs = map(min, zip(*each, strict=True))
            row = [words, f"{time:.2g}", f"{time / loop:.2g}", f"{round(size, -1):.0f}"]
            for other_time, other_size in theirs:
                row += [f"{other_time:.2g}", f"{round(other_size, -1):.0f}"]
            yield row + ([f"{time / theirs[1][0]:.2f}"] if theirs else [])
        yield ["ten million additions", f"{loop:.2g}", "1", ""]


def main():
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    other = Path(sys.argv[2]).resolve() if len(sys.argv) > 2 else None
    table = [["", "answer [s]", "answer [loops]", "memory [MB]"]]
    if other:
        table[0] += ["other, first [s]", "[MB]", "other, later [s]", "[MB]", "over later"]
    print("  ".join(f"{cell:>18}" for cell in table[0]))
    for row in rows(rounds, other):
        print("  ".join(f"{cell:>18}" for cell in row), flush=True)
        table.append(row)
    if not other:
        with Path(__file__).with_suffix(".csv").open("w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows(table)


if __name__ == "__main__":
    main()
