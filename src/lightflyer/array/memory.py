"""What a search asks for again and again while it goes on."""

import sys
from collections.abc import Callable
from functools import partial, wraps
from typing import Any, ParamSpec, TypeVar

from lightflyer.array.namespace import call, is_numeric, is_tracer
from lightflyer.array.tree import leaves

P = ParamSpec("P")
R = TypeVar("R")

_MOST = 32  # results of a function that are kept, the latest


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
        found = memory.get(key)
        if found is None:
            # with the arguments, so that no other object gets their identities
            found = args, function(*args)  # type: ignore[call-arg]
            if len(memory) >= _MOST:
                del memory[next(iter(memory))]
            memory[key] = found
        return found[1]

    return wrapper  # type: ignore[return-value]


def traced_once(function: Callable[P, R]) -> Callable[P, R]:
    """Let JAX trace a function of arrays and records once within one call of a public function.

    A search traces its equations in every loop, and again for derivatives. Nothing is kept when the
    call ends: what the function reads of its module may change.
    """

    @wraps(function)
    def wrapper(*args: Any) -> Any:
        # a model of the user's may hold what is no array
        if call.jax is not sys.modules.get("jax", call) or not all(
            is_tracer(leaf) or is_numeric(leaf) for leaf in leaves(args)
        ):
            return function(*args)  # type: ignore[call-arg]
        memory = call.memory.setdefault(wrapper, {})
        if not memory:  # by a function of its own, as JAX finds again what it has traced
            memory[None] = call.jax.jit(partial(function))
        return memory[None](*args)

    return wrapper  # type: ignore[return-value]
