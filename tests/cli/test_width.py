"""No message is wider than 80 columns, whatever is asked for; paths and tables may be."""

import pytest

from lightflyer.files.result_text import NARROW

GOOD = [
    "predict flyer.toml --samples 0 --verbose",
    "predict layers.toml --samples 0 --verbose", "predict laden.toml --samples 0",
    "film layers.toml", "fly mission.toml", "materials", "doctor",
    "drift flyer.toml", "stability laden.toml", "swarm flyer.toml --payload 100mg",
    "calibrate points.csv --flyer chamber.toml",
]  # fmt: skip
BAD = [
    "predict gone.toml", "predict points.csv", "predict flyer.toml flyer.toml",
    "predict flyer.toml --samples -3", "predict flyer.toml --at 7", "predict comma.toml",
    "predict twice.toml", "predict empty.toml", "map", "swarm", "sweep", "optimise flyer.toml",
    "spread mission.toml", "init x.toml --kind nothing", "init flyer.toml", "lab summary",
    "lab tac flyer.toml", "calibrate flyer.toml", "fly flyer.toml", "sensitivity flyer.toml",
    "predict sun.toml --samples 0", "optimise idle.toml", "drift flyer.toml --altitudes 1km",
]  # fmt: skip


@pytest.fixture
def folder(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    kinds = {"flyer": "earth", "best": "optimise"}
    for name in ("flyer", "layers", "laden", "mission", "chamber", "best"):
        assert run("init", f"{name}.toml", "--kind", kinds.get(name, name))[0] == 0
    assert run("init", "points.csv", "--kind", "points")[0] == 0
    text = (tmp_path / "flyer.toml").read_text(encoding="utf-8")
    best = (tmp_path / "best.toml").read_text(encoding="utf-8")
    mission = (tmp_path / "mission.toml").read_text(encoding="utf-8")
    changed = {
        "comma": text.replace("emittance = 0.08", "emittance = 0,08"),
        "twice": text.replace("[film]", "[film]\n[film]"),
        "sun": text.replace('"1361 W/m^2"', '"1 sun"'),
        "idle": best.replace(
            "altitude =", '"flyer.payload" = { from = "0 g", to = "1 mg" }\naltitude ='
        ),
        "mission": mission.replace('duration = "48 h"', 'duration = "1 h"'),
        "empty": "",
    }
    for name, content in changed.items():
        (tmp_path / f"{name}.toml").write_text(content, encoding="utf-8")


@pytest.mark.parametrize("asked", [GOOD, BAD], ids=["good", "bad"])
def test_no_message_is_wider_than_a_narrow_terminal(run, folder, capsys, monkeypatch, asked):
    monkeypatch.setenv("COLUMNS", "200")
    for words in asked:
        code, out, _ = run(*words.split())  # which measures what goes to the error stream
        assert (code == 0) == (asked is GOOD or words.startswith("predict sun")), words
        wide = [
            line for line in out.splitlines()
            if len(line) > NARROW and not line.startswith((" ", "next: ", "┃", "│", "┡", "└", "┏"))
        ]  # fmt: skip
        assert not wide or words in ("materials",), (words, wide)
