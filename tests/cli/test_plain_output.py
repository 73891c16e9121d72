"""What commands print: names as they are, in any encoding."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import lightflyer
from lightflyer.cli.output import duration, in_words, with_prefix

CLI = Path(lightflyer.__file__).parent / "cli"


def test_brackets_in_names_are_no_markup(prints, refuses, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert "wrote o[red]x.toml" in prints("init", "o[red]x.toml", "--model", "lu2023")
    how = ("--samples", "0", "--format", "svg", "--out", "run [/b] x :smile:")
    assert "run [/b] x :smile:" in prints("predict", "o[red]x.toml", *how)
    refuses("predict", "a[/b].toml")
    assert "[um]" in prints("materials")


def test_one_place_makes_consoles():
    for path in CLI.rglob("*.py"):
        if path.name != "output.py":
            assert not re.search(r"\bConsole\(", path.read_text(encoding="utf-8")), path


@pytest.mark.parametrize("encoding", ["ascii", "cp1252", "utf-8"])
def test_any_encoding_of_the_terminal(flyer_file, encoding):
    printed = subprocess.run(
        [sys.executable, "-m", "lightflyer", "predict", str(flyer_file())],
        capture_output=True,
        env=os.environ | {"PYTHONIOENCODING": encoding},
        check=True,
    ).stdout.decode(encoding)
    assert {"ascii": "W/m^2", "cp1252": "W/m²", "utf-8": "W/m²"}[encoding] in printed
    assert "?" not in printed


def test_a_narrow_terminal_loses_columns_not_digits(run, flyer_file, monkeypatch):
    path = flyer_file()
    asked = ("predict", path, "--at", "70 km,72 km")
    monkeypatch.setenv("COLUMNS", "200")
    wide = run(*asked)[1]
    monkeypatch.setenv("COLUMNS", "50")
    narrow = run(*asked)[1]
    assert "…" not in narrow
    numbers = {word for word in wide.split() if word[0].isdigit()}
    assert numbers <= set(narrow.split())
    table = narrow[narrow.index("altitude") : narrow.index("warning")]
    assert not [line for line in table.splitlines() if len(line) > 50]


def test_no_table_is_wrapped_in_a_pipe(prints, monkeypatch):
    monkeypatch.delenv("COLUMNS", raising=False)
    assert max(map(len, prints("materials").splitlines())) > 100


def test_large_numbers_are_as_people_say_them():
    assert [in_words(number) for number in (12.0, 2.5e6, 3e18)] == [
        "12", "2.5 million", "3e+06 trillion",
    ]  # fmt: skip
    assert [with_prefix(number, "B") for number in (12.0, 5.2e9)] == ["12 B", "5.2 GB"]
    assert [duration(time) for time in (7500.0, 90.0, 1e9)] == ["2 hours", "90 seconds", "32 years"]
