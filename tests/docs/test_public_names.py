"""Every name at the top of the package is on the page that lists them by subject."""

import re
from pathlib import Path

import lightflyer as lf

PAGE = Path(__file__).parents[2] / "docs" / "api.rst"


def test_the_page_lists_every_name():
    page = PAGE.read_text(encoding="utf-8")
    listed = set(re.findall(r"^   (?:\w+\.)*(\w+)$", page, flags=re.MULTILINE))
    rooms = set(re.findall(r"^\.\. currentmodule:: lightflyer\.(\w+)$", page, flags=re.MULTILINE))
    rooms |= set(re.findall(r"^   (\w+)\.\w+$", page, flags=re.MULTILINE))
    rooms |= set(re.findall(r"^``lf\.(\w+)``", page, flags=re.MULTILINE))
    names = {name for name in lf.__all__ if name != "__version__"}
    assert "predict" in names
    assert names <= listed | rooms, names - listed - rooms
