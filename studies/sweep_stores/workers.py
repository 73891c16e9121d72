"""What Dask's own mechanisms do of what the sweep does on a cluster.

    python studies/sweep_stores/workers.py

Prints the processor time of one worker for 2·10⁶ designs with the package's settings of the
allocator, without them, and with those that Dask's plugin `Environ` can make; and whether
registering a plugin and asking for versions end while a worker hangs.
"""

import logging
import os
import shutil
import signal
import sys
import tempfile
import threading
import time
from pathlib import Path

import distributed
from distributed.diagnostics.plugin import Environ

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

DESIGNS, REPEATS, PATIENCE = 2_000_000, 4, 20.0
KEPT = {"MALLOC_TRIM_THRESHOLD_": "33554432", "MALLOC_MMAP_THRESHOLD_": "33554432"}


def without_settings():
    """On a worker: leave the allocator as Dask starts it."""
    from lightflyer.compute import scheduler

    scheduler._keep_freed_memory = lambda: None


def cluster(workers, folder):
    """Workers of one thread each."""
    return distributed.LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        dashboard_address=None,
        local_directory=folder,
        silence_logs=logging.CRITICAL,
    )


def processor_time(mode, folder):
    """Print the processor time of a worker with one setting of its allocator."""
    from sweep import study

    from lightflyer.parametric.run import sweep_into

    asked, times = study(DESIGNS), []
    with cluster(1, folder) as found, distributed.Client(found) as client:
        if mode == "Environ":
            client.register_plugin(Environ(KEPT))
        if mode != "package":
            client.run(without_settings)
        for _ in range(REPEATS):
            shutil.rmtree(folder / "r", ignore_errors=True)
            before = sum(client.run(time.process_time).values())
            sweep_into(asked, folder / "r", scheduler=found.scheduler_address)
            times.append(sum(client.run(time.process_time).values()) - before)
    shown = "  ".join(f"{value:.2f}" for value in times[1:])  # the first compiles
    print(f"allocator by {mode}: {shown} s of CPU for {DESIGNS:,} designs", flush=True)


class Plugin(distributed.WorkerPlugin):
    """Does nothing."""


def ends(function):
    """Whether a function ends, in words."""
    thread = threading.Thread(target=function, daemon=True)
    thread.start()
    thread.join(PATIENCE)
    return "does not end" if thread.is_alive() else "ends"


def with_a_worker_that_hangs(folder):
    """Print which calls end while one of two workers hangs."""
    with cluster(2, folder) as found, distributed.Client(found) as client:
        pid = found.workers[0].pid
        os.kill(pid, signal.SIGSTOP)
        try:
            plugin = ends(lambda: client.register_plugin(Plugin(), name="idle"))
            versions = ends(lambda: client.get_versions(packages=["jaxlib"]))
        finally:
            os.kill(pid, signal.SIGCONT)
        print(
            f"a worker hangs: register_plugin {plugin}, get_versions {versions} in {PATIENCE:g} s"
        )


if __name__ == "__main__":
    for asked in ("package", "nothing", "Environ"):
        with tempfile.TemporaryDirectory() as name:
            processor_time(asked, Path(name))
    with tempfile.TemporaryDirectory() as name:
        with_a_worker_that_hangs(Path(name))
