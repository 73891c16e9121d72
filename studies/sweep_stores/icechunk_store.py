"""The sweep's store on Icechunk's transactions, as short as it gets: what the trial compares.

Offers what `lightflyer.parametric.run` uses of `lightflyer.compute.store`: `open_store`,
`write_chunk`, `Store`. A chunk is written in a fork of the session, which a commit merges; whether
a chunk is done stands in an array beside the outputs. Chunks carry the same CRC-32C as the
package's own store, as Icechunk itself has no checksum of them.
"""

import json
import warnings
from contextlib import contextmanager
from pathlib import Path

import icechunk
import numpy as np
import zarr
from zarr.codecs import Crc32cCodec

from lightflyer.compute.evaluation import Chunks
from lightflyer.compute.store import empty_dataset, versions
from lightflyer.core.errors import OutputError

_DONE, _FAILURES, _NOT_DONE = "chunk_failures", "failures", -1


def _repository(folder):
    return icechunk.Repository.open(icechunk.local_filesystem_storage(str(folder)))


def write_chunk(folder, chunks, chunk, outputs):
    """Write a chunk in a fork of a session; returns the fork, which a commit merges."""
    fork = _repository(folder).writable_session("main").fork()
    group = zarr.open_group(fork.store, mode="r+")
    for name, values in outputs.items():
        group[name].blocks[chunks.place(chunk)] = np.reshape(values, chunks.extent(chunk))
    return fork


class Store:
    """A repository with the results of a study."""

    def __init__(self, folder, study, chunks):
        self.folder, self.chunks, self.token = folder, chunks, str(folder)
        self._names, self._repository = study.outputs, _repository(folder)
        group = zarr.open_group(self._repository.readonly_session("main").store, mode="r")
        failures = group[_DONE][...]
        committed = np.flatnonzero(failures != _NOT_DONE)
        self.damaged = [int(chunk) for chunk in committed if not self._is_intact(group, chunk)]
        self.done = {int(chunk): failures[chunk] for chunk in committed}
        for chunk in self.damaged:
            del self.done[chunk]

    def _is_intact(self, group, chunk):
        try:
            for name in self._names:
                if np.isnan(group[name].blocks[self.chunks.place(chunk)]).all():
                    return False  # a chunk that is lost reads as fill values
        except Exception:  # of Icechunk, of the codec, of the file system
            return False
        return True

    @property
    def missing(self):
        """Numbers of the chunks that are yet to be computed."""
        return [chunk for chunk in range(len(self.chunks)) if chunk not in self.done]

    @property
    def failures(self):
        """Number of designs that have not converged."""
        return int(sum(self.done.values()))

    def commit(self, chunk, fork, failures):
        """Count a chunk as done."""
        session = self._repository.writable_session("main")
        session.merge(fork)
        zarr.open_group(session.store, mode="r+")[_DONE][chunk] = failures
        session.commit(f"chunk {chunk}")
        self.done[chunk] = failures

    def finish(self):
        """Record in the attributes that it is complete."""
        session = self._repository.writable_session("main")
        group = zarr.open_group(session.store, mode="r+")
        attributes = {"complete": not self.missing, "not_converged": self.failures}
        if {**group.attrs} | attributes != {**group.attrs}:
            group.attrs.update(attributes)
            session.commit("finished")


@contextmanager
def open_store(folder, study, most_in_chunk):
    """Make a repository, or open one to continue it."""
    folder, description = Path(folder), study.description() | versions()
    try:
        storage = icechunk.local_filesystem_storage(str(folder))
        if not icechunk.Repository.exists(storage):
            if folder.exists() and any(folder.iterdir()):
                raise OutputError(f"{folder}: already exists and is not a sweep")
            icechunk.Repository.create(storage)
        session = _repository(folder).writable_session("main")
        if not zarr.open_group(session.store, mode="a").attrs:  # or it was cut off before
            _describe(session, study, description, Chunks.of(study.shape, most_in_chunk))
        session = _repository(folder).readonly_session("main")
        group = zarr.open_group(session.store, mode="r")
        if json.loads(group.attrs["description"]) != description:
            raise OutputError(f"{folder}: holds another study")
        chunks = Chunks(study.shape, tuple(group.attrs["block"]))
        yield Store(folder, study, chunks)
    except (icechunk.IcechunkError, OSError) as error:
        if isinstance(error, OutputError):
            raise
        raise OutputError(f"{folder}: cannot be written: {error}") from error


def _describe(session, study, description, chunks):
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Consolidated metadata")
        empty_dataset(study).to_zarr(session.store, mode="a", consolidated=False, zarr_format=3)
    group = zarr.open_group(session.store, mode="r+")
    for name in study.outputs:
        group.create_array(
            name,
            shape=chunks.shape,
            chunks=chunks.block,
            dtype="float64",
            fill_value=np.nan,
            compressors=[Crc32cCodec()],
            dimension_names=[dimension.name for dimension in study.dimensions],
            attributes={**study.known_outputs[name].attributes},
        )
    group.create_array(
        _DONE, shape=(len(chunks),), dtype="int64", fill_value=_NOT_DONE, dimension_names=["chunk"]
    )
    group.attrs.update(description=json.dumps(description), block=chunks.block)
    session.commit("study")
