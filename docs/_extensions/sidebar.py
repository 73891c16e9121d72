"""A sidebar without the several hundred objects of the API, which its page lists."""

from typing import Any

from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment


def _shorten(app: Sphinx, env: BuildEnvironment) -> None:
    del app
    for entries in [*env.tocs["api"].findall(addnodes.toctree)]:
        entries.parent.remove(entries)


def setup(app: Sphinx) -> dict[str, Any]:
    """Shorten the table of contents when all pages are read."""
    app.connect("env-updated", _shorten)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
