"""Work of a function that does not depend on its arguments, done once ahead of all calls."""

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
from jax.extend.core import ClosedJaxpr, Jaxpr, JaxprEqn, Literal
from jax.extend.core.primitives import jit_p


def ahead(function: Callable[..., Any], *arguments: jax.ShapeDtypeStruct) -> Callable[..., Any]:
    """Compute now what a function needs whatever its arguments are.

    For a function that is traced many times, as the residual of a root-find is: what stands in
    every trace has to be compiled every time.

    Parameters
    ----------
    function : callable
        Traceable by JAX; it may close over tracers.
    *arguments : jax.ShapeDtypeStruct
        Shapes and types of its arguments.

    Returns
    -------
    callable
        The same function, of arguments that are broadcast to these shapes. Differentiable in them
        and in what ``function`` closes over.

    Examples
    --------
    >>> number = jax.ShapeDtypeStruct((), jnp.float32)
    >>> double = ahead(lambda x: {"sum": x + jnp.sin(0.0), "root": jnp.sqrt(4.0)}, number)
    >>> print(double(3.0))
    {'root': Array(2., dtype=float32, weak_type=True), 'sum': Array(3., dtype=float32)}
    """
    closed, result = jax.make_jaxpr(function, return_shape=True)(*arguments)
    slots = [_Slot() for _ in arguments]
    steps: list[_Step] = []
    outputs = _split(closed, slots, steps)
    structure = jax.tree.structure(result)

    def late(*given: Any) -> Any:
        values = {
            slot: jnp.broadcast_to(jnp.asarray(value, like.dtype), like.shape)
            for slot, value, like in zip(slots, given, arguments, strict=True)
        }
        for step in steps:
            found = _bind(step.equation, [_value(entry, values) for entry in step.inputs])
            values.update(zip(step.outputs, found, strict=True))
        return jax.tree.unflatten(structure, [_value(entry, values) for entry in outputs])

    return late


class _Slot:
    """Stands for a value that is known only when the function is called."""


class _Step(NamedTuple):
    """An operation left for the call."""

    equation: JaxprEqn
    inputs: list[Any]
    outputs: list[_Slot]


def _value(entry: Any, values: dict[_Slot, Any]) -> Any:
    return values[entry] if isinstance(entry, _Slot) else entry


def _split(closed: ClosedJaxpr, inputs: Iterable[Any], steps: list[_Step]) -> list[Any]:
    """Compute what is known; append the rest to the steps. Returns values and slots."""
    jaxpr: Jaxpr = closed.jaxpr
    known = dict(zip(jaxpr.constvars, closed.consts, strict=True))
    known.update(zip(jaxpr.invars, inputs, strict=True))

    def read(atom: Any) -> Any:
        return atom.val if isinstance(atom, Literal) else known[atom]

    for equation in jaxpr.eqns:
        entries = [read(atom) for atom in equation.invars]
        if not any(isinstance(entry, _Slot) for entry in entries):
            found = _bind(equation, entries)
        elif equation.primitive is jit_p:
            found = _split(equation.params["jaxpr"], entries, steps)
        else:
            found = [_Slot() for _ in equation.outvars]
            steps.append(_Step(equation, entries, found))
        known.update(zip(equation.outvars, found, strict=True))
    return [read(atom) for atom in jaxpr.outvars]


def _bind(equation: JaxprEqn, values: list[Any]) -> list[Any]:
    functions, parameters = (), equation.primitive.get_bind_params(equation.params)
    if isinstance(parameters, tuple):  # JAX before 0.10
        functions, parameters = parameters
    found = equation.primitive.bind(*functions, *values, **parameters)
    return found if equation.primitive.multiple_results else [found]
