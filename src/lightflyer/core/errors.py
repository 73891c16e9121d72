"""The package's exceptions and warnings."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any


class LightflyerError(Exception):
    """Base of every error that lightflyer raises on purpose."""


class ParameterError(LightflyerError, ValueError):
    """A physical parameter is outside its possible range."""


class ConvergenceError(LightflyerError, ArithmeticError):
    """A root-find did not reach its tolerance.

    The heat balance of a passive flyer always has exactly one root, so this points to a force
    model whose heat loss does not increase with the flyer's temperature.
    """


class ConfigurationError(LightflyerError, ValueError):
    """A flyer file cannot be used; the message is one line that says where and what to do."""


class MissingExtraError(LightflyerError, ImportError):
    """An optional dependency is not installed; the message names the extra that brings it."""


class OutputError(LightflyerError, OSError):
    """A result cannot be written where it was asked for."""


class ParameterWarning(UserWarning):
    """A parameter is possible but unusual, such as a measured TAC above one."""


class Doubt(str):
    """A warning of a number that ``--update`` writes into a flyer file on demand only."""


@contextmanager
def named(file: Any) -> Iterator[None]:
    """Say in which file the numbers are that are found impossible."""
    try:
        yield
    except ParameterError as error:
        raise ConfigurationError(f"{file}: {error}") from None


class PluginWarning(UserWarning):
    """A plug-in cannot be imported; what it adds is missing, everything else works."""
