"""Designs from whatever describes one: a file, a dictionary or objects."""

from pathlib import Path
from typing import Any

from lightflyer.core.errors import ParameterError
from lightflyer.design.design import AbstractDesign, ObjectDesign
from lightflyer.design.setup import Setup
from lightflyer.environment.base import AbstractEnvironment
from lightflyer.flyer.base import AbstractFlyer
from lightflyer.force.base import AbstractForceModel


def as_design(
    what: Any,
    environment: AbstractEnvironment | None = None,
    model: AbstractForceModel | None = None,
) -> AbstractDesign:
    """Make a design from a file, a dictionary or objects."""
    if isinstance(what, AbstractFlyer):
        if environment is None or model is None:
            raise ParameterError("a flyer needs an environment and a force model beside it")
        return ObjectDesign(Setup(what, environment, model))
    if environment is not None or model is not None:
        raise ParameterError(
            f"environment and model stand beside a flyer, not beside {type(what).__name__}"
        )
    if isinstance(what, AbstractDesign):
        return what
    if isinstance(what, Setup):
        return ObjectDesign(what)
    if isinstance(what, str | Path):
        from lightflyer.config.reader import read_design  # slow to import

        return read_design(what)
    if hasattr(what, "design"):
        found: AbstractDesign = what.design()
        return found
    raise ParameterError(
        f"{type(what).__name__} is neither a flyer, a Setup, a flyer file nor its path"
    )
