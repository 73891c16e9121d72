"""A calculator for the pages: the package's model, in JavaScript, made when they are built.

The model is called with numbers of a ``recorder``, which leaves a ``graph`` of scalar operations;
``javascript`` writes it. ``model`` says what is recorded, ``page`` and the scripts how it is shown.
The directive ``calculator`` puts it on a page.
"""

from __future__ import annotations

import hashlib
import re
import shutil
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.parsers.rst import Directive
from sphinx.application import Sphinx

_HERE = Path(__file__).parent
_MODEL = "calculator-model-{}.js"
_COPIED = {f"{name}.js": f"calculator-{name}.js" for name in ("core", "bands", "figures", "view")}
_STYLE = "calculator.css"
_SOURCES = {".py", ".js", ".css", ".csv", ".toml", ".txt"}


class Calculator(Directive):
    """``{calculator} KIND``: the calculator of a kind, here; of a disk where none is named."""

    optional_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Its HTML."""
        from .page import html

        return [nodes.raw("", html(*self.arguments), format="html")]


def written(where: Path) -> Path:
    """Folder with the scripts and the style that the page needs.

    Parameters
    ----------
    where : Path
        Folder of its own, in which it is kept until what it is made from changes: to make it takes
        half a minute.
    """
    from filelock import FileLock

    folder = where / _made_from()
    where.parent.mkdir(parents=True, exist_ok=True)
    with FileLock(where.with_suffix(".lock")):
        if not folder.exists():
            shutil.rmtree(where, ignore_errors=True)  # of sources before
            stage = folder.with_suffix(".new")
            stage.mkdir(parents=True)
            _write(stage)
            stage.rename(folder)
    return folder


def _made_from() -> str:
    """Digest of the sources and data of the package and of the calculator."""
    import lightflyer

    digest = hashlib.sha256()
    for folder in (Path(lightflyer.__file__).parent, _HERE):
        for path in sorted(folder.rglob("*")):
            if path.is_file() and path.suffix in _SOURCES:
                digest.update(f"{path.relative_to(folder)} {path.stat().st_size} ".encode())
                digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _write(folder: Path) -> None:
    from .kinds import KINDS
    from .model import compile_all

    for kind in KINDS:
        (folder / _MODEL.format(kind.name)).write_text(compile_all(kind), encoding="utf-8")
    for source, target in _COPIED.items():
        shutil.copyfile(_HERE / source, folder / target)
    shutil.copyfile(_HERE / _STYLE, folder / _STYLE)


def _prepare(app: Sphinx) -> None:
    if app.builder.format == "html":
        app.config.html_static_path.append(str(written(Path(app.doctreedir) / "calculator")))


def _load(app: Sphinx, _page: str, _template: str, context: dict[str, Any], _tree: Any) -> None:
    """Load the scripts on pages that have a calculator, and on no other."""
    found = re.search(r'id="lf-calculator" data-kind="(\w+)"', context.get("body", ""))
    if found:
        app.add_css_file(_STYLE)
        for script in (_MODEL.format(found[1]), *_COPIED.values()):
            app.add_js_file(script, loading_method="defer")


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("calculator", Calculator)
    app.connect("builder-inited", _prepare)
    app.connect("html-page-context", _load)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
