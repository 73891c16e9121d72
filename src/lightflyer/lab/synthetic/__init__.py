"""Synthetic raw files with known truth, with the faults that a laboratory's files have."""

from collections.abc import Sequence
from importlib import import_module
from typing import NamedTuple

import numpy as np

from lightflyer.core.errors import ParameterError
from lightflyer.core.units import scale_and_offset

TORR = scale_and_offset("Torr", "Pa")[0]  # [Pa]

# by measurement: module here, its function that makes the files, commands that reduce them
_EXAMPLES = {
    "force": ("gas", "force_files", (
        'force vane.csv --diameter "12 cm" --hot "419 K" --cold "394 K" --out force',
    )),
    "ftir": ("spectra", "ftir_files", (
        "ftir film.jdx --out ftir", "ftir film.csv --reflectance film-reflectance.csv",
    )),
    "levitation": ("gas", "levitation_files", (
        "levitation levitation.csv --out levitation", "levitation launchpads.csv",
    )),
    "optics": ("spectra", "optics_files", ("optics sample.toml --out optics",)),
    "roughness": ("spectra", "roughness_files", ("roughness {} --out roughness",)),
    "tac": ("gas", "tac_files", (
        "tac tac-raw.csv --calibration tac-resistance.csv", "tac tac-reduced.txt --out tac",
        "tac --top tac-top.txt --bottom tac-bottom.txt --out faces",
    )),
    "thermography": ("spectra", "thermography_files", (
        'thermography thermal.csv --band "7.5-14 um" --accuracy "0.5 K" --out thermography',
        "thermography light-meter.csv --light-meter",
    )),
}  # fmt: skip


class Example(NamedTuple):
    """Synthetic files and the commands that reduce them."""

    files: dict[str, str | bytes]  # Content by file name
    commands: list[str]  # Arguments of ``lightflyer lab``


def example_files(name: str, seed: int = 0) -> Example:
    """Synthetic raw files of a measurement, each labelled as synthetic.

    Parameters
    ----------
    name : str
        Name of the measurement.
    seed : int
        Seed of the noise.

    Returns
    -------
    Example

    Raises
    ------
    ParameterError
        If the name is unknown.
    """
    if name not in _EXAMPLES:
        raise ParameterError(f'there are no synthetic files for "{name}"')
    module, make, commands = _EXAMPLES[name]
    files = getattr(import_module(f"lightflyer.lab.synthetic.{module}"), make)(seed)
    return Example({**files}, [one.format(" ".join(files)) for one in commands])


def label(name: str, truth: str) -> list[str]:
    """First lines of every synthetic file; comment lines; ``name``: name of the measurement."""
    return [f'# SYNTHETIC: made by "lightflyer lab example {name}", not measured', f"# {truth}"]


def cells(formats: str, *columns: np.ndarray) -> list[list[str]]:
    """Rows of a table, each column in its format, such as ``".4g .2f"``."""
    every = formats.split()
    return [
        [format(one, form) for one, form in zip(row, every, strict=True)]
        for row in zip(*columns, strict=True)
    ]


def faulty_table(
    lines: Sequence[str],
    header: Sequence[str],
    rows: Sequence[Sequence[str]],
    rng: np.random.Generator,
    *,
    delimiter: str = ",",
    decimal_comma: bool = False,
    shuffled: bool = False,
) -> str:
    """Text of a table with the faults of real ones; ``lines``: first lines."""
    order = rng.permutation(len(rows)) if shuffled else np.arange(len(rows))
    texts = [list(rows[index]) for index in order]
    first, second, third, fourth = sorted(rng.choice(np.arange(2, len(rows) - 2), 4, replace=False))
    texts[second][-1] = ""
    texts[third][-1] = "OVLD"
    joined = [delimiter.join(row) for row in texts]
    if decimal_comma:
        joined = [row.replace(".", ",") for row in joined]
    joined[fourth] = "# lamp door opened, row lost"
    joined.insert(first, joined[first])
    mark = "\N{ZERO WIDTH NO-BREAK SPACE}" if decimal_comma else ""
    return mark + "\n".join([*lines, delimiter.join(header), *joined]) + "\n"
