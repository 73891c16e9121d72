"""The pages of the commands: each command has one, with the options of its help."""

import re
from pathlib import Path

import pytest

from lightflyer.cli import app

options = pytest.importorskip("command_options", reason="Sphinx is not installed").options

PAGES = Path(__file__).parents[2] / "docs" / "commands"


def _names(where, before=()):
    """Commands and subcommands, as they are written."""
    for name in where:
        if not name.startswith("-"):
            yield " ".join((*before, name))
            yield from _names(where[name], (*before, name))


def _first_words(lines, text):
    """Options with which lines of the help begin; of "--force --no-force" both."""
    begun = re.findall(lines, text, re.M)
    words = " ".join(re.match(r"(--[\w-]+(,? )?)+", line)[0] for line in begun)
    return set(re.findall(r"--[\w-]+", words))


COMMANDS = list(_names(app))


def test_every_command_has_a_page_and_every_page_a_command():
    pages = {page.stem for page in PAGES.glob("*.md")} - {"index"}
    assert pages == {name.replace(" ", "-") for name in COMMANDS}


@pytest.mark.parametrize("name", COMMANDS)
def test_the_page_is_in_the_lists_that_lead_to_it(name):
    stem = name.replace(" ", "-")
    above = "lab.md" if " " in name else "index.md"
    text = (PAGES / above).read_text(encoding="utf-8")
    assert f"]({stem}.md)" in text
    assert f"\n{stem}\n" in text  # of the tree of contents
    page = (PAGES / f"{stem}.md").read_text(encoding="utf-8")
    assert page.startswith(f"# lightflyer {name}\n")


@pytest.mark.parametrize("name", [name for name in COMMANDS if name != "lab"])
def test_the_page_has_the_options_of_the_help(name, prints):
    offered = _first_words(r"│[ *]*(--\w.*)", prints(*name.split(), "--help"))
    listed = options(name)
    assert offered == _first_words(r"^\* `(--[^`]*)`", listed)
    page = (PAGES / f"{name.replace(' ', '-')}.md").read_text(encoding="utf-8")
    assert f"```{{command-options}} {name}\n```" in page


def test_options_within_sentences_keep_their_hyphens():
    listed = options("predict")
    assert "With `--out`, write" in listed
    assert not re.search(r"[^`\w-]--[a-z]", listed)
