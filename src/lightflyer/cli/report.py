"""``--report``: what a command prints and draws, on one page that can be mailed to a colleague.

The page is recorded while the command runs: tables and lines as they are printed, figures as they
are drawn, files as they are read. So nothing is written twice, and the page cannot say anything
else than the terminal.
"""

import hashlib
import platform
import re
import shlex
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from datetime import UTC, datetime
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING

from rich.table import Table

import lightflyer
from lightflyer.cli import output
from lightflyer.core.errors import OutputError, ParameterError
from lightflyer.files import page
from lightflyer.files.result_text import listed, unwrap

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_ENDING = ".html"
_STORE = ".zarr"  # ending of a sweep's folder
_WARNING = "warning: "
_LABELLED = re.compile(r"(\S.*?)\s{2,}(\S.*)")  # such as "best payload      0.3155 mg"
_TITLES = {
    "predict": "Prediction", "compare": "Comparison", "fly": "Mission", "optimise": "Optimum",
    "calibrate": "Calibration",
}  # fmt: skip
_LARGEST_FIGURE = 1_000_000  # bytes of an SVG, beyond which a PNG is taken
_LARGEST_INPUT = 100_000  # bytes of a file that is shown; of a larger one the hash only
_PIXELS = 96  # of a page in an inch of a figure: letters are as large on a phone
_MADE_WITH = ("numpy", "scipy", "jax")


class Report:
    """What a command says, until it is written."""

    def __init__(self, path: Path, arguments: Sequence[str]) -> None:
        # with NumPy, which --help does without
        from lightflyer.core.text import files_read

        self.path = path
        self._arguments = list(arguments)
        self._named = [
            found for part in arguments if _is_file(part) and (found := Path(part)) != path
        ]
        self._results: list[Table | str] = []
        self._figures: list[str] = []
        self._folder: Path | None = None
        self._until_closed = ExitStack()
        self._files_read = self._until_closed.enter_context(files_read())

    @property
    def folder(self) -> Path:
        """Folder for what a command writes beside figures, which is removed in the end."""
        if self._folder is None:
            self._folder = Path(self._until_closed.enter_context(tempfile.TemporaryDirectory()))
        return self._folder

    def note(self, thing: object) -> None:
        """Take what is printed: a table, or lines."""
        self._results.append(thing if isinstance(thing, Table) else str(thing))

    def draw(self, figures: "Mapping[str, Figure]") -> None:
        """Take figures by their names."""
        from lightflyer.files.drawing import save

        for name, figure in figures.items():
            vector, pixels = (self.folder / f"{name}.{ending}" for ending in ("svg", "png"))
            save(figure, [vector, pixels])
            small = vector.stat().st_size <= _LARGEST_FIGURE
            content, kind = (vector, "svg+xml") if small else (pixels, "png")
            names = []
            for axes in figure.axes:
                across, up = axes.get_xlabel(), axes.get_ylabel()
                if up or across:
                    names.append(f"{up} over {across}" if up and across else up or across)
            shown = "; ".join(dict.fromkeys(names)).replace("$", "") or "figure"
            caption = f"{name.replace('-', ' ').replace('_', ' ').capitalize()}: {shown}"
            width = round(_PIXELS * figure.get_figwidth())
            self._figures.append(page.image(content.read_bytes(), kind, shown, caption, width))

    def write(self) -> None:
        """Write the page, whole or not at all."""
        from lightflyer.core.atomic_files import output_directory

        with output_directory(self.path.parent, shared=True) as stage:
            stage(self.path.name).write_text(self._page(), encoding="utf-8")

    def close(self) -> None:
        """Remove what was written for the page only, and note no more files."""
        self._until_closed.close()

    def _page(self) -> str:
        inputs = list(dict.fromkeys([*self._named, *self._files_read]))
        command = takewhile(lambda part: part.isalpha() and not _is_file(part), self._arguments)
        done = " ".join(command)
        paths = self._named or inputs[:1]
        stems = [path.stem for path in paths]
        # with an ending where it alone tells two apart
        names = listed(one.name if stems.count(one.stem) > 1 else one.stem for one in paths)
        title = _TITLES.get(done, done.capitalize()) + (f": {names}" if names else "")
        words: list[Table | str] = list(
            takewhile(lambda thing: isinstance(thing, str), self._results)
        )
        first = next(iter(self._results), None)
        # a table of numbers with their names, and no heading
        if not words and isinstance(first, Table) and not first.show_header:
            words = self._results[:1]
        told = sorted(
            words, key=lambda one: isinstance(one, str) and one.startswith(_WARNING)
        )  # what was found comes first
        parts = [page.heading(title, 1), page.verdict(_results(told)), *self._figures]
        parts += [page.heading("Numbers")] if self._results[len(words) :] else []
        parts += _results(self._results[len(words) :])
        if inputs:
            parts += [page.heading("Files"), *(part for path in inputs for part in _file(path))]
        from lightflyer.core.extras import version_of  # slow to import

        parts += [
            page.heading("How it was made"),
            page.code("lightflyer " + shlex.join(self._arguments)),
            page.paragraph(f"{datetime.now(UTC):%Y-%m-%d %H:%M} UTC"),
            page.table(
                [
                    ("lightflyer", lightflyer.__version__),
                    ("Python", platform.python_version()),
                    *((name, version_of(name)) for name in _MADE_WITH),
                    ("system", f"{platform.system()}, {platform.machine()}"),
                ]
            ),
        ]
        return page.page(title, parts)


current: Report | None = None  # The report that is being recorded

_arguments: list[str] = []


@contextmanager
def write_report(arguments: Sequence[str]) -> Iterator[None]:
    """Write the report that the command within the block begins, once it has ended well."""
    global current
    _arguments[:] = arguments
    try:
        yield
        _finish()
    except SystemExit as end:  # which is how a command ends, well or not
        if not end.code:
            _finish()
        raise
    finally:
        if current is not None:
            current.close()
            output.AFTER_PRINT.remove(current.note)
            current = None


def _finish() -> None:
    if current is not None:
        current.write()
        output.say(output.printer(), f"wrote {current.path}")


def note_warning(text: str) -> None:
    """Take a warning that goes to the standard error stream."""
    if current is not None:
        current.note(_WARNING + text)


def begin(path: Path) -> Report:
    """Begin to record; ``path``: of the page."""
    global current
    if path.suffix.lower() != _ENDING:
        raise ParameterError(f'--report {path}: the page is HTML; name it "{path.stem}{_ENDING}"')
    if path.is_dir() or not path.parent.is_dir():
        reason = "is a folder" if path.is_dir() else "its folder does not exist"
        raise OutputError(f"--report {path}: {reason}")
    from lightflyer.core.atomic_files import require_directory

    try:
        require_directory(path.parent)
    except OutputError as error:
        raise OutputError(f"--report {path}: {error}") from None
    current = Report(path, _arguments)
    output.AFTER_PRINT.append(current.note)
    return current


def _is_file(argument: str) -> bool:
    """Whether it names a file that exists, or the store of a sweep."""
    try:
        path = Path(argument)
        return path.is_file() or (path.suffix == _STORE and path.is_dir())
    except OSError:  # too long for a name, for one
        return False


def _results(things: Sequence[Table | str]) -> Iterator[str]:
    labelled: list[tuple[str, str]] = []
    for thing in things:
        if isinstance(thing, str) and thing.startswith("{"):  # of --json
            yield page.code(thing)
            continue
        lines = unwrap(thing) if isinstance(thing, str) else []
        for line in lines:
            found = _LABELLED.fullmatch(line.strip())
            if found:
                labelled.append((found[1], found[2]))
                continue
            yield from _flush(labelled)
            yield page.paragraph(line, "warning" if line.startswith(_WARNING) else None)
        if isinstance(thing, Table):
            yield from _flush(labelled)
            columns = [[str(cell) for cell in column.cells] for column in thing.columns]
            yield page.table(
                list(zip(*columns, strict=True)),
                [str(column.header) for column in thing.columns] if thing.show_header else None,
                right=[column.justify == "right" for column in thing.columns],
                caption=str(thing.title or ""),
                note=str(thing.caption or ""),
            )
    yield from _flush(labelled)


def _flush(labelled: list[tuple[str, str]]) -> Iterator[str]:
    if labelled:
        yield page.table(labelled)
        labelled.clear()


def _file(path: Path) -> Iterator[str]:
    if path.is_dir():
        yield page.paragraph(f"{path.name}, the store of a sweep")
        return
    try:
        content = path.read_bytes()
    except OSError:
        return
    digest = hashlib.sha256(content).hexdigest()
    yield page.heading(path.name, 3)
    yield page.paragraph(f"{len(content):,} bytes, SHA-256 {digest}")
    if len(content) > _LARGEST_INPUT or b"\0" in content:
        return
    yield page.code(content.decode("utf-8-sig", errors="replace"))
