"""Files that are whole or not there."""

import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from lightflyer.foundation.errors import OutputError


@contextmanager
def output_directory(directory: Path) -> Iterator[Callable[[str], Path]]:
    """Write several files into a directory, all of them or none.

    Parameters
    ----------
    directory : Path
        Made if it does not exist.

    Yields
    ------
    callable
        Takes a final file name, which may lie in a subfolder, returns the temporary path to
        write. When the block ends without an error each file is renamed to its final name;
        otherwise all are removed.

    Raises
    ------
    OutputError
        If the directory cannot be made or written.
    """
    made = not directory.exists()
    try:
        directory.mkdir(parents=True, exist_ok=True)
        staging = tempfile.TemporaryDirectory(prefix=".lightflyer-", dir=directory)
    except OSError as error:
        raise OutputError(f"{directory}: cannot be written: {error.strerror}") from None
    names: list[str] = []

    def stage(name: str) -> Path:
        names.append(name)
        path = Path(staging.name) / name
        path.parent.mkdir(parents=True, exist_ok=True)
        return path

    finished = False
    try:
        with staging:
            yield stage
            for name in names:
                (directory / name).parent.mkdir(exist_ok=True)
                os.replace(Path(staging.name) / name, directory / name)
        finished = True
    except OSError as error:
        raise OutputError(f"{directory}: cannot be written: {error.strerror or error}") from None
    finally:
        if made and not finished and directory.exists() and not any(directory.iterdir()):
            directory.rmdir()
