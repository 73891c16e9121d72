"""Sweeps that are killed, damaged, interrupted or run by a cluster have the same results."""

import errno
import gc
import inspect
import json
import os
import signal
import subprocess
import sys
import threading
import time
import warnings
from pathlib import Path
from typing import ClassVar

import cloudpickle
import distributed
import jax
import jax.numpy as jnp
import numpy as np
import pytest
import xarray as xr

import lightflyer as lf
from lightflyer.compute import scheduler, store
from lightflyer.config.designs import as_design
from lightflyer.core.quantity import Coefficient
from lightflyer.parametric.run import sweep_into
from lightflyer.study.study import make_study

from . import killed_sweeps

KILLS_HERE, KILLS_OF_WORKERS = 20, 2
SCRIPT = Path(killed_sweeps.__file__)
VARIABLES = ["temperature", "lift", "relative_payload", "levitation_irradiance"]


ENTRIES = {
    "flyer.diameter": np.geomspace(0.005, 0.05, 40),
    "altitude": np.linspace(60e3, 90e3, 25),
}


@pytest.fixture
def study(design):
    return make_study(design, ENTRIES, VARIABLES)


class StandIn:
    """In place of the model: numbers that depend on the design only."""

    def __init__(self, fail_at=None, with_error=None):
        self.asked = []
        self.fail_at, self.error = fail_at, with_error

    def __call__(self, start, stop):
        self.asked.append(start)
        if start == self.fail_at:
            raise self.error
        designs = np.arange(start, stop)
        return {name: np.sin(designs + n) for n, name in enumerate(VARIABLES)}, 0


def contents(folder, names=VARIABLES):
    """Bytes of all files of the outputs."""
    return {
        path.relative_to(folder): path.read_bytes()
        for name in names
        for path in (folder / name).rglob("*")
        if path.is_file()
    }


@pytest.mark.slow
def test_twenty_kills_change_no_bit(tmp_path):
    command = [sys.executable, str(SCRIPT), str(tmp_path), str(KILLS_HERE), "20261121"]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120)
    report = json.loads(done.stdout)
    assert report["killed"] == KILLS_HERE
    assert report["found"] > 0
    undisturbed = contents(tmp_path / "undisturbed.zarr", ["lift", "payload"])
    assert contents(tmp_path / "killed.zarr", ["lift", "payload"]) == undisturbed
    # at most the chunks in flight, two threads' and two handed out, are ever computed again
    chunks = len(undisturbed) // 2 - 1  # two outputs, and the description of each
    evaluations = (tmp_path / "evaluations").read_bytes().count(b"\n")
    assert chunks <= evaluations <= chunks + 4 * KILLS_HERE


def test_a_finished_sweep_is_recognised_and_a_torn_line_of_the_journal_costs_a_chunk(
    study, tmp_path
):
    folder, stand_in = tmp_path / "results.zarr", StandIn()
    sweep_into(study, folder, chunk=100, evaluator=stand_in)
    assert len(stand_in.asked) == 10
    journal = folder / ".lightflyer" / "journal"
    for cut, found in ((0, 1000), (5, 900)):
        whole = journal.read_bytes()
        journal.write_bytes(whole[: len(whole) - cut])
        report = sweep_into(study, folder, chunk=100, evaluator=stand_in)
        assert (report.found, report.computed, report.damaged) == (found, 1000 - found, 0)
    damaged = folder / "lift/c/0/0"
    damaged.write_bytes(damaged.read_bytes()[:-1] + b"0")
    with xr.open_zarr(folder, chunks=None) as dataset, pytest.raises(ValueError, match="checksum"):
        dataset.lift.load()  # whoever reads it is told too
    assert sweep_into(study, folder, chunk=100, evaluator=stand_in).damaged == 1


def test_a_full_disk_keeps_what_is_whole(study, tmp_path, monkeypatch):
    folder, whole = tmp_path / "results.zarr", os.fsync
    written = []

    def full(file):
        written.append(file)
        if len(written) > 30:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        whole(file)

    monkeypatch.setattr(store.os, "fsync", full)
    with pytest.raises(lf.OutputError, match=r"No space left on device.*continues"):
        sweep_into(study, folder, chunk=100, evaluator=StandIn(), workers=1)
    monkeypatch.undo()
    assert not list(folder.rglob("*.partial"))
    report = sweep_into(study, folder, chunk=100, evaluator=StandIn())
    assert 0 < report.found < 1000
    assert report.found + report.computed == 1000
    undisturbed = tmp_path / "undisturbed.zarr"
    sweep_into(study, undisturbed, chunk=100, evaluator=StandIn())
    assert contents(folder) == contents(undisturbed)


def test_an_error_in_a_chunk_keeps_the_others(study, tmp_path):
    broken = StandIn(fail_at=700, with_error=lf.ConvergenceError("not converged"))
    with pytest.raises(lf.ConvergenceError):
        sweep_into(study, tmp_path / "r.zarr", chunk=100, evaluator=broken, workers=1)
    assert sweep_into(study, tmp_path / "r.zarr", evaluator=StandIn()).found >= 500


def test_a_store_whose_making_was_cut_off_is_made_again(study, tmp_path, monkeypatch):
    folder = tmp_path / "results.zarr"
    (folder / ".lightflyer").mkdir(parents=True)
    (folder / "lift").mkdir()
    (folder / "lift" / "zarr.json").write_text("{")
    assert sweep_into(study, folder, evaluator=StandIn()).computed == 1000
    monkeypatch.setattr(store, "_write_group", lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        sweep_into(study, tmp_path / "other.zarr", evaluator=StandIn())
    assert not (tmp_path / "other.zarr").exists()


def test_files_beside_a_store_that_was_cut_off_are_left_alone(study, tmp_path):
    (tmp_path / ".lightflyer").mkdir()
    (tmp_path / "thesis.tex").write_text("all of it")
    with pytest.raises(lf.OutputError, match="among other files"):
        sweep_into(study, tmp_path, evaluator=StandIn())
    assert (tmp_path / "thesis.tex").read_text() == "all of it"


def test_only_one_process_writes(study, tmp_path):
    inside, go_on = threading.Event(), threading.Event()

    def slow(start, stop):
        inside.set()
        assert go_on.wait(20)
        return StandIn()(start, stop)

    folder = tmp_path / "results.zarr"
    first = threading.Thread(target=sweep_into, args=(study, folder), kwargs={"evaluator": slow})
    first.start()
    assert inside.wait(20)
    with pytest.raises(lf.OutputError, match="another process is writing"):
        sweep_into(study, folder, evaluator=StandIn())
    go_on.set()
    first.join(20)
    assert sweep_into(study, folder, evaluator=StandIn()).found == 1000


def test_another_study_in_the_folder_is_refused_with_the_difference(
    flyer, study, tmp_path, monkeypatch
):
    folder = tmp_path / "results.zarr"
    sweep_into(study, folder, evaluator=StandIn())
    entries = ENTRIES | {"flyer.diameter": np.geomspace(0.005, 0.05, 41)}
    with pytest.raises(
        lf.OutputError, match=r"another study[^$]*flyer.diameter: 40 values.* there"
    ):
        sweep_into(make_study(study.design, entries, VARIABLES), folder)
    film = flyer.film.model_copy(update={"tac_top": lf.Measured(0.81)})
    changed = flyer.model_copy(update={"film": film}).design()
    with pytest.raises(lf.OutputError, match=r"film.tac_top: \[0.8, null\] there, \[0.81.* now"):
        sweep_into(make_study(changed, ENTRIES, VARIABLES), folder)
    now = lf.__version__
    monkeypatch.setattr(lf, "__version__", "99.0")
    with pytest.raises(lf.OutputError, match=f"lightflyer: {now} there, 99.0 now"):
        sweep_into(study, folder)


class Plate(lf.Disk):
    """A script's own flyer."""

    def describe(self):
        return "plate"


class Push(lf.FreeMolecular):
    """A script's own force model."""

    flyers: ClassVar[tuple[type[lf.AbstractFlyer], ...]] = (Plate,)
    strength: Coefficient = 0.1

    def force(self, flyer, state, unknowns):
        return self.strength * flyer.area * state.pressure * unknowns[0]


@pytest.fixture
def own_study(film):
    setup = lf.Setup(Plate(film, 0.01), lf.lu2023_earth(), Push())
    entries = {"flyer.radius": np.linspace(0.01, 0.02, 30), "altitude": np.linspace(60e3, 70e3, 20)}
    return make_study(as_design(setup), entries, ["lift", "temperature"])


def test_other_code_of_ones_own_class_is_another_study(own_study, tmp_path, monkeypatch):
    folder = tmp_path / "results.zarr"
    sweep_into(own_study, folder, evaluator=StandIn())
    source = inspect.getsource
    monkeypatch.setattr(
        inspect, "getsource", lambda kind: source(kind).replace("* unknowns", "/ unknowns")
    )
    with pytest.raises(lf.OutputError, match=r"code of .*Push: sha256"):
        sweep_into(own_study, folder)


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """Two worker processes that are started again when they die."""
    folder = tmp_path_factory.mktemp("cluster")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=":0", local_directory=folder
    ) as found:
        yield found
    _close_lost_sockets()


@pytest.fixture(scope="module", autouse=True)
def garbage_of_other_modules():
    """What other tests compiled is not searched for lost sockets: it takes seconds each time."""
    gc.freeze()
    yield
    _close_lost_sockets()
    gc.unfreeze()


@pytest.fixture(autouse=True)
def lost_sockets():
    """Sockets to killed processes end with their test, not as a warning in another."""
    yield
    _close_lost_sockets()


def _close_lost_sockets():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)
        gc.collect()


def kill_workers(cluster, stop, killed):
    """Kill a worker now and then, until told to stop."""
    chance = np.random.default_rng(7)
    while not stop.wait(chance.uniform(0.1, 0.3)) and len(killed) < KILLS_OF_WORKERS:
        nanny = cluster.workers[len(killed) % 2]
        if nanny.pid is not None and nanny.status == distributed.Status.running:
            os.kill(nanny.pid, signal.SIGKILL)
            killed.append(nanny.pid)


@pytest.mark.slow
def test_kills_of_a_client_and_of_workers_change_no_bit(cluster, tmp_path):
    address, journal = cluster.scheduler_address, tmp_path / "killed.zarr/.lightflyer/journal"
    client = subprocess.Popen([sys.executable, str(SCRIPT), str(tmp_path), address])
    while not journal.exists() or not journal.stat().st_size:
        assert client.poll() is None
        time.sleep(0.02)
    client.kill()
    assert client.wait() == -signal.SIGKILL
    stop, killed = threading.Event(), []
    killer = threading.Thread(target=kill_workers, args=(cluster, stop, killed))
    killer.start()
    cloudpickle.register_pickle_by_value(killed_sweeps)
    killed_sweeps.run_on(address, tmp_path)
    stop.set()
    killer.join()
    assert len(killed) == KILLS_OF_WORKERS
    designs = np.arange(15_000)
    with xr.open_zarr(tmp_path / "killed.zarr", chunks=None) as dataset:
        assert dataset.attrs["complete"]
        np.testing.assert_array_equal(dataset.lift.values.ravel(), np.sin(designs))
        np.testing.assert_array_equal(dataset.payload.values.ravel(), np.cos(designs) / 3.0)


def parallel_operations():
    """How many operations, of one that is worth it, JAX cuts into parts for several threads."""
    own = os.getpid()  # or a program that a worker compiled for one thread may be found again
    compiled = jax.jit(lambda x: jnp.sin(own + jnp.exp(x))).lower(jnp.ones(1_000_000)).compile()
    return compiled.as_text().count("outer_dimension_partitions")


def test_a_cluster_gives_the_same_bits(cluster, study, tmp_path):
    """With workers of one thread each, beside threads on all processors."""
    here, there = tmp_path / "here.zarr", tmp_path / "there.zarr"
    sweep_into(study, here, chunk=100)
    report = sweep_into(study, there, chunk=100, scheduler=cluster.scheduler_address)
    assert report.computed == 1000
    assert contents(here) == contents(there)
    cloudpickle.register_pickle_by_value(sys.modules[__name__])
    with distributed.Client(cluster.scheduler_address, set_as_default=False) as client:
        assert set(client.run(parallel_operations).values()) == {0}
        assert set(client.run(os.environ.get, "PJRT_NPROC").values()) == {None}
    assert scheduler.processors() == 1 or parallel_operations() > 0


def test_a_cluster_computes_flyers_of_a_scripts_own_classes(cluster, own_study, tmp_path):
    here, there = tmp_path / "here.zarr", tmp_path / "there.zarr"
    sweep_into(own_study, here, chunk=100)
    cloudpickle.register_pickle_by_value(sys.modules[__name__])
    report = sweep_into(own_study, there, chunk=100, scheduler=cluster.scheduler_address)
    assert report.computed == 600
    assert contents(here, ["lift"]) == contents(there, ["lift"])


def test_a_worker_that_hangs_is_not_waited_for(cluster, study, tmp_path, monkeypatch):
    monkeypatch.setattr(scheduler, "VERSIONS_WITHIN", 1.0)
    pid = cluster.workers[0].pid
    os.kill(pid, signal.SIGSTOP)
    try:
        with pytest.raises(lf.ConfigurationError, match="has not reported its versions within 1 s"):
            sweep_into(study, tmp_path / "x.zarr", scheduler=cluster.scheduler_address)
    finally:
        os.kill(pid, signal.SIGCONT)
    assert not (tmp_path / "x.zarr").exists()


def test_results_come_back_where_workers_do_not_see_the_folder(cluster, study, tmp_path):
    folder, here = tmp_path / "results.zarr", tmp_path / "here.zarr"
    cloudpickle.register_pickle_by_value(sys.modules[__name__])
    with store.open_store(folder, study, 100) as opened:
        task = scheduler.Task(StandIn(), folder, opened.chunks, "the token of another store")
        with scheduler.connect_client(cluster.scheduler_address) as client:
            for done in scheduler.run_on_dask(task, opened.missing, client, "here"):
                opened.commit(*done)
    sweep_into(study, here, chunk=100, evaluator=StandIn())
    assert contents(folder) == contents(here)


class Patient:
    """Parts of work that take a while; sweeps, reductions and spreads are run as it is."""

    def remotely(self, number):
        time.sleep(0.1)
        return number

    __call__ = receive = remotely


SCHEDULER = """
import time
from distributed import LocalCluster
one = {"n_workers": 1, "threads_per_worker": 1, "processes": False, "dashboard_address": None}
print(LocalCluster(protocol="tcp", **one).scheduler_address, flush=True)
time.sleep(120)
"""


@pytest.mark.slow
def test_scheduler_that_dies_is_one_line(capfd):
    with subprocess.Popen([sys.executable, "-c", SCHEDULER], stdout=subprocess.PIPE, text=True) as (
        process
    ):
        address, task = process.stdout.readline().strip(), Patient()
        cloudpickle.register_pickle_by_value(sys.modules[__name__])
        with scheduler.connect_client(address) as client:
            done = scheduler.run_on_dask(task, range(1000), client, address)
            assert next(done) in range(1000)
            process.kill()
            with pytest.raises(lf.LightflyerError, match=r"was lost .*the same command continues"):
                list(done)
    assert "Traceback" not in capfd.readouterr().err
