"""Rows that are pasted again narrow intervals: every bench says so."""

import shlex

import pytest


@pytest.mark.parametrize(
    ("name", "file", "options"),
    [
        ("tac", "tac-reduced.txt", ""),
        ("levitation", "levitation.csv", "--draws 100"),
        ("thermography", "thermal.csv", '--band "7.5-14 um" --accuracy "0.5 K"'),
        ("thermography", "light-meter.csv", "--light-meter"),
        ("force", "vane.csv", '--diameter "12 cm" --hot "419 K" --cold "394 K"'),
    ],
)
def test_rows_pasted_twice_are_told(lab, examples, name, file, options):
    path = examples(name) / file
    lines = path.read_text(encoding="utf-8-sig").splitlines()
    rows = [line for line in lines if not line.startswith("#")]
    for content, pasted in ((rows, False), (rows + rows[1:], True)):
        path.write_text("\n".join(content) + "\n", encoding="utf-8")
        code, out, err = lab(name, file, *shlex.split(options))
        assert code == 0
        assert ("rows are copies of others" in out + err) is pasted
