"""Reading a store: what its journal counts as done is there as it was written, or it is refused.

Descriptions, coordinates and the ends of all chunks' files are compared with what was recorded when
the store is opened. The files themselves are hashed as they are read.
"""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import google_crc32c
import xarray as xr
from zarr.storage import LocalStore

from lightflyer.compute.evaluation import Chunks
from lightflyer.compute.store import (
    CHECKSUM_BYTES,
    JOURNAL,
    METADATA,
    RECORDS,
    STUDY,
    chunk_file,
    coordinate_checksums,
    group_checksums,
    journal_entries,
    stored_study,
    sweep_around,
)
from lightflyer.core.errors import ConfigurationError

if TYPE_CHECKING:
    from zarr.core.buffer import Buffer

_UNREADABLE = (OSError, ValueError, LookupError, TypeError, RuntimeError)  # as decoders raise them


class _WholeStore(LocalStore):
    """The files of a store; those of chunks are compared with their checksums."""

    def __init__(self, root: Path, chunks: Chunks, done: dict[int, dict[str, int]]):
        super().__init__(root, read_only=True)
        self._chunks, self._done = chunks, done
        self._names = {name for sums in done.values() for name in sums}

    # Zarr reads by the first, from version 3.2 on also by the second.
    async def get(self, key: str, *args: Any, **kwargs: Any) -> "Buffer | None":
        return self._whole(key, await super().get(key, *args, **kwargs))

    def get_sync(self, key: str, **kwargs: Any) -> "Buffer | None":
        return self._whole(key, super().get_sync(key, **kwargs))

    def _whole(self, key: str, content: "Buffer | None") -> "Buffer | None":
        name, *place = key.split("/")
        if name not in self._names or place[:1] != ["c"]:
            return content
        sums = self._done.get(self._chunks.number(tuple(map(int, place[1:]))))
        if sums is None:
            return None  # written, perhaps, but not yet done
        if content is None:
            raise damaged(self.root, f"{key} is missing")
        if google_crc32c.value(content.to_bytes()[:-CHECKSUM_BYTES]) != sums[name]:
            raise damaged(self.root, f"{key} is not as it was written")
        return content


def damaged(folder: Path, what: str) -> ConfigurationError:
    """Error about a store of which a part was lost after it was written."""
    return ConfigurationError(f"{folder}: {what}; the same sweep mends it")


def _without_study(folder: Path) -> ConfigurationError:
    return ConfigurationError(
        f"{folder}: {RECORDS}/{STUDY} is damaged or missing; copy it again or run the sweep into "
        "another folder"
    )


def _record_of(folder: Path) -> dict[str, Any]:
    """What a store says of itself."""
    if not (folder / RECORDS).is_dir():
        if not folder.exists():
            raise ConfigurationError(f"{folder}: does not exist")
        whole = sweep_around(folder)
        if whole is not None:
            raise ConfigurationError(f"{folder}: is a part of a sweep; name its folder, {whole}")
        if not (folder / METADATA).is_file():
            kind = "folder" if folder.is_dir() else "file"
            raise ConfigurationError(
                f"{folder}: this {kind} is not a sweep, which is the folder of lightflyer sweep"
            )
        raise ConfigurationError(
            f"{folder}: its hidden folder {RECORDS}, which says what is complete, is missing; copy "
            "the whole sweep, or read it unchecked with xarray.open_zarr"
        )
    try:
        return stored_study(folder)
    except (OSError, ValueError):
        raise _without_study(folder) from None


def read_store(folder: Path) -> xr.Dataset:
    """The results in a store; ConfigurationError where a part of it was lost."""
    stored = _record_of(folder)
    recorded = stored.get("group", {})  # version 0.2 recorded none
    try:
        told = group_checksums(folder, [name for name in recorded if name])
        with xr.open_zarr(folder, chunks=None) as plain:
            coordinates, attributes = coordinate_checksums(plain), dict(plain.attrs)
            shapes = {str(name): array.shape for name, array in plain.items()}
    except _UNREADABLE as error:
        reason = str(error) or type(error).__name__
        raise damaged(folder, f"cannot be read as a Zarr group: {reason.splitlines()[0]}") from None
    for name in recorded:
        if told[name] != recorded[name]:
            what = f"{name}/{METADATA}" if name else METADATA
            raise damaged(folder, f"{what} is not as it was written")
    for name, value in stored.get("coordinates", {}).items():
        if coordinates.get(name) != value:
            raise damaged(folder, f"{name} is not as it was written")
    done = {entry["chunk"]: entry for entry in journal_entries(folder)}
    sums = {chunk: entry["crc32c"] for chunk, entry in done.items()}
    names = [name for name in recorded if name and name not in coordinates] or list(shapes)
    if not names or len(shapes[names[0]]) != len(stored["block"]):
        raise _without_study(folder)
    chunks = Chunks(shapes[names[0]], tuple(stored["block"]))
    if attributes.get("complete") and len(done) < len(chunks):
        raise damaged(folder, f"{RECORDS}/{JOURNAL} has {len(done)} of {len(chunks)} chunks")
    _require_files(folder, names, chunks, sums)
    dataset = xr.open_zarr(_WholeStore(folder, chunks, sums), chunks=None)
    failures = sum(entry["failures"] for entry in done.values())
    dataset.attrs |= {"complete": len(done) == len(chunks), "not_converged": failures}
    return dataset


def _require_files(
    folder: Path, names: list[str], chunks: Chunks, done: dict[int, dict[str, int]]
) -> None:
    """Raise unless the file of every chunk that is done is there, and ends with its checksum."""
    lost, whole_size = [], 8 * math.prod(chunks.block) + CHECKSUM_BYTES
    for chunk, sums in sorted(done.items()):
        for name in names:
            path = chunk_file(folder, name, chunks, chunk)
            try:
                with path.open("rb", buffering=0) as file:
                    size = file.seek(-CHECKSUM_BYTES, 2) + CHECKSUM_BYTES
                    end = int.from_bytes(file.read(), "little")
                whole = (size, end) == (whole_size, sums.get(name))
                fault = "" if whole else "is not as it was written"
            except FileNotFoundError:
                fault = "is missing"
            except OSError:
                fault = "cannot be read"
            if fault:
                lost.append(f"{path.relative_to(folder)} {fault}")
    if lost:
        more = f", and {len(lost) - 1} more of its files are lost" if len(lost) > 1 else ""
        raise damaged(folder, lost[0] + more)
