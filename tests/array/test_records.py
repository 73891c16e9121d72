"""Records: what a dataclass cannot do, and what JAX sees of them."""

import abc
import dataclasses
import inspect
import subprocess
import sys

import jax
import numpy as np
import pytest

from lightflyer.array.records import AbstractClassVar, AbstractVar, Module, field


class Base(Module):
    size: AbstractVar[float]
    kind: AbstractClassVar[str]

    @abc.abstractmethod
    def area(self): ...


class Square(Base):
    size: float = field(converter=float)
    kind = "square"
    name: str = field(static=True, default="a")

    def __check_init__(self):
        if self.size < 0.0:
            raise ValueError("negative")

    def area(self):
        return self.size**2


class Half(Base):
    whole: object
    kind = "half"

    @property
    def size(self):
        return 0.5 * self.whole.size

    def area(self):
        return self.size * self.whole.size


class Counted(Module):
    count: int

    def __init__(self, *entries):
        self.count = len(entries)


class CountedTwice(Counted):
    def twice(self):
        return 2 * self.count


def test_converters_then_checks():
    assert Square("3").size == 3.0
    with pytest.raises(ValueError, match="negative"):
        Square(-1)


def test_what_is_named_only_must_be_given():
    class Nameless(Base):
        size: float

        def area(self):
            return 0.0

    with pytest.raises(TypeError, match="Nameless is abstract: it lacks kind"):
        Nameless(1.0)
    with pytest.raises(TypeError, match="Base is abstract: it lacks kind, size"):
        Base()
    assert Half(Square(2)).area() == 2.0

    class Shapeless(Base):
        size: float = 1.0
        kind = "shapeless"

    with pytest.raises(TypeError, match="area"):
        Shapeless()


def test_a_record_does_not_change():
    square = Square(1.0)
    with pytest.raises(dataclasses.FrozenInstanceError):
        square.size = 2.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        del square.size
    assert dataclasses.replace(square, size="4").size == 4.0


def test_a_constructor_of_its_own_is_kept_by_subclasses():
    assert CountedTwice(1, 2, 3).twice() == 6
    with pytest.raises(dataclasses.FrozenInstanceError):
        CountedTwice().count = 1


def test_signature_and_text_are_those_of_a_dataclass():
    assert list(inspect.signature(Square).parameters) == ["size", "name"]
    assert repr(Half(Square(1.0))) == "Half(whole=Square(size=1.0))"  # without what is usual


def test_jax_differentiates_and_maps_records():
    slope = jax.grad(lambda square: square.area())(Square(3.0))
    assert (type(slope), float(slope.size), slope.name) == (Square, 6.0, "a")
    many = jax.vmap(Half)(np.arange(3.0))
    assert (type(many), many.whole.shape) == (Half, (3,))
    keys = [jax.tree_util.keystr(path) for path, _ in jax.tree_util.tree_leaves_with_path(slope)]
    assert keys == [".size"]


LATE = """
import sys
import lightflyer as lf
disk = lf.Disk(lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, 0.8, 0.9), 0.01)
assert "jax" not in sys.modules
{load}
with lf.float64():
    assert jnp.ones(1).dtype == "float64"
assert jnp.ones(1).dtype == "float32"
lf.Disk(disk.film, 0.01)  # a record or a public function notices that JAX is there
from lightflyer.array import tree
assert len(jax.tree.leaves(disk)) == len(tree.leaves(disk)) > 5
assert float(jax.jit(lambda disk: 2 * disk.radius)(disk)) == jnp.float32(0.02)
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    "load",
    [
        "import jax, jax.numpy as jnp",
        "from lightflyer.array.namespace import load_jax; jax = load_jax(); jnp = jax.numpy",
    ],
    ids=["by the user", "by the package"],
)
def test_records_made_before_jax_is_loaded_are_pytrees(load):
    code = LATE.format(load=load)
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert found.returncode == 0, found.stderr
