"""What was computed, kept in a folder: the same call goes on where it was interrupted."""

import json
import zipfile
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from lightflyer.array import tree
from lightflyer.core.atomic_files import output_directory
from lightflyer.core.errors import OutputError
from lightflyer.design.design import AbstractDesign, digest
from lightflyer.environment.wind.gridded import winds_in_files
from lightflyer.mission.path.integration import TerminationReason, Track


def describe_work(design: AbstractDesign, parts: Mapping[str, Any]) -> dict[str, str]:
    """Everything that decides results, in words that can be compared; ``parts``: pytrees."""
    from lightflyer.compute.store import versions  # with all of a study

    described = dict(design.description()) | versions()
    winds = winds_in_files(design.setup)  # whose data are no numbers of the design
    if winds:
        stores = (str(wind.store.key) for wind in winds if wind.store)
        described["files of the wind"] = ", ".join(stores)
    for name, part in parts.items():
        described[name] = f"{tree.structure(part)} {digest(*tree.leaves(part))}"
    return described


class WorkFolder:
    """Parts of one work in a folder, which is made if there is none; ``kind``: what it is."""

    def __init__(self, folder: Path, record: str, kind: str, described: dict[str, str]) -> None:
        self._folder, path = folder, folder / record
        try:
            there = folder.exists() and (not folder.is_dir() or any(folder.iterdir()))
            stored = json.loads(path.read_text(encoding="utf-8")) if path.exists() else None
        except (OSError, ValueError) as error:
            raise OutputError(f"{path}: cannot be read: {error}") from None
        if stored is None and there:
            raise OutputError(f"{folder}: already exists and is no {kind}; choose another folder")
        if stored == described:
            return
        if stored is not None and any(folder.glob("*.npz")):
            names = {**stored, **described}
            unlike = [name for name in names if stored.get(name) != described.get(name)]
            raise OutputError(
                f"{folder}: holds another {kind}, which differs in {', '.join(unlike[:3])}; choose "
                "another folder or remove it"
            )
        with output_directory(folder, shared=True) as stage:
            stage(record).write_text(json.dumps(described, indent=1), encoding="utf-8")

    def read(self, name: str) -> dict[str, Any] | None:
        """Arrays of a part by name; None where there is none, or not a whole one."""
        try:
            with np.load(self._folder / f"{name}.npz") as content:
                return dict(content)
        except (OSError, ValueError, KeyError, zipfile.BadZipFile, EOFError):
            return None

    def write(self, name: str, arrays: Mapping[str, Any]) -> None:
        """Keep the arrays of a part."""
        with output_directory(self._folder, shared=True) as stage:
            np.savez(stage(f"{name}.npz"), **arrays)

    def tracks(self, number: int, fly: Callable[[], Track]) -> Track:
        """Tracks of flights, by a number: those that are kept, or those flown now."""
        name = f"flights-{number:06d}"
        stored = self.read(name)
        if stored is not None:
            return Track(**stored)
        track = fly()
        interrupted = np.equal(track.termination, TerminationReason.INTERRUPTED)
        if np.size(interrupted) and not np.any(interrupted):
            self.write(name, vars(track))
        return track


def keeps_flights(folder: Path) -> bool:
    """Whether a folder has flights of an interrupted mission."""
    return any(folder.glob("flights-*.npz"))


def forget_flights(folder: Path) -> None:
    """Remove the flights that a folder has kept, and the folder where it has nothing else."""
    for path in (*folder.glob("flights-*.npz"), folder / "flights.json"):
        path.unlink(missing_ok=True)
    with suppress(OSError):
        folder.rmdir()
