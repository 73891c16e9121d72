"""``lightflyer lab``: commands of the lab bench, each made from the function of a measurement.

``from lightflyer.cli.lab import ftir`` makes the command of
:mod:`lightflyer.lab.commands.lab_ftir`. The function's parameters are its options, with what the
function's docstring says of them; options of all commands are added here.
"""

import inspect
import math
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import is_dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, get_args, get_origin

import cyclopts
from cyclopts import Parameter

from lightflyer.cli.options import AS_USUAL, Json, ResultOptions, Seed, Whole, only_with
from lightflyer.cli.output import print_json, printer, show, write_json
from lightflyer.files.result_text import wrap
from lightflyer.lab.commands import measurements

if TYPE_CHECKING:
    from lightflyer.lab.result import Listing, Outcome

Files = Annotated[list[Path], Parameter(consume_multiple=True, negative=())]  # of a command

_NAMED = inspect.Parameter.KEYWORD_ONLY
_OUT = Parameter(help="Folder to write the record (JSON, NetCDF) and the figures into.")
_INSIST = Parameter(
    negative=(),
    help="Have --update write also what is in doubt: of a wrong unit, not determined, or of data "
    "that do not fit or not cover it.",
)
_JSON = Parameter(help="Print one JSON object instead of tables.")


def __getattr__(name: str) -> Callable[..., None]:
    """The command of a measurement, which Cyclopts asks for by its name."""
    try:
        return command_of(getattr(import_module(f"lightflyer.lab.commands.lab_{name}"), name))
    except ModuleNotFoundError:
        raise AttributeError(name) from None


def command_of(measure: Callable[..., "Outcome | Listing"]) -> Callable[..., None]:
    """The command of a measurement."""
    name = measure.__name__
    hints: dict[str, Any] = measure.__annotations__
    parameters, readers = [], {}
    for one in inspect.signature(measure).parameters.values():
        if get_origin(hints[one.name]) is Annotated:  # a text, which a function reads
            read = get_args(hints[one.name])[1]
            readers[one.name] = partial(read, f"--{one.name.replace('_', '-')}")
        parameters.append(one.replace(annotation=_kind_of(one, hints[one.name])))
    places = [one.name for one in parameters]
    last = len(places)
    insisting = []
    if "update" in places:
        last = places.index("update")
        insisting = [_option("insist", Annotated[bool, _INSIST], False)]
    parameters = [
        *parameters[:last], _option("out", Annotated[Path | None, _OUT], None),
        *parameters[last : last + 1], *insisting, *parameters[last + 1 :],
        _option("json_output", Annotated[Json, _JSON], False),
        _option("figures", ResultOptions, AS_USUAL),
    ]  # fmt: skip
    signature = inspect.Signature(parameters)
    needs = getattr(measure, "needs", {}) | ({"insist": "update"} if insisting else {})

    def command(*args: Any, **named: Any) -> None:
        bound = signature.bind(*args, **named)
        bound.apply_defaults()
        given = bound.arguments
        figures, json_output = given.pop("figures"), given.pop("json_output")
        out, insist = figures.folder(given.pop("out")), given.pop("insist", False)
        for option, read in readers.items():
            if given[option] is not None:
                given[option] = read(given[option])
        by_place = [given.pop(one.name) for one in parameters if one.kind is not _NAMED]
        found, update = measure(*by_place, **given), given.get("update")
        from lightflyer.core.atomic_files import output_directory, write_netcdf
        from lightflyer.lab.result import Listing

        console = printer()
        if isinstance(found, Listing):
            if json_output:
                print_json(found.document)
            for line in () if json_output else found.lines:
                console.print(line, soft_wrap=True)
            return
        document = found.document()
        names: list[str] = []
        with nullcontext() if out is None else output_directory(out) as stage:
            if stage is not None:
                write_json(stage(f"{name}.json"), document)
                write_netcdf(found.dataset, stage(f"{name}.nc"))
                for file, content in found.tables.items():
                    plain = content.encode() if isinstance(content, str) else content
                    stage(file).write_bytes(plain)
                drawn = figures.write(stage, found.figures)
                names = [f"{name}.json", f"{name}.nc", *found.tables, *drawn]
            # the flyer file is changed after all files are prepared; if that fails, nothing is
            # written
            changes = [] if update is None else _update(name, found, update, insist=insist)
        if json_output:
            print_json(document)
            return
        show(console, map(_narrow, found.lines()))
        written = [] if out is None else [out / file for file in names]
        figures.tell(console, written, "add --out FOLDER to write a record and a figure")
        show(console, [_narrow(f"{update}: {text}") for text in changes])

    command.__name__, command.__doc__ = name, measure.__doc__
    command.__signature__ = signature  # type: ignore[attr-defined]
    command.__annotations__ = {one.name: one.annotation for one in parameters}
    return only_with(**needs)(command)


def _kind_of(one: inspect.Parameter, kind: Any) -> Any:
    """What Cyclopts must know of an option."""
    if get_origin(kind) is Annotated:
        return str | None if one.default is None else str
    if is_dataclass(kind):
        return Annotated[kind, Parameter(name="*")]
    if kind is int:
        return Seed if one.name == "seed" else Whole
    if kind is bool:
        return Annotated[bool, Parameter(negative=())]
    if list[Path] in (kind, *get_args(kind)):
        return Annotated[kind, Parameter(consume_multiple=True, negative=())]
    return kind


def _option(name: str, kind: Any, default: Any) -> inspect.Parameter:
    return inspect.Parameter(name, _NAMED, default=default, annotation=kind)


def _update(name: str, found: "Outcome", flyer: Path, *, insist: bool) -> Sequence[str]:
    from lightflyer.config.update import require_no_doubt, update_flyer_file

    if found.write is not None:
        return found.write(flyer, insist)
    require_no_doubt(flyer, found.warnings, insist=insist)
    origin = ", ".join([f"lab {found.origin or name}", *(file.name for file in found.sources)])
    return update_flyer_file(flyer, found.values, origin, insist=insist, digits=found.digits)


def _narrow(part: Any) -> Any:
    """A line of text in lines of a narrow terminal; tables as they are."""
    return "\n".join(map(wrap, part.splitlines())) if isinstance(part, str) else part


_MOST_LINES = 30  # unless --quantity asks for more


def summary_command(
    folders: Files,
    /,
    *,
    quantity: str | None = None,
    out: Path | None = None,
    json_output: Json = False,
) -> None:
    """Collect the numbers of records that other commands wrote with --out.

    Parameters
    ----------
    folders
        Folders of records, and of folders of them.
    quantity
        Quantities whose name contains this, such as "tac"; "" for all. Default: what each
        measurement was made for.
    out
        Table to write, such as runs.csv.
    json_output
        Print one JSON object instead of a table.
    """
    from lightflyer.core.atomic_files import output_directory
    from lightflyer.core.errors import ConfigurationError
    from lightflyer.files.result_text import table_of
    from lightflyer.lab.collection import collect_records, table_text
    from lightflyer.lab.optics.record import in_display_unit

    def interval(one: Any) -> str:
        low, high = one.interval
        if math.isinf(low) and math.isinf(high):
            return "unknown"
        return one.interval_text() if math.isfinite(low) else f"below {high:.4g}"

    entries = collect_records(folders)
    names = sorted({one.quantity for one in entries})
    found = len(entries)
    entries = [
        one
        for one in entries
        if (one.is_headline or out is not None or json_output if quantity is None
            else quantity in one.quantity or quantity in one.name)
    ]  # fmt: skip
    if not entries:
        raise ConfigurationError(f"no quantity contains {quantity}; found: {'; '.join(names)}")
    if out is not None and out.is_dir():
        raise ConfigurationError(f"{out}: is a folder; name a table, such as {out / 'runs.csv'}")
    if out is not None:
        with output_directory(out.parent, shared=True) as stage:
            stage(out.name).write_text(table_text(entries), encoding="utf-8")
    if json_output:
        print_json({"records": [
            {"folder": one.folder, "command": one.command, "quantity": one.quantity}
            | one.estimate.to_json()
            | {"warnings": one.warnings}
            for one in entries
        ]})  # fmt: skip
        return
    shown = entries if quantity is not None else entries[:_MOST_LINES]
    headings = ("folder", "command", "quantity", "value", "95 % interval", "unit", "warnings")
    rows = (
        (
            one.folder, one.command, one.name, f"{number.value:.4g}",
            interval(number), number.unit or "1", str(one.warnings),
        )
        for one, number in ((one, in_display_unit(one.estimate)) for one in shown)
    )  # fmt: skip
    console = printer()
    console.print(table_of(headings, rows, left=(0, 1, 2, 4, 5)))
    if len(shown) < found and quantity is None:
        console.print(f'and {found - len(shown)} more numbers, with --quantity ""')
    if out is not None:
        console.print(f"wrote {out}", markup=False, soft_wrap=True)


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
            stage(file).write_bytes(content if isinstance(content, bytes) else content.encode())
    console = printer()
    for file in files.files:
        console.print(f"wrote {out / file}", soft_wrap=True)
    for command in files.commands:
        console.print(f"next: lightflyer lab {command}", soft_wrap=True)


example_command.__annotations__["name"] = Literal[*measurements()]

app = cyclopts.App(
    name="lab", help="Reduce raw measurements to numbers with intervals, figures and records."
)
for _name, _about in measurements().items():
    app.command(f"lightflyer.cli.lab:{_name}", name=_name, help=_about)
app.command(summary_command, name="summary", help="The numbers of many records in one table.")
app.command(
    example_command, name="example", help="Write synthetic raw files to try a command with."
)
