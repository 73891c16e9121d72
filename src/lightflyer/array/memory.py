"""What a search asks for again and again while it goes on."""

from collections.abc import Callable
from functools import wraps
from typing import Any, ParamSpec, TypeVar

from lightflyer.array.namespace import call

P = ParamSpec("P")
R = TypeVar("R")

_MOST = 32  # results of a function that are kept, those used last


def kept(function: Callable[P, R]) -> Callable[P, R]:
    """Let a function remember, within one call of a public function, what it gave for arguments.

    They are the same where they are the same objects, as the parts of a flyer and its surroundings
    are in all steps of a search. Nothing is kept when the call ends.
    """

    @wraps(function)
    def wrapper(*args: Any) -> Any:
        if not call.depth or call.jax is not None:
            return function(*args)  # type: ignore[call-arg]
        memory = call.memory.setdefault(wrapper, {})
        key = tuple(map(id, args))
        # with the arguments, so that no other object gets their identities
        found = memory.pop(key, None) or (args, function(*args))  # type: ignore[call-arg]
        if len(memory) >= _MOST:
            del memory[next(iter(memory))]
        memory[key] = found
        return found[1]

    return wrapper  # type: ignore[return-value]
