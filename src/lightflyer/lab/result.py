"""What measurements find, from which their commands make text, JSON, datasets and figures.

A result is a dataclass. Those of its fields and properties that are annotated by :class:`Shown` are
in its JSON object, and a :class:`Shown` with a label names the number in tables. A measurement's
function (:mod:`lightflyer.lab.commands`) returns an :class:`Outcome`, of which its command, and its
place in ``lightflyer lab summary``, are made (:mod:`lightflyer.cli.lab`).
"""

import io
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field
from functools import cached_property
from importlib import import_module
from itertools import combinations, islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, NamedTuple, TypeVar, get_type_hints

import numpy as np

import lightflyer
from lightflyer.core.constants import ZERO_CELSIUS
from lightflyer.core.errors import ConfigurationError, Doubt
from lightflyer.core.quantity import Quantity
from lightflyer.files.result_text import Parts, PrintedResult, table_of, warning_lines
from lightflyer.files.table import Table
from lightflyer.lab.estimate import Estimate

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from rich.table import Table as RichTable

T = TypeVar("T")

LABORATORY = Quantity(
    "K", likely=(280.0, 315.0), known="chambers stand in laboratories, unless they are cooled"
)
"""Temperature of the surroundings."""

EMISSIVITY = Quantity(
    likely=(5e-3, 0.98), known="polished gold has 0.02, black paint and skin have 0.95 to 0.98"
)
"""Emissivity of a film in the infrared."""

ABSORPTANCE = Quantity(
    likely=(1e-3, 0.99), known="black paint absorbs 0.97, all but forests of nanotubes less"
)
"""Absorptance of a film for visible light."""

AREA_RATIO = Quantity(likely=(0.5, 2.0), known="films cover a heater and not much else")
"""Effective over nominal area of a heater; [Lu2023]_ has 1.22."""

_NOT_LOGGED = ZERO_CELSIUS  # [K]: what loggers write of an input that nothing is connected to
_MOST_REJECTED = 10  # rows, that a text lists


class Shown(NamedTuple):
    """How a field or property of a result is shown."""

    label: str = ""  # Of its row in tables
    key: str = ""  # In the JSON object, dots between its levels; by default the field's name


Reported = Annotated[T, Shown()]
"""A field or property that is in the JSON object by its own name."""


def shown_fields(kind: type) -> dict[str, Shown]:
    """Fields and properties of a result that are annotated by :class:`Shown`, in their order."""
    hints = get_type_hints(kind, include_extras=True)
    found = {name: hints[name] for name in kind.__annotations__}
    for name, one in vars(kind).items():
        function = one.func if isinstance(one, cached_property) else getattr(one, "fget", None)
        if function is not None:
            found[name] = get_type_hints(function, include_extras=True).get("return")
    return {
        name: shown
        for name, hint in found.items()
        for shown in getattr(hint, "__metadata__", ())
        if isinstance(shown, Shown)
    }


def plain(value: Any) -> Any:
    """A value as JSON has it; keys that are numbers as texts, and no infinite number."""
    if isinstance(value, Estimate):
        return value.to_json()
    if isinstance(value, Mapping):
        return {
            key if isinstance(key, str) else f"{key:g}": plain(one) for key, one in value.items()
        }
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


class LabResult(PrintedResult):
    """A result that prints as its parts, and a line for each warning."""

    warnings: Sequence[str]

    _figures: ClassVar[str] = ""  # function that draws several, in place of one, "module:function"
    _drawing: ClassVar[str] = ""  # function that draws one into axes
    _several: ClassVar[bool] = False  # whether that function draws a list of results
    _height: ClassVar[float] = 4.6  # of a figure with one axes [inch]

    def parts(self) -> Parts:
        """Lines and tables of the result."""
        raise NotImplementedError

    def text_parts(self) -> Parts:
        yield from self.parts()
        yield from warning_lines(self.warnings)

    def reported(self) -> dict[str, Any]:
        """What is shown of the result, as a JSON object."""
        document: dict[str, Any] = {}
        for name, shown in shown_fields(type(self)).items():
            *levels, key = (shown.key or name).split(".")
            part = document
            for level in levels:
                part = part.setdefault(level, {})
            part[key] = plain(getattr(self, name))
        return document

    def summary(self) -> dict[str, Any]:
        """The result as a JSON object, with its warnings."""
        return self.reported() | {"warnings": list(self.warnings)}

    def labelled(self) -> dict[str, Estimate]:
        """The estimates that have labels, by these."""
        shown = shown_fields(type(self)).items()
        return {one.label: getattr(self, name) for name, one in shown if one.label}

    def plot(self, ax: "Axes | None" = None) -> "Figure":
        """Draw the result; ``ax``: by default that of a new figure."""
        from lightflyer.files.drawing import figure_for

        if ax is None and self._figures:
            return next(iter(imported(self._figures)([self]).values()))
        figure, ax = figure_for(ax, height=self._height)
        imported(self._drawing)([self] if self._several else self, ax)
        return figure


def imported(name: str) -> Any:
    """Function of a module of the lab bench, ``"module:function"``."""
    module, _, function = name.partition(":")
    return getattr(import_module(f"lightflyer.lab.{module}"), function)


def estimate_table(
    rows: Mapping[str, Estimate] | Iterable[tuple[str, Estimate]], first: str = "", digits: int = 4
) -> "RichTable":
    """Table of named estimates with their intervals and units; ``digits``: significant ones."""
    texts = (
        (name, f"{one.value:.{digits}g}", one.interval_text(digits), one.unit or "1")
        for name, one in (rows.items() if isinstance(rows, Mapping) else rows)
    )
    return table_of((first, "value", "95 % interval", "unit"), texts, left=(0, 2, 3))


class Series(NamedTuple):
    """Numbers over a dimension, of a dataset and of a table of commas."""

    name: str
    values: Any  # shape (n,), or one number
    unit: str = ""  # Such as "W/(m^2 K)"
    label: str = ""


def csv_text(comments: Iterable[str], columns: Iterable[Series]) -> str:
    """Columns of numbers as a table of commas, units in the header."""
    columns = list(columns)
    headings = (one.name + f" [{one.unit}]" * bool(one.unit) for one in columns)
    text = io.StringIO()
    text.write("\n".join([*comments, ",".join(headings)]) + "\n")
    np.savetxt(text, np.column_stack([one.values for one in columns]), delimiter=",", fmt="%.8g")
    return text.getvalue()


def variables(
    over: str | Sequence[str], columns: Iterable[Series], **attributes: str
) -> dict[str, Any]:
    """Variables of a dataset over its dimensions, units as its conventions write them."""
    found = {}
    for one in columns:
        above, _, below = one.unit.partition("/")  # "W/(m^2 K)" is written as "W m-2 K-1"
        divided = [part if "^" in part else f"{part}^1" for part in below.strip("()").split()]
        words = [
            above.replace("^", "") * (above != "1"),
            *(part.replace("^", "-") for part in divided),
        ]
        units = " ".join(filter(None, words)) or "1"
        found[one.name] = (over, one.values, {"units": units, "long_name": one.label} | attributes)
    return found


def dataset(
    title: str, variables: Mapping[str, Any], files: Iterable[str], *,
    warnings: Iterable[str] = (), **attributes: Any,
) -> "xr.Dataset":  # fmt: skip
    """Dataset with its title, its input files and the package's version."""
    import xarray as xr

    return xr.Dataset(
        dict(variables),
        attrs={
            "title": f"lightflyer lab: {title}",
            "lightflyer_version": lightflyer.__version__,
            "files": ", ".join(files),
            "warnings": "; ".join(warnings),
            **attributes,
        },
    )


@dataclass(frozen=True)
class Outcome:
    """What a measurement found, as its command prints and writes it."""

    summary: Mapping[str, Any]  # JSON object of the result
    dataset: "xr.Dataset"
    parts: Parts  # Text, the finding first
    _: KW_ONLY
    read: Sequence[Table | Mapping[str, Any]] = ()  # Tables read, or JSON of other files
    warnings: Sequence[str] = ()
    figures: "Callable[[], Mapping[str, Figure]]" = dict
    tables: Mapping[str, str | bytes] = field(default_factory=dict)  # further files, by name
    # Numbers for a flyer file, by section and key, and digits of their ±
    values: Mapping[tuple[str, str], Estimate] = field(default_factory=dict)
    digits: int = 2
    # Where they come from, by default the command's name, and the files given
    origin: str = ""
    sources: Sequence[Path] = ()
    # In place of that: writes into a flyer file, insisting or not, and tells what
    write: Callable[[Path, bool], Sequence[str]] | None = None

    @classmethod
    def of(
        cls, title: str, estimates: Mapping[str, Estimate], tables: Sequence[Table],
        variables: Mapping[str, Any], **others: Any,
    ) -> "Outcome":  # fmt: skip
        """The outcome of a few numbers by name, from tables; ``variables``: of the dataset."""
        said = {name.replace("_", " "): one for name, one in estimates.items()}
        return cls(
            plain(estimates),
            dataset(title, variables, [one.source for one in tables],
                    warnings=others.get("warnings", ())),
            [*(f"{name} {one}" for name, one in [*said.items()][:1]), estimate_table(said)],
            read=tables, **others,
        )  # fmt: skip

    def document(self) -> dict[str, Any]:
        """The JSON object, with the warnings and what was read."""
        read = [
            {
                "file": one.source,
                "rows": len(one),
                "rejected": rejected_json(one.rejected),
                "columns_not_used": one.unused,
                "notes": one.notes,
            }
            if isinstance(one, Table)
            else one
            for one in self.read
        ]
        return {**self.summary, "warnings": list(self.warnings), "read": read}

    def lines(self) -> Parts:
        """The text: the finding, the tables read, all else, and the warnings."""
        parts = iter(self.parts)
        yield from islice(parts, 1)
        for table in self.read:
            if isinstance(table, Table):
                unused = f"; not used: {', '.join(table.unused)}" if table.unused else ""
                yield f"read {len(table)} row{'s' * (len(table) != 1)} of {table.source}{unused}"
                yield from rejected_lines(table.rejected)
                yield from (f"  note: {note}" for note in table.notes)
        yield from parts
        yield from warning_lines(self.warnings)


@dataclass(frozen=True)
class Listing:
    """What an option such as ``--list-channels`` asks for in place of an outcome."""

    document: dict[str, Any]
    lines: Sequence[str]


def figures_by(figures: str, *results: Any, **options: Any) -> "Callable[[], Mapping[str, Figure]]":
    """Function that draws results by ``"module:function"``, which is imported when it is called."""
    return lambda: imported(figures)(*results, **options)


def rejected_json(rejected: Iterable[Any]) -> list[dict[str, Any]]:
    """Rejected rows as JSON."""
    return [{"line": row.line, "reason": row.reason} for row in rejected]


def rejected_lines(rejected: Sequence[Any]) -> Iterator[str]:
    """Rejected rows, only the first of very many."""
    yield from (f"  rejected {row}" for row in rejected[:_MOST_REJECTED])
    if len(rejected) > _MOST_REJECTED:
        yield f"  and {len(rejected) - _MOST_REJECTED} more rows, listed in the JSON record"


def joint_warnings(found: Sequence[tuple[str, Sequence[str]]]) -> list[str]:
    """Warnings of several files; those of one name it, unless all have them."""
    shared = [text for text in found[0][1] if all(text in texts for _, texts in found)]
    return [
        text if text.startswith(name) else type(text)(f"{name}: {text}")
        for name, texts in found
        for text in texts
        if text not in shared
    ] + shared


def require_distinct(measured: Sequence[tuple[str, Any]]) -> None:
    """Refuse the same data twice, which would count as a repeat; names, and arrays (n,)."""
    for (first, one), (second, other) in combinations(measured, 2):
        if np.array_equal(one, other, equal_nan=True):
            raise ConfigurationError(
                f"{second}: has the same data as {first}; each measurement may be given once"
            )


def doubts_of(name: str, quantity: Quantity, value: float, hint: str = "") -> list[Doubt]:
    """A line where a value is not likely; ``hint``: what may be the reason."""
    why = quantity.unlikely(value)
    return [Doubt(f"{name} {why}{'; ' * bool(hint)}{hint}")] if why else []


def ambient_doubts(temperature: np.ndarray) -> list[Doubt]:
    """A line about surroundings colder or warmer than a laboratory; ``temperature`` (n,) [K]."""
    middle = float(np.median(temperature))
    unlogged = abs(middle - _NOT_LOGGED) < 1e-6
    hint = "0 °C is what loggers write where no sensor is connected" if unlogged else ""
    return doubts_of("ambient_temperature", LABORATORY, middle, hint)
