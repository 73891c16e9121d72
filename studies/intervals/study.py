"""How often the package's 95 % intervals contain the truth.

Each other module of this folder is about one command. It has a ``COMMAND`` and a function
``trials(seed)`` that makes one synthetic case by a route of its own, reduces it as the command does
and returns the intervals beside the truth. Run all, or those that are named:

    python studies/intervals/study.py [MODULE ...] [--cases 400] [--workers 2]

The shares go into ``results.csv``, and those of each command into ``summary.csv``, which
the documentation shows.
"""

import argparse
import csv
import importlib.util
import math
import sys
from collections import defaultdict
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import cache, partial
from pathlib import Path
from statistics import median
from types import ModuleType

from trial import Trial

HERE = Path(__file__).parent
RESULTS, SUMMARY = HERE / "results.csv", HERE / "summary.csv"
HEADER = ("command", "quantity", "cases", "share [%]", "± [%]", "median width over truth [%]")
_NOT_COMMANDS = {"study", "trial"}


def modules() -> list[str]:
    """Names of the commands' modules."""
    return sorted({path.stem for path in HERE.glob("*.py")} - _NOT_COMMANDS)


@cache
def load(module: str) -> ModuleType:
    """A module of this folder, whatever else has its name."""
    spec = importlib.util.spec_from_file_location(f"intervals_{module}", HERE / f"{module}.py")
    assert spec is not None
    assert spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(found)
    return found


def run_one(module: str, seed: int) -> list[Trial]:
    """Trials of one module for one seed."""
    return list(load(module).trials(seed))


def rows_of(module: str, cases: int, workers: int) -> list[list[str]]:
    """Rows of the table for one module."""
    found: dict[str, list[Trial]] = defaultdict(list)
    with ProcessPoolExecutor(workers) as pool:
        for number, trials in enumerate(pool.map(partial(run_one, module), range(cases)), 1):
            for trial in trials:
                found[trial.quantity].append(trial)
            if number % 50 == 0:
                print(f"{module}: {number} of {cases}", file=sys.stderr, flush=True)
    command = load(module).COMMAND
    return [[command, quantity, *_shares(trials)] for quantity, trials in found.items()]


def _shares(trials: Sequence[Trial]) -> list[str]:
    count = len(trials)
    share = sum(trial.covered for trial in trials) / count
    widths = sorted(abs((trial.high - trial.low) / trial.truth) for trial in trials if trial.truth)
    width = widths[len(widths) // 2] if widths else math.nan
    sampling = math.sqrt(share * (1.0 - share) / count)
    return [str(count), f"{100 * share:.1f}", f"{100 * sampling:.1f}", f"{100 * width:.3g}"]


def write(rows: Sequence[Sequence[str]]) -> None:
    """Put rows into the table in place of older ones of the same commands."""
    fresh = {row[0] for row in rows}
    kept: list[Sequence[str]] = []
    if RESULTS.exists():
        with RESULTS.open(encoding="utf-8", newline="") as file:
            kept = [row for row in list(csv.reader(file))[1:] if row[0] not in fresh]
    with RESULTS.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([HEADER, *sorted([*kept, *rows])])
    summarise()


def summarise() -> None:
    """Lowest, middle and highest share of each command, from the table of all."""
    shares: dict[str, list[tuple[float, str]]] = defaultdict(list)
    with RESULTS.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            shares[row["command"]].append((float(row["share [%]"]), row["quantity"]))
    with SUMMARY.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(("command", "intervals", "median [%]", "lowest [%]", "highest [%]"))
        for command, found in shares.items():
            values, words = zip(*sorted(found), strict=True)
            ends = (f"{values[end]:.1f}: {words[end]}" for end in (0, -1))
            table.writerow((command, len(found), f"{median(values):.1f}", *ends))


def main() -> None:
    """Run the modules that are named, or all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("modules", nargs="*", metavar="MODULE", help=", ".join(modules()))
    parser.add_argument("--cases", type=int, default=400)
    parser.add_argument("--workers", type=int, default=2)
    options = parser.parse_args()
    for module in options.modules or modules():
        rows = rows_of(module, options.cases, options.workers)
        write(rows)
        for row in rows:
            print(" | ".join(row), flush=True)


if __name__ == "__main__":
    main()
