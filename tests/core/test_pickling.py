"""Objects of a script's own classes in another process."""

import pickle
import subprocess
import sys
from typing import ClassVar

import cloudpickle
import jax
import numpy as np
import pytest

from lightflyer.array.records import AbstractVar, Module, field
from lightflyer.core.entry_point import entry_point
from lightflyer.core.errors import ParameterError
from lightflyer.core.extras import dumps
from lightflyer.core.quantity import Checked, Length

FACTOR = 3.0


class Base(Checked):
    side: AbstractVar[Length]

    def describe(self):
        return f"of {self.side:g} m"


class Inner(Module):
    rows: np.ndarray
    words: str = field(static=True, default="words")
    more: dict = field(default_factory=dict)

    def __init__(self, rows):
        self.rows = FACTOR * rows
        self.words = "own"
        self.more = {}


class Square(Base):
    names: ClassVar[tuple[str, ...]] = ("square",)
    inner: Inner
    side: Length = 2.0

    def describe(self):
        return "square " + super().describe() + f", {isinstance(self, Square)}"

    @property
    def area(self):
        return self.side**2

    @entry_point
    def scaled(self, by):
        return self.area * by * self.inner.rows

    @classmethod
    def large(cls):
        return cls(Inner(np.ones(2)), 100.0)


CODE = """
import pickle, sys
import jax, numpy as np
from lightflyer.core.extras import dumps
square, again, kind = pickle.load(open(sys.argv[1], "rb"))
assert square.describe() == "square of 4 m, True" and square.names == ("square",)
assert type(square) is type(again) is kind
leaves, structure = jax.tree.flatten(square)
assert len(leaves) == 2 and structure == jax.tree.structure(again)
np.testing.assert_array_equal(square.scaled(2.0), [96.0, 192.0])
np.testing.assert_array_equal(jax.jit(lambda s: s.scaled(2.0))(square), [96.0, 192.0])
assert kind.large().area == 1e4 and kind.large().inner.words == "own"
try:
    kind(square.inner, -1.0)
except ValueError as error:
    assert "side" in str(error)
else:
    raise AssertionError
open(sys.argv[1], "wb").write(dumps(square))
"""


def test_a_class_of_a_script_is_whole_in_another_process(tmp_path):
    module = sys.modules[__name__]
    cloudpickle.register_pickle_by_value(module)
    try:
        square = Square(Inner(np.array([1.0, 2.0])), 4.0)
        path = tmp_path / "square"
        path.write_bytes(dumps((square, Square(square.inner), Square)))
        subprocess.run([sys.executable, "-c", CODE, str(path)], check=True, cwd=tmp_path)
    finally:
        cloudpickle.unregister_pickle_by_value(module)
    back = pickle.loads(path.read_bytes())
    assert back.side == 4.0
    assert jax.tree.structure(back) is not None
    with pytest.raises(ParameterError):
        type(back)(square.inner, -1.0)


def test_without_cloudpickle_importable_classes_are_pickled(monkeypatch):
    monkeypatch.setitem(sys.modules, "cloudpickle", None)
    assert pickle.loads(dumps(Checked())) == Checked()
