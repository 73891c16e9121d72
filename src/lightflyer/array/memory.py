"""What a search asks for again and again while it goes on."""

import sys
from collections.abc import Callable
from functools import partial, wraps
from typing import Any, ParamSpec, TypeVar

from lightflyer.array.namespace import call, is_numeric, is_tracer
from lightflyer.array.tree import flatten, leaves

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
        if not is_traceable(args):
            return function(*args)  # type: ignore[call-arg]
        memory = call.memory.setdefault(wrapper, {})
        if not memory:  # by a function of its own, as JAX finds again what it has traced
            memory[None] = call.jax.jit(partial(function))
        return memory[None](*args)

    return wrapper  # type: ignore[return-value]


def is_traceable(args: Any) -> bool:
    """Whether JAX computes, and may take these for arguments: a user's model may hold no arrays."""
    return call.jax is sys.modules.get("jax", call) and all(
        is_tracer(leaf) or is_numeric(leaf) for leaf in leaves(args)
    )


def part_known(
    function: Callable[[Any, Any], Any], known: Any, unknown: Any, name: str
) -> tuple[tuple[Any, ...], Callable[[tuple[Any, ...], Any], Any]]:
    """What JAX can compute of a function by its first argument, and the rest of the function.

    A loop that calls the rest, or a derivative of it, is compiled without what it does not change.
    A function of the same name is split once for arguments alike, within a call of a public one.
    """
    memory, (given, form) = call.memory.setdefault(part_known, {}), flatten(known)
    key = name, form, *map(call.jax.typeof, (*given, *leaves(unknown)))
    found = memory.get(key) or _split(function, known, unknown, len(given))
    consts, first, rest = found
    if not any(map(is_tracer, consts)):  # which belong to what is traced now
        memory[key] = found
    return tuple(first(*consts, *given)), rest


def _split(function: Callable[[Any, Any], Any], known: Any, unknown: Any, count: int) -> Any:
    from jax.extend.core import ClosedJaxpr, Literal, jaxpr_as_fun

    jax = call.jax
    closed, shape = jax.make_jaxpr(function, return_shape=True)(known, unknown)
    whole, form = closed.jaxpr, jax.tree.structure(shape)
    begin, end = [*whole.constvars, *whole.invars[:count]], whole.invars[count:]
    computed, early, late = {*begin}, [], []
    for step in whole.eqns:
        if all(isinstance(one, Literal) or one in computed for one in step.invars):
            early.append(step)
            computed.update(step.outvars)
        else:
            late.append(step)
    used = [*whole.outvars, *(one for step in late for one in step.invars)]
    kept = [one for one in used if not isinstance(one, Literal) and one in computed]
    kept = list(dict.fromkeys(kept))

    def program(inputs: Any, steps: Any, outputs: Any) -> Any:
        part = whole.replace(constvars=(), invars=inputs, eqns=steps, outvars=outputs)
        return jax.jit(jaxpr_as_fun(ClosedJaxpr(part, ())))

    rest = program([*kept, *end], late, whole.outvars)
    return (
        closed.consts,
        program(begin, early, kept),
        (lambda values, unknown: form.unflatten(rest(*values, *leaves(unknown)))),
    )
