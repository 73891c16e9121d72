"""``lightflyer lab example``: synthetic raw files."""

from pathlib import Path
from typing import Literal

from lightflyer.cli.options import Seed
from lightflyer.cli.output import printer
from lightflyer.lab.commands import measurements


def example_command(name: str, /, *, out: Path = Path("."), seed: Seed = 0) -> None:
    """Write synthetic raw files to try a command with, each labelled as synthetic.

    Parameters
    ----------
    name
        Measurement.
    out
        Folder to write into.
    seed
        Seed of the noise.
    """
    from lightflyer.core.atomic_files import output_directory
    from lightflyer.lab.synthetic import example_files

    files = example_files(name, seed)
    with output_directory(out) as stage:
        for file, content in files.files.items():
            if isinstance(content, bytes):
                stage(file).write_bytes(content)
            else:
                stage(file).write_text(content, encoding="utf-8")
    console = printer()
    for file in files.files:
        console.print(f"wrote {out / file}", soft_wrap=True)
    for command in files.commands:
        console.print(f"next: lightflyer lab {command}", soft_wrap=True)


example_command.__annotations__["name"] = Literal[*measurements()]
