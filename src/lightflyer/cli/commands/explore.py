"""``lightflyer explore``: a page on which a flyer's numbers can be moved."""

import shutil
import tempfile
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from cyclopts.validators import Number

from lightflyer.cli.output import printer
from lightflyer.core.atomic_files import TEMPORARY, remove_if_interrupted
from lightflyer.core.extras import extra

_PORT = 8470
_REDIRECTING = """\
<!DOCTYPE html>
<meta charset="utf-8">
<meta name="referrer" content="no-referrer">
<meta http-equiv="refresh" content="0; url={address}">
<title>lightflyer explore</title>
<p><a href="{address}">lightflyer explore</a>
"""
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
        Port of the page; the next free one if that is in use; 0 for any.
    browser
        Open the page in the browser.
    """
    for package in _PACKAGES:
        extra(package, "explore", "explorer")
    from lightflyer.explorer.server import serve
    from lightflyer.explorer.state import Workplace

    with ExitStack() as until_closed:

        def opened(address: str) -> None:
            printer().print(f"explore at {address}  (Ctrl-C ends)")
            if browser:
                import webbrowser

                try:
                    page = until_closed.enter_context(_page_to(address)).as_uri()
                except OSError:  # where temporary files have no room, the address is left
                    return
                # a browser of the terminal's returns only when it is closed
                threading.Thread(target=webbrowser.open, args=(page,), daemon=True).start()

        serve(Workplace.of_file(flyer_file), port, opened)


@contextmanager
def _page_to(address: str) -> Iterator[Path]:
    """A page for this user alone that leads to an address, whose token is nobody else's to know."""
    # All users of a computer read the command lines of its programs, a browser's too.
    folder = Path(tempfile.mkdtemp(prefix=TEMPORARY))  # 0o700, as the file is 0o600
    try:
        with remove_if_interrupted(folder):
            path = folder / "explore.html"
            path.touch(mode=0o600)
            path.write_text(_REDIRECTING.format(address=address), encoding="utf-8")
            yield path
    finally:
        shutil.rmtree(folder, ignore_errors=True)
