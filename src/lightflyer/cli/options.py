"""Options that several commands have, with what they may be; those of figures among them."""

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import Parameter
from cyclopts.validators import Number

from lightflyer.cli import report as reports
from lightflyer.cli.output import say, write_json
from lightflyer.core.errors import ConfigurationError, ParameterError
from lightflyer.files.result_text import wrap

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import Console

    from lightflyer.environment.base import Coordinate

MOST_SAMPLES = 1_000_000


def _whole(_: Any, tokens: Sequence[Any]) -> int:
    """A whole number; 1.5 is none."""
    try:
        return int(tokens[0].value)
    except ValueError:
        raise ValueError(f'"{tokens[0].value}" is not a whole number') from None


Whole = Annotated[int, Parameter(converter=_whole)]

Json = Annotated[bool, Parameter(name="--json", negative=())]  # Whether to print JSON
Seed = Annotated[Whole, Parameter(validator=Number(gte=0, lt=2**63))]  # Seed of random numbers

Samples = Annotated[Whole, Parameter(validator=Number(gte=0, lte=MOST_SAMPLES))]
"""Number of random samples, which take memory each."""


def only_with(**needs: str) -> Callable[[Callable[..., None]], Any]:
    """Have a command refuse options that do nothing without another, by the option's name."""

    def refusing(command: Callable[..., None]) -> Callable[..., None]:
        signature = inspect.signature(command)

        @wraps(command)
        def checked(*args: Any, **named: Any) -> None:
            given = {
                name
                for name, value in signature.bind_partial(*args, **named).arguments.items()
                if value != signature.parameters[name].default
            }
            for name, other in needs.items():
                if name in given and other not in given:
                    option, needed = (f"--{one.replace('_', '-')}" for one in (name, other))
                    raise ParameterError(f"{option} needs {needed}; alone it does nothing")
            command(*args, **named)

        checked.needs = needs  # type: ignore[attr-defined]
        return checked

    return refusing


def coordinate(option: str, text: str, where: "Coordinate") -> float:
    """An altitude or pressure of an option in SI units, within what the environment has."""
    from lightflyer.core.units import scale_and_offset

    try:
        found, spread = where.quantity.read(text)
    except ConfigurationError as error:
        said = "" if text in str(error) else f"{where.name} {text} "
        factor, _ = scale_and_offset(where.quantity.unit, where.shown_unit)
        low, high = factor * where.lowest, factor * where.highest
        allowed = f"must be between {low:g} and {high:g} {where.shown_unit}"
        told = str(error).replace(f"must be {where.quantity.allowed}", allowed)
        raise ConfigurationError(f"{option}: {said}{told}") from None
    if spread is not None:
        raise ConfigurationError(f'{option} "{text}": takes no ±')
    return found


def coordinate_range(option: str, text: str, where: "Coordinate") -> tuple[float, float]:
    """Two altitudes or pressures of an option such as "50 km to 100 km" in SI units."""
    ends = text.split(" to ")
    example = '"50 km to 100 km"' if where.name == "altitude" else '"1 Pa to 100 Pa"'
    if len(ends) != 2:
        raise ConfigurationError(f'{option} "{text}": write a range, as in {example}')
    low, high = (coordinate(option, end.strip(), where) for end in ends)
    if not low < high:
        raise ConfigurationError(f'{option} "{text}": the first must be the lower one')
    return low, high


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
            require_style(self.style)

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
