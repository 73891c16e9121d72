"""``[payload]`` of a flyer file: what the payload consists of."""

from collections.abc import Mapping
from typing import ClassVar

import pydantic

from lightflyer.budget.link import RadioLink
from lightflyer.budget.payload import Budget, Item, SolarCells
from lightflyer.files.section import Section, Spelling


class ItemSection(Section, of=Item):
    """An entry of ``items``."""

    name: str = pydantic.Field(min_length=1)


class CellsSection(Section, of=SolarCells):
    """``[payload.cells]``: solar cells that feed the payload."""


class LinkSection(Section, of=RadioLink):
    """``[payload.link]``: a radio link."""

    spelled: ClassVar[Mapping[str, Spelling]] = {"distance": Spelling("range")}


class PayloadSection(Section, of=Budget):
    """``[payload]``: what a payload needs, set beside what the flyer carries."""

    first_keys: ClassVar[tuple[str, ...]] = ("items", "reserve")

    items: tuple[ItemSection, ...] = ()
    cells: CellsSection | None = None
    link: LinkSection | None = None

    def build(self) -> Budget:
        """The budget."""
        return self.make()
