"""Plug-ins in this process; `test_extending.py` has them installed, and through commands."""

from functools import cache

import pytest

import lightflyer as lf
from lightflyer.core import extras
from lightflyer.flyer.base import FlyerSection

WORKS = """
from typing import Literal
import lightflyer as lf

class Square(lf.flyer.DiskSection):
    shape: Literal["square-of-a-plug-in"]
"""
SAYS = (
    "plug-in broken (broken_plug_in) cannot be imported and is left out: "
    "ZeroDivisionError: no reason"
)


def test_a_broken_plug_in_is_one_warning_and_its_neighbour_works(tmp_path, monkeypatch):
    (tmp_path / "broken_plug_in.py").write_text('raise ZeroDivisionError("no\\nreason")\n')
    (tmp_path / "working_plug_in.py").write_text(WORKS)
    about = tmp_path / "plug_ins-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: plug-ins\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(
        "[lightflyer]\nbroken = broken_plug_in\nworking = working_plug_in\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(FlyerSection, "alternatives", dict(FlyerSection.alternatives))
    monkeypatch.setattr(extras, "_waiting", cache(extras._waiting.__wrapped__))
    with pytest.warns(lf.PluginWarning) as told:
        extras.load_plugins()
    assert [str(warning.message) for warning in told] == [SAYS]
    assert "square-of-a-plug-in" in FlyerSection.alternatives
