"""Channels of a height map's file: which one is a height."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from lightflyer.array.records import ShortRepr
from lightflyer.core.errors import ConfigurationError
from lightflyer.core.units import scale_and_offset

_PREFERRED = ("height", "zsensor", "z-axis", "topography")
"""Parts of the names of channels with heights; the first one found is read."""

_BARE = ("z", "z trace")
_NO_HEIGHT = re.compile(
    r"phase|ampl|deflect|lateral|friction|current|potential|freq|adhesion|modulus|dissip|error"
    r"|deform|stiffness|intensity|bias",
    re.I,
)


@dataclass(frozen=True)
class Channel(ShortRepr):
    """A channel of a file, not read yet."""

    name: str
    unit: str  #: Of its values; empty where the file does not state it
    shape: tuple[int, int]  #: Rows and columns
    width: float  #: Size along the rows and along the columns [m]
    length: float  #: Size along the rows and along the columns [m]
    #: Returns the heights [m], shape (rows, columns), NaN where the instrument has none
    read: Callable[[], np.ndarray]

    @property
    def is_height(self) -> bool:
        """Whether neither name nor unit says that its values are something else."""
        return _may_be_height(self.name) and (not self.unit or metres(self.unit) is not None)

    @property
    def description(self) -> str:
        """Name and unit."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


def metres(unit: str) -> float | None:
    """A unit of length in metres; none if it is not a length."""
    try:
        return scale_and_offset(unit, "m")[0] if unit else None
    except ConfigurationError:
        return None


def choose_channel(
    path: Path, channels: Sequence[Channel], wanted: str | None
) -> tuple[Channel, str]:
    """The named channel, or the first with heights; returns ``channel``, ``note``."""
    named = with_different_names(channels)
    listed = ", ".join(one.description for one in named)
    if wanted is not None:
        found = next((one for one in named if one.name.lower() == wanted.lower()), None)
        if found is None:
            raise ConfigurationError(
                f'{path}: has no channel "{wanted}"; choose one by --channel: {listed}'
            )
        if not found.is_height:
            raise ConfigurationError(
                f'{path}: channel "{found.description}" is not a height; choose one by --channel: '
                f"{listed}"
            )
        return found, ""
    heights = [one for one in named if one.is_height]
    found = _first_height(named, heights)
    if found is None:
        if len(named) == 1:
            raise ConfigurationError(f'{path}: its channel "{listed}" is not a height')
        what = "several channels of heights" if heights else "no channel of heights"
        raise ConfigurationError(f"{path}: has {what}; choose one by --channel: {listed}")
    others = ", ".join(one.name for one in heights if one is not found)
    note = f"{found.name} is read; other heights in the file, by --channel: {others}"
    return found, note if others else ""


def _first_height(named: Sequence[Channel], heights: Sequence[Channel]) -> Channel | None:
    for part in _PREFERRED:
        for one in heights:
            if part in one.name.lower():
                return one
    bare = [one for one in heights if one.name.lower() in _BARE]
    if bare:
        return bare[0]
    lengths = [one for one in heights if one.unit]
    if len(lengths) == 1:
        return lengths[0]
    return heights[0] if heights and len(named) == 1 else None


def _may_be_height(name: str) -> bool:
    wrong = _NO_HEIGHT.search(name)
    return wrong is None or ("height" in name.lower() and "error" not in name.lower())


def with_different_names(channels: Sequence[Channel]) -> list[Channel]:
    """The same channels; the second of two with one name gets "(2)" appended."""
    seen: dict[str, int] = {}
    named = []
    for one in channels:
        name = one.name or "channel" * (len(channels) > 1)
        count = seen[name] = seen.get(name, 0) + 1
        named.append(replace(one, name=name if count == 1 else f"{name} ({count})"))
    return named
