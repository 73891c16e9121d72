"""Immutable records that are pytrees: dataclasses whose numbers JAX sees.

They are as Equinox's modules, and fields may be declared by its ``field`` as by the one here.
"""

import dataclasses
import inspect
from abc import ABCMeta
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Generic, TypeVar, dataclass_transform, get_origin

from lightflyer.pytree import tree

__all__ = ["AbstractClassVar", "AbstractVar", "Module", "field"]

T = TypeVar("T")


def field(
    *, static: bool = False, converter: Callable[[Any], Any] | None = None, **options: Any
) -> Any:
    """A field of a record.

    Parameters
    ----------
    static : bool
        Whether it is part of the structure, which programs are traced for, and no number.
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

_in_making: set[int] = set()  # records whose attributes may be set


@dataclass_transform(eq_default=False, field_specifiers=(dataclasses.field, field))
class _ModuleType(ABCMeta):
    """Makes classes dataclasses and pytrees."""

    def __new__(
        mcs, name: str, bases: tuple[type, ...], content: dict[str, Any], /, **options: Any
    ) -> Any:
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
        dataclasses.dataclass(eq=False, repr=False, init=not made._has_own_init)(made)
        made.__annotations__ = annotations
        fields = dataclasses.fields(made)
        made._converters = tuple(
            (one.name, one.metadata["converter"]) for one in fields if "converter" in one.metadata
        )
        fixed = tuple(one.name for one in fields if one.metadata.get("static"))
        parts = tuple(one.name for one in fields if not one.metadata.get("static"))

        def put_together(kind: type, beside: Any, values: Sequence[Any]) -> Any:
            record: Any = object.__new__(kind)
            vars(record).update(zip(fixed, beside, strict=True))
            vars(record).update(zip(parts, values, strict=True))
            return record

        tree.register(made, fixed, parts, put_together)
        return made

    def __call__(cls, *args: Any, **kwargs: Any) -> Any:
        if cls._abstract:  # type: ignore[attr-defined]
            missing = ", ".join(sorted(cls._abstract))  # type: ignore[attr-defined]
            raise TypeError(f"{cls.__name__} is abstract: it lacks {missing}")
        made: Any = object.__new__(cls)  # type: ignore[arg-type]
        _in_making.add(id(made))
        try:
            made.__init__(*args, **kwargs)
        finally:
            _in_making.discard(id(made))
        values = vars(made)
        for name, converter in cls._converters:  # type: ignore[attr-defined]
            values[name] = converter(values[name])
        for kind in cls.__mro__:
            if "__check_init__" in vars(kind):
                vars(kind)["__check_init__"](made)
        return made

    @property
    def __signature__(cls) -> inspect.Signature:
        whole = inspect.signature(cls.__init__)  # type: ignore[misc]
        return whole.replace(parameters=list(whole.parameters.values())[1:])


def _is_abstract(kind: type, name: str) -> bool:
    """Whether no class gives a value to what a base names only."""
    for base in kind.__mro__:
        if name in vars(base):
            return False
        if name in vars(base).get("__annotations__", {}):
            return name in getattr(base, "_abstract", ())
    return True


class Module(metaclass=_ModuleType):
    """A record that does not change, and is a pytree.

    Subclasses list fields as a dataclass does. ``__check_init__`` of each class is called when a
    record has been made, and may raise.
    """

    def __setattr__(self, name: str, value: Any) -> None:
        if id(self) not in _in_making:
            raise dataclasses.FrozenInstanceError(f"cannot assign to field '{name}'")
        vars(self)[name] = value

    def __delattr__(self, name: str) -> None:
        raise dataclasses.FrozenInstanceError(f"cannot delete field '{name}'")

    def __repr__(self) -> str:
        told = (f"{name}={getattr(self, name)!r}" for name in self.__dataclass_fields__)
        return f"{type(self).__name__}({', '.join(told)})"

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and tree.equal(self, other)

    def __hash__(self) -> int:
        return hash((type(self), *tree.leaves(self)))
