"""Forks processes that run a sweep into a folder, and kills each at a random moment.

Run by test_sweep_is_never_lost.py in a process of its own, which has not started JAX: processes
forked from it begin within milliseconds. A stand-in takes the place of the
model; all else is the package's own. With the address of a Dask scheduler it is a client instead.
"""

import itertools
import json
import os
import random
import signal
import sys
import time
from pathlib import Path

import numpy as np

from lightflyer.config.flyer_file import FlyerFile
from lightflyer.parametric.run import sweep_into
from lightflyer.study.study import make_study

CHUNK = 50
SECONDS_PER_CHUNK = 2e-3
LATEST = 0.25  # of a kill, after the process began [s]
CHUNKS_BEFORE_A_KILL = 12  # at most; then the process waits for its end, however fast it is

FILM = {
    "areal_density": "1 g/m^2",
    "absorptance": 0.75,
    "emittance": 0.08,
    "tac_top": 0.8,
    "tac_bottom": 0.9,
}


def study():
    design = FlyerFile(flyer={"diameter": "2 cm"}, film=FILM, force={"model": "lu2023"}).design()
    entries = {
        "flyer.diameter": np.linspace(0.005, 0.05, 300),
        "altitude": np.linspace(60e3, 90e3, 50),
    }
    return make_study(design, entries, ["lift", "payload"])


class StandIn:
    """Numbers that depend on the design only; logs each evaluation in a file.

    With `most`, it hangs after that many evaluations.
    """

    def __init__(self, log=None, most=None):
        self.log, self.most = log, most
        self.count = itertools.count()

    def __call__(self, start, stop):
        designs = np.arange(start, stop)
        if self.most is not None and next(self.count) >= self.most:
            time.sleep(60)
        if self.log:
            time.sleep(SECONDS_PER_CHUNK)
            with open(self.log, "ab") as file:
                file.write(b"%d\n" % start)
        return {"lift": np.sin(designs), "payload": np.cos(designs) / 3.0}, 0


def run(folder, **options):
    return sweep_into(study(), folder / "killed.zarr", chunk=CHUNK, **options)


def run_on(address, folder):
    return run(folder, evaluator=StandIn(folder / "evaluations"), scheduler=address)


def size_of(log):
    return log.stat().st_size if log.exists() else 0


def kill_repeatedly(folder, kills, seed):
    chance, log = random.Random(seed), folder / "evaluations"
    sweep_into(study(), folder / "undisturbed.zarr", chunk=CHUNK, evaluator=StandIn())
    killed = 0
    while killed < kills:
        before, child = size_of(log), os.fork()
        if child == 0:
            try:
                run(folder, evaluator=StandIn(log, CHUNKS_BEFORE_A_KILL), workers=2)
            finally:
                os._exit(0)
        while killed % 2 and size_of(log) == before:  # half of them once they compute, however late
            time.sleep(1e-3)
        time.sleep(chance.uniform(0.0, LATEST))
        os.kill(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
        if not os.WIFSIGNALED(status):
            break  # it failed, or had finished: too few chunks for so many kills
        killed += 1
    report = run(folder, evaluator=StandIn(log), workers=2)
    print(json.dumps({"killed": killed, "found": report.found, "computed": report.computed}))


if __name__ == "__main__":
    folder, kills_or_address = Path(sys.argv[1]), sys.argv[2]
    if kills_or_address.isdigit():
        kill_repeatedly(folder, int(kills_or_address), int(sys.argv[3]))
    else:
        run_on(kills_or_address, folder)
