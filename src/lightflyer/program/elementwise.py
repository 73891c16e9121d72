"""Functions of numbers, element by element, that JAX traces as one operation.

Traced multiplication by multiplication, polynomials and splines would be half of a prediction's
program. As primitives of their own they are one operation each, and so are their derivatives; only
compilers see them written out.
"""

import operator
from collections.abc import Callable, Sequence
from functools import cached_property, reduce
from typing import Any

from lightflyer.core.precision import float64
from lightflyer.pytree.lazy_jax import extend, jax, jnp

_ARITHMETIC: dict[str, Callable[[Any, Any], Any]] = {
    "add": operator.add,
    "max": lambda one, other: jnp.maximum(one, other),
    "mul": operator.mul,
    "sub": operator.sub,
}


def apply_jax(name: str, one: Any, other: Any) -> Any:
    """One of the operations of arithmetic that functions are written out by."""
    return _ARITHMETIC[name](one, other)


class OwnPrimitive:
    """A primitive of the package's own.

    ``compute``: the function of variables, in JAX, with parameters by their names, which can be
    hashed; ``slope``: likewise its derivative in one variable, whose place comes first.
    """

    def __init__(self, name: str, compute: Callable[..., Any], slope: Callable[..., Any]):
        self.name, self._compute, self._slope = name, compute, slope

    def __call__(self, *variables: Any, **parameters: Any) -> Any:
        """Bind variables; each is single or has, once broadcast, the shape of the result."""
        arrays = [jnp.asarray(variable, float) for variable in variables]
        shape = jnp.broadcast_shapes(*(array.shape for array in arrays))
        filled = [
            array if array.shape in ((), shape) else jnp.broadcast_to(array, shape)
            for array in arrays
        ]
        return self._primitive.bind(*filled, **parameters)

    @cached_property
    def _primitive(self) -> Any:
        from jax.interpreters import ad, batching, mlir

        primitive = extend.Primitive(self.name)
        primitive.def_impl(self._written_out)
        primitive.def_abstract_eval(_result)
        ad.primitive_jvps[primitive] = self._move
        batching.primitive_batchers[primitive] = self._map_over
        mlir.register_lowering(primitive, mlir.lower_fun(self._written_out, multiple_results=False))
        return primitive

    def _written_out(self, *variables: Any, **parameters: Any) -> Any:
        with float64():  # compilation may take place out of the function's own context
            return self._compute(*variables, **parameters)

    def _move(
        self, variables: Sequence[Any], changes: Sequence[Any], **parameters: Any
    ) -> tuple[Any, Any]:
        from jax.interpreters import ad

        parts = [
            change * self._slope(place, *variables, **parameters)
            for place, change in enumerate(changes)
            if not isinstance(change, ad.Zero)
        ]
        value = self(*variables, **parameters)
        return value, jnp.broadcast_to(reduce(jnp.add, parts), value.shape)

    def _map_over(
        self, variables: Sequence[Any], axes: Sequence[int | None], **parameters: Any
    ) -> tuple[Any, int]:
        rank = max(
            jnp.ndim(variable) + (axis is None)
            for variable, axis in zip(variables, axes, strict=True)
        )
        moved = []
        for variable, axis in zip(variables, axes, strict=True):
            if axis is not None:
                variable = jnp.moveaxis(variable, axis, 0)
                variable = variable.reshape(variable.shape + (1,) * (rank - variable.ndim))
            moved.append(variable)
        return self(*moved, **parameters), 0


def _result(*variables: Any, **parameters: Any) -> Any:  # noqa: ARG001
    largest = max(variables, key=lambda variable: len(variable.shape))
    return jax.core.ShapedArray(largest.shape, largest.dtype)
