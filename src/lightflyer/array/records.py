"""Immutable records: dataclasses, and pytrees of JAX once it is loaded."""

import dataclasses
import inspect
from abc import ABCMeta
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Generic, TypeVar, dataclass_transform, get_origin

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import as_numpy, call, is_loaded, notice_jax

__all__ = ["AbstractClassVar", "AbstractVar", "Module", "ShortRepr", "field", "short_repr"]

T = TypeVar("T")


def field(
    *, static: bool = False, converter: Callable[[Any], Any] | None = None, **options: Any
) -> Any:
    """A field of a record.

    Parameters
    ----------
    static : bool
        Whether it is part of the structure, which JAX traces functions for, and no number.
    converter : callable, optional
        Makes the field's value of what the constructor is given.
    **options
        As for :func:`dataclasses.field`.
    """
    about: dict[str, Any] = {"static": True} if static else {}
    if converter is not None:
        about["converter"] = converter
    return dataclasses.field(metadata=about, **options)


if TYPE_CHECKING:
    from typing import ClassVar as AbstractClassVar

    AbstractVar = Annotated[T, "abstract"]
else:

    class AbstractVar(Generic[T]):
        """Annotation of a field or property that subclasses must have."""

    class AbstractClassVar(Generic[T]):
        """Annotation of a class variable that subclasses must have."""


_ABSTRACT = AbstractVar, AbstractClassVar


class _Kept(property):
    """A property that a record within a call of a public function computes once."""

    # Such a record is the call's own. One that a user holds computes it anew, as what it reads may
    # have changed; so does one that is traced, where the result would belong to one trace.

    def __init__(self, compute: Any):
        super().__init__(compute)
        self.__doc__, self._key = compute.__doc__, compute.__qualname__

    def __reduce__(self) -> Any:  # for classes of a script
        return _Kept, (self.fget,)

    def __get__(self, record: Any, owner: type | None = None) -> Any:
        if record is None:
            return self
        if not call.depth or call.jax is not None:
            return self.fget(record)  # type: ignore[misc]
        kept = vars(record)
        found = kept.get(self._key, _MISSING)
        if found is _MISSING:
            found = kept[self._key] = self.fget(record)  # type: ignore[misc]
        return found


_MISSING = object()


def _may_be_kept(part: property) -> bool:
    return part.fset is None and not getattr(part.fget, "__isabstractmethod__", False)


_in_making: set[int] = set()  # records whose attributes may be set


class _Later:
    """The ``__init__`` of a record, written when its class is first used: few of hundreds are."""

    def __set_name__(self, owner: type, name: str) -> None: ...

    def __get__(self, record: Any, owner: Any = None) -> Any:
        kind = type(record) if owner is None else owner
        for base in kind.__mro__:
            if vars(base).get("__init__") is self:
                setattr(base, "__init__", _initialiser(base))  # noqa: B010
        made: Any = getattr(kind, "__init__")  # noqa: B009  # mypy thinks of subclasses
        return made if record is None else made.__get__(record, owner)


def _initialiser(kind: Any) -> Any:
    """A function that takes the fields of a class, as a dataclass has it."""
    parameters: dict[bool, list[str]] = {False: [], True: []}
    names: dict[str, Any] = {"__builtins__": {}, "_missing": _MISSING}
    lines = ["_into = self.__dict__"]
    for one in dataclasses.fields(kind):
        default = ""
        if one.default is not dataclasses.MISSING:
            names[f"_default_{one.name}"] = one.default
            default = f"=_default_{one.name}"
        elif one.default_factory is not dataclasses.MISSING:
            names[f"_make_{one.name}"] = one.default_factory
            default = "=_missing"
            lines.append(f"if {one.name} is _missing: {one.name} = _make_{one.name}()")
        parameters[bool(one.kw_only)].append(one.name + default)
        lines.append(f"_into['{one.name}'] = {one.name}")
    if hasattr(kind, "__post_init__"):
        lines.append("self.__post_init__()")
    named = ["*", *parameters[True]] if parameters[True] else []
    head = ", ".join(["self", *parameters[False], *named])
    exec(f"def __init__({head}):\n  " + "\n  ".join(lines), names)
    made = names["__init__"]
    made.__qualname__, made.__module__ = f"{kind.__qualname__}.__init__", kind.__module__
    made.__annotations__ = {one.name: one.type for one in dataclasses.fields(kind)}
    return made


@dataclass_transform(eq_default=False, field_specifiers=(dataclasses.field, field))
class _ModuleType(ABCMeta):
    """Makes classes dataclasses and pytrees."""

    def __new__(
        mcs, name: str, bases: tuple[type, ...], content: dict[str, Any], /, **options: Any
    ) -> Any:
        content = {
            key: _Kept(part.fget) if type(part) is property and _may_be_kept(part) else part
            for key, part in content.items()
        }
        made: Any = super().__new__(mcs, name, bases, content, **options)
        annotations = inspect.get_annotations(made)
        abstract = {key for key, kind in annotations.items() if get_origin(kind) in _ABSTRACT}
        inherited = {key for base in bases for key in getattr(base, "_abstract", ())}
        made._abstract = abstract | {
            key for key in inherited - {*annotations} if _is_abstract(made, key)
        }
        made._has_own_init = "__init__" in content or any(
            getattr(base, "_has_own_init", False) for base in bases
        )
        made.__annotations__ = {
            key: kind for key, kind in annotations.items() if key not in abstract
        }
        dataclasses.dataclass(eq=False, repr=False, init=False, match_args=False)(made)
        made.__annotations__ = annotations
        fields = dataclasses.fields(made)
        if not made._has_own_init:
            made.__init__ = _Later()
        made._converters = tuple(
            (one.name, one.metadata["converter"]) for one in fields if "converter" in one.metadata
        )
        made._fixed = tuple(one.name for one in fields if one.metadata.get("static"))
        made._parts = tuple(one.name for one in fields if not one.metadata.get("static"))
        tree.register(made, _put_together)
        return made

    def __call__(cls, *args: Any, **kwargs: Any) -> Any:
        if cls._abstract:  # type: ignore[attr-defined]
            missing = ", ".join(sorted(cls._abstract))  # type: ignore[attr-defined]
            raise TypeError(f"{cls.__name__} is abstract: it lacks {missing}")
        notice_jax()
        made: Any = object.__new__(cls)  # type: ignore[arg-type]
        _in_making.add(id(made))
        try:
            made.__init__(*args, **kwargs)
        finally:
            _in_making.discard(id(made))
        values = vars(made)
        if cls._has_own_init:  # type: ignore[attr-defined]
            for name in values.keys() - {*cls._fixed, *cls._parts}:  # type: ignore[attr-defined]
                if "." not in name:  # as kept properties have
                    needs = f"write {name}: float, or what it is, in the body of the class"
                    raise TypeError(f"{cls.__name__} sets {name}, which is no field; {needs}")
        for name, converter in cls._converters:  # type: ignore[attr-defined]
            values[name] = converter(values[name])
        if call.depth:  # what a public function makes of checked numbers
            if is_loaded():
                values.update({name: as_numpy(value) for name, value in values.items()})
            if not call.blanks:
                return made
        name = "__blank_init__" if call.blanks else "__check_init__"
        for kind in cls.__mro__:
            if name in vars(kind):
                vars(kind)[name](made)
        return made

    @property
    def __signature__(cls) -> inspect.Signature:
        whole = inspect.signature(cls.__init__)  # type: ignore[misc]
        return whole.replace(parameters=list(whole.parameters.values())[1:])


def _put_together(kind: Any, beside: Any, values: Sequence[Any]) -> Any:
    record: Any = object.__new__(kind)
    vars(record).update(zip(kind._fixed, beside, strict=True))
    vars(record).update(zip(kind._parts, values, strict=True))
    return record


def _is_abstract(kind: type, name: str) -> bool:
    """Whether no class gives a value to what a base names only."""
    for base in kind.__mro__:
        if name in vars(base):
            return False
        if name in vars(base).get("__annotations__", {}):
            return name in getattr(base, "_abstract", ())
    return True


_LINE = 200  # characters of a record up to which records within it are written out
_TEXT = 60  # characters of a value
_FEW = 6  # values that are written out


def short_repr(record: Any) -> str:
    """A record in a line or two: fields that are not as by default, arrays by shape and ends."""
    if isinstance(record, tuple):  # a named one
        known = record._field_defaults  # type: ignore[attr-defined]
        given = [(name, getattr(record, name), known.get(name)) for name in record._fields]  # type: ignore[attr-defined]
    else:
        fields = (one for one in dataclasses.fields(record) if one.repr)
        given = [(one.name, getattr(record, one.name), one.default) for one in fields]
    # a default that is None or a number; arrays and records have no plain ==
    shown = [
        (name, value)
        for name, value, usual in given
        if not (value is usual or (type(value) is type(usual) and value == usual))
    ]
    for inner in (True, False):
        told = ", ".join(f"{name}={_shown(value, whole=inner)}" for name, value in shown)
        if len(told) <= _LINE:
            break
    else:
        told = told if len(told) <= 2 * _LINE else f"{told[: 2 * _LINE].rpartition(', ')[0]}, …"
    return f"{type(record).__name__}({told})"


def _shown(value: Any, *, whole: bool) -> str:
    """A value of a field; ``whole``: what is within it, too."""
    if hasattr(value, "to_numpy"):  # of pandas or xarray
        value = value.to_numpy()
    if isinstance(value, np.ndarray | np.generic) or hasattr(value, "aval"):
        return _array(value)
    if isinstance(value, Module | ShortRepr):
        return repr(value) if whole else f"{type(value).__name__}(…)"
    if isinstance(value, list | tuple | dict) and len(value) > _FEW:
        return f"<{type(value).__name__} of {len(value)}>"
    if type(value) in (list, tuple):
        inside = ", ".join(_shown(one, whole=whole) for one in value)
        return f"({inside})" if type(value) is tuple else f"[{inside}]"
    if callable(value):
        return f"<{getattr(value, '__qualname__', type(value).__name__)}>"
    told = repr(value)
    if len(told) <= _TEXT:
        return told
    return f"{told[:_TEXT]}…'" if isinstance(value, str) else f"<{type(value).__name__}>"


def _array(value: Any) -> str:
    """Numbers of an array, or its shape and the ends of what it holds."""
    if isinstance(value, np.ndarray | np.generic) and np.size(value) <= _FEW:
        return np.array2string(np.asarray(value), separator=", ", precision=6).replace("\n", "")
    told = f"{value.dtype} {tuple(map(int, value.shape))}"
    if isinstance(value, np.ndarray) and value.dtype.kind in "fiu" and np.isfinite(value).any():
        known = value[np.isfinite(value)]
        told += f", {known.min():.4g} to {known.max():.4g}"
    return f"<{told}>"


class ShortRepr:
    """A dataclass whose ``repr`` is short; see :func:`short_repr`."""

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        if "__repr__" not in vars(cls) and cls.__repr__ is ShortRepr.__repr__:
            cls.__repr__ = ShortRepr.__repr__  # type: ignore[method-assign]  # the dataclass keeps it

    def __repr__(self) -> str:
        return short_repr(self)


class Module(metaclass=_ModuleType):
    """A record that does not change, and is a pytree.

    Subclasses list fields as a dataclass does. ``__check_init__`` of each class is called when a
    record has been made, and may raise; in its place ``__blank_init__`` where impossible numbers
    become NaN.
    """

    def __setattr__(self, name: str, value: Any) -> None:
        if id(self) not in _in_making:
            raise dataclasses.FrozenInstanceError(f"cannot assign to field '{name}'")
        vars(self)[name] = value

    def __delattr__(self, name: str) -> None:
        raise dataclasses.FrozenInstanceError(f"cannot delete field '{name}'")

    def __repr__(self) -> str:
        return short_repr(self)

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and tree.equal(self, other)

    def __hash__(self) -> int:
        return hash((type(self), *tree.leaves(self)))
