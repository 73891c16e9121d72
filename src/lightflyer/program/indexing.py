"""Windows of arrays at places that a program computes, in NumPy."""

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from lightflyer.program.program import Length, length_of

Lengths = dict[str, int]


def shape_of(shape: Iterable[Length], lengths: Lengths) -> tuple[int, ...]:
    """A shape in numbers."""
    return tuple(length_of(length, lengths) for length in shape)


def fill_axes(value: Any, shape: Iterable[Length], lengths: Lengths) -> np.ndarray:
    """A view of a value that fills all of its axes."""
    return np.broadcast_to(value, shape_of(shape, lengths))


def dynamic_slice(
    lengths: Lengths, value: Any, *start: Any, sizes: list[Length], shape: list[Length]
) -> Any:
    """A window, moved so that it lies within."""
    full = fill_axes(value, shape, lengths)
    wanted = shape_of(sizes, lengths)
    return full[_window(full.shape, start, wanted)]


def dynamic_update_slice(
    lengths: Lengths,
    value: Any,
    update: Any,
    *start: Any,
    shape: list[Length],
    sizes: list[Length],
) -> Any:
    """An array with a window replaced, moved so that it lies within."""
    full = fill_axes(value, shape, lengths).copy()
    full[_window(full.shape, start, shape_of(sizes, lengths))] = update
    return full


def _window(shape: Sequence[int], start: Sequence[Any], sizes: Sequence[int]) -> tuple[slice, ...]:
    """A part of an array, moved so that it lies within."""
    begins = (
        min(max(int(begin), 0), length - size)
        for begin, length, size in zip(start, shape, sizes, strict=True)
    )
    return tuple(slice(begin, begin + size) for begin, size in zip(begins, sizes, strict=True))


def gather(
    lengths: Lengths,
    value: Any,
    indices: Any,
    *,
    shape: list[Length],
    index_shape: list[Length],
    offset_dims: list[int],
    start_index_map: list[int],
    collapsed: list[int],
    operand_batching: list[int],
    index_batching: list[int],
    sizes: list[Length],
    mode: str,
    fill: Any,
) -> Any:
    """A window for each index vector; a place beyond the ends is moved in, or filled."""
    full, widths = fill_axes(value, shape, lengths), shape_of(sizes, lengths)
    if np.ndim(indices) == 0 or indices.shape[-1] != len(start_index_map):
        indices = fill_axes(indices, index_shape, lengths)
    batch = indices.ndim - 1
    kept = [axis for axis in range(full.ndim) if axis not in {*collapsed, *operand_batching}]
    rank = batch + len(kept)
    inside: Any = True
    places: list[Any] = []
    for axis in range(full.ndim):
        place: Any = np.zeros((1,) * rank, int)
        if axis in kept:
            place = np.arange(widths[axis]).reshape(
                [-1 if batch + kept.index(axis) == at else 1 for at in range(rank)]
            )
        if axis in start_index_map:
            begin = indices[..., start_index_map.index(axis)]
            last = full.shape[axis] - widths[axis]
            if mode == "fill":
                inside = inside & (begin >= 0) & (begin <= last)
            begin = np.minimum(np.maximum(begin, 0), last)
            place = place + begin.reshape(begin.shape + (1,) * len(kept))
        if axis in operand_batching:
            along = index_batching[operand_batching.index(axis)]
            count = full.shape[axis]
            place = np.arange(count).reshape([-1 if at == along else 1 for at in range(rank)])
        places.append(place)
    found = full[tuple(places)] if places else full
    if mode == "fill" and not np.all(inside):
        outside = ~np.reshape(inside, np.shape(inside) + (1,) * len(kept))
        found = np.where(outside, _filling(fill, found.dtype), found)
    found = np.reshape(found, (1,) * (rank - found.ndim) + found.shape)
    return np.moveaxis(found, range(batch, rank), offset_dims) if kept else found


def _filling(stated: Any, dtype: np.dtype) -> Any:
    if stated is not None:
        return stated
    if dtype.kind == "f":
        return math.nan
    return True if dtype.kind == "b" else np.iinfo(dtype).min


def scatter(
    lengths: Lengths,
    value: Any,
    indices: Any,
    updates: Any,
    *,
    shape: list[Length],
    index_shape: list[Length],
    update_shape: list[Length],
    window_dims: list[int],
    inserted: list[int],
    start_index_map: list[int],
    operand_batching: list[int],
    index_batching: list[int],
    add: bool,
    mode: str,
) -> Any:
    """An array with windows replaced or added to; windows that do not fit are left out."""
    full = fill_axes(value, shape, lengths).copy()
    places = fill_axes(indices, index_shape, lengths)
    new = fill_axes(updates, update_shape, lengths)
    batch = [axis for axis in range(new.ndim) if axis not in window_dims]
    new = np.transpose(new, [*batch, *window_dims])
    single = {*inserted, *operand_batching}
    kept = [axis for axis in range(full.ndim) if axis not in single]
    for where in np.ndindex(*places.shape[:-1]):
        begins, part = [0] * full.ndim, new[where]
        widths = [1] * full.ndim
        for axis, width in zip(kept, part.shape, strict=True):
            widths[axis] = width
        for axis, begin in zip(start_index_map, places[where], strict=True):
            last = full.shape[axis] - widths[axis]
            begins[axis] = int(begin) if mode != "clip" else min(max(int(begin), 0), last)
        for axis, along in zip(operand_batching, index_batching, strict=True):
            begins[axis] = where[along]
        if any(
            begin < 0 or begin + width > length
            for begin, width, length in zip(begins, widths, full.shape, strict=True)
        ):
            continue
        into = tuple(
            begin if axis in single else slice(begin, begin + widths[axis])
            for axis, begin in enumerate(begins)
        )
        full[into] = full[into] + part if add else part
    return full
