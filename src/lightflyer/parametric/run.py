"""Sweeps: the outputs of all designs of a study, in memory or in a folder that keeps them.

Sweeps over labelled arrays may be larger than memory where Dask holds them.
"""

import math
import shutil
import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lightflyer.compute.evaluation import CHUNK, Chunks, Evaluator, Table, find_devices
from lightflyer.compute.scheduler import Task, connect_client, processors, run_here, run_on_dask
from lightflyer.compute.store import empty_dataset, open_store, require_extra
from lightflyer.config.designs import as_design
from lightflyer.core.checks import is_labelled
from lightflyer.core.errors import ConfigurationError, LightflyerError, ParameterWarning
from lightflyer.core.progress import Counted
from lightflyer.core.quantity import require_record
from lightflyer.design.design import AbstractDesign
from lightflyer.design.outputs import outputs_of
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.force.base import AbstractForceModel
from lightflyer.study.axes import SAMPLES, StudyAxis, require
from lightflyer.study.sections import SamplingSection, from_arguments
from lightflyer.study.study import Dimension, Study, assemble_study, read_entries

if TYPE_CHECKING:
    import xarray as xr

LARGEST = 10**9  # Number of designs above which a sweep must be confirmed

_BYTES = 8  # of a number
_GIGABYTE = 1e9
_NUMBERS_BESIDE = 2  # of each design, beside what varies and its outputs: its number, and a spare


def sweep_labelled(
    design: AbstractDesign, entries: Mapping[str, Any], outputs: tuple[str, ...]
) -> "xr.Dataset":
    """Outputs over arrays that broadcast by the names of their dimensions."""
    import xarray as xr

    arrays: dict[str, xr.DataArray] = {}
    for name, entry in entries.items():
        if is_labelled(entry):
            array = design.field(name).quantity.number(name, entry)
            arrays[name] = array if is_labelled(array) else xr.DataArray(array)
        elif not isinstance(entry, StudyAxis):
            raise ConfigurationError(f"{name}: a distribution cannot be combined with DataArrays")
        elif entry.single:
            arrays[name] = xr.DataArray(float(entry.values[0]))
        else:
            arrays[name] = xr.DataArray(entry.values, dims=[name], coords={name: entry.values})

    def evaluate(*columns: np.ndarray) -> Any:
        """Outputs of a block of designs, one for each element of the broadcast columns."""
        columns = np.broadcast_arrays(*columns)
        values = {name: np.ravel(column) for name, column in zip(arrays, columns, strict=True)}
        for name, column in values.items():
            require(design.field(name), column)
        study = Study(design, (Dimension("design", values),), {}, outputs)
        results: Table = dict.fromkeys(outputs, columns[0])
        if columns[0].size:
            results, _ = Evaluator(study)(0, study.size)
        found = tuple(results[name].reshape(columns[0].shape) for name in outputs)
        return found if len(found) > 1 else found[0]  # xarray takes a tuple for several outputs

    found = xr.apply_ufunc(
        evaluate,
        *arrays.values(),
        output_core_dims=[[] for _ in outputs],
        dask="parallelized",
        output_dtypes=[float] * len(outputs),
    )
    columns = found if isinstance(found, tuple) else (found,)
    dataset = xr.Dataset(dict(zip(outputs, columns, strict=True)))
    known_outputs = outputs_of(design.setup)
    for output in outputs:
        dataset[output].attrs = known_outputs[output].attributes
    dataset = dataset.assign_coords(arrays)
    for name, array in arrays.items():
        dataset[name].attrs = array.attrs | design.field(name).attributes
    return dataset


@dataclass(frozen=True)
class SweepReport:
    """What a sweep into a folder did."""

    designs: int  # Designs of the study
    found: int  # Designs that were already computed
    damaged: int  # Chunks that were computed before and had to be again
    computed: int  # Designs computed now
    not_converged: int  # Designs of the study whose results are NaN because a root-find failed
    seconds: float  # From the first chunk to the last


def sweep_into(
    study: Study,
    folder: str | Path,
    *,
    scheduler: str | None = None,
    workers: int | None = None,
    chunk: int = CHUNK,
    device: str | None = None,
    evaluator: Callable[[int, int], Any] | None = None,
) -> SweepReport:
    """Compute a study into a folder, or the part of it that is missing there."""
    folder = Path(folder)
    if device and scheduler is None:
        find_devices(device)
    with ExitStack() as stack:
        # first, so that no folder is made for a scheduler that does not answer
        client = stack.enter_context(connect_client(scheduler)) if scheduler else None
        store = stack.enter_context(open_store(folder, study, chunk))
        missing, chunks = store.missing, store.chunks
        left = sum(_length(chunks, number) for number in missing)
        start, computed = time.perf_counter(), 0
        if missing:
            own = Evaluator(study, device) if evaluator is None else None
            counted = Counted("computing designs", study.size, "designs", done=study.size - left)
            counts_itself = scheduler is None and own is not None
            if scheduler is None and own is not None:
                own.counted = counted  # as its batches end, long before the first chunk
            task = Task(evaluator or own, folder.resolve(), chunks, store.token)
            results = (
                run_on_dask(task, missing, client, scheduler)
                if scheduler
                else run_here(task, missing, workers)
            )
            for number, record, failures in results:
                store.commit(number, record, failures)
                computed += _length(chunks, number)
                if not counts_itself:
                    counted.add(_length(chunks, number))
        if store.missing:
            raise LightflyerError(
                f"{folder}: {len(store.missing)} chunks were not computed; the same command "
                "continues"
            )
        store.finish()
        return SweepReport(
            designs=study.size,
            found=study.size - left,
            damaged=len(store.damaged),
            computed=computed,
            not_converged=store.failures,
            seconds=time.perf_counter() - start,
        )


def _length(chunks: Chunks, number: int) -> int:
    start, stop = chunks.span(number)
    return stop - start


def sweep(
    what: Any,
    environment: AbstractEnvironment | None = None,
    model: AbstractForceModel | None = None,
    *,
    over: Mapping[str, Any],
    outputs: str | Sequence[str] = ("relative_payload",),
    method: str = "sobol",
    points: int = SAMPLES,
    seed: int = 0,
    out: str | Path | None = None,
    scheduler: str | None = None,
    device: str | None = None,
) -> "xr.Dataset":
    """Outputs of a flyer over every combination of some of its numbers.

    Parameters
    ----------
    what : AbstractFlyer, Setup, FlyerFile, path or AbstractDesign
        What is varied.
    environment, model : optional
        Where ``what`` is a flyer.
    over : dict of str to object
        Values of each number by its name: as in the flyer file (``"flyer.diameter"``), for objects
        as their attributes (``"flyer.radius"``, ``"force.c_fm"``); and ``"altitude"``, or whatever
        the environment's coordinate is. Values are texts with units, lists of them, ranges
        ``{"from": "1 cm", "to": "5 cm", "points": 9}``, distributions
        ``{"distribution": "normal", "mean": ..., "standard_deviation": ...}``, lists of numbers and
        one-dimensional arrays in SI units (angles of a flyer file in degrees), or
        :class:`xarray.DataArray` of any dimensions in these units. Where one of these is backed
        by Dask, so is the result.
    outputs : str or sequence of str
        Names of the outputs.
    method, points, seed
        How distributions are drawn: ``"sobol"``, ``"latin-hypercube"`` or ``"random"``.
    out : str or path, optional
        Folder to compute into; the result then reads from there. The same call continues an
        interrupted sweep.
    scheduler : str, optional
        Address of a Dask scheduler that computes into ``out``.
    device : {"cpu", "gpu"}, optional
        Where to compute, on all of the kind; by default where JAX does. Results of a GPU differ
        from those of a processor by rounding.

    Returns
    -------
    xarray.Dataset
        With the varied numbers as coordinates, units on everything, and NaN where there is no such
        number: no irradiance that levitates the flyer, no band.

    Raises
    ------
    ConfigurationError
        If a number or an output does not exist or a value is not possible.
    ParameterError
        If the model is not for the flyer or the gas.
    OutputError
        If the folder cannot be used.

    Examples
    --------
    >>> import lightflyer as lf
    >>> film = lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, tac_top=0.8, tac_bottom=0.9)
    >>> table = lf.sweep(
    ...     lf.Disk(film, radius=0.01), lf.lu2023_earth(), lf.Lu2023(),
    ...     over={"altitude": ["68 km", "72 km"]}, outputs="lift_over_weight",
    ... )
    >>> [round(float(value), 3) for value in table.lift_over_weight]
    [0.995, 1.59]
    """
    design = as_design(what, environment, model)
    names = (outputs,) if isinstance(outputs, str) else tuple(outputs)
    require_record("over", (Mapping,), over)
    entries = read_entries(design, {name: _plain(entry) for name, entry in over.items()}, names)
    if any(hasattr(entry, "dims") for entry in entries.values()):
        if out is not None or scheduler is not None:
            raise ConfigurationError("out and scheduler take ranges and lists, not DataArrays")

        return sweep_labelled(design, entries, names)
    sampling = from_arguments(SamplingSection, method=method, points=points, seed=seed)
    study = assemble_study(design, entries, names, sampling)
    if out is not None:
        sweep_into(study, out, scheduler=scheduler, device=device)
        return open_sweep(out)
    if scheduler is not None:
        raise ConfigurationError("a scheduler computes into a folder; give out as well")
    return in_memory(study, device)


def _plain(entry: Any) -> Any:
    """A list of numbers as an array, which has no unit; in a file it would be refused."""
    plain = type(entry) in (list, tuple) and all(type(one) in (int, float) for one in entry)
    return np.asarray(entry, float) if plain and entry else entry


def in_memory(study: Study, device: str | None = None) -> "xr.Dataset":
    """The outputs of a study as a dataset in memory."""
    numbers = len(study.outputs) + len(study.fields) + _NUMBERS_BESIDE
    need = study.size * numbers * _BYTES
    told = f"{study.size:.3g} designs need about {need / _GIGABYTE:.3g} GB of memory"
    instead = "a folder takes them (out)"
    free = _free_memory()
    if need > free:
        raise ConfigurationError(f"{told}, of which {free / _GIGABYTE:.3g} GB are free; {instead}")
    if need > _GIGABYTE:
        warnings.warn(f"{told}; {instead}", ParameterWarning, stacklevel=3)
    results, failures = Evaluator(study, device)(0, study.size)
    dataset = empty_dataset(study)
    dims = [dimension.name for dimension in study.dimensions]
    for name, output in study.known_outputs.items():
        dataset[name] = (dims, results[name].reshape(study.shape), output.attributes)
    dataset.attrs |= {"complete": True, "not_converged": failures}
    return dataset


def _free_memory() -> float:
    """Memory that this process can still take [bytes]; infinite where no system says."""
    try:
        facts = Path("/proc/meminfo").read_text(encoding="ascii")
        return 1024.0 * int(facts.partition("MemAvailable:")[2].split()[0])
    except (OSError, LookupError, ValueError):
        return math.inf


def open_sweep(folder: str | Path) -> "xr.Dataset":
    """The results of a sweep in a folder, read when they are used.

    Parameters
    ----------
    folder : str or path

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    ConfigurationError
        If there is none, or a part of it was lost since it was written: when it is opened, or when
        the damaged part is read.
    """
    require_extra()
    from lightflyer.compute.reading import read_store

    return read_store(Path(folder))


@dataclass(frozen=True)
class Estimate:
    """Time and space that a study needs."""

    designs: int  # Number of designs, and space on the disk [bytes]
    size: int
    seconds: float  # Time on this machine [s]
    free: int  # Free space on the disk [bytes]


def estimate(study: Study, folder: str | Path) -> Estimate:
    """Time and space that a study needs, from a few of its designs."""
    existing = Path(folder).resolve()
    while not existing.exists():
        existing = existing.parent
    evaluate = Evaluator(study)
    few = min(study.size, evaluate.batch)
    evaluate(0, few)  # compiles
    start = time.perf_counter()
    evaluate(0, few)
    rate = few / (time.perf_counter() - start)
    return Estimate(
        designs=study.size,
        size=study.size * len(study.outputs) * _BYTES,
        seconds=study.size / (rate * processors()),
        free=shutil.disk_usage(existing).free,
    )
