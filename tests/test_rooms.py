"""The structure of the package: who imports whom, and what public names are."""

import importlib
import inspect
import pkgutil
import re
from pathlib import Path

import pytest
from importlinter.cli import lint_imports

import lightflyer as lf

ROOT = Path(__file__).parents[1]
ROOMS = ["environment", "film", "statics", "flyer", "force", "gas", "prediction", "uncertainty",
         "calibration", "comparison", "parametric", "search", "lab", "kinetic_theory", "mission",
         "drag", "structure", "budget", "design"]  # fmt: skip


def test_data_flows_one_way(monkeypatch):
    monkeypatch.chdir(ROOT)
    assert lint_imports(config_filename="pyproject.toml", no_cache=True) == 0


@pytest.mark.parametrize("room", ["", *ROOMS])
def test_public_names_are_there_and_never_module_and_function_at_once(room):
    package = importlib.import_module(f"lightflyer.{room}".rstrip("."))
    modules = {module.name for module in pkgutil.iter_modules(package.__path__)}
    assert package.__all__
    for name in package.__all__:
        found = getattr(package, name)
        is_module = inspect.ismodule(found) and found.__name__.endswith(f".{name}")
        assert is_module or not (inspect.ismodule(found) or name in modules), name


@pytest.mark.parametrize("room", ROOMS)
def test_methods_are_described_where_they_or_their_base_stand(room):
    package = importlib.import_module(f"lightflyer.{room}")
    silent = []
    for kind in filter(inspect.isclass, (getattr(package, name) for name in package.__all__)):
        methods = {name for name, one in vars(kind).items() if inspect.isfunction(one)}
        methods |= {name for name, one in vars(kind).items() if isinstance(one, property)}
        for name in sorted(methods - set(getattr(kind, "__dataclass_fields__", ()))):
            parents = [vars(base)[name] for base in kind.__mro__ if name in vars(base)]
            if not (name.startswith("_") or any(parent.__doc__ for parent in parents)):
                silent.append(f"{kind.__name__}.{name}")
    assert silent == []


def test_contributing_names_every_room():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    rooms = [path.parent.name for path in (ROOT / "src" / "lightflyer").glob("*/__init__.py")]
    assert [room for room in rooms if f"`{room}`" not in text] == []


def test_each_room_keeps_to_its_lines():
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| (`.+?`) \| .* \| ([\d,]+) \|$", text, re.MULTILINE)
    assert len(rows) > 20
    heavier = {}
    for names, most in rows:
        folders = [ROOT / "src" / "lightflyer" / room for room in re.findall(r"`(\w+)`", names)]
        modules = [path for folder in folders for path in folder.rglob("*.py")]
        lines = sum(len(path.read_text(encoding="utf-8").splitlines()) for path in modules)
        if lines > int(most.replace(",", "")):
            heavier[names] = lines
    assert heavier == {}


def test_no_folder_has_more_than_fifteen_modules():
    folders = {path.parent for path in (ROOT / "src").rglob("*.py")}
    counts = {
        folder.name: sum(path.name != "__init__.py" for path in folder.glob("*.py"))
        for folder in folders
    }
    assert {name: count for name, count in counts.items() if count > 15} == {}


def test_only_figures_draw():
    drawing = {"files/drawing.py"}
    for path in (ROOT / "src").rglob("*.py"):
        if "matplotlib" in path.read_text(encoding="utf-8") and path.name != "figures.py":
            lines = [
                line.strip()
                for line in path.read_text(encoding="utf-8").splitlines()
                if line.startswith(("import matplotlib", "from matplotlib"))
            ]
            place = path.relative_to(ROOT / "src" / "lightflyer").as_posix()
            assert not lines or place in drawing or "figures" in place, place


def test_every_kind_of_flyer_has_a_template_to_start_from(tmp_path):
    from lightflyer.cli.commands.init import templates
    from lightflyer.flyer import FlyerSection

    shapes = set()
    for kind, template in templates().items():
        if not template.is_flyer:
            continue
        path = tmp_path / f"{kind}.toml"
        path.write_text(template.read(), encoding="utf-8")
        shapes.add(lf.read_flyer_file(path).flyer.tag())
    ours = {
        tag
        for tag, section in FlyerSection.alternatives.items()
        if section.__module__.startswith("lightflyer.")
    }
    assert shapes == ours
