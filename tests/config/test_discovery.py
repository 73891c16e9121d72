import json
import os
import subprocess
import sys
from functools import cache

import pytest

import lightflyer as lf
from lightflyer.core import extras
from lightflyer.files.result_text import unwrap
from lightflyer.flyer.base import FlyerSection

WORKS = """
from typing import Literal
import lightflyer as lf

class Square(lf.flyer.DiskSection):
    shape: Literal["square-of-a-plug-in"]
"""


@pytest.fixture
def plug_ins(tmp_path):
    """Folder of an installed package that declares two plug-ins, of which the first is broken."""
    (tmp_path / "broken_plug_in.py").write_text('raise ZeroDivisionError("no\\nreason")\n')
    (tmp_path / "working_plug_in.py").write_text(WORKS)
    about = tmp_path / "plug_ins-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: plug-ins\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(
        "[lightflyer]\nbroken = broken_plug_in\nworking = working_plug_in\n"
    )
    return tmp_path


SAYS = (
    "plug-in broken (broken_plug_in) cannot be imported and is left out: "
    "ZeroDivisionError: no reason"
)


def test_a_broken_plug_in_is_one_warning_and_its_neighbour_works(plug_ins, monkeypatch):
    monkeypatch.syspath_prepend(plug_ins)
    monkeypatch.setattr(FlyerSection, "alternatives", dict(FlyerSection.alternatives))
    monkeypatch.setattr(extras, "_waiting", cache(extras._waiting.__wrapped__))
    with pytest.warns(lf.PluginWarning) as told:
        extras.load_plugins()
    assert [str(warning.message) for warning in told] == [SAYS]
    assert "square-of-a-plug-in" in FlyerSection.alternatives


@pytest.mark.slow
def test_a_command_says_so_in_one_line_and_goes_on(plug_ins, flyer_file):
    path = os.pathsep.join([str(plug_ins), *filter(None, [os.environ.get("PYTHONPATH")])])
    found = subprocess.run(
        [sys.executable, "-m", "lightflyer", "predict", str(flyer_file()), "--json"],
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert found.returncode == 0, found.stderr
    assert "altitude_band_km" in json.loads(found.stdout)
    assert unwrap(found.stderr) == [f"lightflyer: warning: {SAYS}"]
