"""``lightflyer explore``: a page on which a flyer's numbers can be moved."""

import threading
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from cyclopts.validators import Number

from lightflyer.cli.output import printer
from lightflyer.core.extras import extra

_PORT = 8470
_PACKAGES = ("bokeh", "tornado", "tomli_w")

Port = Annotated[int, Parameter(validator=Number(gte=0, lt=65_536))]


def explore_command(
    flyer_file: Path | None = None,
    /,
    *,
    port: Port = _PORT,
    browser: bool = True,
) -> None:
    """Open a page on which a flyer's numbers can be moved, and figures follow.

    The page is served on this computer alone, at the loopback address; nothing is fetched from
    elsewhere. Ctrl-C ends it.

    Parameters
    ----------
    flyer_file
        TOML file of a flyer or a mission; by default a disk over Earth. Files that it names are
        read; the page itself can name files of its folder only.
    port
        Port at which the page is served; the next free one where it is in use, 0 for any.
    browser
        Open the page in the browser.
    """
    for package in _PACKAGES:
        extra(package, "explore", "explorer")
    from lightflyer.explorer.server import serve
    from lightflyer.explorer.state import Workplace

    def opened(address: str) -> None:
        printer().print(f"explore at {address}  (Ctrl-C ends)")
        if browser:
            import webbrowser

            # a browser of the terminal's returns only when it is closed
            threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()

    serve(Workplace.of_file(flyer_file), port, opened)
