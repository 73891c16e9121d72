"""The documentation's own tools."""

import sys
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
EXTENSIONS = DOCS / "_extensions"
if str(EXTENSIONS) not in sys.path:
    sys.path.insert(0, str(EXTENSIONS))


@pytest.fixture(scope="session")
def calculator_files():
    """Folder with the scripts and the style that the calculator's page loads."""
    from calculator import written

    return written(DOCS / "_build" / ".doctrees" / "calculator")  # where the pages' build keeps it
