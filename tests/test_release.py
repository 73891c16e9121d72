"""What a release says of itself in several places is the same."""

import re
import subprocess
import tomllib
from importlib import metadata, resources
from pathlib import Path

import pytest

import lightflyer

ROOT = Path(__file__).parents[1]
HEADING = re.compile(r"^## (\d+\.\d+\.\d+), (\d{4}-\d\d-\d\d)$", re.MULTILINE)
DATA = resources.files("lightflyer") / "data"


def text(name):
    return (ROOT / name).read_text(encoding="utf-8")


def test_versions_agree():
    newest, date = HEADING.findall(text("CHANGELOG.md"))[0]
    assert newest == lightflyer.__version__
    citation = text("CITATION.cff")
    assert f"\nversion: {newest}\n" in citation
    assert f"\ndate-released: {date}\n" in citation


def test_every_tag_has_its_heading():
    command = ["git", "tag", "--list", "v*"]
    if not (ROOT / ".git").exists():
        pytest.skip("no repository")
    tags = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    headings = {version for version, _ in HEADING.findall(text("CHANGELOG.md"))}
    assert {tag.removeprefix("v") for tag in tags.split()} <= headings


def test_every_file_of_data_has_source_and_licence():
    rows = [line.split("|") for line in (DATA / "SOURCES.md").read_text("utf-8").splitlines()]
    told = {}
    for row in rows:
        if len(row) == 7 and "`" in row[1]:
            told |= dict.fromkeys(re.findall(r"`([^`]+)`", row[1]), row)
    shipped = {file.name for file in DATA.iterdir() if file.is_file()} - {"SOURCES.md"}
    folders = {f"{folder.name}/*.csv" for folder in DATA.iterdir() if folder.is_dir()}
    assert set(told) == shipped | folders
    for row in told.values():
        assert row[3].strip(), row[1]
        assert re.search(r"MIT|public domain|facts|CC0", row[4]), row[1]


@pytest.mark.parametrize("licence", ["GPL", "AGPL"])
def test_no_file_of_data_has_a_licence_that_binds_the_package(licence):
    assert licence not in (DATA / "SOURCES.md").read_text("utf-8")


@pytest.mark.parametrize("name", ["requirements.lock", "requirements-dev.lock"])
def test_lock_file_has_hashes_and_names_no_index(name):
    lines = [line for line in text(name).splitlines() if "==" in line]
    assert lines
    assert all(line.endswith("\\") for line in lines)
    assert text(name).count("--hash=sha256:") > len(lines)
    assert "://" not in text(name)


def test_what_a_prediction_needs_has_the_versions_of_the_tests():
    """The short lock file is a part of the long one, and holds no extra."""
    short, long = (
        {line for line in text(name).splitlines() if "==" in line}
        for name in ("requirements.lock", "requirements-dev.lock")
    )
    assert short < long
    assert not {line for line in short if line.startswith(("jax", "numba", "zarr", "pytest"))}


def test_recipe_asks_for_what_the_package_asks_for():
    asked = tomllib.loads(text("pyproject.toml"))["project"]["dependencies"]
    recipe = text("conda/recipe.yaml").partition("  run:\n")[2].partition("\ntests:")[0]
    found = re.findall(r"^ +- (\S+) (>=[\d.]+)", recipe, re.MULTILINE)
    assert {name.removesuffix("-base") + bound for name, bound in found if name != "python"} == {
        *asked
    }
    assert f'version: "{lightflyer.__version__}"' in text("conda/recipe.yaml")


def test_extras_are_those_that_messages_name():
    known = tomllib.loads(text("pyproject.toml"))["project"]["optional-dependencies"]
    source = (path.read_text("utf-8") for path in (ROOT / "src").rglob("*.py"))
    called = [re.findall(r'extra\(\s*"\w+",\s*[^,]+,\s*"(\w+)"', content) for content in source]
    assert {name for names in called for name in names} <= set(known)
    assert metadata.version("lightflyer") == lightflyer.__version__
