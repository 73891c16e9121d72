"""Sections of input files: what they share, and how a file chooses between alternatives.

A section is a Pydantic model that is declared beside the class it describes. An alternative of a
section of the flyer file (a shape, an environment, a force model) is one subclass of that
section's base; it enters the file's grammar by being defined::

    class DiskSection(FlyerSection):
        shape: Literal["disk"] = "disk"
        diameter: Length
"""

import inspect
from collections.abc import Iterator, Mapping
from typing import Any, ClassVar, Literal, get_args, get_origin

import pydantic
from pydantic import ConfigDict

from lightflyer.foundation.quantity import Quantity, quantity_of
from lightflyer.foundation.units import Measured


class Section(pydantic.BaseModel):
    """A section of an input file; it takes no key that it does not know."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    not_varied: ClassVar[Mapping[str, str]] = {}
    """Numbers that no study varies and no uncertainty moves, with the reason."""

    @classmethod
    def quantity(cls, name: str) -> Quantity | None:
        """Unit and range of a field, or None for one that is no number."""
        field = cls.model_fields[name]
        found = (quantity_of(part) for part in (*field.metadata, field.annotation))
        return next((quantity for quantity in found if quantity is not None), None)

    def numbers(self) -> Iterator[tuple[str, Quantity, Measured | None]]:
        """Dotted name, quantity and value of each number, those of inner sections included.

        Yields
        ------
        name : str
        quantity : Quantity
        value : Measured or None
            None for an optional number that is not given.
        """
        for name in type(self).model_fields:
            value = getattr(self, name)
            quantity = self.quantity(name)
            if quantity is not None:
                yield name, quantity, value
            for key, inner in _inner(name, value):
                for inner_name, inner_quantity, number in inner.numbers():
                    yield f"{key}.{inner_name}", inner_quantity, number

    def replaced(self, values: Mapping[str, Any]) -> "Section":
        """A copy with other numbers, which are not checked and may be traced by JAX.

        Parameters
        ----------
        values : dict of str to array
            By dotted name, in the units of the quantities.

        Returns
        -------
        Section
        """
        own = {name: Measured(value) for name, value in values.items() if "." not in name}
        nested: dict[str, dict[str, Any]] = {}
        for name, value in values.items():
            first, dot, rest = name.partition(".")
            if dot:
                nested.setdefault(first, {})[rest] = value
        for name, inner in nested.items():
            own[name] = _replaced_inside(getattr(self, name), inner)
        return self.model_copy(update=own) if own else self

    def reason_not_varied(self, name: str) -> str | None:
        """Why a number cannot be varied, or None where it can.

        Parameters
        ----------
        name : str
            Dotted where it is within an inner section.

        Returns
        -------
        str or None
        """
        first, _, rest = name.partition(".")
        inner = getattr(self, first, None)
        if rest and isinstance(inner, Section):
            return inner.reason_not_varied(rest)
        return self.not_varied.get(name.rpartition(".")[2])


def _inner(name: str, value: Any) -> Iterator[tuple[str, Section]]:
    if isinstance(value, Section):
        yield name, value
    elif isinstance(value, tuple) and not isinstance(value, Measured):
        for index, entry in enumerate(value):
            if isinstance(entry, Section):
                yield f"{name}.{index}", entry


def _replaced_inside(value: Any, changes: Mapping[str, Any]) -> Any:
    if isinstance(value, Section):
        return value.replaced(changes)
    entries = list(value)
    for index, entry in enumerate(entries):
        mine = {
            key.partition(".")[2]: change
            for key, change in changes.items()
            if key.partition(".")[0] == str(index)
        }
        entries[index] = entry.replaced(mine) if mine else entry
    return tuple(entries)


class Alternative(Section):
    """Base of a section that has alternatives; a key or two of the file choose between them.

    A direct subclass is the base of one section and states which keys choose. Every concrete
    subclass of that is an alternative, under the values of its literal keys, unless it says
    that it is of other files.
    """

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


def alternative_tags() -> set[str]:
    """Names by which Pydantic tells a section's alternatives apart.

    Returns
    -------
    set of str
    """
    return {tag for base in Alternative.__subclasses__() for tag in base.alternatives}
