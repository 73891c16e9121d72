"""Programs that a later process reads in place of tracing them anew.

A program is found by what it is made from: the function, the static part of its arguments, the
patterns of the shapes of the rest, and the sources and data of this package. It is kept only where
all of that can be named: a function defined within another, or a class from somewhere else, is
traced anew in each process. A file holds data alone: reading one runs nothing.

Wheels bring the programs of the kinds of flyers that ``lightflyer init`` writes
(``.ci/keep_programs``).
"""

import hashlib
import inspect
import io
import json
import os
import pickle
import pickletools
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple

from lightflyer.core.cache import cache_folder, is_private, make_private
from lightflyer.program.program import Program
from lightflyer.program.structure import as_data

LARGEST = 100_000_000
"""Size of all kept programs together [bytes]; those unused for longest go first."""

_PACKAGE = Path(str(resources.files("lightflyer")))
_SHIPPED = _PACKAGE / "data" / "programs"
_SOURCES = {".py", ".csv", ".toml", ".txt"}
_PLAIN = (bool, int, float, str, type(None))
_KNOWN = {"builtins", "collections", "copyreg", "equinox", "jax", "jaxlib", "lightflyer", "numpy"}
_NAMES_PROTOCOL = 2  # the newest in which a pickle names each class in one piece


class Number(NamedTuple):
    """What stands for an array in the description of a program."""

    shape: tuple[Any, ...]
    kind: str


def find(function: Callable[..., Any], form: Any) -> tuple[Program, Any] | None:
    """A kept program, with the structure of what it returns as data."""
    key = _key(function, form)
    if key is None:
        return None
    with suppress(OSError, ValueError, KeyError, TypeError):
        return _read((_SHIPPED / f"{key}.program").read_bytes())
    path = _path(key)
    with suppress(OSError, ValueError, KeyError, TypeError):
        if path is not None and is_private(path.parent) and is_private(path):
            found = _read(path.read_bytes())
            os.utime(path)  # used now
            return found
    return None


def _read(content: bytes) -> tuple[Program, Any]:
    length = int.from_bytes(content[:4], "little")
    structure = json.loads(content[4 : 4 + length])
    return Program.from_bytes(content[4 + length :], salt=content[: 4 + length]), structure


def keep(function: Callable[..., Any], form: Any, program: Program, structure: Any) -> None:
    """Write a program where a later process finds it; what cannot be written is not kept."""
    key = _key(function, form)
    path = None if key is None else _path(key)
    if path is None:
        return
    with suppress(OSError, TypeError):
        text = json.dumps(as_data(structure)).encode()
        head = len(text).to_bytes(4, "little") + text
        if not make_private(path.parent):
            return
        stage = path.with_suffix(f".{os.getpid()}.new")
        stage.write_bytes(head + program.to_bytes(salt=head))
        stage.replace(path)
        _make_room(path.parent)


def _path(key: str) -> Path | None:
    where = cache_folder()
    return None if where is None else where / "programs" / f"{key}.program"


def _key(function: Callable[..., Any], form: Any) -> str | None:
    """Name of the program, or None where it depends on code that has no name or is not known."""
    if not _is_all_code(function):
        return None
    written = io.BytesIO()
    try:
        described = form, *_defaults(function)
        _Describer(written, protocol=_NAMES_PROTOCOL, fix_imports=False).dump(described)
    except (pickle.PicklingError, AttributeError, TypeError):
        return None
    description = written.getvalue()
    modules = {function.__module__, *_modules(description)}
    if {name.split(".")[0] for name in modules} - _KNOWN:
        return None
    name = f"{function.__module__}.{function.__qualname__}".encode()
    return hashlib.sha256(name + description + sources()).hexdigest()


class _Describer(pickle.Pickler):
    """Writes what is only to be hashed: the same bytes in each process."""

    def reducer_override(self, found: Any) -> Any:
        """Sections of files, whose set of the keys that were given has no order."""
        if not isinstance(getattr(found, "__pydantic_fields_set__", None), set):
            return NotImplemented
        state = found.__getstate__()
        given = sorted(state["__pydantic_fields_set__"])
        return type(found), (), {**state, "__pydantic_fields_set__": given}


def _is_all_code(function: Any) -> bool:
    """Whether a function is what its name says: but for defaults it carries no object."""
    if inspect.isclass(function) or isinstance(function, _PLAIN):
        return True
    if not inspect.isfunction(function) or "<" in function.__qualname__:
        return False
    return all(map(_is_all_code, _carried(function)))


def _carried(function: Any) -> list[Any]:
    cells = [cell.cell_contents for cell in function.__closure__ or ()]
    return [*cells, getattr(function, "__wrapped__", None)]


def _defaults(function: Any) -> Iterator[Any]:
    """Defaults of a function and of those that it carries."""
    if inspect.isfunction(function):
        yield function.__defaults__
        yield function.__kwdefaults__
        for one in _carried(function):
            yield from _defaults(one)


def _modules(description: bytes) -> Iterator[str]:
    """Where the classes and functions come from that a pickle names."""
    for operation, argument, _ in pickletools.genops(description):
        if operation.name == "GLOBAL":
            yield str(argument).split(" ")[0]


@cache
def sources() -> bytes:
    """Hash of this package, on which whatever is made from it depends."""
    found = hashlib.sha256()
    for path in sorted(_PACKAGE.rglob("*")):
        if path.suffix in _SOURCES:
            found.update(str(path.relative_to(_PACKAGE)).encode() + path.read_bytes())
    return found.digest()


def _make_room(where: Path) -> None:
    """Remove the programs unused for longest until the rest is small enough."""
    facts = [(path.stat(), path) for path in where.glob("*.program")]
    total = sum(fact.st_size for fact, _ in facts)
    for fact, path in sorted(facts, key=lambda entry: entry[0].st_mtime):
        if total <= LARGEST:
            break
        path.unlink(missing_ok=True)
        total -= fact.st_size
