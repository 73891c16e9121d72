"""Pytrees, as JAX has them: records, tuples, lists and dictionaries of numbers."""

from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from lightflyer.array.namespace import is_loaded, is_tracer, when_loaded

Predicate = Callable[[Any], bool]
_Take = Callable[[Any], tuple[Any, Sequence[Any]]]  # what a node is beside its parts, and its parts
_Make = Callable[[type, Any, Sequence[Any]], Any]

_LEAF: tuple[Any, ...] = ()
_NODES: dict[type, tuple[_Take, _Make]] = {
    type(None): (lambda _: (None, ()), lambda *_: None),
    tuple: (lambda node: (None, node), lambda _, __, parts: tuple(parts)),
    list: (lambda node: (None, node), lambda _, __, parts: list(parts)),
    dict: (
        lambda node: ((names := tuple(sorted(node))), [node[name] for name in names]),
        lambda _, names, parts: dict(zip(names, parts, strict=True)),
    ),
}
"""How nodes are taken apart and put together."""

_LEAVES: set[type] = {float, int, bool, complex, str, np.ndarray, np.float64, np.bool_}


class Structure:
    """What a pytree is beside its leaves."""

    __slots__ = ("_form", "_hash", "num_leaves")

    def __init__(self, form: tuple[Any, ...], num_leaves: int):
        self._form, self.num_leaves = form, num_leaves
        self._hash: int | None = None

    def __hash__(self) -> int:
        if self._hash is None:
            self._hash = hash(self._form)
        return self._hash

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Structure) and self._form == other._form

    def __str__(self) -> str:
        return _text(self._form)

    @property
    def is_ours(self) -> bool:
        """Whether all of its classes are Python's or this package's."""
        return _is_ours(self._form)


def register(kind: Any, make: _Make) -> None:
    """Make a class a node, for JAX too, by its ``_fixed`` and ``_parts``, names of attributes."""
    # They are looked up when a node is taken apart: a class that another process sends has them
    # only after it is made.

    def take(node: Any) -> tuple[Any, list[Any]]:
        values = vars(node)
        return tuple([values[name] for name in kind._fixed]), [values[name] for name in kind._parts]

    def for_jax() -> None:
        import jax

        def take_with_keys(node: Any) -> Any:
            beside, found = take(node)
            keys = map(jax.tree_util.GetAttrKey, kind._parts)
            return list(zip(keys, found, strict=True)), beside

        jax.tree_util.register_pytree_with_keys(
            kind, take_with_keys, lambda beside, found: make(kind, beside, tuple(found)),
            lambda node: take(node)[::-1],
        )  # fmt: skip

    _NODES[kind] = take, make
    when_loaded(for_jax)


def flatten(tree: Any, is_leaf: Predicate | None = None) -> tuple[list[Any], Structure]:
    """Leaves and structure, as :func:`jax.tree.flatten`."""
    found: list[Any] = []
    form = _flatten(tree, found, is_leaf)
    return found, Structure(form, len(found))


def leaves(tree: Any, is_leaf: Predicate | None = None) -> list[Any]:
    """Leaves, as :func:`jax.tree.leaves`."""
    return flatten(tree, is_leaf)[0]


def structure(tree: Any) -> Structure:
    """What a pytree is beside its leaves."""
    return flatten(tree)[1]


def unflatten(form: Structure, values: Sequence[Any]) -> Any:
    """A pytree of some leaves, as :func:`jax.tree.unflatten`."""
    if len(values) != form.num_leaves:
        raise ValueError(f"{len(values)} leaves for a pytree of {form.num_leaves}")
    return _unflatten(form._form, iter(values))


def map_leaves(
    function: Callable[..., Any], tree: Any, *rest: Any, is_leaf: Predicate | None = None
) -> Any:
    """Apply a function to the leaves of pytrees, as :func:`jax.tree.map`."""
    return _map(function, tree, rest, is_leaf)


def _map(
    function: Callable[..., Any], node: Any, rest: tuple[Any, ...], is_leaf: Predicate | None
) -> Any:
    kind = type(node)
    if kind in _LEAVES or (is_leaf is not None and is_leaf(node)):
        return function(node, *rest)
    if kind not in _NODES and not _is_node(node):
        return function(node, *rest)
    take, make = _NODES[kind]
    beside, parts = take(node)
    if not rest:
        return make(kind, beside, [_map(function, part, (), is_leaf) for part in parts])
    columns = []
    for other in rest:
        if type(other) is not kind:
            raise ValueError(f"{type(other).__name__} where another pytree has {kind.__name__}")
        theirs, values = take(other)
        if theirs != beside or len(values) != len(parts):
            raise ValueError(f"two pytrees have a different {kind.__name__}")
        columns.append(values)
    rows = zip(parts, zip(*columns, strict=True), strict=True)
    return make(kind, beside, [_map(function, part, row, is_leaf) for part, row in rows])


def equal(one: Any, other: Any) -> bool:
    """Whether two pytrees are the same, to the last bit of their numbers."""
    (ours, form), (theirs, their_form) = flatten(one), flatten(other)
    return form == their_form and all(map(_same, ours, theirs))


def replace_at(where: Callable[[Any], Any], tree: Any, replacement: Any) -> Any:
    """A pytree with parts replaced, unchecked; ``where`` names the part, or several."""
    _, form = flatten(tree, lambda node: node is None)
    marked = unflatten(form, [_Mark() for _ in range(form.num_leaves)])
    chosen = where(marked)
    parts = leaves(marked, lambda node: node is chosen)
    if type(chosen) in (tuple, list) and not any(part is chosen for part in parts):
        new = {id(part): value for part, value in zip(chosen, replacement, strict=True)}
    else:
        new = {id(chosen): replacement}

    def put(part: Any, old: Any) -> Any:
        return new.get(id(part), old)

    return map_leaves(put, marked, tree, is_leaf=lambda part: id(part) in new)


def take_rows(whole: Any, shape: tuple[int, ...], rows: np.ndarray) -> Any:
    """Some elements of a pytree of arrays, which are the first axis; others are all elements'."""

    def take(leaf: Any) -> Any:
        return leaf[rows] if np.shape(leaf)[: len(shape)] == shape else leaf

    return map_leaves(take, whole, is_leaf=_is_table)


def put_rows(whole: Any, places: np.ndarray | None, rows: Any) -> Any:
    """A pytree of arrays, of which the elements at some places are others; without places, all."""
    if places is None:
        return rows

    def put(old: Any, new: Any) -> Any:
        if not np.shape(old):
            return new
        found = np.array(old)
        found[places] = new
        return found

    return map_leaves(put, whole, rows)


def _is_table(node: Any) -> bool:
    """Whether arrays in a record are nodes of a table, whatever shape elements have."""
    return getattr(type(node), "is_table", False)


class _Mark:
    """Stands for a leaf."""


def _same(one: Any, other: Any) -> bool:
    if is_tracer(one) or is_tracer(other) or one is other:
        return one is other
    one, other = np.asarray(one), np.asarray(other)
    return one.dtype == other.dtype and np.array_equal(one, other)


def _flatten(node: Any, found: list[Any], is_leaf: Predicate | None) -> tuple[Any, ...]:
    if is_leaf is not None and is_leaf(node):
        found.append(node)
        return _LEAF
    kind = type(node)
    if kind in _LEAVES or not (kind in _NODES or _is_node(node)):
        found.append(node)
        return _LEAF
    beside, parts = _NODES[kind][0](node)
    return kind, beside, tuple([_flatten(part, found, is_leaf) for part in parts])


def _unflatten(form: tuple[Any, ...], values: Iterator[Any]) -> Any:
    if form is _LEAF:
        return next(values)
    kind, beside, parts = form
    return _NODES[kind][1](kind, beside, [_unflatten(part, values) for part in parts])


def _is_node(node: Any) -> bool:
    """Whether what is not known by its class yet has parts; it is known from then on."""
    kind = type(node)
    if issubclass(kind, tuple) and hasattr(kind, "_fields"):
        _NODES[kind] = (lambda node: (None, node)), (lambda made, _, parts: made(*parts))
    elif is_loaded():
        import jax

        if jax.tree_util.all_leaves([node]):
            _LEAVES.add(kind)
        else:
            _NODES[kind] = _take_by_jax, lambda _, beside, parts: beside.unflatten(parts)
    return kind in _NODES


def _take_by_jax(node: Any) -> tuple[Any, Sequence[Any]]:
    """For classes that others registered."""
    import jax

    parts, beside = jax.tree.flatten(node, is_leaf=lambda part: part is not node)
    return beside, parts


def _text(form: tuple[Any, ...]) -> str:
    if form is _LEAF:
        return "*"
    kind, beside, parts = form
    return f"{kind.__qualname__}[{beside}]({', '.join(map(_text, parts))})"


def _is_ours(form: tuple[Any, ...]) -> bool:
    if form is _LEAF:
        return True
    kind, _, parts = form
    return kind.__module__.startswith(("builtins", "lightflyer.")) and all(map(_is_ours, parts))
