"""``[force]`` of a flyer file: what all its alternatives share."""

import abc
from typing import ClassVar

from lightflyer.force.base import AbstractForceModel
from lightflyer.foundation.section import Alternative


class ForceSection(Alternative, abc.ABC):
    """``[force]``: a force model."""

    choosing_keys: ClassVar[tuple[tuple[str, str], ...]] = (("model", "kinetic"),)
    model_type: ClassVar[type[AbstractForceModel]]
    """Class of the model that the section builds."""

    @abc.abstractmethod
    def build(self) -> AbstractForceModel:
        """The force model."""
