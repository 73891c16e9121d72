"""Speed of sweeps and of the optimiser beside their peers, in one run.

    python benchmarks/sweep.py [--designs 10000000] [--repeats 3] [--large]

Prints the numbers of docs/benchmarks.md. What is compared alternates, and ratios are of medians:
the machine's own speed drops out of them. ``--large`` also runs 10⁸ designs once, in a process of
its own, and reports its peak memory.
"""

import argparse
import json
import logging
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
from scipy.optimize import differential_evolution

import lightflyer as lf
from lightflyer.compute.evaluation import BATCH, Chunks, Evaluator
from lightflyer.compute.scheduler import processors
from lightflyer.core.progress import report_to
from lightflyer.parametric.run import sweep_into
from lightflyer.search.objectives import ObjectiveFunction
from lightflyer.search.optimiser import find_optimum
from lightflyer.search.problem import as_problem
from lightflyer.study.study import make_study

VARIABLES = ["temperature", "lift", "relative_payload", "levitation_irradiance"]
LARGE = 100_000_000
FILM = {
    "areal_density": "1 g/m^2",
    "absorptance": 0.75,
    "emittance": 0.08,
    "tac_top": 0.8,
    "tac_bottom": 0.9,
}
DESIGN = lf.FlyerFile(flyer={"diameter": "2 cm"}, film=FILM, force={"model": "lu2023"}).design()
PENALTY = 1e3  # of a violated constraint, in scales of the objective


def study(designs):
    entries = {
        "flyer.diameter": np.geomspace(0.005, 0.05, designs // 1000),
        "film.emittance": np.linspace(0.04, 0.2, 10),
        "altitude": np.linspace(60e3, 90e3, 100),
    }
    return make_study(DESIGN, entries, VARIABLES)


def timed(function):
    wall, cpu = time.perf_counter(), time.process_time()
    function()
    return time.perf_counter() - wall, time.process_time() - cpu


def medians(functions, repeats):
    """Median wall and processor time of each function over alternating runs."""
    times = {name: [] for name in functions}
    for _ in range(repeats):
        for name, function in functions.items():
            times[name].append(timed(function))
    return {
        name: tuple(statistics.median(column) for column in zip(*rows, strict=True))
        for name, rows in times.items()
    }


def throughput(folder, designs, repeats):
    """The kernel in memory beside the same sweep to Zarr, both on all processors."""
    asked = study(designs)
    evaluate = Evaluator(asked)
    evaluate(0, BATCH)  # compiles
    chunks = Chunks.of(asked.shape)

    def in_memory():
        def one(chunk):
            evaluate(*chunks.span(chunk))

        with ThreadPoolExecutor(processors()) as pool:
            list(pool.map(one, range(len(chunks))))

    def to_zarr():
        shutil.rmtree(folder / "results.zarr", ignore_errors=True)
        sweep_into(asked, folder / "results.zarr", evaluator=evaluate)

    found = medians({"kernel": in_memory, "zarr": to_zarr}, repeats)
    print(f"{designs:,} designs, {len(VARIABLES)} outputs, medians of {repeats} alternating runs")
    print(f"{'':34}{'wall [s]':>10}{'CPU [s]':>10}{'designs/s':>14}")
    for name, label in (("kernel", "kernel, results dropped"), ("zarr", "sweep to Zarr")):
        wall, cpu = found[name]
        print(f"{label:34}{wall:10.2f}{cpu:10.2f}{designs / wall:14,.0f}")
    ratios = [kernel / zarr for kernel, zarr in zip(found["kernel"], found["zarr"], strict=True)]
    print(f"throughput to Zarr over the kernel's: {ratios[0]:.2f} (by CPU time {ratios[1]:.2f})")


def few():
    """Designs that NumPy evaluates while XLA compiles: the constants of the evaluator."""
    print(
        f"\n{'':34}{'NumPy: first [s]':>18}{'a design [µs]':>16}{'XLA: first [s]':>16}{'few':>10}"
    )
    for outputs in (VARIABLES, ["lowest_altitude", "highest_altitude"], ["usable_payload"]):
        over = {"film.emittance": np.linspace(0.05, 0.15, 8192 if outputs is VARIABLES else 256)}
        place = {"altitude": "70 km"} if outputs is VARIABLES else {}
        asked = make_study(DESIGN, over | place, outputs)
        times = {}
        for way in ("numpy", "xla"):
            evaluate = Evaluator(asked, None if way == "numpy" else "cpu")
            run = partial(evaluate, 0, asked.size)
            times[way] = timed(run)[1], timed(run)[1]
        (ours, again), (theirs, _) = times["numpy"], times["xla"]
        each = again / asked.size
        print(f"{', '.join(outputs)[:32]:34}{ours:18.1f}{1e6 * each:16.1f}"
              f"{theirs:16.1f}{(theirs - ours) / each:10,.0f}")  # fmt: skip


class Clock:
    """Notes when chunks are done."""

    def __init__(self):
        self.done = []

    def __call__(self, step):
        if step.unit == "designs" and step.done:
            self.done.append(time.perf_counter())

    @property
    def per_chunk(self):
        """Time a chunk, from the first to the last, without what comes before."""
        return (self.done[-1] - self.done[0]) / (len(self.done) - 1)


def start_clusters(folder):
    """Clusters of one worker and of two, each worker one thread."""
    import distributed

    return {
        count: distributed.LocalCluster(
            n_workers=count,
            threads_per_worker=1,
            dashboard_address=":0",
            local_directory=folder,
            silence_logs=logging.ERROR,
        )
        for count in (1, 2)
    }


def cluster(folder, designs, repeats):
    """One Dask worker beside two, and beside a process without Dask; each of one thread."""
    import distributed

    asked = study(designs)

    def sweep(address):
        shutil.rmtree(folder / "cluster.zarr", ignore_errors=True)
        clock = Clock()
        with report_to(clock):
            sweep_into(asked, folder / "cluster.zarr", scheduler=address)
        return clock.per_chunk

    clusters = start_clusters(folder)
    addresses = {count: found.scheduler_address for count, found in clusters.items()}
    for address in addresses.values():
        sweep(address)  # compiles on the workers
    times, spent = {"process": [], "processes": [], 1: [], 2: []}, {"process": [], 1: []}
    with distributed.Client(addresses[1]) as client:
        for _ in range(repeats):
            alone = without_dask(folder, designs, 1)
            times["process"].append(alone[0])
            spent["process"].append(alone[1])
            times["processes"].append(without_dask(folder, designs, 2)[0] / 2.0)
            before = sum(client.run(time.process_time).values())
            times[1].append(sweep(addresses[1]))
            spent[1].append(sum(client.run(time.process_time).values()) - before)
            times[2].append(sweep(addresses[2]))
    for found in clusters.values():
        found.close()
    print(f"\n{designs:,} designs in {len(Chunks.of(asked.shape))} chunks, on a Dask cluster")
    show_cluster(times, spent)


def without_dask(folder, designs, count):
    """Time a chunk, and processor time, of as many processes at once, each one sweep on one thread.

    Two of them say what the machine has to give: processors share caches, memory and a clock.
    """
    environment = os.environ | {"PJRT_NPROC": "1"}
    environment.pop("MALLOC_TRIM_THRESHOLD_", None)  # which Dask sets for its workers, and leaves
    command = [sys.executable, __file__, "--designs", str(designs), "--thread"]
    running = [
        subprocess.Popen(
            [*command, str(folder / f"{number}.zarr")],
            env=environment,
            stdout=subprocess.PIPE,
            text=True,
        )
        for number in range(count)
    ]
    found = [json.loads(process.communicate()[0]) for process in running]
    return [statistics.mean(column) for column in zip(*found, strict=True)]


def thread(folder, designs):
    shutil.rmtree(folder, ignore_errors=True)
    asked, clock = study(designs), Clock()
    evaluate = Evaluator(asked)
    evaluate(0, BATCH)  # compiles
    before = time.process_time()
    with report_to(clock):
        sweep_into(asked, folder, evaluator=evaluate, workers=1)
    print(json.dumps([clock.per_chunk, time.process_time() - before]))


def show_cluster(times, spent):
    print(f"{'':34}{'a chunk [ms]':>14}{'each run':>30}")
    found = {name: statistics.median(column) for name, column in times.items()}
    labels = {
        "process": "one process, no cluster",
        "processes": "two processes, no cluster",
        1: "one worker",
        2: "two workers",
    }
    for name, label in labels.items():
        each = "  ".join(f"{1e3 * value:.0f}" for value in times[name])
        print(f"{label:34}{1e3 * found[name]:14.1f}{each:>30}")
    wall = 100.0 * (found[1] / found["process"] - 1.0)
    worker, process = (statistics.median(spent[name]) for name in (1, "process"))
    print(f"two workers over one: {found[1] / found[2]:.2f} times")
    print(f"two processes over one: {found['process'] / found['processes']:.2f} times")
    share = 100.0 * (worker / process - 1.0)
    print(f"the cluster's overhead: {wall:.0f} % a chunk, {share:.0f} % of the worker's CPU time")


DIAMETER = {"from": "0.5 cm", "to": "5 cm", "scale": "log"}
DENSITY = {"from": "0.5 g/m^2", "to": "2 g/m^2", "scale": "log"}
ALTITUDE = {"from": "60 km", "to": "90 km"}
PROBLEMS = {
    "payload over diameter, density, altitude": {
        "maximise": "payload",
        "over": {"flyer.diameter": DIAMETER, "film.areal_density": DENSITY, "altitude": ALTITUDE},
        "constraints": {"areal_density": {"at_least": "0.8 g/m^2"}},
    },
    "the same below 330 K": {
        "maximise": "payload",
        "over": {"flyer.diameter": DIAMETER, "film.areal_density": DENSITY, "altitude": ALTITUDE},
        "constraints": {
            "areal_density": {"at_least": "0.8 g/m^2"},
            "temperature": {"at_most": "330 K"},
        },
    },
    "least irradiance for 0.1 mg": {
        "minimise": "levitation_irradiance",
        "over": {
            "flyer.payload": "0.1 mg",
            "flyer.diameter": DIAMETER,
            "film.areal_density": {"from": "0.8 g/m^2", "to": "2 g/m^2", "scale": "log"},
            "film.emittance": {"from": 0.06, "to": 0.2},
            "altitude": ALTITUDE,
        },
    },
}


def plain_loss(problem, scale):
    """The objective as one writes it with the package's functions, for SciPy."""

    def loss(point):
        free = {
            bounds.field.name: bounds.value(fraction)
            for bounds, fraction in zip(problem.bounds, point, strict=True)
        }
        values = problem.fixed | free
        emittance = values.get("film.emittance", 0.08)
        film = lf.FilmProperties(
            values.get("film.areal_density", 1e-3), 0.75, emittance, emittance, 0.8, 0.9
        )
        disk = lf.Disk(film, 0.5 * values["flyer.diameter"], values.get("flyer.payload", 0.0))
        state = lf.Earth().state(values["altitude"])
        if problem.objectives[0].name == "payload":
            gain = lf.payload(disk, state, lf.Lu2023()) / scale
        else:
            gain = -lf.levitate(disk, state, lf.Lu2023()).irradiance / scale
        lost = PENALTY * max(0.0, 0.8e-3 - values["film.areal_density"]) / 0.8e-3
        if any(part.name == "temperature" for part in problem.constraints):
            balance = lf.equilibrium(disk, state, lf.Lu2023())
            lost += PENALTY * max(0.0, float(balance.temperature) / 330.0 - 1.0)
        return -float(gain) + lost if np.isfinite(gain) else 1e3

    return loss


def compiled_loss(function, scale):
    """The same from this package's compiled function."""

    def loss(point):
        scores = function.scores_of_many(point[None])[0]
        if not np.isfinite(scores).all():
            return 1e3
        return -scores[0] / scale + PENALTY * np.maximum(-scores[1:], 0.0).sum()

    return loss


def global_search(loss, sides, target):
    """SciPy's differential evolution until it has the value; its time and evaluations."""
    seen = []

    def counted(point):
        seen.append(loss(point))
        return seen[-1]

    start = time.perf_counter()
    differential_evolution(
        counted,
        [(0.0, 1.0)] * sides,
        rng=0,
        tol=0.0,
        polish=False,
        maxiter=300,
        callback=lambda intermediate_result: intermediate_result.fun <= target,
    )
    reached = min(seen) <= target
    return time.perf_counter() - start, len(seen), reached


def optimiser(repeats):
    """The optimiser beside SciPy's differential evolution to the same value, 1e-6 short of it."""
    print("\noptimum by gradients beside SciPy's differential evolution to within 1e-6 of it")
    print(f"{'':42}{'ours [ms]':>10}{'plain [ms]':>12}{'ratio':>8}{'compiled':>10}{'ratio':>8}")
    for label, section in PROBLEMS.items():
        problem = as_problem(DESIGN, None, None, **section)
        function = ObjectiveFunction(problem)
        best = find_optimum(function)  # compiles
        scale = abs(best.value)
        target = -problem.objectives[0].sign * best.value / scale + 1e-6
        sides = len(problem.bounds)
        plain, compiled = plain_loss(problem, scale), compiled_loss(function, scale)
        middle = np.full(sides, 0.5)
        plain(middle), compiled(middle)
        times = {"ours": [], "compiled": []}
        for _ in range(repeats):
            times["ours"].append(timed(lambda function=function: find_optimum(function))[0])
            times["compiled"].append(global_search(compiled, sides, target)[0])
        slow, _, reached = global_search(plain, sides, target)
        ours, fast = (statistics.median(times[name]) for name in ("ours", "compiled"))
        print(
            f"{label:42}{1e3 * ours:10.1f}{1e3 * slow:12.0f}{slow / ours:8.0f}"
            f"{1e3 * fast:10.0f}{fast / ours:8.1f}{'' if reached else '  (not reached)'}"
        )
    print("plain: of the package's functions as one writes it; compiled: of the optimiser's own")


def large(folder):
    """10⁸ designs in a process of its own."""
    command = [sys.executable, __file__, "--alone", str(folder)]
    start = time.perf_counter()
    found = subprocess.run(command, capture_output=True, check=True, text=True).stdout
    print(
        f"\n{LARGE:,} designs: {time.perf_counter() - start:.0f} s, peak memory {found.strip()} MB"
    )


def alone(folder):
    sweep_into(study(LARGE), folder / "large.zarr")
    # not resource.getrusage: a child inherits its parent's peak there
    status = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
    print(int(status["VmHWM"].split()[0]) // 1024)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--designs", type=int, default=10_000_000)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--large", action="store_true")
    parser.add_argument("--folder", type=Path, help="where results go; default: a temporary one")
    parser.add_argument(
        "--only", choices=["few", "kernel", "cluster", "optimiser"], help="one part"
    )
    parser.add_argument("--alone", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--thread", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.alone:
        alone(options.alone)
        return
    if options.thread:
        thread(options.thread, options.designs)
        return
    with tempfile.TemporaryDirectory(dir=options.folder) as name:
        folder = Path(name)
        parts = {
            "few": few,
            "kernel": lambda: throughput(folder, options.designs, options.repeats),
            "cluster": lambda: cluster(folder, options.designs, options.repeats),
            "optimiser": lambda: optimiser(options.repeats),
        }
        for part, measure in parts.items():
            if options.only in (None, part):
                measure()
        if options.large:
            large(folder)


if __name__ == "__main__":
    main()
