"""Pytrees as plain data, so that what a program returns can be told without code."""

import dataclasses
import importlib
from typing import Any

from lightflyer.pytree import tree
from lightflyer.pytree.module import Module

_PACKAGE = "lightflyer"  # whose classes may be named in data


def as_data(structure: Any) -> Any:
    """A pytree's structure in lists, dicts, strings and numbers; as JSON has it."""
    return _encode(tree.unflatten(structure, range(structure.num_leaves)))


def from_data(data: Any, leaves: list[Any]) -> Any:
    """The pytree of some leaves; ``data``: from :func:`as_data`."""
    kind, content = data
    match kind:
        case "leaf":
            return leaves[content]
        case "static":
            return tuple(content) if isinstance(content, list) else content
        case "tuple":
            return tuple(from_data(part, leaves) for part in content)
        case "list":
            return [from_data(part, leaves) for part in content]
        case "dict":
            return {name: from_data(part, leaves) for name, part in content.items()}
        case "module":
            name, fields = content
            found = object.__new__(_class_of(name))
            for field, part in fields.items():
                object.__setattr__(found, field, from_data(part, leaves))
            return found
        case "named":
            name, parts = content
            return _class_of(name)(*(from_data(part, leaves) for part in parts))
    raise ValueError(f"not a structure: {kind}")


def _encode(node: Any) -> list[Any]:
    if type(node) is int:
        return ["leaf", node]
    if node is None:
        return ["static", None]
    if type(node) in (tuple, list):
        return [type(node).__name__, [_encode(part) for part in node]]
    if type(node) is dict and all(isinstance(name, str) for name in node):
        return ["dict", {name: _encode(part) for name, part in node.items()}]
    kind = type(node)
    of_package = kind.__module__.split(".")[0] == _PACKAGE
    if of_package and isinstance(node, tuple):
        return ["named", [f"{kind.__module__}:{kind.__qualname__}", [*map(_encode, node)]]]
    if of_package and isinstance(node, Module):
        fields = {
            field.name: (_static if field.metadata.get("static") else _encode)(
                getattr(node, field.name)
            )
            for field in dataclasses.fields(node)
        }
        return ["module", [f"{kind.__module__}:{kind.__qualname__}", fields]]
    raise TypeError(f"{kind.__name__} cannot be put as data")


def _static(value: Any) -> list[Any]:
    plain = str, int, float, bool, type(None)
    if isinstance(value, plain):
        return ["static", value]
    if isinstance(value, tuple) and all(isinstance(part, plain) for part in value):
        return ["static", list(value)]
    raise TypeError(f"{value!r} cannot be put as data")


def _class_of(name: str) -> Any:
    module, _, qualified = name.partition(":")
    if module.split(".")[0] != _PACKAGE:
        raise ValueError(f"{module} is not part of {_PACKAGE}")
    found: Any = importlib.import_module(module)
    for part in qualified.split("."):
        found = getattr(found, part)
    if not (isinstance(found, type) and issubclass(found, (Module, tuple))):
        raise ValueError(f"{name} is neither a record nor a tuple")
    return found
