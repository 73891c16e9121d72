"""Division of the designs of a study into chunks that are computed and stored together."""

import math
from dataclasses import dataclass

CHUNK = 2**18  # Designs in a chunk by default: 2 MB of each output


@dataclass(frozen=True)
class Chunks:
    """Equal blocks of a grid, each of which holds designs with consecutive numbers."""

    shape: tuple[int, ...]  # Shape of the grid
    block: tuple[int, ...]  # Shape of a chunk; the last along a dimension may reach beyond the grid

    @classmethod
    def of(cls, shape: tuple[int, ...], most: int = CHUNK) -> "Chunks":
        """Divide a grid into chunks of at most so many designs."""
        # Trailing dimensions stay whole, one is cut into even parts, leading ones are taken point
        # by point: so a chunk's designs have consecutive numbers.
        block: list[int] = []
        left = most
        for length in reversed(shape):
            parts = math.ceil(length / max(left, 1))
            block.insert(0, math.ceil(length / parts))
            left = left // length if parts == 1 else 1
        return cls(shape, tuple(block))

    @property
    def counts(self) -> tuple[int, ...]:
        """Number of chunks along each dimension."""
        return tuple(
            math.ceil(length / part) for length, part in zip(self.shape, self.block, strict=True)
        )

    def __len__(self) -> int:
        return math.prod(self.counts)

    def place(self, chunk: int) -> tuple[int, ...]:
        """Number of a chunk along each dimension."""
        place: list[int] = []
        for count in reversed(self.counts):
            chunk, rest = divmod(chunk, count)
            place.insert(0, rest)
        return tuple(place)

    def number(self, place: tuple[int, ...]) -> int:
        """Number of the chunk at a place."""
        number = 0
        for count, there in zip(self.counts, place, strict=True):
            number = number * count + there
        return number

    def part(self, chunk: int) -> tuple[slice, ...]:
        """A chunk's part of the grid."""
        return tuple(
            slice(number * part, min((number + 1) * part, length))
            for length, part, number in zip(self.shape, self.block, self.place(chunk), strict=True)
        )

    def span(self, chunk: int) -> tuple[int, int]:
        """First design of a chunk, and the one after its last."""
        start, size = 0, 1
        for length, part, number in zip(self.shape, self.block, self.place(chunk), strict=True):
            start = start * length + number * part
            size *= min(part, length - number * part)
        return start, start + size

    def extent(self, chunk: int) -> tuple[int, ...]:
        """Shape of a chunk's part of the grid."""
        return tuple(
            min(part, length - number * part)
            for length, part, number in zip(self.shape, self.block, self.place(chunk), strict=True)
        )
