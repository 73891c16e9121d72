"""Options that do nothing are refused, and data that count twice."""

import inspect
import shutil
from importlib import import_module
from pkgutil import iter_modules

import pytest

import lightflyer as lf
import lightflyer.cli.commands
from lightflyer.cli import lab
from lightflyer.cli.options import only_with
from lightflyer.lab.commands import measurements


def dependent_options():
    """Command, option and what it needs, of all commands that state any."""
    modules = [
        (one.name, list(vars(import_module(f"lightflyer.cli.commands.{one.name}")).values()))
        for one in iter_modules(lightflyer.cli.commands.__path__)
    ]
    for module, commands in [
        *modules,
        *((name, [getattr(lab, name)]) for name in measurements()),
    ]:
        for command in commands:
            for name, other in getattr(command, "needs", {}).items():
                yield pytest.param(command, name, other, id=f"{module}-{name}")


@pytest.mark.parametrize(("command", "option", "other"), list(dependent_options()))
def test_an_option_that_does_nothing_alone_is_refused(command, option, other):
    parameters = inspect.signature(command).parameters
    assert other in parameters
    required = [one for one in parameters.values() if one.default is inspect.Parameter.empty]
    by_place = [one.name for one in required if one.kind is one.POSITIONAL_ONLY]
    by_name = {one.name: one.name for one in required if one.kind is not one.POSITIONAL_ONLY}
    text = f"--{option} needs --{other}; alone it does nothing".replace("_", "-")
    with pytest.raises(lf.ParameterError, match=text):
        command(*by_place, **by_name, **{option: "not the default"})


def test_the_options_of_the_lab_bench_are_among_them():
    found = {one.id for one in dependent_options()}
    assert {"tac-face", "ftir-collection", "roughness-flatten_order", "calibrate-samples",
            "levitation-keep_ground_effect", "thermography-image_zero"} <= found  # fmt: skip
    assert {
        f"{name}-insist" for name in ("tac", "ftir", "optics", "thermography", "levitation")
    } <= found


def test_with_the_other_option_the_command_runs():
    @only_with(one="two")
    def command(*, one: int = 1, two: int = 2) -> None:
        calls.append((one, two))

    calls = []
    command(one=3, two=4)
    command(two=4)
    command(one=1)  # the default, which does nothing by itself
    assert calls == [(3, 4), (1, 4), (1, 2)]


@pytest.mark.parametrize(("name", "file"), [
    ("tac", "tac-reduced.txt"), ("ftir", "film.csv"), ("levitation", "launchpads.csv"),
    ("roughness", "germanium.txt"),
])  # fmt: skip
def test_the_same_data_twice_are_refused(name, file, run, refuses, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run("lab", "example", name)
    shutil.copy(file, f"copy-{file}")
    for twice in (file, f"copy-{file}"):
        err = refuses("lab", name, file, twice)
        assert "has the same data as" in err or "is also in" in err


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ("tac tac-reduced.txt --diameter -3mm", '--diameter: "-3mm" is not positive'),
        ("tac tac-reduced.txt --diameter 24±30mm", "is not known by its ±"),
        ("tac tac-reduced.txt --ambient -300°C", "is below absolute zero"),
        ("tac tac-reduced.txt --tolerance -1°C", '--tolerance: "-1°C" is negative'),
        ("tac tac-reduced.txt --diameter 24", 'write "24 mm"'),
        ("tac tac-reduced.txt --wall 12mm", "is inside the heater"),
        ("levitation flyer.toml", "flyer.toml: is a TOML file"),
    ],
)
def test_what_labs_write_gets_an_answer_that_helps(
    run, refuses, tmp_path, monkeypatch, arguments, says
):
    monkeypatch.chdir(tmp_path)
    run("lab", "example", "tac")
    (tmp_path / "flyer.toml").write_text("", encoding="utf-8")
    assert says in refuses("lab", *arguments.split())


def test_an_option_beside_its_column_is_said(run, prints, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run("lab", "example", "tac")
    out = prints("lab", "tac", "tac-reduced.txt", "--ambient", "100 °C")
    said = "--ambient is not used: tac-reduced.txt has the column ambient_temperature"
    assert said in " ".join(out.split())


def test_a_first_value_that_starts_with_a_dash_is_no_option(prints, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rows = "\n".join(f"{i} {1.0 + 0.3 * i} {900 + 20 * (i - 5) ** 2}" for i in range(12))
    (tmp_path / "bare.txt").write_text(rows, encoding="utf-8")
    columns = "-, pressure [Pa], irradiance [W/m^2]"
    prints("lab", "levitation", "bare.txt", "--columns", columns, "--draws", "100")
