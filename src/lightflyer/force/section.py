"""``[force]`` of a flyer file: what all its alternatives share."""

from typing import Any, ClassVar

from lightflyer.files.section import Alternative
from lightflyer.force.base import AbstractForceModel


class ForceSection(Alternative):
    """``[force]``: a force model."""

    choosing_keys: ClassVar[tuple[tuple[str, str], ...]] = (("model", "kinetic"),)
    model_type: ClassVar[type[AbstractForceModel]]
    """Class of the model that the section builds."""

    def __init_subclass__(cls, of: type[AbstractForceModel] | None = None, **options: Any) -> None:
        if of is not None:
            cls.model_type = of
        super().__init_subclass__(of=of, **options)

    def build(self) -> AbstractForceModel:
        """The force model."""
        return self.make()
