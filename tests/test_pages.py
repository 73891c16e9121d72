"""Examples, and two pages' own code, as a reader would run them."""

import re
import runpy
from pathlib import Path

import numpy as np
import pytest

import lightflyer as lf

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"


def run_page(name):
    """Run a page's Python in the order of the page; returns what it defines."""
    blocks = re.findall(r"^```python\n(.*?)^```", (DOCS / name).read_text("utf-8"), re.S | re.M)
    assert blocks
    namespace = {"__name__": f"page_{Path(name).stem.replace('-', '_')}"}
    for block in blocks:
        exec(compile(block, name, "exec"), namespace)
    return namespace


def test_sandwich_page():
    names = run_page("sandwich.md")
    masses = lf.payload(names["sandwich"], names["state"], lf.Schafer2025())
    assert masses.shape == names["gaps"].shape
    assert np.all(masses > 0.0)


def test_compare_page():
    found = run_page("compare.md")["found"]
    assert found.best.name == "4 cm"
    assert found.best.prediction.best.values["payload"] == pytest.approx(6.45e-7, rel=1e-3)
    there = found.dataset.payload_per_area.sel(altitude=72e3, method="nearest")
    assert [f"{1e3 * float(value):.2g}" for value in there] == ["1.2", "1", "0.16"]


@pytest.mark.parametrize("name", ["reproduce_paper_band", "calibrate_synthetic_points"])
def test_example_runs_and_its_numbers_hold(name, capsys):
    runpy.run_path(str(ROOT / f"examples/{name}.py"), run_name="__main__")
    assert capsys.readouterr().out
