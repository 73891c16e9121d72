"""The package's store of sweeps beside one on Icechunk: kills, damage, speed.

    pip install icechunk
    python studies/sweep_stores/stores.py

Prints the table of the README. A stand-in takes the place of the model, so that the stores are what
is measured; it takes as long as is stated. The disk that fills is a small tmpfs, which root mounts.
"""

import argparse
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from contextlib import redirect_stdout
from functools import partial
from io import StringIO
from pathlib import Path

os.environ["ICECHUNK_LOG"] = "error"  # it warns at every opening: local commits are not safe

import icechunk_store
import numpy as np
import xarray as xr

from lightflyer.compute import scheduler, store
from lightflyer.config.flyer_file import FlyerFile
from lightflyer.core.errors import LightflyerError
from lightflyer.parametric import run
from lightflyer.study.study import make_study

STORES = {"own": store, "icechunk": icechunk_store}
VARIABLES = ["lift", "payload", "temperature", "relative_payload"]
KILLS, LATEST, SECONDS_PER_CHUNK = 44, 0.6, 2e-3
FILM = {"areal_density": "1 g/m^2", "absorptance": 0.75, "emittance": 0.08,
        "tac_top": 0.8, "tac_bottom": 0.9}  # fmt: skip


def study(diameters=600, altitudes=50):
    """A study of the asked size."""
    design = FlyerFile(flyer={"diameter": "2 cm"}, film=FILM, force={"model": "lu2023"}).design()
    entries = {
        "flyer.diameter": np.geomspace(0.005, 0.05, diameters),
        "altitude": np.linspace(60e3, 90e3, altitudes),
    }
    return make_study(design, entries, VARIABLES)


class StandIn:
    """Numbers that depend on the design only."""

    def __init__(self, seconds=0.0, log=None):
        self.seconds, self.log = seconds, log

    def __call__(self, start, stop):
        """Outputs of some designs, and no failures."""
        time.sleep(self.seconds)
        if self.log:
            with open(self.log, "ab") as file:
                file.write(b"%d\n" % start)
        designs = np.arange(start, stop, dtype=float)
        return {name: designs + 0.25 * number for number, name in enumerate(VARIABLES)}, 0


def use(name):
    """Let sweeps use one of the stores."""
    run.open_store, scheduler.write_chunk = STORES[name].open_store, STORES[name].write_chunk


def sweep(folder, asked=None, **options):
    """Run a sweep with the stand-in."""
    options = {"evaluator": StandIn(), "chunk": 50} | options
    return run.sweep_into(asked or study(), folder, **options)


def is_right(name, folder, asked):
    """Whether every number can be read and is right."""
    if name == "own":
        dataset = run.open_sweep(folder)
    else:
        session = icechunk_store._repository(folder).readonly_session("main")
        dataset = xr.open_zarr(session.store, consolidated=False, chunks=None)
    expected, _ = StandIn()(0, asked.size)
    return all(np.array_equal(dataset[key].values.ravel(), expected[key]) for key in VARIABLES)


def forked(function, kill_after=None):
    """Run a function in a process of its own, perhaps killed; its exit status."""
    child = os.fork()
    if child == 0:
        try:
            function()
            sys.stdout.flush()
            os._exit(0)
        except LightflyerError as error:
            print(f"    {' '.join(str(error).split())[:150]}", flush=True)
            os._exit(2)
        except Exception as error:
            print(f"    {type(error).__name__}: {' '.join(str(error).split())[:150]}", flush=True)
        finally:
            sys.stdout.flush()
            os._exit(1)
    if kill_after is not None:
        time.sleep(kill_after)
        os.kill(child, signal.SIGKILL)
    return os.waitpid(child, 0)[1]


def kills(name, folder):
    """Kill a sweep at random moments until it was killed often enough."""
    asked, chance, log = study(), random.Random(1), folder / "log"
    for _ in range(KILLS):
        forked(
            lambda: sweep(folder / "r", asked, evaluator=StandIn(SECONDS_PER_CHUNK, log)),
            chance.uniform(0.0, LATEST),
        )
    report = sweep(folder / "r", asked)
    evaluated = log.read_bytes().count(b"\n") + report.computed // 50
    print(f"  {KILLS} kills: {'right' if is_right(name, folder / 'r', asked) else 'WRONG'}, "
          f"{report.found} found by the last run, {evaluated} evaluations of 600")  # fmt: skip


def damages(path):
    """Ways to damage a file: their names, and functions that do it."""
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    yield "a bit", lambda: path.write_bytes(content)
    yield "cut", lambda: path.write_bytes(content[:-9])
    yield "removed", path.unlink


def damage(name, folder):
    """One file of each kind is damaged in three ways; the same command runs again."""
    asked, whole = study(4), folder / "whole"
    forked(lambda: sweep(whole, asked))
    files = [path for path in whole.rglob("*") if path.is_file() and path.name != "lock"]
    kinds = {}
    for path in sorted(files):
        kinds.setdefault((path.parent, path.name == "zarr.json"), path)
    outcomes = {}
    for path in kinds.values():
        part = path.relative_to(whole)
        kind = "/".join(part.parts[:-1][:2]) or str(part)
        copy = folder / "copy"
        for how, _ in damages(path):
            shutil.rmtree(copy, ignore_errors=True)
            shutil.copytree(whole, copy)
            dict(damages(copy / part))[how]()
            outcomes.setdefault(outcome(name, copy, asked), []).append(f"{kind}: {how}")
    for result, cases in outcomes.items():
        shown = "; ".join(dict.fromkeys(cases))
        print(f"  damage, {result}: {len(cases)} ({shown})")


def outcome(name, folder, asked):
    """What becomes of a damaged sweep when the same command runs again."""
    reading, writing = os.pipe()

    def again():
        signal.alarm(20)
        with redirect_stdout(StringIO()):
            try:
                sweep(folder, asked)
                text = "repaired" if is_right(name, folder, asked) else "WRONG RESULT"
            except LightflyerError as error:
                text = "refused: " + " ".join(str(error).split("; ")[0].split()[1:7])
            except Exception as error:
                text = f"{type(error).__name__}"
        os.write(writing, text.encode())

    forked(again)
    os.close(writing)
    return os.read(reading, 1000).decode() or "ended by a signal"


def full_disk(name, folder):
    """Fill the disk in the middle, then give it more space."""
    asked, small = study(400), folder / "small"
    small.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=400k", "tmpfs", small], check=True)
    try:
        status = forked(lambda: sweep(small / "r", asked, chunk=1000))
        subprocess.run(["mount", "-o", "remount,size=64m", small], check=True)
        forked(
            lambda: print(f"  full disk: status {status >> 8}, then", report_of(name, small, asked))
        )
    finally:
        subprocess.run(["umount", "-l", small], check=True)


def report_of(name, small, asked):
    """What a run finds and leaves."""
    report = sweep(small / "r", asked, chunk=1000)
    right = "right" if is_right(name, small / "r", asked) else "WRONG"
    return f"{report.found} found, {report.computed} computed, {right}"


def two_writers(_, folder):
    """Start a second process a second after the first."""
    asked, children = study(), []
    for number in range(2):
        child = os.fork()
        if child == 0:
            status = 1
            try:
                log = folder / f"log{number}"
                report = sweep(folder / "r", asked, evaluator=StandIn(SECONDS_PER_CHUNK, log))
                print(f"    writer {number}: computed {report.computed}", flush=True)
                status = 0
            except Exception as error:
                print(f"    writer {number}: {' '.join(str(error).split())[:120]}", flush=True)
                status = 2
            os._exit(status)
        children.append(child)
        time.sleep(1.0)
    statuses = [os.waitpid(child, 0)[1] >> 8 for child in children]
    evaluated = sum(path.read_bytes().count(b"\n") for path in folder.glob("log*"))
    report = sweep(folder / "r", asked)
    print(f"  two writers: ended with {statuses}, {evaluated} evaluations of 600 chunks, "
          f"{report.found // 50} chunks kept of them")  # fmt: skip


def speed(_, folder):
    """Time and space of chunks of the usual size, and of many small ones."""
    for label, asked, chunk in (
        ("40 chunks of 2**18 designs", study(2**10, 10240), 2**18),
        ("500 chunks of 50", study(500), 50),
        ("2000 chunks of 50", study(2000), 50),
    ):
        found = []
        for number in range(1 if "2000" in label else 3):
            target = folder / f"{chunk}-{asked.size}-{number}"
            wall, cpu = time.perf_counter(), time.process_time()
            sweep(target, asked, chunk=chunk)
            found.append((time.perf_counter() - wall, time.process_time() - cpu))
            size = sum(path.stat().st_size for path in target.rglob("*") if path.is_file())
            if number:
                shutil.rmtree(target)
        wall, cpu = map(np.median, zip(*found, strict=True))
        count = asked.size / chunk
        wall_again = time.perf_counter()
        sweep(folder / f"{chunk}-{asked.size}-0", asked, chunk=chunk)
        wall_again = time.perf_counter() - wall_again
        print(f"  {label}: {1e3 * wall / count:.2f} ms a chunk, {1e3 * cpu / count:.2f} of CPU, "
              f"{size / 1e6:.1f} MB, checked again in {wall_again:.2f} s")  # fmt: skip


def flushed(name, folder):
    """Count how often files are flushed to the disk."""
    command = ["strace", "-f", "-c", "-e", "trace=fsync,fdatasync", "-o", str(folder / "trace"),
               sys.executable, __file__, "--only", name, "--part", "small"]  # fmt: skip
    subprocess.run(command, check=True, capture_output=True)
    lines = [line.split() for line in (folder / "trace").read_text().splitlines()]
    calls = sum(int(line[3]) for line in lines if line and line[-1] in ("fsync", "fdatasync"))
    print(f"  20 chunks of 4 files: {calls} flushes to the disk")


def small(_, folder):
    """A sweep to be traced."""
    sweep(folder / "r", study(20), chunk=50)


PARTS = {"kills": kills, "damage": damage, "full_disk": full_disk, "two_writers": two_writers,
         "flushed": flushed, "speed": speed}  # fmt: skip


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", choices=STORES)
    parser.add_argument("--part", choices=[*PARTS, "small"])
    options = parser.parse_args()
    if options.part == "small":
        use(options.only)
        with tempfile.TemporaryDirectory() as folder:
            small(options.only, Path(folder))
        return
    for name in STORES:
        if options.only in (None, name):
            print(
                f"{name}, {len(Path(STORES[name].__file__).read_text().splitlines())} lines",
                flush=True,
            )
            use(name)
            for part, function in PARTS.items():
                if options.part in (None, part):
                    with tempfile.TemporaryDirectory() as folder:
                        # each in a process of its own: Icechunk's threads do not survive a fork
                        status = forked(partial(function, name, Path(folder)))
                        if status:
                            print(f"  {part}: ended with {json.dumps(status)}", flush=True)


if __name__ == "__main__":
    main()
