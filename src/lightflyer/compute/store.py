"""A sweep's results on disk: a Zarr group that survives being killed at any moment.

A chunk's outputs are one file each, written under a temporary name, flushed to the disk and
renamed. Once all of them exist, a line with their checksums goes into a journal beside them, and
only then does the chunk count as done. A process that continues trusts nothing: it reads every file
that the journal names, compares it with its checksum, and computes damaged chunks again; one that
reads results compares too (:mod:`lightflyer.compute.reading`). The files are what the Zarr format
prescribes for an array without compression but with a CRC-32C, so any reader of Zarr opens the
group, and detects a damaged chunk too.
"""

import json
import os
import shutil
import tempfile
import uuid
import warnings
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import lightflyer
from lightflyer.compute.evaluation import Chunks
from lightflyer.core.atomic_files import PARTIAL, write_whole
from lightflyer.core.errors import OutputError
from lightflyer.core.extras import extra, version_of
from lightflyer.study.study import Study

if TYPE_CHECKING:
    import xarray as xr

RECORDS, STUDY, JOURNAL = ".lightflyer", "study.json", "journal"
"""A folder in a store's, and in it the study and which of its chunks are done."""

METADATA = "zarr.json"  # of a group or an array
CHECKSUM_BYTES = 4  # at the end of a chunk's file
_LOCK, _REPAIR = "lock", "repair-"
_PROGRESS = {"complete", "not_converged"}  # attributes that change while a sweep goes on
_MOST_DIFFERENCES = 12

Record = dict[str, int]  # Checksum of each output's file of a chunk


def require_extra() -> None:
    """Raise :class:`MissingExtraError` unless Zarr and its companions are installed."""
    for module in ("filelock", "google_crc32c", "zarr"):
        extra(module, "a sweep into a folder", "sweep")


def versions() -> dict[str, str]:
    """Versions of the packages that a result's last bits depend on."""
    return {
        "lightflyer": lightflyer.__version__,
        "numpy": np.__version__,
        "jaxlib": version_of("jaxlib"),
    }


def write_chunk(folder: Path, chunks: Chunks, chunk: int, outputs: Mapping[str, Any]) -> Record:
    """Write one chunk of every output; it does not count before it is committed."""
    import google_crc32c

    record = {}
    extent = chunks.extent(chunk)
    inside = tuple(slice(length) for length in extent)
    for name, values in outputs.items():
        block = np.reshape(values, extent)
        if extent != chunks.block:
            # Zarr stores complete chunks, also at the edge of the grid
            padded = np.full(chunks.block, np.nan)
            padded[inside] = block
            block = padded
        content = np.ascontiguousarray(block, "<f8").tobytes()
        record[name] = google_crc32c.value(content)
        checksum = record[name].to_bytes(CHECKSUM_BYTES, "little")
        write_atomically(chunk_file(folder, name, chunks, chunk), content, checksum)
    return record


def chunk_file(folder: Path, name: str, chunks: Chunks, chunk: int) -> Path:
    """File of a chunk of an output."""
    return Path(folder, name, "c", *map(str, chunks.place(chunk)))


def write_atomically(path: Path, *parts: bytes) -> None:
    """Write a file as a whole or not at all, and the folder that it is in."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, *parts)


class Store:
    """A folder with the results of a study, locked for one writer."""

    # Made by :func:`open_store`.

    def __init__(self, folder: Path, study: Study, chunks: Chunks):
        self.folder, self.chunks = folder, chunks
        self._names = study.outputs
        self.token = str(stored_study(folder)["token"])
        self._journal_path = folder / RECORDS / JOURNAL
        content = self._journal_path.read_bytes() if self._journal_path.exists() else b""
        entries = {entry["chunk"]: entry for entry in journal_entries(self.folder)}
        self._remove_leftovers()
        # entries of intact chunks, and numbers of the others
        self.done = {chunk: entry for chunk, entry in entries.items() if self._is_intact(entry)}
        self.damaged = sorted(set(entries) - set(self.done))
        repaired = b"".join(map(_journal_line, self.done.values()))
        if repaired != content:
            write_atomically(self._journal_path, repaired)
        self._journal = self._journal_path.open("ab")

    @property
    def missing(self) -> list[int]:
        """Numbers of the chunks that are yet to be computed."""
        return [chunk for chunk in range(len(self.chunks)) if chunk not in self.done]

    @property
    def failures(self) -> int:
        """Number of designs that have not converged."""
        return sum(entry["failures"] for entry in self.done.values())

    def commit(self, chunk: int, record: Record, failures: int) -> None:
        """Count a chunk as done, now that all its files are written."""
        entry = {"chunk": chunk, "crc32c": record, "failures": failures}
        self._journal.write(_journal_line(entry))
        self._journal.flush()
        os.fsync(self._journal.fileno())
        self.done[chunk] = entry

    def finish(self) -> None:
        """Record in the group's attributes that it is complete; remove what killed writers left."""
        self._remove_leftovers()
        attributes = {"complete": not self.missing, "not_converged": self.failures}
        path, metadata = self.folder / METADATA, _metadata(self.folder)
        if metadata["attributes"] | attributes != metadata["attributes"]:
            metadata["attributes"] |= attributes
            write_atomically(path, json.dumps(metadata).encode())

    def close(self) -> None:
        self._journal.close()

    def _remove_leftovers(self) -> None:
        for leftover in self.folder.rglob(f"*{PARTIAL}"):
            leftover.unlink(missing_ok=True)
        for leftover in (self.folder / RECORDS).glob(f"{_REPAIR}*"):
            shutil.rmtree(leftover, ignore_errors=True)

    def _is_intact(self, entry: dict[str, Any]) -> bool:
        import google_crc32c

        for name in self._names:
            try:
                path = chunk_file(self.folder, name, self.chunks, entry["chunk"])
                content = memoryview(path.read_bytes())
            except OSError:
                return False
            stored = int.from_bytes(content[-CHECKSUM_BYTES:], "little")
            found = google_crc32c.value(content[:-CHECKSUM_BYTES].tobytes())
            if not found == stored == entry["crc32c"].get(name):
                return False
        return True


def _journal_line(entry: dict[str, Any]) -> bytes:
    import google_crc32c

    text = json.dumps(entry, sort_keys=True).encode()
    return b"%08x %s\n" % (google_crc32c.value(text), text)


def journal_entries(folder: Path) -> Iterator[dict[str, Any]]:
    """Entries of a store's journal; lines that were cut or damaged are left out."""
    path = folder / RECORDS / JOURNAL
    content = path.read_bytes() if path.exists() else b""
    for line in content.splitlines(keepends=True):
        try:
            entry = json.loads(line[9:])
        except ValueError:
            continue
        kinds = {"chunk": int, "crc32c": dict, "failures": int}
        if (
            isinstance(entry, dict)
            and _journal_line(entry) == line
            and all(isinstance(entry.get(name), kind) for name, kind in kinds.items())
        ):
            yield entry


def stored_study(folder: Path) -> dict[str, Any]:
    """Token, shape of the chunks, description and checksums of the study of a store."""
    content = json.loads((folder / RECORDS / STUDY).read_text(encoding="utf-8"))
    kinds = {"token": str, "block": list, "description": dict}
    if (
        not isinstance(content, dict)
        or not all(isinstance(content.get(name), kind) for name, kind in kinds.items())
        or not all(isinstance(part, int) and part > 0 for part in content["block"])
        # version 0.2 recorded none
        or content.pop("crc32c", _checksum(content)) != _checksum(content)
    ):
        raise ValueError(f"{STUDY} is not the description of a store")
    return content


def _write_record(folder: Path, study: Study, token: str, content: dict[str, Any]) -> None:
    """Write what a store holds, with the checksums of its coordinates and descriptions."""
    content = {"token": token} | content | {
        "coordinates": coordinate_checksums(empty_dataset(study)),
        "group": group_checksums(folder, _names_in_group(study)),
    }  # fmt: skip
    text = json.dumps(content | {"crc32c": _checksum(content)}, indent=1)
    write_atomically(folder / RECORDS / STUDY, text.encode())


def _checksum(content: Any) -> int:
    """Checksum of what can be written as JSON."""
    import google_crc32c

    return int(google_crc32c.value(json.dumps(content, sort_keys=True).encode()))


def coordinate_checksums(dataset: "xr.Dataset") -> dict[str, int]:
    """Checksum of the values of each coordinate."""
    import google_crc32c

    return {
        str(name): google_crc32c.value(np.ascontiguousarray(values, "<f8").tobytes())
        for name, values in dataset.coords.items()
    }


def group_checksums(folder: Path, names: Collection[str]) -> dict[str, int]:
    """Checksums of the group's attributes and of the descriptions of arrays."""
    # Readers take the group's copy of the descriptions; ValueError where it is another.
    group = _metadata(folder)
    told = group["consolidated_metadata"]["metadata"]
    if any(told[name] != _metadata(folder / name) for name in names):
        raise ValueError("two descriptions of one array differ")
    attributes = {k: v for k, v in group["attributes"].items() if k not in _PROGRESS}
    return {"": _checksum(attributes)} | {name: _checksum(told[name]) for name in sorted(names)}


@contextmanager
def open_store(folder: Path, study: Study, most_in_chunk: int) -> Iterator[Store]:
    """Make a store, or open one to continue it."""
    require_extra()
    import filelock

    folder = Path(folder)
    description = study.description() | versions()
    try:
        whole = sweep_around(folder)
        if whole is not None:
            raise OutputError(f"{folder}: is within the sweep {whole}; choose another folder")
        records = folder / RECORDS
        is_free = not folder.exists() or (folder.is_dir() and not any(folder.iterdir()))
        if not (is_free or records.is_dir()):
            raise OutputError(f"{folder}: already exists and is not a sweep; choose another folder")
        records.mkdir(parents=True, exist_ok=True)
        with filelock.FileLock(records / _LOCK).acquire(timeout=0):
            if not (records / STUDY).is_file():
                _create(folder, study, description, Chunks.of(study.shape, most_in_chunk))
            try:
                stored = stored_study(folder)
            except ValueError:
                raise _damaged_record(folder, records / STUDY) from None
            require_same(folder, stored["description"], description)
            if len(stored["block"]) != len(study.shape):
                raise _damaged_record(folder, records / STUDY)
            chunks = Chunks(study.shape, tuple(stored["block"]))
            if not _group_is_intact(folder, study, chunks, stored):
                _repair_group(folder, study, chunks, stored)
            store = Store(folder, study, chunks)
            try:
                yield store
            finally:
                store.close()
    except filelock.Timeout:
        raise OutputError(
            f"{folder}: another process is writing to it; wait for it or choose another folder"
        ) from None
    except OSError as error:
        if isinstance(error, OutputError):
            raise
        raise OutputError(
            f"{folder}: cannot be written: {error.strerror or error}; complete chunks are kept and "
            "the same command continues"
        ) from None


def sweep_around(folder: Path) -> Path | None:
    """The sweep whose folder a path is in."""
    return next((path for path in folder.absolute().parents if (path / RECORDS).is_dir()), None)


def require_same(folder: Path, stored: dict[str, str], asked: dict[str, str]) -> None:
    """Raise with the differences unless two descriptions are the same."""
    lines = [
        f"  {name}: {stored.get(name, 'not given')} there, {asked.get(name, 'not given')} now"
        for name in dict.fromkeys([*stored, *asked])
        if stored.get(name) != asked.get(name)
    ]
    if list(stored) != list(asked) and not lines:
        lines = ["  the order of the fields"]
    if lines:
        more = len(lines) - _MOST_DIFFERENCES
        shown = lines[:_MOST_DIFFERENCES] + ([f"  and {more} more"] if more > 0 else [])
        first = f"{folder}: holds another study; choose another folder or remove it"
        raise OutputError("\n".join([first, *shown]))


def _damaged_record(folder: Path, path: Path) -> OutputError:
    """Error about a store's own record that cannot be read."""
    return OutputError(
        f"{folder}: {path.relative_to(folder)} is damaged or missing; restore it, choose another "
        "folder, or remove this one"
    )


def _names_in_group(study: Study) -> set[str]:
    """Names of the arrays that a new store holds."""
    coordinates = (name for dimension in study.dimensions for name in dimension.values)
    return {*study.outputs, *study.fixed, *coordinates}


def _create(folder: Path, study: Study, description: dict[str, str], chunks: Chunks) -> None:
    """Fill a store's folder; writing the study, which comes last, makes it a store."""
    journal, mine = folder / RECORDS / JOURNAL, _names_in_group(study)
    if journal.is_file() and journal.stat().st_size:
        raise _damaged_record(folder, folder / RECORDS / STUDY)
    leftovers = [path for path in folder.iterdir() if path.name != RECORDS]
    if not all(path.name in mine or path.name.startswith("zarr.") for path in leftovers):
        raise OutputError(
            f"{folder}: is an unfinished sweep among other files; choose another folder"
        )
    for leftover in leftovers:
        shutil.rmtree(leftover) if leftover.is_dir() else leftover.unlink()
    content = {"block": list(chunks.block), "description": description}
    try:
        _write_group(folder, study, chunks)
        write_atomically(folder / RECORDS / JOURNAL)
        _write_record(folder, study, uuid.uuid4().hex, content)
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise


def _write_group(folder: Path, study: Study, chunks: Chunks) -> None:
    """Coordinates, empty outputs and attributes."""
    import zarr
    from zarr.codecs import Crc32cCodec

    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=f"Object at {RECORDS}")
        # in the format's newest version it is an addition; readers that do not know it skip it
        warnings.filterwarnings("ignore", message="Consolidated metadata")
        empty_dataset(study).to_zarr(folder, mode="a", consolidated=False, zarr_format=3)
        group, known = zarr.open_group(folder, mode="r+"), study.known_outputs
        for name in study.outputs:
            group.create_array(
                name,
                shape=chunks.shape,
                chunks=chunks.block,
                dtype="float64",
                fill_value=np.nan,
                compressors=[Crc32cCodec()],
                dimension_names=[dimension.name for dimension in study.dimensions],
                attributes={**known[name].attributes},
            )
        zarr.consolidate_metadata(folder)


def _group_is_intact(folder: Path, study: Study, chunks: Chunks, stored: dict[str, Any]) -> bool:
    """Whether a reader finds the coordinates and the metadata of the outputs."""
    import zarr

    try:
        group: Any = zarr.open_group(folder, mode="r", use_consolidated=False)
        coordinates = empty_dataset(study).coords
        return (
            all(np.array_equal(group[name][...], values) for name, values in coordinates.items())
            and all(
                (group[name].shape, group[name].chunks) == (chunks.shape, chunks.block)
                for name in study.outputs
            )
            and stored.get("group") == group_checksums(folder, _names_in_group(study))
        )
    except (OSError, ValueError, LookupError, TypeError, RuntimeError):  # as decoders raise them
        return False


def _metadata(folder: Path) -> Any:
    return json.loads((folder / METADATA).read_text(encoding="utf-8"))


def _repair_group(folder: Path, study: Study, chunks: Chunks, stored: dict[str, Any]) -> None:
    """Rewrite coordinates, attributes and metadata of the outputs; chunks stay as they are."""
    with tempfile.TemporaryDirectory(dir=folder / RECORDS, prefix=_REPAIR) as name:
        fresh = Path(name)
        _write_group(fresh, study, chunks)
        for path in fresh.rglob("*"):
            if path.is_file():
                write_atomically(folder / path.relative_to(fresh), path.read_bytes())
    _write_record(folder, study, stored["token"], stored)


def empty_dataset(study: Study) -> "xr.Dataset":
    """A dataset with the coordinates and attributes of a study, without outputs."""
    import xarray as xr

    fields = study.fields
    coordinates: dict[str, Any] = {
        name: (dimension.name, values, fields[name].attributes)
        for dimension in study.dimensions
        for name, values in dimension.values.items()
    }
    for name, value in study.fixed.items():
        coordinates[name] = ((), value, fields[name].attributes)
    attributes = {
        "title": "lightflyer sweep",
        "study": study.text,
        "configuration": study.design.text,
        "versions": json.dumps(versions()),
        "lightflyer_version": lightflyer.__version__,
        "assumptions": "; ".join(study.design.setup.environment.assumptions()),
        "warnings": "; ".join(study.design.warnings),
        "complete": False,
        "not_converged": 0,
    }
    return xr.Dataset(coords=coordinates, attrs=attributes)
