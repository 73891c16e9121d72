"""The notebooks run without a warning, and the numbers that they check are right."""

import runpy
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import pytest

pytestmark = pytest.mark.snippets

NOTEBOOKS = sorted((Path(__file__).parents[2] / "docs" / "notebooks").glob("*.py"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_the_notebook_runs_and_its_numbers_are_right(path):
    mpl.use("agg")
    assert "\nassert " in path.read_text(encoding="utf-8")
    runpy.run_path(str(path), run_name="notebook")
    plt.close("all")
