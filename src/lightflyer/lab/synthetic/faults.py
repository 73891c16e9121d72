"""Faults that make a synthetic file look like a laboratory's."""

from collections.abc import Sequence

import numpy as np

from lightflyer.core.units import scale_and_offset

TORR = scale_and_offset("Torr", "Pa")[0]  # [Pa]


def label(name: str, truth: str) -> list[str]:
    """First lines of every synthetic file; comment lines; ``name``: name of the measurement."""
    return [f'# SYNTHETIC: made by "lightflyer lab example {name}", not measured', f"# {truth}"]


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
