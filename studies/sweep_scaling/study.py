"""How long a reduced sweep takes on how many processors: measured parts, and what they add up to.

    python studies/sweep_scaling/study.py [--blocks 600]

Measured: the processor time of a chunk with the model and with what is kept of it; the processor
time of client and scheduler for a block, by handing out blocks that cost nothing but send what real
ones send; and whole sweeps on this machine. From these follow the times for up to 10¹² designs.
Writes results.csv and scaling.png beside this file.
"""

import argparse
import csv
import logging
import os
import sys
import tempfile
import time
from pathlib import Path

import distributed
import numpy as np

from lightflyer.compute.evaluation import Evaluator
from lightflyer.compute.scheduler import connect_client, run_on_dask
from lightflyer.files.drawing import new_figure
from lightflyer.parametric.reduced import Blocks, Progress, pack, reduce_into
from lightflyer.parametric.reduction_plan import Designs, plan_reductions

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parents[1] / "benchmarks"))
from sweep import study  # noqa: E402

CHUNKS, MEASURED = 4, (10**5, 10**6, 10**7)
SIZES = 10.0 ** np.arange(5, 12.5, 0.25)
WORKERS = (2, 32, 1000, 10_000)


class Sent:
    """A block that costs nothing, and sends what a real one sends."""

    def __init__(self, content):
        self.content = content

    def remotely(self, block):
        """The same for every block."""
        return block, self.content, 0

    def receive(self, answer):
        """The same."""
        return answer


def of_a_chunk(asked):
    """Processor time of a chunk's outputs, and of what is kept of it."""
    evaluate, kept, blocks = Evaluator(asked), plan_reductions(asked), Blocks.of(asked)
    outputs, _ = evaluate(0, blocks.chunk)  # compiles
    for part in kept:
        part.partial(Designs(asked, 0, outputs, np.arange(blocks.chunk)))  # imports
    start = time.process_time()
    for chunk in range(CHUNKS):
        outputs, _ = evaluate(chunk * blocks.chunk, (chunk + 1) * blocks.chunk)
    computed = time.process_time()
    for _ in range(CHUNKS):
        seen = Designs(asked, 0, outputs, np.arange(blocks.chunk))
        partials = {part.name: part.partial(seen) for part in kept}
        for part in kept:
            part.reduction.merge(part.reduction.empty(), partials[part.name])
    reduced = time.process_time()
    content = pack(partials)
    return (computed - start) / CHUNKS, (reduced - computed) / CHUNKS, content, blocks.chunk


def of_a_block(asked, content, count):
    """Processor time of client, and of scheduler and idle workers, for a block."""
    with tempfile.TemporaryDirectory() as name:
        cluster = distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, dashboard_address=None, local_directory=name,
            silence_logs=logging.CRITICAL,
        )  # fmt: skip
        with cluster, connect_client(cluster.scheduler_address) as client:
            progress = Progress(Path(name), plan_reductions(asked), count, {})
            list(run_on_dask(Sent(content), range(20), client, "here"))
            # the scheduler lives in this process; its workers do not
            start, wall = time.process_time(), time.perf_counter()
            for block, sent, failures in run_on_dask(Sent(content), range(count), client, "here"):
                progress.add(block, sent, failures, np.inf)
            return (time.process_time() - start) / count, (time.perf_counter() - wall) / count


def whole(designs):
    """Processor time of a whole reduced sweep in this process, compiled before; its file's size."""
    asked = study(designs)
    evaluate = Evaluator(asked)
    evaluate(0, 1)
    with tempfile.TemporaryDirectory() as name:
        start = time.process_time()
        reduce_into(asked, Path(name) / "r.nc", evaluator=evaluate)
        return time.process_time() - start, (Path(name) / "r.nc").stat().st_size


def predicted(size, workers, of_chunk, of_block, chunk):
    """Time of a sweep: of the workers, or of the client where it is the slower [s]."""
    chunks = np.ceil(size / chunk)
    blocks = np.minimum(chunks, np.ceil(chunks / np.ceil(chunks / 10_000)))
    return np.maximum(np.ceil(blocks / workers) * (chunks / blocks) * of_chunk, blocks * of_block)


def main():
    """Measure, write the table, draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--blocks", type=int, default=600)
    options = parser.parse_args()
    asked = study(10**7)
    computed, reduced, content, chunk = of_a_chunk(asked)
    of_client, by_clock = of_a_block(asked, content, options.blocks)
    times = {designs: whole(designs) for designs in MEASURED}
    rows = [
        ("outputs of a chunk, CPU [s]", computed),
        ("what is kept of a chunk, CPU [s]", reduced),
        ("designs in a chunk", chunk),
        ("client and scheduler for a block, CPU [s]", of_client),
        ("a block by the clock, two workers that only send [s]", by_clock),
        ("what a block sends [bytes]", len(content)),
        *((f"{designs:.0e} designs here, CPU [s]", found[0]) for designs, found in times.items()),
        *((f"{designs:.0e} designs, file [bytes]", found[1]) for designs, found in times.items()),
        *((f"1e12 designs on {workers} workers, from these [s]",
           float(predicted(1e12, workers, computed + reduced, of_client, chunk)))
          for workers in WORKERS),
    ]  # fmt: skip
    with (HERE / "results.csv").open("w", newline="") as file:
        csv.writer(file).writerows([("what", "value"), *((k, f"{v:.4g}") for k, v in rows)])
    for label, value in rows:
        print(f"{label:58}{value:12.4g}")
    draw(times, computed + reduced, of_client, chunk)


def draw(times, of_chunk, of_client, chunk):
    """Time against designs, from the measured parts; processor time as two would share it."""
    figure = new_figure(width=5.6)
    ax = figure.axes[0]
    for workers in WORKERS:
        line = predicted(SIZES, workers, of_chunk, of_client, chunk)
        ax.loglog(SIZES, line, label=f"{workers:,} processors, from measured parts")
    halves = [0.5 * found[0] for found in times.values()]
    ax.loglog(list(times), halves, "ko", label="measured processor time, half of it")
    ax.set_xlabel("designs")
    ax.set_ylabel("time by the clock [s]")
    for seconds, label in ((60, "minute"), (3600, "hour"), (86400, "day")):
        ax.axhline(seconds, color="0.8", lw=0.8, zorder=0)
        ax.text(SIZES[0], seconds * 1.1, label, color="0.4", fontsize="small")
    ax.legend(fontsize="small")
    figure.savefig(HERE / "scaling.png", dpi=150)


if __name__ == "__main__":
    os.environ.setdefault("NUMBA_NUM_THREADS", "1")
    main()
