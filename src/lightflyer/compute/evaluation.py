"""Many designs at once, in chunks: a function of the varied numbers, by NumPy or compiled.

It is computed in batches, on this machine's processors or on its GPUs.
"""

import itertools
import math
import threading
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, Literal, get_args

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import by_jax, has_jax, load_jax, number
from lightflyer.core.entry_point import ROWS, written_for_jax
from lightflyer.core.errors import ConfigurationError, ParameterError, ParameterWarning
from lightflyer.core.extras import extra
from lightflyer.core.progress import Counted
from lightflyer.core.quantity import impossible_as_nan
from lightflyer.design.design import AbstractDesign
from lightflyer.design.tables import evaluate
from lightflyer.numerics.batches import in_batches
from lightflyer.study.study import Study

CHUNK = 2**18  # Designs in a chunk by default: 2 MB of each output

Device = Literal["cpu", "gpu"]  # Kinds of devices, by JAX's names

_AXIS = "designs"

BATCH = 16_384  # Designs evaluated at once: they fit the processor's cache, and one thread

BATCH_OVER_BAND = 128
"""Designs evaluated at once where each is searched over some hundred altitudes."""

FEW, FEW_OVER_BAND = 1_000_000, 10_000
"""Designs of a study that NumPy has evaluated before XLA has compiled; see
``benchmarks/sweep.py``."""

NUMPY_BATCH_OVER_BAND = 64  # Designs that NumPy searches at once: so are its arrays in the cache

BATCH_ON_GPU, BATCH_OVER_BAND_ON_GPU = 2**18, 2**12
"""The same of all GPUs together: a chunk, whose arrays fit the cache of an H100."""

MOST_PREPARED = 5_000
"""Most variants of a film of layers in one study: each takes a fraction of a second."""

_COMPILATION: dict[str, Any] = {
    "xla_backend_optimization_level": 3,
    "xla_cpu_use_fusion_emitters": True,
    "xla_cpu_opt_preset": "CPU_OPT_PRESET_DEFAULT",
}
"""XLA's own defaults, whatever its flags say: the last bits of a result must not depend on the
process that computes it. Less optimised, XLA joins products and sums into one rounding or not
according to which operations it compiles together, and that depends on the number of its threads.
"""

Table = dict[str, np.ndarray]


@dataclass(frozen=True)
class Chunks:
    """Equal blocks of a grid, each of which holds designs with consecutive numbers."""

    shape: tuple[int, ...]  # Shape of the grid
    block: tuple[int, ...]  # Shape of a chunk; the last along a dimension may reach beyond the grid

    @classmethod
    def of(cls, shape: tuple[int, ...], most: int = CHUNK) -> "Chunks":
        """Divide a grid into chunks of at most so many designs."""
        # Trailing dimensions stay whole, one is cut into even parts, leading ones are taken point
        # by point: so a chunk's designs have consecutive numbers.
        block: list[int] = []
        left = most
        for length in reversed(shape):
            parts = math.ceil(length / max(left, 1))
            block.insert(0, math.ceil(length / parts))
            left = left // length if parts == 1 else 1
        return cls(shape, tuple(block))

    @property
    def counts(self) -> tuple[int, ...]:
        """Number of chunks along each dimension."""
        return tuple(
            math.ceil(length / part) for length, part in zip(self.shape, self.block, strict=True)
        )

    def __len__(self) -> int:
        return math.prod(self.counts)

    def place(self, chunk: int) -> tuple[int, ...]:
        """Number of a chunk along each dimension."""
        place: list[int] = []
        for count in reversed(self.counts):
            chunk, rest = divmod(chunk, count)
            place.insert(0, rest)
        return tuple(place)

    def number(self, place: tuple[int, ...]) -> int:
        """Number of the chunk at a place."""
        number = 0
        for count, there in zip(self.counts, place, strict=True):
            number = number * count + there
        return number

    def part(self, chunk: int) -> tuple[slice, ...]:
        """A chunk's part of the grid."""
        return tuple(
            slice(number * part, min((number + 1) * part, length))
            for length, part, number in zip(self.shape, self.block, self.place(chunk), strict=True)
        )

    def span(self, chunk: int) -> tuple[int, int]:
        """First design of a chunk, and the one after its last."""
        start, size = 0, 1
        for length, part, row in zip(self.shape, self.block, self.place(chunk), strict=True):
            start = start * length + row * part
            size *= min(part, length - row * part)
        return start, start + size

    def extent(self, chunk: int) -> tuple[int, ...]:
        """Shape of a chunk's part of the grid."""
        return tuple(
            min(part, length - number * part)
            for length, part, number in zip(self.shape, self.block, self.place(chunk), strict=True)
        )


def find_devices(kind: str) -> list[Any]:
    """All devices of a kind that this process has."""
    if kind not in get_args(Device):
        raise ConfigurationError(f"device {kind}: is not one of {', '.join(get_args(Device))}")
    extra("jax", f"device {kind}", "jax")
    try:
        return load_jax().local_devices(backend=kind)
    except RuntimeError:
        raise ConfigurationError(
            f'device {kind}: JAX finds none here; for one of NVIDIA install "jax[cuda13]", else '
            "leave the device out"
        ) from None


class OnDevices:
    """Divides arrays over devices and computes each part where it lies."""

    # The parts do not wait for each other: a search ends on each device when its own designs have
    # converged. Float64 throughout.

    def __init__(self, kind: str):
        devices = find_devices(kind)
        self.count = len(devices)
        jax = load_jax()
        self._mesh = jax.sharding.Mesh(np.array(devices), (_AXIS,))
        self._each = jax.sharding.PartitionSpec(_AXIS)

    def divide_work(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """A function of arrays of designs that is computed part by part."""
        return load_jax().shard_map(
            function, mesh=self._mesh, in_specs=self._each, out_specs=self._each, check_vma=False
        )

    def place(self, arrays: Any) -> Any:
        """Arrays on the devices, a part on each; their length is a multiple of the devices'."""
        jax = load_jax()
        return jax.device_put(arrays, jax.sharding.NamedSharding(self._mesh, self._each))


def jit_with_options(function: Callable[..., Any], options: dict[str, Any]) -> Callable[..., Any]:
    """Like :func:`jax.jit`, with options of XLA where it knows them."""
    known = dict(options)
    jitted = load_jax().jit(function, compiler_options=known)

    def tolerant(*args: Any, **kwargs: Any) -> Any:
        nonlocal known, jitted
        while True:
            try:
                return jitted(*args, **kwargs)
            except load_jax().errors.JaxRuntimeError as error:
                unknown = {name for name in known if f"'{name}'" in str(error)}
                if "No such compile option" not in str(error) or not unknown:
                    raise
            known = {k: v for k, v in known.items() if k not in unknown}
            jitted = load_jax().jit(function, compiler_options=known or None)

    return tolerant


class Evaluator:
    """Computes the outputs of any of a study's designs."""

    # Designs are numbered in row-major order of the study's dimensions. The result of a design does
    # not depend on which others are computed with it: all of a study are computed in one way. Can
    # be pickled; it is compiled where it runs, once for all studies of equal designs with the same
    # outputs.

    counted: Counted | None = None
    """Counts the designs as they are computed, in this process."""

    def __init__(self, study: Study, device: str | None = None):
        self.study, self.device = study, device
        searched = any(output.over_band for output in study.known_outputs.values())
        self.batch = BATCH_OVER_BAND if searched else BATCH
        if device == "gpu":
            self.batch = BATCH_OVER_BAND_ON_GPU if searched else BATCH_ON_GPU
        few = study.size <= (FEW_OVER_BAND if searched else FEW)
        self._prepared, self._strides = _prepare(study)
        self.by_jax = device is not None or (not few and has_jax() and self._is_traceable())
        if not self.by_jax:
            self.batch = NUMPY_BATCH_OVER_BAND if searched else ROWS

    def __call__(self, start: int, stop: int) -> tuple[Table, int]:
        """Outputs of the designs from ``start`` up to ``stop``."""
        return self.at(np.arange(start, stop))

    def at(self, designs: np.ndarray) -> tuple[Table, int]:
        """Outputs of designs of any numbers; returns ``outputs`` (n,), ``failures``."""
        study, kernel = self.study, self._kernel() if self.by_jax else None

        def compute(designs: np.ndarray) -> tuple[Table, np.ndarray]:
            values, prepared = self.inputs(designs)
            if kernel is not None:
                found = kernel(values, prepared)
            else:
                found = evaluate_designs(
                    study.design, study.outputs, study.fixed | values, prepared
                )
            if self.counted is not None:
                self.counted.add(len(designs))
            return found

        if kernel is None:  # for which any length will do
            size = min(self.batch, len(designs))
        else:
            size = math.ceil(self.batch / kernel.parts) * kernel.parts
        outputs, converged = in_batches(compute, (designs,), size)
        failed = ~converged
        for values in outputs.values():
            values[failed | ~np.isfinite(values)] = np.nan
        return outputs, int(np.count_nonzero(failed))

    def _is_traceable(self) -> bool:
        """Whether JAX can trace the design: a class of the user's may be written in NumPy alone."""
        if tree.structure(self.study.design.setup).is_ours:
            return True
        first = self.inputs(np.zeros(1, int))
        try:
            with by_jax(), written_for_jax():
                one = tree.map_leaves(lambda column: column[0], first)
                load_jax().eval_shape(self.of_one, *one)
        except ParameterError:
            return False
        return True

    def _kernel(self) -> "_Kernel":
        study = self.study
        with _kernels_lock:  # or every thread would make one
            return _known_kernel(
                study.design, study.outputs, tuple(study.fixed.items()), self.device
            )

    def __getstate__(self) -> dict[str, Any]:
        # another process counts for itself
        return {name: value for name, value in vars(self).items() if name != "counted"}

    def inputs(self, designs: Any) -> tuple[dict[str, Any], Any]:
        """Varied numbers of some designs, and what is prepared for them; ``designs`` (n,)."""
        arrays = designs.__array_namespace__()  # NumPy's or JAX's
        places = self.study.places(designs)
        values = self.study.values_at(designs)
        if not values:
            # a study of one design still needs something to map over
            name, value = next(iter(self.study.fixed.items()))
            values = {name: arrays.full(designs.shape, value)}
        if self._prepared is None:
            return values, None
        number = arrays.zeros(designs.shape, int)
        for place, stride in zip(places, self._strides, strict=True):
            number = number + stride * place
        return values, tree.map_leaves(lambda leaf: arrays.asarray(leaf)[number], self._prepared)

    @property
    def of_one(self) -> Callable[[Any, Any], Any]:
        """Outputs of one design, and whether they have converged, from its part of inputs."""
        return _outputs_of_one(self.study.design, self.study.outputs, self.study.fixed)


def _outputs_of_one(
    design: AbstractDesign, names: tuple[str, ...], fixed: dict[str, float]
) -> Callable[[Any, Any], Any]:
    coordinate = design.coordinate_name

    def one(values: Any, prepared: Any) -> Any:
        given = fixed | values
        with impossible_as_nan():
            setup = design.build(given, prepared)
        return evaluate(setup, names, given.get(coordinate))

    return one


class _Kernel:
    """Outputs of many designs by XLA, compiled once for all threads of a process."""

    def __init__(
        self,
        design: AbstractDesign,
        names: tuple[str, ...],
        fixed: tuple[tuple[str, float], ...],
        device: str | None,
    ):
        self._devices = OnDevices(device) if device else None
        self.parts = self._devices.count if self._devices else 1  # Batches are of a multiple of it
        every = load_jax().vmap(_outputs_of_one(design, names, dict(fixed)))
        if self._devices:
            every = self._devices.divide_work(every)
        self._compiled = jit_with_options(every, {} if device == "gpu" else _COMPILATION)
        self._ready: set[Any] = set()
        self._lock = threading.Lock()

    def __call__(self, values: Table, prepared: Any) -> tuple[Table, np.ndarray]:
        shapes = {name: column.shape for name, column in values.items()}
        kind = tuple(shapes.items()), prepared is None
        if kind not in self._ready:
            with self._lock:  # or every thread would compile
                if kind not in self._ready:
                    found = self._run(values, prepared)
                    self._ready.add(kind)
                    return found
        return self._run(values, prepared)

    def _run(self, values: Table, prepared: Any) -> tuple[Table, np.ndarray]:
        with by_jax():
            if self._devices:
                values, prepared = self._devices.place((values, prepared))
            outputs, converged = self._compiled(values, prepared)
            return {name: np.asarray(column) for name, column in outputs.items()}, np.asarray(
                converged
            )


_kernels_lock = threading.Lock()
_known_kernel = lru_cache(maxsize=16)(_Kernel)


def evaluate_designs(
    design: AbstractDesign, names: Sequence[str], values: Mapping[str, Any], prepared: Any = None
) -> tuple[Table, np.ndarray]:
    """Outputs of many designs by NumPy, NaN for impossible ones, and whether they have converged.

    ``values``: (n,) by name, or one number for all; ``prepared``: what films of layers need.
    """
    count = max(map(np.size, values.values()))
    with impossible_as_nan(), warnings.catch_warnings():
        warnings.simplefilter("ignore", ParameterWarning)
        setup = tree.map_leaves(number, design.build(values, prepared))
        outputs, converged = evaluate(setup, names, values.get(design.coordinate_name))
    table = {name: np.array(np.broadcast_to(one, count)) for name, one in outputs.items()}
    return table, np.broadcast_to(converged, count)


def _prepare(study: Study) -> tuple[Any, list[int]]:
    """All different films of layers of a study, stacked, and the strides of their numbers."""
    design = study.design
    changing = [design.needs_recompute(list(dimension.values)) for dimension in study.dimensions]
    fixed = {name: study.fixed[name] for name in design.needs_recompute(list(study.fixed))}
    if not any(changing) and not fixed:
        return None, []
    lengths = [
        dimension.size if names else 1
        for dimension, names in zip(study.dimensions, changing, strict=True)
    ]
    total = int(np.prod(lengths))
    if total > MOST_PREPARED:
        raise ConfigurationError(
            f"the study has {total} different films of layers, each of which takes a fraction of "
            f"a second to compute; at most {MOST_PREPARED}"
        )
    found, counted = [], Counted("computing films of layers", total)
    for places in itertools.product(*map(range, lengths)):
        values = fixed | {
            name: float(dimension.values[name][place])
            for dimension, names, place in zip(study.dimensions, changing, places, strict=True)
            for name in names
        }
        found.append(design.precompute(values))
        counted.add()
    stacked = tree.map_leaves(
        lambda *leaves: np.stack([np.asarray(leaf) for leaf in leaves]), *found
    )
    strides = [
        int(np.prod(lengths[number + 1 :])) if length > 1 else 0
        for number, length in enumerate(lengths)
    ]
    return stacked, strides
