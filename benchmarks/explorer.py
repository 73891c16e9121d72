"""How fast the explorer's page follows: for each kind of flyer, the first answer and later ones.

Run ``python benchmarks/explorer.py [KIND ...]``, with the names of ``lightflyer init --kind``. Each
answer is what the page asks for when a slider moves (figures), and when it rests (results and
bands to first order). Beside it stands how long the prediction takes that both begin with.
"""

import copy
import resource
import sys
import time
from pathlib import Path

import numpy as np

from lightflyer.explorer.grammar import templates
from lightflyer.explorer.pages import ANSWERS
from lightflyer.explorer.state import Workplace, plain

KINDS = ("earth", "layers", "sandwich", "plate", "balloon", "hollow", "chamber", "mars")
MOVES = 15
SMALLEST_CHANGE = 1e-3  # of a density, each time


def moved(document, number):
    """The document with another payload."""
    changed = copy.deepcopy(document)
    changed["flyer"]["payload"] = f"{SMALLEST_CHANGE * number:.4f} mg"
    return changed


def timed(workplace, name, document):
    start = time.perf_counter()
    found = ANSWERS[name](workplace, {"document": document})
    assert not found.get("errors"), found["errors"]
    return 1e3 * (time.perf_counter() - start)


def main(kinds):
    known = templates()
    print(f"{'kind':10}{'':10}{'first':>9}{'median':>9}{'95 %':>9}  ms")
    for kind in kinds or KINDS:
        document = plain(known[kind].document)
        workplace = Workplace(Path.cwd(), "flyer.toml", document)
        for name in ("move", "predict"):
            times = [timed(workplace, name, moved(document, number)) for number in range(MOVES)]
            late, slow = np.median(times[1:]), np.quantile(times[1:], 0.95)
            print(f"{kind:10}{name:10}{times[0]:9.0f}{late:9.0f}{slow:9.0f}", flush=True)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3
    print(f"largest memory {memory:.0f} MB")


if __name__ == "__main__":
    main(sys.argv[1:])
