"""Sending objects to other processes, those of classes from a script or notebook included.

Other processes cannot import such a class. cloudpickle sends it along: it makes an empty class and
fills it afterwards. But the fields of a record are learned when its class is made, so here they are
there from the start, and only methods follow.
"""

import abc
import dataclasses
import inspect
import io
import pickle
import sys
import types
import uuid
from typing import Any
from weakref import WeakKeyDictionary, WeakValueDictionary

from lightflyer.array.records import Module

_GENERATED = (
    *("__dict__", "__weakref__", "__annotations__", "_abc_impl", "__abstractmethods__"),
    *("__dataclass_fields__", "__dataclass_params__", "__match_args__"),
)
_FIRST = ("__module__", "__qualname__", "__doc__")
_FIELD_OPTIONS = ("default", "default_factory", "init", "repr", "hash", "compare", "kw_only")

_identifiers: WeakKeyDictionary[type, str] = WeakKeyDictionary()
_classes: WeakValueDictionary[str, type] = WeakValueDictionary()


def dumps(value: Any) -> bytes:
    """Pickle an object; :func:`pickle.loads` reads it wherever lightflyer is installed."""
    try:
        import cloudpickle
    except ImportError:
        return pickle.dumps(value)

    class Pickler(cloudpickle.Pickler):
        def reducer_override(self, thing: Any) -> Any:
            if isinstance(thing, type) and issubclass(thing, Module) and _is_own(thing):
                return _make, _beginning(thing), _rest(thing), None, None, _fill
            return super().reducer_override(thing)

    with io.BytesIO() as buffer:
        Pickler(buffer).dump(value)
        return buffer.getvalue()


def _is_own(kind: type) -> bool:
    """Whether a class cannot be imported elsewhere."""
    import cloudpickle

    if kind.__module__ == "__main__":
        return True
    if kind.__module__ in cloudpickle.list_registry_pickle_by_value():
        return True
    found: Any = sys.modules.get(kind.__module__)
    for name in kind.__qualname__.split("."):
        found = getattr(found, name, None)
    return found is not kind


def _beginning(kind: Any) -> tuple[Any, ...]:
    """Metaclass, name, bases, fields and identity of a class."""
    identifier = _identifiers.setdefault(kind, uuid.uuid4().hex)
    content = {name: kind.__dict__[name] for name in _FIRST if name in kind.__dict__}
    content["__annotations__"] = inspect.get_annotations(kind)
    for name in content["__annotations__"]:
        field = kind.__dataclass_fields__.get(name)
        if name in kind.__dict__:
            content[name] = kind.__dict__[name]
        if _is_field(field) and (name not in content or field.metadata):
            content[name] = _options(field)
    own_init = kind._has_own_init and "__init__" in kind.__dict__
    return type(kind), kind.__name__, kind.__bases__, content, own_init, identifier


def _is_field(field: Any) -> bool:
    # what dataclasses also list: class variables
    return field is not None and field._field_type is dataclasses._FIELD  # type: ignore[attr-defined]


class _Options(dict[str, Any]):
    """What a dataclass field was declared with."""


def _options(field: Any) -> _Options:
    given = {name: getattr(field, name) for name in _FIELD_OPTIONS}
    known = {name: value for name, value in given.items() if value is not dataclasses.MISSING}
    return _Options(known, metadata=dict(field.metadata))


def _rest(kind: Any) -> dict[str, Any]:
    """Everything of a class that is no field."""
    sent = {*_GENERATED, *_FIRST, *inspect.get_annotations(kind)}
    if not kind._has_own_init:
        sent.add("__init__")
    return {name: value for name, value in kind.__dict__.items() if name not in sent}


def _make(
    metaclass: type,
    name: str,
    bases: tuple[type, ...],
    content: dict[str, Any],
    own_init: bool,
    identifier: str,
) -> type:
    """The class with its fields; the same one each time."""
    if identifier in _classes:
        return _classes[identifier]
    body = {
        key: dataclasses.field(**value) if isinstance(value, _Options) else value
        for key, value in content.items()
    }
    if own_init:
        body["__init__"] = _later  # or one would be generated
    made = types.new_class(name, bases, {"metaclass": metaclass}, lambda space: space.update(body))
    _classes[identifier] = made
    _identifiers[made] = identifier
    return made


def _later(self: Any) -> None:
    """Stands for a method that follows."""


def _fill(made: Any, content: dict[str, Any]) -> None:
    for name, value in content.items():
        setattr(made, name, value)
    abc.update_abstractmethods(made)
