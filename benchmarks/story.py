"""Time and memory against the number of designs, peers beside it: the figure of docs/benchmarks.md.

    python benchmarks/story.py [--most 10000000]  # measures, writes story.json, draws
    python benchmarks/story.py --draw                  # draws what was measured

Processor time, as the machine may be busy: that of all threads of the process, for a function that
ran once before. Memory is the peak of a process of its own. Beside the heat balances of solver.py:
SciPy on the equations of numpy_model.py, and the same compiled by numba; and a sweep to Zarr. Lines
go on, dashed, where nothing was measured: proportional to the largest number that was.
"""

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import jax
import numpy as np
from solver import (
    TAC,
    designs,
    package_temperatures,
    peer_problem,
    scipy_scalar,
    scipy_vectorised,
)

HERE = Path(__file__).parent
RESULT, FIGURE = HERE / "story.json", HERE.parent / "docs" / "images" / "speed.png"
LABELS = {
    "package": "lightflyer",
    "numba": "numba, compiled loop",
    "find_root": "SciPy find_root",
    "brentq": "SciPy brentq",
    "zarr": "sweep to Zarr",
    "solve": "heat balances",
}
MOST = {"package": 10**7, "numba": 10**6, "find_root": 10**6, "brentq": 1000,
        "zarr": 10**7}  # fmt: skip
LIFTED = {"find_root": 6, "numba": -1, "zarr": -6, "package": -12}  # names at line ends [points]
TARGET = 10**9  # designs to which lines go on
TOLERANCE = 1e-12  # of the absorbed power, as the package's


def by_numba(values):
    """Temperatures by the compiled loop."""
    import numba_model

    _, hottest, (cold, pressure, radius, emittance, absorbed) = peer_problem(values)
    return numba_model.temperatures(
        absorbed, cold, hottest, pressure, radius, TAC, emittance, TOLERANCE
    )


SOLVERS = {
    "package": package_temperatures,
    "numba": by_numba,
    "find_root": scipy_vectorised,
    "brentq": lambda values: scipy_scalar(values, len(values["radius"])),
}


def measured(function):
    """Processor time of a function, from as many calls as take a twentieth of a second."""
    jax.block_until_ready(function())
    calls, start = 0, time.process_time()
    while calls == 0 or time.process_time() - start < 0.05:
        jax.block_until_ready(function())
        calls += 1
    return (time.process_time() - start) / calls


def sweep_once(count, folder):
    """A sweep with four outputs, in a folder."""
    from sweep import study

    from lightflyer.compute.evaluation import Evaluator
    from lightflyer.parametric.run import sweep_into

    asked = study(count)
    evaluate = Evaluator(asked)
    evaluate(0, 1)  # compiles
    start = time.process_time()
    sweep_into(asked, folder / "r.zarr", evaluator=evaluate)
    return time.process_time() - start


def alone(kind, count):
    """Time and peak memory of one task in this process."""
    if kind == "solve":
        values = designs(count)
        start = time.process_time()
        package_temperatures(values)
        seconds = time.process_time() - start
    else:
        with tempfile.TemporaryDirectory() as name:
            seconds = sweep_once(count, Path(name))
    status = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
    print(json.dumps([seconds, int(status["VmHWM"].split()[0]) / 1024]))


def in_a_process(kind, count):
    """The same in a process of its own."""
    command = [sys.executable, __file__, "--alone", kind, str(count)]
    return json.loads(subprocess.run(command, capture_output=True, check=True, text=True).stdout)


def powers(first, most):
    """Powers of ten from one to another, and the other."""
    found = [10**n for n in range(first, 12) if 10**n <= most]
    return found if found[-1] == most else [*found, most]


def measure(most):
    """All that the figure shows."""
    times = {name: {} for name in LABELS if name != "solve"}
    memory = {name: {} for name in ("solve", "zarr")}
    for name, function in SOLVERS.items():
        for count in powers(0, min(MOST[name], most)):
            values = designs(count)
            times[name][count] = measured(lambda f=function, v=values: f(v))
        print(name, times[name], flush=True)
    for count in powers(5, min(MOST["zarr"], most)):
        times["zarr"][count], memory["zarr"][count] = in_a_process("zarr", count)
    print("zarr", times["zarr"], memory["zarr"], flush=True)
    for count in powers(3, min(MOST["package"], most)):
        memory["solve"][count] = in_a_process("solve", count)[1]
    machine = f"{platform.machine()}, {len(os.sched_getaffinity(0))} processors"
    return {"machine": machine, "times": times, "memory": memory}


def agree():
    """Print how far the contenders' temperatures differ; raise if they do."""
    values = designs(1000)
    ours = np.asarray(package_temperatures(values))
    for name, function in SOLVERS.items():
        worst = np.max(np.abs(np.asarray(function(values)) / ours - 1.0))
        print(f"largest difference of temperature, {name}: {worst:.1e}")
        assert worst < 1e-9, name


def show(found):
    """Print times a design, and ratios, at the largest number that each took."""
    print(f"processor time at the largest number measured ({found['machine']})")
    last = {name: list(series.items())[-1] for name, series in found["times"].items()}
    for name, (count, seconds) in last.items():
        base = last["package" if name in SOLVERS else "zarr"]
        each, its = seconds / int(count), base[1] / int(base[0])
        print(f"{LABELS[name]:26}{int(count):>12,} designs {1e9 * each:10.0f} ns each"
              f"{each / its:10.2f}")  # fmt: skip
    print("ratios: heat balances to lightflyer's, sweeps to the one to Zarr")


def draw(found):
    """Time of heat balances, and of a sweep."""
    from lightflyer.files.drawing import new_figure, save

    figure = new_figure()
    (ax,) = figure.axes
    for name in (*SOLVERS, "zarr"):
        counts = np.array([int(count) for count in found["times"][name]], float)
        values = np.array(list(found["times"][name].values()))
        (line,) = ax.loglog(counts, values, "o-", ms=4)
        on = np.array([counts[-1], TARGET])
        further = values[-1] * on / on[0]
        ax.loglog(on, further, "--", lw=1, color=line.get_color())
        ax.annotate(
            LABELS[name],
            (TARGET, further[-1]),
            (6, LIFTED.get(name, 0)),
            textcoords="offset points",
            va="center",
            color=line.get_color(),
        )
    ax.set(xlabel="designs", ylabel="processor time [s]")
    ax.grid(alpha=0.25)
    save(figure, [FIGURE])
    print(f"wrote {FIGURE.relative_to(HERE.parent)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--most", type=int, default=10**7)
    parser.add_argument("--draw", action="store_true")
    parser.add_argument("--alone", nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.alone:
        alone(options.alone[0], int(options.alone[1]))
        return
    if not options.draw:
        agree()
        RESULT.write_text(json.dumps(measure(options.most), indent=1) + "\n", encoding="utf-8")
    found = json.loads(RESULT.read_text(encoding="utf-8"))
    show(found)
    draw(found)


if __name__ == "__main__":
    main()
