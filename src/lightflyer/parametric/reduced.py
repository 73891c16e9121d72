"""Sweeps of which only the best designs, fronts and distributions are kept.

The designs are divided into blocks. Whoever computes a block merges what is kept of its chunks and
sends that. Here the blocks' parts are merged and, now and then, saved beside the result with a note
of which blocks are in it. As merging gives the same bits in any order, so does a sweep that was
killed and continued. It loses what was computed since it was saved last.
"""

import io
import json
import math
import os
import shutil
import time
import zipfile
import zlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.compute.chunks import CHUNK
from lightflyer.compute.devices import find_devices
from lightflyer.compute.evaluation import Evaluator
from lightflyer.compute.scheduler import connect_client, run_here, run_on_dask
from lightflyer.compute.store import require_same, versions, write_atomically
from lightflyer.config.designs import as_design
from lightflyer.core.errors import ConfigurationError, OutputError
from lightflyer.core.progress import Counted
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.force.base import AbstractForceModel
from lightflyer.parametric.reduced_tree import to_datatree
from lightflyer.parametric.reducers import (
    CHUNK_ON_GPU,
    DeviceReducer,
    Partials,
    Reducer,
    merge,
)
from lightflyer.parametric.reduction_plan import ReductionSpec, plan_reductions, samples_of
from lightflyer.parametric.run import SweepReport
from lightflyer.study.distributions import SAMPLES
from lightflyer.study.sections import ReduceSection, SamplingSection, from_arguments
from lightflyer.study.study import Study, make_study

if TYPE_CHECKING:
    import xarray as xr

MOST_BLOCKS = 10_000  # Blocks of the largest study: a scheduler hands out some hundred a second

SAVE_EVERY = 2.0
"""Time after which what is merged is saved [s]; Ctrl-C ends the process without saving."""

_SUFFIX = ".nc"
_UNFINISHED, _STATE, _LOCK = ".unfinished", "state.npz", "lock"
_DONE, _FAILURES, _DESCRIPTION = "done", "failures", "description"

_DAMAGES = (zipfile.BadZipFile, zlib.error, ValueError, LookupError, EOFError, OSError,
            NotImplementedError)  # fmt: skip
"""What reading a damaged archive raises."""


@dataclass(frozen=True)
class Blocks:
    """Division of the designs of a study into blocks of whole designs and those into chunks."""

    size: int  # Designs, samples counted
    chunk: int  # Designs computed at once
    length: int  # Designs of a block but the last

    @classmethod
    def of(cls, study: Study, most_in_chunk: int = CHUNK) -> "Blocks":
        """Chunks near the asked size, and no more blocks than :data:`MOST_BLOCKS`."""
        samples = max(samples_of(study), 1)
        chunk = samples * max(most_in_chunk // samples, 1)
        return cls(study.size, chunk, chunk * math.ceil(study.size / (chunk * MOST_BLOCKS)))

    def __len__(self) -> int:
        return math.ceil(self.size / self.length)

    def count(self, block: int) -> int:
        return min(self.size - block * self.length, self.length)

    def chunks(self, block: int) -> Iterator[tuple[int, int]]:
        """First design of each chunk of a block, and the one after its last."""
        start, stop = block * self.length, block * self.length + self.count(block)
        for first in range(start, stop, self.chunk):
            yield first, min(first + self.chunk, stop)


@dataclass(frozen=True)
class BlockTask:
    """Computes blocks and what is kept of them."""

    study: Study
    reducer: Any  # What is kept, and number of failures, of the designs from a number up to another
    blocks: Blocks

    def __call__(self, block: int) -> tuple[int, bytes, int]:
        """Number of the block, what is kept of it, and how many designs have not converged."""
        kept = plan_reductions(self.study)
        partials = {part.name: part.reduction.empty() for part in kept}
        failures = 0
        for start, stop in self.blocks.chunks(block):
            found, failed = self.reducer(start, stop)
            failures += failed
            merge(kept, partials, found)
        return block, pack(partials), failures

    remotely = __call__

    def receive(self, answer: tuple[int, bytes, int]) -> tuple[int, bytes, int]:
        """The same."""
        return answer


def pack(partials: Partials, **more: Any) -> bytes:
    """Partials, and whatever else, compressed: most cells of a distribution are empty."""
    stream = io.BytesIO()
    flat = {
        f"{name}/{key}": array for name, part in partials.items() for key, array in part.items()
    }
    np.savez_compressed(stream, **flat, **more)
    return stream.getvalue()


def unpack(content: bytes) -> tuple[Partials, dict[str, np.ndarray]]:
    """Partials, and whatever else, from :func:`pack`."""
    partials: Partials = {}
    more = {}
    with np.load(io.BytesIO(content)) as arrays:
        for name, array in arrays.items():
            part, slash, key = name.rpartition("/")
            if slash:
                partials.setdefault(part, {})[key] = array
            else:
                more[name] = array
    return partials, more


def _names(partials: Partials) -> set[tuple[str, str]]:
    return {(name, key) for name, part in partials.items() for key in part}


class Progress:
    """What is merged so far, in memory and in a file."""

    def __init__(
        self, folder: Path, kept: list[ReductionSpec], count: int, description: dict[str, str]
    ):
        self._path, self._kept, self._description = folder / _STATE, kept, description
        self.partials: Partials = {part.name: part.reduction.empty() for part in kept}
        self.done = np.zeros(count, bool)
        self.failures = 0
        self._saved = time.monotonic()
        if self._path.exists():
            self._continue()

    def _continue(self) -> None:
        damaged = OutputError(
            f"{self._path}: is damaged; remove {self._path.parent} to start again"
        )
        try:
            partials, more = unpack(self._path.read_bytes())
            description = json.loads(str(more[_DESCRIPTION]))
            done, failures = more[_DONE], int(more[_FAILURES])
        except _DAMAGES:
            raise damaged from None
        require_same(self._path.parent, description, self._description)
        if _names(partials) != _names(self.partials) or done.shape != self.done.shape:
            raise damaged
        self.partials, self.done, self.failures = partials, done, failures

    def add(self, block: int, content: bytes, failures: int, save_every: float) -> None:
        """Merge what is kept of a block, and save when it is time."""
        merge(self._kept, self.partials, unpack(content)[0])
        self.done[block] = True
        self.failures += failures
        if time.monotonic() - self._saved >= save_every:
            self.save()

    def save(self) -> None:
        """Write what is merged to the disk."""
        more = {
            _DONE: self.done,
            _FAILURES: np.asarray(self.failures),
            _DESCRIPTION: np.asarray(json.dumps(self._description)),
        }
        write_atomically(self._path, pack(self.partials, **more))
        self._saved = time.monotonic()


def reduce_into(
    study: Study,
    path: str | Path,
    *,
    scheduler: str | None = None,
    workers: int | None = None,
    chunk: int | None = None,
    device: str | None = None,
    evaluator: Any = None,
    save_every: float = SAVE_EVERY,
) -> SweepReport:
    """Compute a study and write what is kept of it into a file, or continue to do so."""
    if device and scheduler is None:
        find_devices(device)
    path, on_gpu = Path(path), device == "gpu" and evaluator is None
    blocks = Blocks.of(study, chunk or (CHUNK_ON_GPU if on_gpu else CHUNK))
    if path.suffix != _SUFFIX:
        raise OutputError(
            f"{path}: a reduced sweep is a NetCDF file; let its name end with {_SUFFIX}"
        )
    kept = plan_reductions(study)
    description = _describe(study, kept, blocks)
    start = time.perf_counter()
    with ExitStack() as stack:
        client = stack.enter_context(connect_client(scheduler)) if scheduler else None
        folder = stack.enter_context(_unfinished_report(path))
        if path.exists():
            return _finished_report(study, path, description)
        progress = Progress(folder, kept, len(blocks), description)
        missing = [int(block) for block in np.flatnonzero(~progress.done)]
        left = sum(map(blocks.count, missing))
        own = Evaluator(study, device) if evaluator is None else evaluator
        counted = Counted("computing designs", study.size, "designs", done=study.size - left)
        reducer: Any = DeviceReducer(study, "gpu") if on_gpu else Reducer(study, own)
        counts_itself = scheduler is None and evaluator is None
        if counts_itself:
            counting = reducer if on_gpu else own
            counting.counted = counted  # as its batches end: a block may take minutes
        task = BlockTask(study, reducer, blocks)
        found = (
            run_on_dask(task, missing, client, scheduler)
            if scheduler
            else run_here(task, missing, workers)
        )
        try:
            for block, content, failures in found:
                progress.add(block, content, failures, save_every)
                if not counts_itself:
                    counted.add(blocks.count(block))
        finally:
            progress.save()
        tree = to_datatree(study, own, kept, progress.partials, progress.failures)
        tree.attrs[_DESCRIPTION] = json.dumps(description)
        _write(tree, folder, path)
        return SweepReport(
            designs=study.size,
            found=study.size - left,
            damaged=0,
            computed=left,
            not_converged=progress.failures,
            seconds=time.perf_counter() - start,
        )


def sweep_reduced(
    what: Any,
    environment: AbstractEnvironment | None = None,
    model: AbstractForceModel | None = None,
    *,
    over: Mapping[str, Any],
    out: str | Path,
    outputs: str | Sequence[str] = ("relative_payload",),
    method: str = "sobol",
    points: int = SAMPLES,
    seed: int = 0,
    scheduler: str | None = None,
    device: str | None = None,
    best: str | Sequence[str] | None = None,
    designs: int | None = None,
    fronts: Sequence[tuple[str, str]] | None = None,
    distributions: str | Sequence[str] | None = None,
) -> "xr.DataTree":
    """The best designs, Pareto fronts and distributions of a sweep that is too large to keep.

    Parameters
    ----------
    what, environment, model, over, outputs, method, points, seed, scheduler, device
        As of :func:`lightflyer.sweep`.
    out : str or path
        NetCDF file. The same call continues an interrupted sweep.
    best : str or sequence of str, optional
        Outputs whose best designs are kept; by default the first of relative payload, payload,
        width of the band and lift over weight that is computed.
    designs : int, optional
        How many of each; by default 100.
    fronts : sequence of (str, str), optional
        An output, and what it is weighed against: another output or a varied number; by default the
        first of ``best`` against altitude, irradiance and temperature.
    distributions : str or sequence of str, optional
        Outputs whose quantiles and histograms are kept; by default all.

    Returns
    -------
    xarray.DataTree
        Groups ``best``, ``fronts`` and ``distributions``. Numbers of designs count the places along
        all dimensions but that of the samples. With samples, medians of the outputs decide; the
        distributions are those of all samples.

    Raises
    ------
    ConfigurationError
        If a number or an output does not exist or a value is not possible.
    OutputError
        If the file cannot be used.
    """
    asked = {"best": best, "designs": designs, "fronts": fronts, "distributions": distributions}
    study = make_study(
        as_design(what, environment, model),
        over,
        (outputs,) if isinstance(outputs, str) else tuple(outputs),
        from_arguments(SamplingSection, method=method, points=points, seed=seed),
        reduce=from_arguments(ReduceSection, **asked),
    )
    reduce_into(study, out, scheduler=scheduler, device=device)
    return open_reduced(out)


def _describe(study: Study, kept: list[ReductionSpec], blocks: Blocks) -> dict[str, str]:
    """All that decides the result, in words."""
    return (
        study.description()
        | {part.name: repr(part.reduction) for part in kept}
        | {"designs at once": str(blocks.chunk)}
        | versions()
    )


@contextmanager
def _unfinished_report(path: Path) -> Iterator[Path]:
    """The folder of an unfinished result, locked for one writer; removed once there is a result."""
    import filelock

    folder = path.with_name(path.name + _UNFINISHED)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with filelock.FileLock(folder / _LOCK).acquire(timeout=0):
            try:
                yield folder
            finally:
                if path.exists() or not (folder / _STATE).exists():
                    shutil.rmtree(folder, ignore_errors=True)
    except filelock.Timeout:
        raise OutputError(
            f"{path}: another process is writing to it; wait for it or choose another file"
        ) from None
    except OSError as error:
        if isinstance(error, OutputError):
            raise
        raise OutputError(
            f"{path}: cannot be written: {error.strerror or error}; what was saved is kept and the "
            "same command continues"
        ) from None


def _finished_report(study: Study, path: Path, description: dict[str, str]) -> SweepReport:
    attributes = open_reduced(path).attrs
    require_same(path, json.loads(attributes[_DESCRIPTION]), description)
    return SweepReport(study.size, study.size, 0, 0, int(attributes["not_converged"]), 0.0)


def _write(tree: "xr.DataTree", folder: Path, path: Path) -> None:
    temporary = folder / path.name
    tree.to_netcdf(temporary, engine="h5netcdf")
    with temporary.open("rb") as file:
        os.fsync(file.fileno())
    os.replace(temporary, path)


def open_reduced(path: str | Path) -> "xr.DataTree":
    """What was kept of a sweep.

    Parameters
    ----------
    path : str or path
        NetCDF file of :func:`reduce_into`.

    Returns
    -------
    xarray.DataTree
        Groups ``best``, ``fronts`` and ``distributions``.

    Raises
    ------
    ConfigurationError
        If it is no such file.
    """
    import xarray as xr

    try:
        tree = xr.load_datatree(path, engine="h5netcdf")
    except (OSError, ValueError, KeyError) as error:
        raise ConfigurationError(f"{path}: cannot be read as NetCDF: {error}") from None
    if _DESCRIPTION not in tree.attrs:
        raise ConfigurationError(f"{path}: holds no reduced sweep")
    return tree
