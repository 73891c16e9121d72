"""Pytrees without JAX, beside JAX's own."""

from collections import OrderedDict
from dataclasses import dataclass
from dataclasses import field as dataclass_field
from typing import NamedTuple

import jax
import numpy as np
import pytest

import lightflyer as lf
from lightflyer.array import tree
from lightflyer.array.records import Module, field


class Pair(NamedTuple):
    left: object
    right: object


class Record(Module):
    number: object
    name: str = field(static=True, default="name")
    more: object = None


@jax.tree_util.register_dataclass
@dataclass(frozen=True)
class Foreign:
    part: object
    kind: str = dataclass_field(metadata={"static": True})


TREES = [
    1.0,
    None,
    (),
    [],
    {},
    (1.0, [2, (3.0, None)], {"b": 4.0, "a": "text"}),
    Pair(1.0, Pair(None, (2.0,))),
    Record(np.arange(3.0), "other", {"z": Record(1.0), "y": 2.0}),
    Foreign((1.0, Record(2.0)), "kind"),
    Record(Foreign([None, 3.0], "kind")),
    OrderedDict(b=1.0, a=(2.0, None)),
    {3: 1.0, 1: 2.0},
    lf.Disk(lf.FilmProperties(1e-3, 0.75, 0.08, 0.08, 0.8, 0.9), [0.01, 0.02]),
    lf.Earth(),
]


@pytest.mark.parametrize("value", TREES, ids=lambda value: type(value).__name__)
def test_leaves_and_structure_are_those_of_jax(value):
    leaves, form = tree.flatten(value)
    theirs, their_form = jax.tree.flatten(value)
    assert len(leaves) == len(theirs) == form.num_leaves
    assert all(one is other for one, other in zip(leaves, theirs, strict=True))
    numbers = list(range(len(leaves)))
    ours = tree.unflatten(form, numbers)
    assert jax.tree.structure(ours) == their_form
    assert jax.tree.leaves(ours) == jax.tree.leaves(jax.tree.unflatten(their_form, numbers))
    assert tree.structure(ours) == form
    assert hash(tree.structure(ours)) == hash(form)
    assert str(tree.structure(ours)) == str(form)


@pytest.mark.parametrize("value", TREES, ids=lambda value: type(value).__name__)
def test_leaves_may_be_chosen(value):
    def is_leaf(node):
        return node is None or isinstance(node, tuple)

    ours, theirs = tree.leaves(value, is_leaf), jax.tree.leaves(value, is_leaf=is_leaf)
    assert len(ours) == len(theirs)
    assert all(one is other for one, other in zip(ours, theirs, strict=True))


def test_structures_differ_by_class_name_and_static_fields():
    several = (
        *(Record(1.0), Record(1.0, "other"), Record(1.0, more=2.0), Foreign(1.0, "a")),
        *(Foreign(1.0, "b"), (1.0,), [1.0], Pair(1.0, 2.0), {"a": 1.0}, {"b": 1.0}),
    )
    assert len({*map(tree.structure, several)}) == len(several)


def test_a_function_of_several_pytrees():
    one = {"a": (1.0, Record(2.0)), "b": None}
    other = {"a": ([10.0], Record((20.0, 30.0))), "b": None}
    found = tree.map_leaves(lambda ours, theirs: (ours, theirs), one, other)
    assert found["a"][0] == (1.0, [10.0])
    assert found["b"] is None
    assert found["a"][1].number == (2.0, (20.0, 30.0))


@pytest.mark.parametrize("other", [(1.0,), [1.0, 2.0], (1.0, 2.0, 3.0), {"a": 1.0}], ids=repr)
def test_pytrees_that_do_not_fit(other):
    with pytest.raises(ValueError, match=r"another pytree|two pytrees"):
        tree.map_leaves(lambda *both: both, (1.0, 2.0), other)


def test_parts_are_replaced_whatever_stands_there():
    whole = Record((1.0, None), more=Record(np.ones(2)))
    found = tree.replace_at(lambda one: one.more.number, whole, 5.0)
    assert found.more.number == 5.0
    assert found.number == (1.0, None)
    assert found.name == "name"
    assert whole.more.number.tolist() == [1.0, 1.0]
    found = tree.replace_at(lambda one: one.number, whole, None)
    assert found.number is None
    assert found.more.number is whole.more.number
    found = tree.replace_at(lambda one: (one.number[1], one.more), whole, ("new", None))
    assert found.number == (1.0, "new")
    assert found.more is None
    found = tree.replace_at(lambda one: [one.number[0]], whole, [7.0])
    assert found.number == (7.0, None)


def test_equality_is_to_the_last_bit_and_of_type():
    ones = np.ones(2)
    assert tree.equal((1.0, ones), (1.0, ones.copy()))
    assert not tree.equal((1.0, ones), (1.0, ones + 1e-16 * ones + 2.3e-16))
    assert not tree.equal((1.0, ones), (1.0, ones.astype(np.float32)))
    assert not tree.equal((1.0,), [1.0])
    assert Record(1.0) == Record(1.0) != Record(2.0)
    assert hash(Record(1.0)) == hash(Record(1.0))
