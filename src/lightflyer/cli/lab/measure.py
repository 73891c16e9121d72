"""Commands of the lab bench, each made from the function of a measurement.

``from lightflyer.cli.lab.measure import ftir`` makes the command of
:mod:`lightflyer.lab.commands.lab_ftir`. The function's parameters are its options, with what the
function's docstring says of them; options of all commands are added here.
"""

import inspect
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import is_dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, get_args, get_origin

from cyclopts import Parameter

from lightflyer.cli.figure_files import AS_USUAL, ResultOptions
from lightflyer.cli.options import Json, Seed, Whole, only_with
from lightflyer.cli.output import print_json, printer, show, write_json
from lightflyer.files.result_text import wrap

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
        found = measure(*by_place, **given)
        _deliver(
            name, found, given.get("update"), out=out, insist=insist, json_output=json_output,
            figures=figures,
        )  # fmt: skip

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


def _deliver(
    name: str, found: "Outcome | Listing", update: Path | None, *, out: Path | None, insist: bool,
    json_output: bool, figures: ResultOptions,
) -> None:  # fmt: skip
    """Write a measurement's record and figures, and print its text or its JSON object."""
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
                stage(file).write_bytes(content.encode() if isinstance(content, str) else content)
            drawn = figures.write(stage, found.figures)
            names = [f"{name}.json", f"{name}.nc", *found.tables, *drawn]
        # the flyer file is changed after all files are prepared; if that fails, nothing is written
        changes = [] if update is None else _update(name, found, update, insist=insist)
    if json_output:
        print_json(document)
        return
    show(console, map(_narrow, found.lines()))
    written = [] if out is None else [out / file for file in names]
    figures.tell(console, written, "add --out FOLDER to write a record and a figure")
    show(console, [_narrow(f"{update}: {text}") for text in changes])


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
