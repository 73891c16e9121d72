"""Compiled programs that a later process finds without tracing them anew.

JAX keeps what it compiled where a folder is named for it, but finds it only after it has traced
and lowered the function, which for a prediction takes longer than running it a hundred times. Here
a program is found by what it is made from: the function, the static part of its arguments, the
shapes of the rest, every file of this package, and the versions of JAX and NumPy. A program is
kept only where all of that can be named: a function defined within another, or a class from
somewhere else, is traced as usual.
"""

import hashlib
import os
import pickle
import pickletools
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple

import jax
import numpy as np
from jax.experimental import serialize_executable

from lightflyer.foundation.files import output_directory

LARGEST = 500_000_000
"""Size of all kept programs together [bytes]; those unused for longest go first."""

_FOLDER = "whole"  # within JAX's own
_KNOWN = {"builtins", "collections", "copyreg", "equinox", "jax", "jaxlib", "lightflyer", "numpy"}
_NAMES_PROTOCOL = 2  # the newest in which a pickle names each class in one piece


class _Number(NamedTuple):
    """What stands for a number in the description of a program."""

    shape: tuple[int, ...]
    kind: str


class KeptProgram:
    """A function compiled for one structure and one set of shapes, kept for later processes.

    Parameters
    ----------
    function : callable
        Pure function of pytrees of numbers and arrays.
    compile_flat : callable
        Compiles a function of a list of arrays for such a list.
    """

    def __init__(self, function: Callable[..., Any], compile_flat: Callable[..., Any]):
        self._function = function
        self._compile_flat = compile_flat
        self._loaded: dict[Any, tuple[Any, Any] | None] = {}

    def find(self, args: tuple[Any, ...]) -> Callable[[], Any] | None:
        """The program for some arguments, read or compiled and written.

        Parameters
        ----------
        args : tuple of pytrees
            Concrete, double precision.

        Returns
        -------
        callable or None
            Runs it; None where such programs cannot be kept, or no folder is named.
        """
        folder = jax.config.jax_compilation_cache_dir  # type: ignore[attr-defined]
        if not folder:
            return None
        leaves, structure = jax.tree.flatten(args)
        numbers = tuple(_Number(leaf.shape, leaf.dtype.str) for leaf in leaves)
        place = folder, structure, numbers
        if place not in self._loaded:
            self._loaded[place] = self._obtain(Path(folder) / _FOLDER, args, numbers)
        found = self._loaded[place]
        if found is None:
            return None
        program, outline = found
        return lambda: jax.tree.unflatten(jax.tree.structure(outline), program(leaves))

    def _obtain(
        self, folder: Path, args: tuple[Any, ...], numbers: tuple[_Number, ...]
    ) -> tuple[Any, Any] | None:
        key = _key(self._function, args, numbers)
        if key is None:
            return None
        path = folder / f"{key}.program"
        return _read(path) or self._compile(path, args)

    def _compile(self, path: Path, args: tuple[Any, ...]) -> tuple[Any, Any] | None:
        leaves, structure = jax.tree.flatten(args)
        outlines: list[Any] = []

        def flat(leaves: list[Any]) -> list[Any]:
            results, form = jax.tree.flatten(self._function(*jax.tree.unflatten(structure, leaves)))
            outlines.append(jax.tree.unflatten(form, range(len(results))))
            return results

        with _not_kept_by_jax():  # which cannot write anew what it has read itself
            program = self._compile_flat(flat, leaves)
        with suppress(Exception):  # what cannot be written is compiled anew next time
            content = pickle.dumps((*serialize_executable.serialize(program), outlines[-1]))
            _require_same(program(leaves), _load(content)[0](leaves))
            with output_directory(path.parent) as stage:
                stage(path.name).write_bytes(content)
            _make_room(path.parent)
        return program, outlines[-1]


def _read(path: Path) -> tuple[Any, Any] | None:
    """A kept program, or None where there is none that runs here."""
    with suppress(Exception):  # a damaged file, or one of another build of JAX: compiled anew
        found = _load(path.read_bytes())
        os.utime(path)  # used now
        return found
    return None


def _load(content: bytes) -> tuple[Any, Any]:
    *program, outline = pickle.loads(content)
    return serialize_executable.deserialize_and_load(*program), outline


def _require_same(one: list[Any], other: list[Any]) -> None:
    for mine, its in zip(one, other, strict=True):
        np.testing.assert_array_equal(np.asarray(mine), np.asarray(its))


@contextmanager
def _not_kept_by_jax() -> Iterator[None]:
    before = jax.config.jax_persistent_cache_min_compile_time_secs  # type: ignore[attr-defined]
    jax.config.update("jax_persistent_cache_min_compile_time_secs", np.inf)
    try:
        yield
    finally:
        jax.config.update("jax_persistent_cache_min_compile_time_secs", before)


def _key(
    function: Callable[..., Any], args: tuple[Any, ...], numbers: tuple[_Number, ...]
) -> str | None:
    """Name of the program, or None where it depends on code that has no name or is not known."""
    form = jax.tree.unflatten(jax.tree.structure(args), numbers)
    try:
        description = pickle.dumps(form, protocol=_NAMES_PROTOCOL)
    except (pickle.PicklingError, AttributeError, TypeError):
        return None
    modules = {function.__module__, *_modules(description)}
    if "<" in function.__qualname__ or {name.split(".")[0] for name in modules} - _KNOWN:
        return None
    name = f"{function.__module__}.{function.__qualname__}".encode()
    return hashlib.sha256(name + description + _versions()).hexdigest()


def _modules(description: bytes) -> Iterator[str]:
    """Where the classes and functions come from that a pickle names."""
    for operation, argument, _ in pickletools.genops(description):
        if operation.name == "GLOBAL":
            yield str(argument).split(" ")[0]


@cache
def _versions() -> bytes:
    """What the same description depends on beside itself."""
    package = Path(str(resources.files("lightflyer")))
    files = [
        (str(path.relative_to(package)), path.stat().st_mtime_ns, path.stat().st_size)
        for path in sorted(package.rglob("*"))
        if path.suffix not in ("", ".pyc")
    ]
    settings = os.environ.get("XLA_FLAGS", ""), jax.default_backend(), jax.device_count()
    return repr((jax.__version__, np.__version__, settings, files)).encode()


def _make_room(folder: Path) -> None:
    """Remove the programs unused for longest until the rest is small enough."""
    facts = [(path.stat(), path) for path in folder.glob("*.program")]
    total = sum(fact.st_size for fact, _ in facts)
    for fact, path in sorted(facts, key=lambda entry: entry[0].st_mtime):
        if total <= LARGEST:
            break
        path.unlink(missing_ok=True)
        total -= fact.st_size
