"""``lightflyer init``: a flyer file to start from."""

from importlib import resources
from pathlib import Path
from typing import Literal

from rich.console import Console

from lightflyer.foundation.errors import OutputError


def init(
    path: Path = Path("flyer.toml"),
    /,
    *,
    kind: Literal["earth", "chamber"] = "earth",
    force: bool = False,
) -> None:
    """Write a commented flyer file to start from.

    Parameters
    ----------
    path
        Where to write it.
    kind
        Fly over Earth, or in a vacuum chamber.
    force
        Overwrite an existing file.
    """
    template = resources.files("lightflyer") / "data" / f"flyer-{kind}.toml"
    try:
        with path.open("w" if force else "x", encoding="utf-8") as file:
            file.write(template.read_text(encoding="utf-8"))
    except FileExistsError:
        raise OutputError(f"{path}: exists; --force overwrites it") from None
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror}") from None
    Console().print(
        f"wrote {path}\nnext: lightflyer predict {path} --out prediction", highlight=False
    )
