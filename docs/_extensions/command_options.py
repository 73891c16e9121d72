"""What ``--help`` says of a command, on its page.

``{command-options} lab tac`` is the usage, the arguments and the options of ``lightflyer lab tac``,
taken from the program itself.
"""

import re
from typing import Any, ClassVar

from cyclopts.docs.markdown import generate_markdown_docs
from docutils import nodes
from docutils.statemachine import StringList
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from lightflyer.cli import app

USAGE = re.compile(r"^```console\n.*?^```$", re.M | re.S)
CODE_OR_OPTION = re.compile(r"`[^`]*`|(?<![\w-])--[a-z][\w-]*")
"""Code, and an option within a sentence, whose hyphens must not become a dash."""


def options(command: str) -> str:
    """Usage, arguments and options of a command as Markdown.

    Parameters
    ----------
    command : str
        Such as ``"lab tac"``.

    Returns
    -------
    str
    """
    found: Any = app
    for word in command.split():
        found = found[word]
    text = generate_markdown_docs(
        found,
        recursive=False,
        generate_toc=False,
        command_chain=["lightflyer", *command.split()],
    )
    usage = USAGE.search(text)
    assert usage is not None, text
    # between usage and options stands the sentence with which the page begins
    listed = text[text.index("\n**", usage.end()) :]
    return f"{usage[0]}\n{CODE_OR_OPTION.sub(_as_code, listed)}"


def _as_code(found: re.Match[str]) -> str:
    return found[0] if found[0].startswith("`") else f"`{found[0]}`"


class CommandOptions(SphinxDirective):
    """Usage, arguments and options of a command."""

    required_arguments = 1
    final_argument_whitespace = True
    option_spec: ClassVar[dict[str, Any]] = {}

    def run(self) -> list[nodes.Node]:
        """The parsed text."""
        where = f"help of lightflyer {self.arguments[0]}"
        lines = StringList(options(self.arguments[0]).splitlines(), where)
        block = nodes.container(classes=["command-options"])
        self.state.nested_parse(lines, 0, block)
        return [block]


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the directive."""
    app.add_directive("command-options", CommandOptions)
    return {"parallel_read_safe": True}
