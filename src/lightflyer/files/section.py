"""Sections of input files: what they share, and how a file chooses between alternatives.

A section is a Pydantic model that is declared beside the class it describes. Its keys follow from
the annotated fields of that class: names, units, ranges, choices and defaults stand there alone. An
alternative of a section of the flyer file (a shape, an environment, a force model) is one subclass
of that section's base; it enters the file's grammar by being defined::

    class DiskSection(FlyerSection, of=Disk):
        shape: Literal["disk"] = "disk"
"""

import dataclasses
import inspect
from collections.abc import Iterator, Mapping
from types import NoneType
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, get_args, get_origin

import pydantic
from pydantic import ConfigDict
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from lightflyer.array.namespace import Numeric
from lightflyer.core.clock import require_hour
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.quantity import Quantity, contradiction_in, quantity_of
from lightflyer.core.units import Measured

_PLAIN = (bool, int, str)

UNKNOWN = "unknown_alternative"
"""Type of the mistake of a section that is none of the known alternatives."""


class Spelling(NamedTuple):
    """How a file gives a field."""

    key: str
    factor: float = 1.0  # The field's value over the key's


DIAMETER = Spelling("diameter", 0.5)  # How a file gives a radius


@dataclasses.dataclass(frozen=True, eq=False)
class OneOf:
    """Annotation of a text that is a name in a registry, which may still grow."""

    registry: Mapping[str, Any]

    def __get_pydantic_core_schema__(
        self, source: Any, handler: pydantic.GetCoreSchemaHandler
    ) -> CoreSchema:
        """Tell Pydantic to look the name up."""
        return core_schema.no_info_after_validator_function(
            self._require_registered, handler(source)
        )

    def _require_registered(self, name: str) -> str:
        if name in self.registry:
            return name
        known = ", ".join(f"'{known}'" for known in self.registry)
        raise PydanticCustomError("literal_error", "not one of {expected}", {"expected": known})


class Section(pydantic.BaseModel):
    """A section of an input file; it takes no key that it does not know."""

    # A subclass ``of`` a class has a key for each field of it that is a number, a choice or a text,
    # unless the subclass declares that key itself or leaves it out.

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)

    def __repr_args__(self) -> Iterator[tuple[str, Any]]:
        """What the file gives."""
        for name in sorted(self.model_fields_set):
            value = getattr(self, name)
            plain = isinstance(value, Measured) and value.uncertainty is None
            yield name, value.value if plain else value

    describes: ClassVar[type | None] = None
    """Class of what the section describes."""

    spelled: ClassVar[Mapping[str, Spelling]] = {}
    """Fields of that class that the file gives otherwise."""

    left_out: ClassVar[tuple[str, ...]] = ()
    """Fields of that class that have no key."""

    first_keys: ClassVar[tuple[str, ...]] = ()
    """Keys that come first, where the order is not that of the fields."""

    not_varied: ClassVar[Mapping[str, str]] = {}
    """Numbers that no study varies and no uncertainty moves, with the reason."""

    def __init_subclass__(cls, of: type | None = None, **options: Any) -> None:
        """Add the keys that follow from a class, before Pydantic looks for keys."""
        super().__init_subclass__(**options)
        if of is None:
            return
        cls.describes = of
        declared = vars(cls).get("__annotations__", {})
        known = {**cls.model_fields, **declared}  # those of the bases too
        added = {key: kind for key, kind in cls.keys_of(of).items() if key not in known}
        for key, (_, default) in added.items():
            if default is not ...:
                setattr(cls, key, default)
        every = {**declared, **{key: annotation for key, (annotation, _) in added.items()}}
        cls.__annotations__ = {key: every[key] for key in dict.fromkeys((*cls.first_keys, *every))}

    @classmethod
    def keys_of(cls, described: type) -> dict[str, tuple[Any, Any]]:
        """Annotation and default of each key that follows from a class; ``...`` where required."""
        found = {}
        for field in dataclasses.fields(described):
            if field.name in cls.left_out:
                continue
            annotation: Any = field.type
            default: Any = ... if field.default is dataclasses.MISSING else field.default
            if annotation is float:
                annotation = Annotated[Numeric, Quantity()]
            kinds = [kind for kind in (*get_args(annotation), annotation) if kind is not NoneType]
            key, factor = cls._spelling(field.name)
            quantity = quantity_of(annotation)
            if quantity is None:
                if get_origin(annotation) is not Literal and not set(kinds) <= set(_PLAIN):
                    continue
            elif default is None and quantity.in_files is not None:
                annotation, default = kinds[0], quantity.in_files
            elif default not in (None, ...):
                default = Measured(default)
            if isinstance(default, Measured):
                default = Measured(default.value / factor, default.uncertainty)
            found[key] = annotation, default
        return found

    def make(self, **given: Any) -> Any:
        """The object that the section describes."""
        if self.describes is None:
            raise TypeError(f"{type(self).__name__} needs a build() of its own, or of=...")
        for field in dataclasses.fields(self.describes):
            has_key = self._spelling(field.name).key in type(self).model_fields
            if has_key and field.name not in given:
                given[field.name] = self._value_of(field.name)
        return self.describes(**given)

    @classmethod
    def _spelling(cls, field: str) -> Spelling:
        return cls.spelled.get(field, Spelling(field))

    def _value_of(self, field: str) -> Any:
        """What a field of the class described becomes."""
        key, factor = self._spelling(field)
        value = getattr(self, key)
        if isinstance(value, Measured):
            return value.value if factor == 1.0 else factor * value.value
        if isinstance(value, tuple):
            return tuple(entry.make() for entry in value)
        return value.make() if isinstance(value, Section) else value

    @pydantic.field_validator("date", mode="before", check_fields=False)
    @classmethod
    def _has_an_hour(cls, date: Any) -> Any:
        return require_hour(date)

    @pydantic.model_validator(mode="after")
    def _possible_together(self) -> "Section":
        """Raise where numbers contradict each other by the rule of the class described."""
        problem = contradiction_in(self.describes, self._value_of)
        if problem:
            raise ConfigurationError(problem)
        return self

    def idle(self) -> dict[str, str]:
        """Keys that have no effect as the others are, with why: ``"without tilt"``."""
        return {}

    @pydantic.model_validator(mode="after")
    def _every_key_has_an_effect(self) -> "Section":
        for key, why in self.idle().items():
            if key in self.model_fields_set and getattr(self, key) is not None:
                raise ConfigurationError(f"{key} has no effect {why}")
        for key in self.model_fields_set:
            value = getattr(self, key)
            has_error = isinstance(value, Measured) and value.uncertainty
            if has_error and (reason := self.reason_not_varied(key)):
                raise ConfigurationError(f"{key} takes no ±: it {reason}")
        return self

    @classmethod
    def quantity(cls, name: str) -> Quantity | None:
        """Unit and range of a field, or None for one that is no number."""
        field = cls.model_fields[name]
        found = (quantity_of(part) for part in (*field.metadata, field.annotation))
        return next((quantity for quantity in found if quantity is not None), None)

    def numbers(self) -> Iterator[tuple[str, Quantity, Measured | None]]:
        """Dotted name, quantity and value of each number, those of inner sections included."""
        for name in type(self).model_fields:
            value = getattr(self, name)
            quantity = self.quantity(name)
            if quantity is not None:
                yield name, quantity, value
            several = isinstance(value, tuple) and not isinstance(value, Measured)
            entries = enumerate(value) if several else ()
            inside = {name: value, **{f"{name}.{index}": one for index, one in entries}}
            for key, inner in inside.items():
                for inner_name, kind, number in (
                    inner.numbers() if isinstance(inner, Section) else ()
                ):
                    yield f"{key}.{inner_name}", kind, number

    def with_values(self, values: Mapping[str, Any]) -> "Section":
        """A copy with other numbers, which are not checked and may be traced by JAX."""
        own: dict[str, Any] = {}
        own |= {name: Measured(value) for name, value in values.items() if "." not in name}
        nested: dict[str, dict[str, Any]] = {}
        for name, value in values.items():
            first, dot, rest = name.partition(".")
            if dot:
                nested.setdefault(first, {})[rest] = value
        for name, changes in nested.items():
            value = getattr(self, name)
            if isinstance(value, Section):
                own[name] = value.with_values(changes)
                continue
            of_entries: dict[int, dict[str, Any]] = {}
            for key, change in changes.items():
                index, _, rest = key.partition(".")
                of_entries.setdefault(int(index), {})[rest] = change
            own[name] = tuple(
                entry.with_values(of_entries[index]) if index in of_entries else entry
                for index, entry in enumerate(value)
            )
        return self.model_copy(update=own) if own else self

    def reason_not_varied(self, name: str) -> str | None:
        """Why a number cannot be varied, or None where it can."""
        first, _, rest = name.partition(".")
        inner = getattr(self, first, None)
        if rest and isinstance(inner, Section):
            return inner.reason_not_varied(rest)
        return self.not_varied.get(name.rpartition(".")[2])


class Alternative(Section):
    """Base of a section that has alternatives; a key or two of the file choose between them."""

    # A direct subclass is the base of one section and states which keys choose. Every concrete
    # subclass of that is an alternative, under the values of its literal keys, unless it says that
    # it is of other files.

    choosing_keys: ClassVar[tuple[tuple[str, str], ...]] = ()
    """Keys that choose, with the values they have where the file leaves them out."""

    of_other_files: ClassVar[bool] = False
    """Whether files with alternatives do not know it."""

    alternatives: ClassVar[dict[str, type["Alternative"]]] = {}

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        super().__pydantic_init_subclass__(**kwargs)
        if Alternative in cls.__bases__:
            cls.alternatives = {}
        elif not (cls.of_other_files or inspect.isabstract(cls)):
            cls.alternatives[cls.tag()] = cls

    @classmethod
    def tag(cls) -> str:
        """Values of the choosing keys of this alternative, separated by blanks."""
        values = []
        for key, _ in cls.choosing_keys:
            annotation = cls.model_fields[key].annotation if key in cls.model_fields else None
            if get_origin(annotation) is Literal:
                values.append(str(get_args(annotation)[0]))
        return " ".join(values)

    @classmethod
    def tag_of(cls, content: Any) -> str:
        """Tag of the alternative that a file's content, or a section, chooses."""
        if isinstance(content, Section):
            return content.tag() if isinstance(content, Alternative) else ""
        given = content if isinstance(content, Mapping) else {}
        values: list[str] = []
        for key, default in cls.choosing_keys:
            values.append(str(given.get(key, default)))
            if " ".join(values) in cls.alternatives:
                break  # an alternative without a second choice
        return " ".join(values)

    @classmethod
    def __get_pydantic_core_schema__(
        cls, source: Any, handler: pydantic.GetCoreSchemaHandler
    ) -> CoreSchema:
        """Let a field of the base's type take any alternative; others are never compiled."""
        if Alternative not in cls.__bases__:
            return handler(source)
        return core_schema.with_info_plain_validator_function(cls._validate_any)

    @classmethod
    def _validate_any(cls, content: Any, info: pydantic.ValidationInfo) -> "Alternative":
        if isinstance(content, cls):
            return content
        tag = cls.tag_of(content)
        if tag not in cls.alternatives:
            raise PydanticCustomError(UNKNOWN, "unknown alternative", {"base": cls, "tag": tag})
        return cls.alternatives[tag].model_validate(content, context=info.context)

    @classmethod
    def choices(cls, key: str, tag: str) -> list[str]:
        """Values that a choosing key may have, given those before it in a tag."""
        position = [name for name, _ in cls.choosing_keys].index(key)
        before = tag.split(" ")[:position]
        found = (known.split(" ") for known in cls.alternatives)
        values = (
            parts[position]
            for parts in found
            if len(parts) > position and parts[:position] == before
        )
        return list(dict.fromkeys(values))
