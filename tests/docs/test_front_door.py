"""The map of questions leads everywhere, and the citation is that of this version."""

import re
import tomllib
from pathlib import Path

import yaml

import lightflyer as lf
from lightflyer.cli.commands.init import templates

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
NO_QUESTION = {"index", "flyer-file", "python", "figures", "calculator", "outer-flow", "references"}
"""Pages that are reached from others, or stand on the front page itself."""

# Citation File Format 1.2.0: what a file must have, and of this file's keys what they must be
REQUIRED = {"cff-version", "message", "title", "authors"}
AUTHOR_KEYS = {"name", "family-names", "given-names", "affiliation", "orcid", "alias"}


def test_every_page_answers_a_question_on_the_front_page():
    text = (DOCS / "index.md").read_text(encoding="utf-8")
    front = text.split("```{toctree}")[0]
    answered = {
        link.split("#")[0].removesuffix(".md") for link in re.findall(r"]\(([^)]+)\)", front)
    }
    subjects = {page.stem for page in DOCS.glob("*.md")} - NO_QUESTION
    parts = {name for name in subjects if name.startswith(("lab-", "calculator-"))}
    flyers = {"sandwich", "plate", "hollow", "balloon"}  # from the page of kinds of flyers
    assert subjects - parts - flyers - answered == set()
    for flyer in flyers:
        assert f"({flyer}.md)" in (DOCS / "flyers.md").read_text(encoding="utf-8")


def test_the_picture_of_the_readme_shows_what_is_predicted(tmp_path):
    """``make picture`` draws it; its description holds the numbers that it shows."""
    path = tmp_path / "flyer.toml"
    path.write_text(templates()["laden"].read(), encoding="utf-8")
    found = lf.predict(path)
    low, high = found.uncertainty.bands["verdict.rest.temperature_k"]
    rest = found.verdict.rest
    told = f"{rest.coordinate / 1e3:.1f} km, {rest.values['temperature']:.0f} K"
    told += f" ({low:.0f} to {high:.0f})"
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    for scheme in ("light", "dark"):
        drawn = (DOCS / "images" / f"lightflyer-{scheme}.svg").read_text(encoding="utf-8")
        assert f"rests at {told}" in drawn
        assert f"images/lightflyer-{scheme}.svg" in readme
    assert f"rests {told.split(' km')[0]} km over Earth" in readme


def test_the_citation_is_whole_and_of_this_version():
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert set(cited) >= REQUIRED
    assert cited["cff-version"] == "1.2.0"
    assert cited["version"] == lf.__version__
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert cited["license"] == project["license"]
    assert [one["name"] for one in cited["authors"]] == [one["name"] for one in project["authors"]]
    for work in cited["references"]:
        assert {"type", "title", "authors"} <= set(work)
        assert all(set(author) <= AUTHOR_KEYS for author in work["authors"])
    listed = (DOCS / "references.rst").read_text(encoding="utf-8")
    assert all(work["url"] in listed for work in cited["references"])


def test_every_example_has_its_place():
    text = (DOCS / "_extensions" / "gallery_figures.py").read_text(encoding="utf-8")
    placed = re.findall(r'^    "(\w+\.py)",$', text.split("ORDER = (")[1].split("\n)")[0], re.M)
    examples = {path.name for path in DOCS.glob("gallery/*.py")}
    notebooks = {path.name for path in DOCS.glob("notebooks/*.py")}
    assert set(placed) == examples | notebooks
    front = (DOCS / "index.md").read_text(encoding="utf-8")
    assert all(f"notebooks/{name.removesuffix('.py')})" in front for name in notebooks)
