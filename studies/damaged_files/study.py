"""Whether commands crash on 2,000 damaged lab files, or answer with impossible numbers.

    python studies/damaged_files/study.py [--files 2000] [--only WORD] [--start 0]

Counts by command go into ``results.csv``; what went wrong is printed.
"""

import argparse
import csv
import sys
from collections import Counter
from pathlib import Path

from check import cases, findings

RESULTS = Path(__file__).parent / "results.csv"


def main() -> None:
    """Damage the files of every command in turn."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--files", type=int, default=2000)
    parser.add_argument("--start", type=int, default=0, help="first seed")
    parser.add_argument("--only", default="", help="part of a command's name")
    options = parser.parse_args()
    chosen = [one for one in cases() if options.only in one.name]
    counts: dict[str, Counter[str]] = {one.name: Counter() for one in chosen}
    for seed in range(options.start, options.start + options.files):
        case = chosen[seed % len(chosen)]
        wrong, damages, code = findings(case, seed)
        counts[case.name]["files"] += 1
        counts[case.name]["refused"] += code == 2
        counts[case.name]["faults"] += bool(wrong)
        for text in wrong[:3]:
            print(f"{case.name} | seed {seed} | {damages} | {text}", flush=True)
        if seed % 100 == 99:
            print(f"{seed + 1} files", file=sys.stderr, flush=True)
    if not options.only:
        with RESULTS.open("w", encoding="utf-8", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(("command", "files", "reduced", "refused", "faults"))
            for name, found in counts.items():
                reduced = found["files"] - found["refused"] - found["faults"]
                writer.writerow((name, found["files"], reduced, found["refused"], found["faults"]))


if __name__ == "__main__":
    main()
