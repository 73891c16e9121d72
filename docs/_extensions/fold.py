"""Long pages fold: ``fold: 2`` in a page's front matter leaves two sections open, folds the rest.

Plain ``<details>``: a browser opens them where a link or a search on the page leads into them.
"""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx

_SCRIPT = "fold.js"
_FEW = 60  # words of a section that is not worth folding


def _fold(section: nodes.section) -> None:
    title, *content = section.children
    words = sum(len(part.astext().split()) for part in content)
    if words < _FEW:
        return
    rounded = round(words, -1)
    opening = f'<details class="lf-fold"><summary>Read on ({rounded} words)</summary>'
    section.children = [
        title,
        nodes.raw("", opening, format="html"),
        *content,
        nodes.raw("", "</details>", format="html"),
    ]


def _fold_page(app: Sphinx, doctree: nodes.document, name: str) -> None:
    asked = app.env.metadata.get(name, {}).get("fold")
    if asked is None or app.builder.format != "html":
        return
    for page in doctree.children:
        if isinstance(page, nodes.section):
            sections = [part for part in page.children if isinstance(part, nodes.section)]
            for section in sections[int(asked) :]:
                _fold(section)


def _write(app: Sphinx) -> None:
    if app.builder.format == "html":
        folder = Path(app.doctreedir) / "fold"
        folder.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(Path(__file__).parent / _SCRIPT, folder / _SCRIPT)
        app.config.html_static_path.append(str(folder))


def _load(app: Sphinx, _page: str, _template: str, context: dict[str, Any], _tree: Any) -> None:
    if 'class="lf-fold"' in context.get("body", ""):
        app.add_js_file(_SCRIPT, loading_method="defer")


def setup(app: Sphinx) -> dict[str, Any]:
    """Fold pages when their links are resolved."""
    app.connect("builder-inited", _write)
    app.connect("doctree-resolved", _fold_page)
    app.connect("html-page-context", _load)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
