"""The documentation's own tools."""

import sys
from pathlib import Path

import pytest

EXTENSIONS = Path(__file__).parents[2] / "docs" / "_extensions"
if str(EXTENSIONS) not in sys.path:
    sys.path.insert(0, str(EXTENSIONS))


@pytest.fixture(scope="session")
def calculator_files(tmp_path_factory):
    """Folder with the scripts and the style that the calculator's page loads."""
    from calculator import write

    folder = tmp_path_factory.mktemp("calculator")
    write(folder)
    return folder
