"""The documentation's own tools."""

import sys
from pathlib import Path

import numpy as np
import pytest

from lightflyer.core.entry_point import entry_point
from lightflyer.design.tables import tabulate

DOCS = Path(__file__).parents[2] / "docs"
EXTENSIONS = DOCS / "_extensions"
if str(EXTENSIONS) not in sys.path:
    sys.path.insert(0, str(EXTENSIONS))


@pytest.fixture(scope="session")
def calculator_files():
    """Folder with the scripts and the style that the calculator's page loads."""
    from calculator import written

    return written(DOCS / "_build" / ".doctrees" / "calculator")  # where the pages' build keeps it


tabulated = entry_point(
    lambda setup, place: tabulate(setup, place, setup.environment.radiation.irradiance)
)
"""All outputs of setups at places, by their names."""


def require_outputs(rows, table, agreement):
    """Compare the outputs that JavaScript gives, in the order in which they are shown."""
    from calculator.model import SHOWN

    found = np.array([[float(value) for value in row[: len(SHOWN)]] for row in rows]).T
    found = dict(zip(SHOWN, found, strict=True))
    for name in [one for one in SHOWN if one in table]:
        right = np.broadcast_to(np.asarray(table[name]), len(rows))
        size = np.abs(right) + (found["own_mass"] if name == "payload" else 0.0)
        finite = np.isfinite(right)
        # infinite and NaN in the same places
        np.testing.assert_array_equal(found[name][~finite], right[~finite], err_msg=name)
        off = np.abs(found[name][finite] - right[finite]) / (size[finite] + 1e-300)
        assert off.max(initial=0.0) < agreement, name
