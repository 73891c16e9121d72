"""Options of figures, the same in every command that writes some."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter

from lightflyer.cli import report as reports
from lightflyer.cli.output import say, write_json
from lightflyer.core.errors import ParameterError
from lightflyer.files.result_text import wrap

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import Console

_DOTS = (30, 1200)


@Parameter(name="*")
@dataclass(frozen=True)
class FigureOptions:
    """How figures are written.

    Parameters
    ----------
    formats
        Formats of the figures: png, svg or pdf, or several, separated by commas.
    dpi
        Dots per inch of PNG figures, 30 to 1200.
    style
        Matplotlib style sheet, by name or path, for fonts, sizes, line widths and grid; "column"
        for a journal's column of 8.6 cm.
    """

    formats: Annotated[str, Parameter(name="--format")] = "png,svg"
    dpi: int = 150
    style: str | None = None

    def check(self, out: Path | None) -> None:
        """Raise before anything is computed where an option cannot be used; ``out``: of figures."""
        given = {"--format": "formats", "--dpi": "dpi", "--style": "style"}
        default = AS_USUAL
        used = [name for name, key in given.items() if getattr(self, key) != getattr(default, key)]
        if out is None and used:
            raise ParameterError(f"{', '.join(used)}: figures need a folder; add --out FOLDER")
        if out is not None:
            from lightflyer.core.atomic_files import require_directory

            require_directory(out)
        if not used:
            return  # and Matplotlib need not be imported yet
        from lightflyer.files.drawing import FORMATS, require_style

        if not self.endings or set(self.endings) - set(FORMATS):
            allowed = ", ".join(FORMATS)
            raise ParameterError(f'--format "{self.formats}": choose from {allowed}')
        low, high = _DOTS
        if not low <= self.dpi <= high:
            raise ParameterError(f"--dpi = {self.dpi}: must be from {low} to {high}")
        if self.style is not None:
            require_style(self.style, "--style ")

    @property
    def endings(self) -> list[str]:
        """Endings of the files asked for."""
        names = (part.strip().lower().removeprefix(".") for part in self.formats.split(","))
        return list(dict.fromkeys(name for name in names if name))

    def write(
        self,
        stage: Callable[[str], Path],
        draw: "Callable[[], Mapping[str, Figure]]",
    ) -> list[str]:
        """Draw figures, write each in every format, and return the names of the files."""
        from lightflyer.files.drawing import save, use_style

        names = []
        with use_style(self.style):
            drawn = draw()
            if reports.current is not None:
                reports.current.draw(drawn)
            for title, figure in drawn.items():
                files = [f"{title}.{ending}" for ending in self.endings]
                save(figure, [stage(name) for name in files], dpi=self.dpi)
                names += files
        return names

    def write_folder(
        self,
        out: Path | None,
        files: Mapping[str, Any],
        draw: "Callable[[], Mapping[str, Figure]]",
    ) -> list[Path]:
        """Write files and figures where there is a folder to write into; return their paths."""
        # by their names JSON objects, or functions that write a file at a path
        if out is None:
            return []
        from lightflyer.core.atomic_files import output_directory

        with output_directory(out) as stage:
            for name, content in files.items():
                if callable(content):
                    content(stage(name))
                else:
                    write_json(stage(name), content)
            names = [*files, *self.write(stage, draw)]
        return [out / name for name in names]


@Parameter(name="*")
@dataclass(frozen=True)
class ResultOptions(FigureOptions):
    """How figures are written, and the page of everything.

    Parameters
    ----------
    report
        HTML page for all that is printed and drawn, with the files read, the command and the
        versions: one file that can be mailed.
    """

    report: Path | None = None

    def folder(self, out: Path | None) -> Path | None:
        """Folder to write into; begins the report where one is asked for."""
        # before anything is computed; for the time being where only the report needs a folder
        self.check(out)
        if self.report is None:
            return out
        begun = reports.begin(self.report)
        return begun.folder if out is None else out

    def tell(self, console: "Console", written: Sequence[Path], otherwise: str = "") -> None:
        """Print which files were written; ``otherwise``: what to print where none was."""
        begun = reports.current
        kept = [path for path in written if begun is None or not path.is_relative_to(begun.folder)]
        folders = dict.fromkeys(path.parent for path in kept)
        for folder in folders:
            names = [path.name for path in kept if path.parent == folder]
            several = wrap(f"wrote into {folder}: {', '.join(names)}")
            say(console, several if len(names) > 1 else f"wrote {folder / names[0]}")
        if not kept and begun is None and otherwise:
            say(console, otherwise)


AS_USUAL = ResultOptions()  # Figures where nothing else is asked, and no report
