"""Published flyers: their table, files and verdicts, and the pages made of them."""

import json
import re
from pathlib import Path

import pytest

from lightflyer.config.reader import read_design

pytest.importorskip("sphinx")
from calculator.kinds import KINDS
from calculator.model import factor, force_models
from published import calculator_state, page, published, table
from published.verdicts import verdict

DOCS = Path(__file__).parents[2] / "docs"
FLYERS = published()
NAMES = [flyer.name for flyer in FLYERS]


@pytest.mark.parametrize("flyer", FLYERS, ids=NAMES)
def test_its_file_is_read_and_its_verdict_is_of_that_file(flyer, tmp_path):
    path = tmp_path / "flyer.toml"
    path.write_text(flyer.flyer_file(), encoding="utf-8")
    design = read_design(path)
    assert flyer.file["flyer"]["shape"][0] == flyer.kind
    found = flyer.verdict()
    assert found["own_mass"] == pytest.approx(float(design.setup.flyer.own_mass), rel=1e-9)
    assert found["lines"][0].startswith(design.setup.flyer.describe())


@pytest.mark.parametrize("flyer", FLYERS, ids=NAMES)
def test_its_page_names_a_source_of_every_number(flyer):
    listed = (DOCS / "references.rst").read_text(encoding="utf-8")
    written = page(flyer)
    assert f'<a href="../references.html#{flyer.source.lower()}">{flyer.source}</a>' in written
    text = re.sub(r"<[^>]*>", "", written)
    words = " ".join([flyer.source, *(where for _, _, where in flyer.told), text])
    for source in re.findall(r"\b[A-Z][a-z]+20\d\d\b", words):
        assert f".. [{source}]" in listed
    for section, keys in flyer.file.items():
        for key, (value, where) in keys.items():
            assert where or key in {"shape", "kind"}
            assert not where or f"| `{section}.{key}` | {value} | {where} |" in text
    assert text.count("(guess)") == flyer.guesses


def test_a_changed_number_has_no_verdict(monkeypatch):
    kept = json.loads(table.VERDICTS.read_text(encoding="utf-8"))
    assert set(kept) == set(NAMES)
    kept[NAMES[0]]["digest"] = "of another file"
    monkeypatch.setattr(table, "_verdicts", lambda: kept)
    with pytest.raises(LookupError, match="make verdicts"):
        FLYERS[0].verdict()


@pytest.mark.parametrize("flyer", FLYERS, ids=NAMES)
def test_the_calculator_shows_the_numbers_of_its_file(flyer, tmp_path):
    if not flyer.in_calculator:
        assert "design:" not in page(flyer)
        return
    name, link = calculator_state(flyer)
    kind = next(one for one in KINDS if one.name == name)
    path = tmp_path / "flyer.toml"
    path.write_text(flyer.flyer_file(), encoding="utf-8")
    design = read_design(path)
    shown = dict(part.split("=") for part in link.removeprefix("#design:").split("&"))
    assert shown.pop("model") in force_models(kind)
    assert kind.size.name in shown
    for number in kind.computed:
        if number.name in shown:
            value, _, spread = shown[number.name].partition("+-")
            given = design.number(number.name)
            name = "film.emittance" if given is None else number.name
            given, stated = design.number(name), design.uncertainties.get(name, 0.0)
            scale = factor(number, kind)
            assert float(value) * scale == pytest.approx(given, rel=1e-5, abs=1e-12), name
            assert float(spread or 0) * scale == pytest.approx(stated, rel=1e-5, abs=1e-12), name


@pytest.mark.snippets
@pytest.mark.parametrize("flyer", FLYERS, ids=NAMES)
def test_its_verdict_is_what_the_package_says_now(flyer):
    found = verdict(flyer)
    kept = flyer.verdict()
    assert found["lines"] == kept["lines"]
    assert found["warnings"] == kept["warnings"]
