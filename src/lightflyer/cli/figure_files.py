"""Options of figures, the same in every command that writes some."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from lightflyer.foundation.errors import ParameterError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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
        """Raise before anything is computed where an option cannot be used.

        Parameters
        ----------
        out : Path or None
            Folder of the figures; without one, options of figures have no effect.

        Raises
        ------
        ParameterError
        """
        given = {"--format": "formats", "--dpi": "dpi", "--style": "style"}
        default = AS_USUAL
        used = [name for name, key in given.items() if getattr(self, key) != getattr(default, key)]
        if out is None and used:
            raise ParameterError(f"{', '.join(used)}: figures need a folder; add --out FOLDER")
        if not used:
            return  # and Matplotlib need not be imported yet
        from lightflyer.foundation.drawing import FORMATS, require_style

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
        """Draw figures and write each in every format.

        Parameters
        ----------
        stage : callable
            See :func:`~lightflyer.foundation.files.output_directory`.
        draw : callable
            Returns figures by file name without ending.

        Returns
        -------
        list of str
            Names of the files.
        """
        from lightflyer.foundation.drawing import save, styled

        names = []
        with styled(self.style):
            for title, figure in draw().items():
                files = [f"{title}.{ending}" for ending in self.endings]
                save(figure, [stage(name) for name in files], dpi=self.dpi)
                names += files
        return names


AS_USUAL = FigureOptions()
"""Figures where nothing else is asked."""
