"""Options that several commands have, with what they may be."""

import inspect
from collections.abc import Callable, Sequence
from functools import wraps
from typing import Annotated, Any

from cyclopts import Parameter
from cyclopts.validators import Number

from lightflyer.core.errors import ParameterError

MOST_SAMPLES = 1_000_000


def _whole(_: Any, tokens: Sequence[Any]) -> int:
    """A whole number; 1.5 is none."""
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError(f'"{tokens[0].value}" is not a whole number') from None


Whole = Annotated[int, Parameter(converter=_whole)]

Json = Annotated[bool, Parameter(name="--json", negative=())]  # Whether to print JSON
Seed = Annotated[Whole, Parameter(validator=Number(gte=0, lt=2**63))]  # Seed of random numbers

Samples = Annotated[Whole, Parameter(validator=Number(gte=0, lte=MOST_SAMPLES))]
"""Number of random samples, which take memory each."""


def only_with(**needs: str) -> Callable[[Callable[..., None]], Any]:
    """Have a command refuse options that do nothing without another, by the option's name."""

    def refusing(command: Callable[..., None]) -> Callable[..., None]:
        signature = inspect.signature(command)

        @wraps(command)
        def checked(*args: Any, **named: Any) -> None:
            given = {
                name
                for name, value in signature.bind_partial(*args, **named).arguments.items()
                if value != signature.parameters[name].default
            }
            for name, other in needs.items():
                if name in given and other not in given:
                    option, needed = (f"--{one.replace('_', '-')}" for one in (name, other))
                    raise ParameterError(f"{option} needs {needed}; alone it does nothing")
            command(*args, **named)

        checked.needs = needs  # type: ignore[attr-defined]
        return checked

    return refusing
