"""Computing the chunks of a sweep: in threads of this process, or on a Dask cluster."""

import asyncio
import ctypes
import itertools
import logging
import os
import pickle
from collections.abc import Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path
from threading import Thread
from typing import Any, NamedTuple, Protocol

from lightflyer.array.namespace import has_jax, load_jax
from lightflyer.compute.evaluation import Chunks
from lightflyer.compute.store import Record, stored_study, versions, write_chunk
from lightflyer.core.errors import ConfigurationError, LightflyerError
from lightflyer.core.extras import dumps, extra

ANSWER_WITHIN = 10.0  # Time within which a scheduler must answer [s]

VERSIONS_WITHIN = 60.0
"""Time within which its workers must import this package and report its version [s]."""

_AHEAD = 3  # chunks handed out per thread of a worker: one computed, one written, one waiting
_RETRIES = 3
_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3  # of mallopt, in malloc.h
_KEPT = 2**25  # bytes: the largest that glibc takes
_XLA_THREADS = "PJRT_NPROC"  # in the environment; read when JAX starts


class AbstractTask(Protocol):
    """Numbered parts of work, each computed here or on a worker of a cluster."""

    def __call__(self, number: int, /) -> Any:
        """Do a part in this process; what comes of it."""

    def remotely(self, number: int, /) -> Any:
        """Do a part on a worker; what goes to the client."""

    def receive(self, answer: Any, /) -> Any:
        """What came of a part, from what a worker sent."""


class Task(NamedTuple):
    """Chunks to compute, and where to write them."""

    evaluator: Any  # Outputs, and number of failures, of the designs from a number up to another
    folder: Path  # Folder of the store
    chunks: Chunks
    token: str  # Token of the store

    def __call__(self, chunk: int) -> "Done":
        """Compute a chunk and write it."""
        outputs, failures = self.evaluator(*self.chunks.span(chunk))
        return chunk, write_chunk(self.folder, self.chunks, chunk, outputs), failures

    def remotely(self, chunk: int) -> "tuple[Done, Any]":
        """On a worker: write the chunk if the folder is visible, else send its outputs back."""
        import distributed

        outputs, failures = self.evaluator(*self.chunks.span(chunk))
        with suppress(OSError, ValueError):
            if stored_study(self.folder)["token"] == self.token:
                distributed.secede()  # the worker computes the next while this one is written
                record = write_chunk(self.folder, self.chunks, chunk, outputs)
                return (chunk, record, failures), None
        return (chunk, {}, failures), outputs

    def receive(self, answer: "tuple[Done, Any]") -> "Done":
        """Write the outputs that a worker could not write."""
        (chunk, record, failures), outputs = answer
        if outputs is not None:
            record = write_chunk(self.folder, self.chunks, chunk, outputs)
        return chunk, record, failures


Done = tuple[int, Record, int]
"""Number of a chunk, checksums of its files, number of designs that have not converged."""


def processors() -> int:
    """Number of processors that this process may use, as far as the system says."""
    if hasattr(os, "sched_getaffinity"):  # on Linux
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def run_here(
    task: AbstractTask, missing: Sequence[int], workers: int | None = None
) -> Iterator[Any]:
    """Do work in threads of this process, yielding its parts as they are done."""
    count = workers or processors() + 2
    waiting = iter(missing)
    pool = ThreadPoolExecutor(min(count, max(len(missing), 1)))
    running: set[Future[Any]] = set()
    try:
        for number in waiting:
            running.add(pool.submit(task, number))
            if len(running) >= count:
                done, running = wait(running, return_when=FIRST_COMPLETED)
                yield from (future.result() for future in done)
        while running:
            done, running = wait(running, return_when=FIRST_COMPLETED)
            yield from (future.result() for future in done)
    finally:
        pool.shutdown(cancel_futures=True)


@cache
def _settle_in() -> None:
    """Prepare a worker's process for computing, before its first chunk."""
    import distributed

    # Dask starts its workers with ``MALLOC_TRIM_THRESHOLD_``. Having any value there, glibc gives
    # every larger array back to the system at once and pages it in anew for the next, which costs
    # more than half of the arithmetic. Other allocators have no ``mallopt`` and no such habit.
    with suppress(OSError, AttributeError):
        libc = ctypes.CDLL(None)
        libc.mallopt(_M_MMAP_THRESHOLD, _KEPT)
        libc.mallopt(_M_TRIM_THRESHOLD, _KEPT)
    if has_jax() and _XLA_THREADS not in os.environ:
        # By itself JAX takes as many threads as there are processors and cuts each operation into
        # as many parts. But the others have workers of their own, and whole operations cost less.
        os.environ[_XLA_THREADS] = str(distributed.get_worker().state.nthreads)
        try:
            load_jax().devices()
        finally:
            os.environ.pop(_XLA_THREADS, None)


def _remotely(task: AbstractTask, number: int) -> Any:
    """On a worker: do a part of the work."""
    _settle_in()
    return task.remotely(number)


def run_on_dask(
    task: AbstractTask, missing: Sequence[int], client: Any, address: str
) -> Iterator[Any]:
    """Do work on an existing Dask cluster, yielding its parts as they are done."""
    # The parts of a worker that is lost go to another.
    import distributed

    with _naming_loss(address):
        threads = max(sum(client.nthreads().values()), 1)
        # made by a task and not scattered: it can be made again when its worker is lost
        shared = client.submit(pickle.loads, dumps(task), pure=False)
        waiting = iter(missing)

        def submit(number: int) -> Any:
            return client.submit(_remotely, shared, number, pure=False, retries=_RETRIES)

        first = [submit(chunk) for chunk in itertools.islice(waiting, _AHEAD * threads)]
        queue = distributed.as_completed(first, loop=client.loop, with_results=True)
        for _, answer in queue:
            if isinstance(answer, Exception):  # not raised where the scheduler is lost
                raise answer
            for more in itertools.islice(waiting, 1):
                queue.add(submit(more))
            yield task.receive(answer)


@contextmanager
def _naming_loss(address: str) -> Iterator[None]:
    """Say in one line that a cluster was lost."""
    import distributed

    try:
        yield
    except (distributed.KilledWorker, distributed.CancelledError, OSError) as error:
        if isinstance(error, OSError) and error.errno is not None:
            raise  # of the disk
        raise LightflyerError(
            f"the cluster at {address} was lost ({type(error).__name__}); complete chunks are kept "
            "and the same command continues"
        ) from None


@contextmanager
def connect_client(address: str) -> Iterator[Any]:
    """A client of an existing Dask scheduler whose workers can do the work."""
    distributed = extra("distributed", "--scheduler", "sweep")
    try:
        from distributed.comm.core import connect

        async def greet() -> None:
            comm = await connect(address, timeout=ANSWER_WITHIN)
            comm.abort()

        async def greet_in_time() -> None:
            await asyncio.wait_for(greet(), ANSWER_WITHIN)

        # in a thread of its own: this one may have a running loop, as in a notebook
        with ThreadPoolExecutor(1) as pool:
            pool.submit(lambda: asyncio.run(greet_in_time())).result()
        client = distributed.Client(address, timeout=ANSWER_WITHIN, set_as_default=False)
    except Exception as error:  # whatever else listens there may answer anything
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ConfigurationError(
            f"--scheduler {address}: no answer within {ANSWER_WITHIN:g} s ({reason}); start one "
            "with 'dask scheduler', or leave the option out to compute here"
        ) from None
    log = logging.getLogger("distributed.client")
    level = log.level
    log.setLevel(logging.CRITICAL)  # what is lost is said in one line
    try:
        with _naming_loss(address):
            _check_workers(client, address)
        yield client
    finally:
        with suppress(Exception):  # a cluster that was lost needs no farewell
            client.close(timeout=ANSWER_WITHIN)
        log.setLevel(level)


def _check_workers(client: Any, address: str) -> None:
    """Raise unless there are workers, with the same packages as here."""
    import distributed

    try:
        client.wait_for_workers(1, timeout=ANSWER_WITHIN)
    except (TimeoutError, distributed.TimeoutError):
        raise ConfigurationError(
            f"--scheduler {address}: has no workers; start some with 'dask worker {address}'"
        ) from None
    answer: Future[dict[str, Any]] = Future()

    def ask() -> None:
        try:
            answer.set_result(client.run(versions, on_error="return"))
        except Exception as error:  # raised again where the answer is awaited
            answer.set_exception(error)

    # a call that a worker never answers cannot be ended, only left behind
    Thread(target=ask, daemon=True).start()
    try:
        found = answer.result(VERSIONS_WITHIN)
    except TimeoutError:
        raise ConfigurationError(
            f"--scheduler {address}: a worker has not reported its versions within "
            f"{VERSIONS_WITHIN:g} s; stop workers that hang or start others"
        ) from None
    here = versions()
    for worker, there in found.items():
        if isinstance(there, OSError):
            continue  # lost since it was asked; another takes its place
        if isinstance(there, Exception):
            raise ConfigurationError(f"--scheduler {address}: worker {worker} failed: {there}")
        if there != here:
            raise ConfigurationError(
                f"--scheduler {address}: worker {worker} has {there}, this process has {here}; "
                "results would differ"
            )
