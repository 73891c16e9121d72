"""Files that are whole or not there."""

import io
import os
import secrets
import shutil
import socket
import threading
import time
import warnings
import zlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from lightflyer.core.errors import OutputError, ParameterWarning

if TYPE_CHECKING:
    import xarray as xr

TEMPORARY = ".lightflyer-"  # What the names of temporary files and folders begin with

PARTIAL = ".partial"  # What the names of files end with that are being written

_ATTEMPTS = 100  # to remove a folder in which a file was just opened
_LEFT_BEHIND = 86400.0  # age of a temporary folder from which no run is at it any more [s]
_RESULTS = (".json", ".nc", ".pdf", ".png", ".svg")

# this computer among those that share a folder
_HERE = f"{zlib.crc32(socket.gethostname().encode()):08x}"

_UNFINISHED: set[Path] = set()
_CHANGING = threading.Lock()  # folders made and files renamed, not once the process ends


@contextmanager
def remove_if_interrupted(path: Path) -> Iterator[None]:
    """Have a file or folder removed if the process is interrupted within the block."""
    _UNFINISHED.add(path)
    try:
        yield
    finally:
        _UNFINISHED.discard(path)


def remove_unfinished() -> None:
    """Remove what is being written before the process ends; nothing is made or renamed then."""
    _CHANGING.acquire(timeout=5.0)  # a handler may have stopped the thread that holds it
    for path in sorted(_UNFINISHED, reverse=True):  # a folder after what lies in it
        if path.name.startswith(TEMPORARY):
            for _ in range(_ATTEMPTS):  # a file may be opened in it meanwhile
                shutil.rmtree(path, ignore_errors=True)
                if not path.is_dir():
                    break
            path.unlink(missing_ok=True)
        elif path.exists() and not any(path.iterdir()):
            path.rmdir()


def _say_what_else(directory: Path, names: set[str]) -> None:
    """Warn of results in a folder that are not of this run."""
    # a table may be what the run has read, unless it has the name of a result
    stems = {Path(name).stem for name in names}
    found = sorted(
        path.name
        for path in directory.iterdir()
        if path.suffix in _RESULTS or (path.suffix == ".csv" and path.stem in stems)
    )
    if others := [name for name in found if name not in names]:
        text = f"{directory}: not of this run, but there before: {', '.join(others)}"
        warnings.warn(text, ParameterWarning, stacklevel=3)


def _is_left_behind(folder: Path) -> bool:
    """Whether a temporary folder is that of a run that was killed."""
    if time.time() - folder.stat().st_mtime > _LEFT_BEHIND:
        return True
    host, _, rest = folder.name.removeprefix(TEMPORARY).partition("-")
    number = rest.partition("-")[0]
    # elsewhere a signal of zero is not only a question
    if os.name != "posix" or host != _HERE or not number.isdecimal():
        return False
    try:
        os.kill(int(number), 0)
    except ProcessLookupError:
        return True
    except OSError:
        pass  # another user's
    return False


def write_whole(path: Path, *parts: bytes) -> None:
    """Write a file under a temporary name, flush it to the disk and rename it."""
    path = path.resolve()  # a link stays one
    temporary = path.with_name(f"{path.name}.{secrets.token_hex(16)}{PARTIAL}")
    try:
        with temporary.open("wb") as file:
            file.writelines(parts)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise


def write_netcdf(dataset: "xr.Dataset", path: Path) -> None:
    """Write a dataset as NetCDF; OSError where the disk is full."""
    # HDF5 ends the process there, with a segmentation fault: it gets memory to write into.
    path.write_bytes(dataset.to_netcdf(engine="h5netcdf"))


Columns: TypeAlias = Mapping[str, tuple[Any, np.ndarray, Mapping[str, str]]]
"""Dimensions, values and attributes by name, as :class:`xarray.Dataset` takes them."""


def write_columns(path: Path, columns: Columns, attributes: Mapping[str, str]) -> None:
    """Write numbers as NetCDF, as xarray would, which takes as long to load as they to compute."""
    import h5netcdf

    memory = io.BytesIO()
    with h5netcdf.File(memory, "w") as file:
        for name, (dimensions, values, about) in columns.items():
            along = (dimensions,) if isinstance(dimensions, str) else tuple(dimensions)
            for dimension, size in zip(along, values.shape, strict=True):
                if dimension not in file.dimensions:
                    file.dimensions[dimension] = size
            made = file.create_variable(name, along, values.dtype, data=values, fillvalue=np.nan)
            made.attrs.update(about)
        file.attrs.update(attributes)
    path.write_bytes(memory.getvalue())


def require_directory(directory: Path) -> None:
    """Raise where nothing can be written into a directory, before anything is computed."""
    made = not directory.exists()
    with output_directory(directory, shared=True):
        pass
    if made:
        directory.rmdir()


@contextmanager
def output_directory(directory: Path, *, shared: bool = False) -> Iterator[Callable[[str], Path]]:
    """Write several files into a directory, all of them or none; others may share it."""
    made = not directory.exists()
    temporary = directory / f"{TEMPORARY}{_HERE}-{os.getpid()}-{secrets.token_hex(4)}"
    names: list[str] = []

    def stage(name: str) -> Path:
        names.append(name)
        path = temporary / name
        with _CHANGING:
            path.parent.mkdir(parents=True, exist_ok=True)
        return path

    finished = False
    try:
        # known before they are made: an interrupt may come at any moment
        with (
            remove_if_interrupted(temporary),
            remove_if_interrupted(directory) if made else nullcontext(),
        ):
            with _CHANGING:
                directory.mkdir(parents=True, exist_ok=True)
            for left in directory.glob(f"{TEMPORARY}*"):
                if left.is_dir() and _is_left_behind(left):
                    shutil.rmtree(left, ignore_errors=True)
            with _CHANGING:
                temporary.mkdir()
            yield stage
            with _CHANGING:
                for name in names:
                    (directory / name).parent.mkdir(exist_ok=True)
                    os.replace(temporary / name, directory / name)
            finished = True
            if not shared:
                _say_what_else(directory, {Path(name).parts[0] for name in names})
    except OSError as error:
        shown = Path.cwd() if directory == Path() else directory
        raise OutputError(f"{shown}: cannot be written: {error.strerror or error}") from None
    finally:
        shutil.rmtree(temporary, ignore_errors=True)
        if made and not finished and directory.exists() and not any(directory.iterdir()):
            directory.rmdir()
