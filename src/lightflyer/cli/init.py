"""``lightflyer init``: a flyer file to start from."""

from importlib import resources
from pathlib import Path

from lightflyer.cli.output import printer
from lightflyer.foundation.errors import OutputError, ParameterError

_PREFIX, _SUFFIX = "flyer-", ".toml"


def templates() -> dict[str, str]:
    """Texts of the commented flyer files that come with the package.

    Returns
    -------
    dict of str to str
        By kind, such as ``"earth"``: the template ``data/flyer-earth.toml``.
    """
    found = (entry for entry in (resources.files("lightflyer") / "data").iterdir())
    return {
        entry.name.removeprefix(_PREFIX).removesuffix(_SUFFIX): entry.read_text(encoding="utf-8")
        for entry in sorted(found, key=lambda entry: entry.name)
        if entry.name.startswith(_PREFIX) and entry.name.endswith(_SUFFIX)
    }


def init(path: Path = Path("flyer.toml"), /, *, kind: str = "earth", force: bool = False) -> None:
    """Write a commented flyer file to start from.

    Parameters
    ----------
    path
        Where to write it.
    kind
        What it describes: earth (a disk over Earth), chamber (the disk in a vacuum chamber),
        sandwich (two perforated membranes over Earth), plate (nanocardboard in the chamber),
        balloon (a solar balloon over Earth) or hollow (a sphere that pumps gas, over Earth).
    force
        Overwrite an existing file.
    """
    known = templates()
    if kind not in known:
        raise ParameterError(f'--kind "{kind}" is unknown; choose from {", ".join(known)}')
    try:
        with path.open("w" if force else "x", encoding="utf-8") as file:
            file.write(known[kind])
    except FileExistsError:
        raise OutputError(f"{path}: already exists; --force overwrites it") from None
    except OSError as error:
        raise OutputError(f"{path}: cannot be written: {error.strerror}") from None
    printer().print(
        f"wrote {path}\nnext: lightflyer predict {path} --out prediction", highlight=False
    )
