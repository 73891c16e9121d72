"""What the theme leaves out of its pages for readers with a keyboard or a screen reader."""

from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

_MENDED = {
    '<p class="caption" role="heading">': '<p class="caption" role="heading" aria-level="2">',
    '<aside class="sidebar-drawer">': '<aside class="sidebar-drawer" aria-label="All pages">',
    '<aside class="toc-drawer': '<aside aria-label="On this page" class="toc-drawer',
    '<div class="content-icon-container">': (
        '<div class="content-icon-container" role="navigation" aria-label="Page as text, theme">'
    ),
    # what scrolls sideways must be reached by keys
    "<pre>": '<pre tabindex="0">',
    '<div class="math-wrapper': '<div tabindex="0" class="math-wrapper',
    '<th class="head"><p></p></th>': "<td></td>",
    '<div class="table-wrapper': '<div tabindex="0" class="table-wrapper',
}
_SEARCH, _NAMED = 'id="furo-main-content">', "<h1>Search</h1>"


def _mend(app: Sphinx, error: Exception | None) -> None:
    if error is not None or app.builder.format != "html":
        return
    for path in Path(app.outdir).rglob("*.html"):
        text = mended = path.read_text(encoding="utf-8")
        for old, new in _MENDED.items():
            mended = mended.replace(old, new)
        if path.name == "search.html":  # the theme's has no heading
            mended = (
                mended.replace(_SEARCH, f"{_SEARCH}<h1>Search</h1>") if _NAMED not in text else text
            )
        if mended != text:
            path.write_text(mended, encoding="utf-8")


def setup(app: Sphinx) -> dict[str, Any]:
    """Mend pages when all are written."""
    app.connect("build-finished", _mend)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
