"""Pictures of the pages that are drawn by the package or by a small script, light and dark.

``rise`` shows why a film rises, ``drawings`` draws flyers to scale. Directives: ``{rise}``,
``{kinds}``, ``{scales}``, ``{flyer-drawing}``, ``{architecture}``.
"""

from __future__ import annotations

import shutil
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any, ClassVar

from docutils import nodes
from docutils.parsers.rst import Directive
from sphinx.application import Sphinx

from lightflyer.files.palette import style_sheet

_HERE = Path(__file__).parent
_SCRIPT = "rise.js"
_DRAWN = "schematic.css"  # of the explorer, whose drawings these pages show


def _directive(draw: Callable[[], str]) -> type[Directive]:
    """A directive whose HTML a function gives."""

    class Picture(Directive):
        def run(self) -> list[nodes.Node]:
            return [nodes.raw("", draw(), format="html")]

    return Picture


class FlyerDrawing(Directive):
    """``{flyer-drawing} KIND``: how it works, and with ``:size:`` how large it is."""

    required_arguments = 1
    option_spec: ClassVar[dict[str, Any]] = {"size": str}

    def run(self) -> list[nodes.Node]:
        """Its HTML."""
        from .drawings import of_kind, to_scale

        kind, size = self.arguments[0], self.options.get("size")
        content = of_kind(kind) + (to_scale(kind, size) if size else "")
        return [nodes.raw("", f'<figure class="lf-drawings">{content}</figure>', format="html")]


def _write(app: Sphinx) -> None:
    if app.builder.format != "html":
        return
    folder = Path(app.doctreedir) / "pictures"
    folder.mkdir(parents=True, exist_ok=True)
    unless_light = 'body:not([data-theme="light"])'
    sheet = style_sheet('body[data-theme="dark"]', unless_light)
    (folder / "palette.css").write_text(sheet, encoding="utf-8")
    explorer = resources.files("lightflyer.explorer") / "static"
    (folder / _DRAWN).write_text((explorer / _DRAWN).read_text(encoding="utf-8"), encoding="utf-8")
    for name in ("pictures.css", _SCRIPT):
        shutil.copyfile(_HERE / name, folder / name)
    app.config.html_static_path.append(str(folder))


def _load(app: Sphinx, _page: str, _template: str, context: dict[str, Any], _tree: Any) -> None:
    """Load the script on the pages that show it."""
    if 'id="lf-rise"' in context.get("body", ""):
        app.add_js_file(_SCRIPT, loading_method="defer")


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directives."""
    from . import architecture, drawings, rise

    app.add_directive("rise", _directive(rise.html))
    app.add_directive("kinds", _directive(drawings.cards))
    app.add_directive("scales", _directive(drawings.scales))
    app.add_directive("flyer-drawing", FlyerDrawing)
    app.add_directive("architecture", _directive(architecture.html))
    app.add_css_file("palette.css", priority=100)
    app.add_css_file(_DRAWN)
    app.add_css_file("pictures.css")
    app.connect("builder-inited", _write)
    app.connect("html-page-context", _load)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
