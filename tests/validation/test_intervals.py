"""How often intervals contain the truth: a case or more of each study, and the table in full."""

import csv
import itertools
import math
from pathlib import Path

import pytest

STUDY = Path(__file__).parents[2] / "studies" / "intervals"
ENOUGH = 4  # intervals, of as many cases as it takes
FARTHEST = 2.5  # half widths from the middle; a normal error of 95 % lies beyond in 1 of 10⁶ cases
LARGEST = 1.5  # root mean square of errors in standard ones, of all quantities of a command
# wider than they need be, as the documentation says: the scatter of few points is poorly known, of
# two samples doubly so, and the law of a narrow range is exact there, but not in a laboratory;
# a curve across a gap may be bent by more than that of a model
CAUTIOUS = ("reduction, 8 points", "scatter like accuracy", "slope, narrow range", "none from")
# those that fall short, as it says too: no residual shows a drift that the parameters take up
SHORT = {"drift not stated": 90.0}
MODULES = sorted({path.stem for path in STUDY.glob("*.py")} - {"study", "trial"})


@pytest.fixture(scope="module")
def study(study_of):
    with study_of("intervals", "study") as module:
        yield module


@pytest.mark.parametrize("module", MODULES)
def test_intervals_cover(study, module, monkeypatch):
    """Far too narrow ones are found here, those that are somewhat so by the study."""
    made = study.load(module)
    some = dict([*getattr(made, "CONDITIONS", {}).items()][::3])  # that share a way to intervals
    monkeypatch.setattr(made, "CONDITIONS", some, raising=False)
    errors, seeds = [], itertools.count(20_000)
    while len(errors) < ENOUGH:
        for trial in study.run_one(module, next(seeds)):
            half = 0.5 * (trial.high - trial.low)
            off = abs(trial.truth - trial.low - half)
            assert off <= FARTHEST * half, trial
            if 0.0 < half < math.inf:
                errors.append(1.96 * off / half)
    assert math.sqrt(sum(error**2 for error in errors) / len(errors)) < LARGEST


def test_the_table_keeps_its_promise():
    """Shares of 93 to 97 %, within what the number of cases leaves open."""
    with (STUDY / "results.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    commands = {command_of(module) for module in MODULES}
    assert {row["command"] for row in rows} == commands
    for row in rows:
        assert int(row["cases"]) >= 300, row
        share, error = float(row["share [%]"]), float(row["± [%]"])
        cautious = any(words in row["quantity"] for words in CAUTIOUS)
        least = next((low for words, low in SHORT.items() if words in row["quantity"]), 93.0)
        assert least - 2.0 * error <= share <= (100.0 if cautious else 97.0 + 2.0 * error), row


def command_of(module):
    """The command that a module is about, without importing what it needs."""
    for line in (STUDY / f"{module}.py").read_text(encoding="utf-8").splitlines():
        if line.startswith("COMMAND = "):
            return line.split('"')[1]
    raise AssertionError(f"{module} has no COMMAND")
