"""Where commands print: plain text, whatever is in it."""

from rich.console import Console


def printer(*, stderr: bool = False, width: int | None = None) -> Console:
    """Console that shows texts as they are.

    Names of files and of quantities may contain brackets, which Rich would take for markup, and
    colons, which it would take for emoji.

    Parameters
    ----------
    stderr : bool
        Print to the standard error stream.
    width : int, optional
        Columns; by default those of the terminal.

    Returns
    -------
    rich.console.Console
    """
    return Console(stderr=stderr, width=width, markup=False, emoji=False, highlight=False)
