"""Checks of values at the outermost call. Traced values have none yet and pass."""

import enum
from typing import Any, Self

import numpy as np

from lightflyer.array import tree
from lightflyer.array.namespace import call, is_loaded, is_tracer
from lightflyer.core.errors import ParameterError


class Choice(enum.StrEnum):
    """One of a few names."""

    @classmethod
    def of(cls, name: str) -> Self:
        try:
            return cls(name)
        except ValueError:
            kind = cls.__name__.lower()
            raise ParameterError(
                f'{kind} "{name}" is unknown; choose from {", ".join(cls)}'
            ) from None


def is_traced(*trees: Any) -> bool:
    """Whether any leaf is traced by JAX, or recorded, that is, has no concrete value yet."""
    may_be = call.jax is not None or is_loaded()
    return may_be and any(is_tracer(leaf) for leaf in tree.leaves(trees))


def is_labelled(value: Any) -> bool:
    """Whether a value is an array of xarray."""
    return hasattr(value, "dims") and hasattr(value, "attrs") and hasattr(value, "dtype")


def is_series(value: Any) -> bool:
    """Whether a value is a column of pandas."""
    return hasattr(value, "iloc") and hasattr(value, "dtype")


def is_concrete(*values: Any) -> bool:
    """Whether all values are numbers that are still to be checked: none within a public function.

    There they have been, and what is impossible becomes NaN.
    """
    if call.depth:
        return False
    return not is_traced(values) and all(
        bool(np.issubdtype(np.asarray(value).dtype, np.number)) for value in values
    )


def require_range(
    name: str,
    value: Any,
    lowest: float = -np.inf,
    highest: float = np.inf,
    *,
    open_below: bool = False,
) -> None:
    """Raise unless every element of a concrete ``value`` is a number in the range."""
    if isinstance(value, str):
        raise ParameterError(f'{name} = "{value}" is a text; write a number in SI units')
    if value is None or not is_concrete(value):
        return
    array = np.asarray(value)
    above = array > lowest if open_below else array >= lowest
    inside = above & (array <= highest) & np.isfinite(array)
    if not np.all(inside):
        bad = array[~inside].flat[0] if array.ndim else array
        raise ParameterError(f"{name} = {bad:g} is not {range_text(lowest, highest, open_below)}")


def range_text(lowest: float, highest: float, open_below: bool) -> str:
    """Words for an allowed range, such as ``"positive"``."""
    if highest == np.inf:
        if lowest == -np.inf:
            return "a finite number"
        if lowest == 0.0:
            return "positive" if open_below else "zero or positive"
        return f"{'above' if open_below else 'at least'} {lowest:g}"
    return f"between {lowest:g}{' (excluded)' if open_below else ''} and {highest:g}"


def require_positive(**values: Any) -> None:
    """Raise :class:`ParameterError` unless every concrete value is positive and finite."""
    for name, value in values.items():
        require_range(name, value, 0.0, open_below=True)


def require_data(margins: dict[str, Any]) -> None:
    """Raise :class:`ParameterError` if any concrete margin is negative, named by what is beyond.

    Within a public function nothing is raised: what is beyond is NaN there, for that element alone.
    """
    if call.depth:
        return
    for beyond, margin in margins.items():
        if not is_traced(margin) and np.any(np.less(margin, 0.0)):
            raise ParameterError(beyond)
