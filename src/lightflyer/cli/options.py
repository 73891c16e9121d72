"""Options that several commands have, with what they may be."""

import inspect
from collections.abc import Callable, Sequence
from functools import wraps
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter
from cyclopts.validators import Number

from lightflyer.core.errors import ConfigurationError, ParameterError

if TYPE_CHECKING:
    from lightflyer.environment.base import Coordinate

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


def coordinate(option: str, text: str, where: "Coordinate") -> float:
    """An altitude or pressure of an option in SI units, within what the environment has."""
    from lightflyer.core.units import scale_and_offset

    try:
        found, spread = where.quantity.read(text)
    except ConfigurationError as error:
        said = "" if text in str(error) else f"{where.name} {text} "
        factor, _ = scale_and_offset(where.quantity.unit, where.shown_unit)
        low, high = factor * where.lowest, factor * where.highest
        allowed = f"must be between {low:g} and {high:g} {where.shown_unit}"
        told = str(error).replace(f"must be {where.quantity.allowed}", allowed)
        raise ConfigurationError(f"{option}: {said}{told}") from None
    if spread is not None:
        raise ConfigurationError(f'{option} "{text}": takes no ±')
    return found


def coordinate_range(option: str, text: str, where: "Coordinate") -> tuple[float, float]:
    """Two altitudes or pressures of an option such as "50 km to 100 km" in SI units."""
    ends = text.split(" to ")
    example = '"50 km to 100 km"' if where.name == "altitude" else '"1 Pa to 100 Pa"'
    if len(ends) != 2:
        raise ConfigurationError(f'{option} "{text}": write a range, as in {example}')
    low, high = (coordinate(option, end.strip(), where) for end in ends)
    if not low < high:
        raise ConfigurationError(f'{option} "{text}": the first must be the lower one')
    return low, high
