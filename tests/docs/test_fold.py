"""Long pages fold after their first sections, and what they hold stays on the page."""

import pytest

nodes = pytest.importorskip("docutils.nodes")
fold = pytest.importorskip("fold")


def page(*lengths):
    """A page of sections of so many words each."""
    found = nodes.section("", nodes.title("", "page"))
    for length in lengths:
        text = nodes.paragraph("", " ".join(["word"] * length))
        found += nodes.section("", nodes.title("", "section"), text)
    return found


def folded(section):
    return any(isinstance(part, nodes.raw) for part in section.children)


class App:
    """What the extension asks Sphinx for."""

    def __init__(self, asked):
        self.env = type("Env", (), {"metadata": {"page": {} if asked is None else {"fold": asked}}})
        self.builder = type("Builder", (), {"format": "html"})


@pytest.mark.parametrize(
    ("asked", "expected"), [(None, [0, 0, 0]), ("1", [0, 0, 1]), (0, [1, 0, 1])]
)
def test_sections_after_the_first_fold_if_they_are_long(asked, expected):
    whole = page(500, 20, 300)
    document = nodes.Element("", whole)
    before = whole.astext().count("word")
    fold._fold_page(App(asked), document, "page")
    sections = [part for part in whole.children if isinstance(part, nodes.section)]
    assert [folded(section) for section in sections] == [bool(one) for one in expected]
    texts = [p for section in sections for p in section.children if isinstance(p, nodes.paragraph)]
    assert sum(text.astext().count("word") for text in texts) == before


def test_the_words_are_told():
    whole = page(496)
    fold._fold_page(App(0), nodes.Element("", whole), "page")
    assert "(500 words)" in whole.children[1].children[1].astext()
