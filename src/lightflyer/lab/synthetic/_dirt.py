"""What makes a synthetic file look like a laboratory's."""

from collections.abc import Sequence

import numpy as np

from lightflyer.foundation.units import scale_and_offset

TORR = scale_and_offset("Torr", "Pa")[0]
"""In pascal."""


def label(name: str, truth: str) -> list[str]:
    """First lines of every synthetic file.

    Parameters
    ----------
    name : str
        Of the measurement.
    truth : str
        What the file was made from.

    Returns
    -------
    list of str
        Comment lines.
    """
    return [f'# SYNTHETIC: made by "lightflyer lab example {name}", not measured', f"# {truth}"]


def dirty_text(
    lines: Sequence[str],
    header: Sequence[str],
    rows: Sequence[Sequence[str]],
    rng: np.random.Generator,
    *,
    delimiter: str = ",",
    decimal_comma: bool = False,
    shuffled: bool = False,
) -> str:
    """A table with the faults of real ones.

    Parameters
    ----------
    lines : sequence of str
        That come first.
    header : sequence of str
    rows : sequence of sequence of str
    rng : numpy.random.Generator
    delimiter : str
    decimal_comma : bool
        Write decimal commas, and a byte-order mark, as some offices' programs do.
    shuffled : bool
        Swap the order of the rows.

    Returns
    -------
    str
        With one row twice, one with an empty cell, one with an overflow, and one left out.
    """
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
