"""Numbers of many records of the lab bench in one table."""

import csv
import io
import json
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from lightflyer.core.errors import ConfigurationError
from lightflyer.lab.commands import measurements
from lightflyer.lab.estimate import Estimate

HEADLINES = {
    "levitation": ("optimal_pressure", "minimum_irradiance"),
    "tac": ("tac", "tac_top", "tac_bottom", "difference"),
    "thermography": ("emissivity", "absorptivity"),
    "ftir": ("emissivity", "emissivity_upper_bound"),
    "roughness": ("rms_height",),
    "force": ("measured_over_predicted",),
}
"""Numbers that a measurement is made for, where these are not all; of optics, all fitted."""

_DETAILS = ("monte_carlo", "maps", "runs", "top", "bottom")  # parts of a record, beside its result


class RecordedNumber(NamedTuple):
    """One measured number of a record."""

    folder: str  # of the record
    command: str
    quantity: str  # with the names of what it is part of, such as "samples, Ge, optimal_pressure"
    estimate: Estimate
    warnings: int  # of its record

    @property
    def name(self) -> str:
        """The quantity in words, without the group that all of its kind are in."""
        return self.quantity.removeprefix("samples, ").removeprefix("numbers, ").replace("_", " ")

    @property
    def is_headline(self) -> bool:
        """Whether it is what its measurement was made for."""
        *parts, last = self.quantity.split(", ")
        if self.command == "optics":
            return parts[:1] == ["numbers"]
        return last in HEADLINES.get(self.command, (last,)) and not {*parts} & {*_DETAILS}


def collect_records(folders: str | Path | Sequence[str | Path]) -> list[RecordedNumber]:
    """Every number with an interval in the records of folders and of what lies in them.

    Parameters
    ----------
    folders : str, path, or sequence of these

    Returns
    -------
    list of RecordedNumber
        In the order of the paths.

    Raises
    ------
    ConfigurationError
        If a folder does not exist or has no record, or a record is damaged.
    """
    found: list[RecordedNumber] = []
    commands = measurements()  # whose records are NAME.json
    if isinstance(folders, str | Path):
        folders = [folders]
    if not all(isinstance(folder, str | Path) for folder in folders):
        raise ConfigurationError("folders must be paths")
    for folder in map(Path, folders):
        if not folder.is_dir():
            raise ConfigurationError(f"{folder}: is not a folder")
        records = sorted(
            path for path in folder.rglob("*.json") if path.stem in commands and path.is_file()
        )
        if not records:
            names = ", ".join(f"{name}.json" for name in commands)
            raise ConfigurationError(f"{folder}: has no record of the lab bench ({names})")
        for path in records:
            try:
                content = json.loads(path.read_text(encoding="utf-8"))
                warnings = len(content["warnings"])
                found += [
                    RecordedNumber(str(path.parent), path.stem, ", ".join(name), estimate, warnings)
                    for name, estimate in _estimates(content, ())
                ]
            except (OSError, ValueError, KeyError, TypeError, RecursionError):
                raise ConfigurationError(
                    f"{path}: is not a record of lightflyer, or is damaged"
                ) from None
    return list(dict.fromkeys(found))


def _estimates(content: Any, name: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Estimate]]:
    if not isinstance(content, dict):
        return
    if {"value", "interval_95"} <= content.keys():
        low, high = content["interval_95"]
        ends = (-math.inf if low is None else float(low), math.inf if high is None else float(high))
        spread = content.get("standard_uncertainty")
        spread = None if spread is None else float(spread)
        yield name, Estimate(float(content["value"]), ends, str(content.get("unit", "")), spread)
        return
    for key, part in content.items():
        yield from _estimates(part, (*name, key))


def table_text(entries: Sequence[RecordedNumber]) -> str:
    """The numbers as a table of commas, one a line."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    headings = (
        "folder,command,quantity,value,lower 95 %,upper 95 %,standard uncertainty,unit,warnings"
    )
    writer.writerow(headings.split(","))
    for one in entries:
        number, unit = one.estimate, one.estimate.unit or "1"
        every = (number.value, *number.interval, number.uncertainty)
        numbers = ("" if x is None else f"{x:.10g}" for x in every)
        writer.writerow([one.folder, one.command, one.quantity, *numbers, unit, one.warnings])
    return text.getvalue()
